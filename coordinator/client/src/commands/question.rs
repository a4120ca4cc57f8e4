//! `cognate member`, `sample`, `project`, `multidegree`, `mobility`, `real-curve`, `real-surface`, `real-points`,
//! `singular-locus` and `certify`: questions to components that were found before. Each is a job, of a coordinator of
//! its own or of a running one.

use crate::commands::solve;
use crate::common_arguments::{OutputArguments, PresetName};
use crate::connection::{Connection, Target};
use crate::error::{ClientError, Exit};
use crate::output::axes::{self, AxisOf};
use crate::output::text::counted;
use crate::problem::Prepared;
use crate::sets::arguments::{
    Member, Mobility, Plain, Project, Ranges, RealCurve, RealSurface, Sample, SetArguments,
};
use crate::sets::{KnownSet, points};
use cognate_continuation::tracker::settings::Preset;
use cognate_protocol::submission::{Asked, Options, SettingsChoice, Source, Submission};
use cognate_solutions::witness::question::{CurveWish, SampleWish};
use cognate_solutions::witness::{ComponentId, Question};
use cognate_systems::system::System;
use cognate_systems::transform::join;
use std::path::Path;

/// On which components points lie.
pub async fn member(a: &Member) -> Result<Exit, ClientError> {
    ask(&a.set, |set| {
        let points = points::read(&a.points, &set.system.variables, a.accuracy)?;
        Ok(Question::Member { points })
    })
    .await
}

/// Points of components.
pub async fn sample(a: &Sample) -> Result<Exit, ClientError> {
    ask(&a.set, |set| {
        let variables = &set.system.variables;
        let near = match &a.near {
            None => None,
            Some(path) => match points::read(path, variables, None)?.as_slice() {
                [one] => Some(one.clone()),
                several => {
                    let message = format!("holds {} points; expected one", several.len());
                    return Err(wrong("--near", &message));
                }
            },
        };
        Ok(Question::Sample(SampleWish {
            count: a.count,
            near,
            real: a.real,
            within: ranges_of(a.within.as_ref(), variables)?,
        }))
    })
    .await
}

/// A range for each variable: one is for all of them.
fn ranges_of(given: Option<&Ranges>, variables: &[String]) -> Result<Vec<[f64; 2]>, ClientError> {
    let ranges = match given {
        None => return Ok(Vec::new()),
        Some(Ranges(ranges)) if ranges.len() == 1 => vec![ranges[0]; variables.len()],
        Some(Ranges(ranges)) => ranges.clone(),
    };
    if ranges.len() != variables.len() {
        let message = format!(
            "{}; expected one, or {}: one for each of {}",
            counted(ranges.len() as u64, "range"),
            variables.len(),
            variables.join(", ")
        );
        return Err(wrong("--box", &message));
    }
    Ok(ranges)
}

/// Images of components.
pub async fn project(a: &Project) -> Result<Exit, ClientError> {
    ask(&a.set, |set| {
        let variables = &set.system.variables;
        let place = |name: &String| place_of(name, variables, "--onto");
        let onto = a.onto.iter().map(place).collect::<Result<_, _>>()?;
        Ok(Question::Project { onto })
    })
    .await
}

/// The place of a variable that an option names.
fn place_of(name: &str, variables: &[String], option: &str) -> Result<u32, ClientError> {
    let place = variables.iter().position(|v| v == name.trim());
    place.map(|place| place as u32).ok_or_else(|| {
        let message = format!("`{name}`; expected some of {}", variables.join(", "));
        wrong(option, &message)
    })
}

/// Degrees of components by groups of variables.
pub async fn multidegree(a: &Plain) -> Result<Exit, ClientError> {
    ask(&a.set, |_| Ok(Question::Multidegree)).await
}

/// Which witness points are proved.
pub async fn certify(a: &Plain) -> Result<Exit, ClientError> {
    ask(&a.set, |_| Ok(Question::Certify)).await
}

/// Where the equations lose rank.
pub async fn singular_locus(a: &Plain) -> Result<Exit, ClientError> {
    ask(&a.set, |_| Ok(Question::SingularLocus)).await
}

/// Real points of components.
pub async fn real_points(a: &Plain) -> Result<Exit, ClientError> {
    ask(&a.set, |_| Ok(Question::RealPoints)).await
}

/// The real part of surfaces.
pub async fn real_surface(a: &RealSurface) -> Result<Exit, ClientError> {
    let samples = a.samples;
    let question = Question::RealSurface { samples };
    ask_dimension(&a.set, &SURFACES, |_| Ok((question, Vec::new()))).await
}

/// How points can be moved.
pub async fn mobility(a: &Mobility) -> Result<Exit, ClientError> {
    ask(&a.set, |set| {
        let points = points::read(&a.points, &set.system.variables, a.accuracy)?;
        let depth = a.depth;
        Ok(Question::Mobility { points, depth })
    })
    .await
}

