//! JSON with places: every value and every character of a string knows where it stands.
//!
//! Numbers stay text, so that nothing is rounded before it must be.

use super::limits;
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::token::{Token, TokenKind, shorten};
use std::borrow::Cow;
use winnow::ascii::{digit0, digit1};
use winnow::combinator::{alt, opt, preceded};
use winnow::error::EmptyError;
use winnow::prelude::*;
use winnow::token::{any, one_of, take, take_while};

/// A string, and how its characters map to the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text<'a> {
    /// Text of the string, without escapes.
    pub text: Cow<'a, str>,
    /// The first byte within the quotes.
    pub start: usize,
    /// After each escape: byte of the text, byte of the file.
    pub(super) escapes: Vec<(usize, usize)>,
}

impl Text<'_> {
    fn place(&self, at: usize) -> usize {
        let after = self.escapes.partition_point(|&(text, _)| text <= at);
        let (text, file) = match after.checked_sub(1) {
            Some(last) => self.escapes[last],
            None => (0, self.start),
        };
        file + (at - text)
    }

    /// The place in the file of a place in the text.
    pub fn span(&self, span: Span) -> Span {
        Span {
            start: self.place(span.start),
            end: self.place(span.end),
        }
    }
}

/// Kinds of JSON values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind<'a> {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number as it is written.
    Number(&'a str),
    /// A string.
    Text(Box<Text<'a>>),
    /// A list.
    Array(Vec<Value<'a>>),
    /// Fields in the order of the file; no name occurs twice.
    Object(Vec<(Text<'a>, Value<'a>)>),
}

/// A value and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Value<'a> {
    /// Kind of the value.
    pub kind: Kind<'a>,
    /// Place of the value in the file.
    pub span: Span,
}

impl<'a> Value<'a> {
    /// The value in words, for messages.
    pub fn describe(&self) -> String {
        match &self.kind {
            Kind::Null => "null".into(),
            Kind::Bool(b) => b.to_string(),
            Kind::Number(text) => format!("the number {}", shorten(text)),
            Kind::Text(text) => format!("the string \"{}\"", shorten(&text.text)),
            Kind::Array(_) => "an array".into(),
            Kind::Object(_) => "an object".into(),
        }
    }

    fn wrong(&self, expected: &str) -> Fault {
        Fault::expected(self.span, expected, self.describe())
    }

    /// The items of a list; anything else is a fault that says what was expected.
    pub fn array(&self, expected: &str) -> Result<&[Value<'a>], Fault> {
        match &self.kind {
            Kind::Array(items) => Ok(items),
            _ => Err(self.wrong(expected)),
        }
    }

    /// The fields of an object.
    pub fn object(&self, expected: &str) -> Result<&[(Text<'a>, Value<'a>)], Fault> {
        match &self.kind {
            Kind::Object(fields) => Ok(fields),
            _ => Err(self.wrong(expected)),
        }
    }

    /// A string.
    pub fn text(&self, expected: &str) -> Result<&Text<'a>, Fault> {
        match &self.kind {
            Kind::Text(text) => Ok(text),
            _ => Err(self.wrong(expected)),
        }
    }

    /// A truth value.
    pub fn bool(&self, expected: &str) -> Result<bool, Fault> {
        match self.kind {
            Kind::Bool(b) => Ok(b),
            _ => Err(self.wrong(expected)),
        }
    }

    /// A finite number, also one that is written as a string because it has many digits.
    pub fn number(&self, expected: &str) -> Result<f64, Fault> {
        let text = match &self.kind {
            Kind::Number(text) => text,
            Kind::Text(text) => &*text.text,
            _ => return Err(self.wrong(expected)),
        };
        decimal(text).ok_or_else(|| self.wrong(expected))
    }
}

/// Reads one value that fills `text[start..end]`.
pub fn parse(text: &str, start: usize, end: usize) -> Result<Value<'_>, Fault> {
    let mut reader = Reader {
        whole: &text[..end],
        rest: &text[start..end],
        values: 0,
    };
    let value = reader.value(0)?;
    reader.blank();
    if reader.rest.is_empty() {
        Ok(value)
    } else {
        Err(reader.expected("the end of the JSON text"))
    }
}

struct Reader<'a> {
    whole: &'a str,
    rest: &'a str,
    values: u64,
}

