//! Settings in the comments of a table: the unit of angles and, in tables of Denavit and Hartenberg, the order of a row.
//!
//! `# angles: rad` and `# convention: modified` are directives. Other comments above the first row are prose: one that says a
//! unit of angles or a convention is followed, and one that can be read either way is refused where no directive decides.

use super::document::{Document, MechanismError};

/// Words that turn the meaning of a comment around.
const NEGATIONS: &[&str] = &["not", "non", "instead", "than", "unlike"];
/// Words that say nothing.
const FILLERS: &[&str] = &["in", "all", "are", "is", "the"];

/// A question that comments answer with one of two words.
struct Question {
    /// Name of the directive.
    name: &'static str,
    /// Words for the answer without a comment; the first one is that of messages.
    usual: &'static [&'static str],
    /// Words for the other answer; the first one is that of messages.
    other: &'static [&'static str],
    /// Words of prose that is about the question.
    about: &'static [&'static str],
    /// Words for answers that are not read.
    unread: &'static [&'static str],
}

const ANGLES: Question = Question {
    name: "angles",
    usual: &["deg", "degs", "degree", "degrees", "°"],
    other: &["rad", "rads", "radian", "radians"],
    about: &["angle", "angles", "unit", "units"],
    unread: &[
        "turn",
        "turns",
        "revolution",
        "revolutions",
        "fraction",
        "fractions",
        "multiple",
        "multiples",
        "grad",
        "grads",
        "gradian",
        "gradians",
        "gon",
        "gons",
        "mrad",
    ],
};

const CONVENTION: Question = Question {
    name: "convention",
    usual: &["standard", "classic", "classical", "distal", "sdh"],
    other: &["modified", "craig", "proximal", "mdh"],
    about: &[
        "convention",
        "notation",
        "dh",
        "denavit",
        "hartenberg",
        "mdh",
        "sdh",
    ],
    unread: &[],
};

/// Names of the directives.
const DIRECTIVES: [&str; 2] = [ANGLES.name, CONVENTION.name];

/// An answer in prose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Prose {
    Usual,
    Other,
    Either,
    /// An answer that is not read.
    Unread,
}

impl Question {
    /// The answer of a comment that is no directive; `None` where it says nothing of the question.
    fn prose(&self, comment: &str) -> Option<Prose> {
        let comment = comment.to_lowercase();
        let comment = comment
            .replace("rad/s", "")
            .replace("deg/s", "")
            .replace("°/s", "")
            .replace("last modified", "")
            .replace("modified on", "")
            .replace("modified by", "");
        let is_part = |c: char| c.is_alphanumeric() || c == '°';
        let words: Vec<&str> = comment
            .split(|c| !is_part(c))
            .filter(|w| !w.is_empty())
            .collect();
        let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
        let is_answer = |word: &&str| {
            [self.usual, self.other, FILLERS]
                .iter()
                .any(|list| list.contains(word))
        };
        let is_about = has(self.about) || words.iter().all(is_answer);
        match (has(self.usual), has(self.other)) {
            (false, false) => (has(self.about) && has(self.unread)).then_some(Prose::Unread),
            (true, false) if !is_about => None,
            _ if !is_about || has(NEGATIONS) => Some(Prose::Either),
            (true, true) => Some(Prose::Either),
            (true, false) => Some(Prose::Usual),
            (false, true) => Some(Prose::Other),
        }
    }
}

/// Answers to a question, in the order of the lines.
#[derive(Default)]
struct Answers {
    /// Whether the directive has the other answer than the usual one.
    directive: Option<bool>,
    /// The answer of the prose, and the first byte of the comment.
    prose: Option<(Prose, usize)>,
}

