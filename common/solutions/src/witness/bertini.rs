//! Bertini's files of a decomposition: `witness_data`, which other programs read, and `main_data` for people.
//!
//! `witness_data` as Bertini 1 writes it and Bertini_real reads it: points in homogeneous coordinates, codimension by
//! codimension; then the matrices of the slices. Numbers of the matrices are exact rationals. A file says where slices
//! and points are; nothing in it is believed before equations, slices and traces are checked.

use super::evidence::Evidence;
use super::witness_set::{ComponentId, Irreducible, Multiplicity, WitnessSet};
use cognate_numeric::rational::Rational;
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

/// Bits of a double, as Bertini counts them.
const DOUBLE_BITS: u32 = 52;
/// Most numbers that a count in a file may announce.
const MOST: usize = 10_000_000;
/// Type of a nonsingular and of a singular witness point.
const NONSINGULAR: u32 = 10;
const SINGULAR: u32 = 15;
/// The matrices hold exact rationals.
const RATIONAL: u32 = 2;

/// A component of a file, with the line where each of its points begins.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadSet {
    /// The component, whose deflation is not known.
    pub set: WitnessSet,
    /// The line of each point, from 1.
    pub lines: Vec<usize>,
    /// Number of deflations that the component needs, as the file says.
    pub deflations: u32,
}

/// Reason why a file is no `witness_data`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct WitnessDataError {
    /// The line, from 1.
    pub line: usize,
    /// Description of the unexpected text and of the expected text.
    pub message: String,
}

/// The components in affine space of these variables; `degrees`: of the equations.
pub fn write_witness_data(sets: &[WitnessSet], variables: usize, degrees: &[u32]) -> String {
    let mut by_codimension: BTreeMap<usize, Vec<&WitnessSet>> = BTreeMap::new();
    for set in sets {
        let codimension = variables - set.dimension() as usize;
        by_codimension.entry(codimension).or_default().push(set);
    }
    let mut text = format!("{}\n{}\n", variables + 1, by_codimension.len());
    for (codimension, sets) in &by_codimension {
        let points: usize = sets.iter().map(|set| set.points.len()).sum();
        let _ = writeln!(text, "{codimension}\n{points}");
        for (number, set) in sets.iter().enumerate() {
            for point in &set.points {
                write_point(&mut text, set, number, point);
            }
        }
    }
    let _ = writeln!(text, "-1\n\n{RATIONAL}");
    for (codimension, sets) in &by_codimension {
        write_matrices(&mut text, *codimension, sets[0], variables, degrees);
    }
    text
}

fn write_point(text: &mut String, set: &WitnessSet, number: usize, point: &[Complex64]) {
    for _ in 0..2 {
        let _ = writeln!(text, "{DOUBLE_BITS}");
        let one = Complex64::new(1.0, 0.0);
        for z in std::iter::once(&one).chain(point) {
            let _ = writeln!(text, "{:.16e} {:.16e}", z.re, z.im);
        }
    }
    let multiplicity = set.multiplicity.scheme.unwrap_or(set.multiplicity.tracked);
    let kind = match set.deflation.is_empty() && multiplicity == 1 {
        true => NONSINGULAR,
        false => SINGULAR,
    };
    let condition = set.evidence.worst_condition.max(1.0);
    let _ = writeln!(
        text,
        "{condition:.16e}\n{}\n{:.16e}\n{:.16e}\n{kind}\n{multiplicity}\n{number}\n{}",
        u32::from(kind == SINGULAR),
        1.0,
        0.0,
        set.deflation.len()
    );
}

/// The combinations of the equations, the homogenising exponents, the slices and the patch.
fn write_matrices(
    text: &mut String,
    codimension: usize,
    set: &WitnessSet,
    variables: usize,
    degrees: &[u32],
) {
    let rows = codimension.min(degrees.len());
    let mut order: Vec<usize> = (0..degrees.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(degrees[i]), i));
    let _ = writeln!(text, "{rows} {}", degrees.len());
    let chosen = &order[..rows];
    // Any combinations do whose rows are general: small integers of the place.
    let coefficient = |row: usize, column: usize| match () {
        () if chosen[row] == column => 1,
        () if chosen.contains(&column) || degrees[column] > degrees[chosen[row]] => 0,
        () => ((row * 31 + column * 17 + 7) % 23) as i32 - 11,
    };
    for row in 0..rows {
        for column in 0..degrees.len() {
            let _ = writeln!(text, "{} 0", coefficient(row, column));
        }
    }
    for row in 0..rows {
        for column in 0..degrees.len() {
            let exponent = degrees[chosen[row]].saturating_sub(degrees[column]);
            let _ = writeln!(text, "{exponent}");
        }
    }
    let unit = |text: &mut String| {
        let _ = writeln!(text, "{}", variables + 1);
        for k in 0..=variables {
            let _ = writeln!(text, "{} 0", u32::from(k == 0));
        }
    };
    unit(text);
    let _ = writeln!(text, "0 0");
    let _ = writeln!(text, "{} {}", set.slice.len(), variables + 1);
    for row in &*set.slice {
        for z in row {
            let _ = writeln!(text, "{} {}", exact(z.re), exact(z.im));
        }
    }
    unit(text);
}

