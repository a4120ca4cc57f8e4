//! A platform on legs in space, forward: Study coordinates, an equation a leg (M. L. Husty 1996); with a fixed
//! orientation the place of the platform alone.

use super::formulation::{
    Configuration, Family, Formulation, Lifted, PathText, Problem, Target, half_tangent,
    overdriven, turn_of, unbalanced,
};
use super::text::{self, Equations};
use crate::mechanism::chain::JointValue;
use crate::mechanism::exact::Number;
use crate::mechanism::exact::double_expression;
use crate::mechanism::pose::{Pose, Vector3, cross, unit};
use crate::mechanism::{Leg, LegKind, Mechanism, MechanismError, PLATFORM, Platform, Vector};
use crate::plane::modulus;
use num_complex::Complex64;
use std::sync::Arc;

/// The formulation of a platform's forward question.
pub fn compile(
    mechanism: &Mechanism,
    platform: &Platform,
    problem: Problem,
) -> Result<Box<dyn Formulation>, MechanismError> {
    let driven: Vec<String> = platform
        .legs
        .iter()
        .filter(|l| l.is_driven())
        .map(|l| l.name.clone())
        .collect();
    let mut equations = Equations::default();
    let legs = equations_of_legs(platform, problem, &mut equations);
    if platform.fixed_orientation {
        equations.groups = vec![["x", "y", "z"].map(String::from).to_vec()];
    } else {
        let names = ["x", "y"]
            .iter()
            .flat_map(|c| (0..4).map(move |k| format!("{c}{k}")));
        equations.groups = vec![names.collect()];
        equations.homogeneous = true;
        equations.equations.push("x0*y0+x1*y1+x2*y2+x3*y3".into());
        equations.degenerate.push(("no pose", NORM.into()));
    }
    for (leg, (foot, square)) in platform.legs.iter().zip(&legs) {
        if problem == Problem::Motion && leg.is_driven() {
            // A strut of any length holds nothing.
            continue;
        }
        let head = vector_text(&leg.to, problem);
        let equation = if platform.fixed_orientation {
            let place = ["x", "y", "z"].map(String::from);
            let away: [String; 3] = std::array::from_fn(|k| {
                text::minus(&text::sum(&[place[k].clone(), head[k].clone()]), &foot[k])
            });
            format!("{}-{square}", text::dot(&away, &away))
        } else {
            leg_equation(foot, &head, square)
        };
        equations.equations.push(equation);
    }
    if problem == Problem::Forward {
        overdriven(mechanism, &driven)?;
        unbalanced(
            mechanism,
            &driven,
            equations.unknowns(),
            equations.equations.len(),
        )?;
    }
    Ok(Box::new(Forward {
        family: family(platform),
        platform: platform.clone(),
        inputs: if problem == Problem::Forward {
            driven
        } else {
            Vec::new()
        },
        all_driven: problem == Problem::Forward,
        equations,
    }))
}

/// Vanishes where Study coordinates are no pose.
const NORM: &str = "x0^2+x1^2+x2^2+x3^2";

fn family(platform: &Platform) -> Family {
    let words: Vec<&str> = platform.legs.iter().map(|l| l.word.as_str()).collect();
    let same = words.iter().all(|w| *w == words[0]);
    let word = if same {
        words[0].to_owned()
    } else {
        words.join("+")
    };
    let count = platform.legs.len();
    let constraints = count;
    let (expected, source) = match (platform.fixed_orientation, constraints) {
        (true, 3) => (Some(2), "three spheres"),
        (false, 6) => (Some(40), "Raghavan 1993, Mourrain 1993"),
        _ => (None, "not known"),
    };
    Family {
        name: format!("{count}-{word}"),
        expected,
        source,
        representation: if platform.fixed_orientation {
            "the platform's place"
        } else {
            "Study coordinates in P^7"
        },
    }
}

/// A point as text: for all positions together without rounding of roots.
fn vector_text(point: &Vector, problem: Problem) -> [String; 3] {
    match problem {
        Problem::Motion => text::exact_vector(point),
        Problem::Forward | Problem::Inverse => text::vector(point),
    }
}

