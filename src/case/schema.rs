//! The JSON Schema of the case file: what the types say, and the rules of the program that a schema can state.
//!
//! The schema refuses nothing that the program accepts. What it can't state are rules between distant values: names that are
//! defined, places on the shaft, bores smaller than outlines, memory.

use crate::case::Case;
use serde_json::{Map, Value, json};

/// Above zero, where given.
const POSITIVE: [(&str, &[&str]); 13] = [
    ("Material", &["E", "rho"]),
    (
        "Section",
        &[
            "radius",
            "diameter",
            "outer_radius",
            "outer_diameter",
            "semi_axis_y",
            "semi_axis_z",
            "height",
            "width",
        ],
    ),
    ("Segment", &["length"]),
    ("Disk", &["mass", "radius", "diameter", "thickness", "rho"]),
    ("SpeedRange", &["to"]),
    ("Statics", &["tolerance"]),
    ("Spinup", &["until", "step", "rtol", "atol"]),
    ("DrivePhase", &["until"]),
    ("Stator", &["clearance", "stiffness"]),
    ("Body", &["length"]),
    ("BodyLoad", &["until"]),
    ("Structural", &["EA", "GA", "EI", "EA_t", "rho_A", "rho_I", "height", "width"]),
    ("Contact", &["penalty", "point_penalty", "until", "step"]),
];

/// Zero or more.
const NOT_NEGATIVE: [(&str, &[&str]); 7] = [
    ("Segment", &["added_mass_per_length"]),
    ("MaterialDamping", &["stiffness", "mass"]),
    ("Section", &["inner_radius", "inner_diameter", "inner_semi_axis_y", "inner_semi_axis_z"]),
    ("Disk", &["polar_inertia", "diametral_inertia", "inner_radius", "inner_diameter"]),
    ("SpeedRange", &["from"]),
    ("Stator", &["friction"]),
    ("Expected", &["rtol", "atol"]),
];

/// Least and largest value.
const RANGES: [(&str, &str, f64, f64); 22] = [
    ("Segment", "elements", 1.0, 18_446_744_073_709_551_615.0),
    ("Probe", "points", 2.0, 10_000.0),
    ("Modes", "count", 1.0, 2000.0),
    ("Campbell", "modes", 1.0, 1000.0),
    ("SpeedRange", "count", 1.0, 100_000.0),
    ("Statics", "load_steps", 1.0, 10_000.0),
    ("Statics", "max_iterations", 1.0, 1000.0),
    ("Spinup", "output", 2.0, 1_000_000.0),
    ("Spinup", "max_steps", 1.0, 18_446_744_073_709_551_615.0),
    ("Spinup", "rho_infinity", 0.0, 1.0),
    ("Spinup", "rtol", 0.0, 0.1),
    ("Spinup", "atol", 0.0, 0.1),
    ("Stator", "friction", 0.0, 10.0),
    ("QuadraturePoints", "axial", 2.0, 20.0),
    ("QuadraturePoints", "section", 2.0, 20.0),
    ("Body", "elements", 1.0, 20_000.0),
    ("Contact", "segments", 1.0, 1000.0),
    ("Contact", "output", 2.0, 1_000_000.0),
    ("Contact", "snapshots", 1.0, 12.0),
    ("Contact", "load_steps", 1.0, 100_000.0),
    ("Tradeoff", "repeats", 0.0, 4_294_967_295.0),
    ("Filter", "n", 0.0, 18_446_744_073_709_551_615.0),
];

/// Elements of a shaft: those to choose from in an editor, and the whole family.
const ELEMENTS: [&str; 13] = [
    "34X1", "34X2", "34X3", "34X4", "34X5", "34R12", "34R13", "34R23", "34R33", "34R34", "auto", "3333c",
    "3333s",
];