impl Answers {
    /// The answers of the comments of a table.
    fn of(question: &Question, document: &Document<'_>) -> Result<Self, MechanismError> {
        let mut answers = Self::default();
        // Lines of the table: the headings, then the first row.
        let mut table_lines = 0;
        let mut at = 0;
        for line in document.text.split_inclusive('\n') {
            let place = at;
            at += line.len();
            let line = line.trim_start_matches('\u{feff}').trim();
            let Some(comment) = line.strip_prefix('#') else {
                table_lines += usize::from(!line.is_empty());
                continue;
            };
            let (name, value) = comment.split_once([':', '=']).unwrap_or_default();
            let name = name.trim().to_lowercase();
            let value = value.trim().trim_matches('"').to_lowercase();
            if name == question.name {
                answers.direct(question, document, place, &value)?;
            } else if table_lines < 2 && !DIRECTIVES.contains(&name.as_str()) {
                answers.read(question, place, comment);
            }
        }
        Ok(answers)
    }

    /// Takes the value of a directive at a byte of the file.
    fn direct(
        &mut self,
        question: &Question,
        document: &Document<'_>,
        at: usize,
        value: &str,
    ) -> Result<(), MechanismError> {
        let (usual, other) = (question.usual[0], question.other[0]);
        let is_other = question.other.contains(&value);
        if !is_other && !question.usual.contains(&value) {
            let message = format!("expected {usual} or {other}, found \"{value}\"");
            return Err(document.error(at, question.name, message));
        }
        if self
            .directive
            .is_some_and(|directive| directive != is_other)
        {
            let message = format!("expected {usual} or {other}, found both");
            return Err(document.error(at, question.name, message));
        }
        self.directive = Some(is_other);
        Ok(())
    }

    /// Takes a comment that is no directive.
    fn read(&mut self, question: &Question, at: usize, comment: &str) {
        let Some(answer) = question.prose(comment) else {
            return;
        };
        self.prose = match self.prose {
            Some((before, _)) if before != answer => Some((Prose::Either, at)),
            Some(before) => Some(before),
            None => Some((answer, at)),
        };
    }

    /// Whether the other answer than the usual one holds; `None` where no comment says so.
    fn settled(
        &self,
        question: &Question,
        document: &Document<'_>,
    ) -> Result<Option<bool>, MechanismError> {
        match (self.directive, self.prose) {
            (None, Some((Prose::Either, at))) => {
                let (name, usual, other) = (question.name, question.usual[0], question.other[0]);
                let message = format!(
                    "this comment can be read as {usual} or as {other}: add the line \"# {name}: {other}\" \
                     or \"# {name}: {usual}\""
                );
                Err(document.error(at, name, message))
            }
            // Angles that are written as multiples of pi need no unit.
            (None, Some((Prose::Unread, _))) if rows_have_pi(document) => Ok(None),
            (None, Some((Prose::Unread, at))) => {
                let (name, usual, other) = (question.name, question.usual[0], question.other[0]);
                let message = format!(
                    "this comment names a unit that is not read: expected {name} in {usual} or {other}, and the line \
                     \"# {name}: {other}\" or \"# {name}: {usual}\""
                );
                Err(document.error(at, name, message))
            }
            (None, Some((answer, _))) => Ok(Some(answer == Prose::Other)),
            (directive, _) => Ok(directive),
        }
    }

    /// Whether angles are in degrees, by answers about angles.
    fn degrees(&self, document: &Document<'_>) -> Result<Option<bool>, MechanismError> {
        Ok(self.settled(&ANGLES, document)?.map(|radians| !radians))
    }
}

/// Whether a row of a table has a number with pi.
fn rows_have_pi(document: &Document<'_>) -> bool {
    let mut rows = document.text.lines().filter(|line| !line.starts_with('#'));
    rows.any(|row| row.contains("pi") || row.contains('π'))
}

/// Settings that the comments of a table give.
#[derive(Clone, Debug)]
pub struct Directives {
    /// Whether angles are in degrees, `None` where no comment says so; or the refusal of an angle whose unit is not named.
    pub degrees: Result<Option<bool>, MechanismError>,
    /// Rows are Rx(alpha) Tx(a) Rz(theta) Tz(d) (J. J. Craig, Introduction to Robotics, 1986), else Rz(theta) Tz(d) Tx(a)
    /// Rx(alpha) (J. Denavit and R. S. Hartenberg, 1955).
    pub modified: bool,
}

