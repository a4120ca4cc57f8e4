//! Taylor probe: where a path goes, and how far it may go without coming near another, from its Taylor
//! series at a point.
//!
//! Where x(t) has its nearest singularity two paths meet or one leaves for infinity, and a step that
//! passes by at less than its distance cannot be taken for one on another path; a prediction
//! that is off by less than the distance to the nearest other path belongs to its own. Both
//! are estimated as in Telen, Van Barel, Verschelde (A robust numerical path tracking
//! algorithm for polynomial homotopy continuation, SIAM J. Sci. Comput. 42, 2020, sections 3, 4),
//! with coefficients from automatic differentiation.

use crate::chart::norm;
use crate::homotopies::Homotopy;
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::jet::TERMS;
use cognate_numeric::scalar::{Complex, Jet, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use num_complex::Complex64;

/// Factors by which the square root of the ratio of Taylor coefficients of orders 1 and 3, and of orders 2 and 4,
/// overestimates the radius at a branch point of two paths, where coordinates are like (1 - s)^(1/2). At a pole the
/// radii are right.
const BRANCH_POINT: [f64; 2] = [2.83, 1.79];
/// Directions in which other solutions are looked for, beside the one in which the Jacobian is weakest.
const DIRECTIONS: usize = 2;
/// Least denominator of a Pade approximant that is used; below it the Taylor polynomial serves.
const NEAR_POLE: f64 = 0.25;

/// Estimates from the Taylor series at one point of a path.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Estimate {
    /// Distance in t to the nearest singularity of the path.
    pub radius: f64,
    /// Distance to the nearest other path at this t, relative to the largest coordinate.
    pub separation: f64,
    /// Taylor series of the path.
    pub series: Series,
}

/// Taylor coefficients of orders 1 to 4 of every coordinate, in the length of the way down the real
/// axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Series(Vec<[Complex64; TERMS - 1]>);

impl Series {
    /// Displacement of each coordinate after a way of length `s`: by the [3/1] Pade approximant, whose pole the last
    /// two coefficients give.
    pub fn displacements(&self, s: f64) -> impl Iterator<Item = Complex64> {
        self.0.iter().map(move |[a, b, c, d]| {
            let one = Complex64::new(1.0, 0.0);
            // 1 - s d/c
            let denominator = one - d * s / c;
            let cubic = if denominator.norm_sqr() >= NEAR_POLE * NEAR_POLE {
                c / denominator
            } else {
                c + d * s
            };
            (a + (b + cubic * s) * s) * s
        })
    }
}

/// Work space for Taylor series at points of paths, in the arithmetic of the tracking context.
pub(super) struct TaylorProbe<'a, S: Real> {
    homotopy: &'a Homotopy,
    context: S::Context,
    scratch: <Interpreter as Evaluate<S>>::Scratch,
    jets: <Interpreter as Evaluate<Jet<S>>>::Scratch,
    /// [J | free | free]
    jacobian: Matrix<S>,
    work: Matrix<S>,
}

/// One estimate, compiled for the instruction set.
struct EstimateJob<'r, 'a, 'p, S: Real> {
    probe: &'r mut TaylorProbe<'a, S>,
    point: &'p [Complex<S>],
    t: Complex64,
    target: u64,
}

impl<S: Real> Job for EstimateJob<'_, '_, '_, S> {
    type Output = Estimate;
    #[inline(always)]
    fn run(self) -> Estimate {
        self.probe.estimate_inlined(self.point, self.t, self.target)
    }
}

impl<'a, S: Real> TaylorProbe<'a, S> {
    pub fn new(homotopy: &'a Homotopy, context: S::Context) -> Self {
        let n = homotopy.dimension();
        Self {
            homotopy,
            context,
            scratch: Evaluate::<S>::scratch(homotopy.program(), context),
            jets: Evaluate::<Jet<S>>::scratch(homotopy.program(), context),
            jacobian: Matrix::zeros(context, n, n + 2),
            work: Matrix::zeros(context, n, n + 1),
        }
    }

    /// The estimate at a point of a path that goes on along the real axis.
    pub fn estimate(&mut self, point: &[Complex<S>], t: Complex64, target: u64) -> Estimate {
        dispatch_baseline(EstimateJob {
            probe: self,
            point,
            t,
            target,
        })
    }

