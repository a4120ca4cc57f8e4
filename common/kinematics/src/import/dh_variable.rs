//! Names of joint variables in the cells of a table of Denavit and Hartenberg, as books print them: `q2`, `theta2 - 90`,
//! `0.2 + d3`.

/// Names of an angle that varies, before a number.
pub const ANGLES: &[&str] = &["q", "t", "th", "theta", "θ", "phi", "φ", "j", "joint"];
/// Names of a length that varies, before a number.
pub const LENGTHS: &[&str] = &["q", "d", "j", "joint"];

/// The name of a joint variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// The name as it is written.
    pub name: String,
    /// The letters before the number, in small letters.
    letters: String,
    /// The number that ends the name; `None` where that has other digits than 0 to 9.
    pub index: Option<u32>,
}

impl Variable {
    fn read(word: &str, names: &[&str]) -> Option<Self> {
        let stem = word.trim_end_matches(|c: char| c.is_numeric() || c == '_');
        let letters = stem.trim_end_matches('_').to_lowercase();
        let is_name = names.contains(&letters.as_str()) && stem.len() < word.len();
        is_name.then(|| Self {
            name: word.to_owned(),
            letters,
            index: index(&word[stem.len()..]),
        })
    }

    /// The name of the joint that the variable gives: `q0`; `None` for the other letters, which name the angle or the length.
    pub fn joint(&self) -> Option<String> {
        let index = self.index.filter(|_| self.letters == "q")?;
        Some(format!("q{index}"))
    }
}

/// The number of a name: `_4`, `12`, `₃`.
fn index(text: &str) -> Option<u32> {
    let digit = |c: char| match c {
        '₀'..='₉' => Some(u32::from(c) - u32::from('₀')),
        _ => c.to_digit(10),
    };
    let mut digits = text.chars().filter(|c| *c != '_');
    digits.try_fold(0u32, |number, c| {
        number.checked_mul(10)?.checked_add(digit(c)?)
    })
}

/// A cell that may hold the variable of its joint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The variable, if one is named.
    pub variable: Option<Variable>,
    /// The number beside the variable: of `q2` it is 0, of `q2 - 90` and `-90 + q2` it is -90.
    pub number: String,
}

impl Cell {
    /// Reads a cell; `names` are the names of a variable in its column.
    pub fn read(text: &str, names: &[&str]) -> Self {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let start = text.find(|c| !is_part(c)).unwrap_or(text.len());
        let first = Variable::read(&text[..start], names);
        if first.is_some() {
            let rest: String = text[start..].split_whitespace().collect();
            let number = match rest.strip_prefix('+') {
                _ if rest.is_empty() => "0".to_owned(),
                Some(number) => number.to_owned(),
                None => rest,
            };
            return Self {
                variable: first,
                number,
            };
        }
        let end = text.trim_end_matches(is_part).len();
        let last = Variable::read(&text[end..], names);
        match text[..end].trim_end().strip_suffix('+') {
            Some(number) if last.is_some() => Self {
                variable: last,
                number: number.trim_end().to_owned(),
            },
            _ => Self {
                variable: None,
                number: text.to_owned(),
            },
        }
    }
}
