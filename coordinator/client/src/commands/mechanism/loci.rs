//! `cognate mechanism singularities` without `--at`: all singular positions of a mechanism, decomposed.
//!
//! The equations are those of its motion and a determinant; they are decomposed as those of `motion` are. Of an arm of three
//! joints that places a point, cusps are counted instead.

use super::motion::{Asked, Wishes, Work, decomposed};
use super::read::{Read, described, orientation, refuse_locks};
use crate::commands::sequence::{Sequence, Working, served};
use crate::common_arguments::AnswerFormat;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismSingularities;
use crate::mechanism::locus_answer::{DrawnCurve, LocusAnswer, LocusComponent, SingularPosition};
use crate::mechanism::motion_answer::{Isolated, Mode};
use crate::output::mechanisms::{loci as shown, posture_changes};
use crate::output::objects;
use crate::output::text::{Look, counted};
use cognate_kinematics::compile::motion::{DegreeIn, Placed};
use cognate_kinematics::compile::singular_positions::{
    Extent, SingularKind, SingularPositions, singular_positions,
};
use cognate_mechanism_solver::local::ranks::singular_values;
use cognate_mechanism_solver::point_arm::{self, PostureChanges};
use cognate_solutions::witness::Question;
use cognate_solutions::witness::question::CurveWish;
use cognate_summary::question_answer::{CurveBlock, QuestionAnswer};
use cognate_systems::evaluation;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Points of each arc of a drawn curve, on either side of its middle.
const SAMPLES: u32 = 15;

/// Step of differences, in parts of the size of the point: equations have few terms of low degree.
const DIFFERENCE: f64 = 1e-5;
/// Equations have full rank where the smallest singular value is above this part of the largest.
const REGULAR: f64 = 1e-5;

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &MechanismSingularities) -> Result<Exit, ClientError> {
    refuse_locks(&a.mechanism)?;
    let running = a.service.running()?;
    let shown = (a.progress.progress, a.format != AnswerFormat::Table);
    let read = Read::of(&a.mechanism)?;
    let kind = read.singular_kind(a);
    if kind == SingularKind::Outputs
        && a.orientation.is_none()
        && let Some(changes) = point_arm::posture_changes(&read.mechanism, a.seed)
    {
        return print_changes(a, &read, &changes);
    }
    let angle = orientation(a.orientation.as_deref(), read.degrees(&a.mechanism))?;
    let locus = singular_positions(&read.mechanism, &kind, angle.as_ref());
    let locus = locus.map_err(|e| described(&e))?;
    if locus.extent == Extent::Nowhere {
        return print(a, &read, &without_equations(kind, &locus));
    }
    if locus.extent == Extent::Everywhere && locus.motion.equations.equations.is_empty() {
        let whole = LocusComponent {
            id: format!("{}.1", locus.whole_from),
            dimension: locus.whole_from,
            degree: 1,
            is_whole_mode: Some(true),
        };
        let mut answer = without_equations(kind, &locus);
        answer.warnings.push(whole_mode_warning(&whole));
        answer.components.push(whole);
        answer.curves = None;
        return print(a, &read, &answer);
    }
    let work = |jobs| -> Working<'_> { Box::pin(answered(a, jobs, read, (kind, locus))) };
    served(&a.service, shown, running, Box::new(work)).await
}

fn whole_mode_warning(whole: &LocusComponent) -> String {
    format!(
        "component {} is a whole mode of the motion: all its positions are singular",
        whole.id
    )
}

/// The answer where nothing is decomposed: no position is singular.
fn without_equations(kind: SingularKind, locus: &SingularPositions) -> LocusAnswer {
    LocusAnswer {
        kind,
        degree_in: locus.motion.degree_in,
        components: Vec::new(),
        isolated: Isolated {
            complex: Some(0),
            real: Some(0),
        },
        positions: Vec::new(),
        curves: Some(Vec::new()),
        removed: BTreeMap::new(),
        doubts: Vec::new(),
        warnings: locus.motion.warnings.clone(),
    }
}