/// JSON Schema of the case file.
pub fn schema() -> Value {
    let mut schema = schemars::schema_for!(Case).to_value();
    for (definition, keys) in POSITIVE {
        keys.iter().for_each(|key| set(&mut schema, definition, key, "exclusiveMinimum", 0.into()));
    }
    for (definition, keys) in NOT_NEGATIVE {
        keys.iter().for_each(|key| set(&mut schema, definition, key, "minimum", 0.into()));
    }
    for (definition, key, least, largest) in RANGES {
        set(&mut schema, definition, key, "minimum", json!(least as u64));
        let largest = if largest.fract() == 0.0 { json!(largest as u64) } else { json!(largest) };
        set(&mut schema, definition, key, "maximum", largest);
    }
    set(&mut schema, "Material", "nu", "exclusiveMinimum", (-1).into());
    set(&mut schema, "Material", "nu", "exclusiveMaximum", json!(0.5));
    set(&mut schema, "Statics", "tolerance", "exclusiveMinimum", json!(1e-32));
    set(&mut schema, "Statics", "tolerance", "exclusiveMaximum", json!(1e-2));
    set(&mut schema, "Shaft", "segments", "minItems", 1.into());
    set(&mut schema, "Spinup", "drive", "minItems", 1.into());
    set(&mut schema, "Spinup", "torque", "minItems", 1.into());
    add(&mut schema, "Spinup", "oneOf", json!([{ "required": ["drive"] }, { "required": ["torque"] }]));
    for (definition, key) in [("Body", "start"), ("Body", "velocity"), ("BodyLoad", "force")] {
        set(&mut schema, definition, key, "minItems", 2.into());
        set(&mut schema, definition, key, "maxItems", 3.into());
    }
    for definition in ["Shaft", "Segment"] {
        let family = json!([{ "enum": ELEMENTS }, { "pattern": "^(34X[1-5]|34R[1-9][1-9]|auto)(k[0-6])?$" }, { "type": "null" }]);
        set(&mut schema, definition, "element", "anyOf", family);
    }
    set(&mut schema, "Body", "element", "enum", json!(["2322s", "3333s", "34X3"]));
    set(&mut schema, "Campbell", "orders", "items", json!({ "type": "number", "exclusiveMinimum": 0 }));
    set(&mut schema, "Expected", "value", "type", json!(["number", "array"]));
    set(&mut schema, "Expected", "value", "items", json!({ "type": "number" }));
    set(&mut schema, "Expected", "value", "minItems", 1.into());
    add(&mut schema, "Expected", "anyOf", json!([given(&["rtol"]), given(&["atol"])]));
    let axes = json!({
        "type": "object", "minProperties": 1, "additionalProperties": { "type": "array", "minItems": 1 }
    });
    add(&mut schema, "Grid", "anyOf", json!([axes, { "type": "array", "minItems": 1, "items": axes }]));
    add(&mut schema, "Section", "allOf", sections());
    add(&mut schema, "Support", "allOf", supports());
    add(
        &mut schema,
        "Disk",
        "anyOf",
        json!([
            given(&["mass"]),
            given(&["radius", "thickness", "rho"]),
            given(&["diameter", "thickness", "rho"])
        ]),
    );
    schema
}

/// Keys that are there and not null.
fn given(keys: &[&str]) -> Value {
    let there: Map<String, Value> =
        keys.iter().map(|key| ((*key).to_owned(), json!({ "not": { "type": "null" } }))).collect();
    json!({ "required": keys, "properties": there })
}

/// Keys that are absent or null.
fn absent(keys: &[&str]) -> Value {
    let gone: Map<String, Value> =
        keys.iter().map(|key| ((*key).to_owned(), json!({ "type": "null" }))).collect();
    json!({ "properties": gone })
}

