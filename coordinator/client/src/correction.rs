//! Correction: equations with slips of notation, put right where only one thing can be meant.
//!
//! Comes in: a text, and a reader that says where it does not understand. Goes out: the text with as few changes as the reader
//! needs to take the whole of it.

use cognate_systems::expression::function_name::{FunctionName, instead_of_function};
use cognate_systems::expression::token::is_raised;
use cognate_systems::formats::FormatError;

/// Changes of one text at most.
const MOST_CHANGES: usize = 50;
/// Characters of a text that is corrected; each change reads it again.
const LONGEST: usize = 20_000;

/// The text put right; `None` where it is right, or where no change is the only one that can be meant.
pub fn corrected(text: &str, read: impl Fn(&str) -> Result<(), FormatError>) -> Option<String> {
    let mut chars: Vec<char> = text.chars().collect();
    if chars.len() > LONGEST {
        return None;
    }
    let fault = |chars: &[char]| {
        let error = read(&chars.iter().collect::<String>()).err()?;
        Some(Fault::of(&error, chars))
    };
    let mut open = fault(&chars)?;
    for _ in 0..MOST_CHANGES {
        let left = chars.len() - open.at;
        let (changed, next) = changes(&chars, &open).find_map(|changed| {
            let next = fault(&changed);
            let is_further = next.as_ref().is_none_or(|next| {
                let rest = changed.len() - next.at;
                rest < left || (rest == left && next.said != open.said)
            });
            is_further.then_some((changed, next))
        })?;
        match next {
            None => return Some(changed.into_iter().collect()),
            Some(next) => (chars, open) = (changed, next),
        }
    }
    None
}

/// A place in the text that a reader does not understand.
struct Fault {
    /// Number of characters before the fault.
    at: usize,
    /// Message of the reader.
    said: String,
}

impl Fault {
    fn of(error: &FormatError, chars: &[char]) -> Self {
        let lines = chars.split_inclusive(|c| *c == '\n');
        let before: usize = lines.take(error.place.line - 1).map(<[char]>::len).sum();
        Self {
            at: (before + error.place.column - 1).min(chars.len()),
            said: format!("expected {}, found {}", error.expected(), error.found()),
        }
    }

    /// The words in backquotes behind these words.
    fn quoted_after(&self, words: &str) -> Option<&str> {
        let (_, rest) = self.said.split_once(words)?;
        rest.split('`').nth(1)
    }
}

/// A part of a text that is replaced.
struct Change {
    from: usize,
    to: usize,
    by: String,
}

/// The changes that may be meant, as whole texts, the likeliest first.
fn changes<'a>(chars: &'a [char], fault: &Fault) -> impl Iterator<Item = Vec<char>> + use<'a> {
    let listed = [
        root(chars, fault.at),
        constant(chars, fault),
        function(chars, fault.at),
        product(chars, fault.at),
        brackets(chars, fault.at),
        one_too_many(chars, fault.at),
        closing(chars, fault.at),
    ];
    listed.into_iter().flatten().map(|change| {
        let mut text = chars[..change.from].to_vec();
        text.extend(change.by.chars());
        text.extend(&chars[change.to..]);
        text
    })
}

/// `√x` is `sqrt(x)`.
fn root(chars: &[char], at: usize) -> Option<Change> {
    if chars.get(at) != Some(&'√') {
        return None;
    }
    match chars.get(at + 1) {
        Some('(') => Some(Change {
            from: at,
            to: at + 1,
            by: "sqrt".to_owned(),
        }),
        _ => argument(chars, at + 1).map(|(to, argument)| Change {
            from: at,
            to,
            by: format!("sqrt({argument})"),
        }),
    }
}

/// Names of constants: `i` is `I`.
fn constant(chars: &[char], fault: &Fault) -> Option<Change> {
    let is_meant = fault.said.contains("` for the ");
    let by = fault.quoted_after("expected ").filter(|_| is_meant)?;
    let length = chars[fault.at..]
        .iter()
        .take_while(|c| is_of_name(**c))
        .count();
    (length > 0).then(|| Change {
        from: fault.at,
        to: fault.at + length,
        by: by.to_owned(),
    })
}

/// `Sin(x)` and `sin x` are `sin(x)`.
fn function(chars: &[char], at: usize) -> Option<Change> {
    let (from, name) = name_before(chars, at)?;
    let function = name.to_lowercase();
    FunctionName::of(&function)?;
    if chars.get(at) == Some(&'(') {
        return (name != function).then_some(Change {
            from,
            to: at,
            by: function,
        });
    }
    argument(chars, at).map(|(to, argument)| Change {
        from,
        to,
        by: format!("{function}({argument})"),
    })
}

/// `2 x` and `x y` are products. A name before a bracket may be a function, and in `1/2 x` it is not clear what is divided.
fn product(chars: &[char], at: usize) -> Option<Change> {
    let next = *chars.get(at)?;
    let last = end_before(chars, at)?;
    let begins = is_of_name(next) || next == '(';
    let ends = is_of_name(chars[last]) || chars[last] == ')';
    let named = name_before(chars, at).map(|(_, name)| name);
    let is_called = next == '(' && named.as_ref().is_some_and(|name| name.chars().count() > 1);
    let is_function = named.is_some_and(|name| instead_of_function(&name).is_some());
    let before = end_before(chars, operand_start(chars, last)).map(|k| chars[k]);
    let is_unclear = matches!(before, Some('/' | '^'));
    (begins && ends && !is_called && !is_function && !is_unclear).then(|| Change {
        from: last + 1,
        to: at,
        by: "*".to_owned(),
    })
}

