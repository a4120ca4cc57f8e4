//! Visible: texts of somebody else as they may be shown.

/// A text of somebody else with its control characters written out: what is shown in a terminal or a log
/// neither moves the cursor nor forges lines.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        // Characters that turn the direction of what follows hide as well as others.
        let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        match c.is_control() || turns {
            true => shown.extend(c.escape_default()),
            false => shown.push(c),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_moves_no_cursor() {
        let evil = "a\u{1b}]0;owned\u{7}\nb\u{202e}c \u{e4}";
        assert_eq!(visible(evil), "a\\u{1b}]0;owned\\u{7}\\nb\\u{202e}c \u{e4}");
    }
}
