//! `cognate mechanism motion`: all configurations of a mechanism, decomposed into the modes of its motion.
//!
//! Equations of all configurations are one decomposition; what its components have in common, their real parts and the
//! degrees of paths are questions to it. All are jobs of one coordinator.

mod circuits;
mod meetings;
mod paths;
mod reduced;
mod sweep;
mod walks;

use super::read::{Read, described, refuse_locks, wrong};
use crate::commands::question;
use crate::commands::sequence::{Sequence, Working, served};
use crate::common_arguments::{AnswerFormat, PresetName};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismMotion;
use crate::mechanism::motion_answer::{Isolated, Mode, MotionAnswer};
use crate::output::mechanisms::motion as shown;
use crate::output::objects;
use crate::output::text::Look;
use crate::problem::Prepared;
use crate::sets::KnownSet;
use cognate_continuation::tracker::settings::Preset;
use cognate_kinematics::compile::motion::{DegreeIn, Motion, Placed, TracedPoint, motion};
use cognate_kinematics::compile::text::Equations;
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::mechanism::{Mechanism, MechanismError};
use cognate_kinematics::polygon::connected_parts;
use cognate_protocol::submission::{Decompose, Options, SettingsChoice, Source, Submission};
use cognate_solutions::point_shape::modulus;
use cognate_solutions::witness::question::GivenPoint;
use cognate_solutions::witness::{ComponentId, Method, Question};
use cognate_summary::decomposition::DecompositionSummary;
use cognate_summary::question_answer::QuestionAnswer;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Largest distance of a point and its conjugate, relative to the point's size, at which they are one point.
const REAL: f64 = 1e-6;
/// Smallest distance of a point and its conjugate, relative to the point's size, at which they are two points.
const NOT_REAL: f64 = 1e-4;
/// Names of the coordinates of the traced point among the unknowns.
const TRACED: [&str; 2] = ["path_x", "path_y"];

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &MechanismMotion) -> Result<Exit, ClientError> {
    refuse_locks(&a.mechanism)?;
    let running = a.service.running()?;
    let shown = (a.progress.progress, a.format != AnswerFormat::Table);
    if let Some(values) = &a.sweep {
        let members = sweep::members(a, values)?;
        let work = |jobs| -> Working<'_> { Box::pin(sweep::answers(a, jobs, members)) };
        return served(&a.service, shown, running, Box::new(work)).await;
    }
    let read = Read::of(&a.mechanism)?;
    let asked = Asked::of(&read.mechanism, a.path.as_deref())?;
    let work = |jobs| -> Working<'_> { Box::pin(one(a, jobs, read, asked)) };
    served(&a.service, shown, running, Box::new(work)).await
}

/// The answer for one mechanism.
async fn one(
    a: &MechanismMotion,
    jobs: Sequence,
    read: Read,
    asked: Asked,
) -> Result<Exit, ClientError> {
    for warning in asked.motion.warnings.iter().chain(&read.mechanism.warnings) {
        eprintln!("warning: {warning}");
    }
    let answer = answered(a, &jobs, &read.mechanism, &asked).await?;
    for doubt in &answer.doubts {
        eprintln!("warning: {doubt}");
    }
    let view = shown::MotionView {
        mechanism: &read.mechanism,
        content: &read.content,
        degrees: read.degrees(&a.mechanism),
    };
    objects::print(
        a.format,
        &["/components"],
        || shown::table(&view, &answer, Look::of_standard_output()),
        || shown::json(&view, &answer),
    )?;
    Ok(Exit::of_settled(answer.is_settled()))
}

/// The system of a mechanism's motion.
pub(super) struct Asked {
    pub(super) motion: Motion,
    /// The equations that are decomposed: those of the motion, and the traced point where it is linear in the unknowns.
    equations: Equations,
    system: System,
    /// Whether unknowns of the decomposition are the traced point's coordinates.
    traces: bool,
    /// For each unknown, the number of the unknown that is its conjugate at a real configuration.
    partners: Vec<usize>,
    /// The configuration of the file.
    home: Option<Vec<Complex64>>,
    /// Number of connected parts of all real configurations, where lengths alone tell it.
    connected_parts: Option<u64>,
}

impl Asked {
    /// The motion of a mechanism, and the path of the point that is named.
    fn of(mechanism: &Mechanism, path: Option<&str>) -> Result<Self, ClientError> {
        let traced = path.map(|text| traced_point(mechanism, text)).transpose()?;
        let motion = motion(mechanism, traced.as_ref()).map_err(|e| described(&e))?;
        Self::of_equations(mechanism, motion, traced.as_ref())
    }

