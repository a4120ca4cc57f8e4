//! Krawczyk's test: in doubles for the easy points, in MPFR with more and more bits for the rest.
//!
//! For a box c + B with B_i = [-r_i, r_i] + i [-r_i, r_i] and any matrix C, the
//! operator is K = c - C F(c) + (1 - C F'(c + B)) B. If K lies in the interior
//! of the box, there is exactly one zero of F in the box, and it is in K
//! (Krawczyk 1969; Rump 1983; arXiv 2011.05000 section 3). All of it is evaluated
//! in intervals that enclose the exact system, so the proof is about the input.

use super::certificate::{Certificate, Certification, Uncertified};
use cognate_numeric::linear_algebra::inverse::inverse;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Complex, Interval, MultiplePrecision, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Bits at which a point is given up: a Jacobian that is regular by less is as good as singular.
pub const MOST_BITS: u32 = 1024;
/// ||1 - C J|| below this makes a certificate strong; less than 1/sqrt(2).
const STRONG: f64 = 0.7;
/// A box begins at so many times the first correction: room for the involution's image of a
/// solution, whose point is off by as much.
const INFLATION: f64 = 256.0;
/// How far Newton's method may move a point, relative to its largest coordinate: it is refined,
/// and a path's endpoint of double precision is good to much more.
const FARTHEST: f64 = 1e-4;

/// The test for points of one system at one value of its parameters.
#[derive(Debug)]
pub struct Krawczyk {
    program: Interpreter,
    parameters: Vec<Complex64>,
    /// The homogeneous groups, each with its variables.
    homogeneous: Vec<Vec<usize>>,
    doubles: Workspace<f64>,
}

/// Work space of one arithmetic.
#[derive(Debug)]
struct Workspace<R: Directed> {
    context: R::Context,
    point: Scratch<R>,
    boxes: Scratch<Interval<R>>,
    point_parameters: Vec<Complex<R>>,
    box_parameters: Vec<Complex<Interval<R>>>,
}

impl<R: Directed> Workspace<R> {
    fn new(program: &Interpreter, parameters: &[Complex64], context: R::Context) -> Self {
        Self {
            context,
            point: program.scratch(context),
            boxes: program.scratch(context),
            point_parameters: lift(context, parameters),
            box_parameters: lift(context, parameters),
        }
    }

    /// False where a constant or a parameter is not enclosed.
    fn encloses(&self, program: &Interpreter) -> bool {
        // At any point at all: an invalid constant spoils the values that it is in.
        let shape = Evaluate::<Interval<R>>::shape(program);
        let mut boxes: Scratch<Interval<R>> = program.scratch(self.context);
        let x = vec![Complex::from_f64(self.context, 1.0, 0.0); shape.variables];
        let mut values = vec![Complex::zero(self.context); shape.equations];
        program.value(&x, &self.box_parameters, &mut values, &mut boxes);
        values.iter().all(Complex::is_valid)
    }
}

fn lift<R: Real>(context: R::Context, values: &[Complex64]) -> Vec<Complex<R>> {
    values
        .iter()
        .map(|z| Complex::from_f64(context, z.re, z.im))
        .collect()
}

impl Krawczyk {
    /// For a square system: as many equations as variables, less one for each homogeneous group.
    ///
    /// # Panics
    /// When it is not square, or the parameters are not as many as its own.
    pub fn new(system: &System, parameters: &[Complex64]) -> Self {
        Self::with_program(Self::program(system), Self::homogeneous(system), parameters)
    }

    /// The program of a square system.
    pub(super) fn program(system: &System) -> Interpreter {
        assert_eq!(
            system.equation_count(),
            system.dimension(),
            "only a square system has isolated solutions that a box can show"
        );
        Interpreter::compile(
            &system.expressions,
            &system.equations,
            system.variable_count(),
            system.parameters.len(),
        )
    }

    /// The variables of each homogeneous group.
    pub(super) fn homogeneous(system: &System) -> Vec<Vec<usize>> {
        let groups = system.groups.iter().filter(|group| group.homogeneous);
        groups.map(|group| group.variables.clone()).collect()
    }

    /// With a program that was compiled before.
    pub(super) fn with_program(
        program: Interpreter,
        homogeneous: Vec<Vec<usize>>,
        parameters: &[Complex64],
    ) -> Self {
        assert_eq!(
            Evaluate::<f64>::shape(&program).parameters,
            parameters.len(),
            "every parameter has a value"
        );
        Self {
            doubles: Workspace::new(&program, parameters, ()),
            homogeneous,
            parameters: parameters.to_vec(),
            program,
        }
    }

