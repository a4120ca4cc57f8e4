//! Minors: the largest minors of a matrix of expressions, which vanish together where its rank is not full.
//!
//! Row after row, each minor of the rows so far is a sum over the minors of the rows before, which have names: n 2^(n-1)
//! products, and not n!.

use super::configurations::Motion;
use super::singular_kind::Extent;
use super::text::{self, Equations};
use crate::mechanism::{Mechanism, MechanismError};
use crate::plane::modulus;
use std::collections::BTreeMap;

/// Columns at most: more have too many minors.
const MOST_COLUMNS: usize = 12;
/// Equations at most.
const MOST_MINORS: usize = 60;

/// Constant minors of exact numbers are 0 up to this, which is rounding.
const ZERO: f64 = 1e-13;
/// Constant minors of rounded numbers are in doubt up to this.
const UNCLEAR: f64 = 1e-9;

/// Vanishing of the largest minors.
#[derive(Clone, Debug, PartialEq)]
pub enum Minors {
    /// All minors vanish where these expressions are 0.
    Zeros(Vec<String>),
    /// All minors vanish everywhere.
    Everywhere,
    /// There are too many rows or columns.
    TooMany,
}

/// The largest minors of a matrix with `columns` columns; minors of fewer rows are defined in the equations.
pub fn largest_minors(rows: &[Vec<String>], columns: usize, equations: &mut Equations) -> Minors {
    if rows.len().max(columns) > MOST_COLUMNS {
        return Minors::TooMany;
    }
    let named: Vec<Vec<String>> = rows
        .iter()
        .enumerate()
        .map(|(i, row)| {
            let entries = row.iter().enumerate();
            let entry = |(j, entry): (usize, &String)| {
                equations.define(format!("rate{}_{}", i + 1, j + 1), entry.clone())
            };
            entries.map(entry).collect()
        })
        .collect();
    let matrix: Vec<Vec<String>> = match rows.len() > columns {
        false => named,
        true => {
            let column = |j: usize| named.iter().map(|row| row[j].clone()).collect();
            (0..columns).map(column).collect()
        }
    };
    let mut minors: BTreeMap<u32, String> = BTreeMap::from([(0, "1".into())]);
    for (i, row) in matrix.iter().enumerate() {
        let mut sums: BTreeMap<u32, Vec<String>> = BTreeMap::new();
        for (chosen, minor) in &minors {
            for (j, entry) in row.iter().enumerate() {
                if entry == "0" || chosen & (1 << j) != 0 {
                    continue;
                }
                let product = text::times(entry, minor);
                // Expanded along the last row, the sign is that of the number of chosen columns behind this one.
                let is_negative = (chosen >> (j + 1)).count_ones() % 2 == 1;
                sums.entry(chosen | (1 << j))
                    .or_default()
                    .push(match is_negative {
                        true => format!("(-{product})"),
                        false => product,
                    });
            }
        }
        let is_last = i + 1 == matrix.len();
        let sums = sums.into_iter().map(|(chosen, terms)| {
            let sum = text::sum(&terms);
            let sum = match is_last {
                true => sum,
                false => equations.define(format!("minor{}_{chosen}", i + 1), sum),
            };
            (chosen, sum)
        });
        minors = sums.collect();
    }
    let zeros: Vec<String> = minors.into_values().collect();
    match zeros.len() {
        0 => Minors::Everywhere,
        count if count > MOST_MINORS => Minors::TooMany,
        _ => Minors::Zeros(zeros),
    }
}

/// Adds minors to the equations of a motion, because they vanish together in singular positions. Minors that are constants
/// decide the extent.
pub fn add_minors(
    mechanism: &Mechanism,
    minors: Vec<String>,
    motion: &mut Motion,
) -> Result<Extent, MechanismError> {
    let constants = motion.equations.constants(&minors, &mechanism.file)?;
    let largest = constants.iter().flatten().map(|value| modulus(*value));
    let largest = largest.reduce(f64::max);
    let is_rounded = !motion.warnings.is_empty();
    match largest {
        Some(size) if size > if is_rounded { UNCLEAR } else { ZERO } => return Ok(Extent::Nowhere),
        Some(_) if is_rounded => {
            return Err(mechanism.error(
                "whether it is singular in every position is not clear: its numbers are rounded",
            ));
        }
        _ => {}
    }
    let pairs = minors.into_iter().zip(constants);
    let others = pairs.filter_map(|(minor, constant)| constant.is_none().then_some(minor));
    let before = motion.equations.equations.len();
    motion.equations.equations.extend(others);
    Ok(match motion.equations.equations.len() == before {
        true => Extent::Everywhere,
        false => Extent::Solutions,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minors(rows: &[&[&str]], columns: usize) -> (Minors, Equations) {
        let rows: Vec<Vec<String>> = rows
            .iter()
            .map(|row| row.iter().map(|entry| entry.to_string()).collect())
            .collect();
        let mut equations = Equations::default();
        (largest_minors(&rows, columns, &mut equations), equations)
    }

    #[test]
    fn a_determinant_has_the_signs_of_its_permutations() {
        let (zeros, _) = minors(&[&["a", "b"], &["c", "d"]], 2);
        assert_eq!(zeros, Minors::Zeros(vec!["(d*a+(-c*b))".into()]));
    }

    #[test]
    fn a_high_matrix_has_a_minor_for_each_choice_of_rows() {
        let (zeros, _) = minors(&[&["a"], &["b"], &["c"]], 1);
        let expected = ["a", "b", "c"].map(String::from).to_vec();
        assert_eq!(zeros, Minors::Zeros(expected));
    }

    #[test]
    fn rows_with_too_few_columns_are_dependent_everywhere() {
        let (zeros, _) = minors(&[&["a", "0"], &["b", "0"]], 2);
        assert_eq!(zeros, Minors::Everywhere);
    }
}
