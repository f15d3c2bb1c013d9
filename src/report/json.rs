//! JSON text of reports: numbers to twelve digits, lists of numbers on one line, so that files are small
//! and do not change from run to run. What was put in, the block `case`, keeps all digits.

use serde_json::{Number, Value};

/// Significant digits of numbers in reports.
const DIGITS: usize = 12;
/// Column after which a list of plain values is broken.
const WIDTH: usize = 110;

/// Pretty JSON text of a report with a final line break.
pub fn text(value: &Value) -> String {
    let mut out = String::new();
    write(&mut out, value, 0, false);
    out.push('\n');
    out
}

/// Key of a report under which numbers keep all digits.
const EXACT: &str = "case";

fn write(out: &mut String, value: &Value, indent: usize, exact: bool) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            out.push('{');
            for (i, (key, item)) in map.iter().enumerate() {
                out.push_str(if i > 0 { ",\n" } else { "\n" });
                pad(out, indent + 2);
                out.push_str(&format!("{}: ", Value::String(key.clone())));
                write(out, item, indent + 2, exact || (indent == 0 && key == EXACT));
            }
            out.push('\n');
            pad(out, indent);
            out.push('}');
        }
        Value::Array(list) if list.iter().any(|v| v.is_object() || v.is_array()) => {
            out.push('[');
            for (i, item) in list.iter().enumerate() {
                out.push_str(if i > 0 { ",\n" } else { "\n" });
                pad(out, indent + 2);
                write(out, item, indent + 2, exact);
            }
            out.push('\n');
            pad(out, indent);
            out.push(']');
        }
        Value::Array(list) => {
            out.push('[');
            let mut column = indent;
            for (i, item) in list.iter().enumerate() {
                let item = plain(item, exact);
                if i > 0 {
                    out.push(',');
                    if column + item.len() + 2 > WIDTH {
                        out.push('\n');
                        pad(out, indent + 2);
                        column = indent + 2;
                    } else {
                        out.push(' ');
                    }
                }
                column += item.len() + 2;
                out.push_str(&item);
            }
            out.push(']');
        }
        other => out.push_str(&plain(other, exact)),
    }
}

fn pad(out: &mut String, indent: usize) {
    out.extend(std::iter::repeat_n(' ', indent));
}

fn plain(value: &Value, exact: bool) -> String {
    match value {
        Value::Number(n) if !exact => number(n),
        other => other.to_string(),
    }
}

fn number(n: &Number) -> String {
    match (n.as_u64(), n.as_i64(), n.as_f64()) {
        (None, None, Some(x)) => {
            let rounded: f64 = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x);
            Value::from(rounded).to_string()
        }
        _ => n.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn text_reads_back_and_is_rounded() {
        let value =
            json!({"a": [1.0, 0.1 + 0.2, null], "b": {"c": [], "d": [{"e": 1e-300}, "x\"y"]}, "n": 3});
        let text = text(&value);
        assert!(text.contains("0.3,") && !text.contains("0.30000000000000004"));
        let back: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back["b"]["d"], value["b"]["d"]);
        assert_eq!(back["a"][1], json!(0.3));
    }

    #[test]
    fn what_was_put_in_keeps_its_digits() {
        let x = 0.1 + 0.2;
        let text = text(&json!({ "case": { "nu": x, "list": [{ "x": [x] }] }, "results": { "case": x } }));
        assert_eq!(text.matches("0.30000000000000004").count(), 2, "{text}");
    }

    #[test]
    fn long_lists_are_broken() {
        let text = text(&json!((0..200).map(f64::from).collect::<Vec<_>>()));
        assert!(text.lines().all(|line| line.len() <= WIDTH + 1) && text.lines().count() > 5);
    }
}
