//! Foreign notation: signs of print and words of other programs, written as our equations are.
//!
//! Comes in: a text, and a place that its reader does not understand. Goes out: the change that can be meant there.

use super::text_change::{
    Change, Statement, argument, between, closing_bracket, end_before, is_of_name, name_before,
    statement,
};
use cognate_systems::expression::function_name::{FunctionName, of_degrees};
use cognate_systems::expression::token::{is_raised, lowered};
use cognate_systems::objective::Goal;

/// A degree as a factor.
const DEGREE: &str = "*pi/180";

/// The change of a notation at a place; `said` is the message of the reader.
pub fn change(chars: &[char], at: usize, said: &str) -> Option<Change> {
    repeating_decimal(chars, at, said)
        .or_else(|| label(chars, at))
        .or_else(|| heading(chars, at))
        .or_else(|| degrees(chars, at))
        .or_else(|| mixed_number(chars, at, said))
        .or_else(|| percent(chars, at))
        .or_else(|| wide_digit(chars, at))
        .or_else(|| square_brackets(chars, at))
        .or_else(|| indices(chars, at))
        .or_else(|| function_of_degrees(chars, at))
        .or_else(|| function_of_others(chars, at))
        .or_else(|| raised_function(chars, at))
        .or_else(|| latex(chars, at))
        .or_else(|| absolute_value(chars, at))
        .or_else(|| sign(chars, at))
        .or_else(|| plus_or_minus(chars, at))
        .or_else(|| comment(chars, at))
        .or_else(|| subscript(chars, at))
        .or_else(|| declared_function(chars, at))
        .or_else(|| definition(chars, said))
        .or_else(|| exponential(chars, at, said))
}

fn replaced(from: usize, to: usize, by: &str) -> Option<Change> {
    let by = by.to_owned();
    Some(Change { from, to, by })
}

/// `0.(3)` is `1/3`; the message has the number.
fn repeating_decimal(chars: &[char], at: usize, said: &str) -> Option<Change> {
    let (_, number) = said.split_once("expected `")?;
    let (number, _) = number.split_once("` for a repeating decimal")?;
    let is_of_decimal = |c: &char| c.is_ascii_digit() || *c == '.';
    let before = chars[..at].iter().rposition(|c| !is_of_decimal(c));
    let from = before.map_or(0, |k| k + 1);
    let end = closing_bracket(chars, at)? + 1;
    let is_apart = |c: &char| " =+-,;()\n".contains(*c);
    let neighbours = [before.map(|k| &chars[k]), chars.get(end)];
    if neighbours.into_iter().flatten().all(is_apart) {
        replaced(from, end, number)
    } else {
        replaced(from, end, &format!("({number})"))
    }
}

/// `eq1: x = 2` and `1) x = 2` at the beginning of a line are `x = 2`.
fn label(chars: &[char], at: usize) -> Option<Change> {
    let line = chars[..at].iter().rposition(|c| *c == '\n');
    let from = line.map_or(0, |k| k + 1);
    let length = chars[from..].iter().take_while(|c| is_of_name(**c)).count();
    let end = from + length;
    let name: String = chars[from..end].iter().collect();
    let is_number = name.ends_with(|c: char| c.is_ascii_digit());
    let is_label = match chars.get(end)? {
        ')' => length > 0 && name.chars().all(|c| c.is_ascii_digit()),
        ':' => chars.get(end + 1) != Some(&'=') && (is_number || name.starts_with("eq")),
        _ => false,
    };
    (is_label && at <= end).then_some(())?;
    let blanks = chars[end + 1..].iter().take_while(|c| **c == ' ').count();
    replaced(from, end + 1 + blanks, "")
}

/// `minimize x^2` at the beginning of a line is `minimize: x^2`.
fn heading(chars: &[char], at: usize) -> Option<Change> {
    let (from, name) = name_before(chars, at)?;
    let line = chars[..from].iter().rposition(|c| matches!(c, '\n' | ';'));
    let is_first = chars[line.map_or(0, |k| k + 1)..from]
        .iter()
        .all(|c| c.is_whitespace());
    let is_apart = chars[at - 1].is_whitespace();
    let is_goal = Goal::ALL.into_iter().any(|goal| goal.name() == name);
    (is_goal && is_first && is_apart).then_some(())?;
    replaced(end_before(chars, at)? + 1, at, ": ")
}

