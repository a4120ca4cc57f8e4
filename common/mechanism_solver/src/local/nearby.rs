//! Configurations near one: whether it closes, the nearest one that does, and whether there are as many around it as a dimension asks
//! for.

use super::assembly::Assembly;
use super::conditions::{Condition, Evaluation};
use super::field::{Constant, Doubles};
use super::local_ring::residuals;
use super::ranks::{Matrix, NONZERO, ZERO, singular_values};
use super::series::SeriesSpace;
use cognate_kinematics::plane::modulus;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// A configuration closes to this part of the size, or it is none.
pub const CLOSES: f64 = 1e-6;
/// Newton's corrections at most.
const MOST_CORRECTIONS: usize = 60;
/// Distance of the configurations that are looked for, in radians of half a turn or lengths.
const DISTANCE: f64 = 0.1;
/// Part of the largest singular value below which others are 0 while a slice is approached. Where the conditions lose rank on all of
/// the configurations, a singular value is about as small as the distance, and half the distance is left after each correction.
const APPROACHED: f64 = 1e-10;
/// Random slices that are tried.
const TRIES: u64 = 8;
/// Number of random slices that must meet the configurations.
const NEEDED: usize = 2;

/// The conditions and their derivatives at coordinates, in doubles.
pub struct Linearized {
    /// Residuals of the conditions.
    pub gaps: Vec<Complex64>,
    /// Rows of derivatives.
    pub rows: Matrix<Complex64>,
}

/// The conditions at coordinates.
pub fn linearized(assembly: &Assembly, at: &[Complex64]) -> Linearized {
    let space = SeriesSpace::new(&Doubles, at.len(), 1);
    let coordinates: Vec<_> = at
        .iter()
        .enumerate()
        .map(|(v, x)| space.add(&space.variable(v), &space.constant(*x)))
        .collect();
    let list = residuals(&Doubles, assembly, &space, &coordinates);
    Linearized {
        gaps: list.iter().map(|series| series[0]).collect(),
        rows: list.iter().map(|series| series[1..].to_vec()).collect(),
    }
}

/// The largest gap.
pub fn largest(gaps: &[Complex64]) -> f64 {
    gaps.iter().map(|x| modulus(*x)).fold(0.0, f64::max)
}

/// The largest gap of the conditions of the assembly, in parts of its size; loops that close by half a turn do not close.
pub fn gap(assembly: &Assembly) -> f64 {
    let at: Vec<Complex64> = assembly.offset.iter().map(|x| x.double.into()).collect();
    let space = SeriesSpace::new(&Doubles, 0, 0);
    let coordinates: Vec<_> = at.iter().map(|x| vec![*x]).collect();
    let evaluation = Evaluation {
        space: &space,
        values: &assembly.values,
        coordinates: &coordinates,
        size: &assembly.size,
    };
    let is_loop = |c: &&Condition| matches!(c, Condition::Loop(_));
    let traces = assembly.conditions.iter().filter(is_loop);
    let turned = traces
        .filter_map(|condition| evaluation.traces(condition))
        .map(|trace| modulus(trace - 3.0));
    let turned = turned.fold(0.0, f64::max);
    largest(&linearized(assembly, &at).gaps).max(if turned > 1e-3 { turned } else { 0.0 })
}

/// One correction by the shortest vector, singular values below a part of the largest left out.
pub fn corrected(
    at: &mut [Complex64],
    rows: &Matrix<Complex64>,
    gaps: &[Complex64],
    least_part: f64,
) {
    let columns = (0..at.len()).map(|c| rows.iter().map(|row| row[c]).collect());
    let svd = Svd::of(columns.collect());
    let first = svd.values.first().copied().unwrap_or(0.0);
    let rank = svd
        .values
        .iter()
        .take(rows.len())
        .filter(|x| **x > least_part * first)
        .count();
    for (x, step) in at.iter_mut().zip(svd.least_squares(gaps, rank)) {
        *x -= step;
    }
}

/// The assembly at the nearest configuration that closes; as it is where it closes already.
pub fn refined(mut assembly: Assembly) -> Assembly {
    let mut at: Vec<Complex64> = assembly.offset.iter().map(|x| x.double.into()).collect();
    let mut has_moved = false;
    for _ in 0..MOST_CORRECTIONS {
        let linearization = linearized(&assembly, &at);
        if largest(&linearization.gaps) <= ZERO / 100.0 || linearization.rows.is_empty() {
            break;
        }
        corrected(&mut at, &linearization.rows, &linearization.gaps, NONZERO);
        has_moved = true;
    }
    if has_moved {
        assembly.offset = at.iter().map(|x| Constant::rounded(x.re)).collect();
    }
    assembly
}

