//! The JSON Schema and the program against each other, by a small checker of the keywords that the schema uses.

use crate::common::{case_files, scene_files};
use crate::mutations::{CASES, SCENES, config, count, mutated};
use proptest::prelude::*;
use regex_lite::Regex;
use rotor::case::{Case, schema};
use rotor::error::Error;
use rotor::model::Model;
use rotor::model::scene::Scene;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

static SCHEMA: LazyLock<Value> = LazyLock::new(schema);

/// Patterns of the schema, compiled once.
static PATTERNS: LazyLock<HashMap<String, Regex>> = LazyLock::new(|| {
    let mut map = HashMap::new();
    collect(&SCHEMA, &mut map);
    map
});

fn collect(value: &Value, into: &mut HashMap<String, Regex>) {
    match value {
        Value::Object(map) => {
            if let Some(pattern) = map.get("pattern").and_then(Value::as_str) {
                let compiled = Regex::new(pattern).unwrap_or_else(|e| panic!("{pattern}: {e}"));
                into.insert(pattern.to_owned(), compiled);
            }
            map.values().for_each(|v| collect(v, into));
        }
        Value::Array(list) => list.iter().for_each(|v| collect(v, into)),
        _ => {}
    }
}

fn is(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
        other => panic!("type {other}"),
    }
}

/// Why a value does not fit a schema, if so: draft 2020-12, the keywords in use.
fn fault(value: &Value, rule: &Value, at: &str) -> Option<String> {
    let rule = match rule {
        Value::Bool(true) => return None,
        Value::Bool(false) => return Some(format!("{at}: nothing may stand here")),
        other => other.as_object().expect("a schema"),
    };
    rule.iter().find_map(|(keyword, asked)| keyword_fault(value, keyword, asked, rule, at))
}

fn keyword_fault(
    value: &Value,
    keyword: &str,
    asked: &Value,
    rule: &Map<String, Value>,
    at: &str,
) -> Option<String> {
    let no = |fits: bool| (!fits).then(|| format!("{at}: {value} breaks {keyword} {asked}"));
    let fits = |rule: &Value| fault(value, rule, at).is_none();
    let list = || asked.as_array().expect("a list").iter();
    match keyword {
        "$ref" => {
            let pointer = asked.as_str().and_then(|s| s.strip_prefix('#')).expect("a reference");
            fault(value, SCHEMA.pointer(pointer).unwrap_or_else(|| panic!("{pointer}")), at)
        }
        "type" => match asked {
            Value::String(name) => no(is(value, name)),
            _ => no(list().any(|name| is(value, name.as_str().expect("a name")))),
        },
        "enum" => no(list().any(|v| v == value)),
        "const" => no(asked == value),
        "anyOf" => no(list().any(fits)),
        "oneOf" => no(list().filter(|rule| fits(rule)).count() == 1),
        "allOf" => list().find_map(|rule| fault(value, rule, at)),
        "not" => no(!fits(asked)),
        "if" => rule.get("then").filter(|_| fits(asked)).and_then(|then| fault(value, then, at)),
        "pattern" => {
            no(value.as_str().is_none_or(|text| PATTERNS[asked.as_str().expect("text")].is_match(text)))
        }
        _ if value.is_number() => number_fault(value, keyword, asked, at),
        _ => container_fault(value, keyword, asked, rule, at),
    }
}

fn number_fault(value: &Value, keyword: &str, asked: &Value, at: &str) -> Option<String> {
    let (x, bound) = (value.as_f64()?, asked.as_f64());
    let fits = match (keyword, bound) {
        ("minimum", Some(bound)) => x >= bound,
        ("maximum", Some(bound)) => x <= bound,
        ("exclusiveMinimum", Some(bound)) => x > bound,
        ("exclusiveMaximum", Some(bound)) => x < bound,
        _ => true,
    };
    (!fits).then(|| format!("{at}: {value} breaks {keyword} {asked}"))
}

fn container_fault(
    value: &Value,
    keyword: &str,
    asked: &Value,
    rule: &Map<String, Value>,
    at: &str,
) -> Option<String> {
    let bound = || asked.as_u64().expect("a count") as usize;
    let no = |fits: bool| (!fits).then(|| format!("{at}: breaks {keyword} {asked}"));
    match (keyword, value) {
        ("properties", Value::Object(map)) => {
            let known = asked.as_object().expect("properties");
            known.iter().find_map(|(key, rule)| fault(map.get(key)?, rule, &format!("{at}.{key}")))
        }
        ("additionalProperties", Value::Object(map)) => {
            let known = rule.get("properties").and_then(Value::as_object);
            let others = map.iter().filter(|(key, _)| !known.is_some_and(|known| known.contains_key(*key)));
            others.into_iter().find_map(|(key, value)| fault(value, asked, &format!("{at}.{key}")))
        }
        ("required", Value::Object(map)) => {
            let list = asked.as_array().expect("a list");
            no(list.iter().all(|key| map.contains_key(key.as_str().expect("a key"))))
        }
        ("minProperties", Value::Object(map)) => no(map.len() >= bound()),
        ("items", Value::Array(list)) => {
            list.iter().enumerate().find_map(|(i, item)| fault(item, asked, &format!("{at}.{i}")))
        }
        ("minItems", Value::Array(list)) => no(list.len() >= bound()),
        ("maxItems", Value::Array(list)) => no(list.len() <= bound()),
        _ => {
            const KNOWN: [&str; 24] = [
                "properties",
                "additionalProperties",
                "required",
                "minProperties",
                "items",
                "minItems",
                "maxItems",
                "minimum",
                "maximum",
                "exclusiveMinimum",
                "exclusiveMaximum",
                "then",
                "description",
                "title",
                "default",
                "format",
                "$schema",
                "$defs",
                "examples",
                "$id",
                "$comment",
                "deprecated",
                "readOnly",
                "writeOnly",
            ];
            assert!(KNOWN.contains(&keyword), "the checker does not know {keyword}");
            None
        }
    }
}

