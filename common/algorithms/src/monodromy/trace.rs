//! Trace test: whether a set of solutions is complete.
//!
//! The points of a curve on slices that move in parallel have a sum that moves on a line, and the sum of a part of an
//! irreducible curve's points does not (Sommese, Verschelde, Wampler: Symmetric functions applied to decomposing
//! solution sets of polynomial systems, 2002). Where the parameters are the coefficients of linear equations, or of
//! combinations of polynomials that embed the space, the equations are the slices. Otherwise the curve is the one of
//! [`sections`], whose sections by generic coefficients begin at the solutions that are known and are completed by
//! loops of their own.

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::homotopies::sections::{section_variables, sections};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::point_shape::PointShape;
use cognate_systems::expression::NodeId;
use cognate_systems::polynomial::{Polynomial, degrees};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How far the middle of three sums may be off the line, in parts of the sum of moduli. Endpoints
/// are accurate to about 1e-14; what a missing point does is as large as the bend of its own way,
/// measured from 1e-7 for one of some thousand on.
pub const MOST_DEVIATION: f64 = 1e-9;

/// Reason why there is no trace test.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTraceTest {
    /// No common linear forms.
    #[error(
        "its variables are in several groups, one of them homogeneous; use affine groups, or one \
         homogeneous group"
    )]
    Groups,
    /// The line of parameters makes no curve of polynomials.
    #[error("a parameter stands below a line; give what it makes there as a parameter of its own")]
    BelowALine,
}

/// Slices that move in parallel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Pencil {
    /// Direction in which the parameters move.
    pub direction: Vec<Complex64>,
    /// Coordinates are taken where this form in some variables is 1; `None` as they are.
    pub patch: Option<Vec<(usize, Complex64)>>,
}

/// The curve over a line of parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Curve {
    /// Parameters where the line begins: the base.
    pub parameters: Vec<Complex64>,
    /// Direction of the line.
    pub direction: Vec<Complex64>,
    /// Layout of the coordinates of points on the curve.
    pub shape: PointShape,
    /// Coefficients of the section that holds the solutions of the base.
    pub first_section: Vec<Complex64>,
    /// Parallel motion of the sections.
    pub pencil: Pencil,
}

impl Curve {
    /// Homotopy from one section of the curve to another, by their coefficients.
    pub fn homotopy(&self, start: &[Complex64], target: &[Complex64]) -> HomotopyKind {
        HomotopyKind::Sections {
            parameters: self.parameters.clone(),
            direction: self.direction.clone(),
            start: start.to_vec(),
            target: target.to_vec(),
        }
    }
}

/// A trace test by the equations that move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum TraceTest {
    /// Equations of the search itself, whose parameters are those of slices.
    Slices(Pencil),
    /// Sections of the curve that the family has over a line.
    Sections(Box<Curve>),
}

impl TraceTest {
    /// The test for solutions at the base. `direction`: random parameters as large as those.
    pub fn of(
        system: &System,
        base: &[Complex64],
        direction: Vec<Complex64>,
        seed: u64,
    ) -> Result<Self, NoTraceTest> {
        let mut random = RandomStream::new(seed, Purpose::Loop, 3 << 32);
        if let Some(constants) = moving_constants(system) {
            let mut direction = vec![Complex64::default(); base.len()];
            for p in constants {
                direction[p] = random.unit();
            }
            return Ok(Self::Slices(Pencil {
                direction,
                patch: None,
            }));
        }
        let (members, constant) = section_variables(system).ok_or(NoTraceTest::Groups)?;
        let curve = sections(system, base, &direction).ok_or(NoTraceTest::Groups)?;
        degrees(&curve).map_err(|_| NoTraceTest::BelowALine)?;
        let length = members.len() + usize::from(constant);
        let mut section_parameters: Vec<Complex64> = (0..length).map(|_| random.unit()).collect();
        section_parameters.resize(2 * length, Complex64::default());
        let mut moves = vec![Complex64::default(); 2 * length];
        let patch = if constant {
            moves[2 * length - 1] = random.unit();
            None
        } else {
            let form: Vec<_> = members.iter().map(|&v| (v, random.unit())).collect();
            for (place, (_, c)) in moves[length..].iter_mut().zip(&form) {
                *place = *c;
            }
            Some(form)
        };
        Ok(Self::Sections(Box::new(Curve {
            parameters: base.to_vec(),
            direction,
            shape: PointShape::of(&curve),
            first_section: section_parameters,
            pencil: Pencil {
                direction: moves,
                patch,
            },
        })))
    }
}

/// Whether a trace test moves parameters of a system themselves.
pub(crate) fn has_pencil(system: &System) -> bool {
    moving_constants(system).is_some()
}

