//! Correction: equations with slips of notation, put right where only one thing can be meant.
//!
//! Comes in: a text, and a reader that says where it does not understand. Goes out: the text with as few changes as the reader
//! needs to take the whole of it.

use super::foreign_notation::{self, bare_argument, is_indexed};
use super::text_change::{Change, argument, closing_bracket, end_before, is_of_name, name_before};
use cognate_systems::expression::function_name::{FunctionName, instead_of_function};
use cognate_systems::formats::FormatError;

/// Changes of one text at most.
const MOST_CHANGES: usize = 50;
/// Characters of a text that is corrected; each change reads it again.
const LONGEST: usize = 20_000;

/// Words of sentences, which are no factors.
const SENTENCE: [&str; 12] = [
    "solve", "find", "for", "and", "or", "not", "where", "with", "in", "if", "let", "mod",
];

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

/// The changes that may be meant, as whole texts, the likeliest first.
fn changes<'a>(chars: &'a [char], fault: &Fault) -> impl Iterator<Item = Vec<char>> + use<'a> {
    let listed = [
        foreign_notation::change(chars, fault.at, &fault.said),
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
    bare_argument(chars, at).map(|(to, argument)| Change {
        from,
        to,
        by: format!("{function}({argument})"),
    })
}

/// `2 x` and `x y` are products. A name before a bracket may be a function, and in `1/2 x` it is not clear what is divided.
fn product(chars: &[char], at: usize) -> Option<Change> {
    let next = *chars.get(at)?;
    let last = end_before(chars, at)?;
    let begins = is_of_name(next) || matches!(next, '(' | '∛' | '√');
    let ends = is_of_name(chars[last]) || chars[last] == ')';
    let named = name_before(chars, at).map(|(_, name)| name);
    let is_long = named.as_ref().is_some_and(|name| name.chars().count() > 1);
    let is_called = next == '(' && named.is_some() && (is_long || has_names_alone(chars, at));
    let words = [named.clone().unwrap_or_default(), word_at(chars, at)];
    let is_sentence = words.iter().any(|word| SENTENCE.contains(&&word[..]));
    let is_grouped = next.is_ascii_digit() && chars[last].is_ascii_digit();
    // `3√x` may be a cube root.
    let is_root = matches!(next, '∛' | '√') && chars[last].is_ascii_digit();
    let is_function = named.is_some_and(|name| {
        let is_called = FunctionName::of(&name.to_lowercase()).is_some();
        is_called || instead_of_function(&name).is_some()
    });
    let before = end_before(chars, operand_start(chars, last));
    let is_minus = |k: &usize| chars[*k] == '-';
    // The sign of an exponent stands behind the `^`.
    let raised = before.filter(is_minus).and_then(|k| end_before(chars, k));
    let is_power = raised.is_some_and(|k| chars[k] == '^');
    let is_unclear = is_power || before.is_some_and(|k| matches!(chars[k], '/' | '^'));
    (begins
        && ends
        && !is_called
        && !is_indexed(chars, at)
        && !is_number_of_equation(chars, last, at)
        && !is_root
        && !is_function
        && !is_unclear
        && !is_sentence
        && !is_grouped)
        .then(|| Change {
            from: last + 1,
            to: at,
            by: "*".to_owned(),
        })
}

/// Whether a whole number in brackets before an equation ends at `last`, or one begins at `at` behind an equation.
fn is_number_of_equation(chars: &[char], last: usize, at: usize) -> bool {
    let is_number = |from: usize, to: usize| {
        let inside = chars.get(from..to);
        inside.is_some_and(|inside| inside.iter().all(|c| c.is_ascii_digit()))
    };
    let open = operand_start(chars, last);
    let is_before = chars[last] == ')'
        && is_number(open + 1, last)
        && end_before(chars, open).is_none_or(|k| chars[k] == ';');
    let close = closing_bracket(chars, at).filter(|close| is_number(at + 1, *close));
    let rest = close.and_then(|close| chars[close + 1..].iter().find(|c| **c != ' '));
    let is_behind = close.is_some() && rest.is_none_or(|c| matches!(c, '\n' | ';' | ','));
    is_before || is_behind
}

/// The name that begins at a place.
fn word_at(chars: &[char], at: usize) -> String {
    argument(chars, at).map_or(String::new(), |(_, word)| word)
}