fn exact(x: f64) -> String {
    Rational::from_f64(x).map_or_else(|| "0".into(), |x| x.to_string())
}

/// Tokens of a file with their lines.
struct Reader<'a> {
    tokens: Vec<(usize, &'a str)>,
    next: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        let lines = text.lines().enumerate();
        let tokens = lines.flat_map(|(k, line)| line.split_whitespace().map(move |t| (k + 1, t)));
        Self {
            tokens: tokens.collect(),
            next: 0,
        }
    }

    fn line(&self) -> usize {
        let last = self.tokens.last().map_or(1, |(line, _)| *line);
        self.tokens.get(self.next).map_or(last, |(line, _)| *line)
    }

    fn token(&mut self, expected: &str) -> Result<(usize, &'a str), WitnessDataError> {
        let line = self.line();
        let token = self.tokens.get(self.next).copied();
        self.next += 1;
        token.ok_or_else(|| WitnessDataError {
            line,
            message: format!("the file ends here; expected {expected}"),
        })
    }

    fn parsed<T>(
        &mut self,
        expected: &str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<T, WitnessDataError> {
        let (line, token) = self.token(expected)?;
        parse(token).ok_or_else(|| WitnessDataError {
            line,
            message: format!(
                "`{}`; expected {expected}",
                token.chars().take(40).collect::<String>()
            ),
        })
    }

    fn count(&mut self, expected: &str) -> Result<usize, WitnessDataError> {
        self.parsed(expected, |t| t.parse().ok().filter(|n| *n <= MOST))
    }

    fn number(&mut self, expected: &str) -> Result<f64, WitnessDataError> {
        self.parsed(expected, |token| {
            let value = match token.split_once('/') {
                Some((p, q)) => fraction(p, q)?,
                None => token.parse().ok()?,
            };
            value.is_finite().then_some(value)
        })
    }

    fn complex(&mut self, expected: &str) -> Result<Complex64, WitnessDataError> {
        Ok(Complex64::new(
            self.number(expected)?,
            self.number(expected)?,
        ))
    }

    fn wrong<T>(&self, line: usize, message: String) -> Result<T, WitnessDataError> {
        Err(WitnessDataError { line, message })
    }
}

/// The double nearest to a quotient of integers.
fn fraction(p: &str, q: &str) -> Option<f64> {
    let (p, q) = (p.parse::<Rational>().ok()?, q.parse::<Rational>().ok()?);
    (q != Rational::new()).then(|| (p / q).to_f64())
}

/// One point of a file.
struct ReadPoint {
    line: usize,
    values: Vec<Complex64>,
    multiplicity: u64,
    component: usize,
    deflations: u32,
}

/// Reads the components in a file for `variables` affine variables.
pub fn read_witness_data(text: &str, variables: usize) -> Result<Vec<ReadSet>, WitnessDataError> {
    let mut reader = Reader::new(text);
    let line = reader.line();
    let homogeneous = reader.count("the number of homogeneous variables")?;
    if homogeneous != variables + 1 {
        let message = format!("{homogeneous} variables; expected {}", variables + 1);
        return reader.wrong(line, message);
    }
    let codimensions = reader.count("the number of codimensions")?;
    if codimensions > variables {
        return reader.wrong(
            line,
            format!("{codimensions} codimensions of {variables} variables"),
        );
    }
    let mut points_by_codimension: Vec<(usize, Vec<ReadPoint>)> = Vec::new();
    for _ in 0..codimensions {
        let line = reader.line();
        let codimension = reader.count("a codimension")?;
        if codimension == 0 || codimension > variables {
            return reader.wrong(
                line,
                format!("codimension {codimension}; expected 1 to {variables}"),
            );
        }
        let points = reader.count("the number of witness points")?;
        let points = (0..points).map(|_| read_point(&mut reader, variables));
        points_by_codimension.push((codimension, points.collect::<Result<_, _>>()?));
    }
    let line = reader.line();
    let end = reader.parsed("-1 after the points", |t| t.parse::<i64>().ok())?;
    if end != -1 {
        return reader.wrong(line, format!("{end}; expected -1 after the points"));
    }
    reader.count("the type of the numbers")?;
    let mut sets = Vec::new();
    for (codimension, points) in points_by_codimension {
        let slice = read_matrices(&mut reader, variables, variables - codimension)?;
        sets.extend(components(variables - codimension, &slice, points));
    }
    Ok(sets)
}