type Lexed<T> = Result<T, EmptyError>;

fn number<'a>(input: &mut &'a str) -> Lexed<&'a str> {
    (
        opt('-'),
        alt(('0'.void(), (one_of('1'..='9'), digit0).void())),
        opt(('.', digit1)),
        opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1)),
    )
        .take()
        .parse_next(input)
}

fn code_unit(input: &mut &str) -> Lexed<u32> {
    preceded('u', take(4usize))
        .verify_map(|digits: &str| {
            let hexadecimal = digits.bytes().all(|b| b.is_ascii_hexdigit());
            hexadecimal
                .then(|| u32::from_str_radix(digits, 16).ok())
                .flatten()
        })
        .parse_next(input)
}

fn escape(input: &mut &str) -> Lexed<char> {
    let pair = (code_unit, preceded('\\', code_unit)).verify_map(|(high, low)| {
        let both = (0xD800..0xDC00).contains(&high) && (0xDC00..0xE000).contains(&low);
        both.then(|| char::from_u32(0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00)))
            .flatten()
    });
    preceded(
        '\\',
        alt((
            pair,
            code_unit.verify_map(char::from_u32),
            any.verify_map(|c| {
                Some(match c {
                    '"' | '\\' | '/' => c,
                    'b' => '\u{8}',
                    'f' => '\u{c}',
                    'n' => '\n',
                    'r' => '\r',
                    't' => '\t',
                    _ => return None,
                })
            }),
        )),
    )
    .parse_next(input)
}

fn plain<'a>(input: &mut &'a str) -> Lexed<&'a str> {
    take_while(0.., |c: char| c != '"' && c != '\\' && c >= ' ').parse_next(input)
}

impl<'a> Reader<'a> {
    fn position(&self) -> usize {
        self.whole.len() - self.rest.len()
    }

    fn blank(&mut self) {
        self.rest = self.rest.trim_start_matches([' ', '\t', '\n', '\r']);
    }

    fn take(&mut self, symbol: char) -> bool {
        self.blank();
        match self.rest.strip_prefix(symbol) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    /// Makes a fault at this place, where other text stands than the expected one.
    fn expected(&self, expected: &str) -> Fault {
        let start = self.position();
        let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+');
        let length = self.rest.find(|c| !word(c)).unwrap_or(self.rest.len());
        let (kind, length) = match self.rest.chars().next() {
            None => (TokenKind::End, 0),
            Some(c) if length == 0 => (TokenKind::Unknown(c), c.len_utf8()),
            Some(_) => (TokenKind::Name(&self.rest[..length]), length),
        };
        let span = Span {
            start,
            end: start + length,
        };
        let actual_input = match kind {
            TokenKind::Name(text) => format!("`{}`", shorten(text)),
            _ => Token { kind, span }.describe(),
        };
        Fault::expected(span, expected, actual_input)
    }

    fn value(&mut self, depth: u64) -> Result<Value<'a>, Fault> {
        self.blank();
        let start = self.position();
        self.values += 1;
        let here = Span {
            start,
            end: start + 1,
        };
        if depth > limits::JSON_NESTING.value {
            return Err(Fault::limit(here, limits::JSON_NESTING, depth));
        }
        if self.values > limits::JSON_VALUES.value {
            return Err(Fault::limit(here, limits::JSON_VALUES, "more"));
        }
        let kind = if self.take('{') {
            self.fields(depth)?
        } else if self.take('[') {
            let mut items = Vec::new();
            while !self.take(']') {
                if !items.is_empty() && !self.take(',') {
                    return Err(self.expected("`,` or `]`"));
                }
                items.push(self.value(depth + 1)?);
            }
            Kind::Array(items)
        } else if self.rest.starts_with('"') {
            Kind::Text(Box::new(self.string()?))
        } else {
            let mut scalar = alt((
                number.map(Kind::Number),
                "true".value(Kind::Bool(true)),
                "false".value(Kind::Bool(false)),
                "null".value(Kind::Null),
            ));
            let before = self.rest;
            let scalar: Lexed<Kind<'a>> = scalar.parse_next(&mut self.rest);
            match scalar {
                Ok(kind) => kind,
                Err(_) => {
                    self.rest = before;
                    return Err(self.expected("a JSON value"));
                }
            }
        };
        Ok(Value {
            kind,
            span: Span {
                start,
                end: self.position(),
            },
        })
    }