/// `60°` and `60 deg` are `60*pi/180`; radians are numbers.
fn degrees(chars: &[char], at: usize) -> Option<Change> {
    let name = argument(chars, at).map(|(_, name)| name);
    let (length, by) = match (chars.get(at)?, name.unwrap_or_default().as_str()) {
        ('°', _) => (1, DEGREE),
        (_, name @ ("deg" | "degree" | "degrees")) => (name.len(), DEGREE),
        (_, name @ ("rad" | "radian" | "radians")) => (name.len(), ""),
        _ => return None,
    };
    let last = end_before(chars, at)?;
    let is_operand = is_of_name(chars[last]) || matches!(chars[last], ')' | '.');
    is_operand.then_some(())?;
    replaced(last + 1, at + length, by)
}

/// `3½` and `3 1/2` are `(3+1/2)`; the message has the number.
fn mixed_number(chars: &[char], at: usize, said: &str) -> Option<Change> {
    let (_, number) = said.split_once("expected `(")?;
    let (number, _) = number.split_once(")` for a mixed number")?;
    let last = end_before(chars, at)?;
    let before = chars[..=last].iter().rposition(|c| !c.is_ascii_digit());
    let is_of_fraction = |c: &&char| c.is_ascii_digit() || **c == '/';
    let length = chars[at..].iter().take_while(is_of_fraction).count();
    // The `1/2` of `x^3 1/2` may be a factor.
    let is_apart = last + 1 < at;
    let is_power = before.is_some_and(|k| chars[k] == '^');
    (!is_apart || !is_power).then_some(())?;
    replaced(
        before.map_or(0, |k| k + 1),
        at + length.max(1),
        &format!("({number})"),
    )
}

/// `50%` is `50/100` at the end of a term.
fn percent(chars: &[char], at: usize) -> Option<Change> {
    let is_percent = *chars.get(at)? == '%' && at > 0 && chars[at - 1].is_ascii_digit();
    let next = chars[at + 1..].iter().find(|c| **c != ' ');
    let is_end = next.is_none_or(|c| "\n+-=,;)".contains(*c));
    let is_of_number = |c: &char| c.is_ascii_digit() || *c == '.';
    let before = chars[..at].iter().rposition(|c| !is_of_number(c));
    let sign = before.and_then(|k| end_before(chars, k + 1));
    let is_divided = sign.is_some_and(|k| matches!(chars[k], '/' | '^'));
    (is_percent && is_end && !is_divided).then_some(())?;
    replaced(at, at + 1, "/100")
}

/// A digit as wide as an ideograph is the digit.
fn wide_digit(chars: &[char], at: usize) -> Option<Change> {
    let digit = (*chars.get(at)? as u32).checked_sub('０' as u32)?;
    let digit = char::from_digit(digit, 10)?;
    replaced(at, at + 1, &digit.to_string())
}

/// `Sin[x]` is `sin(x)`; the place is that of the name or of the bracket.
fn square_brackets(chars: &[char], at: usize) -> Option<Change> {
    let open = argument(chars, at).map_or(at, |(end, _)| end);
    let end = closing_bracket(chars, open).filter(|_| chars[open] == '[')?;
    let (from, name) = name_before(chars, open)?;
    let function = FunctionName::called(&name.to_lowercase())?.text();
    let inside = between(chars, open + 1, end);
    replaced(from, end + 1, &format!("{function}({inside})"))
}

/// The whole number in brackets that begins here, as an index has them in MATLAB, and the place behind it.
fn index(chars: &[char], at: usize) -> Option<(usize, String)> {
    let end = closing_bracket(chars, at).filter(|_| chars[at] == '(')?;
    let inside = between(chars, at + 1, end);
    let is_index = !inside.is_empty() && inside.chars().all(|c| c.is_ascii_digit());
    is_index.then_some((end + 1, inside))
}

/// Whether a name stands before a whole number in brackets: an index, an exact number or a product.
pub fn is_indexed(chars: &[char], at: usize) -> bool {
    name_before(chars, at).is_some() && index(chars, at).is_some()
}

/// `x(1)` and `x(2)` in one text are `x1` and `x2`, all of them in one change. `S(1)` is an exact number of SymPy.
fn indices(chars: &[char], at: usize) -> Option<Change> {
    index(chars, at)?;
    let (first, name) = name_before(chars, at).filter(|(_, name)| name != "S")?;
    let mut by = String::new();
    let (mut written, mut numbers) = (first, Vec::new());
    for open in at..chars.len() {
        let Some((from, (end, number))) = name_before(chars, open)
            .filter(|(from, other)| *other == name && *from >= written)
            .and_then(|(from, _)| Some((from, index(chars, open)?)))
        else {
            continue;
        };
        by += &format!("{}{name}{number}", between(chars, written, from));
        let touches = |c: &char| is_of_name(*c) || *c == '(';
        if chars.get(end).is_some_and(touches) {
            return None;
        }
        written = end;
        numbers.push(number);
    }
    let text: String = chars.iter().collect();
    let is_free = |number: &String| {
        let indexed = format!("{name}{number}");
        !text
            .split(|c: char| !is_of_name(c))
            .any(|word| word == indexed)
    };
    let is_several = numbers.iter().any(|number| *number != numbers[0]);
    (is_several && numbers.iter().all(is_free)).then_some(())?;
    replaced(first, written, &by)
}

