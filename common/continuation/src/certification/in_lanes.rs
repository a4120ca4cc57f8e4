//! Krawczyk's test of eight points at a time: Newton's method in doubles, the proof in balls of doubles.
//!
//! No lane sees its neighbours: what is proved of a point, and how, depends on it alone.

use super::candidate::Candidate;
use super::limits::{FARTHEST, INFLATION, MOST_STEPS, SMALLEST_RADIUS, STRONG, TRIES};
use super::proved::Proved;
use cognate_numeric::lanes::called::{BallLanes, WIDTH};
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::lanes::{LaneMask, Lanes};
use cognate_numeric::linear_algebra::inverse::invert;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::precision::unit_roundoff;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::{Ball, Complex, Magnitude, Mask, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};

/// Bits of a double.
const BITS: u32 = 53;

type Doubles = Lanes<WIDTH>;
type Lane = LaneMask<WIDTH>;
type Balls = BallLanes;
type Bound = Magnitude<Doubles>;

/// The test for some points of one square system, with its work space.
pub(super) struct TestInLanes<'a> {
    program: &'a Interpreter,
    of_points: Scratch<Doubles>,
    of_balls: Scratch<Balls>,
    parameters: Vec<Complex<Doubles>>,
    ball_parameters: Vec<Complex<Balls>>,
    /// Points where Newton's method begins.
    start: Vec<Complex<Doubles>>,
    x: Vec<Complex<Doubles>>,
    /// [J | F | -] for all variables.
    whole: Matrix<Doubles>,
    boxes: Vec<Complex<Balls>>,
    values: Vec<Complex<Balls>>,
    whole_of_boxes: Matrix<Balls>,
}

/// Boxes that are proved to hold exactly one solution, one in each lane of `proved`.
struct Boxes {
    proved: Lane,
    radius: Vec<Bound>,
    needed: Vec<Bound>,
    contraction: Bound,
}

fn splat(value: f64) -> Doubles {
    Real::from_f64((), value)
}

/// The larger part's size.
#[inline(always)]
fn larger_part(z: &Complex<Doubles>) -> Bound {
    let mut size = Bound::of(&z.re);
    size.max(&Bound::of(&z.im));
    size
}

#[inline(always)]
fn modulus(z: &Complex<Doubles>) -> Bound {
    let mut size = z.norm_sqr();
    size.sqrt();
    Bound::of(&size)
}

/// Bounds of |Re z| and |Im z|.
#[inline(always)]
fn parts(z: &Complex<Balls>) -> [Bound; 2] {
    [z.re.number().magnitude(), z.im.number().magnitude()]
}

/// `factor` times it, outward.
#[inline(always)]
fn multiple(factor: f64, bound: &Bound) -> Bound {
    let mut product = Bound::zero();
    product.mul_add(&Bound::from_f64(factor), bound);
    product
}

#[inline(always)]
fn around(z: &Complex<Doubles>, radius: &Bound) -> Complex<Balls> {
    Complex {
        re: Balls::new(Ball::around(&z.re, radius)),
        im: Balls::new(Ball::around(&z.im, radius)),
    }
}

#[inline(always)]
fn point(z: &Complex<Doubles>) -> Complex<Balls> {
    Complex {
        re: Balls::new(Ball::point(&z.re)),
        im: Balls::new(Ball::point(&z.im)),
    }
}

impl<'a> TestInLanes<'a> {
    /// Work space for this system.
    pub(super) fn new(program: &'a Interpreter) -> Self {
        let shape = Evaluate::<Doubles>::shape(program);
        let (n, variables) = (shape.equations, shape.variables);
        let (zero, nothing) = (Complex::zero(()), Complex::zero(()));
        Self {
            program,
            of_points: program.scratch(()),
            of_balls: program.scratch(()),
            parameters: vec![zero; shape.parameters],
            ball_parameters: vec![nothing; shape.parameters],
            start: vec![zero; variables],
            x: vec![zero; variables],
            whole: Matrix::zeros((), n, variables + 2),
            boxes: vec![nothing; variables],
            values: vec![nothing; n],
            whole_of_boxes: Matrix::zeros((), n, variables + 2),
        }
    }

