//! The local ring of a configuration: how many functions on the configurations differ to each order, and what that says of their
//! dimension.

use super::assembly::Assembly;
use super::conditions::Evaluation;
use super::ranks::{Matrix, Ranks, Reduction};
use super::series::{Series, SeriesSpace};

/// Orders that are always told: lengths modulo powers 1 to 5 of the maximal ideal.
const LEAST_ORDER: usize = 4;
/// Highest order that is looked at.
const MOST_ORDER: usize = 12;
/// Local properties of a configuration that follow from the conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalRing {
    /// Number of coordinates less the rank of the conditions: freedoms to the first order.
    pub infinitesimal: usize,
    /// Lengths of the local ring modulo the (k+1)-th power of its maximal ideal.
    pub lengths: Vec<u64>,
    /// The dimension is not smaller: every equation takes one freedom at most.
    pub least_dimension: usize,
    /// The dimension is not larger: Macaulay's bound on the growth of Hilbert functions.
    pub most_dimension: usize,
    /// Whether the conditions that are independent to the first order are all: then the configurations are a manifold.
    pub is_regular: bool,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Doubt {
    /// The conditions do not hold at the configuration.
    Open,
    /// A singular value, as a part of the largest, that may be 0 or not.
    SingularValue(f64),
}

/// The conditions' values as series in all coordinates.
pub fn residuals<F: Ranks>(
    field: &F,
    assembly: &Assembly,
    space: &SeriesSpace<'_, F>,
    coordinates: &[Series<F::Element>],
) -> Vec<Series<F::Element>> {
    debug_assert_eq!(field.one(), space.field.one());
    let evaluation = Evaluation {
        space,
        values: &assembly.values,
        coordinates,
        size: &assembly.size,
    };
    let conditions = assembly.conditions.iter();
    conditions
        .flat_map(|condition| evaluation.residuals(condition, assembly.space))
        .collect()
}

/// The conditions to the first order: their values, and the rows of their derivatives.
pub fn first_order<F: Ranks>(
    field: &F,
    assembly: &Assembly,
) -> (Vec<F::Element>, Matrix<F::Element>) {
    let space = SeriesSpace::new(field, assembly.values.len(), 1);
    let variables = (0..assembly.values.len()).map(|v| space.variable(v));
    let offset = assembly.offset.iter().map(|x| field.constant(x));
    let coordinates: Vec<_> = variables
        .zip(offset)
        .map(|(variable, offset)| space.add(&variable, &space.constant(offset)))
        .collect();
    let list = residuals(field, assembly, &space, &coordinates);
    let values = list.iter().map(|series| series[0]).collect();
    (
        values,
        list.iter().map(|series| series[1..].to_vec()).collect(),
    )
}

/// The local ring at the configuration of an assembly, of which the dimension is known to be at least `least_dimension`.
pub fn local_ring<F: Ranks>(
    field: &F,
    assembly: &Assembly,
    least_dimension: usize,
) -> Result<LocalRing, Doubt> {
    let n = assembly.values.len();
    let (values, rows) = first_order(field, assembly);
    if !values.iter().all(|x| field.is_zero(*x)) {
        return Err(Doubt::Open);
    }
    // A condition that no coordinate enters takes no freedom.
    let conditions = rows.len() - assembly.constant_conditions();
    let reduction = field.reduce(&rows, n).map_err(Doubt::SingularValue)?;
    let freedoms = n - reduction.rank;
    let order = highest_order(freedoms, field.most_monomials());
    let space = SeriesSpace::new(field, freedoms, order);
    let equations = reduced(field, assembly, &space, &reduction);
    let is_identity = |series: &Series<F::Element>| series.iter().all(|x| field.is_zero(*x));
    let equations: Vec<_> = equations.into_iter().filter(|e| !is_identity(e)).collect();
    let mut ring = LocalRing {
        infinitesimal: freedoms,
        lengths: vec![1],
        least_dimension: n
            .saturating_sub(conditions)
            .min(freedoms)
            .max(least_dimension),
        most_dimension: freedoms,
        is_regular: reduction.rank == conditions,
    };
    for k in 1..=order {
        let columns = space.up_to[k];
        let rank = field.rank(multiples(&space, &equations, k), columns);
        let rank = rank.map_err(Doubt::SingularValue)?;
        let length = (columns - rank) as u64;
        let before = ring.lengths[k - 1];
        ring.lengths.push(length);
        ring.most_dimension = ring.most_dimension.min(growth(length - before, k as u64));
        let is_settled = ring.most_dimension <= ring.least_dimension;
        if k >= LEAST_ORDER && is_settled {
            break;
        }
    }
    Ok(ring)
}