    #[inline(always)]
    fn estimate_inlined(&mut self, point: &[Complex<S>], t: Complex64, target: u64) -> Estimate {
        let parameters = self.parameters(t, target);
        let parameter_values: Vec<Complex<S>> = parameters.iter().map(|p| term(p, 0)).collect();
        let (program, scratch) = (self.homotopy.program(), &mut self.scratch);
        program.jacobian(point, &parameter_values, &mut self.jacobian, scratch);
        // Order after order: the equations at what is known of x, and Newton for what is missing.
        let mut x: Vec<Complex<Jet<S>>> = point.iter().map(still).collect();
        let mut series = Series(vec![Default::default(); point.len()]);
        let mut sizes = [0.0; TERMS];
        for order in 1..TERMS {
            let rest = self.term_of_values(&x, &parameters, order);
            let missing = self.solve(&rest);
            for (x, missing) in x.iter_mut().zip(&missing) {
                x.re.0[order].sub(&missing.re);
                x.im.0[order].sub(&missing.im);
            }
            let rounded: Vec<Complex64> = missing.iter().map(|z| z.lane(0)).collect();
            for (coefficients, missing) in series.0.iter_mut().zip(&rounded) {
                coefficients[order - 1] = -missing;
            }
            sizes[order] = length(&rounded);
        }
        // A series whose odd terms vanish has a radius too: every second coefficient tells.
        let ratio = |k: usize| (sizes[k] / sizes[k + 2]).sqrt() / BRANCH_POINT[k - 1];
        let radius = smaller(ratio(1), ratio(2));
        // The nearest other solution lies about where the Jacobian is weakest: at point + s v with
        // s J v + s^2 F''(v, v)/2 = 0. In all directions quadratic equations have none nearer than
        // 1/|J^-1 F''/2|, of which a few directions tell the Frobenius norm: over all unit vectors
        // the mean of the squares is 2/(n (n + 1)) of it.
        let n = point.len();
        let at_rest: Vec<Complex<Jet<S>>> = parameter_values.iter().map(still).collect();
        let entry = |i: usize, j: usize| self.jacobian.at(i, j).lane(0);
        let columns = (0..n).map(|j| (0..n).map(|i| entry(i, j)).collect());
        let weakest = Svd::of(columns.collect()).domain.pop().unwrap_or_default();
        let mut bent = self.bent(point, &at_rest, &weakest);
        let mut random = RandomStream::new(0, Purpose::Probe, 2);
        let mut squares = 0.0;
        for _ in 0..DIRECTIONS {
            let v: Vec<Complex64> = (0..n).map(|_| random.unit()).collect();
            let v: Vec<Complex64> = v.iter().map(|z| z / length(&v)).collect();
            let size = self.bent(point, &at_rest, &v);
            squares += size * size;
        }
        let pairs = (n * (n + 1) / 2) as f64;
        let curvature = (pairs * squares / DIRECTIONS as f64).sqrt();
        if curvature > bent {
            bent = curvature;
        }
        let here: Vec<Complex64> = point.iter().map(|z| z.lane(0)).collect();
        Estimate {
            radius,
            separation: 1.0 / (bent * norm(&here)),
            series,
        }
    }

    /// |J^-1 F''(v, v)/2|
    #[inline(always)]
    fn bent(&mut self, point: &[Complex<S>], at_rest: &[Complex<Jet<S>>], v: &[Complex64]) -> f64 {
        let context = self.context;
        let mut beside: Vec<Complex<Jet<S>>> = point.iter().map(still).collect();
        for (x, v) in beside.iter_mut().zip(v) {
            x.re.0[1] = S::from_f64(context, v.re);
            x.im.0[1] = S::from_f64(context, v.im);
        }
        let curvature = self.term_of_values(&beside, at_rest, 2);
        let bent: Vec<Complex64> = self.solve(&curvature).iter().map(|z| z.lane(0)).collect();
        length(&bent)
    }

    /// The parameters as they move when t goes down along the real axis.
    fn parameters(&self, t: Complex64, target: u64) -> Vec<Complex<Jet<S>>> {
        let context = self.context;
        let native = |z: Complex64| Complex::<Jet<S>>::from_f64(context, z.re, z.im);
        let (a, b) = self.homotopy.ends(target);
        let (a, b): (Vec<_>, Vec<_>) = (a.map(native).collect(), b.map(native).collect());
        let mut t = Complex::<Jet<S::Control>>::from_f64((), t.re, t.im);
        t.re.0[1] = S::Control::from_f64((), -1.0);
        let mut parameters = vec![Complex::zero(context); a.len()];
        let mut unused = parameters.clone();
        let path = self.homotopy.path();
        path.at::<Jet<S>>(context, &t, &a, &b, &mut parameters, &mut unused);
        parameters
    }

    /// One coefficient of the equations along moving points.
    fn term_of_values(
        &mut self,
        x: &[Complex<Jet<S>>],
        parameters: &[Complex<Jet<S>>],
        order: usize,
    ) -> Vec<Complex<S>> {
        let mut values = vec![Complex::zero(self.context); x.len()];
        let program = self.homotopy.program();
        program.value(x, parameters, &mut values, &mut self.jets);
        values.iter().map(|value| term(value, order)).collect()
    }

