//! Words and numbers as a figure shows them, and the room they take. Text cannot be measured without fonts, so widths are estimated on the
//! generous side.

/// Which end of a line of text stands at its place, or its centre.
pub use plotters::style::text_anchor::HPos as Anchor;
/// Bold letters are about this much wider than regular ones.
pub const BOLD_WIDER: f64 = 1.12;

/// Estimated width of a text, on the generous side for common sans-serif fonts.
pub fn text_width(text: &str, size: f64) -> f64 {
    text.chars().map(character_width).sum::<f64>() * size
}

/// Widths in em after DejaVu Sans, one of the widest fonts that stand in for "sans-serif".
fn character_width(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '\'' => 0.28,
        ' ' | ',' | '.' | ';' | ':' | '|' | '/' | '!' | 'I' | '-' => 0.35,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '"' => 0.42,
        'm' | '…' | '%' | '@' => 1.0,
        'w' | '+' | '=' | '<' | '>' | '~' | '×' | '–' | '#' => 0.84,
        'W' => 1.0,
        'A'..='Z' | '&' => 0.78,
        '\u{0}'..='\u{7f}' => 0.64,
        '⁰'..='⁹' | '⁻' | '¹' | '²' | '³' | '·' => 0.45,
        '\u{80}'..='\u{2e7f}' => 0.8,
        _ => 1.05,
    }
}

/// The text itself if it fits, else its beginning with an ellipsis.
pub fn shorten(text: &str, size: f64, width: f64) -> String {
    let text = printable(text);
    if text_width(&text, size) <= width {
        return text;
    }
    let mut kept = String::new();
    let mut used = text_width("…", size);
    for character in text.chars() {
        used += character_width(character) * size;
        if used > width {
            break;
        }
        kept.push(character);
    }
    format!("{}…", kept.trim_end())
}

/// Breaks a text at spaces into at most `rows` lines; what does not fit ends in an ellipsis.
pub fn wrap(text: &str, size: f64, width: f64, rows: usize) -> Vec<String> {
    let text = printable(text);
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    let mut words = text.split_whitespace().peekable();
    while let Some(&word) = words.peek() {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if text_width(&longer, size) <= width {
            line = longer;
            words.next();
        } else if lines.len() + 1 >= rows {
            break;
        } else if line.is_empty() {
            lines.push(shorten(word, size, width));
            words.next();
        } else {
            lines.push(std::mem::take(&mut line));
        }
    }
    let rest: Vec<&str> = words.collect();
    if !rest.is_empty() {
        line = shorten(&format!("{line} {}", rest.join(" ")), size, width);
    }
    if !line.trim().is_empty() && rows > 0 {
        lines.push(line.trim_start().to_owned());
    }
    lines
}

/// The text without characters that XML forbids or that would break a line.
pub fn printable(text: &str) -> String {
    let allowed = |c: char| !c.is_control() && c != '\u{fffe}' && c != '\u{ffff}';
    text.chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}

/// A number with this many significant digits; a dash if it is not finite.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    // The rounded number decides on the decimals: 9.99996 has one digit less behind the point than 9.99994.
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent = rounded.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()).unwrap_or(0);
    if (-4..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        rounded
    }
}

/// A quantity with its unit and, if needed, a power of ten: "Spin speed (10³ rpm)".
pub fn axis_label(quantity: &str, unit: &str, exponent: i32) -> String {
    match exponent {
        0 => format!("{quantity} ({unit})"),
        _ => format!("{quantity} (10{} {unit})", superscript(exponent)),
    }
}

/// A power in raised digits.
pub fn superscript(exponent: i32) -> String {
    let raised = |character| match character {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn wrapped_lines_fit(text in ".{0,200}", width in 40.0..400.0f64, rows in 1..4usize) {
            let lines = wrap(&text, 10.0, width, rows);
            prop_assert!(lines.len() <= rows);
            prop_assert!(lines.iter().all(|line| text_width(line, 10.0) <= width + 1e-9), "{lines:?}");
        }
    }

    #[test]
    fn numbers_have_the_digits_asked_for() {
        let written =
            [0.0, 620.1, 9.99996, 123456.7, 1.5e9, 2e-7, -3.25, f64::NAN].map(|v| significant(v, 5));
        assert_eq!(written, ["0", "620.10", "10.000", "123457", "1.5000e9", "2.0000e-7", "-3.2500", "–"]);
    }
}