impl Directives {
    /// The settings of a table.
    pub fn of(document: &Document<'_>) -> Result<Self, MechanismError> {
        let angles = Answers::of(&ANGLES, document)?;
        let convention = Answers::of(&CONVENTION, document)?;
        Ok(Self {
            degrees: angles.degrees(document),
            modified: convention.settled(&CONVENTION, document)?.unwrap_or(false),
        })
    }
}

/// Whether the comments of a table say that angles are in degrees; `None` where no comment names their unit.
pub fn degrees(document: &Document<'_>) -> Result<Option<bool>, MechanismError> {
    Answers::of(&ANGLES, document)?.degrees(document)
}

/// Whether a word for a unit of angles is one for degrees.
pub fn degrees_of_word(word: &str) -> Option<bool> {
    let word = word.trim().to_lowercase();
    let is_degrees = ANGLES.usual.contains(&word.as_str());
    let is_unit = is_degrees || ANGLES.other.contains(&word.as_str());
    is_unit.then_some(is_degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directives(comments: &str) -> Result<Directives, String> {
        let text = format!("{comments}theta,d,a,alpha\n0,0.1,0,90\n# modified, rad\n");
        let document = Document {
            file: "arm.csv",
            text: &text,
        };
        Directives::of(&document).map_err(|e| e.to_string())
    }

    #[test]
    fn comments_that_say_a_convention_are_followed() {
        for (comment, modified) in [
            ("# DH convention: modified", true),
            ("# modified DH", true),
            ("# Craig's convention, from the Franka documentation", true),
            ("# convention: proximal", true),
            ("# MDH", true),
            ("#convention:modified", true),
            ("# modified DH\n# convention: standard", false),
            ("# DH convention: standard", false),
            ("# the standard arm", false),
            ("# KUKA KR 6 R900, mm", false),
            ("# last modified in May", false),
            ("# modified by the vendor", false),
        ] {
            assert_eq!(
                directives(&format!("{comment}\n")).unwrap().modified,
                modified,
                "{comment}"
            );
        }
        for comment in [
            "# not modified DH",
            "# standard or modified DH",
            "# standard DH\n# modified DH",
        ] {
            let error = directives(&format!("# a\n{comment}\n")).unwrap_err();
            let wanted = "add the line \"# convention: modified\" or \"# convention: standard\"";
            assert!(error.ends_with(wanted), "{error}");
            assert!(
                error.starts_with("arm.csv:2") || error.starts_with("arm.csv:3"),
                "{error}"
            );
        }
        assert!(directives("# convention: standard\n# convention: craig\n").is_err());
    }

    #[test]
    fn comments_that_say_a_unit_of_angles_are_followed() {
        for (comment, degrees) in [
            ("# unit: rad", Some(false)),
            ("# angle: rad", Some(false)),
            ("# all angles in radians", Some(false)),
            ("# units: mm, degrees", Some(true)),
            ("# (rad)", Some(false)),
            ("# angles in radians\n# angles: deg", Some(true)),
            ("# speeds in rad/s, limits in deg", None),
            ("# KUKA KR 6 R900, mm", None),
            ("# angles in turns of the crank, in rad", Some(false)),
            ("# the first joint has no fraction", None),
        ] {
            let read = directives(&format!("{comment}\n")).unwrap().degrees;
            assert_eq!(read, Ok(degrees), "{comment}");
        }
        for comment in [
            "# angles in rad, not deg",
            "# limits in rad",
            "# angles not in deg",
        ] {
            let error = directives(&format!("{comment}\n")).unwrap().degrees;
            let error = error.unwrap_err().to_string();
            let wanted = "add the line \"# angles: rad\" or \"# angles: deg\"";
            assert!(error.ends_with(wanted), "{error}");
        }
        // Quarters of a turn were read as degrees (2026-11-30).
        for comment in ["# angles in fractions of a turn", "# unit of angles: gon"] {
            let error = directives(&format!("{comment}\n")).unwrap().degrees;
            let error = error.unwrap_err().to_string();
            assert!(error.contains("names a unit that is not read"), "{error}");
        }
        let as_multiples = "# angles as multiples of pi\n0,0,0,pi/2\n";
        assert_eq!(directives(as_multiples).unwrap().degrees, Ok(None));
    }
}
