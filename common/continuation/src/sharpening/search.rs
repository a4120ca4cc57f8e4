//! The search for equations of which a point is a regular solution: those that are given, or what
//! deflation makes of them.

use super::newton::{Newton, Number, exponent, least_squares};
use super::{Sharpened, Unsharpened};
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::{Complex, MultiplePrecision};
use cognate_systems::evaluation::Interpreter;
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::scaling::Scaling;
use cognate_systems::system::System;
use cognate_systems::transform::deflate;
use num_complex::Complex64;

/// Most deflations of one point: enough for a root of multiplicity 9 of one equation.
const MOST_DEFLATIONS: u32 = 8;
/// Deflated equations with more unknowns than these are not tried: 300 cost a minute at a point that no
/// deflation makes regular.
const MOST_UNKNOWNS: usize = 100;
/// Operations of one round of Newton's method on each level of one search, together: a few seconds of
/// arithmetic with 460 bits. A point of multiplicity 40 of two equations had taken minutes.
pub(super) const MOST_WORK: usize = 10_000_000;
/// Singular values below this part of 1, or of the largest, may stand for 0 if [`GAP`] holds.
const SMALL: f64 = 1e-3;
/// Least factor between the singular values that stand for 0 and the next larger one.
const GAP: f64 = 30.0;
/// Ranks that are tried at one point: the one with the widest gap is almost always right, and one
/// that is not leads nowhere.
const TRIED: usize = 2;

/// Equations and a point, perhaps after deflations.
struct Level {
    expressions: Expressions,
    equations: Vec<NodeId>,
    /// Variables, multipliers among them.
    unknowns: Vec<usize>,
    point: Vec<Number>,
    deflations: u32,
}

/// A point to sharpen, and how far.
struct Search<'a> {
    parameters: &'a [Complex64],
    own: usize,
    digits: i64,
    bits: u32,
    random: RandomStream,
    /// Work done so far.
    work: usize,
}

/// Brings a point, given by the values of all variables, to this many decimal digits as a solution
/// of all equations of a system at these values of its parameters.
///
/// A point that is a multiple solution is one of deflated equations; that it solves all, and that
/// Newton's method converges quadratically there, is the proof that ranks were chosen well. Pure.
pub fn sharpen(
    system: &System,
    parameters: &[Complex64],
    point: &[Complex64],
    digits: u32,
    seed: u64,
) -> Result<Sharpened, Unsharpened> {
    let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
    if point.len() != system.variable_count() || !point.iter().all(finite) {
        return Err(Unsharpened::DamagedPoint);
    }
    let digits = (f64::from(digits) * std::f64::consts::LOG2_10) as i64 + 2;
    let bits = u32::try_from(2 * digits + 128).map_err(|_| Unsharpened::DamagedPoint)?;
    let mut values: Vec<Number> = point
        .iter()
        .map(|z| Complex::from_f64(bits, z.re, z.im))
        .collect();
    let mut unknowns: Vec<usize> = (0..point.len()).collect();
    for group in system.groups.iter().filter(|group| group.homogeneous) {
        let size = |v: usize| point[v].norm_sqr();
        let largest = group.variables.iter().copied();
        let largest = largest.reduce(|a, b| if size(b) > size(a) { b } else { a });
        let fixed = largest.filter(|&v| size(v) > 0.0);
        let fixed = fixed.ok_or(Unsharpened::DamagedPoint)?;
        let scale = values[fixed].inverse();
        for &v in &group.variables {
            let value = values[v].clone();
            values[v].set_product(&value, &scale);
        }
        values[fixed] = Complex::from_f64(bits, 1.0, 0.0);
        unknowns.retain(|&v| v != fixed);
    }
    let mut search = Search {
        parameters,
        own: point.len(),
        digits,
        bits,
        random: RandomStream::new(seed, Purpose::Deflation, 0),
        work: 0,
    };
    search.run(Level {
        expressions: system.expressions.clone(),
        equations: system.equations.clone(),
        unknowns,
        point: values,
        deflations: 0,
    })
}