    /// Lanes without a candidate of their own have the last one.
    fn load(&mut self, candidates: &[Candidate<'_>]) {
        for lane in 0..WIDTH {
            let candidate = &candidates[lane.min(candidates.len() - 1)];
            for (to, &z) in self.parameters.iter_mut().zip(candidate.parameters) {
                to.set_lane(lane, z);
            }
            for (to, &z) in self.start.iter_mut().zip(candidate.point) {
                to.set_lane(lane, z);
            }
        }
        for (to, z) in self.ball_parameters.iter_mut().zip(&self.parameters) {
            *to = point(z);
        }
    }

    /// Newton's method to the end of doubles, in `x`; which lanes it did not leave.
    #[inline(always)]
    fn refine(&mut self, free: &[usize]) -> Lane {
        let (n, coordinate_count) = (free.len(), self.x.len());
        let mut work = Matrix::<Doubles>::zeros((), n, n + 1);
        // The largest coordinate, of which the homogenising one is 1.
        let mut largest = Bound::from_f64(1.0);
        for (x, start) in self.x.iter_mut().zip(&self.start) {
            x.set(start);
            largest.max(&modulus(start));
        }
        let (mut good, mut moving) = (Lane::splat(true), Lane::splat(true));
        let mut last = splat(f64::INFINITY);
        for _ in 0..MOST_STEPS {
            self.program.jacobian(
                &self.x,
                &self.parameters,
                &mut self.whole,
                &mut self.of_points,
            );
            for i in 0..n {
                for (j, &v) in free.iter().enumerate() {
                    work.at_mut(i, j).set(self.whole.at(i, v));
                }
                work.at_mut(i, n).set(self.whole.at(i, coordinate_count));
            }
            eliminate::<Doubles, 1>(&mut work, &mut splat(0.0));
            let mut step = Bound::zero();
            for i in 0..n {
                step.max(&modulus(work.at(i, n)));
            }
            let finite = step.value().less(&splat(f64::INFINITY));
            good = good.and(finite.or(moving.not()));
            // Elsewhere rounding error is reached, or there is nothing to converge to.
            let mut half = last;
            half.mul(&splat(0.5));
            moving = moving.and(step.value().less(&half));
            last.select(moving, step.value());
            let mut moved = Bound::zero();
            for (i, &v) in free.iter().enumerate() {
                let mut next = self.x[v];
                next.sub(work.at(i, n));
                self.x[v].select(moving, &next);
                let mut away = self.x[v];
                away.sub(&self.start[v]);
                moved.max(&modulus(&away));
            }
            let near = moved
                .value()
                .less_equal(multiple(FARTHEST, &largest).value());
            good = good.and(near.or(moving.not()));
            let there = multiple(unit_roundoff(BITS), &largest);
            moving = moving
                .and(near)
                .and(step.value().less_equal(there.value()).not());
            if !moving.any() {
                break;
            }
        }
        good
    }

    /// The approximate inverse of the Jacobian at `x`.
    #[inline(always)]
    fn preconditioner(&mut self, free: &[usize]) -> Vec<Complex<Balls>> {
        let n = free.len();
        self.program.jacobian(
            &self.x,
            &self.parameters,
            &mut self.whole,
            &mut self.of_points,
        );
        let mut work = Matrix::<Doubles>::zeros((), n, 2 * n);
        for i in 0..n {
            for (j, &v) in free.iter().enumerate() {
                work.at_mut(i, j).set(self.whole.at(i, v));
            }
        }
        invert(&mut work);
        (0..n * n)
            .map(|entry| point(work.at(entry / n, n + entry % n)))
            .collect()
    }

    /// Computes the distance from the centre to which C F(c) leads, in either part.
    #[inline(always)]
    fn correction(&mut self, n: usize, c: &[Complex<Balls>]) -> Vec<Bound> {
        for (to, z) in self.boxes.iter_mut().zip(&self.x) {
            *to = point(z);
        }
        self.program.value(
            &self.boxes,
            &self.ball_parameters,
            &mut self.values,
            &mut self.of_balls,
        );
        let row = |i: usize| {
            let mut sum = Complex::<Balls>::zero(());
            for (c, value) in c[i * n..(i + 1) * n].iter().zip(&self.values) {
                sum.mul_add(c, value);
            }
            let [mut re, im] = parts(&sum);
            re.max(&im);
            re
        };
        (0..n).map(row).collect()
    }

    /// ||1 - C F'(box)||, and how far from the centre the operator leads.
    #[inline(always)]
    fn contraction(
        &mut self,
        free: &[usize],
        radius: &[Bound],
        correction: &[Bound],
        c: &[Complex<Balls>],
    ) -> (Bound, Vec<Bound>) {
        let n = free.len();
        for (&v, radius) in free.iter().zip(radius) {
            self.boxes[v] = around(&self.x[v], radius);
        }
        self.program.jacobian(
            &self.boxes,
            &self.ball_parameters,
            &mut self.whole_of_boxes,
            &mut self.of_balls,
        );
        let mut contraction = Bound::zero();
        let mut needed = Vec::with_capacity(n);
        for i in 0..n {
            let mut sum_of_moduli = Bound::zero();
            let mut need = correction[i];
            for (j, &v) in free.iter().enumerate() {
                let mut slope = Complex::<Balls>::from_f64((), f64::from(i == j), 0.0);
                for (k, c) in c[i * n..(i + 1) * n].iter().enumerate() {
                    slope.mul_sub(c, self.whole_of_boxes.at(k, v));
                }
                let [re, im] = parts(&slope);
                let mut modulus = Bound::zero();
                modulus.mul_add(&re, &re);
                modulus.mul_add(&im, &im);
                modulus.sqrt();
                sum_of_moduli.add(&modulus);
                // |K_i - c_i| <= |C F(c)|_i + sum_j (|Re M_ij| + |Im M_ij|) r_j in either part.
                need.mul_add(&re, &radius[j]);
                need.mul_add(&im, &radius[j]);
            }
            contraction.max(&sum_of_moduli);
            needed.push(need);
        }
        (contraction, needed)
    }

    /// Looks, in these lanes, for boxes that the operator leads into their interior.
    #[inline(always)]
    fn contract(&mut self, free: &[usize], good: Lane) -> Boxes {
        let n = free.len();
        let c = self.preconditioner(free);
        let correction = self.correction(n, &c);
        let mut radius: Vec<Bound> = (0..n)
            .map(|i| {
                let mut error_bound = multiple(unit_roundoff(BITS), &larger_part(&self.x[free[i]]));
                error_bound.max(&correction[i]);
                let mut radius = multiple(INFLATION, &error_bound);
                radius.max(&Bound::from_f64(SMALLEST_RADIUS));
                radius
            })
            .collect();
        let mut boxes = Boxes {
            proved: Lane::splat(false),
            radius: vec![Bound::zero(); n],
            needed: vec![Bound::zero(); n],
            contraction: Bound::zero(),
        };
        let (mut open, mut still_too_wide) = (good, Lane::splat(false));
        for _ in 0..TRIES {
            let (contraction, needed) = self.contraction(free, &radius, &correction, &c);
            let strong = contraction.value().less(&splat(STRONG));
            let (mut inside, mut finite) = (Lane::splat(true), Lane::splat(true));
            for (need, radius) in needed.iter().zip(&radius) {
                inside = inside.and(need.value().less(radius.value()));
                finite = finite.and(need.value().less(&splat(f64::INFINITY)));
            }
            let proved_lanes = open.and(strong).and(inside);
            boxes.take(proved_lanes, &radius, &needed, &contraction);
            open = open.and(proved_lanes.not());
            // Where it contracts, some radius is small beside the others: as large as its row asks for. Elsewhere
            // the box is too wide: nearer to what the correction itself needs.
            let grow = strong.and(finite);
            open = open.and(grow.and(still_too_wide).not());
            if !open.any() {
                break;
            }
            still_too_wide = still_too_wide.or(grow.not());
            for ((radius, need), correction) in radius.iter_mut().zip(&needed).zip(&correction) {
                let mut wider = multiple(8.0, need);
                wider.max(radius);
                let mut narrower = multiple(0.125, radius);
                narrower.max(&multiple(2.0, correction));
                narrower.select(grow, &wider);
                *radius = narrower;
            }
        }
        boxes
    }
}

impl Boxes {
    /// Stores the box of each lane in `proved_lanes`, and marks the lane as proved.
    #[inline(always)]
    fn take(
        &mut self,
        proved_lanes: Lane,
        radius: &[Bound],
        needed: &[Bound],
        contraction: &Bound,
    ) {
        self.proved = self.proved.or(proved_lanes);
        self.contraction.select(proved_lanes, contraction);
        for (to, from) in self.radius.iter_mut().zip(radius) {
            to.select(proved_lanes, from);
        }
        for (to, from) in self.needed.iter_mut().zip(needed) {
            to.select(proved_lanes, from);
        }
    }
}

// The two halves of the test are functions of their own, for the optimiser's sake (`tracker/lockstep.rs`).

struct Refine<'t, 'a>(&'t mut TestInLanes<'a>, &'t [usize]);

impl Job for Refine<'_, '_> {
    type Output = Lane;
    #[inline(always)]
    fn run(self) -> Lane {
        self.0.refine(self.1)
    }
}

struct Contract<'t, 'a>(&'t mut TestInLanes<'a>, &'t [usize], Lane);

impl Job for Contract<'_, '_> {
    type Output = Boxes;
    #[inline(always)]
    fn run(self) -> Boxes {
        self.0.contract(self.1, self.2)
    }
}

impl TestInLanes<'_> {
    /// Tries to certify points with these free variables in double precision; there are at most as many points as
    /// lanes.
    pub(super) fn prove(
        &mut self,
        free: &[usize],
        candidates: &[Candidate<'_>],
    ) -> Vec<Option<Proved>> {
        self.load(candidates);
        let good = dispatch_baseline(Refine(self, free));
        let boxes = dispatch_baseline(Contract(self, free, good));
        let proved = |lane: usize| -> Option<Proved> {
            let exact = |z: &Complex<Doubles>| {
                let z = z.lane(lane);
                let [re, im] = [z.re, z.im].map(Rational::from_f64);
                Some(ComplexRational::new(re?, im?))
            };
            let each = |bounds: &[Bound]| bounds.iter().map(|b| b.value().lane(lane)).collect();
            boxes.proved.lane(lane).then_some(())?;
            Some(Proved {
                centre: self.x.iter().map(exact).collect::<Option<_>>()?,
                radius: each(&boxes.radius),
                needed: each(&boxes.needed),
                contraction: boxes.contraction.value().lane(lane),
                precision_bits: BITS,
            })
        };
        (0..candidates.len()).map(proved).collect()
    }
}