/// `tg(x)` is `tan(x)`, `pow(x, 2)` is `(x)^(2)`, and `Eq(x, 2)` is `x = 2`.
fn function_of_others(chars: &[char], at: usize) -> Option<Change> {
    let end = closing_bracket(chars, at).filter(|_| chars[at] == '(')?;
    let (from, name) = name_before(chars, at)?;
    let inside = between(chars, at + 1, end);
    let pair = inside.rsplit_once(',').filter(|(a, b)| {
        let is_whole = |text: &str| text.matches('(').count() == text.matches(')').count();
        is_whole(a) && is_whole(b)
    });
    let by = match (&name[..], pair) {
        ("tg", _) => format!("tan({inside})"),
        ("ctg" | "cotan", _) => format!("cot({inside})"),
        ("sen", _) => format!("sin({inside})"),
        ("sqr", None) => format!("({inside})^2"),
        ("pow" | "power", Some((base, exponent))) => format!("({base})^({})", exponent.trim()),
        ("Eq" | "eq", Some((left, right))) => format!("{left} = {}", right.trim()),
        _ => return None,
    };
    replaced(from, end + 1, &by)
}

/// `sind(x)` is `sin(x*pi/180)`.
fn function_of_degrees(chars: &[char], at: usize) -> Option<Change> {
    let end = closing_bracket(chars, at)?;
    let (from, name) = name_before(chars, at)?;
    let function = of_degrees(&name)?;
    let inside = operand(&between(chars, at + 1, end));
    replaced(from, end + 1, &format!("{function}({inside}{DEGREE})"))
}

/// `sin^2(x)` and `sin²(x)` are `sin(x)^2`. An exponent of -1 may be an inverse function.
fn raised_function(chars: &[char], at: usize) -> Option<Change> {
    let (end, inside) = match closing_bracket(chars, at) {
        Some(end) => (end + 1, between(chars, at + 1, end)),
        None => bare_argument(chars, at)?,
    };
    let last = end_before(chars, at)?;
    let is_of_exponent = |c: &char| c.is_ascii_digit() || is_raised(*c);
    let before = chars[..=last].iter().rposition(|c| !is_of_exponent(c))?;
    let exponent = between(chars, before + 1, last + 1);
    let (exponent, name_end) = match (exponent.chars().all(is_raised), chars[before]) {
        _ if exponent.is_empty() => return None,
        (true, _) => (lowered(&exponent), before + 1),
        (false, '^') => (exponent, before),
        _ => return None,
    };
    let (from, name) = name_before(chars, name_end)?;
    FunctionName::of(&name)?;
    replaced(from, end, &format!("{name}({inside})^{exponent}"))
}

/// `\frac{a}{b}` is `((a)/(b))`, and `\sqrt{x}` is `sqrt(x)`.
fn latex(chars: &[char], at: usize) -> Option<Change> {
    if *chars.get(at)? != '\\' {
        return None;
    }
    let length = chars[at + 1..]
        .iter()
        .take_while(|c| c.is_ascii_alphabetic());
    let end = at + 1 + length.count();
    let word = between(chars, at + 1, end);
    let braces = |at: usize| {
        let is_brace = chars.get(at) == Some(&'{');
        let end = closing_bracket(chars, at).filter(|_| is_brace)?;
        Some((between(chars, at + 1, end), end + 1))
    };
    match &word[..] {
        "frac" | "dfrac" | "tfrac" => {
            let (above, end) = braces(end)?;
            let (below, end) = braces(end)?;
            replaced(at, end, &format!("(({above})/({below}))"))
        }
        "sqrt" => {
            let (inside, end) = braces(end)?;
            replaced(at, end, &format!("sqrt({inside})"))
        }
        "cdot" | "times" => replaced(at, end, "*"),
        "left" | "right" => replaced(at, end, ""),
        "begin" | "end" => {
            let (_, end) = braces(end)?;
            replaced(at, end, "")
        }
        "" if chars.get(end) == Some(&'\\') => replaced(at, end + 1, ", "),
        "" => replaced(at, end, ""),
        word => replaced(at, end, word),
    }
}