fn read_point(reader: &mut Reader<'_>, variables: usize) -> Result<ReadPoint, WitnessDataError> {
    let line = reader.line();
    let mut values = Vec::new();
    for approximation in 0..2 {
        reader.count("a precision")?;
        let coordinates: Result<Vec<_>, _> = (0..=variables)
            .map(|_| reader.complex("a coordinate of a witness point"))
            .collect();
        if approximation == 0 {
            values = coordinates?;
        } else {
            coordinates?;
        }
    }
    let first = values.remove(0);
    if first.norm_sqr() == 0.0 {
        return reader.wrong(line, "a witness point at infinity".into());
    }
    for z in &mut values {
        *z /= first;
    }
    reader.number("a condition number")?;
    reader.number("a corank")?;
    reader.number("a singular value")?;
    reader.number("a singular value")?;
    reader.count("the type of a witness point")?;
    let multiplicity = reader.count("a multiplicity")? as u64;
    let at = reader.line();
    let component = reader.parsed("the number of a component", |t| t.parse::<i64>().ok())?;
    let component = usize::try_from(component).ok().filter(|n| *n < MOST);
    let Some(component) = component else {
        return reader.wrong(
            at,
            "a point of no component; expected a number from 0".into(),
        );
    };
    let deflations = reader.count("a number of deflations")? as u32;
    Ok(ReadPoint {
        line,
        values,
        multiplicity,
        component,
        deflations,
    })
}

/// The slice of one codimension; what is before and after it is only read over.
fn read_matrices(
    reader: &mut Reader<'_>,
    variables: usize,
    dimension: usize,
) -> Result<Vec<Vec<Complex64>>, WitnessDataError> {
    let matrix = "an entry of a matrix of combinations";
    let (rows, columns) = (reader.count(matrix)?, reader.count(matrix)?);
    let entries = rows.saturating_mul(columns);
    if entries > MOST {
        return reader.wrong(
            reader.line(),
            format!("a matrix of {rows} times {columns} numbers"),
        );
    }
    for _ in 0..entries {
        reader.complex(matrix)?;
    }
    for _ in 0..entries {
        reader.number("an exponent")?;
    }
    for _ in 0..reader.count("the length of a vector")? {
        reader.complex("an entry of a vector")?;
    }
    reader.complex("a constant")?;
    let line = reader.line();
    let rows = reader.count("the number of slices")?;
    let columns = reader.count("the number of coefficients of a slice")?;
    if (rows, columns) != (dimension, variables + 1) {
        let message = format!(
            "{rows} slices of {columns} coefficients; expected {dimension} of {}",
            variables + 1
        );
        return reader.wrong(line, message);
    }
    let mut slice = Vec::with_capacity(rows);
    for _ in 0..rows {
        let row = (0..columns).map(|_| reader.complex("a coefficient of a slice"));
        slice.push(row.collect::<Result<Vec<_>, _>>()?);
    }
    for _ in 0..reader.count("the length of a patch")? {
        reader.complex("a coefficient of a patch")?;
    }
    Ok(slice)
}

fn components(dimension: usize, slice: &[Vec<Complex64>], points: Vec<ReadPoint>) -> Vec<ReadSet> {
    let mut groups: BTreeMap<usize, Vec<ReadPoint>> = BTreeMap::new();
    for point in points {
        groups.entry(point.component).or_default().push(point);
    }
    let slice = Arc::new(slice.to_vec());
    let sets = groups.into_values().enumerate();
    sets.map(|(number, points)| ReadSet {
        deflations: points.iter().map(|p| p.deflations).max().unwrap_or(0),
        lines: points.iter().map(|p| p.line).collect(),
        set: WitnessSet {
            id: ComponentId {
                dimension: dimension as u32,
                number: number as u32 + 1,
            },
            degree: points.len() as u64,
            multiplicity: Multiplicity {
                scheme: Some(points[0].multiplicity),
                tracked: points[0].multiplicity,
                dual_dimensions: Vec::new(),
            },
            irreducible: Irreducible::Yes,
            deflation: Vec::new(),
            self_conjugate: None,
            orbit: None,
            slice: Arc::clone(&slice),
            points: points.into_iter().map(|p| p.values).collect(),
            evidence: Evidence::default(),
        },
    })
    .collect()
}