    /// Equations whose unknowns are those of a motion, and the path of a point.
    pub(super) fn of_equations(
        mechanism: &Mechanism,
        motion: Motion,
        traced: Option<&TracedPoint>,
    ) -> Result<Self, ClientError> {
        let mut equations = motion.equations.clone();
        let linear = motion.path.as_ref().filter(|path| path.is_linear);
        if let Some(path) = linear {
            let [x, y] = TRACED.map(String::from);
            equations.conjugates.push((x.clone(), y.clone()));
            equations.groups.resize(2, Vec::new());
            for (k, name) in [x, y].into_iter().enumerate() {
                let coordinate = &path.coordinates[k];
                equations.equations.push(format!("{name}-{coordinate}"));
                equations.groups[k].push(name);
            }
        }
        let system = equations
            .system(&mechanism.file)
            .map_err(|e: MechanismError| described(&e))?;
        let place = |name: &str| system.variables.iter().position(|v| v == name);
        let mut partners: Vec<usize> = (0..system.variables.len()).collect();
        for (first, second) in &equations.conjugates {
            if let (Some(first), Some(second)) = (place(first), place(second)) {
                partners[first] = second;
                partners[second] = first;
            }
        }
        let mut asked = Self {
            traces: linear.is_some(),
            home: None,
            connected_parts: connected_parts(mechanism),
            motion,
            equations,
            system,
            partners,
        };
        asked.home = asked.home_of(traced);
        Ok(asked)
    }

    /// The equations that are decomposed, as a system.
    pub(super) fn system(&self) -> &System {
        &self.system
    }

    /// The configuration of the file in the unknowns of the decomposition.
    fn home_of(&self, traced: Option<&TracedPoint>) -> Option<Vec<Complex64>> {
        let values = self.motion.home.as_ref()?;
        let mut values = values.iter();
        let at = |name: &String| match (TRACED.iter().position(|t| t == name), traced) {
            // At home the frames of all links are the ground's.
            (Some(k), Some(traced)) => {
                let [x, y] = [0, 1].map(|i| traced.point[i].to_f64());
                Some(Complex64::new(x, if k == 0 { y } else { -y }))
            }
            _ => values.next().map(|x| Complex64::from(*x)),
        };
        self.system.variables.iter().map(at).collect()
    }

    /// The configuration that a solution is; `None` where it is none.
    pub(super) fn placed(&self, point: &[Complex64]) -> Option<Placed> {
        let names = self.system.variables.iter().zip(point);
        let position_coordinates = names.filter(|(name, _)| !TRACED.contains(&name.as_str()));
        let position_coordinates: Vec<Complex64> =
            position_coordinates.map(|(_, value)| *value).collect();
        self.motion.placed(&position_coordinates)
    }

    /// Whether a solution is real; `None` where that is in doubt.
    pub(super) fn is_real(&self, point: &[Complex64]) -> Option<bool> {
        let sizes = |a: &&Complex64, b: &&Complex64| modulus(**a).total_cmp(&modulus(**b));
        let largest = point.iter().max_by(sizes)?;
        let scale = match self.equations.homogeneous {
            true => Complex64::new(1.0, 0.0) / largest,
            false => Complex64::new(1.0 / modulus(*largest).max(1.0), 0.0),
        };
        let scaled: Vec<Complex64> = point.iter().map(|z| z * scale).collect();
        let partner = |k: usize| scaled[self.partners[k]].conj();
        let gaps = scaled
            .iter()
            .enumerate()
            .map(|(k, z)| modulus(z - partner(k)));
        match gaps.fold(0.0, f64::max) {
            gap if gap <= REAL => Some(true),
            gap if gap >= NOT_REAL => Some(false),
            _ => None,
        }
    }
}

/// The point that `--path` names.
fn traced_point(mechanism: &Mechanism, text: &str) -> Result<TracedPoint, ClientError> {
    if text.trim() == "output" {
        let output = mechanism.output.as_ref().ok_or_else(|| {
            let message =
                "output: the file names none; type the link and a point of it, \"LINK x y\"";
            wrong("--path", message)
        })?;
        return Ok(TracedPoint::of_output(output));
    }
    let words: Vec<&str> = text.split([' ', ',']).filter(|w| !w.is_empty()).collect();
    let expected = || {
        let message = format!("expected output or \"LINK x y [z]\", found \"{text}\"");
        wrong("--path", message)
    };
    let (link, numbers) = words.split_first().ok_or_else(expected)?;
    let mut point = [0, 0, 0].map(Number::integer);
    if numbers.len() < 2 || numbers.len() > 3 {
        return Err(expected());
    }
    for (place, word) in point.iter_mut().zip(numbers) {
        *place = Number::read(word).ok_or_else(expected)?;
    }
    Ok(TracedPoint {
        link: (*link).to_owned(),
        point,
    })
}