/// The real part of curves.
pub async fn real_curve(a: &RealCurve) -> Result<Exit, ClientError> {
    let samples = a.samples;
    ask_dimension(&a.set, &CURVES, |set| {
        let axes = axes::axes(&set.system, &a.axes).map_err(|e| wrong("--axes", &e))?;
        let variables = &set.system.variables;
        let projection = a.projection.as_ref();
        let projection = projection.map(|name| place_of(name, variables, "--projection"));
        let wish = CurveWish {
            samples,
            projection: projection.transpose()?,
            tolerance: a.tolerance,
            within: ranges_of(a.within.as_ref(), variables)?,
            certify: a.certify,
        };
        Ok((Question::RealCurve(wish), axes))
    })
    .await
}

/// Components of which a picture is made.
struct Drawn {
    dimension: u32,
    /// Noun for one of the components, singular.
    name: &'static str,
    /// Hint to the command for components of another dimension.
    others: &'static str,
}

const CURVES: Drawn = Drawn {
    dimension: 1,
    name: "curve",
    others: "`cognate real-points` finds real points of components of every dimension",
};

const SURFACES: Drawn = Drawn {
    dimension: 2,
    name: "surface",
    others: "`cognate real-curve` draws curves",
};

/// Reads and checks the components, asks, and shows the answer.
async fn ask(
    a: &SetArguments,
    question: impl Fn(&KnownSet) -> Result<Question, ClientError>,
) -> Result<Exit, ClientError> {
    let running = a.service.running()?;
    let set = read(&a.set, &a.components, running.as_ref()).await?;
    let prepared = prepared(a.preset, &set, question(&set)?)?;
    send(a, running.as_ref(), prepared).await
}

/// Asks about the components of one dimension; a question comes with the axes of its drawing, if there is one. Components
/// of other dimensions are left out, with their names in a message, unless they were asked by name.
async fn ask_dimension(
    a: &SetArguments,
    drawn: &Drawn,
    question: impl FnOnce(&KnownSet) -> Result<(Question, Vec<AxisOf>), ClientError>,
) -> Result<Exit, ClientError> {
    let running = a.service.running()?;
    let mut set = read(&a.set, &a.components, running.as_ref()).await?;
    let others = match a.components.is_empty() {
        true => set.leave_other_dimensions(drawn.dimension),
        false => Vec::new(),
    };
    let named = || {
        let named = others
            .iter()
            .map(|id| format!("{id} (dimension {})", id.dimension));
        named.collect::<Vec<String>>().join(", ")
    };
    if set.components.is_empty() {
        let message = format!("holds no {}, but {}; {}", drawn.name, named(), drawn.others);
        return Err(wrong(&a.set.display().to_string(), &message));
    }
    let (question, axes) = question(&set)?;
    let mut prepared = prepared(a.preset, &set, question)?;
    if !others.is_empty() {
        let warning = format!(
            "left out, being no {}: {}; {}",
            drawn.name,
            named(),
            drawn.others
        );
        prepared.submission.options.warnings.push(warning);
    }
    let output = OutputArguments { axes, ..a.output() };
    solve::anywhere(&a.service, running.as_ref(), &output, &a.progress, prepared).await
}

/// Components, chosen and checked, of files or of a job of the coordinator that was named.
pub(super) async fn read(
    path: &Path,
    chosen: &[ComponentId],
    running: Option<&Target>,
) -> Result<KnownSet, ClientError> {
    let mut set = match running {
        Some(target) if !path.exists() => {
            let mut connection = Connection::open(target).await?;
            KnownSet::of_job(&mut connection, &path.display().to_string()).await?
        }
        _ => KnownSet::read(path)?,
    };
    set.choose(chosen)?;
    set.check()?;
    Ok(set)
}

/// Has the question answered, and shows the answer.
pub(super) async fn send(
    a: &SetArguments,
    running: Option<&Target>,
    prepared: Prepared,
) -> Result<Exit, ClientError> {
    let output = a.output();
    solve::anywhere(&a.service, running, &output, &a.progress, prepared).await
}

pub(super) fn prepared(
    preset: PresetName,
    set: &KnownSet,
    question: Question,
) -> Result<Prepared, ClientError> {
    let options = Options {
        seed: Some(set.seed),
        settings: SettingsChoice {
            preset: Some(Preset::from(preset)),
            ..SettingsChoice::default()
        },
        name: set.name.chars().take(60).collect(),
        question: Some(Asked {
            components: set.sets(),
            question,
        }),
        ..Options::default()
    };
    options
        .check()
        .map_err(|misfit| wrong("options", &misfit.to_string()))?;
    Ok(Prepared::new(
        Submission {
            source: Source::System(Box::new(set.system.clone())),
            options,
        },
        set.name.clone(),
    ))
}

/// The system of a set with the equations of a file, in the same variables.
pub(super) fn joined(
    first: &KnownSet,
    path: &Path,
    second: &System,
) -> Result<System, ClientError> {
    join(&first.system, second)
        .map_err(|error| wrong(&path.display().to_string(), &error.to_string()))
}

fn wrong(origin: &str, message: &str) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}