/// The components as text for people, in the order of Bertini's `main_data`.
pub fn write_main_data(sets: &[WitnessSet], variables: &[String]) -> String {
    let mut text = format!(
        "Number of variables: {}\nVariables:  {}\n",
        variables.len(),
        variables.join(" ")
    );
    for dimension in sets
        .iter()
        .map(WitnessSet::dimension)
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .rev()
    {
        let _ = writeln!(text, "\n----------DIMENSION {dimension}----------");
        let sets_of_dimension: Vec<&WitnessSet> =
            sets.iter().filter(|s| s.dimension() == dimension).collect();
        for (title, deflated) in [("NONSINGULAR", false), ("SINGULAR", true)] {
            let numbered = sets_of_dimension.iter().enumerate();
            let wanted: Vec<_> = numbered
                .filter(|(_, s)| s.deflation.is_empty() != deflated)
                .collect();
            if wanted.is_empty() {
                continue;
            }
            let _ = writeln!(text, "{title} SOLUTIONS");
            let mut path = 0;
            for (number, set) in wanted {
                for point in &set.points {
                    let _ = writeln!(
                        text,
                        "---------------\nPath number: {path}\nComponent number: {number}\nEstimated condition number: {:.6e}",
                        set.evidence.worst_condition
                    );
                    for z in point {
                        let _ = writeln!(text, "{:.15e} {:.15e}", z.re, z.im);
                    }
                    let multiplicity = set.multiplicity.scheme.unwrap_or(set.multiplicity.tracked);
                    let _ = writeln!(
                        text,
                        "Multiplicity: {multiplicity}\nDeflations needed: {}",
                        set.deflation.len()
                    );
                    path += 1;
                }
            }
        }
    }
    let _ = writeln!(
        text,
        "\n*************** Decomposition by Degree ***************"
    );
    let mut by_dimension: BTreeMap<u32, BTreeMap<u64, u64>> = BTreeMap::new();
    for set in sets {
        let degrees = by_dimension.entry(set.dimension()).or_default();
        *degrees.entry(set.degree).or_default() += 1;
    }
    for (dimension, degrees) in by_dimension.iter().rev() {
        let count: u64 = degrees.values().sum();
        let _ = writeln!(
            text,
            "\nDimension {dimension}: {count} classified components"
        );
        for (degree, count) in degrees {
            let _ = writeln!(text, "   degree {degree}: {count} components");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parabola() -> WitnessSet {
        let z = |re: f64, im: f64| Complex64::new(re, im);
        WitnessSet {
            id: ComponentId {
                dimension: 1,
                number: 1,
            },
            degree: 2,
            multiplicity: Multiplicity {
                scheme: Some(1),
                tracked: 1,
                dual_dimensions: Vec::new(),
            },
            irreducible: Irreducible::Yes,
            deflation: Vec::new(),
            self_conjugate: None,
            orbit: None,
            slice: Arc::new(vec![vec![z(-2.0, 0.1), z(0.3, 0.7), z(1.0, 0.0)]]),
            points: vec![
                vec![z(1.4, 0.25), z(2.0, 0.0)],
                vec![z(-1.4, 0.0), z(2.0, 1e-9)],
            ],
            evidence: Evidence::default(),
        }
    }

    #[test]
    fn what_was_written_is_read() {
        let text = write_witness_data(&[parabola()], 2, &[2]);
        let sets = read_witness_data(&text, 2).unwrap();
        let [read] = sets.as_slice() else {
            panic!("{sets:?}");
        };
        assert_eq!(read.set, parabola());
        assert_eq!(read.lines, [5, 21]);
    }

    #[test]
    fn what_is_cut_or_wrong_is_named_with_its_line() {
        let text = write_witness_data(&[parabola()], 2, &[2]);
        let lines: Vec<&str> = text.lines().collect();
        // Every cut is found, wherever it is.
        for end in 0..lines.len() {
            let cut = lines[..end].join("\n");
            let error = read_witness_data(&cut, 2).unwrap_err();
            assert!(error.line <= end.max(1), "{error}");
        }
        let mut wrong = lines.clone();
        wrong[6] = "0.3 what";
        let error = read_witness_data(&wrong.join("\n"), 2).unwrap_err();
        assert_eq!(
            (error.line, error.message.contains("`what`")),
            (7, true),
            "{error}"
        );
        let error = read_witness_data(&text, 3).unwrap_err();
        assert_eq!(error.line, 1);
    }
}
