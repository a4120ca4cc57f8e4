//! Iterative refinement: regular finite ends of paths, brought to the digits that doubles can show.
//!
//! Newton's method with residuals in double-doubles and eliminations in doubles, eight ends at a time (Higham, Accuracy
//! and Stability of Numerical Algorithms, 2002, chapter 12); with more digits where double-doubles do not suffice. The
//! results of a stage's paths come in; in each that ends at a regular finite point of the system the endpoint
//! and its accuracy are replaced. The point becomes homogeneous coordinates in which each group's divisor (the homogenising
//! coordinate, or the largest one of a homogeneous group) is a power of two, so that the values of the variables are
//! those of the solution, rounded once.

use crate::chart::{Chart, norm};
use crate::endgames::cauchy::generic_form;
use crate::homotopies::Homotopy;
use crate::path_result::{Coordinates, PathResult, REFINED_ERROR};
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use crate::tracker::outcome::PathOutcome;
use cognate_machine_code::Evaluator;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::called::{DoubleDoubleLanes, WIDTH};
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs, unit_roundoff};
use cognate_numeric::scalar::{Complex, DoubleDouble, MultiplePrecision, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use num_complex::Complex64;

/// Newton steps at most.
const ROUNDS: usize = 6;
/// A first correction is at most this part of the largest coordinate: an end has more digits than that.
const FIRST: f64 = 1e-6;
/// A first correction is at most this where all coordinates are small, as at the solution 0: absolute.
const FIRST_NEAR_ZERO: f64 = 1e-12;
/// Corrections after the first are at most this part of the one before.
const CONTRACTION: f64 = 1e-2;
/// Largest correction, as a part of the largest coordinate, after which only the rounding of double-doubles is left
/// (2^-80).
const SETTLED: f64 = 8.271_806_125_530_277e-25;
/// Largest correction, as a part of the largest coordinate, that counts as rounding if it is no longer smaller than the
/// one before (2^-60).
const AT_REST: f64 = 8.673_617_379_884_035e-19;
/// Coordinates smaller than this (2^-20) have the digits that they would have at this size.
const LEAST_SIZE: f64 = 9.536_743_164_062_5e-7;
/// Bound of errors, as a multiple of their estimates.
const MARGIN: f64 = 64.0;
/// A divisor is told from 0 where its error is at most this part of it.
const TOLD_FROM_ZERO: f64 = 1e-3;
/// Condition numbers above this are those of ends that are regular in their own units only (`scaled_newton`), unless more
/// digits than doubles found them.
const CONDITION_BY_DOUBLES: f64 = 1e13;
/// The digits of each coordinate of an end with a condition number above [`CONDITION_BY_DOUBLES`] differ by at most
/// this part of it after refinement.
const SAME: f64 = 1e-12;
/// Points whose coordinates differ by more than this factor are left as they are: squares must be doubles.
const FARTHEST: f64 = 1e140;

/// A point of the chart and bounds of its coordinates' errors.
pub(super) struct PrecisePoint<S> {
    pub(super) x: Vec<Complex<S>>,
    errors: Vec<f64>,
}

/// A point as a path's result has it.
struct Rounded {
    /// Homogeneous coordinates, normalised.
    endpoint: Vec<Complex64>,
    /// Bound of the error relative to the largest value of a variable, before the rounding to doubles.
    error: f64,
}

/// The larger of the real and the imaginary part.
fn size(z: Complex64) -> f64 {
    z.re.abs().max(z.im.abs())
}

impl<S: Real> PrecisePoint<S> {
    /// The values of the variables, rounded to doubles once, as normalised homogeneous coordinates; `None` where the point
    /// is not finite as far as its errors tell.
    ///
    /// A real or imaginary part that its error may make 0 is written 0.
    fn rounded(&self, chart: &Chart, context: S::Context) -> Option<Rounded> {
        let unit = 16.0 * unit_roundoff(S::bits(context));
        let mut endpoint = Vec::new();
        let (mut worst, mut largest) = (0.0f64, 0.0f64);
        for group in 0..chart.group_count() {
            let (patch, first) = chart.patch(group);
            let end = first + patch.len() - 1;
            let (free, errors) = (&self.x[first..end], &self.errors[first..end]);
            // The removed coordinate and its error.
            let mut removed = Complex::<S>::from_f64(context, patch[0].re, patch[0].im);
            let mut removed_error = 0.0;
            for ((c, y), error) in patch[1..].iter().zip(free).zip(errors) {
                if *c == Complex64::default() {
                    continue;
                }
                removed.mul_add(&Complex::from_f64(context, c.re, c.im), y);
                removed_error += 2.0 * size(*c) * (error + unit * size(y.lane(0)));
            }
            let coordinates = std::iter::once(&removed).chain(free);
            let errors = std::iter::once(&removed_error).chain(errors);
            let both: Vec<(&Complex<S>, f64)> = coordinates.zip(errors.copied()).collect();
            let divisor = match chart.is_homogeneous(group) {
                false => 0,
                true => largest_of(&both),
            };
            let (by, by_error) = both[divisor];
            let by_size = size(by.lane(0));
            let is_finite = by_error <= TOLD_FROM_ZERO * by_size;
            if !is_finite {
                return None;
            }
            // In an affine chart coordinates are the values of the variables.
            let is_one = divisor == 0 && by_error == 0.0 && by.lane(0) == Complex64::new(1.0, 0.0);
            let inverse = by.inverse();
            for (place, (y, error)) in both.iter().enumerate() {
                if place == divisor {
                    endpoint.push(Complex64::new(1.0, 0.0));
                    continue;
                }
                let mut quotient = (*y).clone();
                if !is_one {
                    quotient.mul(&inverse);
                }
                let value = quotient.lane(0);
                let here = size(value);
                let error = 4.0 * (error + here * by_error) / by_size + unit * here;
                let has_a_square = here <= FARTHEST;
                if !has_a_square {
                    return None;
                }
                let part = |part: f64| if part.abs() <= error { 0.0 } else { part };
                let value = Complex64::new(part(value.re), part(value.im));
                endpoint.push(value);
                largest = largest.max(size(value));
                worst = worst.max(error);
            }
        }
        chart.normalize(&mut endpoint);
        let error = worst / if largest > 0.0 { largest } else { 1.0 };
        Some(Rounded { endpoint, error })
    }
}

/// Index of the largest coordinate; the first of equals.
fn largest_of<S: Real>(coordinates: &[(&Complex<S>, f64)]) -> usize {
    let mut best = (0, 0.0);
    for (place, (y, _)) in coordinates.iter().enumerate() {
        let here = y.lane(0).norm_sqr();
        if here > best.1 {
            best = (place, here);
        }
    }
    best.0
}

/// Whether each coordinate of one point is that of another but for its last digits.
fn same_in_own_units(chart: &Chart, a: &[Complex64], b: &[Complex64]) -> bool {
    let mut first = 0;
    (0..chart.group_count()).all(|group| {
        let here = first..first + chart.group_size(group);
        first = here.end;
        let scale = a[here.start] / b[here.start];
        let mut both = a[here.clone()].iter().zip(&b[here]);
        both.all(|(a, b)| size(a - b * scale) <= SAME * size(*a))
    })
}

impl PreparedStage {
    /// Refines the regular finite ends among the results of these items, `first` and those after it.
    ///
    /// An end is refined as it would be alone. Its counts and `precision_bits` remain those of the path.
    pub(super) fn refine_ends(&self, first: u64, results: &mut [PathResult]) {
        if !self.ends_at_the_system() {
            return;
        }
        let homotopy = self.homotopy();
        let mut waiting = Vec::new();
        for (place, result) in results.iter().enumerate() {
            if let Some(point) = self.refinable(result) {
                let (_, target) = self.item(first + place as u64);
                waiting.push(RoughEnd {
                    place,
                    point,
                    target,
                });
            }
        }
        if waiting.is_empty() {
            return;
        }
        let mut newton = NewtonAtEnds::new(homotopy);
        for ends in waiting.chunks(WIDTH) {
            let points = newton.refine(ends);
            for (end, point) in ends.iter().zip(points) {
                let rounded = point
                    .and_then(|point| point.rounded(homotopy.chart(), ()))
                    .filter(|rounded| rounded.error <= REFINED_ERROR)
                    .or_else(|| self.with_more_digits(end));
                let result = &mut results[end.place];
                let rounded = rounded.filter(|rounded| {
                    let coordinates = result.endpoint.to_double();
                    result.condition <= CONDITION_BY_DOUBLES
                        || same_in_own_units(homotopy.chart(), coordinates, &rounded.endpoint)
                });
                if let Some(rounded) = rounded {
                    result.endpoint = Coordinates::Double(rounded.endpoint);
                    result.accuracy = f64::EPSILON + rounded.error;
                }
            }
        }
    }

    /// The point of the chart where a path ends, where that is regular and finite.
    fn refinable(&self, result: &PathResult) -> Option<Vec<Complex64>> {
        let homotopy = self.homotopy();
        let coordinates = result.endpoint.to_double();
        let is_finite = homotopy.smallest_homogenizing(coordinates) > 1.0 / FARTHEST;
        if result.outcome != PathOutcome::Regular || !is_finite {
            return None;
        }
        homotopy.chart().point(coordinates)
    }

    /// An end by Newton's method on the rungs above double-doubles.
    fn with_more_digits(&self, end: &RoughEnd) -> Option<Rounded> {
        let (homotopy, settings) = (self.homotopy(), self.settings());
        let mut above = rungs(DOUBLE_DOUBLE, settings.max_precision_bits).skip(1);
        above.find_map(|bits| {
            let mut point = end.point.clone();
            let refiner = Refiner::<MultiplePrecision>::new(homotopy, bits);
            let mut refiner = refiner.with_all_digits();
            let report = refiner.refine(&mut point, end.target);
            let largest = largest_part(end.point.iter().copied());
            let moved = largest_part(point.iter().zip(&end.point).map(|(a, b)| a - b));
            let is_near = moved <= (FIRST * largest).max(FIRST_NEAR_ZERO);
            if !(report.converged && is_near) {
                return None;
            }
            let error = MARGIN * report.accuracy * norm(&point);
            let precise = PrecisePoint {
                x: refiner.last().to_vec(),
                errors: vec![error; point.len()],
            };
            let rounded = precise.rounded(homotopy.chart(), bits)?;
            (rounded.error <= REFINED_ERROR).then_some(rounded)
        })
    }
}

/// A regular end with the digits that the tracker gave it.
#[derive(Clone)]
pub(super) struct RoughEnd {
    /// The end's place among the results.
    pub(super) place: usize,
    /// The point of the chart.
    pub(super) point: Vec<Complex64>,
    pub(super) target: u64,
}

/// Newton's method at ends of paths of one homotopy, with its work space.
pub(super) struct NewtonAtEnds<'a> {
    homotopy: &'a Homotopy,
    scratch: <Interpreter as Evaluate<DoubleDoubleLanes>>::Scratch,
    scratch_of_doubles: <Evaluator as Evaluate<Lanes<WIDTH>>>::Scratch,
    /// [J | ...] at the ends as they came, in doubles.
    jacobian: Matrix<Lanes<WIDTH>>,
    /// [J | H | rounding], eliminated.
    matrix: Matrix<Lanes<WIDTH>>,
    x: Vec<Complex<DoubleDoubleLanes>>,
    values: Vec<Complex<DoubleDoubleLanes>>,
    /// The sum of the moduli of each equation's terms, with the equation's phase.
    rounding: Vec<Complex<Lanes<WIDTH>>>,
    /// A phase for each equation: rounding errors of equations do not cancel.
    phases: Vec<Complex64>,
}

