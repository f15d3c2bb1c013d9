//! What serde alone would read too freely or too strictly.

use serde_json::Value;

/// The same with 8.0 written as 8: a number of elements is whole however it is written.
pub(super) fn whole_numbers(value: &Value) -> Value {
    /// Range of whole numbers that can be kept, 2^63 and 2^64.
    const RANGE: std::ops::Range<f64> = -9_223_372_036_854_775_808.0..18_446_744_073_709_551_616.0;
    match value {
        Value::Object(map) => map.iter().map(|(key, value)| (key.clone(), whole_numbers(value))).collect(),
        Value::Array(list) => list.iter().map(whole_numbers).collect(),
        Value::Number(n) => match n.as_f64() {
            Some(x) if n.is_f64() && x.fract() == 0.0 && RANGE.contains(&x) => {
                if x < 0.0 {
                    (x as i64).into()
                } else {
                    (x as u64).into()
                }
            }
            _ => value.clone(),
        },
        other => other.clone(),
    }
}

/// Serde also reads an object from a list of its values and a word from `{ "word": null }`; in a case file
/// either is a mistake. The place of the first one, and what belongs there.
pub(super) fn other_container(
    written: &Value,
    understood: &Value,
    path: &str,
) -> Option<(String, &'static str)> {
    let child = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (written, understood) {
        (Value::Object(map), Value::Object(known)) => {
            map.iter().find_map(|(key, value)| other_container(value, known.get(key)?, &child(key)))
        }
        (Value::Array(list), Value::Array(known)) => {
            let pairs = list.iter().zip(known).enumerate();
            pairs
                .into_iter()
                .find_map(|(i, (value, known))| other_container(value, known, &child(&i.to_string())))
        }
        (Value::Array(_), Value::Object(_)) => Some((path.to_owned(), "an object { .. }")),
        (Value::Object(_), Value::String(_)) => Some((path.to_owned(), "a string")),
        _ => None,
    }
}