    /// J^-1 of a vector.
    #[inline(always)]
    fn solve(&mut self, b: &[Complex<S>]) -> Vec<Complex<S>> {
        let n = b.len();
        for i in 0..n {
            for j in 0..n {
                self.work.at_mut(i, j).set(self.jacobian.at(i, j));
            }
            self.work.at_mut(i, n).set(&b[i]);
        }
        let mut exchanges = S::Control::from_f64((), 0.0);
        eliminate::<S, 1>(&mut self.work, &mut exchanges);
        (0..n).map(|i| self.work.at(i, n).clone()).collect()
    }
}

/// A point that does not move.
fn still<S: Real>(z: &Complex<S>) -> Complex<Jet<S>> {
    let mut jet = Complex::zero(z.re.context());
    let Complex { re, im }: &mut Complex<Jet<S>> = &mut jet;
    re.0[0].set(&z.re);
    im.0[0].set(&z.im);
    jet
}

/// One coefficient of a number that moves.
fn term<S: Real>(z: &Complex<Jet<S>>, order: usize) -> Complex<S> {
    Complex {
        re: z.re.0[order].clone(),
        im: z.im.0[order].clone(),
    }
}

fn length(v: &[Complex64]) -> f64 {
    v.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt()
}

/// The smaller of two that may be no numbers: 0/0 is where nothing moves.
fn smaller(a: f64, b: f64) -> f64 {
    match (a.is_nan(), b.is_nan()) {
        (true, true) => f64::INFINITY,
        (true, false) => b,
        (false, true) => a,
        (false, false) => {
            if a < b {
                a
            } else {
                b
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::homotopies::HomotopyKind;
    use crate::stage::PreparedStage;
    use crate::start_points::StoredPoints;
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, Work};
    use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision};
    use cognate_systems::formats::read;
    use std::sync::Arc;

    /// x^2 = p between two values of p: the paths meet where p is 0, and are 2 x apart.
    fn square_roots() -> PreparedStage {
        let text =
            "CONFIG\nEND;\nINPUT\nvariable_group x; parameter p; function f; f = x^2 - p;\nEND;\n";
        let system = read("test", text.as_bytes()).unwrap().system;
        let number = |re: f64| Complex64::new(re, 0.0);
        let points = Arc::new(StoredPoints {
            dimension: 1,
            coordinates: vec![number(2.0), number(-2.0)],
        });
        let stage = Stage::new(
            Work::Track,
            HomotopyKind::Parameter {
                start: vec![number(4.0)],
                targets: vec![vec![Complex64::new(-1.0, 3.0)]],
            },
            points.as_start(),
            Settings::default(),
            5,
        );
        PreparedStage::new(&system, &stage, &|_| Some(points.clone())).unwrap()
    }

    fn seen<S: Real>(stage: &PreparedStage, context: S::Context) -> Estimate {
        let start = stage.start_point(0).unwrap();
        let point: Vec<Complex<S>> = start
            .iter()
            .map(|z| Complex::from_f64(context, z.re, z.im))
            .collect();
        let mut probe = TaylorProbe::<S>::new(stage.homotopy(), context);
        probe.estimate(&point, Complex64::new(1.0, 0.0), 0)
    }

    #[test]
    fn singularities_and_neighbours_are_where_they_are() {
        let stage = square_roots();
        let estimate = seen::<f64>(&stage, ());
        assert!((estimate.separation - 2.0).abs() < 1e-12, "{estimate:?}");
        // p(t) = a + phi(t) b is 0 at phi = -a/b, and phi = gamma t / (1 + (gamma - 1) t).
        let gamma = stage.homotopy().path().arc.unwrap();
        let (mut a, mut b) = stage.homotopy().ends(0);
        let phi = -a.next().unwrap() / b.next().unwrap();
        let one = Complex64::new(1.0, 0.0);
        let meeting = phi / (gamma - phi * (gamma - one));
        let pole = one / (one - gamma);
        let near = |t: Complex64| (t - one).norm_sqr().sqrt();
        let true_radius = near(meeting).min(near(pole));
        let ratio = estimate.radius / true_radius;
        // Coefficients of low order say up to twice as much at a branch point, at a pole neither more
        // nor less.
        assert!((0.5..2.2).contains(&ratio), "{estimate:?}, {true_radius}");
        // Every arithmetic gives the same radius.
        for other in [
            seen::<DoubleDouble<f64>>(&stage, ()),
            seen::<MultiplePrecision>(&stage, 212),
        ] {
            assert!((other.radius / estimate.radius - 1.0).abs() < 1e-9);
            assert!((other.separation / estimate.separation - 1.0).abs() < 1e-9);
        }
    }
}
