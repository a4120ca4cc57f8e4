//! Tokens: the words of the expression grammar, with their places in the text.

use super::fault::{Fault, Span};
use cognate_numeric::rational::Rational;
use winnow::ascii::{digit0, digit1};
use winnow::combinator::{alt, not, opt, repeat};
use winnow::error::EmptyError;
use winnow::prelude::*;
use winnow::token::{any, one_of, take_while};

/// Kinds of tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind<'a> {
    /// A number without a sign: `12`, `1.5`, `.5e-3`, `½`.
    Number(&'a str),
    /// A name: a letter or `_`, then letters, digits, `_` and indices such as `[1]`. `π` is a name of its own, and
    /// `π1` is one.
    Name(&'a str),
    /// One of `+ - * / ^ ( ) ; , = :`; `**` is read as `^`, and signs of printed mathematics (`×`, `·`, `−`, `÷`) as those of
    /// the keyboard.
    Symbol(char),
    /// Raised digits, perhaps behind a raised minus sign: a power.
    Raised(&'a str),
    /// A character that belongs to no token.
    Unknown(char),
    /// The end of the text.
    End,
}

/// A token and its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// Kind of the token.
    pub kind: TokenKind<'a>,
    /// Place of the token in the text.
    pub span: Span,
}

impl Token<'_> {
    /// The token in words, for messages.
    pub fn describe(&self) -> String {
        match self.kind {
            TokenKind::Number(text) => format!("the number `{}`", shorten(text)),
            TokenKind::Name(text) => format!("the name `{}`", shorten(text)),
            TokenKind::Symbol(symbol) => format!("`{symbol}`"),
            TokenKind::Raised(text) => format!("the power `{}`", shorten(text)),
            TokenKind::Unknown(c) if c.is_control() => {
                format!("the control character U+{:04X}", c as u32)
            }
            TokenKind::Unknown('!') => {
                "the character `!` (a factorial has no polynomial form; `!=` is not equal)".into()
            }
            TokenKind::Unknown(c) => match instead_of(c) {
                Some(instead) => format!("the character `{c}`, which is written {instead}"),
                None => format!("the character `{c}`"),
            },
            TokenKind::End => "the end of the text".into(),
        }
    }
}

/// The circle constant as it is printed: part of no other name but those with an index, `π1` and `π_1`.
pub const PRINTED_PI: &str = "π";

/// Sign of a raised number.
const RAISED_MINUS: char = '⁻';

/// Powers as raised digits, from the 0th on.
const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// Fractions of one character, with numerator and denominator.
const FRACTIONS: [(char, u32, u32); 15] = [
    ('½', 1, 2),
    ('⅓', 1, 3),
    ('⅔', 2, 3),
    ('¼', 1, 4),
    ('¾', 3, 4),
    ('⅕', 1, 5),
    ('⅖', 2, 5),
    ('⅗', 3, 5),
    ('⅘', 4, 5),
    ('⅙', 1, 6),
    ('⅚', 5, 6),
    ('⅛', 1, 8),
    ('⅜', 3, 8),
    ('⅝', 5, 8),
    ('⅞', 7, 8),
];

/// The value of a fraction of one character.
pub fn fraction(text: &str) -> Option<Rational> {
    let mut characters = text.chars();
    let fraction = characters.next().filter(|_| characters.next().is_none())?;
    let (_, numerator, denominator) = FRACTIONS.iter().find(|(c, ..)| *c == fraction)?;
    Some(Rational::from((*numerator, *denominator)))
}

fn is_fraction(c: char) -> bool {
    FRACTIONS.iter().any(|(fraction, ..)| *fraction == c)
}

/// Whether a character is a raised digit: it ends a name and is a power.
pub fn is_raised(c: char) -> bool {
    RAISED.contains(&c)
}

/// Returns the notation to write instead of a character of printed mathematics that has no one meaning here.
fn instead_of(c: char) -> Option<&'static str> {
    match c {
        '√' => Some("`sqrt(...)`"),
        '∛' => Some("`cbrt(...)`"),
        '°' => Some("`*pi/180`"),
        '|' => Some("`abs(...)`"),
        '０'..='９' => Some(WIDE_DIGITS[c as usize - '０' as usize]),
        _ => None,
    }
}

/// Notation of the digits that are as wide as ideographs.
const WIDE_DIGITS: [&str; 10] = [
    "`0`", "`1`", "`2`", "`3`", "`4`", "`5`", "`6`", "`7`", "`8`", "`9`",
];

