//! Tables of bearings in files and in cases: what is read, and where a slip stands.

use crate::common::case;
use rotor::case::{Case, LoadedCase};
use rotor::error::Error;
use rotor::model::Model;
use serde_json::{Value, json};
use std::path::Path;

/// A rotor whose first bearing has that table.
fn rotor(table: Value) -> Value {
    json!({
        "title": "a table",
        "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } },
        "sections": { "s": { "shape": "circle", "radius": 0.05 } },
        "shaft": { "segments": [{ "length": 1, "elements": 2, "section": "s", "material": "m" }] },
        "supports": [
            { "at": 0, "kind": "bearing", "table": table },
            { "at": 1, "kind": "bearing", "stiffness": 1e8 }
        ]
    })
}

/// The case in a folder with that file.
fn beside(name: &str, bytes: &[u8], table: Value) -> Result<LoadedCase, Error> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join(name), bytes).expect("written");
    let path = folder.path().join("case.json");
    std::fs::write(&path, rotor(table).to_string()).expect("written");
    Case::load(&path, &[])
}

fn of_text(text: &str) -> Result<LoadedCase, Error> {
    beside("brg.csv", text.as_bytes(), json!({ "file": "brg.csv" }))
}

fn rows(loaded: Result<LoadedCase, Error>) -> Value {
    loaded.unwrap_or_else(|e| panic!("{e}")).value["supports"][0]["table"].clone()
}

/// Numbers of a table, in order.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        Value::Object(map) => map.values().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap_or_else(|| panic!("{other}"))],
    }
}

fn near(ours: &Value, right: &[f64], what: &str) {
    let ours = numbers(ours);
    assert_eq!(ours.len(), right.len(), "{what}: {ours:?}");
    for (a, b) in ours.iter().zip(right) {
        assert!((a - b).abs() <= 1e-14 * b.abs(), "{what}: {a} instead of {b}");
    }
}

/// What the files below hold, in SI.
fn right() -> Vec<f64> {
    let rpm = std::f64::consts::PI / 30.0;
    vec![
        1000.0 * rpm,
        1.5e8,
        2e7,
        -2e7,
        2.5e8,
        1e5,
        0.0,
        0.0,
        1.25e5, //
        3000.0 * rpm,
        1.25e8,
        3e7,
        -3e7,
        2e8,
        9e4,
        0.0,
        0.0,
        1e5,
    ]
}

/// The same table however it is written.
#[test]
fn a_table_is_read_in_every_dress() {
    let texts = [
        "speed (rpm),Kxx (N/m),Kxy (N/m),Kyx (N/m),Kyy (N/m),Cxx (N s/m),Cyy (N s/m)\n\
         1000,1.5e8,2e7,-2e7,2.5e8,1e5,1.25e5\n3000,1.25e8,3e7,-3e7,2e8,9e4,1e5\n",
        "\u{feff}Speed [rpm];K_xx [N/\u{b5}m];K_xy [N/um];K_yx [kN/mm];K_yy [MN/m];C_xx [N*s/m];C_yy [Ns/m]\r\n\
         1000;150;20,0;-20;250;1,0E5;125000\r\n\r\n3000;125;30;-30;200;90000;1e5\r\n",
        "# pad bearing, cold\nrpm\tkxx\tkxy\tkyx\tkyy\tcxx\tcyy\n\tN/m\tN/m\tN/m\tN/m\tN-s/m\tN.s/m\n\
         1000\t1.5e8\t2e7\t-2e7\t2.5e8\t1e5\t1.25e5\n3000\t1.25e8\t3e7\t-3e7\t2e8\t9e4\t1e5",
        "czz (kN s/m), cyy (kN s/m), kyy (N/m), kyz (N/m), kzy (N/m), kzz (N/m), rotor speed (1/min)\n\
         125, 100, 1.5e8, 2e7, -2e7, 2.5e8, 1000\n100, 90, 1.25e8, 3e7, -3e7, 2e8, 3000\n",
        "sep=;\nomega (rpm);KXX (N/m);KXY (N/m);KYX (N/m);KYY (N/m);CXX (N s/m);CYY (N s/m);\n\
         1000;1.5e8;2e7;-2e7;2.5e8;1e5;1.25e5;\n3000;1.25e8;3e7;-3e7;2e8;9e4;1e5;\n",
    ];
    for text in texts {
        near(&rows(of_text(text)), &right(), text);
    }
    for (name, table) in [
        ("one-sheet.xlsx", json!({ "file": "a.xlsx" })),
        ("two-sheets.xlsx", json!({ "file": "a.xlsx", "sheet": "bearing" })),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables").join(name);
        let bytes = std::fs::read(path).expect("a workbook");
        near(&rows(beside("a.xlsx", &bytes, table)), &right(), name);
    }
}