/// Decomposes and asks.
async fn answered(
    a: &MechanismMotion,
    jobs: &Sequence,
    mechanism: &Mechanism,
    asked: &Asked,
) -> Result<MotionAnswer, ClientError> {
    let wishes = Wishes {
        seed: a.seed,
        preset: a.preset,
        asks_real: a.real,
        asks_path: a.path.is_some(),
    };
    let mut work = decomposed(wishes, jobs, mechanism, asked).await?;
    work.doubt_multiplicities();
    if !work.answer.modes.is_empty() {
        work.find_home().await?;
        work.find_meetings().await?;
        if a.real {
            work.find_circuits().await?;
        }
        if a.path.is_some() {
            work.find_path_degrees().await?;
        }
    }
    if a.real && work.answer.modes.is_empty() && work.answer.doubts.is_empty() {
        work.answer.circuits = Some(0);
    }
    work.answer.is_kinematotropic = work.kinematotropic();
    Ok(work.answer)
}

/// Settings of a decomposition, and the questions that are asked of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wishes {
    /// Seed of everything random.
    pub seed: u64,
    /// How cautiously paths are followed.
    pub preset: PresetName,
    /// Whether circuits are asked for.
    pub asks_real: bool,
    /// Whether the degree of a path is.
    pub asks_path: bool,
}

/// A decomposition of which questions are asked.
pub(super) struct Work<'a> {
    wishes: Wishes,
    jobs: &'a Sequence,
    asked: &'a Asked,
    /// The components that are modes and isolated positions.
    pub(super) set: KnownSet,
    /// The component of each mode of the answer.
    pub(super) components: Vec<ComponentId>,
    pub(super) answer: MotionAnswer,
}

/// An answer with the doubts of a decomposition, before its components are modes or isolated positions.
fn answer_without_modes(
    wishes: &Wishes,
    asked: &Asked,
    summary: &DecompositionSummary,
) -> MotionAnswer {
    let mut answer = MotionAnswer {
        degree_in: asked.motion.degree_in,
        modes: Vec::new(),
        isolated: Isolated::default(),
        meetings: Vec::new(),
        is_kinematotropic: None,
        circuits: None,
        asks_real: wishes.asks_real,
        asks_path: wishes.asks_path,
        removed: BTreeMap::new(),
        doubts: summary.decomposition.unsettled.clone(),
        warnings: asked.motion.warnings.clone(),
    };
    if !summary.settled && answer.doubts.is_empty() {
        answer
            .doubts
            .push("the decomposition is not settled".into());
    }
    answer
}

/// The decomposition of the configurations: modes, isolated positions, and components that are no positions.
pub(super) async fn decomposed<'a>(
    wishes: Wishes,
    jobs: &'a Sequence,
    mechanism: &Mechanism,
    asked: &'a Asked,
) -> Result<Work<'a>, ClientError> {
    let prepared = prepared(
        (wishes.seed, wishes.preset),
        &mechanism.name,
        &asked.system,
        asked.motion.degree_in,
    );
    let (summary, mut set) = jobs.decompose(prepared, None).await?;
    let mut answer = answer_without_modes(&wishes, asked, &summary);
    let is_complete = answer.doubts.is_empty();
    let mut components = Vec::new();
    let mut isolated = [0u64; 2];
    let mut real_is_known = true;
    let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
    let mut kept = Vec::new();
    for component in &set.components {
        let set = &component.set;
        let placed = set
            .points
            .iter()
            .filter(|p| asked.placed(p).is_some())
            .count();
        if placed == 0 {
            let each = [u64::from(set.dimension()), set.degree, 1];
            let list: &mut Vec<[u64; 3]> = answer.removed.entry("no pose".into()).or_default();
            match list.iter_mut().find(|other| other[..2] == each[..2]) {
                Some(other) => other[2] += 1,
                None => list.push(each),
            }
            continue;
        }
        if placed < set.points.len() {
            answer
                .doubts
                .push(format!("component {} is in part no pose", set.id));
        }
        kept.push(set.id);
        if set.dimension() == 0 {
            isolated[0] += 1;
            match asked.is_real(&set.points[0]) {
                Some(is_real) => isolated[1] += u64::from(is_real),
                None => real_is_known = false,
            }
            continue;
        }
        let number = numbers.entry(set.dimension()).or_default();
        *number += 1;
        components.push(set.id);
        answer.modes.push(Mode {
            id: format!("{}.{number}", set.dimension()),
            dimension: set.dimension(),
            degree: set.degree,
            multiplicity: set.multiplicity.scheme,
            home: None,
            real: None,
            path_degree: None,
        });
    }
    if is_complete {
        answer.isolated = Isolated {
            complex: Some(isolated[0]),
            real: real_is_known.then_some(isolated[1]),
        };
    }
    if !real_is_known {
        let doubt = "whether an isolated position is real is not clear";
        answer.doubts.push(doubt.into());
    }
    set.components
        .retain(|component| kept.contains(&component.set.id));
    Ok(Work {
        wishes,
        jobs,
        asked,
        set,
        components,
        answer,
    })
}