/// Progress of Newton's method in one lane.
#[derive(Clone, Copy, PartialEq)]
enum Progress {
    /// The next correction follows the last one, of this size; infinite before the first.
    Under(f64),
    /// The point is settled: this is the error that Newton's method leaves, beside that of rounding.
    Settled(f64),
    /// The corrections do not shrink.
    Stopped,
}

impl Progress {
    /// Computes the progress after a correction, where the largest coordinate is `largest`, and whether the correction
    /// is made.
    fn after(self, correction: f64, largest: f64) -> (Self, bool) {
        let Self::Under(before) = self else {
            return (self, false);
        };
        let within = |part: f64| correction <= part * largest.max(LEAST_SIZE);
        if before.is_infinite() {
            let near = correction <= (FIRST * largest).max(FIRST_NEAR_ZERO);
            return match (within(SETTLED), near) {
                (true, _) => (Self::Settled(correction), true),
                (false, true) => (Self::Under(correction), true),
                (false, false) => (Self::Stopped, false),
            };
        }
        let shrinks = correction <= CONTRACTION * before;
        match (shrinks, within(SETTLED), within(AT_REST)) {
            (true, true, _) => {
                let contraction = MARGIN * correction / before;
                (Self::Settled(correction * contraction.min(1.0)), true)
            }
            (true, false, _) => (Self::Under(correction), true),
            (false, _, true) => (Self::Settled(MARGIN * correction), true),
            (false, _, false) => (Self::Stopped, false),
        }
    }
}