fn print(
    a: &MechanismSingularities,
    read: &Read,
    answer: &LocusAnswer,
) -> Result<Exit, ClientError> {
    for warning in answer.warnings.iter().chain(&read.mechanism.warnings) {
        eprintln!("warning: {warning}");
    }
    for doubt in &answer.doubts {
        eprintln!("warning: {doubt}");
    }
    let view = shown::LocusView {
        mechanism: &read.mechanism,
        content: &read.content,
        degrees: read.degrees(&a.mechanism),
    };
    objects::print(
        a.format,
        &["/components", "/solutions"],
        || shown::table(&view, answer, Look::of_standard_output()),
        || shown::json(&view, answer),
    )?;
    Ok(Exit::of_settled(answer.is_settled()))
}

/// Prints the singular positions of an arm of three joints that places a point.
fn print_changes(
    a: &MechanismSingularities,
    read: &Read,
    changes: &PostureChanges,
) -> Result<Exit, ClientError> {
    for warning in read.mechanism.warnings.iter().chain(&changes.doubts) {
        eprintln!("warning: {warning}");
    }
    objects::print(
        a.format,
        &["/components", "/solutions"],
        || posture_changes::table(&read.mechanism, changes, Look::of_standard_output()),
        || posture_changes::json(&read.mechanism, &read.content, changes),
    )?;
    Ok(Exit::of_settled(changes.doubts.is_empty()))
}

/// Decomposes, draws the components that are curves in the plane, and prints.
async fn answered(
    a: &MechanismSingularities,
    jobs: Sequence,
    read: Read,
    (kind, locus): (SingularKind, SingularPositions),
) -> Result<Exit, ClientError> {
    let limits = [locus.whole_from, locus.maybe_whole_from];
    let (extent, closing) = (locus.extent, locus.closing);
    let asked = Asked::of_equations(&read.mechanism, locus.motion, None)?;
    let wishes = Wishes {
        seed: a.seed,
        preset: a.preset,
        asks_real: false,
        asks_path: false,
    };
    let mut work = decomposed(wishes, &jobs, &read.mechanism, &asked).await?;
    if kind == SingularKind::Outputs {
        doubt_meetings(&mut work, &asked, closing);
    }
    let curves = drawn(&mut work, &asked).await?;
    let component = |mode: &Mode| LocusComponent {
        id: mode.id.clone(),
        dimension: mode.dimension,
        degree: mode.degree,
        is_whole_mode: match mode.dimension {
            _ if extent == Extent::Everywhere => Some(true),
            dimension if dimension >= limits[0] => Some(true),
            dimension if dimension >= limits[1] => None,
            _ => Some(false),
        },
    };
    let mut warnings = asked.motion.warnings.clone();
    let components: Vec<LocusComponent> = work.answer.modes.iter().map(component).collect();
    for whole in components.iter().filter(|c| c.is_whole_mode == Some(true)) {
        warnings.push(whole_mode_warning(whole));
    }
    for maybe in components.iter().filter(|c| c.is_whole_mode.is_none()) {
        work.doubt(format!(
            "whether component {} is a whole mode of the motion is not clear; see cognate mechanism motion",
            maybe.id
        ));
    }
    let answer = LocusAnswer {
        degree_in: asked.motion.degree_in,
        components,
        isolated: work.answer.isolated,
        positions: positions(&work, &asked, &kind),
        curves,
        removed: std::mem::take(&mut work.answer.removed),
        doubts: std::mem::take(&mut work.answer.doubts),
        warnings,
        kind,
    };
    print(a, &read, &answer)
}

/// Doubts an answer for the output where loops lose rank, as where modes meet: there something more can begin to move, and the
/// output need not have lost a direction.
fn doubt_meetings(work: &mut Work<'_>, asked: &Asked, closing: usize) {
    let sets = work.set.components.iter().map(|component| &component.set);
    let meetings = sets.filter(|set| !is_regular(asked, closing, &set.points[0]));
    let meetings = meetings.count();
    if meetings > 0 {
        work.doubt(format!(
            "in {} the loops lose rank, as where modes meet: whether the output is singular there is not clear; ask with --at FILE",
            counted(meetings as u64, "position or component")
        ));
    }
}