/// The parameters whose moves are those of parallel slices.
fn moving_constants(system: &System) -> Option<Vec<usize>> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return None;
    }
    slices(system).or_else(|| hyperplane(system))
}

/// The terms of an equation by the exponents of its variables and the parameter in each, if there is one:
/// where the equation is linear in its parameters.
fn linear_terms(system: &System, equation: NodeId) -> Option<Vec<(Vec<u32>, Option<usize>)>> {
    let (n, count) = (system.variables.len(), system.parameters.len());
    let f = Polynomial::expand(&system.expressions, equation, n, count)?;
    let terms = f.terms.keys().map(|exponents| {
        let (of_variables, of_parameters) = exponents.split_at(n);
        let parameter = of_parameters.iter().position(|&k| k > 0);
        let linear = of_parameters.iter().sum::<u32>() <= 1;
        linear.then(|| (of_variables.to_vec(), parameter))
    });
    terms.collect()
}

/// The parameters that are the constants of slices, where all parameters of a system are
/// coefficients of linear equations, each of one only, and there are enough of them for a slice to
/// lie anywhere.
fn slices(system: &System) -> Option<Vec<usize>> {
    let n = system.variables.len();
    let (mut constants, mut coefficient_counts, mut number) = (Vec::new(), Vec::new(), 0);
    let mut seen = vec![0usize; system.parameters.len()];
    for &equation in &system.equations {
        let terms = linear_terms(system, equation)?;
        if terms.iter().all(|(_, parameter)| parameter.is_none()) {
            continue;
        }
        number += 1;
        let mut coefficients = 0;
        let mut constant = None;
        for (exponents, parameter) in terms {
            let degree = exponents.iter().sum::<u32>();
            if degree > 1 {
                return None;
            }
            let Some(parameter) = parameter else {
                continue;
            };
            seen[parameter] += 1;
            coefficients += 1;
            if degree == 0 {
                constant = Some(parameter);
            }
        }
        constants.push(constant?);
        coefficient_counts.push(coefficients);
    }
    // Linear combinations of d slices may have d coefficients that are as they please.
    let enough = coefficient_counts.iter().all(|&k| k + number > n);
    (number > 0 && enough && seen.iter().all(|&k| k <= 1)).then_some(constants)
}

/// The constant of the first equation, where each equation is a linear combination of polynomials with
/// parameters of its own for coefficients, 1 and every variable among these polynomials.
///
/// They embed the space, so that an equation is a hyperplane that may lie anywhere, the other equations cut
/// out an irreducible curve (Bertini's theorem), and parallel hyperplanes cut that curve in points whose
/// coordinates have sums that move on a line.
fn hyperplane(system: &System) -> Option<Vec<usize>> {
    let n = system.variables.len();
    let mut owners = vec![None; system.parameters.len()];
    let mut first = None;
    for (i, &equation) in system.equations.iter().enumerate() {
        let terms = linear_terms(system, equation)?;
        let mut stand_in = BTreeMap::<usize, Vec<&Vec<u32>>>::new();
        for (exponents, parameter) in &terms {
            if let Some(parameter) = *parameter {
                if *owners[parameter].get_or_insert(i) != i {
                    return None;
                }
                stand_in.entry(parameter).or_default().push(exponents);
            }
        }
        let alone = |parameter: usize| match stand_in[&parameter].as_slice() {
            [exponents] if exponents.iter().sum::<u32>() <= 1 => {
                Some(exponents.iter().position(|&e| e == 1).unwrap_or(n))
            }
            _ => None,
        };
        let free: BTreeMap<usize, usize> = stand_in
            .keys()
            .filter_map(|&parameter| Some((alone(parameter)?, parameter)))
            .collect();
        if free.len() <= n {
            return None;
        }
        first = first.or(free.get(&n).copied());
    }
    first.map(|constant| vec![constant])
}

