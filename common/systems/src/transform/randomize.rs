//! An overdetermined system squared up: as many random combinations of its equations as it has unknowns.
//!
//! (I | A) F with the equations by descending degree and A real and rational:
//! every isolated solution of F is an isolated solution of almost every such
//! combination, and conjugation stays a symmetry (Sommese, Wampler: The
//! Numerical Solution of Systems of Polynomials, 2005, section 13.5).
//! Equations of lower degree that `independent` finds stay as they are.

use super::independent::independent;
use crate::evaluation::{Evaluate, Interpreter};
use crate::expression::{Expressions, NodeId};
use crate::polynomial::Degrees;
use crate::system::System;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::Complex;
use std::cmp::Reverse;

/// The system with `dimension()` equations instead of more; a square one comes back as it is.
///
/// Linear equations and smooth quadrics in variables of their own, such as circles, stay what they
/// are (see `independent`), as many of them as make the product of the degrees least: ten cubics, two
/// quadrics and six circles in twelve unknowns have 2^6 * 3^6 paths from their total degree instead of
/// 2^2 * 3^10.
///
/// A pure function of its arguments. `degrees` are those of `system`. In a
/// homogeneous group an equation of lower degree is multiplied by random real
/// linear forms first, so that what is added has one degree.
///
/// # Panics
/// When there are fewer equations than unknowns, or `degrees` has another length.
pub fn randomize(system: &System, degrees: &Degrees, seed: u64) -> System {
    let (equations, unknowns) = (system.equation_count(), system.dimension());
    assert!(
        equations >= unknowns,
        "combining equations makes them fewer"
    );
    assert_eq!(degrees.total.len(), equations, "a degree for each equation");
    if equations == unknowns {
        return system.clone();
    }
    let mut order: Vec<usize> = (0..equations).collect();
    order.sort_by_key(|&i| (Reverse(degrees.total[i]), i));
    let candidates = independent(system, degrees);
    let most = candidates.len().min(unknowns - 1);
    let mut best: Option<(Rational, usize)> = None;
    for count in 0..=most {
        let whole = &candidates[..count];
        let others = order.iter().filter(|i| !whole.contains(i));
        let tracked = whole.iter().chain(others.take(unknowns - count));
        let product = tracked.fold(Rational::from(1), |p, &i| p * degrees.total[i]);
        if best.as_ref().is_none_or(|(least, _)| product < *least) {
            best = Some((product, count));
        }
    }
    let whole = &candidates[..best.map_or(0, |(_, count)| count)];
    order.retain(|i| !whole.contains(i));
    let (kept, rest) = order.split_at(unknowns - whole.len());
    let mut result = System {
        equations: Vec::new(),
        equation_names: Vec::new(),
        ..system.clone()
    };
    let out = &mut result.expressions;
    let scaled = scaled(system, out, seed);
    for (row, &i) in kept.iter().enumerate() {
        let mut random = RandomStream::new(seed, Purpose::Randomization, row as u64);
        let wanted: Vec<u32> = (0..system.groups.len())
            .map(|g| {
                let degree = |&j: &usize| degrees.by_group[j][g];
                rest.iter().map(degree).fold(degree(&i), u32::max)
            })
            .collect();
        let mut sum = raised(system, degrees, out, &scaled, i, &wanted, &mut random);
        for &j in rest {
            let a = out.constant(ComplexRational::real(coefficient(&mut random)));
            let term = raised(system, degrees, out, &scaled, j, &wanted, &mut random);
            let term = out.multiply(a, term);
            sum = out.add(sum, term);
        }
        result.equations.push(sum);
        let name = system.equation_names.get(i).cloned();
        let name = name.unwrap_or_else(|| format!("equation {}", i + 1));
        result.equation_names.push(format!("{name} and others"));
    }
    // The higher degrees come first.
    for &i in whole.iter().rev() {
        result.equations.push(system.equations[i]);
        let name = system.equation_names.get(i).cloned();
        let name = name.unwrap_or_else(|| format!("equation {}", i + 1));
        result.equation_names.push(name);
    }
    result
}

/// A random real number between 1/4 and 1 in modulus, a multiple of 2^-16: exact in doubles, and
/// cheap in exact arithmetic.
pub(super) fn coefficient(random: &mut RandomStream) -> Rational {
    let size = Rational::from((16_384 + random.below(49_152), 65_536u32));
    if random.below(2) == 0 { size } else { -size }
}

/// The equations, each times a power of two, so that none drowns the others: their values at
/// random points with coordinates of modulus 1 are about 1.
pub(super) fn scaled(system: &System, out: &mut Expressions, seed: u64) -> Vec<NodeId> {
    const PROBES: u64 = 3;
    let native = |z: num_complex::Complex64| Complex { re: z.re, im: z.im };
    let program = Interpreter::compile(
        &system.expressions,
        &system.equations,
        system.variables.len(),
        system.parameters.len(),
    );
    let mut scratch = Evaluate::<f64>::scratch(&program, ());
    let mut values = vec![Complex { re: 0.0, im: 0.0 }; system.equation_count()];
    let mut sizes = vec![0.0f64; system.equation_count()];
    for probe in 0..PROBES {
        let mut random = RandomStream::new(seed, Purpose::Randomization, u64::MAX - probe);
        let x: Vec<_> = (0..system.variables.len())
            .map(|_| native(random.unit()))
            .collect();
        let p: Vec<_> = (0..system.parameters.len())
            .map(|_| native(random.unit()))
            .collect();
        program.value(&x, &p, &mut values, &mut scratch);
        for (size, value) in sizes.iter_mut().zip(&values) {
            let square = value.norm_sqr();
            // A product of many factors has a square beyond what doubles hold.
            *size = size.max(match square.is_normal() {
                true => square.sqrt(),
                false => value.re.abs().max(value.im.abs()),
            });
        }
    }
    system
        .equations
        .iter()
        .zip(sizes)
        .map(|(&equation, size)| {
            let mut exponent = 0i32;
            let mut size = size;
            while size.is_finite() && size > 1.0 && exponent > -1000 {
                size *= 0.5;
                exponent -= 1;
            }
            while size > 0.0 && size <= 0.5 && exponent < 1000 {
                size *= 2.0;
                exponent += 1;
            }
            let scale = out.constant(ComplexRational::real(Rational::from(1) << exponent));
            out.multiply(scale, equation)
        })
        .collect()
}