/// Which keys a section of each shape takes.
fn sections() -> Value {
    const ALL: [&str; 12] = [
        "radius",
        "diameter",
        "outer_radius",
        "outer_diameter",
        "inner_radius",
        "inner_diameter",
        "semi_axis_y",
        "semi_axis_z",
        "inner_semi_axis_y",
        "inner_semi_axis_z",
        "height",
        "width",
    ];
    /// A shape, groups of which it takes one key each, and others that may be there.
    type Rule<'a> = (&'a str, &'a [&'a [&'a str]], &'a [&'a str]);
    let shapes: [Rule<'_>; 4] = [
        ("circle", &[&["radius", "diameter"]], &[]),
        ("tube", &[&["outer_radius", "outer_diameter"], &["inner_radius", "inner_diameter"]], &[]),
        ("ellipse", &[&["semi_axis_y"], &["semi_axis_z"]], &["inner_semi_axis_y", "inner_semi_axis_z"]),
        ("rectangle", &[&["height"], &["width"]], &[]),
    ];
    shapes
        .iter()
        .map(|(shape, groups, optional)| {
            let takes = |key: &&str| optional.contains(key) || groups.iter().any(|group| group.contains(key));
            let others: Vec<&str> = ALL.into_iter().filter(|key| !takes(key)).collect();
            let mut then = vec![absent(&others)];
            for group in *groups {
                then.push(json!({ "oneOf": group.iter().map(|key| given(&[key])).collect::<Vec<_>>() }));
            }
            when("shape", &[shape], json!({ "allOf": then }))
        })
        .collect()
}

/// Which keys a support of each kind takes.
fn supports() -> Value {
    const OF_BEARINGS: [&str; 12] = [
        "stiffness",
        "damping",
        "table",
        "offset",
        "mass",
        "axial_stiffness",
        "axial_damping",
        "tilt_stiffness",
        "tilt_damping",
        "torsional_stiffness",
        "torsional_damping",
        "housing",
    ];
    let without = |more: &[&'static str]| absent(&[more, &OF_BEARINGS].concat());
    let any: Vec<Value> = [
        "stiffness",
        "table",
        "axial_stiffness",
        "axial_damping",
        "tilt_stiffness",
        "tilt_damping",
        "torsional_stiffness",
        "torsional_damping",
    ]
    .iter()
    .map(|key| given(&[key]))
    .collect();
    json!([
        { "oneOf": [given(&["kind"]), given(&["fix"])] },
        when("kind", &["clamped"], without(&["driven"])),
        when("kind", &["revolute", "cylindrical"], without(&[])),
        when("kind", &["pinned", "roller"], without(&["section", "driven"])),
        when("kind", &["bearing", "seal"], json!({
            "anyOf": any,
            "allOf": [
                absent(&["section", "driven"]),
                { "if": given(&["table"]), "then": absent(&["stiffness", "damping", "mass"]) }
            ]
        })),
        { "if": given(&["fix"]), "then": without(&["section", "driven", "acts_on"]) }
    ])
}

/// A rule for objects whose key has one of some words.
fn when(key: &str, words: &[&str], then: Value) -> Value {
    json!({ "if": { "required": [key], "properties": { key: { "enum": words } } }, "then": then })
}

/// Adds a keyword to the schema of a key.
fn set(schema: &mut Value, definition: &str, key: &str, keyword: &str, value: Value) {
    add(schema, &format!("{definition}/properties/{key}"), keyword, value);
}

/// Adds a keyword to a definition.
fn add(schema: &mut Value, definition: &str, keyword: &str, value: Value) {
    match schema.pointer_mut(&format!("/$defs/{definition}")).and_then(Value::as_object_mut) {
        Some(place) => drop(place.insert(keyword.to_owned(), value)),
        None => debug_assert!(false, "no {definition}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every rule finds its key.
    #[test]
    fn rules_meet_the_types() {
        let plain = schemars::schema_for!(Case).to_value();
        let lists = POSITIVE.iter().map(|(d, k)| (*d, *k)).chain(NOT_NEGATIVE.iter().map(|(d, k)| (*d, *k)));
        let all = lists.flat_map(|(d, keys)| keys.iter().map(move |key| (d, *key)));
        for (definition, key) in all.chain(RANGES.iter().map(|r| (r.0, r.1))) {
            assert!(
                plain.pointer(&format!("/$defs/{definition}/properties/{key}")).is_some(),
                "{definition} {key}"
            );
        }
        schema();
    }
}
