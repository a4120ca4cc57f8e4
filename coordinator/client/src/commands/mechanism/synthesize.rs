//! `cognate mechanism synthesize`: four-bars that miss many poses, points or pairs of angles least.

use super::read::{Read, described, refuse_locks, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismSynthesize;
use crate::output::mechanisms::approximate::{self as shown, Synthesized};
use crate::output::objects;
use crate::output::text::Look;
use crate::problem::read_file;
use cognate_kinematics::mechanism::pose::ReadPose;
use cognate_kinematics::mechanism::targets::{self, PoseForm};
use cognate_kinematics::mechanism::{Body, JointKind, Mechanism, Space};
use cognate_mechanism_solver::approximate::angle_pairs::function_generators;
use cognate_mechanism_solver::approximate::dyads::{PlanarPose, dyads};
use cognate_mechanism_solver::approximate::path_points::path_linkages;
use num_complex::Complex64;

/// Links of a four-bar, and its joints.
const LINKS: usize = 4;

/// Runs it.
pub fn run(a: &MechanismSynthesize) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    refuse_locks(&a.mechanism)?;
    if !a.approximate {
        return Err(wrong(
            "--approximate",
            "expected, since this command is for more than can be met; what can be met exactly is found by \
             cognate synthesize body-guidance, nine-point, function-generation or spatial-dyads",
        ));
    }
    if !is_four_bar(&read.mechanism) {
        return Err(wrong(
            &read.mechanism.file,
            "not in this version: approximate synthesis of anything but a planar four-bar with four joints of type R",
        ));
    }
    let answer = answer(a, &read)?;
    for doubt in answer.doubts() {
        eprintln!("warning: {doubt}");
    }
    objects::print(
        a.format,
        &["/dyads", "/linkages"],
        || {
            shown::table(
                &answer,
                read.degrees(&a.mechanism),
                Look::of_standard_output(),
            )
        },
        || shown::json(&read.mechanism, &read.content, &answer),
    )?;
    Ok(Exit::of_settled(answer.doubts().is_empty()))
}

fn answer(a: &MechanismSynthesize, read: &Read) -> Result<Synthesized, ClientError> {
    let degrees = read.degrees(&a.mechanism);
    let task = &a.task;
    if let Some(path) = &task.poses {
        let (name, content) = read_file(path)?;
        let form = PoseForm::whole(Space::Planar, degrees);
        let poses = targets::poses(&name, &content, form).map_err(|e| described(&e))?;
        let planar = |read: &ReadPose| {
            let (place, axis) = (read.pose.position, read.pose.rotation);
            PlanarPose {
                place: Complex64::new(place[0].re, place[1].re),
                direction: Complex64::new(axis[0][0].re, axis[1][0].re),
            }
        };
        let poses: Vec<PlanarPose> = poses.iter().map(planar).collect();
        let answer = dyads(&poses, a.seed).map_err(|message| wrong(&name, message))?;
        return Ok(Synthesized::Dyads(answer));
    }
    if let Some(path) = &task.pairs {
        let (name, content) = read_file(path)?;
        let pairs = targets::angle_pairs(&name, &content, degrees).map_err(|e| described(&e))?;
        let direction = |[c, s]: [f64; 2]| Complex64::new(c, s);
        let pairs: Vec<[Complex64; 2]> =
            pairs.into_iter().map(|pair| pair.map(direction)).collect();
        let answer =
            function_generators(&pairs, a.seed).map_err(|message| wrong(&name, message))?;
        return Ok(Synthesized::FunctionGenerators(answer));
    }
    let Some(path) = &task.points else {
        unreachable!("the arguments name one of the three")
    };
    let (name, content) = read_file(path)?;
    let points = targets::points(&name, &content, true).map_err(|e| described(&e))?;
    let points: Vec<Complex64> = points.iter().map(|p| Complex64::new(p[0], p[1])).collect();
    let answer = path_linkages(&points, a.starts, a.seed, a.threads);
    Ok(Synthesized::PathLinkages(
        answer.map_err(|message| wrong(&name, message))?,
    ))
}

/// Whether the links are one loop of four with joints that turn.
fn is_four_bar(mechanism: &Mechanism) -> bool {
    let Body::Linkage(linkage) = &mechanism.body else {
        return false;
    };
    let joints_of = |link: usize| {
        linkage
            .joints
            .iter()
            .filter(|joint| joint.links.contains(&link))
            .count()
    };
    mechanism.space == Space::Planar
        && linkage.links.len() == LINKS
        && linkage.joints.len() == LINKS
        && linkage
            .joints
            .iter()
            .all(|joint| joint.kind == JointKind::R)
        && (0..LINKS).all(|link| joints_of(link) == 2)
}