/// For every leg its foot, the point at which the rod begins, and the square of the rod's length.
fn equations_of_legs(
    platform: &Platform,
    problem: Problem,
    equations: &mut Equations,
) -> Vec<([String; 3], String)> {
    let mut leg_equations = Vec::new();
    for (k, leg) in platform.legs.iter().enumerate() {
        let number = format!("{}", k + 1);
        leg_equations.push(match &leg.kind {
            LegKind::Strut { from, length, .. } => {
                let square = match length {
                    Some(length) if problem == Problem::Motion => length.square_expression(),
                    Some(length) => format!("{}^2", length.expression()),
                    None => {
                        let name = format!("square_{number}");
                        if problem == Problem::Forward {
                            equations.parameters.push(name.clone());
                        }
                        name
                    }
                };
                (vector_text(from, problem), square)
            }
            LegKind::Crank { rod, .. } => {
                let (c, s) = text::turn(equations, &number);
                (crank_tip(leg, &c, &s), format!("{}^2", rod.expression()))
            }
            LegKind::Slider { origin, rod, .. } => {
                let name = format!("shift_{number}");
                equations.parameters.push(name.clone());
                let along = slide_direction(leg);
                let tip = std::array::from_fn(|i| {
                    let shift = text::times(&double_expression(along[i]), &name);
                    text::sum(&[origin[i].expression(), shift])
                });
                (tip, format!("{}^2", rod.expression()))
            }
        });
    }
    leg_equations
}

/// The tip of a crank by cosine and sine, as expressions.
pub fn crank_tip(leg: &Leg, c: &str, s: &str) -> [String; 3] {
    let LegKind::Crank { center, length, .. } = &leg.kind else {
        return ["0", "0", "0"].map(String::from);
    };
    let (along, aside) = crank_frame(leg);
    std::array::from_fn(|i| {
        let turned = text::sum(&[
            text::times(&double_expression(along[i]), c),
            text::times(&double_expression(aside[i]), s),
        ]);
        text::sum(&[
            center[i].expression(),
            text::times(&length.expression(), &turned),
        ])
    })
}

fn real(v: &Vector) -> [f64; 3] {
    [v[0].to_f64(), v[1].to_f64(), v[2].to_f64()]
}

/// Unit vectors of a crank at 0 and at 90 degrees.
pub fn crank_frame(leg: &Leg) -> ([f64; 3], [f64; 3]) {
    let LegKind::Crank { axis, zero, .. } = &leg.kind else {
        return ([0.0; 3], [0.0; 3]);
    };
    let axis = unit(real(axis)).unwrap_or([0.0, 0.0, 1.0]);
    let zero = real(zero);
    // Without the part along the axis that rounding may leave.
    let along: f64 = (0..3).map(|i| zero[i] * axis[i]).sum();
    let zero = unit(std::array::from_fn(|i| zero[i] - along * axis[i])).unwrap_or([1.0, 0.0, 0.0]);
    (zero, cross(axis, zero))
}

/// Unit vector of a slider.
pub fn slide_direction(leg: &Leg) -> [f64; 3] {
    match &leg.kind {
        LegKind::Slider { direction, .. } => unit(real(direction)).unwrap_or([1.0, 0.0, 0.0]),
        _ => [0.0; 3],
    }
}

/// Parameters of a leg's input: the squared length, the half-tangent, the shift.
fn leg_parameters(leg: &Leg, value: f64) -> Vec<Complex64> {
    match &leg.kind {
        LegKind::Strut { .. } => vec![(value * value).into()],
        LegKind::Crank { .. } => half_tangent(value).to_vec(),
        LegKind::Slider { .. } => vec![value.into()],
    }
}

/// Parameters of all legs that are driven, by the values of their inputs.
///
/// # Errors
/// When the target is a pose.
pub fn driven_parameters(platform: &Platform, target: &Target) -> Result<Vec<Complex64>, String> {
    let Target::Inputs(values) = target else {
        return Err("expected values of the inputs".into());
    };
    let driven = platform.legs.iter().filter(|l| l.is_driven());
    let pairs = driven.zip(values);
    Ok(pairs.flat_map(|(leg, x)| leg_parameters(leg, *x)).collect())
}

/// Random parameters of all legs that are driven, as large as the lengths of the platform.
pub fn random_parameters(
    platform: &Platform,
    draw: &mut dyn FnMut() -> Complex64,
) -> Vec<Complex64> {
    let size = size(platform);
    let mut values = Vec::new();
    for leg in platform.legs.iter().filter(|l| l.is_driven()) {
        match leg.kind {
            LegKind::Strut { .. } => values.push(draw() * (size * size)),
            LegKind::Crank { .. } => values.extend([draw(), draw()]),
            LegKind::Slider { .. } => values.push(draw() * size),
        }
    }
    values
}