/// The equation times as many random linear forms of each homogeneous group as it lacks in degree.
fn raised(
    system: &System,
    degrees: &Degrees,
    out: &mut Expressions,
    equations: &[NodeId],
    equation: usize,
    wanted: &[u32],
    random: &mut RandomStream,
) -> NodeId {
    let mut product = equations[equation];
    for (g, group) in system.groups.iter().enumerate() {
        if !group.homogeneous {
            continue;
        }
        for _ in degrees.by_group[equation][g]..wanted[g] {
            let mut form = out.integer(0);
            for &v in &group.variables {
                let c = out.constant(ComplexRational::real(coefficient(random)));
                let x = out.variable(v as u32);
                let term = out.multiply(c, x);
                form = out.add(form, term);
            }
            product = out.multiply(form, product);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::exact;
    use crate::polynomial::{check_homogeneous, degrees};

    fn read(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        match crate::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        }
    }

    /// Survey, system (35): three conics through three points.
    fn eq35() -> System {
        read(
            "variable_group x, y; function f1, f2, f3; \
             f1 = x*y; f2 = x*(x - y - 1); f3 = y*(x - y - 1);",
        )
    }

    #[test]
    fn every_solution_solves_the_combinations_too() {
        let system = eq35();
        let system_degrees = degrees(&system).unwrap();
        let square = randomize(&system, &system_degrees, 7);
        assert_eq!(square.check(), Ok(()));
        assert_eq!((square.equation_count(), square.dimension()), (2, 2));
        assert_eq!(degrees(&square).unwrap().total, [2, 2]);
        let at = |point: [i32; 2]| {
            let x = point.map(ComplexRational::real);
            exact::values(&square.expressions, &square.equations, &x, &[])
        };
        let zero = |values: Vec<Option<ComplexRational>>| {
            values.iter().flatten().filter(|v| v.is_zero()).count() == 2
        };
        for point in [[0, 0], [1, 0], [0, -1]] {
            assert!(zero(at(point)), "{point:?}");
        }
        assert!(!zero(at([0, 1])), "not what the survey prints");
        assert!(at([2, 3]).iter().flatten().all(ComplexRational::is_real));
    }

    #[test]
    fn it_is_a_pure_function_of_the_seed() {
        let system = eq35();
        let system_degrees = degrees(&system).unwrap();
        assert_eq!(
            randomize(&system, &system_degrees, 7),
            randomize(&system, &system_degrees, 7)
        );
        assert_ne!(
            randomize(&system, &system_degrees, 7),
            randomize(&system, &system_degrees, 8)
        );
    }

    #[test]
    fn higher_degrees_come_first_and_square_systems_stay() {
        let system = read(
            "variable_group x, y; function f1, f2, f3; \
             f1 = x + y - 1; f2 = x^3 - y; f3 = x^2 - y^2 + 2*x - 1;",
        );
        let square = randomize(&system, &degrees(&system).unwrap(), 1);
        assert_eq!(degrees(&square).unwrap().total, [3, 1]);
        assert_eq!(square.equation_names, ["f2 and others", "f1"]);
        let second_randomization = randomize(&square, &degrees(&square).unwrap(), 2);
        assert_eq!(second_randomization, square);
    }

    /// Two cubics, a quadric and a circle in three unknowns: 3 * 3 * 2 whether the circle stays or
    /// not; with another circle instead of the quadric 3 * 2 * 2, and its product decides, not
    /// that the third degree of all is 2 already.
    #[test]
    fn the_least_product_of_degrees_decides_what_stays() {
        let tracked = |last: &str| {
            let system = read(&format!(
                "variable_group x, y, z; function f1, f2, f3, f4; f1 = x^3 + y*z - 1; \
                 f2 = y^3 - x*z + 2; f3 = x^2 + y^2 - 1; f4 = {last};"
            ));
            let square = randomize(&system, &degrees(&system).unwrap(), 3);
            (degrees(&square).unwrap().total, square.equation_names)
        };
        let (cubics, names) = tracked("x*z + y*z");
        assert_eq!(cubics, [3, 3, 2]);
        assert_eq!(names[2], "f3 and others", "a tie combines");
        let (quadrics, names) = tracked("z^2 - 2");
        assert_eq!(quadrics, [3, 2, 2]);
        assert_eq!(names, ["f1 and others", "f3", "f4"]);
    }

    #[test]
    fn homogeneous_groups_stay_homogeneous() {
        let system = read(
            "hom_variable_group x, y, z; function f1, f2, f3; \
             f1 = x^3 - y*z^2; f2 = x*y - z^2; f3 = x - y;",
        );
        let square = randomize(&system, &degrees(&system).unwrap(), 5);
        let square_degrees = degrees(&square).unwrap();
        assert_eq!(square_degrees.total, [3, 2]);
        assert_eq!(check_homogeneous(&square, &square_degrees), Ok(()));
    }
}
