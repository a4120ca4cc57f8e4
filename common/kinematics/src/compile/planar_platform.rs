//! A platform on legs in the plane, forward: isotropic coordinates p, P, g, G, two groups.

use super::formulation::{
    Configuration, Family, Formulation, Lifted, Problem, Target, overdriven, unbalanced,
};
use super::platform::{
    driven_parameters, given_values, legs_residual, random_parameters, slide_direction,
};
use super::text::{self, Equations, complex};
use crate::mechanism::exact::double_expression;
use crate::mechanism::pose::Pose;
use crate::mechanism::{LegKind, Mechanism, MechanismError, PLATFORM, Platform};
use num_complex::Complex64;

/// The formulation of a planar platform's forward question.
pub fn compile(
    mechanism: &Mechanism,
    platform: &Platform,
    problem: Problem,
) -> Result<Box<dyn Formulation>, MechanismError> {
    if platform.fixed_orientation {
        return Err(mechanism.error("a fixed orientation is for platforms in space"));
    }
    let driven: Vec<String> = platform
        .legs
        .iter()
        .filter(|l| l.is_driven())
        .map(|l| l.name.clone())
        .collect();
    let mut equations = Equations {
        groups: vec![vec!["p".into(), "g".into()], vec!["P".into(), "G".into()]],
        conjugates: vec![("p".into(), "P".into()), ("g".into(), "G".into())],
        equations: vec!["g*G-1".into()],
        ..Equations::default()
    };
    for (k, leg) in platform.legs.iter().enumerate() {
        let number = k + 1;
        let ends: [String; 2] = foot(leg, number, problem, &mut equations);
        let [b, b_bar] =
            [false, true].map(|bar| complex(&leg.to[0].expression(), &leg.to[1].expression(), bar));
        let square = match &leg.kind {
            LegKind::Strut {
                length: Some(length),
                ..
            } => format!("{}^2", length.expression()),
            LegKind::Strut { .. } => format!("square_{number}"),
            LegKind::Crank { rod, .. } | LegKind::Slider { rod, .. } => {
                format!("{}^2", rod.expression())
            }
        };
        let side = |p: &str, g: &str, b: &str, foot: &str| {
            text::minus(&text::sum(&[p.to_owned(), text::times(g, b)]), foot)
        };
        let product = format!(
            "{}*{}",
            side("p", "g", &b, &ends[0]),
            side("P", "G", &b_bar, &ends[1])
        );
        equations.equations.push(format!("{product}-{square}"));
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
    let words: Vec<&str> = platform.legs.iter().map(|l| l.word.as_str()).collect();
    let same = words.iter().all(|w| *w == words[0]);
    let family = Family {
        name: format!(
            "{}-{}",
            words.len(),
            if same {
                words[0].to_owned()
            } else {
                words.join("+")
            }
        ),
        expected: (words.len() == 3).then_some(6),
        source: "Hunt 1983, Gosselin 1992",
        representation: "isotropic coordinates of the platform, two groups",
    };
    Ok(Box::new(Forward {
        platform: platform.clone(),
        family,
        inputs: if problem == Problem::Forward {
            driven
        } else {
            Vec::new()
        },
        equations,
    }))
}

/// The foot of a leg and its conjugate.
fn foot(
    leg: &crate::mechanism::Leg,
    number: usize,
    problem: Problem,
    equations: &mut Equations,
) -> [String; 2] {
    let point =
        |v: &crate::mechanism::Vector, bar| complex(&v[0].expression(), &v[1].expression(), bar);
    match &leg.kind {
        LegKind::Strut { from, length, .. } => {
            if length.is_none() && problem == Problem::Forward {
                equations.parameters.push(format!("square_{number}"));
            }
            [false, true].map(|bar| point(from, bar))
        }
        LegKind::Crank { center, length, .. } => {
            let (t, w) = (format!("t_{number}"), format!("w_{number}"));
            equations.parameters.extend([t.clone(), w.clone()]);
            let (along, _) = super::platform::crank_frame(leg);
            [false, true].map(|bar| {
                // e^(i angle) = (w + i t)/(w - i t).
                let (above, below) = if bar { ("-", "+") } else { ("+", "-") };
                let turn = format!("({w}{above}I*{t})/({w}{below}I*{t})");
                let zero = complex(
                    &double_expression(along[0]),
                    &double_expression(along[1]),
                    bar,
                );
                let arm = text::times(&text::times(&length.expression(), &zero), &turn);
                text::sum(&[point(center, bar), arm])
            })
        }
        LegKind::Slider { origin, .. } => {
            let name = format!("shift_{number}");
            equations.parameters.push(name.clone());
            let along = slide_direction(leg);
            [false, true].map(|bar| {
                let direction = complex(
                    &double_expression(along[0]),
                    &double_expression(along[1]),
                    bar,
                );
                text::sum(&[point(origin, bar), text::times(&name, &direction)])
            })
        }
    }
}

/// The pose of isotropic coordinates: p and g with their conjugates P and G.
pub fn isotropic_pose(p: Complex64, p_bar: Complex64, g: Complex64, g_bar: Complex64) -> Pose {
    let half_i = Complex64::new(0.0, 0.5);
    let real = |z: Complex64, bar: Complex64| (z + bar) * 0.5;
    let imaginary = |z: Complex64, bar: Complex64| (bar - z) * half_i;
    Pose {
        position: [real(p, p_bar), imaginary(p, p_bar), Complex64::default()],
        ..Pose::about_z(real(g, g_bar), imaginary(g, g_bar))
    }
}

struct Forward {
    platform: Platform,
    family: Family,
    inputs: Vec<String>,
    equations: Equations,
}

impl Formulation for Forward {
    fn family(&self) -> &Family {
        &self.family
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
        let is_driven = !self.inputs.is_empty();
        is_driven.then(|| random_parameters(&self.platform, draw))
    }

    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted {
        let pose = isotropic_pose(point[0], point[2], point[1], point[3]);
        Lifted::Position(Box::new(Configuration {
            values: given_values(&self.platform, target),
            output: Some(self.platform.output(&pose)),
            bodies: vec![(PLATFORM.into(), pose)],
            residual: legs_residual(&self.platform, &pose, parameters),
        }))
    }
}
