//! Numbers that people type without names: a line for a pose, or for the values of all inputs.

use super::document::{Document, MechanismError};
use super::exact::{Number, looks_like_radians};
use super::target_row::{MOST_TARGETS, Row, inputs_of_row, is_comment, value};
use cognate_numeric::counted::counted;
use std::iter::Peekable;

/// Numbers of a line, as they are typed, and where it begins.
pub(super) struct Numbers<'a> {
    pub at: usize,
    pub words: Vec<&'a str>,
}

impl<'a> Numbers<'a> {
    pub fn of(at: usize, line: &'a str) -> Self {
        let separates = |c: char| c.is_whitespace() || [',', ';', '[', ']'].contains(&c);
        let words = line.split(separates).filter(|word| !word.is_empty());
        Self {
            at,
            words: words.collect(),
        }
    }
}

/// The lines of a text that have words and are no comments; `None` where the first of them has words that are neither numbers nor angles.
pub(super) fn lines_of_numbers(text: &str) -> Option<Peekable<impl Iterator<Item = Numbers<'_>>>> {
    let mut at = 0;
    let lines = text.split_inclusive('\n').map(move |line| {
        let numbers = (!is_comment(line)).then(|| Numbers::of(at, line));
        at += line.len();
        numbers
    });
    let lines = lines.flatten();
    let mut lines = lines.filter(|numbers| !numbers.words.is_empty()).peekable();
    let is_number = |word: &&str| value(word, true, false).is_some();
    let begins_with_numbers = lines.peek()?.words.iter().all(is_number);
    begins_with_numbers.then_some(lines)
}

/// Angles that are typed without a unit must look like those of the unit that is meant.
pub(super) fn check_unit(
    document: &Document<'_>,
    at: usize,
    angles: &[&str],
    degrees: bool,
) -> Result<(), MechanismError> {
    let turn = 2.0 * std::f64::consts::PI;
    for angle in angles {
        let Some(x) = Number::read(angle).map(|number| number.to_f64()) else {
            continue;
        };
        let (unit, other) = match degrees {
            true if looks_like_radians(angle) => ("degrees", "rad"),
            false if x.abs() > turn => ("radians", "deg"),
            _ => continue,
        };
        let message = format!(
            "{angle} would be {angle} {unit} here: say the unit, {angle}{other} or --angles {other}"
        );
        return Err(document.error(at, "", message));
    }
    Ok(())
}

/// Values of inputs from a file of numbers, a line for all of `names` in this order; `None` where it begins with names.
pub(super) fn inputs_without_names(
    document: &Document<'_>,
    names: &[(String, bool)],
    degrees: bool,
) -> Option<Result<Vec<Vec<f64>>, MechanismError>> {
    let mut lines = lines_of_numbers(document.text)?;
    // Joints may be called 1, 2, ...
    let is_name = |word: &&str| names.iter().any(|(name, _)| name == word);
    if lines.peek()?.words.iter().all(is_name) {
        return None;
    }
    Some(each_inputs(document, lines, names, degrees))
}

fn each_inputs<'a>(
    document: &Document<'_>,
    lines: impl Iterator<Item = Numbers<'a>>,
    names: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<Vec<f64>>, MechanismError> {
    let mut inputs = Vec::new();
    for Numbers { at, words } in lines {
        if inputs.len() >= MOST_TARGETS {
            let message = format!("more than {MOST_TARGETS} targets");
            return Err(document.error(at, "", message));
        }
        if words.len() != names.len() {
            let listed: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
            let message = format!(
                "expected {} ({}), found {}",
                counted(names.len(), "value"),
                listed.join(" "),
                words.len()
            );
            return Err(document.error(at, "", message));
        }
        for ((_, is_angle), word) in names.iter().zip(&words) {
            if *is_angle {
                check_unit(document, at, &[word], degrees)?;
            }
        }
        let names_of_cells = names.iter().map(|(name, _)| name.as_str());
        let row = Row {
            at,
            cells: names_of_cells.zip(words).collect(),
        };
        inputs.push(inputs_of_row(document, &row, names, degrees)?);
    }
    Ok(inputs)
}

#[cfg(test)]
mod tests {
    use crate::mechanism::targets::inputs;

    #[test]
    fn inputs_may_stand_without_names() {
        let names = [("q1".to_owned(), true), ("rail".to_owned(), false)];
        let read = |text: &str, degrees| inputs("q.txt", text.as_bytes(), &names, degrees);
        let quarter = std::f64::consts::FRAC_PI_2;
        let both = read("90 0.5\n[pi/2, 1]\n", true).expect("two lines");
        assert_eq!(both, [[quarter, 0.5], [quarter, 1.0]]);
        for table in [
            "q1,rail\n90,0.5\n",
            "# of the vendor; by hand\nq1,rail\n90,0.5\n# the last\n",
            "# angles: deg\n\n90 0.5\n",
        ] {
            assert_eq!(read(table, true).expect(table), [[quarter, 0.5]], "{table}");
        }
        // The unit that a file names holds for its numbers, whatever that of the mechanism is.
        for numbers in ["q1,rail\n90,0.5\n", "90 0.5\n"] {
            let stated = read(&format!("# angles: deg\n{numbers}"), false);
            assert_eq!(stated.expect(numbers), [[quarter, 0.5]]);
        }
        let numbered = [("1".to_owned(), true), ("2".to_owned(), true)];
        let table = inputs("q.txt", b"1,2\n90,0\n", &numbered, true);
        assert_eq!(table.expect("a table"), [[quarter, 0.0]]);
        for (text, degrees, expected) in [
            (
                "90 0.5 1\n",
                true,
                "q.txt:1: expected 2 values (q1 rail), found 3",
            ),
            ("0 1\n1.5708 0.5\n", true, "1.5708rad"),
            ("90 0.5\n", false, "90deg"),
            ("# angles: grad\n0 1\n", true, "expected deg or rad"),
            ("# limits in rad\n0 1\n", true, "\"# angles: rad\""),
            ("0 pi/2deg\n", true, "q.txt:1: rail: expected a number"),
        ] {
            let error = read(text, degrees).expect_err(text).to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
