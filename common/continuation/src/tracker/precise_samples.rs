//! Precise samples: points at which doubles have followed a path around t = 0, with the digits of double-doubles.
//!
//! Whether several sheets run to infinity together lies below the noise of doubles, which follow them well enough all
//! the same. Newton's method with more digits takes that noise away, at eight samples at a time; the path need not be
//! followed again. Residuals alone need the digits: the Jacobian's elimination in doubles makes each correction shorter by
//! its condition number times their unit roundoff (iterative refinement: Higham, Accuracy and Stability of Numerical
//! Algorithms, 2002, chapter 12).

use crate::chart::LEAST_NORM;
use crate::endgames::cauchy::PreciseSample;
use crate::homotopies::Homotopy;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::called::{DoubleDoubleLanes, WIDTH};
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use num_complex::Complex64;

/// A relative correction this small leaves an error that no decision sees.
const SMALL: f64 = 1e-24;
/// A first correction is at most this: the samples have the digits of doubles, and are not multiple points.
const FIRST: f64 = 1e-6;
/// Corrections after the first are at most this part of the one before, or at most [`ROUNDING`].
const CONTRACTION: f64 = 1e-3;
/// Largest correction that counts as rounding.
const ROUNDING: f64 = 1e-18;
/// Newton steps at most.
const ROUNDS: u32 = 7;

/// Refined samples of one path.
pub(super) struct Found {
    /// The samples with more digits; `None` where Newton's method does not converge.
    pub samples: Option<Vec<PreciseSample>>,
    /// Number of evaluations of the equations.
    pub evaluations: u32,
}

/// Newton's method at samples of paths of one homotopy, with its work space.
pub(super) struct NewtonAtSamples<'a> {
    homotopy: &'a Homotopy,
    scratch: <Interpreter as Evaluate<DoubleDoubleLanes>>::Scratch,
    /// [J | H | H_t], and [J | H] at the vertices, rounded.
    matrix: Matrix<DoubleDoubleLanes>,
    rounded: Matrix<Lanes<WIDTH>>,
    x: Vec<Complex<DoubleDoubleLanes>>,
    p: Vec<Complex<DoubleDoubleLanes>>,
    dp: Vec<Complex<DoubleDoubleLanes>>,
}

impl<'a> NewtonAtSamples<'a> {
    /// Work space for one homotopy.
    pub(super) fn new(homotopy: &'a Homotopy) -> Self {
        let n = homotopy.dimension();
        let zero = Complex::zero(());
        Self {
            homotopy,
            scratch: Evaluate::<DoubleDoubleLanes>::scratch(homotopy.program(), ()),
            matrix: Matrix::zeros((), n, n + 2),
            rounded: Matrix::zeros((), n, n + 1),
            x: vec![zero; n],
            p: vec![zero; homotopy.parameter_count()],
            dp: vec![zero; homotopy.parameter_count()],
        }
    }

    /// The sample in one lane, where the last Newton step led.
    fn sample(&self, lane: usize, noise: f64) -> PreciseSample {
        let here: Vec<_> = self.x.iter().map(|z| z.single(lane)).collect();
        PreciseSample {
            homogenizing: self.homotopy.homogenizing((), &here),
            noise,
        }
    }
}

impl NewtonAtSamples<'_> {
    /// `places`: where the samples were taken, in t, and how far beside it the vertex is; `points`: the points there, one
    /// after another; `target`: which of the homotopy's targets the path goes to.
    pub(super) fn precise(
        &mut self,
        places: &[[Complex64; 2]],
        points: &[Complex64],
        target: u64,
    ) -> Found {
        let n = self.x.len();
        let mut samples = Vec::with_capacity(places.len());
        let mut evaluations = 0;
        for (places, points) in places.chunks(WIDTH).zip(points.chunks(n * WIDTH)) {
            let newton = Newton {
                space: self,
                places,
                points,
                target,
            };
            let Corrections { last, rounds } = dispatch_baseline(newton);
            evaluations += rounds * places.len() as u32;
            let Some(last) = last else {
                return Found {
                    samples: None,
                    evaluations,
                };
            };
            let in_lanes = last.into_iter().enumerate().take(places.len());
            samples.extend(in_lanes.map(|(lane, noise)| self.sample(lane, noise)));
        }
        Found {
            samples: Some(samples),
            evaluations,
        }
    }
}

/// Newton's method at as many samples as there are lanes.
struct Newton<'r, 'a> {
    space: &'r mut NewtonAtSamples<'a>,
    places: &'r [[Complex64; 2]],
    points: &'r [Complex64],
    target: u64,
}

/// Convergence of Newton's method at one sample.
struct Corrections {
    /// The last corrections, relative to the largest coordinates; `None` where it does not converge.
    last: Option<[f64; WIDTH]>,
    rounds: u32,
}