/// Whether the equations of the motion clearly have full rank at a solution, by differences.
fn is_regular(asked: &Asked, closing: usize, point: &[Complex64]) -> bool {
    let system = asked.system();
    let equations = &system.equations[..closing];
    let size = point.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
    let step = DIFFERENCE * size.sqrt();
    let derivatives = (0..point.len()).map(|k| {
        let moved = |by: f64| {
            let mut point = point.to_vec();
            point[k] += by;
            evaluation::values(&system.expressions, equations, &point, &[])
        };
        let pairs = std::iter::zip(moved(step), moved(-step));
        pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect()
    });
    // The rank of the transposed matrix is the same.
    let rows: Vec<Vec<Complex64>> = derivatives.collect();
    let values = singular_values(&rows, closing);
    match (values.first(), values.get(closing.wrapping_sub(1))) {
        (Some(largest), Some(smallest)) => *smallest > REGULAR * largest,
        _ => closing == 0,
    }
}

/// Positions that are alone: real ones first, in the order of the inputs.
fn positions(work: &Work<'_>, asked: &Asked, kind: &SingularKind) -> Vec<SingularPosition> {
    let alone = work.set.components.iter().map(|component| &component.set);
    let alone = alone.filter(|set| set.dimension() == 0);
    let position = |point: &Vec<_>| {
        let is_real = asked.is_real(point);
        SingularPosition {
            is_real,
            placed: match is_real {
                Some(true) => asked.placed(point),
                _ => None,
            },
        }
    };
    let mut positions: Vec<SingularPosition> = alone.map(|set| position(&set.points[0])).collect();
    let place = |position: &SingularPosition| -> Vec<f64> {
        let Some(Placed::Joints(values)) = &position.placed else {
            return Vec::new();
        };
        let first = values.iter().filter(|(name, _)| kind.is_input(name));
        let others = values.iter().filter(|(name, _)| !kind.is_input(name));
        first.chain(others).map(|(_, value)| value.real()).collect()
    };
    positions.sort_by(|a, b| {
        let is_not_real = |position: &SingularPosition| position.is_real != Some(true);
        let order = is_not_real(a).cmp(&is_not_real(b));
        let pairs = std::iter::zip(place(a), place(b));
        let by_value = pairs.map(|(x, y)| x.total_cmp(&y));
        order.then(by_value.fold(std::cmp::Ordering::Equal, |order, next| order.then(next)))
    });
    positions
}

/// Real points of curves in the plane of the output; `None` where the locus is no such curve.
async fn drawn(work: &mut Work<'_>, asked: &Asked) -> Result<Option<Vec<DrawnCurve>>, ClientError> {
    if work.answer.modes.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let is_plane = asked.motion.degree_in == DegreeIn::Pose && work.set.system.variables.len() == 2;
    if !is_plane || work.answer.modes.iter().any(|mode| mode.dimension != 1) {
        return Ok(None);
    }
    let wish = CurveWish {
        samples: SAMPLES,
        ..CurveWish::default()
    };
    let set = work.only(&work.components);
    let question = Question::RealCurve(wish);
    let Some(QuestionAnswer::RealCurve(answer)) = work.ask(&set, question).await? else {
        return Ok(None);
    };
    let mut curves = Vec::new();
    for (counts, curve) in answer.components.iter().zip(&answer.curves) {
        let place = work.mode_of(&counts.id).filter(|_| counts.settled);
        let Some(place) = place else {
            work.doubt("the real points of a curve of singular positions are not clear");
            return Ok(None);
        };
        curves.push(DrawnCurve {
            id: work.answer.modes[place].id.clone(),
            degree: work.answer.modes[place].degree,
            samples: samples(curve),
        });
    }
    Ok(Some(curves))
}

/// The points of a plane curve's arcs, one arc after the other.
fn samples(curve: &CurveBlock) -> Vec<[f64; 2]> {
    let points = curve.edges.iter().flat_map(|arc| &arc.samples);
    points.map(|point| [point[0].re, point[1].re]).collect()
}
