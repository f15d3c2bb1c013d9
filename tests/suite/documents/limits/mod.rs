//! Extremes of geometry, material, mesh, supports, speed, tolerance and time: every cell is within its bound, carries the
//! program's own warning, or is refused with a reason. The table is docs/limits.md.

mod cell;
mod linear;
mod motion;
mod steps;

use crate::common::keep;
use cell::Cell;

/// Share of rounding beyond which a result needs a warning, whatever its bound.
const ROUNDED: f64 = 2e-6;
/// Steps of the energy's drift.
const STEPS: usize = 200_000;

const HEAD: &str = "# Limits

This page says what happens at extremes: how large the error is, how many digits are lost, and what the program says of it. It is made by
`ROTOR_WRITE_DOCS=1 cargo test --release --test suite limits:: -- --ignored`. The long tests compare it with a fresh one: words exactly,
numbers within one and a half decades.

- **error**: relative, against the quantity named.
- **rounding**: the relative change when all lengths are scaled by 1.7 and every quantity moves by at most four units in the last place. That
  changes nothing but rounding.
- **digits lost**: the decimal digits, of sixteen, that rounding took.
- **verdict**: *within* means within its bound. *warned* means beyond it, or that rounding is more than a tenth of it, and that `check` or
  the run says why. *refused* stands with the exit code and the reason.

A cell that is none of these fails the test. So does a cell that loses ten digits without a word, or whose shaken copy says other words.

| extreme | case | quantity | error | bound | rounding | digits lost | verdict | the program says |
|---|---|---|---|---|---|---|---|---|
";

/// Warnings that speak of what is wrong in a family of cells.
fn relevant(family: &str) -> &'static [&'static str] {
    match family {
        "slenderness L/r" | "number of elements" | "member" => &["coarse-mesh", "rounding"],
        "wall t/r" => &["ring-ovals", "hollow-section", "section-basis"],
        "step R_2 / R_1" | "disk length / R_2" => &["step", "thin-disk"],
        "bore / rim" => &["hollow-growth"],
        "Poisson's ratio" => &["bending-locks", "auxetic"],
        "speed (rad/s)" => &["slow-spin"],
        "rtol" | "ramp (s)" | "transient steps" => &["energy-error"],
        _ => &[],
    }
}

fn row(c: &Cell) -> String {
    let number = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{v:.1e}"));
    let said = match &c.refused {
        Some((code, text)) => format!("exit {code}: {}", text.split(" at ").next().unwrap_or_default()),
        None => c.said.join(", "),
    };
    let digits = c.digits_lost().map_or("-".to_owned(), |d| format!("{d:.1}"));
    format!(
        "| {} | {} | {} | {} | {:.0e} | {} | {digits} | {} | {said} |\n",
        c.family,
        c.name,
        c.quantity,
        number(c.error),
        c.bound,
        number(c.noise),
        c.verdict()
    )
}

#[test]
#[ignore = "long"]
fn every_cell_is_within_its_bound_or_says_so() {
    let mut list = linear::slenderness();
    list.extend(linear::walls());
    list.extend(motion::bores());
    list.extend(linear::poisson());
    list.extend(linear::units());
    list.extend(linear::meshes());
    list.extend(linear::bearings());
    list.extend(steps::steps());
    list.extend(motion::speeds());
    list.extend(motion::tolerances());
    list.push(motion::drift(STEPS));
    for c in &list {
        let said = c.said.iter().any(|code| relevant(c.family).contains(&code.as_str()));
        assert!(c.verdict() != "SILENT" && (c.verdict() != "warned" || said), "{}", row(c));
        let rounded = c.noise.is_some_and(|n| n > ROUNDED);
        assert!(
            !rounded || c.said.iter().any(|s| s == "rounding" || s == "thin-wall"),
            "silent rounding: {}",
            row(c)
        );
        assert!(c.wavered.is_none(), "moved by rounding: {:?}: {}", c.wavered, row(c));
        assert!(c.refused.as_ref().is_none_or(|(code, _)| *code == 1), "{}", row(c));
    }
    keep("docs/limits.md", &(HEAD.to_owned() + &list.iter().map(row).collect::<String>()));
}