impl<'a> NewtonAtEnds<'a> {
    pub(super) fn new(homotopy: &'a Homotopy) -> Self {
        let n = homotopy.dimension();
        Self {
            homotopy,
            scratch: Evaluate::<DoubleDoubleLanes>::scratch(homotopy.program(), ()),
            scratch_of_doubles: Evaluate::<Lanes<WIDTH>>::scratch(homotopy.evaluator(), ()),
            jacobian: Matrix::zeros((), n, n + 2),
            matrix: Matrix::zeros((), n, n + 2),
            x: vec![Complex::zero(()); n],
            values: vec![Complex::zero(()); n],
            rounding: vec![Complex::zero(()); n],
            phases: generic_form().take(n).collect(),
        }
    }

    /// Ends, at most as many as there are lanes, with the digits of double-doubles; `None` where Newton's method does not
    /// settle.
    pub(super) fn refine(
        &mut self,
        ends: &[RoughEnd],
    ) -> Vec<Option<PrecisePoint<DoubleDouble<f64>>>> {
        let parameters = self.load(ends);
        let progress = dispatch_baseline(Newton {
            space: self,
            parameters: &parameters,
        });
        let lanes = progress.into_iter().take(ends.len()).enumerate();
        lanes
            .map(|(lane, progress)| match progress {
                Progress::Settled(left) => Some(self.point(lane, left)),
                Progress::Under(_) | Progress::Stopped => None,
            })
            .collect()
    }

