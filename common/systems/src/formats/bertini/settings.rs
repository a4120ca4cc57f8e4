//! The CONFIG part: what has a meaning here is kept, the rest is warned about by name.

use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::similar::edits;
use crate::expression::token::{Token, TokenKind, Tokens};
use crate::formats::{FileSettings, OtherRun, PrecisionHint, Source, Warning, warn};

/// Settings that are followed, in small letters.
const FOLLOWED: &[&str] = &[
    "finaltol",
    "maxnumbersteps",
    "mptype",
    "parameterhomotopy",
    "precision",
    "randomseed",
    "sharpendigits",
    "tracktolbeforeeg",
    "tracktolduringeg",
    "tracktype",
    "userhomotopy",
];

/// The other settings of Bertini 1.6 (Bates, Hauenstein, Sommese, Wampler: Numerically Solving
/// Polynomial Systems with Bertini, 2013, appendix E), in small letters and sorted.
const WITHOUT_MEANING: &[&str] = &[
    "ampmaxprec",
    "ampsafetydigits1",
    "ampsafetydigits2",
    "coeffbound",
    "condnumthreshold",
    "constructwitnessset",
    "degreebound",
    "deletetempfiles",
    "endgamebdry",
    "endgamenum",
    "endpointfinitethreshold",
    "endpointsamethreshold",
    "functiontolerance",
    "imagthreshold",
    "intrinsicmultiplier",
    "junkremovaltest",
    "maxcodimension",
    "maxcyclenum",
    "maxldtdepth",
    "maxnewtonits",
    "maxnorm",
    "maxnumbadloopsinmon",
    "maxnummonlinears",
    "maxnumpts",
    "maxstepsbeforenewton",
    "maxstepsize",
    "minstepsizebeforeeg",
    "minstepsizeduringeg",
    "multonedimension",
    "nbhdradius",
    "numsamplepoints",
    "odepredictor",
    "outputlevel",
    "pathtruncationthreshold",
    "printpathmodulus",
    "ratiotolerance",
    "reducedonly",
    "regenhigherdimtest",
    "regenremoveinf",
    "regenstartlevel",
    "samplefactor",
    "screenout",
    "securitylevel",
    "securitymaxnorm",
    "sharpenonly",
    "singvalzerotol",
    "slicefinaltol",
    "slicetolbeforeeg",
    "slicetolduringeg",
    "specificcodimension",
    "stepfailfactor",
    "stepsforincrease",
    "stepsuccessfactor",
    "targettolmultiplier",
    "useregeneration",
    "witnessgentype",
    "witnesssupersetonly",
];

/// Names the command for a track type that is another kind of run.
fn other_track_type(number: i64) -> &'static str {
    match number {
        1 => "a decomposition into irreducible components is the command `cognate decompose`",
        2 => "points on a component are the command `cognate sample`",
        3 => "whether points lie on components is the command `cognate member`",
        4 => "witness sets are written by the command `cognate decompose`",
        5 => "a projection of a component is the command `cognate project`",
        6 => "isosingular sets are the command `cognate singular-locus`",
        7 => "a component cut by more equations is the command `cognate intersect`",
        -4..=-1 => {
            "points are not evaluated alone; `cognate solve` refines the solutions that it finds \
             (`--precision BITS`, `--certify`) and gives their residuals and conditions"
        }
        _ => "isolated solutions (0) are the command `cognate solve`",
    }
}

/// Reads settings up to and with `END;`, whose `;` may be missing.
pub(super) fn read(
    source: &Source<'_>,
    tokens: &mut Tokens<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
) -> Result<(), Fault> {
    let mut kind = None;
    let mut bits = None;
    let mut ignored: Vec<(usize, &str)> = Vec::new();
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
            tokens.take_symbol(';');
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
                let number = value.integer()?;
                if number != 0 {
                    let what = format!("TrackType: {number}; {}", other_track_type(number));
                    let fault = Fault::new(value.token.span, What::NotInThisVersion(what));
                    settings.other_run = Some(OtherRun {
                        track_type: number,
                        refusal: source.error(fault),
                    });
                }
            }
            other if WITHOUT_MEANING.binary_search(&other).is_ok() => {
                // Each once: a file may repeat a setting a million times.
                if !ignored
                    .iter()
                    .any(|(_, earlier_name)| earlier_name.eq_ignore_ascii_case(name))
                {
                    ignored.push((token.span.start, name));
                }
            }
            other => {
                let setting_names = FOLLOWED.iter().chain(WITHOUT_MEANING);
                // A word that goes on, or that stops too early, is nearer than one of other letters.
                let begun =
                    |setting: &str| setting.starts_with(other) || begins_alike(other, setting);
                let nearest =
                    setting_names.min_by_key(|setting| (!begun(setting), edits(other, setting)));
                let nearest = nearest.copied().unwrap_or_default();
                let expected = format!("a setting of Bertini's, perhaps `{nearest}`");
                return Err(Fault::expected(token.span, &expected, token.describe()));
            }
        }
        tokens.expect_symbol(';', "`;`")?;
    }
    say_ignored(source, &ignored, warnings);
    settings.precision = match (kind, bits) {
        (Some(0), _) => Some(PrecisionHint::Double),
        // Bertini's own default for a fixed precision is 96 bits.
        (Some(1), bits) => Some(PrecisionHint::Bits(bits.unwrap_or(96))),
        (Some(_), _) => Some(PrecisionHint::Adaptive),
        (None, _) => None,
    };
    Ok(())
}

/// Whether two words begin with the same letters, as many as tell settings from each other.
fn begins_alike(a: &str, b: &str) -> bool {
    const TELLING: usize = 7;
    a.get(..TELLING).is_some_and(|begin| b.starts_with(begin))
}

/// Makes one warning for all settings that are ignored, at the first of them.
fn say_ignored(source: &Source<'_>, ignored: &[(usize, &str)], warnings: &mut Vec<Warning>) {
    let names: Vec<&str> = ignored.iter().map(|(_, name)| *name).collect();
    let message = match names[..] {
        [] => return,
        [name] => format!("the setting {name} has no meaning here and is ignored"),
        _ => format!(
            "the settings {} have no meaning here and are ignored",
            names.join(", ")
        ),
    };
    warn(warnings, source, ignored[0].0, message);
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

    fn integer(&self) -> Result<i64, Fault> {
        let text = match self.token.kind {
            TokenKind::Number(text) => text.parse::<i64>().ok(),
            _ => None,
        };
        let signed = text.map(|n| if self.negative { -n } else { n });
        signed.ok_or_else(|| self.wrong("a whole number"))
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
