//! Motion: all configurations of a mechanism together, as the solutions of equations whose unknowns are the coordinates
//! in which degrees of motions are counted.
//!
//! Planar linkages: turns of the links. Loops in space and about a point: turns and shifts of the joints. Frameworks: the
//! points. Platforms: Study coordinates. Numbers of the file stay exact, square roots among them.

use super::configurations::{ROUNDED, no_path};
use super::formulation::{Lifted, Problem, Question};
use super::{compile, joint_loops, size};
use crate::mechanism::chain::JointValue;
use crate::mechanism::pose::Pose;
use crate::mechanism::{Body, JointKind, LegKind, Linkage, Mechanism, MechanismError, Space};
use cognate_numeric::counted::counted;

pub use super::configurations::{DegreeIn, Motion, Placed, TracedPoint};

/// Equations of all configurations, and the path of a point, where one is named.
///
/// # Errors
/// When the mechanism cannot be decomposed; the message says what to type instead.
pub fn motion(
    mechanism: &Mechanism,
    traced: Option<&TracedPoint>,
) -> Result<Motion, MechanismError> {
    let mut motion = motion_with_constants(mechanism, traced)?;
    let length = size(mechanism);
    if let Some(gap) = motion.equations.settle_constants(mechanism, length)? {
        motion.warnings.push(gap);
    }
    Ok(motion)
}

/// As [`motion`], but equations without unknowns remain among the equations.
///
/// # Errors
/// As those of [`motion`].
pub fn motion_with_constants(
    mechanism: &Mechanism,
    traced: Option<&TracedPoint>,
) -> Result<Motion, MechanismError> {
    match &mechanism.body {
        Body::Linkage(linkage) if mechanism.space == Space::Planar => {
            planar(mechanism, linkage, traced)
        }
        Body::Linkage(linkage) => {
            let motion = joint_loops::of_linkage(mechanism, linkage, traced);
            motion.map(|motion| Motion {
                warnings: rounded_numbers(mechanism),
                ..motion
            })
        }
        Body::Chain(chain) if chain.closed => joint_loops::of_chain(mechanism, chain, traced),
        Body::Chain(chain) => Err(mechanism.error(format!(
            "an open chain of {} moves freely in each of them; motion is of closed loops: write it as \"loop\"",
            counted(chain.joints.len(), "joint")
        ))),
        Body::Framework(_) => framework(mechanism, traced),
        Body::Platform(_) => platform(mechanism, traced),
    }
}

fn planar(
    mechanism: &Mechanism,
    linkage: &Linkage,
    traced: Option<&TracedPoint>,
) -> Result<Motion, MechanismError> {
    let formulation = compile(mechanism, &Question::of(Problem::Motion))?;
    let equations = formulation
        .equations()
        .cloned()
        .ok_or_else(|| mechanism.error("nothing of it moves"))?;
    let path = traced.map(|traced| {
        let path = formulation.path(&traced.link, &traced.point);
        path.ok_or_else(|| no_path(mechanism, traced))
    });
    let path = path.transpose()?;
    let is_turn = |name: &String| name.starts_with(['g', 'G']);
    let variables = equations.variables();
    let at_home = variables.iter().map(|name| f64::from(is_turn(name)));
    let home = linkage.at_home.then(|| at_home.collect());
    let against_ground: Vec<bool> = linkage
        .joints
        .iter()
        .map(|joint| joint.links[1] == linkage.ground)
        .collect();
    Ok(Motion {
        warnings: rounded_numbers(mechanism),
        equations,
        degree_in: DegreeIn::Links,
        home,
        path,
        placing: Box::new(move |solution| {
            let Lifted::Position(position) = formulation.lift(None, &[], solution) else {
                return None;
            };
            let values = position.values.into_iter().zip(&against_ground);
            let value =
                |((name, value), is_swapped): ((std::sync::Arc<str>, JointValue), &bool)| {
                    let value = match (value, is_swapped) {
                        (JointValue::Turn(c, s), true) => JointValue::Turn(c, -s),
                        (JointValue::Shift(d), true) => JointValue::Shift(-d),
                        (value, false) => value,
                    };
                    (name.to_string(), value)
                };
            Some(Placed::Joints(values.map(value).collect()))
        }),
    })
}