/// Where the rod of a leg begins, and the square of its length, at parameters; takes its own from the front.
pub fn foot_of_leg(leg: &Leg, parameters: &mut &[Complex64]) -> (Vector3, Complex64) {
    let mut next = || match parameters.split_first() {
        Some((first, rest)) => {
            *parameters = rest;
            *first
        }
        None => Complex64::default(),
    };
    let square = |n: &Number| Complex64::from(n.to_f64() * n.to_f64());
    match &leg.kind {
        LegKind::Strut { from, length, .. } => {
            let length = match length {
                Some(length) => square(length),
                None => next(),
            };
            (real(from).map(Complex64::from), length)
        }
        LegKind::Crank {
            center,
            length,
            rod,
            ..
        } => {
            let (t, w) = (next(), next());
            let (c, s) = turn_of(t, w);
            let (along, aside) = crank_frame(leg);
            let center = real(center);
            let tip = std::array::from_fn(|i| {
                (c * along[i] + s * aside[i]) * length.to_f64() + center[i]
            });
            (tip, square(rod))
        }
        LegKind::Slider { origin, rod, .. } => {
            let shift = next();
            let (origin, along) = (real(origin), slide_direction(leg));
            (
                std::array::from_fn(|i| shift * along[i] + origin[i]),
                square(rod),
            )
        }
    }
}

/// A length of the platform: the largest coordinate or length of a leg.
pub fn size(platform: &Platform) -> f64 {
    let mut size = 0.0f64;
    for leg in &platform.legs {
        let mut points: Vec<[f64; 3]> = vec![real(&leg.to)];
        match &leg.kind {
            LegKind::Strut { from, length, .. } => {
                points.push(real(from));
                size = size.max(length.as_ref().map_or(0.0, Number::to_f64));
            }
            LegKind::Crank {
                center,
                length,
                rod,
                ..
            } => {
                points.push(real(center));
                size = size.max(length.to_f64()).max(rod.to_f64());
            }
            LegKind::Slider { origin, rod, .. } => {
                points.push(real(origin));
                size = size.max(rod.to_f64());
            }
        }
        for point in points {
            size = point.iter().fold(size, |m, c| m.max(c.abs()));
        }
    }
    if size > 0.0 { size } else { 1.0 }
}

/// |R b + p - a|^2 = square in Study coordinates: rotation e = (x0..x3), p e = (y0..y3); the survey's (31).
pub fn leg_equation(a: &[String; 3], b: &[String; 3], square: &str) -> String {
    let [a1, a2, a3] = a;
    let [b1, b2, b3] = b;
    let term = |factor: &str, x: &str, y: &str, form: &str| match text::times(x, y).as_str() {
        "0" => "0".to_owned(),
        product => format!("{factor}*{product}*({form})"),
    };
    let squares = |v: &[String; 3]| text::dot(v, v);
    let constant = format!("({}+{}-{square})", squares(a), squares(b));
    let mut terms = vec![
        "y0^2+y1^2+y2^2+y3^2".to_owned(),
        format!("{constant}*({NORM})"),
        term("(-2)", a1, "1", "x0*y1-x1*y0+x2*y3-x3*y2"),
        term("(-2)", a2, "1", "x0*y2-x1*y3-x2*y0+x3*y1"),
        term("(-2)", a3, "1", "x0*y3+x1*y2-x2*y1-x3*y0"),
        term("2", b1, "1", "x0*y1-x1*y0-x2*y3+x3*y2"),
        term("2", b2, "1", "x0*y2+x1*y3-x2*y0-x3*y1"),
        term("2", b3, "1", "x0*y3-x1*y2+x2*y1-x3*y0"),
    ];
    for (factor, a, b, form) in [
        ("(-2)", a1, b1, "x0^2+x1^2-x2^2-x3^2"),
        ("(-2)", a2, b2, "x0^2-x1^2+x2^2-x3^2"),
        ("(-2)", a3, b3, "x0^2-x1^2-x2^2+x3^2"),
        ("4", a1, b2, "x0*x3-x1*x2"),
        ("(-4)", a1, b3, "x0*x2+x1*x3"),
        ("(-4)", a2, b1, "x0*x3+x1*x2"),
        ("4", a2, b3, "x0*x1-x2*x3"),
        ("4", a3, b1, "x0*x2-x1*x3"),
        ("(-4)", a3, b2, "x0*x1+x2*x3"),
    ] {
        terms.push(term(factor, a, b, form));
    }
    text::sum(&terms)
}