    /// Tries to prove that there is exactly one solution near a point, given by the values of
    /// all variables; in homogeneous groups up to a factor.
    ///
    /// Pure: the same system, parameters and point give the same bits.
    pub fn certify(&mut self, point: &[Complex64]) -> Certification {
        match self.attempt(point) {
            Ok(certificate) => Certification::Certified(Box::new(certificate)),
            Err(reason) => Certification::Uncertified(reason),
        }
    }

    fn attempt(&mut self, point: &[Complex64]) -> Result<Certificate, Uncertified> {
        let shape = Evaluate::<f64>::shape(&self.program);
        let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
        if point.len() != shape.variables || !point.iter().all(finite) {
            return Err(Uncertified::DamagedPoint);
        }
        let (point, free) = self.in_chart(point).ok_or(Uncertified::DamagedPoint)?;
        let test = Test {
            program: &self.program,
            free: &free,
        };
        let first = test.run::<f64>(&mut self.doubles, &point);
        let mut reason = match first {
            Ok(certificate) => return Ok(certificate),
            Err(reason) => reason,
        };
        let mut bits = 128;
        while bits <= MOST_BITS {
            let mut workspace =
                Workspace::<MultiplePrecision>::new(&self.program, &self.parameters, bits);
            if bits == 128 && !workspace.encloses(&self.program) {
                return Err(Uncertified::NoEnclosure);
            }
            match test.run(&mut workspace, &point) {
                Ok(certificate) => return Ok(certificate),
                Err(now) => reason = now,
            }
            bits *= 2;
        }
        Err(reason)
    }

    /// The point with the largest variable of each homogeneous group at 1, and the variables
    /// that are not fixed so.
    fn in_chart(&self, point: &[Complex64]) -> Option<(Vec<Complex64>, Vec<usize>)> {
        let mut point = point.to_vec();
        let mut fixed = Vec::new();
        for group in &self.homogeneous {
            let size = |v: usize| point[v].norm_sqr();
            let largest = group
                .iter()
                .copied()
                .reduce(|a, b| if size(b) > size(a) { b } else { a })?;
            let scale = point[largest];
            if scale.norm_sqr() == 0.0 {
                return None;
            }
            for &v in group {
                point[v] /= scale;
            }
            point[largest] = Complex64::new(1.0, 0.0);
            fixed.push(largest);
        }
        let free = (0..point.len()).filter(|v| !fixed.contains(v)).collect();
        Some((point, free))
    }
}

/// One system in the chart of one point.
struct Test<'a> {
    program: &'a Interpreter,
    /// The variables that are not fixed at 1.
    free: &'a [usize],
}