fn highest_order(freedoms: usize, most_monomials: usize) -> usize {
    let monomials =
        |order: usize| (1..=order).fold(1usize, |n, k| n.saturating_mul(freedoms + k) / k);
    let fits = |order: &usize| monomials(*order) <= most_monomials;
    (LEAST_ORDER..=MOST_ORDER)
        .take_while(fits)
        .last()
        .unwrap_or(LEAST_ORDER - 1)
}

/// The conditions that the first order does not use, as series in the free coordinates: the others are solved order by order.
fn reduced<F: Ranks>(
    field: &F,
    assembly: &Assembly,
    space: &SeriesSpace<'_, F>,
    reduction: &Reduction<F::Element>,
) -> Vec<Series<F::Element>> {
    let n = assembly.values.len();
    let combine = |weights: &[F::Element], list: &[Series<F::Element>]| {
        let zero = space.constant(field.zero());
        weights
            .iter()
            .zip(list)
            .fold(zero, |sum, (weight, series)| {
                space.add(&sum, &space.scale(series, *weight))
            })
    };
    let mut coordinates: Vec<Series<F::Element>> = (0..n)
        .map(|i| {
            let weights: Vec<_> = reduction.kernel.iter().map(|v| v[i]).collect();
            let variables: Vec<_> = (0..space.variables).map(|v| space.variable(v)).collect();
            let offset = field.constant(&assembly.offset[i]);
            space.add(&combine(&weights, &variables), &space.constant(offset))
        })
        .collect();
    let mut list = residuals(field, assembly, space, &coordinates);
    for _ in 1..space.order {
        let corrections: Vec<_> = reduction.solve.iter().map(|w| combine(w, &list)).collect();
        for (i, coordinate) in coordinates.iter_mut().enumerate() {
            let weights: Vec<_> = reduction.lift.iter().map(|v| v[i]).collect();
            *coordinate = space.subtract(coordinate, &combine(&weights, &corrections));
        }
        list = residuals(field, assembly, space, &coordinates);
    }
    reduction.rest.iter().map(|w| combine(w, &list)).collect()
}

/// Rows: the equations times all monomials, up to a degree.
fn multiples<F: Ranks>(
    space: &SeriesSpace<'_, F>,
    equations: &[Series<F::Element>],
    degree: usize,
) -> Matrix<F::Element> {
    let columns = space.up_to[degree];
    let mut rows = Vec::new();
    // Equations begin with degree 2.
    let monomials = if degree >= 2 {
        space.up_to[degree - 2]
    } else {
        0
    };
    for equation in equations {
        for factor in 0..monomials {
            let mut row = vec![space.field.zero(); columns];
            for (k, x) in equation.iter().enumerate().take(columns) {
                if let Some(place) = space.product(factor, k).filter(|p| *p < columns) {
                    row[place] = *x;
                }
            }
            rows.push(row);
        }
    }
    rows
}

/// Macaulay: where the Hilbert function of a graded ring is h at degree k >= 1, the ring's dimension is not above this number.
/// h is a sum of binomials C(a, k) + C(b, k-1) + .. with a > b > .., and the function grows no faster than the same sum with all
/// of them raised, a polynomial of degree a - k.
fn growth(h: u64, k: u64) -> usize {
    if h == 0 {
        return 0;
    }
    let binomial = |a: u64| (1..=k).fold(1u128, |n, i| n * u128::from(a - k + i) / u128::from(i));
    let mut a = k;
    while binomial(a + 1) <= u128::from(h) {
        a += 1;
    }
    (a - k + 1) as usize
}

#[cfg(test)]
mod tests {
    use super::growth;

    #[test]
    fn growth_is_bounded_by_macaulay() {
        assert_eq!(growth(0, 3), 0);
        for k in 2..6 {
            assert_eq!((growth(1, k), growth(2, k)), (1, 1));
            assert_eq!(
                (growth(k, k), growth(k + 1, k), growth(k + 2, k)),
                (1, 2, 2)
            );
        }
        assert_eq!((growth(3, 1), growth(6, 2), growth(10, 3)), (3, 3, 3));
    }
}
