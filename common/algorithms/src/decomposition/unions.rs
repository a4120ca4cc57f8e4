//! Unions of witness points that are proved to be no components: intervals of their second derivatives, summed.
//!
//! Along a general moving slice the second derivatives of the witness points of a union of components have the sum 0
//! (see `continuation::bend`). Where the box of a sum does not hold 0, the points are not the points of a union of
//! components. Where all points together are the points of a union of components, the points without one component are,
//! too: unions of at most half of the points decide.

use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, Interval};

/// A vector, coordinate by coordinate, each in an interval.
pub(super) type Enclosed = Vec<Complex<Interval<f64>>>;

/// Most unions that are tried.
const MOST_UNIONS: u64 = 1 << 21;
/// More than the rounding error of an addition of doubles, relative to the largest sum.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Unions of points that are proved to be no components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Excluded {
    /// Number of unions.
    pub unions: u64,
    /// All unions of fewer points are among them.
    pub least_degree: u64,
    /// All proper unions, or what they leave, are among them.
    pub all: bool,
    /// Whether the sum over all points may be 0.
    pub whole_may_be_closed: bool,
    /// Whether the sum over a proper union is 0 to nearly all digits.
    pub closed_part: bool,
}

/// A sum in a box this small, relative to its terms, is taken for 0.
const CLOSED: f64 = 1e-9;

/// Values of one linear form at all points: centres, real part and imaginary part, with a radius of both.
struct Projected {
    centres: Vec<[f64; 2]>,
    radii: Vec<f64>,
}

impl Projected {
    fn new(derivatives: &[Enclosed], seed: u64) -> Self {
        let count = derivatives.first().map_or(0, Vec::len);
        let mut random = RandomStream::new(seed, Purpose::Probe, 3);
        let form: Vec<Complex<Interval<f64>>> = (0..count)
            .map(|_| random.unit())
            .map(|z| Complex::from_f64((), z.re, z.im))
            .collect();
        let (mut centres, mut radii) = (Vec::new(), Vec::new());
        for derivative in derivatives {
            let mut value = Complex::<Interval<f64>>::zero(());
            for (coefficient, t) in form.iter().zip(derivative) {
                value.mul_add(coefficient, t);
            }
            let middle = |part: &Interval<f64>| 0.5 * (part.lower() + part.upper());
            let centre = [middle(&value.re), middle(&value.im)];
            let mut around = value;
            around.sub(&Complex::from_f64((), centre[0], centre[1]));
            // NaN where nothing is known: no comparison with it holds.
            radii.push(around.re.magnitude() + around.im.magnitude());
            centres.push(centre);
        }
        Self { centres, radii }
    }

    /// Upper bound for the error of a sum of `count` of the values.
    fn slack(&self, count: usize) -> f64 {
        let largest = |values: &mut Vec<f64>| -> f64 {
            values.sort_by(|a, b| b.total_cmp(a));
            values.iter().take(count).sum()
        };
        let mut sizes: Vec<f64> = self
            .centres
            .iter()
            .map(|c| c[0].abs() + c[1].abs())
            .collect();
        let errors = largest(&mut self.radii.clone());
        (1.0 + 1e-9) * (errors + count as f64 * ROUNDING * largest(&mut sizes))
    }
}

/// Whether the box of the sum of these vectors may hold 0.
fn may_be_zero(derivatives: &[Enclosed], members: &[usize]) -> bool {
    let count = derivatives.first().map_or(0, Vec::len);
    (0..count).all(|v| {
        let mut sum = Complex::<Interval<f64>>::zero(());
        for &k in members {
            sum.add(&derivatives[k][v]);
        }
        sum.re.may_be_zero() && sum.im.may_be_zero()
    })
}

/// Whether the sum of these vectors is nearly 0, relative to their sizes.
fn is_nearly_zero(derivatives: &[Enclosed], members: &[usize]) -> bool {
    let count = derivatives.first().map_or(0, Vec::len);
    let size = |z: &Complex<Interval<f64>>| z.re.magnitude() + z.im.magnitude();
    let (mut largest, mut sizes) = (0.0f64, 0.0);
    for v in 0..count {
        let mut sum = Complex::<Interval<f64>>::zero(());
        for &k in members {
            sum.add(&derivatives[k][v]);
            sizes += size(&derivatives[k][v]);
        }
        largest = largest.max(size(&sum));
    }
    largest <= CLOSED * sizes
}

/// Walks through the unions of a given number of points, in the order of their places; `false` if one of them, the
/// chosen one, is not excluded.
struct Walk<'a> {
    derivatives: &'a [Enclosed],
    projected: &'a Projected,
    slack: f64,
    chosen: Vec<usize>,
}

impl Walk<'_> {
    fn excludes_all(&mut self, first: usize, left: usize, sum: [f64; 2]) -> bool {
        if left == 0 {
            let clear = sum[0].abs() > self.slack || sum[1].abs() > self.slack;
            return clear || !may_be_zero(self.derivatives, &self.chosen);
        }
        for k in first..=self.derivatives.len() - left {
            let centre = self.projected.centres[k];
            self.chosen.push(k);
            let sum = [sum[0] + centre[0], sum[1] + centre[1]];
            if !self.excludes_all(k + 1, left - 1, sum) {
                return false;
            }
            self.chosen.pop();
        }
        true
    }
}

