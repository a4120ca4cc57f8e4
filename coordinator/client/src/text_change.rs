//! Text change: a part of a text that is replaced, and the words around a place in a text.

use cognate_systems::expression::token::is_raised;

/// A part of a text that is replaced.
pub struct Change {
    /// First character.
    pub from: usize,
    /// Character behind the last one.
    pub to: usize,
    /// Text that takes the place.
    pub by: String,
}

/// Whether a name or a number has this character.
pub fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() && !is_raised(c) || c == '_'
}

/// The place of the last character before this place that is no blank, on the same line.
pub fn end_before(chars: &[char], at: usize) -> Option<usize> {
    let last = chars[..at].iter().rposition(|c| *c != ' ' && *c != '\t')?;
    (chars[last] != '\n').then_some(last)
}

/// The name that ends before this place, and where it begins; behind the digits of a factor such as the 2 of `2x`.
pub fn name_before(chars: &[char], at: usize) -> Option<(usize, String)> {
    let last = end_before(chars, at)?;
    let before = chars[..=last].iter().rposition(|c| !is_of_name(*c));
    let start = before.map_or(0, |k| k + 1);
    let digits = chars[start..=last]
        .iter()
        .take_while(|c| c.is_ascii_digit());
    let from = start + digits.count();
    let name: String = chars[from..=last].iter().collect();
    let is_name = name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    is_name.then_some((from, name))
}

/// The name or number that begins here, and its end.
pub fn argument(chars: &[char], at: usize) -> Option<(usize, String)> {
    let argument: String = chars[at..].iter().take_while(|c| is_of_name(**c)).collect();
    let length = argument.chars().count();
    (length > 0).then_some((at + length, argument))
}

/// The place of the bracket that closes the one at this place, on the same line.
pub fn closing_bracket(chars: &[char], at: usize) -> Option<usize> {
    let opening = *chars.get(at)?;
    let closing = match opening {
        '(' => ')',
        '[' => ']',
        '{' => '}',
        _ => return None,
    };
    let mut depth = 0_usize;
    for (k, c) in chars.iter().enumerate().skip(at) {
        depth += usize::from(*c == opening);
        depth -= usize::from(*c == closing);
        if depth == 0 {
            return Some(k);
        }
        if *c == '\n' {
            return None;
        }
    }
    None
}

/// The text between two places.
pub fn between(chars: &[char], from: usize, to: usize) -> String {
    chars[from..to].iter().collect()
}

/// An equation between the ends of its line, or `;`.
pub struct Statement {
    /// First character.
    pub from: usize,
    /// Character behind the last one.
    pub to: usize,
    /// Text before the only `=`.
    pub left: String,
    /// Text behind it.
    pub right: String,
}

/// The equation around a place; `None` where there is no `=` in it, or several.
pub fn statement(chars: &[char], at: usize) -> Option<Statement> {
    let is_end = |c: &char| matches!(c, '\n' | ';');
    let at = at.min(chars.len());
    let from = chars[..at].iter().rposition(is_end).map_or(0, |k| k + 1);
    let length = chars[from..].iter().position(is_end);
    let to = length.map_or(chars.len(), |length| from + length);
    let text = between(chars, from, to);
    let (left, right) = text.split_once('=')?;
    (!right.contains('=')).then(|| Statement {
        from,
        to,
        left: left.trim().to_owned(),
        right: right.trim().to_owned(),
    })
}