/// Brings a point, given by the values of the variables, to this many decimal digits; `system` is that in its unknowns,
/// `scaling` takes variables to them.
pub fn sharpen_in_variables(
    system: &System,
    scaling: &Scaling,
    parameters: &[Complex64],
    variables: &[Complex64],
    digits: u32,
    seed: u64,
) -> Result<Sharpened, Unsharpened> {
    let unknowns = scaling.to_unknowns(variables);
    let sharpened = sharpen(system, parameters, &unknowns, digits, seed)?;
    Ok(sharpened.in_variables(scaling, &system.groups))
}

impl Search<'_> {
    fn run(&mut self, level: Level) -> Result<Sharpened, Unsharpened> {
        let program = Interpreter::compile(
            &level.expressions,
            &level.equations,
            level.point.len(),
            self.parameters.len(),
        );
        // Values and derivatives, and least squares with complex numbers.
        let size = level.equations.len() * level.unknowns.len().pow(2);
        self.work += program.flops() + 16 * size;
        if self.work > MOST_WORK {
            return Err(Unsharpened::NotRegular);
        }
        let (parameters, bits) = (self.parameters, self.bits);
        let mut newton = Newton::new(&program, parameters, &level.unknowns, self.own, bits);
        let limit = newton
            .converge(&level.point, self.digits)
            .and_then(|limit| {
                let random = &mut self.random;
                let alone = newton.is_alone(&limit.point, self.digits, random)?;
                alone.then_some(limit).ok_or(Unsharpened::NotRegular)
            });
        let why = match limit {
            Ok(limit) => {
                let coordinates = &limit.point[..self.own];
                return Ok(Sharpened {
                    values: self.rounded(coordinates),
                    accuracy: power_of_two(limit.correction.max(-self.digits - 8)),
                    deflations: level.deflations,
                    precision_bits: self.bits,
                });
            }
            Err(why) => why,
        };
        if level.deflations == MOST_DEFLATIONS {
            return Err(Unsharpened::NotRegular);
        }
        for rank in ranks(&newton.jacobian(&level.point)) {
            if level.unknowns.len() + rank + 1 > MOST_UNKNOWNS {
                continue;
            }
            let deflated = self.deflated(&level, rank);
            if let Some(solution) = deflated.and_then(|level| self.run(level).ok()) {
                return Ok(solution);
            }
        }
        Err(why)
    }

    /// The next level: its equations, and the multipliers that belong to the point.
    fn deflated(&mut self, level: &Level, rank: usize) -> Option<Level> {
        let mut expressions = level.expressions.clone();
        let first = level.point.len();
        let (equations, unknowns) = (&level.equations, &level.unknowns);
        let random = &mut self.random;
        let equations = deflate(&mut expressions, equations, unknowns, first, rank, random);
        // The equations that are new are affine in the multipliers: F' B l = 0 and h l = 1.
        let multipliers: Vec<usize> = (first..=first + rank).collect();
        let new = &equations[level.equations.len()..];
        let variables = first + rank + 1;
        let program = Interpreter::compile(&expressions, new, variables, self.parameters.len());
        let mut point = level.point.clone();
        point.resize(variables, Complex::zero(self.bits));
        let mut affine = Newton::new(&program, self.parameters, &multipliers, 0, self.bits);
        let columns = affine.jacobian(&point);
        let mut one = vec![Complex::zero(self.bits); new.len()];
        *one.last_mut()? = Complex::from_f64(self.bits, 1.0, 0.0);
        let values = least_squares(self.bits, &columns, &one)?;
        point.truncate(first);
        point.extend(values);
        let unknowns = level.unknowns.iter().copied().chain(multipliers).collect();
        Some(Level {
            expressions,
            equations,
            unknowns,
            point,
            deflations: level.deflations + 1,
        })
    }

    /// Rounds each coordinate to the digits that it has, and a few bits more.
    fn rounded(&self, point: &[Number]) -> Vec<ComplexRational> {
        let largest = point.iter().filter_map(exponent).max().unwrap_or(0).max(0);
        let round = |z: &Number| {
            let size = exponent(z).filter(|&size| size > largest - 2 * self.digits);
            let Some(size) = size else {
                return ComplexRational::default();
            };
            let down = self.digits + 8 - size;
            let part = |x: &MultiplePrecision| {
                let scaled = x.0.to_rational().unwrap_or_default();
                shifted(shifted(scaled, down).round(), -down)
            };
            ComplexRational::new(part(&z.re), part(&z.im))
        };
        point.iter().map(round).collect()
    }
}