    /// Makes one Newton step in doubles at each of these ends, at most as many as there are lanes.
    pub(super) fn steps_in_doubles(&mut self, ends: &[RoughEnd]) -> Vec<StepInDoubles> {
        let parameters = self.load(ends);
        let mut steps = dispatch_baseline(Step {
            space: self,
            parameters: &parameters,
        })
        .to_vec();
        steps.truncate(ends.len());
        steps
    }

    /// Puts the ends into the lanes; their parameters at t = 0.
    fn load(&mut self, ends: &[RoughEnd]) -> Vec<Complex<DoubleDoubleLanes>> {
        // Lanes without an end of their own have the last one.
        let end_of = |lane: usize| &ends[lane.min(ends.len() - 1)];
        let mut parameters =
            vec![Complex::<DoubleDoubleLanes>::zero(()); self.homotopy.parameter_count()];
        for lane in 0..WIDTH {
            let end = end_of(lane);
            for (x, z) in self.x.iter_mut().zip(&end.point) {
                x.set_lane(lane, *z);
            }
            // At t = 0 the parameters are those of the target.
            for (p, z) in parameters.iter_mut().zip(self.homotopy.ends(end.target).0) {
                p.set_lane(lane, z);
            }
        }
        parameters
    }

    /// The point of a lane in which Newton's method leaves this error.
    fn point(&self, lane: usize, left: f64) -> PrecisePoint<DoubleDouble<f64>> {
        let n = self.x.len();
        let unit = unit_roundoff(DOUBLE_DOUBLE);
        let rounding = (0..n).map(|i| MARGIN * unit * size(self.matrix.at(i, n + 1).lane(lane)));
        PrecisePoint {
            x: self.x.iter().map(|z| z.single(lane)).collect(),
            errors: rounding.map(|rounding| rounding + left).collect(),
        }
    }
}

/// Newton steps in all lanes until each is settled or has stopped.
struct Newton<'r, 'a> {
    space: &'r mut NewtonAtEnds<'a>,
    parameters: &'r [Complex<DoubleDoubleLanes>],
}