impl Test<'_> {
    fn run<R: Directed>(
        &self,
        workspace: &mut Workspace<R>,
        point: &[Complex64],
    ) -> Result<Certificate, Uncertified> {
        let context = workspace.context;
        let mut x: Vec<Complex<R>> = lift(context, point);
        let jacobian = self.refine(workspace, &mut x, point)?;
        let approximate = inverse(context, &jacobian).ok_or(Uncertified::Singular)?;
        let mut c = Matrix::<Interval<R>>::zeros(context, self.free.len(), self.free.len());
        for (entry, value) in c.entries.iter_mut().zip(&approximate.entries) {
            *entry = enclosed(value);
        }
        self.prove(workspace, &x, &c)
    }

    /// Newton's method to the end of the arithmetic; returns the Jacobian at the last point.
    fn refine<R: Directed>(
        &self,
        workspace: &mut Workspace<R>,
        x: &mut [Complex<R>],
        start: &[Complex64],
    ) -> Result<Matrix<R>, Uncertified> {
        let (context, n) = (workspace.context, self.free.len());
        let all = x.len();
        let still = vec![Complex::zero(context); workspace.point_parameters.len()];
        let mut whole = Matrix::<R>::zeros(context, n, all + 2);
        let mut work = Matrix::<R>::zeros(context, n, n + 1);
        let mut jacobian = Matrix::<R>::zeros(context, n, n);
        let size = |z: Complex64| z.norm_sqr().sqrt();
        // The largest coordinate, of which the homogenising one is 1.
        let largest = start.iter().fold(1.0, |m: f64, &z| m.max(size(z)));
        let mut last = f64::INFINITY;
        // Each step doubles the digits of a regular solution; 106 bits a double cannot start from
        // fewer than a handful, so that is more than enough.
        for _ in 0..24 {
            self.program.linearize(
                x,
                &workspace.point_parameters,
                &still,
                &mut whole,
                &mut workspace.point,
            );
            for i in 0..n {
                for (j, &v) in self.free.iter().enumerate() {
                    work.at_mut(i, j).set(whole.at(i, v));
                    jacobian.at_mut(i, j).set(whole.at(i, v));
                }
                work.at_mut(i, n).set(whole.at(i, all));
            }
            eliminate::<R, 1>(&mut work, &mut 0.0);
            let step = (0..n).fold(0.0, |m: f64, i| {
                let size = size(work.at(i, n).lane(0));
                if size > m || size.is_nan() { size } else { m }
            });
            if !step.is_finite() {
                return Err(Uncertified::Singular);
            }
            if step >= 0.5 * last {
                break; // rounding error is reached, or there is nothing to converge to
            }
            last = step;
            for (i, &v) in self.free.iter().enumerate() {
                x[v].sub(work.at(i, n));
            }
            let moved = x
                .iter()
                .zip(start)
                .fold(0.0, |m: f64, (x, &start)| m.max(size(x.lane(0) - start)));
            if moved.is_nan() || moved > FARTHEST * largest {
                return Err(Uncertified::NewtonLeaves);
            }
            if step <= unit(R::bits(context)) * largest {
                break;
            }
        }
        Ok(jacobian)
    }

    fn prove<R: Directed>(
        &self,
        workspace: &mut Workspace<R>,
        x: &[Complex<R>],
        c: &Matrix<Interval<R>>,
    ) -> Result<Certificate, Uncertified> {
        let (context, n) = (workspace.context, self.free.len());
        let centre: Vec<Complex<Interval<R>>> = x.iter().map(enclosed).collect();
        let mut values = vec![Complex::zero(context); n];
        self.program.value(
            &centre,
            &workspace.box_parameters,
            &mut values,
            &mut workspace.boxes,
        );
        // How far from the centre C F(c) leads, in either part.
        let correction: Vec<f64> = (0..n)
            .map(|i| {
                let mut sum = Complex::<Interval<R>>::zero(context);
                for (j, value) in values.iter().enumerate() {
                    sum.mul_add(c.at(i, j), value);
                }
                larger(sum.re.magnitude(), sum.im.magnitude())
            })
            .collect();
        if correction.iter().any(|d| !d.is_finite()) {
            return Err(Uncertified::NoContraction);
        }
        let floor = unit(R::bits(context).min(300));
        let mut radius: Vec<f64> = (0..n)
            .map(|i| {
                let z = x[self.free[i]].lane(0);
                let own = floor * larger(z.re.abs(), z.im.abs());
                (INFLATION * larger(correction[i], own)).max(1e-280)
            })
            .collect();
        let mut still_too_wide = false;
        for _ in 0..6 {
            let slopes = self.slopes(workspace, &centre, &radius, c);
            let contraction = (0..n).fold(0.0, |m: f64, i| {
                let row = (0..n).fold(0.0, |sum, j| above_sum(sum, slopes[i * n + j].0));
                larger(m, row)
            });
            // |K_i - c_i| <= |C F(c)|_i + sum_j (|Re M_ij| + |Im M_ij|) r_j in either part.
            let needed: Vec<f64> = (0..n)
                .map(|i| {
                    (0..n).fold(correction[i], |sum, j| {
                        above_sum(
                            sum,
                            f64::product(&slopes[i * n + j].1, &radius[j], Toward::Above),
                        )
                    })
                })
                .collect();
            let inside = needed.iter().zip(&radius).all(|(need, r)| need < r);
            if contraction < STRONG && inside {
                return Ok(self.certificate(x, &radius, &needed, contraction, R::bits(context)));
            }
            if contraction < STRONG && needed.iter().all(|need| need.is_finite()) {
                // Some radius is small beside the others: as large as its row asks for.
                for (r, need) in radius.iter_mut().zip(&needed) {
                    *r = larger(*r, 8.0 * need);
                }
                if still_too_wide {
                    break;
                }
            } else {
                // Too wide: nearer to what the correction itself needs.
                still_too_wide = true;
                for (r, d) in radius.iter_mut().zip(&correction) {
                    *r = (0.125 * *r).max(2.0 * d);
                }
            }
        }
        Err(Uncertified::NoContraction)
    }

    /// Bounds of M = 1 - C F'(box): of each entry's modulus, and of |Re| + |Im|.
    fn slopes<R: Directed>(
        &self,
        workspace: &mut Workspace<R>,
        centre: &[Complex<Interval<R>>],
        radius: &[f64],
        c: &Matrix<Interval<R>>,
    ) -> Vec<(f64, f64)> {
        let (context, n) = (workspace.context, self.free.len());
        let mut boxes = centre.to_vec();
        for (&v, &r) in self.free.iter().zip(radius) {
            let side = Interval::around_zero(context, r);
            boxes[v].re.add(&side);
            boxes[v].im.add(&side);
        }
        let still = vec![Complex::zero(context); workspace.box_parameters.len()];
        let mut whole = Matrix::<Interval<R>>::zeros(context, n, centre.len() + 2);
        self.program.linearize(
            &boxes,
            &workspace.box_parameters,
            &still,
            &mut whole,
            &mut workspace.boxes,
        );
        let mut slopes = Vec::with_capacity(n * n);
        for i in 0..n {
            for (j, &v) in self.free.iter().enumerate() {
                let mut sum = Complex::from_f64(context, if i == j { 1.0 } else { 0.0 }, 0.0);
                for k in 0..n {
                    sum.mul_sub(c.at(i, k), whole.at(k, v));
                }
                let (re, im) = (sum.re.magnitude(), sum.im.magnitude());
                let squares = above_sum(
                    f64::product(&re, &re, Toward::Above),
                    f64::product(&im, &im, Toward::Above),
                );
                slopes.push((f64::root(&squares, Toward::Above), above_sum(re, im)));
            }
        }
        slopes
    }

    fn certificate<R: Directed>(
        &self,
        x: &[Complex<R>],
        radius: &[f64],
        needed: &[f64],
        contraction: f64,
        precision_bits: u32,
    ) -> Certificate {
        let exact = |value: &R| {
            value
                .to_rational()
                .expect("a point that was proved to be near a solution is finite")
        };
        let mut certificate = Certificate {
            centre: x
                .iter()
                .map(|z| ComplexRational::new(exact(&z.re), exact(&z.im)))
                .collect(),
            radius: vec![0.0; x.len()],
            error: vec![0.0; x.len()],
            contraction,
            precision_bits,
        };
        for (i, &v) in self.free.iter().enumerate() {
            certificate.radius[v] = radius[i];
            // More than what was found, so that who checks it in another arithmetic finds less.
            let more = f64::min(2.0 * needed[i], 0.5 * (needed[i] + radius[i]));
            certificate.error[v] = if more < radius[i] { more } else { needed[i] };
        }
        certificate
    }
}