/// The decomposition of equations of a motion, of a mechanism of this name.
pub(super) fn prepared(
    (seed, preset): (u64, PresetName),
    name: &str,
    system: &System,
    degree_in: DegreeIn,
) -> Prepared {
    let options = Options {
        seed: Some(seed),
        settings: SettingsChoice {
            preset: Some(Preset::from(preset)),
            ..SettingsChoice::default()
        },
        name: name.chars().take(60).collect(),
        decompose: Some(Decompose {
            // Loops have more equations than they need, of which most cut nothing.
            method: (degree_in == DegreeIn::Joints).then_some(Method::Equations),
            ..Decompose::default()
        }),
        ..Options::default()
    };
    Prepared::new(
        Submission {
            source: Source::System(Box::new(system.clone())),
            options,
        },
        name.to_owned(),
    )
}

impl Work<'_> {
    /// The decomposition with these components only.
    pub(super) fn only(&self, chosen: &[ComponentId]) -> KnownSet {
        let mut set = self.set.clone();
        set.components
            .retain(|component| chosen.contains(&component.set.id));
        set
    }

    /// The mode of a component, as answers name it.
    pub(super) fn mode_of(&self, id: &str) -> Option<usize> {
        self.components.iter().position(|c| c.to_string() == id)
    }

    pub(super) fn doubt(&mut self, doubt: impl Into<String>) {
        self.answer.doubts.push(doubt.into());
    }

    fn doubt_multiplicities(&mut self) {
        let modes = self.answer.modes.iter();
        let unknown = modes.filter(|mode| mode.multiplicity.is_none());
        let doubt = |mode: &Mode| format!("the multiplicity of mode {} is not known", mode.id);
        self.answer.doubts.extend(unknown.map(doubt));
    }

    /// Asks the components; `None` where the service refuses the question, which leaves a doubt.
    pub(super) async fn ask(
        &mut self,
        set: &KnownSet,
        question: Question,
    ) -> Result<Option<QuestionAnswer>, ClientError> {
        let prepared = question::prepared(self.wishes.preset, set, question)?;
        match self.jobs.question(prepared).await {
            Ok(answer) => {
                self.answer.doubts.extend(answer.unsettled);
                Ok(Some(answer.answer))
            }
            Err(ClientError::GaveUp(message) | ClientError::Refused(message)) => {
                self.doubt(message);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// On which modes the position of the file is.
    async fn find_home(&mut self) -> Result<(), ClientError> {
        let Some(home) = self.asked.home.clone() else {
            return Ok(());
        };
        let points = vec![GivenPoint {
            values: home,
            accuracy: f64::EPSILON,
        }];
        let set = self.only(&self.components);
        let question = Question::Member { points };
        let Some(QuestionAnswer::Member(answer)) = self.ask(&set, question).await? else {
            return Ok(());
        };
        let Some(point) = answer.points.first() else {
            return Ok(());
        };
        let in_doubt = !point.unsettled.is_empty();
        let modes: Vec<usize> = point.on.iter().filter_map(|id| self.mode_of(id)).collect();
        for (place, mode) in self.answer.modes.iter_mut().enumerate() {
            mode.home = match (modes.contains(&place), in_doubt) {
                (true, _) => Some(true),
                (false, true) => None,
                (false, false) => Some(false),
            };
        }
        Ok(())
    }

    /// Whether modes of different dimensions meet in a real position.
    fn kinematotropic(&self) -> Option<bool> {
        let modes = &self.answer.modes;
        if modes
            .iter()
            .all(|mode| mode.dimension == modes[0].dimension)
        {
            return self.answer.isolated.complex.map(|_| false);
        }
        let dimension = |id: &String| modes.iter().find(|m| m.id == *id).map(|m| m.dimension);
        let differ = |meeting: &&crate::mechanism::motion_answer::Meeting| {
            dimension(&meeting.modes[0]) != dimension(&meeting.modes[1])
        };
        let mut in_doubt = self.answer.isolated.complex.is_none();
        for meeting in self.answer.meetings.iter().filter(differ) {
            let points = meeting.points.as_deref();
            match points {
                Some(points) if points.iter().any(|p| p.is_real == Some(true)) => {
                    return Some(true);
                }
                Some(points) => in_doubt |= points.iter().any(|p| p.is_real.is_none()),
                None => in_doubt = true,
            }
        }
        (!in_doubt).then_some(false)
    }
}