/// The place of a point of the platform times the square of the quaternion.
fn study_point(point: &[String; 3]) -> Vec<String> {
    let shift = [
        "x0*y1-x1*y0-x3*y2+x2*y3",
        "x0*y2-x2*y0-x1*y3+x3*y1",
        "x0*y3-x3*y0-x2*y1+x1*y2",
    ];
    let rows = [
        ["x0^2+x1^2-x2^2-x3^2", "2*(x1*x2-x0*x3)", "2*(x1*x3+x0*x2)"],
        ["2*(x1*x2+x0*x3)", "x0^2-x1^2+x2^2-x3^2", "2*(x2*x3-x0*x1)"],
        ["2*(x1*x3-x0*x2)", "2*(x2*x3+x0*x1)", "x0^2-x1^2-x2^2+x3^2"],
    ];
    let rows = rows.map(|row| row.map(|entry| format!("({entry})")));
    let coordinate = |i: usize| text::sum(&[format!("({})", shift[i]), text::dot(&rows[i], point)]);
    (0..3).map(coordinate).collect()
}

/// The pose of Study coordinates; `None` where they are none.
pub fn study_pose(point: &[Complex64]) -> Option<Pose> {
    let e = [point[0], point[1], point[2], point[3]];
    let g = [point[4], point[5], point[6], point[7]];
    let square: Complex64 = e.iter().map(|c| c * c).sum();
    // p = vector part of g times the conjugate of e, over the square.
    let p = [
        e[0] * g[1] - g[0] * e[1] - g[2] * e[3] + g[3] * e[2],
        e[0] * g[2] - g[0] * e[2] - g[3] * e[1] + g[1] * e[3],
        e[0] * g[3] - g[0] * e[3] - g[1] * e[2] + g[2] * e[1],
    ];
    // Coordinates up to a factor: what is small against their largest is 0.
    let largest = point.iter().map(|c| c.norm_sqr()).fold(0.0, f64::max);
    if square.norm_sqr() <= 1e-20 * largest * largest {
        return None;
    }
    Pose::of_quaternion(e, p.map(|c| c / square))
}

/// The largest error of a leg, in squares of the platform's size and the position's.
pub fn legs_residual(platform: &Platform, pose: &Pose, mut parameters: &[Complex64]) -> f64 {
    let size = size(platform);
    let mut most = 0.0f64;
    for leg in &platform.legs {
        let (foot, square) = foot_of_leg(leg, &mut parameters);
        let head = pose.point(real(&leg.to).map(Complex64::from));
        let away: Vector3 = std::array::from_fn(|i| head[i] - foot[i]);
        let length: Complex64 = away.iter().map(|c| c * c).sum();
        let scale: f64 = away.iter().map(|c| c.norm_sqr()).sum::<f64>() + size * size;
        most = most.max(modulus(length - square) / scale);
    }
    most
}

/// Values of legs that a target gives.
pub fn given_values(platform: &Platform, target: Option<&Target>) -> Vec<(Arc<str>, JointValue)> {
    let Some(Target::Inputs(values)) = target else {
        return Vec::new();
    };
    let driven = platform.legs.iter().filter(|l| l.is_driven());
    let value = |(leg, x): (&Leg, &f64)| {
        (
            leg.name.as_str().into(),
            JointValue::of_real(*x, leg.is_angle()),
        )
    };
    driven.zip(values).map(value).collect()
}

struct Forward {
    platform: Platform,
    family: Family,
    inputs: Vec<String>,
    all_driven: bool,
    equations: Equations,
}

impl Formulation for Forward {
    fn family(&self) -> &Family {
        &self.family
    }

    fn path(&self, link: &str, point: &Vector) -> Option<PathText> {
        (link == PLATFORM && !self.platform.fixed_orientation).then(|| PathText {
            coordinates: study_point(&text::exact_vector(point)),
            denominator: format!("({NORM})"),
            is_linear: false,
        })
    }

    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn equations(&self) -> Option<&Equations> {
        Some(&self.equations)
    }

    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        driven_parameters(&self.platform, target)
    }

    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        let is_driven = self.all_driven && !self.inputs.is_empty();
        is_driven.then(|| random_parameters(&self.platform, draw))
    }

    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted {
        let pose = if self.platform.fixed_orientation {
            Some(Pose {
                position: [point[0], point[1], point[2]],
                ..Pose::IDENTITY
            })
        } else {
            study_pose(point)
        };
        let Some(pose) = pose else {
            return Lifted::Degenerate("no pose");
        };
        Lifted::Position(Box::new(Configuration {
            values: given_values(&self.platform, target),
            output: Some(self.platform.output(&pose)),
            bodies: vec![(PLATFORM.into(), pose)],
            residual: legs_residual(&self.platform, &pose, parameters),
        }))
    }
}