fn enclosed<R: Directed>(z: &Complex<R>) -> Complex<Interval<R>> {
    Complex {
        re: Interval::point(&z.re),
        im: Interval::point(&z.im),
    }
}

/// The larger one; NaN where either is.
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

fn above_sum(a: f64, b: f64) -> f64 {
    f64::sum(&a, &b, Toward::Above)
}

/// 2^-bits; 0 below the smallest double.
fn unit(bits: u32) -> f64 {
    cognate_numeric::precision::unit_roundoff(bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::rational::Rational;
    use cognate_systems::formats::read;
    use cognate_systems::named::{griewank_osborne, katsura};

    fn system(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        read("test", text.as_bytes()).unwrap().system
    }

    fn real(values: &[f64]) -> Vec<Complex64> {
        values.iter().map(|&re| Complex64::new(re, 0.0)).collect()
    }

    fn certified(krawczyk: &mut Krawczyk, point: &[Complex64]) -> Certificate {
        match krawczyk.certify(point) {
            Certification::Certified(certificate) => {
                assert!(certificate.is_sound());
                *certificate
            }
            Certification::Uncertified(reason) => panic!("{}", reason.describe()),
        }
    }

    fn refused(krawczyk: &mut Krawczyk, point: &[Complex64]) -> Uncertified {
        match krawczyk.certify(point) {
            Certification::Uncertified(reason) => reason,
            Certification::Certified(found) => panic!("nothing can be proved here: {found:?}"),
        }
    }

    #[test]
    fn a_square_root_is_enclosed_from_exact_input() {
        // x^2 = 1/10, of which no double knows the right side.
        let system = system("variable_group x; function f; f = x^2 - 0.1;");
        let mut krawczyk = Krawczyk::new(&system, &[]);
        let found = certified(&mut krawczyk, &real(&[0.3162]));
        assert_eq!(found.precision_bits, 53);
        // The root lies between centre - error and centre + error: by exact squares.
        let error = Rational::from_f64(found.error[0]).unwrap();
        let square = |x: Rational| x.clone() * x;
        let centre = &found.centre[0].re;
        let tenth = Rational::from((1, 10));
        assert!(square(centre.clone() - &error) < tenth && tenth < square(centre.clone() + &error));
        assert!(found.radius[0] < 1e-12 && found.error[0] < found.radius[0]);
        assert!(found.contraction < 1e-10);
    }

    #[test]
    fn all_solutions_near_start_points_of_katsura_are_certified() {
        let system = katsura(3).system;
        let mut krawczyk = Krawczyk::new(&system, &[]);
        // u = (1, 0, 0, 0) solves katsura-n for every n.
        let found = certified(&mut krawczyk, &real(&[1.0, 0.0, 0.0, 0.0]));
        assert_eq!(found.precision_bits, 53);
        assert_eq!(
            refused(&mut krawczyk, &real(&[5.0, -3.0, 0.0, 8.0])),
            Uncertified::NewtonLeaves
        );
    }

    #[test]
    fn homogeneous_points_are_certified_in_the_chart_of_their_largest_coordinate() {
        let system =
            system("hom_variable_group x, y, z; function f, g; f = x^2 - 2*y^2; g = x*z - 3*y*y;");
        let mut krawczyk = Krawczyk::new(&system, &[]);
        let root = f64::sqrt(2.0);
        let scale = Complex64::new(0.3, -0.4);
        let point: Vec<_> = [root, 1.0, 3.0 / root].map(|v| scale * v).to_vec();
        let found = certified(&mut krawczyk, &point);
        assert_eq!(found.centre[2], ComplexRational::real(1));
        assert_eq!((found.radius[2], found.error[2]), (0.0, 0.0));
        assert!(found.radius[0] > 0.0);
    }

    #[test]
    fn what_doubles_cannot_decide_more_bits_do() {
        // Roots at a distance of 1e-12 from each other, expanded: doubles see a double root.
        let system =
            system("variable_group x; function f; f = x^2 - 2.000000000001*x + 1.000000000001;");
        let mut krawczyk = Krawczyk::new(&system, &[]);
        let found = certified(&mut krawczyk, &real(&[1.0 + 1.3e-12]));
        assert!(found.precision_bits >= 128, "{}", found.precision_bits);
        assert!(found.radius[0] < 1e-12);
        let root = Rational::from(1) + Rational::from((1, 1_000_000_000_000u64));
        let boxes = found.lies_in::<MultiplePrecision>(256);
        assert!(boxes[0].re.contains(&root));
    }

    #[test]
    fn singular_points_and_damaged_ones_are_refused() {
        let origin = griewank_osborne();
        let mut krawczyk = Krawczyk::new(&origin.system, &[]);
        let reason = refused(&mut krawczyk, &real(&[0.0, 0.0]));
        assert_eq!(reason, Uncertified::Singular);
        let reason = refused(&mut krawczyk, &real(&[1e-9, -1e-9]));
        assert!(
            matches!(reason, Uncertified::Singular | Uncertified::NoContraction),
            "{reason:?}"
        );
        let regular = system("variable_group x, y; function f, g; f = x + y^2; g = y - x^2;");
        let origin = Krawczyk::new(&regular, &[]).certify(&real(&[1e-17, -3e-18]));
        assert!(origin.certificate().is_some());
        assert_eq!(
            refused(&mut krawczyk, &real(&[f64::NAN, 0.0])),
            Uncertified::DamagedPoint
        );
        assert_eq!(
            refused(&mut krawczyk, &real(&[0.0])),
            Uncertified::DamagedPoint
        );
        // A double root, from beside it.
        let double = system("variable_group x; function f; f = (x - 1/3)^2;");
        let mut krawczyk = Krawczyk::new(&double, &[]);
        refused(&mut krawczyk, &real(&[0.333_333_333_4]));
    }

    #[test]
    fn parameters_are_exact_doubles_and_constants_are_enclosed() {
        let system = system(
            "variable_group x; parameter p; constant c; function f; c = sqrt(3); f = x^2 - c*p;",
        );
        let mut krawczyk = Krawczyk::new(&system, &real(&[0.1]));
        let start = f64::sqrt(f64::sqrt(3.0) * 0.1);
        let found = certified(&mut krawczyk, &real(&[start]));
        assert!(found.error[0] < 1e-14);
    }

    #[test]
    fn a_radius_too_small_beside_the_others_grows() {
        // y is 1e-9 and follows x, which is 1e9.
        let system = system(
            "variable_group x, y; function f, g; f = x - 1000000000 + y^2; g = x*y - 1 - y^2;",
        );
        let mut krawczyk = Krawczyk::new(&system, &[]);
        let found = certified(&mut krawczyk, &real(&[1e9, 1e-9]));
        assert!(found.radius[1] < 1e-20, "{:?}", found.radius);
    }
}