/// The number that raised digits say, with their sign, in characters of the line.
pub fn lowered(raised: &str) -> String {
    let digit = |c: char| match c {
        RAISED_MINUS => Some("-".to_owned()),
        _ => RAISED
            .iter()
            .position(|&raised| raised == c)
            .map(|digit| digit.to_string()),
    };
    raised.chars().filter_map(digit).collect()
}

/// Shortens a text to at most 40 characters, for messages.
pub fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((at, _)) => format!("{}...", &text[..at]),
        None => text.into(),
    }
}

/// True for a text that is one name.
pub fn is_name(text: &str) -> bool {
    alt((printed_pi, name)).parse(text).is_ok()
}

type Lexed<T> = Result<T, EmptyError>;

fn number<'a>(input: &mut &'a str) -> Lexed<&'a str> {
    (
        alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void())),
        // `2e` is the number 2 and the name e: an exponent has digits.
        opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1)),
    )
        .take()
        .parse_next(input)
}

/// Letters, digits and `_`, and indices such as `[1]`: a bracket of a name is closed in it, so that names can
/// stand in the lists of notations whose lists have brackets. Raised digits, fractions and `π`
/// are part of no name.
fn name<'a>(input: &mut &'a str) -> Lexed<&'a str> {
    let is_apart = |c: char| is_raised(c) || is_fraction(c) || PRINTED_PI.contains(c);
    let belongs = |c: char| (c.is_alphanumeric() || c == '_') && !is_apart(c);
    let letters = |input: &mut &'a str| take_while(1.., belongs).parse_next(input);
    let index = ('[', letters, ']').take();
    (
        one_of(|c: char| c.is_alphabetic() || c == '_'),
        repeat::<_, _, (), _, _>(0.., alt((letters, index))),
    )
        .take()
        .parse_next(input)
}

/// `π` without an index behind it.
fn printed_pi<'a>(input: &mut &'a str) -> Lexed<&'a str> {
    let is_apart = |c: char| is_raised(c) || is_fraction(c);
    let index = one_of(move |c: char| c.is_numeric() && !is_apart(c) || matches!(c, '_' | '['));
    (PRINTED_PI, not(index)).take().parse_next(input)
}

fn lexeme<'a>(input: &mut &'a str) -> Lexed<TokenKind<'a>> {
    alt((
        alt((number, one_of(is_fraction).take())).map(TokenKind::Number),
        alt((printed_pi, name)).map(TokenKind::Name),
        "**".value(TokenKind::Symbol('^')),
        (opt(RAISED_MINUS), take_while(1.., RAISED))
            .take()
            .map(TokenKind::Raised),
        one_of(['×', '·', '⋅', '∙', '∗']).value(TokenKind::Symbol('*')),
        one_of(['−', '–']).value(TokenKind::Symbol('-')),
        one_of(['÷', '∕', '⁄']).value(TokenKind::Symbol('/')),
        one_of(['+', '-', '*', '/', '^', '(', ')', ';', ',', '=', ':']).map(TokenKind::Symbol),
        any.map(TokenKind::Unknown),
    ))
    .parse_next(input)
}

fn blank<'a>(input: &mut &'a str, comment: Option<char>) -> Lexed<&'a str> {
    loop {
        let _: &str = take_while(0.., char::is_whitespace).parse_next(input)?;
        match comment {
            Some(c) if input.starts_with(c) => {
                let _: &str = take_while(0.., |c| c != '\n').parse_next(input)?;
            }
            _ => return Ok(""),
        }
    }
}

/// Reads a text token by token, with one token of look-ahead.
#[derive(Clone, Debug)]
pub struct Tokens<'a> {
    text: &'a str,
    rest: &'a str,
    end: usize,
    comment: Option<char>,
    peeked: Option<Token<'a>>,
}

impl<'a> Tokens<'a> {
    /// Reads `text`; from `comment` to the end of a line is skipped.
    pub fn new(text: &'a str, comment: Option<char>) -> Self {
        Self {
            text,
            rest: text,
            end: 0,
            comment,
            peeked: None,
        }
    }

    /// Reads on from byte `start`; places stay those of the whole text.
    pub fn starting_at(text: &'a str, start: usize, comment: Option<char>) -> Self {
        Self {
            rest: &text[start..],
            ..Self::new(text, comment)
        }
    }