/// Whether a bracket holds names between commas and nothing else, as the arguments of a function.
fn has_names_alone(chars: &[char], at: usize) -> bool {
    let inside = closing_bracket(chars, at).map_or(&[][..], |end| &chars[at + 1..end]);
    let is_of_list = |c: &char| is_of_name(*c) || matches!(c, ',' | ' ');
    inside.iter().any(|c| c.is_alphabetic()) && inside.iter().all(is_of_list)
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

/// `[x + 1]` and `{x + 1}` are `(x + 1)`. With commas it is a list: of expressions where it is the whole text.
fn brackets(chars: &[char], at: usize) -> Option<Change> {
    if !matches!(chars.get(at)?, '[' | '{') {
        return None;
    }
    let is_index = end_before(chars, at).is_some_and(|k| is_of_name(chars[k]) || chars[k] == ')');
    let end = closing_bracket(chars, at)?;
    let inside: String = chars[at + 1..end].iter().collect();
    let is_exponent = end_before(chars, at).is_some_and(|k| chars[k] == '^');
    let is_number = inside.chars().all(|c| c.is_ascii_digit());
    if inside.contains(',') {
        let is_whole = at == 0 && chars[end + 1..].iter().all(|c| c.is_whitespace());
        let is_sum = |part: &str| part.contains(['+', '-', '*', '/', '^', '=']);
        return (is_whole && inside.split(',').all(is_sum)).then(|| Change {
            from: at,
            to: end + 1,
            by: inside,
        });
    }
    (!is_index).then(|| Change {
        from: at,
        to: end + 1,
        by: match is_exponent && is_number {
            true => inside,
            false => format!("({inside})"),
        },
    })
}

/// A bracket that nothing opens, and an operator that stands twice.
fn one_too_many(chars: &[char], at: usize) -> Option<Change> {
    let wrong = *chars.get(at)?;
    let is_twice =
        "*^+".contains(wrong) && end_before(chars, at).is_some_and(|k| chars[k] == wrong);
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
    let end = chars[at..].iter().position(|c| *c == '\n');
    let end = end.map_or(chars.len(), |length| at + length);
    let count = |bracket: char| chars[line..end].iter().filter(|c| **c == bracket).count();
    let last = end_before(chars, at)?;
    (count('(') > count(')')).then(|| Change {
        from: last + 1,
        to: last + 1,
        by: ")".to_owned(),
    })
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
            ("x √2 = 1", "x*√2 = 1"),
            ("cos(60 deg) = x", "cos(60*pi/180) = x"),
            ("cos(60deg) = x", "cos(60*pi/180) = x"),
            ("cos(60°) = x", "cos(60*pi/180) = x"),
            ("cos(x) = 0.5 rad", "cos(x) = 0.5"),
            ("sind(x) = 1/2", "sin(x*pi/180) = 1/2"),
            ("cosd(x + 1) = 1/2", "cos((x + 1)*pi/180) = 1/2"),
            ("sin^2(x) = 1/4", "sin(x)^2 = 1/4"),
            ("sin²(x) + cos^2(y) = 1/4", "sin(x)^2 + cos(y)^2 = 1/4"),
            ("sin^2 x = 1/4", "sin(x)^2 = 1/4"),
            ("tg(x) = 1", "tan(x) = 1"),
            ("pow(x, 2) = 4", "(x)^(2) = 4"),
            ("Eq(x**2, 4)", "x**2 = 4"),
            ("f(x) = x^2 - 1", "x^2 - 1 = 0"),
            ("x(x - 1) = 2", "x*(x - 1) = 2"),
            (r"\frac{x}{2} = \sqrt{2}", "((x)/(2)) = sqrt(2)"),
            (r"x \cdot y = 1", "x * y = 1"),
            ("x^{2} = 4", "x^2 = 4"),
            ("x_{1} = 2", "x_1 = 2"),
            ("|x| = 1", "abs(x) = 1"),
            ("|x| + |y - 1| = 1", "abs(x) + abs(y - 1) = 1"),
            ("x = 1,5", "x = 1.5"),
            ("x -> 2", "x = 2"),
            ("x^2 ≈ 2", "x^2 = 2"),
            ("eq1: x^2 = 4", "x^2 = 4"),
            ("1) x = 2\n2) y = x", "x = 2\ny = x"),
            ("x = ±2", "x^2 = 2^2"),
            ("x .* y = 2", "x * y = 2"),
            ("x = 1\nx =< 2", "x = 1\nx <= 2"),
            ("x^2 = 4 && x > 0", "x^2 = 4, x > 0"),
            ("x^2 = 4 and x > 0", "x^2 = 4, x > 0"),
            ("x = 1 and y = 2", "x = 1, y = 2"),
            ("x = 2 // a comment", "x = 2 # a comment"),
            ("x = 2 % a comment", "x = 2 # a comment"),
            ("x := 2", "x = 2"),
            ("log(x) = 2", "x = exp(2)"),
            ("ln(x + 1) = 2\ny = 1", "x + 1 = exp(2)\ny = 1"),
            ("log10(x) = 2", "x = 10^2"),
            ("exp(x) = 2", "x = log(2)"),
            ("e^x = 2", "x = log(2)"),
            ("2^x = 8", "x = log(8)/log(2)"),
            ("sin x = 1/2", "sin(x) = 1/2"),
            ("Sin(x) = 1/2", "sin(x) = 1/2"),
            ("cos 2x = 1/2", "cos(2x) = 1/2"),
            ("[x + 1]*2 = 4", "(x + 1)*2 = 4"),
            ("x = 0.(3)", "x = 1/3"),
            ("y = 2*0.1(6)^2", "y = 2*(1/6)^2"),
            ("x = 1\nminimize x^2 + y", "x = 1\nminimize: x^2 + y"),
            ("x^^2 = 3", "x^2 = 3"),
            ("(x + 1)*2) = 3", "(x + 1)*2 = 3"),
            (") x = 3", " x = 3"),
            ("(x + 1 = 3", "(x + 1) = 3"),
            ("x^(1/2 = 2", "x^(1/2) = 2"),
            ("x = sin 30°", "x = sin(30*pi/180)"),
            ("x = 3sin 30°", "x = 3sin(30*pi/180)"),
            ("sin x cos x = 1/4", "sin(x)*cos(x) = 1/4"),
            ("x = 3½", "x = (3+1/2)"),
            ("x = -2½", "x = -(2+1/2)"),
            ("y = x^3½", "y = x^(3+1/2)"),
            ("3½y = 7", "(3+1/2)y = 7"),
            ("x = 3 1/2", "x = (3+1/2)"),
            ("x = 50%", "x = 50/100"),
            (
                "x(1)^2 + x(2)^2 = 5\nx(1) = x(2)",
                "x1^2 + x2^2 = 5\nx1 = x2",
            ),
            (r"x^2=4 \\ y=x", "x^2=4 ,  y=x"),
            (
                r"\begin{cases} x &= 2 \\ y = x \end{cases}",
                " x = 2 ,  y = x ",
            ),
            ("$x^2 = 4$", "x^2 = 4"),
            ("$$x^2 = 4$$", "x^2 = 4"),
            ("Sin[x] == 1/2", "sin(x) == 1/2"),
            ("2 Sin[2 x] == 1", "2*sin(2*x) == 1"),
            ("x = ２", "x = 2"),
            ("x = 1,234.5", "x = 1234.5"),
            ("{x^2+y^2-5, x*y-2}", "x^2+y^2-5, x*y-2"),
            ("rπ = 1", "r*π = 1"),
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
            "x_{i + 1} = 2",
            "x^= 2",
            "x $ 2 = 1",
            "log(x) = y",
            "x! = 6",
            "f(x) = 1",
            "3√x = 2",
            "x = 1 000",
            "x // 2 = 1",
            "x = y // 2",
            "sin^-1(x) = 1",
            "x = 1\nsolve for x",
            "x^2 - 4 = 0 {x}",
            "x^2 = 4 (2)",
            "(2) x^2 = 4",
            "unknown: x = 2",
            "y = x^3 1/2",
            "x = {1,2}",
            "x = sqrt(8,3)",
            "S(1)/2*x = 1",
            "x(1) = 5",
            "x(1)y = 2, x(2) = y",
            "x^2 = 4 (2), y = 3",
            "x(1) + x(2) = x1",
            "sin x^2 = 1",
            "sin x² = 1",
            "sin x/2 = 1",
            "sin 2 x = 1",
            "y = √2x",
            "x = 12 345",
            "x = 1,234",
            "x = 2^50%",
        ];
        for typed in unclear {
            assert_eq!(of(typed), None, "{typed}");
        }
    }
}
