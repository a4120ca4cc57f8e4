//! Polars: where the Jacobian of equations and given rows are dependent.

use super::critical::{MOST_CRITICAL_VARIABLES, columns_of, determinant};
use crate::expression::NodeId;
use crate::system::System;
use cognate_numeric::random::RandomStream;
use cognate_numeric::rational::ComplexRational;

/// Random integers are at most this.
const MOST: i64 = 99;

/// A determinant after the equations of `system`: 0 where the Jacobian of the first `rows` of `combinations`, above
/// `towards` where it is given, has dependent rows, and on a random hypersurface elsewhere: the rows that are missing
/// to a square are random integers. `combinations` are equations in the same expressions.
///
/// With `towards`, values of the variables at a real point and for each variable the one that conjugation exchanges it
/// with, the row is half the gradient of the sum of (x_v - q_v)(x_w - q_w) over all v with partner w: the square of the distance to q
/// (Hauenstein: Numerically computing real points on algebraic sets, Acta Appl. Math. 125, 2013).
///
/// # Panics
/// When there are more rows than variables, or more variables than [`MOST_CRITICAL_VARIABLES`].
pub fn polar(
    system: &mut System,
    combinations: &[NodeId],
    towards: Option<(&[ComplexRational], &[usize])>,
    random: &mut RandomStream,
) {
    let n = system.variables.len();
    let given = combinations.len() + usize::from(towards.is_some());
    assert!(
        given <= n && n <= MOST_CRITICAL_VARIABLES,
        "at most as many rows as columns"
    );
    let e = &mut system.expressions;
    let mut columns = columns_of(e, combinations, n);
    if let Some((point, partners)) = towards {
        for (column, &partner) in columns.iter_mut().zip(partners) {
            let x = e.variable(u32::try_from(partner).expect("variables are counted in 32 bits"));
            let q = e.constant(point[partner].clone());
            column.push(Some(e.subtract(x, q)));
        }
    }
    for _ in given..n {
        for column in &mut columns {
            let entry = random.below(2 * MOST as u64) as i64 - MOST;
            let entry = if entry < 0 { entry } else { entry + 1 };
            column.push(Some(e.integer(entry)));
        }
    }
    let determinant = determinant(e, &columns);
    system.equations.push(determinant);
    let number = system.equations.len();
    system.equation_names.push(format!("polar:{number}"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;
    use cognate_numeric::random::Purpose;

    #[test]
    fn polars_have_the_degrees_of_their_rows() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f;\
                     f = x^2 - y^2*z;\nEND;\n";
        let mut system = crate::formats::read("test", text).unwrap().system;
        let rows = system.equations.clone();
        let mut random = RandomStream::new(1, Purpose::Test, 0);
        polar(&mut system, &rows, None, &mut random);
        let point: Vec<ComplexRational> = (1..=3).map(|k| ComplexRational::real((k, 7))).collect();
        polar(&mut system, &rows, Some((&point, &[0, 1, 2])), &mut random);
        assert_eq!(system.check(), Ok(()));
        assert_eq!(degrees(&system).unwrap().total, [3, 2, 3]);
    }
}