/// `|x|` is `abs(x)`.
fn absolute_value(chars: &[char], at: usize) -> Option<Change> {
    if *chars.get(at)? != '|' {
        return None;
    }
    let length = chars[at + 1..]
        .iter()
        .position(|c| matches!(c, '|' | '\n'))?;
    let end = at + 1 + length;
    let last = end_before(chars, end)?;
    let is_closed = chars[end] == '|' && (is_of_name(chars[last]) || chars[last] == ')');
    is_closed.then_some(())?;
    replaced(
        at,
        end + 1,
        &format!("abs({})", between(chars, at + 1, end)),
    )
}

/// `->` is `=`, `=<` is `<=`, the comma in `1,5` is a point, and `and` stands between conditions: equations have a comma.
fn sign(chars: &[char], at: usize) -> Option<Change> {
    let rest = &chars[at.min(chars.len())..];
    let before = end_before(chars, at);
    let line = chars[..at].iter().rposition(|c| *c == '\n');
    let line = line.map_or(0, |k| k + 1);
    let is_first = chars[line..at].iter().all(|c| matches!(c, ' ' | '$'));
    match (before.map(|k| chars[k]), rest) {
        (_, ['-', '>', ..]) => replaced(at, at + 2, "="),
        (_, ['≈', ..]) => replaced(at, at + 1, "="),
        (Some('='), [order @ ('<' | '>'), ..]) => replaced(before?, at + 1, &format!("{order}=")),
        (Some(digit), [',', next, ..]) if digit.is_ascii_digit() && next.is_ascii_digit() => {
            decimal_comma(chars, at)
        }
        (_, ['&', '=', ..]) => replaced(at, at + 1, ""),
        (_, ['$']) | (_, ['$', '\n' | '$', ..]) => replaced(at, at + 1, ""),
        (_, ['$', ..]) if is_first => replaced(at, at + 1, ""),
        (_, ['&', '&', ..]) => replaced(before? + 1, at + 2, ","),
        (_, ['a', 'n', 'd', ' ', ..]) => replaced(before? + 1, at + 3, ","),
        (_, ['w', 'h', 'e', 'r', 'e', ' ', ..]) => replaced(before? + 1, at + 5, ","),
        (_, ['.', '*' | '/' | '^', ..]) => replaced(at, at + 1, ""),
        _ => None,
    }
}

/// `1,5` is `1.5`, and `1,234.5` is `1234.5`. `1,234` may be both, and in brackets a list may be meant.
fn decimal_comma(chars: &[char], at: usize) -> Option<Change> {
    let digits = chars[at + 1..].iter().take_while(|c| c.is_ascii_digit());
    let behind = at + 1 + digits.count();
    let line = chars[..at].iter().rposition(|c| *c == '\n');
    let before = &chars[line.map_or(0, |k| k + 1)..at];
    let count = |bracket: char| before.iter().filter(|c| **c == bracket).count();
    let is_apart = count('(') == count(')');
    let is_group = behind == at + 4;
    match chars.get(behind) {
        _ if !is_apart => None,
        Some('.') if is_group => replaced(at, at + 1, ""),
        Some('.') => None,
        _ if is_group => None,
        _ => replaced(at, at + 1, "."),
    }
}

/// `x = ±2` is `x^2 = 2^2`.
fn plus_or_minus(chars: &[char], at: usize) -> Option<Change> {
    let Statement {
        from,
        to,
        left,
        right,
    } = statement(chars, at)?;
    let right = right.strip_prefix('±')?;
    let squares = format!("{}^2 = {}^2", operand(&left), operand(right));
    replaced(from, to, &squares)
}

/// A comment begins with `#`, in other programs with `//` or `%`.
fn comment(chars: &[char], at: usize) -> Option<Change> {
    let from = match (chars.get(at)?, at.checked_sub(1)) {
        ('/', Some(before)) if chars[before] == '/' => before,
        ('%', Some(before)) if chars[before].is_ascii_digit() => return None,
        ('%', _) => at,
        _ => return None,
    };
    let line = chars[..from].iter().rposition(|c| *c == '\n');
    let is_behind_equation = chars[line.map_or(0, |k| k + 1)..from].contains(&'=');
    let next = chars[at + 1..].iter().find(|c| **c != ' ');
    let is_text = next.is_none_or(|c| c.is_alphabetic() || *c == '\n');
    (is_behind_equation && is_text).then_some(())?;
    replaced(from, at + 1, "#")
}

/// `x_{1}` is `x_1`.
fn subscript(chars: &[char], at: usize) -> Option<Change> {
    let is_index = *chars.get(at)? == '{' && at > 0 && chars[at - 1] == '_';
    let end = closing_bracket(chars, at).filter(|_| is_index)?;
    let inside = between(chars, at + 1, end);
    inside.chars().all(is_of_name).then_some(())?;
    replaced(at, end + 1, &inside)
}