fn framework(
    mechanism: &Mechanism,
    traced: Option<&TracedPoint>,
) -> Result<Motion, MechanismError> {
    if let Some(traced) = traced {
        return Err(no_path(mechanism, traced));
    }
    let formulation = compile(mechanism, &Question::of(Problem::Motion))?;
    let equations = formulation.equations().cloned().unwrap_or_default();
    Ok(Motion {
        warnings: rounded_numbers(mechanism),
        equations,
        degree_in: DegreeIn::Points,
        home: None,
        path: None,
        placing: Box::new(move |solution| {
            let Lifted::Position(position) = formulation.lift(None, &[], solution) else {
                return None;
            };
            let bodies = position.bodies.into_iter();
            let place = |pose: Pose| [pose.position[0], pose.position[1]];
            let points = bodies.map(|(name, pose)| (name.to_string(), place(pose)));
            Some(Placed::Points(points.collect()))
        }),
    })
}

fn platform(mechanism: &Mechanism, traced: Option<&TracedPoint>) -> Result<Motion, MechanismError> {
    let Body::Platform(platform) = &mechanism.body else {
        return Err(mechanism.error("it is no platform"));
    };
    if mechanism.space != Space::Spatial || platform.fixed_orientation {
        return Err(mechanism.error(
            "not in this version: motion of platforms in the plane, about a point or of fixed orientation; write it as links and joints",
        ));
    }
    let is_strut = |kind: &LegKind| matches!(kind, LegKind::Strut { .. });
    if let Some(leg) = platform.legs.iter().find(|leg| !is_strut(&leg.kind)) {
        return Err(mechanism.error(format!(
            "not in this version: motion with leg {} of type {}; write it as links and joints",
            leg.name, leg.word
        )));
    }
    let formulation = compile(mechanism, &Question::of(Problem::Motion))?;
    let equations = formulation.equations().cloned().unwrap_or_default();
    let path = traced.map(|traced| {
        let path = formulation.path(&traced.link, &traced.point);
        path.ok_or_else(|| no_path(mechanism, traced))
    });
    Ok(Motion {
        warnings: rounded_numbers(mechanism),
        path: path.transpose()?,
        equations,
        degree_in: DegreeIn::Study,
        home: None,
        placing: Box::new(
            move |solution| match formulation.lift(None, &[], solution) {
                Lifted::Position(position) => position.output.map(Placed::Pose),
                _ => None,
            },
        ),
    })
}

/// A warning where numbers of the file are not written in rationals and roots.
pub(super) fn rounded_numbers(mechanism: &Mechanism) -> Vec<String> {
    let mut is_rounded = false;
    let mut look = |vector: &[&crate::mechanism::exact::Number]| {
        is_rounded |= vector.iter().any(|n| !n.is_exact_in_expressions());
    };
    match &mechanism.body {
        Body::Linkage(linkage) => {
            for side in linkage.joints.iter().flat_map(|joint| &joint.sides) {
                look(&side.point.each_ref());
                look(&side.axis.each_ref());
            }
            let shifts = linkage.joints.iter().any(|j| j.kind == JointKind::P);
            is_rounded |= shifts && !linkage.at_home;
        }
        Body::Framework(framework) => {
            for bar in &framework.bars {
                look(&[&bar.length]);
            }
        }
        Body::Platform(platform) => {
            for leg in &platform.legs {
                look(&leg.to.each_ref());
                if let LegKind::Strut { from, length, .. } = &leg.kind {
                    look(&from.each_ref());
                    look(&length.iter().collect::<Vec<_>>());
                }
            }
        }
        Body::Chain(_) => {}
    }
    match is_rounded {
        true => vec![ROUNDED.into()],
        false => Vec::new(),
    }
}