/// Added mass, whirl frequencies, and inches.
#[test]
fn whirl_frequencies_and_masses_are_read() {
    let text = "speed (rpm),whirl (Hz),kyy (lbf/in),kzz (lbf/in),myy (lb),mzz (kg)\n\
                60,1,1e5,2e5,1,2\n60,2,1e5,2e5,1,3\n120,1,1e5,2e5,1,4\n120,2,1e5,2e5,1,5\n";
    let (tau, lbf_in, lb) = (std::f64::consts::TAU, 175.12683524647636, 0.45359237);
    let row = |speed: f64, whirl: f64, mass: f64| {
        vec![speed * tau, whirl * tau, 1e5 * lbf_in, 0.0, 0.0, 2e5 * lbf_in, lb, 0.0, 0.0, mass]
    };
    let right = [row(1.0, 1.0, 2.0), row(1.0, 2.0, 3.0), row(2.0, 1.0, 4.0), row(2.0, 2.0, 5.0)].concat();
    near(&rows(of_text(text)), &right, "whirl");
}

/// The case as analysed holds the rows and is the same without the file; its hash is that of the numbers.
#[test]
fn the_effective_case_holds_the_rows() {
    let text = |k: &str| format!("speed (rpm),Kxx (N/m),Kyy (N/m)\n1000,{k},2e8\n2000,3e8,4e8\n");
    let loaded = of_text(&text("1e8")).unwrap_or_else(|e| panic!("{e}"));
    let again =
        LoadedCase::from_value("elsewhere.json", loaded.value.clone()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.sha256, again.sha256);
    assert_ne!(loaded.sha256, of_text(&text("1.0000001e8")).unwrap_or_else(|e| panic!("{e}")).sha256);
    // a case without tables keeps its hash
    let plain = case("jeffcott");
    let hash = LoadedCase::from_value("a.json", plain.value.clone()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(plain.sha256, hash.sha256);
}

/// Every slip in a file is told with its row, its column and what would be right.
#[test]
fn slips_in_a_file_are_told_with_their_place() {
    let head = "speed (rpm),Kxx (N/m),Kyy (N/m)\n";
    for (text, said) in [
        ("", vec!["brg.csv: at `(the whole file)`", "is empty"]),
        ("\u{feff}\n\n", vec!["is empty"]),
        (head, vec!["row 1", "no rows", "at least one row"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\nrpm,N/m,N/m\n", vec!["row 2", "has a unit already"]),
        (
            "speed,Kxx (N/m),Kyy (N/m)\n1,2,3\n",
            vec!["row 1, column 1", "no unit", "rpm and rad/s can't be told apart"],
        ),
        ("speed (rpm),Kxx,Kyy (N/m)\n1,2,3\n", vec!["row 1, column 2", "no unit"]),
        ("speed (m/s),Kxx (N/m),Kyy (N/m)\n1,2,3\n", vec!["column 1", "unit of velocity", "rpm"]),
        ("speed (rpm),Kxx (N/mmm),Kyy (N/m)\n1,2,3\n", vec!["column 2", "unknown unit", "lbf/in"]),
        ("speed (rpm),Kxx (N/m),Kyyy (N/m)\n1,2,3\n", vec!["column 3", "no such column", "kyy kyz kzy kzz"]),
        ("sped (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n", vec!["column 1", "did you mean \"speed\""]),
        ("speed (rpm),Kxx (N/m),Kzz (N/m)\n1,2,3\n", vec!["column 2", "two kinds"]),
        ("speed (rpm),Kxx (N/m),kxx (N/m)\n1,2,3\n", vec!["column 3", "stands twice"]),
        ("speed (rpm),Kxx (N/m)\n1,2\n", vec!["row 1", "Kyy of the stiffness is missing"]),
        ("speed (rpm),kyy (N/m)\n1,2\n", vec!["row 1", "missing"]),
        ("Kxx (N/m),Kyy (N/m)\n1,2\n", vec!["row 1", "speed is missing"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m),Kxy (N/m)\n1,2,3,4\n", vec!["Kyx of the stiffness is missing"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m),Cxx (N s/m)\n1,2,3,4\n", vec!["Cyy of the damping is missing"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n2,,3\n", vec!["row 3, column 2 (\"Kxx (N/m)\")", "empty"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n2,3\n", vec!["row 3, column 3", "empty"]),
        (
            "speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n\n2,soft,3\n",
            vec!["row 4, column 2", "\"soft\"", "no number"],
        ),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n2,NaN,3\n", vec!["row 3, column 2", "not a finite number"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n2,1e999,3\n", vec!["not a finite number"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3\n2,1e40,3\n", vec!["extreme size"]),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n1,2,3,4\n", vec!["row 2, column 4", "semicolons"]),
        ("speed (rpm)\tKxx (N/m)\tKyy (N/m)\n1\t2,5\t3\n", vec!["row 2", "comma", "semicolons"]),
        ("speed (rpm);Kxx (N/m);Kyy (N/m)\n1;2,5;3.5\n", vec!["row 2", "commas and points"]),
        ("speed (rpm);Kxx (N/m);Kyy (N/m)\n1;2,500,000;3\n", vec!["row 2, column 2", "no number"]),
        (
            "speed (rpm),Kxx (N/m),Kyy (N/m)\n3,2,3\n2,2,3\n",
            vec!["row 3, column 1", "\"2\"", "do not ascend", "sort"],
        ),
        ("speed (rpm),Kxx (N/m),Kyy (N/m)\n3,2,3\n3,2,3\n", vec!["row 3, column 1", "stands twice"]),
        (
            "speed (rpm),whirl (rpm),Kxx (N/m),Kyy (N/m)\n1,1,2,3\n1,2,2,3\n2,1,2,3\n3,1,2,3\n3,2,2,3\n",
            vec!["row 5, column 2", "has 1 whirl frequencies, the first one 2"],
        ),
        (
            "speed (rpm),whirl (rpm),Kxx (N/m),Kyy (N/m)\n1,1,2,3\n1,2,2,3\n2,1,2,3\n2,4,2,3\n",
            vec!["row 5, column 2", "the same whirl frequencies"],
        ),
        (
            "speed (rpm),whirl (rpm),Kxx (N/m),Kyy (N/m)\n1,2,2,3\n1,1,2,3\n",
            vec!["row 3, column 2", "do not ascend", "then by whirl"],
        ),
        ("speed (rpm),whirl (rpm),Kxx (N/m),Kyy (N/m)\n1,-2,2,3\n", vec!["row 2, column 2", "negative"]),
    ] {
        let error = of_text(text).expect_err(text);
        assert_eq!(error.exit_code(), 2);
        let message = error.to_string();
        said.iter().for_each(|said| assert!(message.contains(said), "{text}\n{message}\nhas no {said}"));
    }
    for (name, bytes, table, said) in [
        ("brg.csv", b"\xff\xfes\0p\0".as_slice(), json!({ "file": "brg.csv" }), "no text in UTF-8"),
        ("brg.csv", b"PK\x03\x04....", json!({ "file": "brg.csv" }), "workbook can't be read"),
        ("brg.xls", b"\xd0\xcf\x11\xe0....", json!({ "file": "brg.xls" }), "saved as .xlsx"),
        ("brg.csv", b"a", json!({ "file": "gone.csv" }), "supports.0.table.file"),
        ("brg.csv", b"a", json!({ "file": "." }), "is no file"),
        ("brg.csv", b"a", json!({ "file": "brg.csv", "sheet": "x" }), "no sheets"),
        ("brg.csv", b"a", json!({ "fil": "brg.csv" }), "did you mean \"file\""),
        ("brg.csv", b"a", json!({ "file": 3 }), "supports.0.table.file"),
        ("brg.csv", b"a", json!({}), "the key \"file\" is missing"),
        ("brg.csv", b"a", json!("brg.csv"), "supports.0.table"),
    ] {
        let error = beside(name, bytes, table).expect_err(said);
        assert!(error.exit_code() == 2 && error.to_string().contains(said), "{error}\nhas no {said}");
    }
    let bytes = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables/two-sheets.xlsx"));
    let error = beside("a.xlsx", &bytes.expect("a workbook"), json!({ "file": "a.xlsx" })).expect_err("two");
    assert!(error.to_string().contains("\"sheet\": \"notes\" or \"sheet\": \"bearing\""), "{error}");
}

/// Rows in a case follow the same rules, with the path of the slip.
#[test]
fn slips_in_rows_are_told_with_their_path() {
    let row = |speed: &str| json!({ "speed": speed, "stiffness": "1e8 N/m" });
    let whirling = |speed: f64, whirl: f64| json!({ "speed": speed, "whirl": whirl, "stiffness": 1e8 });
    for (table, path, said) in [
        (json!([]), "supports.0.table", "no rows"),
        (json!([row("2 rpm"), row("1 rpm")]), "supports.0.table.1.speed", "do not ascend"),
        (json!([row("2 rpm"), row("2 rpm")]), "supports.0.table.1.speed", "stands twice"),
        (json!([row("2 kg")]), "supports.0.table[0].speed", "unit of mass"),
        (json!([{ "speed": 1 }]), "supports.0.table", "stiffness"),
        (json!([row("2 rpm"), whirling(3.0, 1.0)]), "supports.0.table.1.whirl", "only some rows"),
        (json!([whirling(1.0, 1.0), whirling(1.0, 1.0)]), "supports.0.table.1.whirl", "do not ascend"),
    ] {
        let error =
            LoadedCase::from_value("a.json", rotor(table)).and_then(|c| Model::new(&c)).expect_err(said);
        let message = error.to_string();
        assert_eq!(error.exit_code(), 2);
        let path = path.replace('[', ".").replace(']', "");
        assert!(message.contains(&path) && message.contains(said), "{message}\nhas no {path}, {said}");
    }
}
