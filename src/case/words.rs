//! What the readers of JSON and of cases say, in the words of a case file.

use crate::case::paths::{at, short, shown};
use crate::error::{Error, Refusal};
use serde_json::Value;

/// Turns serde's words into path, value and remedy.
pub(super) fn input_error(file: &str, value: &Value, path: &str, message: &str) -> Error {
    let mut path = path.replace('[', ".").replace(']', "");
    let input = |path: String, found: String, problem: String, allowed: String| {
        let path = if path.is_empty() { "(top level)".to_owned() } else { shown(&path) };
        Error::Refused(Refusal { file: Some(file.to_owned()), path, found: Some(found), problem, allowed })
    };
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if let (true, Some((key, known))) = (message.starts_with("unknown field"), quoted.split_first()) {
        if path.rsplit('.').next() != Some(key) {
            path = if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
        }
        let near = nearest(key, known).map(|k| format!(", did you mean \"{k}\"?")).unwrap_or_default();
        let found = at(value, &path).map_or_else(|| format!("\"{key}\""), short);
        return input(path, found, format!("unknown key \"{}\"{near}", shown(key)), known.join(", "));
    }
    let found = at(value, &path).map_or("missing".to_owned(), short);
    if let (true, Some((word, known))) = (message.starts_with("unknown variant"), quoted.split_first()) {
        let near = nearest(word, known).map(|k| format!(", did you mean \"{k}\"?")).unwrap_or_default();
        return input(path, found, format!("unknown word \"{}\"{near}", shown(word)), known.join(", "));
    }
    if let (true, Some(key)) = (message.starts_with("missing field"), quoted.first()) {
        return input(
            path,
            found,
            format!("the key \"{key}\" is missing"),
            format!("add \"{key}\" (see `rotor schema`)"),
        );
    }
    if let Some((problem, allowed)) = message.split_once(", expected ") {
        return input(path, found, found_words(problem), expected_words(allowed));
    }
    let (problem, allowed) = message.split_once("; ").unwrap_or((message, "see `rotor schema`"));
    input(path, found, problem.to_owned(), allowed.to_owned())
}

/// "invalid type: map" in plain words.
fn found_words(problem: &str) -> String {
    let quoted = || problem.split('`').nth(1).unwrap_or_default();
    match problem.split_once(": ").unwrap_or((problem, "")) {
        (_, "map") => "an object { .. } does not belong here".to_owned(),
        (_, "sequence") => "a list [ .. ] does not belong here".to_owned(),
        (_, "null" | "unit value" | "Option value") => "null is no value for this".to_owned(),
        (_, text) if text.starts_with("string") => "a text in quotes does not belong here".to_owned(),
        (_, text) if text.starts_with("boolean") => format!("the word {} does not belong here", quoted()),
        (_, text) if text.starts_with("integer") || text.starts_with("floating") => {
            format!("the number {} does not fit", quoted())
        }
        (text, _) if text.starts_with("invalid length ") => {
            let count = text.trim_start_matches("invalid length ");
            format!("the list has {count} {}", if count == "1" { "entry" } else { "entries" })
        }
        _ => problem.to_owned(),
    }
}

/// "struct Shaft" in plain words.
fn expected_words(allowed: &str) -> String {
    match allowed {
        "f64" => "a number".to_owned(),
        "u32" | "u64" | "usize" => "a whole number, 0 or more".to_owned(),
        "a string" | "string or map" | "variant identifier" => "a text in quotes".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a sequence" => "a list [ .. ]".to_owned(),
        "a map" => "an object { .. }".to_owned(),
        text if text.starts_with("struct ") => "an object { .. }".to_owned(),
        text => match text.strip_prefix("an array of length ") {
            Some(count) => format!("a list of {count} entries"),
            None => text.to_owned(),
        },
    }
}

/// What the reader of JSON says, in plain words.
pub(super) fn syntax_words(message: &str) -> String {
    let message = message.split(" at line ").next().unwrap_or_default();
    let plain = match message {
        "key must be a string" => {
            "a key in quotes is missing: a comma stands before `}`, or the key has no quotes"
        }
        "trailing comma" => "a comma stands before the closing bracket",
        "expected value" => "a value is missing or is none: texts need quotes, numbers begin with a digit",
        "expected `,` or `}`" => "a comma or `}` is missing before this",
        "expected `,` or `]`" => "a comma or `]` is missing before this",
        "expected `:`" => "a colon is missing after the key",
        "trailing characters" => "something follows the end of the case",
        "invalid number" => "this is no number as JSON writes it: 0.5, -3, 1e-3",
        "number out of range" => "the number is too large",
        "invalid escape" => "a text holds a backslash that begins nothing known: write \\\\",
        "recursion limit exceeded" => "brackets are nested too deeply: at most 127 levels",
        "expected ident" => "a word without quotes: only true, false and null have none",
        text if text.starts_with("EOF while parsing") => "the file ends before a bracket or quote is closed",
        text if text.starts_with("control character") => {
            "a text holds a line end or another control character: close the quote, or write \\n"
        }
        text if text.contains("hex escape") || text.contains("unicode code point") => {
            "a text holds a \\u that is not followed by the code of a character"
        }
        text => text,
    };
    plain.to_owned()
}

/// The candidate that was probably meant.
pub fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let best = candidates.iter().map(|c| (strsim::damerau_levenshtein(word, c), *c)).min()?;
    (best.0 <= 1 + word.chars().count() / 4).then_some(best.1)
}