impl Job for Newton<'_, '_> {
    type Output = Corrections;
    #[inline(always)]
    fn run(self) -> Corrections {
        let space = self.space;
        let n = space.x.len();
        let mut t = Complex::from_f64((), 0.0, 0.0);
        let mut beside: Complex<Lanes<WIDTH>> = t;
        // Lanes without a sample of their own have the last one.
        for lane in 0..WIDTH {
            let sample = lane.min(self.places.len() - 1);
            t.set_lane(lane, self.places[sample][0]);
            beside.set_lane(lane, self.places[sample][1]);
            for (x, z) in space.x.iter_mut().zip(&self.points[sample * n..]) {
                x.set_lane(lane, *z);
            }
        }
        let (a, b) = space.homotopy.ends(self.target);
        let native = |z: Complex64| Complex::<DoubleDoubleLanes>::from_f64((), z.re, z.im);
        let a: Vec<_> = a.map(native).collect();
        let b: Vec<_> = b.map(native).collect();
        space
            .homotopy
            .path()
            .at((), &t, &a, &b, &mut space.p, &mut space.dp);
        let mut before = f64::INFINITY;
        let mut rounds = 0;
        let last = loop {
            let last = space.step(&beside);
            rounds += 1;
            let largest = last.iter().copied().fold(0.0, f64::max);
            let is_number = last.iter().all(|c| c.is_finite());
            let converges = largest
                <= if rounds == 1 {
                    FIRST
                } else {
                    CONTRACTION * before
                };
            let rests = largest <= SMALL || rounds > 1 && !converges && largest <= ROUNDING;
            if is_number && rests {
                break Some(last);
            }
            if !(is_number && converges) || rounds == ROUNDS {
                break None;
            }
            before = largest;
        };
        Corrections { last, rounds }
    }
}

impl NewtonAtSamples<'_> {
    /// A Newton step towards the path beside t in every lane; the corrections, relative to the largest coordinate.
    #[inline(always)]
    fn step(&mut self, beside: &Complex<Lanes<WIDTH>>) -> [f64; WIDTH] {
        let n = self.x.len();
        let (program, scratch) = (self.homotopy.program(), &mut self.scratch);
        program.linearize(&self.x, &self.p, &self.dp, &mut self.matrix, scratch);
        let beside = Complex::<DoubleDoubleLanes>::from_control((), beside);
        for i in 0..n {
            for j in 0..n {
                *self.rounded.at_mut(i, j) = self.matrix.at(i, j).control();
            }
            let mut value = *self.matrix.at(i, n);
            value.mul_add(&beside, self.matrix.at(i, n + 1));
            *self.rounded.at_mut(i, n) = value.control();
        }
        let mut exchanges = Lanes::from_f64((), 0.0);
        eliminate::<Lanes<WIDTH>, 1>(&mut self.rounded, &mut exchanges);
        let mut largest = [(0.0f64, LEAST_NORM * LEAST_NORM); WIDTH];
        for (i, x) in self.x.iter_mut().enumerate() {
            let delta = self.rounded.at(i, n);
            x.sub(&Complex::from_control((), delta));
            for (lane, (correction, size)) in largest.iter_mut().enumerate() {
                let here = delta.lane(lane).norm_sqr();
                if here > *correction || here.is_nan() {
                    *correction = here;
                }
                size.max(&x.lane(lane).norm_sqr());
            }
        }
        largest.map(|(correction, size)| (correction / size).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use crate::homotopies::HomotopyKind;
    use crate::path_result::PathResult;
    use crate::stage::PreparedStage;
    use crate::start_points::StartPoints;
    use crate::tracker::outcome::PathOutcome;
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, Work};
    use cognate_systems::named::reimer;

    fn ends(precision_bits: u32) -> Vec<PathResult> {
        let stage = Stage::new(
            Work::Track,
            HomotopyKind::StraightLine {
                parameters: Vec::new(),
            },
            StartPoints::TotalDegree {
                degrees: vec![2, 3, 4],
            },
            Settings {
                precision_bits,
                ..Settings::default()
            },
            3,
        );
        let prepared = PreparedStage::new(&reimer(3).system, &stage, &|_| None).unwrap();
        prepared.track(0..24, 8)
    }

    /// Refined samples of paths in doubles give the same ends at infinity and winding numbers as paths in
    /// double-doubles.
    #[test]
    fn doubles_follow_several_sheets_to_infinity() {
        let (doubles, precise) = (ends(53), ends(106));
        let mut several = 0;
        for (a, b) in doubles.iter().zip(&precise) {
            assert_eq!(a.outcome, b.outcome);
            if a.outcome == PathOutcome::Diverging {
                assert_eq!(a.winding_number, b.winding_number, "{a:?} {b:?}");
                several += u32::from(a.winding_number > Some(1) && a.precision_bits == 53);
            }
        }
        assert!(several >= 6, "{several}");
    }
}