impl Job for Newton<'_, '_> {
    type Output = [Progress; WIDTH];
    #[inline(always)]
    fn run(self) -> [Progress; WIDTH] {
        let Newton { space, parameters } = self;
        let n = space.x.len();
        let homotopy = space.homotopy;
        space.linearize(parameters);
        let mut progress = [Progress::Under(f64::INFINITY); WIDTH];
        for _ in 0..ROUNDS {
            let (program, scratch) = (homotopy.program(), &mut space.scratch);
            program.value(&space.x, parameters, &mut space.values, scratch);
            space.matrix.clone_from(&space.jacobian);
            for i in 0..n {
                *space.matrix.at_mut(i, n) = space.values[i].control();
                *space.matrix.at_mut(i, n + 1) = space.rounding[i];
            }
            let mut exchanges = Lanes::from_f64((), 0.0);
            let elimination = homotopy.elimination();
            elimination.eliminate::<Lanes<WIDTH>, 2>(&mut space.matrix, &mut exchanges);
            let mut moves = [false; WIDTH];
            for (lane, (progress, moves)) in progress.iter_mut().zip(&mut moves).enumerate() {
                let largest = largest_part((0..n).map(|i| space.x[i].lane(lane)));
                let correction = largest_part((0..n).map(|i| space.matrix.at(i, n).lane(lane)));
                (*progress, *moves) = progress.after(correction, largest);
            }
            for i in 0..n {
                let mut correction = *space.matrix.at(i, n);
                for (lane, moves) in moves.iter().enumerate() {
                    if !moves {
                        correction.set_lane(lane, Complex64::default());
                    }
                }
                space.x[i].sub(&Complex::from_control((), &correction));
            }
            if !progress.iter().any(|p| matches!(p, Progress::Under(_))) {
                break;
            }
        }
        progress
    }
}

/// A Newton step in doubles.
#[derive(Clone, Copy)]
pub(super) struct StepInDoubles {
    /// The size of the correction.
    pub(super) correction: f64,
    /// Estimate of what rounding in the evaluation of the equations contributes to the correction.
    pub(super) rounding: f64,
    /// The size of the point.
    pub(super) largest: f64,
}

/// One Newton step in doubles in all lanes; the points are not moved.
struct Step<'r, 'a> {
    space: &'r mut NewtonAtEnds<'a>,
    parameters: &'r [Complex<DoubleDoubleLanes>],
}

impl Job for Step<'_, '_> {
    type Output = [StepInDoubles; WIDTH];
    #[inline(always)]
    fn run(self) -> [StepInDoubles; WIDTH] {
        let Step { space, parameters } = self;
        let n = space.x.len();
        space.linearize(parameters);
        space.matrix.clone_from(&space.jacobian);
        for i in 0..n {
            *space.matrix.at_mut(i, n + 1) = space.rounding[i];
        }
        let mut exchanges = Lanes::from_f64((), 0.0);
        let elimination = space.homotopy.elimination();
        elimination.eliminate::<Lanes<WIDTH>, 2>(&mut space.matrix, &mut exchanges);
        let unit = unit_roundoff(f64::MANTISSA_DIGITS);
        std::array::from_fn(|lane| {
            let column = |j: usize| largest_part((0..n).map(|i| space.matrix.at(i, j).lane(lane)));
            StepInDoubles {
                correction: column(n),
                rounding: unit * column(n + 1),
                largest: largest_part((0..n).map(|i| space.x[i].lane(lane))),
            }
        })
    }
}

/// The largest real or imaginary part; not a number where one is none.
pub(super) fn largest_part(numbers: impl Iterator<Item = Complex64>) -> f64 {
    numbers.fold(0.0, |largest, z| {
        let here = size(z);
        if here > largest || z.re.is_nan() || z.im.is_nan() {
            here + 0.0 * (z.re + z.im)
        } else {
            largest
        }
    })
}

impl NewtonAtEnds<'_> {
    /// The Jacobian in doubles at the ends as they came, and the sum of the moduli of each equation's terms.
    #[inline(always)]
    fn linearize(&mut self, parameters: &[Complex<DoubleDoubleLanes>]) {
        let n = self.x.len();
        let x: Vec<Complex<Lanes<WIDTH>>> = self.x.iter().map(Complex::control).collect();
        let p: Vec<Complex<Lanes<WIDTH>>> = parameters.iter().map(Complex::control).collect();
        let evaluator = self.homotopy.evaluator();
        let scratch = &mut self.scratch_of_doubles;
        evaluator.jacobian(&x, &p, &mut self.jacobian, scratch);
        for i in 0..n {
            let mut terms = Lanes::from_f64((), 0.0);
            for (j, x) in x.iter().enumerate() {
                let mut term = *self.jacobian.at(i, j);
                term.mul(x);
                let mut modulus = term.norm_sqr();
                modulus.sqrt();
                terms.add(&modulus);
            }
            let phase = self.phases[i];
            let mut rounding = Complex::from_f64((), phase.re, phase.im);
            rounding.scale(&terms);
            self.rounding[i] = rounding;
        }
    }
}