/// How far the sum at the middle of three parallel slices is from the mean of the other two, in
/// parts of the sums of moduli: the largest of all coordinates.
pub(super) fn deviation(places: [&[Vec<Complex64>]; 3], pencil: &Pencil) -> f64 {
    let n = places[0].first().map_or(0, Vec::len);
    let (mut bent, mut size) = (vec![Complex64::default(); n], vec![0.0f64; n]);
    for (points, weight) in places.into_iter().zip([1.0, -2.0, 1.0]) {
        for point in points {
            let mut divisor = vec![Complex64::new(1.0, 0.0); n];
            if let Some(form) = &pencil.patch {
                let value: Complex64 = form.iter().map(|(v, c)| point[*v] * c).sum();
                for (v, _) in form {
                    divisor[*v] = value;
                }
            }
            for (i, (z, divisor)) in point.iter().zip(divisor).enumerate() {
                let y = z / divisor;
                bent[i] += y * weight;
                size[i] += y.norm_sqr().sqrt();
            }
        }
    }
    let parts = bent.iter().zip(&size).filter(|(_, size)| **size > 0.0);
    let parts = parts.map(|(bent, size)| bent.norm_sqr().sqrt() / size);
    // A number that is none is no small one.
    parts.fold(0.0, |most, part| if part <= most { most } else { part })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        match cognate_systems::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn slices_are_seen_by_their_parameters() {
        let sliced = "variable_group x, y; parameter a, b, c; function f, g; g = x^3 + y^2 - x*y;";
        let slice_constants = |equation: &str| slices(&read(&format!("{sliced} f = {equation};")));
        assert_eq!(slice_constants("a*x + b*y + c"), Some(vec![2]));
        assert_eq!(
            slice_constants("x + b*y + c"),
            Some(vec![2]),
            "up to a factor it lies anywhere"
        );
        assert_eq!(
            slice_constants("x + y + c"),
            None,
            "always in one direction"
        );
        assert_eq!(
            slice_constants("a*x + b*y + 1"),
            None,
            "its constant does not move"
        );
        assert_eq!(slice_constants("a*x^2 + b*y + c"), None);
        assert_eq!(
            slice_constants("a*x + a*y + c"),
            None,
            "one parameter twice"
        );
        assert_eq!(slice_constants("a*b*x + b*y + c"), None);
    }

    #[test]
    fn combinations_that_embed_the_space_are_seen() {
        let hyperplane_constants =
            |text: &str| hyperplane(&read(&format!("variable_group x, y; {text}")));
        let eight = "parameter a, b, c, d, e, f, g, h; function p, q;";
        let circles = format!(
            "{eight} p = a*(x^2 + y^2) + b*x + c*y + d; q = e*(x^2 + y^2) + f*x + g*y + h;"
        );
        assert_eq!(hyperplane_constants(&circles), Some(vec![3]));
        let shared = circles.replace("e*(", "a*(");
        assert_eq!(
            hyperplane_constants(&shared),
            None,
            "one parameter in two equations"
        );
        let bound = circles.replace("+ g*y", "+ f*y");
        assert_eq!(
            hyperplane_constants(&bound),
            None,
            "x and y have one parameter"
        );
        let fixed = circles.replace("+ h;", "+ 1;");
        assert_eq!(
            hyperplane_constants(&fixed),
            None,
            "a constant does not move"
        );
        let square = circles.replace("a*(", "a^2*(");
        assert_eq!(hyperplane_constants(&square), None, "not linear in a");
    }

    /// x y = 1 on parallel lines has a sum that moves on a line; one of its two points has not.
    #[test]
    fn a_sum_is_straight_and_a_part_is_not() {
        let pencil = Pencil {
            direction: Vec::new(),
            patch: None,
        };
        // x + y = c: x is a root of x^2 - c x + 1.
        let at = |c: f64| {
            let root = (c * c / 4.0 - 1.0).sqrt();
            [c / 2.0 - root, c / 2.0 + root]
                .map(|x| vec![Complex64::new(x, 0.0), Complex64::new(c - x, 0.0)])
        };
        let [a, b, c] = [at(3.0), at(4.0), at(5.0)];
        assert!(deviation([&a, &b, &c], &pencil) < 1e-15);
        assert!(deviation([&a[..1], &b[..1], &c[..1]], &pencil) > 1e-3);
        let patch = Some(vec![
            (0, Complex64::new(0.0, 1.0)),
            (1, Complex64::new(2.0, 0.0)),
        ]);
        let scaled = |points: &[Vec<Complex64>]| -> Vec<Vec<Complex64>> {
            let scale = Complex64::new(3.0, -1.0);
            points
                .iter()
                .map(|p| p.iter().map(|z| z * scale).collect())
                .collect()
        };
        let patched = Pencil { patch, ..pencil };
        let one = deviation([&a, &b, &c], &patched);
        let other = deviation([&scaled(&a), &scaled(&b), &scaled(&c)], &patched);
        assert!((one - other).abs() < 1e-12, "{one} {other}");
    }

    #[test]
    fn what_cannot_be_tested_is_named() {
        let one = [Complex64::new(1.0, 0.5)];
        let test = |text: &str| TraceTest::of(&read(text), &one, vec![one[0]], 1);
        let below = "variable_group x; parameter p; function f; f = x^2 - 1/p;";
        assert_eq!(test(below), Err(NoTraceTest::BelowALine));
        let groups = "hom_variable_group x, y; variable_group z; parameter p; function f, g; \
                      f = x^2 - p*y^2; g = z - p;";
        assert_eq!(test(groups), Err(NoTraceTest::Groups));
        let plain = test("variable_group x; parameter p; function f; f = x^3 - p;").unwrap();
        assert!(matches!(plain, TraceTest::Sections(_)));
    }
}