/// The number of unions of `count` out of `points` points, as far as it does not exceed the most that are tried.
fn number_of_unions(points: u64, count: u64) -> Option<u64> {
    let mut number = 1u64;
    for k in 0..count {
        number = number.checked_mul(points - k)? / (k + 1);
        if number > MOST_UNIONS {
            return None;
        }
    }
    Some(number)
}

/// Tries unions of few points first. `derivatives`: x'' of each witness point.
pub(super) fn exclude(derivatives: &[Enclosed], seed: u64) -> Excluded {
    let degree = derivatives.len();
    let everything: Vec<usize> = (0..degree).collect();
    let mut exclusion = Excluded {
        unions: 0,
        least_degree: 1,
        all: false,
        whole_may_be_closed: may_be_zero(derivatives, &everything),
        closed_part: false,
    };
    let projected = Projected::new(derivatives, seed);
    for count in 1..=degree / 2 {
        // Of two halves of the points only the one with the first point is tried.
        let half = 2 * count == degree;
        let unions = match half {
            true => number_of_unions(degree as u64 - 1, count as u64 - 1),
            false => number_of_unions(degree as u64, count as u64),
        };
        let Some(unions) = unions.filter(|unions| exclusion.unions + unions <= MOST_UNIONS) else {
            return exclusion;
        };
        let mut walk = Walk {
            derivatives,
            projected: &projected,
            slack: projected.slack(count),
            chosen: Vec::new(),
        };
        let excluded = match half {
            true => {
                walk.chosen.push(0);
                walk.excludes_all(1, count - 1, projected.centres[0])
            }
            false => walk.excludes_all(0, count, [0.0; 2]),
        };
        if !excluded {
            exclusion.closed_part = is_nearly_zero(derivatives, &walk.chosen);
            return exclusion;
        }
        exclusion.unions += unions;
        exclusion.least_degree = count as u64 + 1;
    }
    exclusion.all = true;
    exclusion.least_degree = degree as u64;
    exclusion
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of two coordinates in boxes of this radius.
    fn boxes(values: &[[f64; 2]], radius: f64) -> Vec<Enclosed> {
        let part = |x: f64| Interval::new(x - radius, x + radius);
        let number = |&x: &f64| Complex {
            re: part(x),
            im: part(-x),
        };
        let vectors = values.iter();
        vectors.map(|v| v.iter().map(number).collect()).collect()
    }

    const FIVE: [[f64; 2]; 5] = [
        [1.0, 0.5],
        [-3.0, 2.0],
        [0.25, -4.0],
        [5.0, 1.0],
        [-3.25, 0.5],
    ];

    #[test]
    fn all_proper_unions_of_one_component_are_excluded() {
        let exclusion = exclude(&boxes(&FIVE, 1e-9), 1);
        let expected = Excluded {
            unions: 5 + 10,
            least_degree: 5,
            all: true,
            whole_may_be_closed: true,
            closed_part: false,
        };
        assert_eq!(exclusion, expected);
        // One alone is a component: no proper union is left.
        let exclusion = exclude(&boxes(&[[0.0, 0.0]], 1e-9), 1);
        assert!(exclusion.all && exclusion.whole_may_be_closed && exclusion.least_degree == 1);
    }

    #[test]
    fn two_components_together_are_not_excluded() {
        // The first two, and the last three.
        let mut values = FIVE;
        values[1] = [-1.0, -0.5];
        values[4] = [-5.25, 3.0];
        let exclusion = exclude(&boxes(&values, 1e-9), 1);
        assert_eq!((exclusion.least_degree, exclusion.all), (2, false));
        assert!(exclusion.whole_may_be_closed && exclusion.closed_part);
        let boxes = boxes(&values, 1e-9);
        assert!(may_be_zero(&boxes, &[0, 1]) && may_be_zero(&boxes, &[2, 3, 4]));
        assert!(!may_be_zero(&boxes, &[0, 2]));
    }

    #[test]
    fn a_missing_point_and_wide_boxes_are_seen() {
        let exclusion = exclude(&boxes(&FIVE[..4], 1e-9), 1);
        assert!(!exclusion.whole_may_be_closed);
        let exclusion = exclude(&boxes(&FIVE, 2.0), 1);
        assert_eq!(
            (exclusion.all, exclusion.least_degree, exclusion.unions),
            (false, 1, 0)
        );
        assert!(!exclusion.closed_part);
        let mut unknown = boxes(&FIVE, 1e-9);
        unknown[2][0].re = Interval::invalid(());
        unknown[2][1].re = Interval::invalid(());
        unknown[2][0].im = Interval::invalid(());
        unknown[2][1].im = Interval::invalid(());
        assert_eq!(exclude(&unknown, 1).least_degree, 1);
    }

    #[test]
    fn many_points_have_the_least_degree_that_can_be_tried() {
        let values: Vec<[f64; 2]> = (0..144).map(|k| [f64::from(k) + 0.5, 1.0]).collect();
        let exclusion = exclude(&boxes(&values, 1e-9), 1);
        assert_eq!((exclusion.least_degree, exclusion.all), (4, false));
    }
}
