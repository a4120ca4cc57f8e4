//! Equations that can be kept as they are where the others are combined.

use crate::polynomial::{Degrees, Polynomial};
use crate::system::System;
use cognate_numeric::rational::ComplexRational;

/// Most variables of one equation that is looked at: what follows is elimination in exact numbers.
const MOST_VARIABLES: usize = 12;

/// Linear equations and smooth quadrics, no two of them in one variable; those of lower degree
/// first, then those in fewer variables, which leave more to others.
///
/// The gradient of each vanishes at none of its zeros, and gradients in different variables are
/// independent. So they cut a smooth set with one dimension less for each of them, wherever it is
/// cut: as many general combinations of the other equations as are missing keep every isolated
/// solution on it, as they do in the whole space (Bertini's theorem; Sommese, Wampler 2005,
/// theorem 13.5.1). Circles c^2 + s^2 = 1 and lengths of vectors are such equations.
///
/// None where a group is homogeneous, and none with parameters or coefficients that are not
/// rational.
pub(super) fn independent(system: &System, degrees: &Degrees) -> Vec<usize> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return Vec::new();
    }
    let (variables, parameters) = (system.variables.len(), system.parameters.len());
    let mut candidates: Vec<(u32, Vec<usize>, usize)> = Vec::new();
    for (i, &equation) in system.equations.iter().enumerate() {
        let degree = degrees.total[i];
        if degree > 2 {
            continue;
        }
        let Some(f) = Polynomial::expand(&system.expressions, equation, variables, parameters)
        else {
            continue;
        };
        let of_parameters = |e: &Vec<u32>| e[variables..].iter().any(|&k| k > 0);
        let occurs = |&v: &usize| f.terms.keys().any(|e| e[v] > 0);
        let mine: Vec<usize> = (0..variables).filter(occurs).collect();
        if f.terms.keys().any(of_parameters)
            || mine.len() > MOST_VARIABLES
            || (degree == 2 && !is_regular(quadratic_form(&f, &mine)))
        {
            continue;
        }
        candidates.push((degree, mine, i));
    }
    candidates.sort_by_key(|(degree, mine, i)| (*degree, mine.len(), *i));
    let mut taken = vec![false; variables];
    let mut independent_rows = Vec::new();
    for (_, mine, i) in candidates {
        if mine.iter().all(|&v| !taken[v]) {
            for v in mine {
                taken[v] = true;
            }
            independent_rows.push(i);
        }
    }
    independent_rows
}

/// Twice the symmetric matrix of a polynomial of degree 2 in these variables, homogenised: the
/// last row belongs to 1.
fn quadratic_form(f: &Polynomial, variables: &[usize]) -> Vec<Vec<ComplexRational>> {
    let n = variables.len();
    let mut matrix = vec![vec![ComplexRational::default(); n + 1]; n + 1];
    for (exponents, coefficient) in &f.terms {
        // The two places of a term; 1 stands for what a lower degree lacks.
        let mut places = Vec::new();
        for (place, &v) in variables.iter().enumerate() {
            places.extend(std::iter::repeat_n(place, exponents[v] as usize));
        }
        places.resize(2, n);
        let (i, j) = (places[0], places[1]);
        matrix[i][j] = matrix[i][j].add(coefficient);
        matrix[j][i] = matrix[j][i].add(coefficient);
    }
    matrix
}

/// Whether a matrix is regular, by elimination. The gradient of a quadric with a regular matrix vanishes at none of the
/// quadric's points.
fn is_regular(mut matrix: Vec<Vec<ComplexRational>>) -> bool {
    let n = matrix.len();
    for column in 0..n {
        let Some(pivot) = (column..n).find(|&row| !matrix[row][column].is_zero()) else {
            return false;
        };
        matrix.swap(column, pivot);
        let top = matrix[column].clone();
        for row in &mut matrix[column + 1..] {
            let Some(factor) = row[column].divide(&top[column]) else {
                return false;
            };
            for (entry, above) in row.iter_mut().zip(&top).skip(column) {
                *entry = entry.subtract(&factor.multiply(above));
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;

    fn kept(text: &str) -> Vec<usize> {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        let system = match crate::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        };
        independent(&system, &degrees(&system).unwrap())
    }

    #[test]
    fn circles_and_parabolas_are_smooth_and_cones_are_not() {
        let names = "variable_group x, y, z; function f;";
        let one = |equation: &str| kept(&format!("{names} f = {equation};")).len();
        assert_eq!(one("x^2 + y^2 - 1"), 1);
        assert_eq!(one("x^2 - y"), 1);
        assert_eq!(one("x*y - 1"), 1);
        assert_eq!(one("x^2 + y^2 - z^2"), 0, "singular at 0");
        assert_eq!(one("x*y - x - y + 1"), 0, "two lines meet");
        assert_eq!(one("(x + y)^2"), 0);
        assert_eq!(one("x^2 - 2"), 1);
        assert_eq!(one("x + y - 1"), 1);
        assert_eq!(one("x^3 - y"), 0, "of degree 3");
    }

    #[test]
    fn no_two_have_a_variable_in_common() {
        let system = "variable_group x, y, z; parameter p; function f1, f2, f3, f4; \
                      f1 = x^2 + y^2 - 1; f2 = y^2 + z^2 - 1; f3 = z^2 - 2; f4 = z - p;";
        assert_eq!(kept(system), [2, 0]);
        let linear = "variable_group x, y; function f1, f2; f1 = x^2 + y^2 - 1; f2 = x - y;";
        assert_eq!(kept(linear), [1], "the linear one goes first");
        let wide = "variable_group x, y, z, w; function f1, f2, f3; \
                    f1 = x*y + z*w - 1; f2 = x^2 + y^2 - 1; f3 = z^2 + w^2 - 1;";
        assert_eq!(
            kept(wide),
            [1, 2],
            "two in two variables rather than one in four"
        );
    }
}