/// Where the number, the name or the bracket begins whose last character is at this place.
fn operand_start(chars: &[char], last: usize) -> usize {
    let mut depth = 0_usize;
    let outside = chars[..=last].iter().rposition(|&c| match c {
        ')' => {
            depth += 1;
            false
        }
        '(' => {
            depth = depth.saturating_sub(1);
            false
        }
        _ => depth == 0 && !is_of_name(c) && c != '.',
    });
    outside.map_or(0, |k| k + 1)
}

/// `[x + 1]` and `{x + 1}` are `(x + 1)`.
fn brackets(chars: &[char], at: usize) -> Option<Change> {
    let opening = *chars.get(at)?;
    let closing = match opening {
        '[' => ']',
        '{' => '}',
        _ => return None,
    };
    let is_index = at > 0 && is_of_name(chars[at - 1]);
    let mut depth = 0_usize;
    let end = chars[at..].iter().position(|c| {
        depth += usize::from(*c == opening);
        depth -= usize::from(*c == closing);
        depth == 0
    })?;
    let inside: String = chars[at + 1..at + end].iter().collect();
    (!is_index).then(|| Change {
        from: at,
        to: at + end + 1,
        by: format!("({inside})"),
    })
}

/// A bracket that nothing opens, and an operator that stands twice.
fn one_too_many(chars: &[char], at: usize) -> Option<Change> {
    let wrong = *chars.get(at)?;
    let is_twice =
        "*/^+".contains(wrong) && end_before(chars, at).is_some_and(|k| chars[k] == wrong);
    (wrong == ')' || is_twice).then(|| Change {
        from: at,
        to: at + 1,
        by: String::new(),
    })
}

/// A bracket that nothing closes ends where it has to.
fn closing(chars: &[char], at: usize) -> Option<Change> {
    let line = chars[..at]
        .iter()
        .rposition(|c| *c == '\n')
        .map_or(0, |k| k + 1);
    let count = |bracket: char| chars[line..at].iter().filter(|c| **c == bracket).count();
    let last = end_before(chars, at)?;
    (count('(') > count(')')).then(|| Change {
        from: last + 1,
        to: last + 1,
        by: ")".to_owned(),
    })
}

/// Whether a name or a number has this character.
fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() && !is_raised(c) || c == '_'
}

/// The place of the last character before this place that is no blank, on the same line.
fn end_before(chars: &[char], at: usize) -> Option<usize> {
    let last = chars[..at].iter().rposition(|c| *c != ' ' && *c != '\t')?;
    (chars[last] != '\n').then_some(last)
}

/// The name that ends before this place, and where it begins.
fn name_before(chars: &[char], at: usize) -> Option<(usize, String)> {
    let last = end_before(chars, at)?;
    let before = chars[..=last].iter().rposition(|c| !is_of_name(*c));
    let from = before.map_or(0, |k| k + 1);
    let name: String = chars[from..=last].iter().collect();
    let is_name = name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    is_name.then_some((from, name))
}

/// The name or number that begins here, and its end.
fn argument(chars: &[char], at: usize) -> Option<(usize, String)> {
    let argument: String = chars[at..].iter().take_while(|c| is_of_name(**c)).collect();
    let length = argument.chars().count();
    (length > 0).then_some((at + length, argument))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats::plain;

    fn of(text: &str) -> Option<String> {
        corrected(text, |text| plain::typed("-e", text).map(drop))
    }

    #[test]
    fn slips_of_notation_are_put_right() {
        let slips = [
            ("2 x = 1", "2*x = 1"),
            ("3 x y = 1\nx = y", "3*x*y = 1\nx = y"),
            ("(x + 1) (x - 1) = 0", "(x + 1)*(x - 1) = 0"),
            ("1/2 + (x - 1) x = 0", "1/2 + (x - 1)*x = 0"),
            ("5 (x + 1) = 2", "5*(x + 1) = 2"),
            ("3 x² + 2x = 1", "3*x² + 2x = 1"),
            ("x^2 = -1*i", "x^2 = -1*I"),
            ("√x = 2", "sqrt(x) = 2"),
            ("√(x + 1) = 2", "sqrt(x + 1) = 2"),
            ("sin x = 1/2", "sin(x) = 1/2"),
            ("Sin(x) = 1/2", "sin(x) = 1/2"),
            ("cos 2x = 1/2", "cos(2x) = 1/2"),
            ("[x + 1]*2 = 4", "(x + 1)*2 = 4"),
            ("x^^2 = 3", "x^2 = 3"),
            ("(x + 1)*2) = 3", "(x + 1)*2 = 3"),
            ("(x + 1 = 3", "(x + 1) = 3"),
            ("x^(1/2 = 2", "x^(1/2) = 2"),
        ];
        for (typed, meant) in slips {
            assert_eq!(of(typed).as_deref(), Some(meant), "{typed}");
        }
    }

    #[test]
    fn nothing_is_guessed() {
        let unclear = [
            "x = 2",
            "x^2 + = 1",
            "1/2x = 1",
            "1/2 x = 1",
            "1/(x + 1) y = 1",
            "2^3 x = 1",
            "sinh(x) = 1",
            "sinh x = 1",
            "asin x = a",
            "x_{1} = 2",
            "e^x = 1",
            "x $ 2 = 1",
            "log(x) = 2",
            "|x| = 1",
        ];
        for typed in unclear {
            assert_eq!(of(typed), None, "{typed}");
        }
    }
}
