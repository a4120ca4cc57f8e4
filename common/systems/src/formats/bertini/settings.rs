//! The CONFIG part: what has a meaning here is kept, the rest is warned about by name.

use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::token::{Token, TokenKind, Tokens};
use crate::formats::{FileSettings, PrecisionHint, Source, Warning, warn};

/// Reads settings up to and with `END;`.
pub(super) fn read(
    source: &Source<'_>,
    tokens: &mut Tokens<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
) -> Result<(), Fault> {
    let mut kind = None;
    let mut bits = None;
    loop {
        let token = tokens.take();
        let TokenKind::Name(name) = token.kind else {
            return Err(Fault::expected(
                token.span,
                "a setting `Name: value;` or `END;`",
                token.describe(),
            ));
        };
        if name == "END" {
            tokens.expect_symbol(';', "`;`")?;
            break;
        }
        if tokens.take_symbol(':').is_none() {
            tokens.take_symbol('=');
        }
        let value = Value::read(tokens)?;
        let lower = name.to_ascii_lowercase();
        match lower.as_str() {
            "randomseed" => settings.seed = Some(value.whole()?).filter(|&seed| seed != 0),
            "mptype" => kind = Some(value.one_of(&[0, 1, 2])?),
            "precision" => {
                bits = Some(u32::try_from(value.whole()?).map_err(|_| value.wrong("bits"))?);
            }
            "sharpendigits" => {
                let digits = u32::try_from(value.whole()?).map_err(|_| value.wrong("digits"))?;
                settings.digits = Some(digits).filter(|&digits| digits > 0);
            }
            "finaltol" => settings.final_tolerance = Some(value.positive()?),
            "tracktolbeforeeg" => settings.tracking_tolerance = Some(value.positive()?),
            "tracktolduringeg" => settings.endgame_tolerance = Some(value.positive()?),
            "maxnumbersteps" => settings.maximum_steps = Some(value.whole()?),
            "userhomotopy" => settings.user_homotopy = value.one_of(&[0, 1, 2])? != 0,
            "parameterhomotopy" => {
                settings.parameter_homotopy =
                    Some(value.one_of(&[0, 1, 2])? as u8).filter(|&n| n != 0);
            }
            "tracktype" => {
                if value.whole()? != 0 {
                    let what = "a TrackType other than 0 (isolated solutions)".into();
                    return Err(Fault::new(value.token.span, What::NotInThisVersion(what)));
                }
            }
            _ => {
                let message = format!("the setting {name} has no meaning here and is ignored");
                warn(warnings, source, token.span.start, message);
            }
        }
        tokens.expect_symbol(';', "`;`")?;
    }
    settings.precision = match (kind, bits) {
        (Some(0), _) => Some(PrecisionHint::Double),
        // Bertini's own default for a fixed precision is 96 bits.
        (Some(1), bits) => Some(PrecisionHint::Bits(bits.unwrap_or(96))),
        (Some(_), _) => Some(PrecisionHint::Adaptive),
        (None, _) => None,
    };
    Ok(())
}

/// The value of a setting: a number or a word.
struct Value<'a> {
    token: Token<'a>,
    negative: bool,
}

impl<'a> Value<'a> {
    fn read(tokens: &mut Tokens<'a>) -> Result<Self, Fault> {
        let negative = tokens.take_symbol('-').is_some();
        let token = tokens.take();
        match token.kind {
            TokenKind::Number(_) | TokenKind::Name(_) => Ok(Self { token, negative }),
            _ => Err(Fault::expected(
                token.span,
                "the setting's value",
                token.describe(),
            )),
        }
    }

    fn span(&self) -> Span {
        self.token.span
    }

    fn wrong(&self, expected: &str) -> Fault {
        let sign = if self.negative { "a minus before " } else { "" };
        Fault::expected(
            self.span(),
            expected,
            format!("{sign}{}", self.token.describe()),
        )
    }

    fn number(&self) -> Option<&'a str> {
        match self.token.kind {
            TokenKind::Number(text) if !self.negative => Some(text),
            _ => None,
        }
    }

    fn whole(&self) -> Result<u64, Fault> {
        let wrong = || self.wrong("a whole number below 2^64 that is not negative");
        self.number()
            .and_then(|text| text.parse().ok())
            .ok_or_else(wrong)
    }

    fn one_of(&self, allowed: &[u64]) -> Result<u64, Fault> {
        match self.whole() {
            Ok(n) if allowed.contains(&n) => Ok(n),
            _ => {
                let list: Vec<String> = allowed.iter().map(u64::to_string).collect();
                Err(self.wrong(&format!("one of {}", list.join(", "))))
            }
        }
    }

    fn positive(&self) -> Result<f64, Fault> {
        self.number()
            .and_then(|text| text.parse::<f64>().ok())
            .filter(|&x| x > 0.0 && x.is_finite())
            .ok_or_else(|| self.wrong("a positive number"))
    }
}