/// value * 2^by
fn shifted(value: Rational, by: i64) -> Rational {
    let size = u32::try_from(by.unsigned_abs()).expect("sizes of numbers are 32-bit exponents");
    if by < 0 { value >> size } else { value << size }
}

/// 2^e as a double, 2^-1000 for what is smaller.
fn power_of_two(e: i64) -> f64 {
    let mut power = 1.0;
    for _ in e.clamp(-1000, 0)..0 {
        power *= 0.5;
    }
    power
}

/// Candidates for the rank of a matrix without full rank, the likeliest first.
fn ranks(columns: &[Vec<Number>]) -> Vec<usize> {
    let rounded = |column: &Vec<Number>| column.iter().map(|z| z.lane(0)).collect();
    let values = Svd::of(columns.iter().map(rounded).collect()).values;
    let top = values.first().copied().unwrap_or(0.0);
    let mut before = if top > 1.0 { top } else { 1.0 };
    let small = SMALL * before;
    let mut gaps = Vec::new();
    for (rank, &value) in values.iter().enumerate() {
        let gap = before / value.max(f64::MIN_POSITIVE);
        if value <= small && gap >= GAP {
            gaps.push((gap, rank));
        }
        before = value;
    }
    gaps.sort_by(|a, b| b.0.total_cmp(&a.0));
    gaps.into_iter().take(TRIED).map(|(_, rank)| rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::decimal_text::complex_text;
    use cognate_systems::formats::read;

    fn system(head: &str, functions: &str) -> System {
        let names: Vec<String> = (1..=functions.split(';').count() - 1)
            .map(|k| format!("f{k}"))
            .collect();
        let equations: Vec<String> = names
            .iter()
            .zip(functions.split(';'))
            .map(|(name, f)| format!("{name} = {f};"))
            .collect();
        let text = format!(
            "CONFIG\nEND;\nINPUT\n{head}; function {}; {}\nEND;\n",
            names.join(", "),
            equations.join(" ")
        );
        read("test", text.as_bytes()).unwrap().system
    }

    /// Sharpens a point that is off by 1e-9; the digits and the deflations.
    fn sharpened(
        system: &System,
        point: &[(f64, f64)],
        digits: u32,
    ) -> Result<(Vec<[String; 2]>, u32), Unsharpened> {
        let mut random = RandomStream::new(3, Purpose::Test, 0);
        let point: Vec<Complex64> = point
            .iter()
            .map(|&(re, im)| Complex64::new(re, im) + random.disc() * 1e-9)
            .collect();
        let solution = sharpen(system, &[], &point, digits, 5)?;
        assert!(solution.accuracy < 1e-14 && solution.accuracy > 0.0);
        let texts = solution.values.iter().map(|z| complex_text(z, digits));
        Ok((texts.collect(), solution.deflations))
    }

    #[test]
    fn a_regular_solution_gets_its_digits() {
        let roots = system("variable_group x, y", "x^2 - 2; x*y - 1;");
        let half_root = "0.7071067811865475244008443621048490392848359376884740";
        let root = "1.414213562373095048801688724209698078569671875376948";
        let (coordinates, deflations) = sharpened(
            &roots,
            &[
                (root.parse().unwrap(), 0.0),
                (half_root.parse().unwrap(), 0.0),
            ],
            52,
        )
        .unwrap();
        assert_eq!(coordinates, [[root, "0"], [half_root, "0"]]);
        assert_eq!(deflations, 0);
    }

    #[test]
    fn multiple_solutions_are_deflated() {
        let zero = || ["0".to_string(), "0".to_string()];
        // (1/3, -2) doubly: the line touches the curve.
        let touching = system("variable_group x, y", "y + 2 - (3*x - 1)^2; y + 2;");
        let (coordinates, deflations) =
            sharpened(&touching, &[(1.0 / 3.0, 0.0), (-2.0, 0.0)], 40).unwrap();
        let third = format!("0.{}", "3".repeat(40));
        assert_eq!(coordinates[0], [third, "0".into()]);
        assert_eq!(coordinates[1][0], format!("-2.{}", "0".repeat(39)));
        assert_eq!(deflations, 1);
        // Griewank and Osborne: multiplicity 3, where Newton's method diverges.
        let hard = system("variable_group x, y", "29/16*x^3 - 2*x*y; y - x^2;");
        let (coordinates, deflations) = sharpened(&hard, &[(0.0, 0.0); 2], 30).unwrap();
        assert_eq!(coordinates, [zero(), zero()]);
        assert!((1..3).contains(&deflations));
        // A root of multiplicity 6 needs five deflations.
        let sextic = system("variable_group x", "(x - 10)^6;");
        let (coordinates, deflations) = sharpened(&sextic, &[(10.0, 0.0)], 30).unwrap();
        assert_eq!(coordinates[0][0], format!("10.{}", "0".repeat(28)));
        assert_eq!(deflations, 5);
        // Corank 2: four lines through one point.
        let lines = system("variable_group x, y", "x*y; x^2 - y^2;");
        let (coordinates, deflations) = sharpened(&lines, &[(0.0, 0.0); 2], 30).unwrap();
        assert_eq!((coordinates, deflations), (vec![zero(), zero()], 1));
    }

    #[test]
    fn all_equations_count_and_factors_do_not() {
        // Survey, system (35): three equations in two unknowns.
        let three = system("variable_group x, y", "x*y; x*(x - y - 1); y*(x - y - 1);");
        let (coordinates, deflations) = sharpened(&three, &[(1.0, 0.0), (0.0, 0.0)], 25).unwrap();
        assert_eq!(coordinates[0][0], format!("1.{}", "0".repeat(24)));
        assert_eq!((coordinates[1][0].as_str(), deflations), ("0", 0));
        let projective = system("hom_variable_group x, y", "x^2 - 2*y^2;");
        let (coordinates, _) = sharpened(
            &projective,
            &[(-2.0, 2.0), (-f64::sqrt(2.0), f64::sqrt(2.0))],
            25,
        )
        .unwrap();
        assert_eq!(
            coordinates[0],
            [format!("1.{}", "0".repeat(24)), "0".into()]
        );
        assert_eq!(coordinates[1][0], "0.7071067811865475244008444");
    }

    #[test]
    fn what_is_no_isolated_solution_is_refused() {
        let line = system("variable_group x, y", "x*y; x*(y - 1);");
        let on_a_line = sharpened(&line, &[(0.0, 0.0), (0.3, 0.0)], 20);
        assert_eq!(on_a_line, Err(Unsharpened::NotRegular));
        let none = system("variable_group x, y", "x^2 - 2; x*y - 1;");
        let nowhere = sharpened(&none, &[(1.4, 0.0), (0.7, 0.0)], 20);
        assert_eq!(nowhere, Err(Unsharpened::NewtonLeaves));
        let damaged = sharpen(&none, &[], &[Complex64::default()], 20, 1);
        assert_eq!(damaged, Err(Unsharpened::DamagedPoint));
        // Half-way between two solutions that are near each other is none.
        let near = system("variable_group x", "x^2 - 1e-12;");
        assert!(sharpened(&near, &[(0.0, 0.0)], 20).is_err());
    }
}