/// What the schema says, what the reading of the case says, and what the checks of the model say.
fn verdicts(text: &str) -> (Option<String>, Option<Error>, Option<Error>) {
    let value: Value = serde_json::from_str(text).expect("JSON");
    let by_schema = fault(&value, &SCHEMA, "case");
    match Case::parse("mutated.json", text, &[]) {
        Err(error) => (by_schema, Some(error.clone()), Some(error)),
        Ok(loaded) => {
            let scene = loaded.case.shaft.is_none()
                && (!loaded.case.bodies.is_empty() || loaded.case.contact.is_some());
            let built = if scene { Scene::new(&loaded).err() } else { Model::new(&loaded).err() };
            (by_schema, None, built)
        }
    }
}

/// What the schema refuses the program refuses; what can't be read the schema refuses, but for sizes that are no sizes.
fn agree(text: &str) -> bool {
    let (schema, read, built) = verdicts(text);
    if let Some(fault) = &schema {
        assert!(built.is_some(), "only the schema refuses: {fault}\n{text}");
    }
    if let Some(error) = &read {
        let words = error.to_string();
        let beyond = ["extreme size", "not a finite number"].iter().any(|w| words.contains(w));
        assert!(schema.is_some() || beyond, "only the program refuses: {error}\n{text}");
    }
    schema.is_some() == built.is_some()
}

#[test]
fn every_case_fits_the_schema() {
    for path in case_files().into_iter().chain(scene_files()) {
        let value = Case::load(&path, &[]).expect("case").value;
        assert_eq!(fault(&value, &SCHEMA, "case"), None, "{}", path.display());
    }
}

/// What an editor is to underline.
#[test]
fn the_schema_refuses_what_the_program_refuses() {
    let base = CASES
        .iter()
        .find(|case| case["title"].as_str().is_some_and(|t| t.contains("Jeffcott")))
        .expect("a case");
    assert_eq!(fault(base, &SCHEMA, "case"), None);
    let table = [
        ("/shaft/segments/0/elements", json!(0)),
        ("/shaft/segments/0/elements", json!(2.5)),
        ("/shaft/segments/0/element", json!("34X6")),
        ("/shaft/segments/0/length", json!("1 furlong")),
        ("/shaft/segments/0/length", json!("1 GPa")),
        ("/shaft/segments/0/length", json!(-1)),
        ("/shaft/segments", json!([])),
        ("/shaft/element", json!("34R70")),
        ("/sections/shaft/radius", json!("five mm")),
        ("/sections/shaft/height", json!(1)),
        ("/sections/shaft/diameter", json!(1)),
        ("/materials/light/nu", json!(0.5)),
        ("/materials/light/E", json!(0)),
        ("/modes/count", json!(0)),
        ("/campbell/modes", json!(0)),
        ("/campbell/speeds/count", json!(100_001)),
        ("/campbell/reduction", json!(8)),
        ("/supports/0/stiffness", json!(1)),
        ("/supports/0/kind", json!("bearing")),
        ("/supports/0/fix", json!(["r"])),
        ("/disks/0/radius", json!(-1)),
        ("/expected/0/value", json!([])),
        ("/expected/0/rtol", json!(null)),
        ("/surplus", json!(1)),
    ];
    for (pointer, value) in table {
        let mut case = base.clone();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        case.pointer_mut(parent).unwrap_or_else(|| panic!("{pointer}"))[key] = value.clone();
        let (schema, _, built) = verdicts(&case.to_string());
        assert!(schema.is_some() && built.is_some(), "{pointer} {value}: {schema:?} {built:?}");
    }
    for (pointer, value) in [
        ("/$schema", json!("case.schema.json")),
        ("/shaft/segments/0/elements", json!(8.0)),
        ("/shaft/segments/0/length", json!("1000mm")),
        ("/shaft/segments/0/length", json!("1")),
        ("/sections/shaft/radius", json!("5e3 \u{b5}m")),
        ("/disks/0/mass", json!("22 lb")),
        ("/disks/0/polar_inertia", json!("0 kg\u{b7}m\u{b2}")),
    ] {
        let mut case = base.clone();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        case.pointer_mut(parent).expect("a place")[key] = value.clone();
        let (schema, read, built) = verdicts(&case.to_string());
        assert!(
            schema.is_none() && read.is_none() && built.is_none(),
            "{pointer} {value}: {schema:?} {built:?}"
        );
    }
}

/// Mutations tried, and those on which schema and program agree.
static TRIED: [AtomicUsize; 2] = [AtomicUsize::new(0), AtomicUsize::new(0)];

proptest! {
    #![proptest_config(config(count(40_000) / 10))]

    #[test]
    fn schema_and_program_agree_on_mutated_cases(text in mutated(&CASES)) {
        TRIED[usize::from(agree(&text))].fetch_add(1, Ordering::Relaxed);
        let [apart, together] = [0, 1].map(|i| TRIED[i].load(Ordering::Relaxed));
        // rules between distant values are beyond a schema
        assert!(apart + together < 1000 || apart < together, "{apart} verdicts differ, {together} agree");
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 20))]

    #[test]
    fn schema_and_program_agree_on_mutated_scenes(text in mutated(&SCENES)) {
        agree(&text);
    }
}