/// Whether the configurations around this one have at least this dimension: random slices of the complementary dimension beside
/// it meet them, and at the places where they do there are as many freedoms.
pub fn has_dimension(assembly: &Assembly, dimension: usize, seed: u64) -> bool {
    let slices = Slices {
        dimension,
        distance: DISTANCE,
        seed,
    };
    let met = (0..TRIES).filter(|index| slices.meeting(assembly, *index).is_some());
    met.take(NEEDED).count() == NEEDED
}

/// Whether the configurations around this one, with other values of a coordinate, have at least this dimension: slices beside
/// it at two distances meet them where the coordinate is not 0: at least about the square of the distance, as a parabola has it,
/// because the fifth power of a smaller one counts as 0 here.
pub fn has_dimension_over(
    assembly: &Assembly,
    coordinate: usize,
    dimension: usize,
    seed: u64,
) -> bool {
    [DISTANCE, DISTANCE / 10.0].into_iter().all(|distance| {
        let slices = Slices {
            dimension,
            distance,
            seed,
        };
        let is_other = |at: &Vec<Complex64>| modulus(at[coordinate]) > distance * distance / 4.0;
        let met =
            (0..TRIES).filter(|k| slices.meeting(assembly, *k).as_ref().is_some_and(is_other));
        met.take(NEEDED).count() == NEEDED
    })
}

/// Random slices of the complementary dimension beside a configuration.
struct Slices {
    /// Number of linear conditions.
    dimension: usize,
    /// Distance from the configuration, in radians of half a turn or parts of the size.
    distance: f64,
    seed: u64,
}

impl Slices {
    /// A configuration on a slice, where one is met at about the distance and has as many freedoms as there are conditions.
    fn meeting(&self, assembly: &Assembly, index: u64) -> Option<Vec<Complex64>> {
        let Self {
            dimension,
            distance,
            seed,
        } = *self;
        let n = assembly.values.len();
        let mut random = RandomStream::new(seed, Purpose::Probe, index);
        let origin: Vec<Complex64> = assembly.offset.iter().map(|x| x.double.into()).collect();
        let forms: Matrix<Complex64> = (0..dimension)
            .map(|_| (0..n).map(|_| random.unit()).collect())
            .collect();
        // Begins in a direction that the first order allows.
        let kernel = {
            let Linearized { rows, .. } = linearized(assembly, &origin);
            let columns = (0..n).map(|c| rows.iter().map(|row| row[c]).collect());
            let svd = Svd::of(columns.collect());
            let first = svd.values.first().copied().unwrap_or(0.0).max(ZERO);
            let free = (0..n).filter(|k| *k >= rows.len() || svd.values[*k] <= NONZERO * first);
            free.map(|k| svd.domain[k].clone()).collect::<Vec<_>>()
        };
        let mut at = origin.clone();
        for vector in &kernel {
            let factor = random.unit() * distance * 2.0;
            for (x, v) in at.iter_mut().zip(vector) {
                *x += factor * v;
            }
        }
        let value = |form: &Vec<Complex64>, at: &[Complex64]| {
            form.iter().zip(at).map(|(f, x)| f * x).sum::<Complex64>()
        };
        let levels: Vec<Complex64> = forms.iter().map(|form| value(form, &at)).collect();
        for _ in 0..MOST_CORRECTIONS {
            let Linearized { mut gaps, mut rows } = linearized(assembly, &at);
            gaps.extend(
                forms
                    .iter()
                    .zip(&levels)
                    .map(|(f, level)| value(f, &at) - level),
            );
            let is_near = at.iter().all(|x| x.norm_sqr() < 100.0);
            if !is_near || gaps.iter().any(|x| !x.norm_sqr().is_finite()) {
                return None;
            }
            if largest(&gaps) <= 1e-13 {
                let conditions = rows.len();
                let apart = at.iter().zip(&origin).map(|(x, o)| modulus(x - o));
                let apart = apart.fold(0.0, f64::max);
                let values = singular_values(&rows, n);
                let first = values.first().copied().unwrap_or(0.0);
                let rank = values.iter().filter(|x| **x > NONZERO * first).count();
                let is_met = conditions > 0
                    && (distance / 2.0..=10.0 * distance).contains(&apart)
                    && n - rank >= dimension;
                return is_met.then_some(at);
            }
            rows.extend(forms.iter().cloned());
            corrected(&mut at, &rows, &gaps, APPROACHED);
        }
        None
    }
}