    /// The next token, which stays.
    pub fn peek(&mut self) -> Token<'a> {
        if let Some(token) = self.peeked {
            return token;
        }
        let total = self.text.len();
        // Neither can fail: blanks may be empty, and `lexeme` takes any character.
        let _ = blank(&mut self.rest, self.comment);
        let start = total - self.rest.len();
        let kind = lexeme(&mut self.rest).unwrap_or(TokenKind::End);
        let span = Span {
            start,
            end: total - self.rest.len(),
        };
        let token = Token { kind, span };
        self.peeked = Some(token);
        token
    }

    /// The next token, which is consumed.
    pub fn take(&mut self) -> Token<'a> {
        let token = self.peek();
        self.peeked = None;
        self.end = token.span.end;
        token
    }

    /// Consumes the next token if it is this symbol.
    pub fn take_symbol(&mut self, symbol: char) -> Option<Span> {
        let token = self.peek();
        (token.kind == TokenKind::Symbol(symbol)).then(|| self.take().span)
    }

    /// Consumes this symbol, or says what was expected.
    pub fn expect_symbol(&mut self, symbol: char, expected: &str) -> Result<Span, Fault> {
        let token = self.peek();
        match self.take_symbol(symbol) {
            Some(span) => Ok(span),
            None => Err(Fault::expected(token.span, expected, token.describe())),
        }
    }

    /// Byte where the last consumed token ended.
    pub fn position(&self) -> usize {
        self.end
    }

    /// The whole text.
    pub fn text(&self) -> &'a str {
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<TokenKind<'_>> {
        let mut tokens = Tokens::new(text, Some('%'));
        let mut kinds = Vec::new();
        loop {
            match tokens.take().kind {
                TokenKind::End => return kinds,
                kind => kinds.push(kind),
            }
        }
    }

    #[test]
    fn numbers_and_names_that_begin_with_e_are_told_apart() {
        use TokenKind::{Name, Number, Symbol};
        assert_eq!(kinds("2e5*e5"), [Number("2e5"), Symbol('*'), Name("e5")]);
        assert_eq!(
            kinds("2e+x"),
            [Number("2"), Name("e"), Symbol('+'), Name("x")]
        );
        assert_eq!(kinds("1.5E-3.5"), [Number("1.5E-3"), Number(".5")]);
        assert_eq!(
            kinds("x**y % a comment\n^1."),
            [Name("x"), Symbol('^'), Name("y"), Symbol('^'), Number("1."),]
        );
        assert_eq!(kinds("x[1]_2 @"), [Name("x[1]_2"), TokenKind::Unknown('@')]);
        assert_eq!(
            kinds("x² x₂"),
            [Name("x"), TokenKind::Raised("²"), Name("x₂")]
        );
        let printed = [Name("x"), TokenKind::Raised("¹²"), Symbol('*'), Name("y")];
        assert_eq!(kinds("x¹² · y"), printed);
        assert_eq!(lowered("¹²⁰"), "120");
        assert_eq!(lowered("⁻¹²"), "-12");
        let inverse = [Name("x"), TokenKind::Raised("⁻¹"), Symbol('*'), Number("½")];
        assert_eq!(kinds("x⁻¹∗½"), inverse);
        assert_eq!(kinds("x½"), [Name("x"), Number("½")]);
        assert_eq!(kinds("aπr"), [Name("a"), Name("π"), Name("r")]);
        assert_eq!(kinds("π1 π_x π₁"), [Name("π1"), Name("π_x"), Name("π₁")]);
        assert_eq!(kinds("π²"), [Name("π"), TokenKind::Raised("²")]);
        assert!(is_name("π") && is_name("π1") && !is_name("πr"));
        assert_eq!(kinds("−÷×"), [Symbol('-'), Symbol('/'), Symbol('*')]);
        let open = [Name("x"), TokenKind::Unknown('['), Symbol('*'), Name("y")];
        assert_eq!(kinds("x[*y"), open);
    }

    #[test]
    fn spans_count_bytes() {
        let mut tokens = Tokens::new("  ab\u{e9} ;", None);
        assert_eq!(tokens.take().span, Span { start: 2, end: 6 });
        assert_eq!(tokens.take().span, Span { start: 7, end: 8 });
        assert_eq!(tokens.take().span, Span { start: 8, end: 8 });
    }
}
