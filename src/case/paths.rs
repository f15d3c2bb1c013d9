//! Values by dotted path: reading, overriding, and how they are quoted in messages.

use crate::error::{Error, Result};
use serde_json::{Map, Value};

/// Most steps of a path to a value of the case: no key of a case stands as deep.
const MOST_STEPS: usize = 32;

/// The value at a dotted path.
pub(super) fn at<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').filter(|s| !s.is_empty()).try_fold(value, |value, step| match value {
        Value::Object(map) => map.get(step),
        Value::Array(list) => step.parse::<usize>().ok().and_then(|i| list.get(i)),
        _ => None,
    })
}

/// Puts a new value at a dotted path. Keys that are missing are made; whether they may exist at all is for
/// the types of [`Case`] to say.
pub(super) fn replace(value: &mut Value, path: &str, new: Value) -> Result<()> {
    let wrong = |step: &str, there: String| {
        Err(Error::Usage(format!(
            "override {}: there is no `{}` in the case; there {there}",
            shortened(path),
            shortened(step)
        )))
    };
    let mut place = value;
    let steps: Vec<&str> = path.split('.').take(MOST_STEPS + 1).collect();
    // values are read, compared and dropped level by level
    if steps.len() > MOST_STEPS {
        let count = path.split('.').count();
        return Err(Error::Usage(format!(
            "override {}: the path has {count} steps; a path has at most {MOST_STEPS}",
            shortened(path)
        )));
    }
    for (i, step) in steps.iter().enumerate() {
        let last = i + 1 == steps.len();
        place = match place {
            Value::Object(map) => map
                .entry(step.to_string())
                .or_insert_with(|| if last { Value::Null } else { Value::Object(Map::new()) }),
            Value::Array(list) => {
                let length = list.len();
                match step.parse::<usize>().ok().and_then(|i| list.get_mut(i)) {
                    Some(item) => item,
                    None => return wrong(step, format!("are {length} entries, numbered from 0")),
                }
            }
            other => return wrong(step, format!("is only the value {}", short(other))),
        };
    }
    *place = new;
    Ok(())
}

/// JSON text of a value, shortened.
pub(super) fn short(value: &Value) -> String {
    shortened(&value.to_string())
}

/// Text of at most 80 characters.
pub(super) fn shortened(text: &str) -> String {
    limited(text, 80)
}

/// A path or name as messages show it: whole, but for those that nobody means.
pub(crate) fn shown(path: &str) -> String {
    limited(path, 300)
}

fn limited(text: &str, most: usize) -> String {
    if text.chars().nth(most).is_none() {
        return text.to_owned();
    }
    text.chars().take(most - 3).collect::<String>() + "..."
}