    fn fields(&mut self, depth: u64) -> Result<Kind<'a>, Fault> {
        let mut fields: Vec<(Text<'a>, Value<'a>)> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        while !self.take('}') {
            if !fields.is_empty() && !self.take(',') {
                return Err(self.expected("`,` or `}`"));
            }
            self.blank();
            if !self.rest.starts_with('"') {
                return Err(self.expected("a field's name in quotes"));
            }
            let start = self.position();
            let name = self.string()?;
            if !seen.insert(name.text.to_string()) {
                let problem = Problem::DuplicateName {
                    name: name.text.to_string(),
                    first: "is a field of this object already".into(),
                };
                return Err(Fault::new(
                    Span {
                        start,
                        end: self.position(),
                    },
                    problem,
                ));
            }
            if !self.take(':') {
                return Err(self.expected("`:`"));
            }
            fields.push((name, self.value(depth + 1)?));
        }
        Ok(Kind::Object(fields))
    }

    fn string(&mut self) -> Result<Text<'a>, Fault> {
        let quote = self.position();
        self.rest = &self.rest[1..];
        let start = self.position();
        let mut text = Cow::Borrowed("");
        let mut escapes = Vec::new();
        loop {
            // Cannot fail: it may be empty.
            let part = plain(&mut self.rest).unwrap_or_default();
            if text.is_empty() {
                text = Cow::Borrowed(part);
            } else {
                text.to_mut().push_str(part);
            }
            match self.rest.chars().next() {
                Some('"') => {
                    self.rest = &self.rest[1..];
                    return Ok(Text {
                        text,
                        start,
                        escapes,
                    });
                }
                Some('\\') => {
                    let before = self.rest;
                    match escape(&mut self.rest) {
                        Ok(c) => text.to_mut().push(c),
                        Err(_) => {
                            self.rest = before;
                            return Err(self.expected("an escape that JSON knows"));
                        }
                    }
                    escapes.push((text.len(), self.position()));
                }
                Some(_) => return Err(self.expected("a printable character or an escape")),
                None => {
                    let span = Span {
                        start: quote,
                        end: quote + 1,
                    };
                    let actual_input = "the end of the text in a string";
                    return Err(Fault::expected(span, "a closing quote", actual_input));
                }
            }
        }
    }
}

/// A string in quotes, as JSON wants it.
pub(crate) fn quote(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                quoted.push('\\');
                quoted.push(c);
            }
            c if c < ' ' => quoted.push_str(&format!("\\u{:04x}", c as u32)),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A finite number in decimal notation.
pub(crate) fn decimal(text: &str) -> Option<f64> {
    let plain = |b: u8| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E');
    if !text.bytes().all(plain) {
        return None;
    }
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_know_their_places() {
        let text = r#" {"a": [1, -2.5e3, true, null], "b\n\"c\u00e9": "x\ty+z"} "#;
        let value = parse(text, 0, text.len()).expect("valid");
        let fields = value.object("").expect("object");
        assert_eq!(fields[0].0.text, "a");
        assert_eq!(fields[1].0.text, "b\n\"cé");
        let numbers = fields[0].1.array("").expect("array");
        assert_eq!(&text[numbers[1].span.start..numbers[1].span.end], "-2.5e3");
        let string = fields[1].1.text("").expect("text");
        assert_eq!(string.text, "x\ty+z");
        let place = string.span(Span { start: 4, end: 5 });
        assert_eq!(&text[place.start..place.end], "z");
        assert_eq!(quote("a\"\\\n"), "\"a\\\"\\\\\\u000a\"");
    }

    #[test]
    fn a_surrogate_pair_is_one_character() {
        let text = r#""\ud83d\ude00""#;
        let value = parse(text, 0, text.len()).expect("valid");
        assert_eq!(value.text("").expect("text").text, "\u{1F600}");
        for bad in [
            r#""\ud83d""#,
            r#""\u12g4""#,
            r#""\x""#,
            "\"\u{1}\"",
            "\"a",
            "01",
            "[1,]",
        ] {
            assert!(parse(bad, 0, bad.len()).is_err(), "{bad}");
        }
    }
}