/// `f(x) = x^2 - 1` is the equation `x^2 - 1 = 0`.
fn declared_function(chars: &[char], at: usize) -> Option<Change> {
    let Statement {
        from,
        to,
        left,
        right,
    } = statement(chars, at)?;
    let (name, arguments) = left.strip_suffix(')')?.split_once('(')?;
    let is_name = |name: &str| !name.trim().is_empty() && name.trim().chars().all(is_of_name);
    let begins_here = from <= at && chars[at.min(chars.len() - 1)] == '(';
    let is_declaration = begins_here && is_name(name) && arguments.split(',').all(is_name);
    let is_free = FunctionName::called(name.trim()).is_none();
    let mut names = right.split(|c: char| !is_of_name(c));
    let is_used = names.any(|word| arguments.split(',').any(|name| name.trim() == word));
    (is_declaration && is_free && is_used).then_some(())?;
    replaced(from, to, &format!("{right} = 0"))
}

/// `x := 2` defines a name, where an equation is expected; `x = 1 and y > 0` is one condition.
fn definition(chars: &[char], said: &str) -> Option<Change> {
    let place = |word: &str| {
        let word: Vec<char> = word.chars().collect();
        chars.windows(word.len()).position(|part| part == word)
    };
    if said.contains("at least one equation") {
        let at = place(":=")?;
        return replaced(at, at + 2, "=");
    }
    let at = place(" and ").filter(|_| said.contains("conditions alone"))?;
    replaced(at, at + " and".len(), ",")
}

/// `log(x) = 2` is `x = exp(2)`, `exp(x) = 2` is `x = log(2)`, and `2^x = 8` is `x = log(8)/log(2)`.
fn exponential(chars: &[char], at: usize, said: &str) -> Option<Change> {
    let is_meant = ["as exponent", "`log`", "`log10`", "`log2`", "exp("];
    is_meant
        .iter()
        .any(|word| said.contains(word))
        .then_some(())?;
    let Statement {
        from,
        to,
        left,
        right,
    } = statement(chars, at)?;
    let by = match left.split_once('^') {
        Some((base, exponent)) => {
            let is_number = base.trim().parse::<f64>().is_ok();
            let exponent = without_brackets(exponent.trim());
            match base.trim() {
                "e" if exponent.contains('I') => format!("exp({exponent}) = {right}"),
                "e" => format!("{exponent} = log({right})"),
                base if is_number => format!("{exponent} = log({right})/log({base})"),
                _ => return None,
            }
        }
        None => {
            let (name, argument) = left.strip_suffix(')')?.split_once('(')?;
            match name {
                "log" | "ln" => format!("{argument} = exp({right})"),
                "exp" => format!("{argument} = log({right})"),
                "log10" => format!("{argument} = 10^{}", operand(&right)),
                "log2" => format!("{argument} = 2^{}", operand(&right)),
                _ => return None,
            }
        }
    };
    replaced(from, to, &by)
}

/// The argument of a function without brackets, and its end: in degrees where it has a unit. What stands behind it must leave no
/// doubt of where it ends.
pub fn bare_argument(chars: &[char], at: usize) -> Option<(usize, String)> {
    let (end, argument) = argument(chars, at)?;
    let next = (end..chars.len()).find(|k| chars[*k] != ' ');
    let Some(next) = next else {
        return Some((end, argument));
    };
    if let Some(unit) = degrees(chars, next) {
        return Some((unit.to, format!("{argument}{}", unit.by)));
    }
    let word = self::argument(chars, next).map_or(String::new(), |(_, word)| word);
    let is_clear = match chars[next] {
        '^' | '*' | '/' | '(' | '.' | '[' | '×' | '·' => false,
        c if is_of_name(c) => FunctionName::of(&word).is_some() || word == "and",
        c => !is_raised(c),
    };
    is_clear.then_some((end, argument))
}

/// A text as a factor: in brackets where it is more than one number or name.
fn operand(text: &str) -> String {
    let text = text.trim();
    match text
        .chars()
        .all(|c| is_of_name(c) || matches!(c, '.' | '*'))
    {
        true => text.to_owned(),
        false => format!("({text})"),
    }
}

/// A text without the brackets around all of it.
fn without_brackets(text: &str) -> &str {
    let inside = text
        .strip_prefix('(')
        .and_then(|text| text.strip_suffix(')'));
    inside
        .filter(|text| !text.contains(['(', ')']))
        .unwrap_or(text)
}
