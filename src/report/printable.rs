//! Text that is safe to show: titles and names come from case files, and a terminal obeys what some characters say.

/// True for characters that steer a terminal or a reader instead of standing for themselves: control characters,
/// marks of the direction of writing, invisible spaces, and line ends of Unicode.
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{feff}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}')
}

fn escaped(text: &str, kept: impl Fn(char) -> bool) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if steers(c) && !kept(c) { out.extend(c.escape_unicode()) } else { out.push(c) }
    }
    out
}

/// One line of text: characters that steer are written as `\u{1b}`.
pub fn line(text: &str) -> String {
    escaped(text, |_| false)
}

/// Lines of text: as [`line()`], line ends and tabulators stay.
pub fn lines(text: &str) -> String {
    escaped(text, |c| matches!(c, '\n' | '\t'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_is_shown() {
        assert_eq!(line("a\u{1b}[31mb\nc"), "a\\u{1b}[31mb\\u{a}c");
        assert_eq!(lines("a\u{202e}b\nc\td"), "a\\u{202e}b\nc\td");
        assert_eq!(lines("\u{9b}31m \u{7f}\r"), "\\u{9b}31m \\u{7f}\\u{d}");
        let plain = "Läufer 転子 Ω = 3·10⁴ 1/min";
        assert_eq!(line(plain), plain);
    }
}
