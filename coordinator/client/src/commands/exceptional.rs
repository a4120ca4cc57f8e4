//! `cognate exceptional`: values of a family's parameters over which its solutions have at least a given dimension, by fibre
//! products (Sommese, Wampler: Exceptional sets and fiber products, Found. Comput. Math. 8, 2008).
//!
//! Copies of the variables over common parameters, each on a general linear space of that codimension: over an exceptional
//! set every copy has points, elsewhere each further copy lowers the dimension of what is left by 1 or more. A component
//! whose image is larger than what could be left is therefore of an exceptional set.

use super::question;
use super::sequence::{Sequence, Working, served};
use crate::arguments::AnswerFormat;
use crate::error::{ClientError, Exit};
use crate::output::exceptional::{Exceptional, Level, Set};
use crate::output::text::Look;
use crate::output::{files, objects, text};
use crate::problem::{self, Prepared};
use crate::sets::KnownSet;
use crate::sets::arguments;
use cognate_continuation::tracker::settings::Preset;
use cognate_protocol::submission::{Decompose, Options, SettingsChoice, Source, Submission};
use cognate_solutions::witness::Question;
use cognate_summary::question_answer::{ProjectBlock, QuestionAnswer};
use cognate_systems::system::System;
use cognate_systems::transform::fibre_product;

/// Finds them, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &arguments::Exceptional) -> Result<Exit, ClientError> {
    let running = a.service.running()?;
    let family = problem::read_equations_of(&a.system)?;
    check(a, &family)?;
    let shown = (a.progress.progress, a.format != AnswerFormat::Table);
    let work = |jobs| -> Working<'_> { Box::pin(search(a, jobs, family)) };
    served(&a.service, shown, running, Box::new(work)).await
}

/// Whether the file holds a family of which this can be asked.
fn check(a: &arguments::Exceptional, family: &System) -> Result<(), ClientError> {
    let origin = problem::source_name(&a.system);
    if family.parameters.is_empty() {
        return Err(wrong(&origin, "has no parameters; expected a family"));
    }
    if family.path_variable.is_some() {
        return Err(wrong(&origin, "is a homotopy; expected a family"));
    }
    if family.groups.iter().any(|group| group.homogeneous) {
        return Err(wrong(
            &origin,
            "homogeneous groups are not in this version; expected affine variables",
        ));
    }
    let (wanted, most) = (a.fibre_dimension, family.variables.len());
    if wanted as usize > most {
        let message = format!("{wanted}; the family has {most} variables");
        return Err(wrong("--fibre-dimension", &message));
    }
    let most = family.parameters.len() + 1;
    if a.copies as usize > most {
        let message = format!("{}; {most} are always enough here", a.copies);
        return Err(wrong("--copies", &message));
    }
    let product = fibre_product(family, a.copies as usize, wanted as usize, a.seed);
    let checked = product.check();
    checked.map_err(|error| wrong(&origin, &format!("as a system in its parameters: {error}")))
}

/// Products with more and more copies, until every component is of an exceptional set.
async fn search(
    a: &arguments::Exceptional,
    jobs: Sequence,
    family: System,
) -> Result<Exit, ClientError> {
    let parameters = family.parameters.len() as i64;
    let mut exceptional = Exceptional {
        name: problem::source_name(&a.system),
        fibre_dimension: a.fibre_dimension,
        parameters: family.parameters.clone(),
        sets: Vec::new(),
        levels: Vec::new(),
        doubts: Vec::new(),
    };
    // Largest dimension of an image that may be no exceptional set.
    let mut most = parameters - i64::from(a.copies);
    for copies in a.copies.. {
        let level = product(a, &jobs, &family, copies, &mut exceptional).await?;
        let left = level.images.iter().copied().filter(|image| *image <= most);
        let left = left.max().unwrap_or(-1);
        exceptional.levels.push(Level {
            not_known: left,
            ..level
        });
        let level = &exceptional.levels[exceptional.levels.len() - 1];
        most = match exceptional.doubts.is_empty() {
            true if left < 0 => break,
            true => left - 1,
            false => most - 1,
        };
        if most < -1 {
            break;
        }
        jobs.say(&format!(
            "product {copies}: {}, not all of exceptional sets for sure",
            text::counted(level.images.len() as u64, "component")
        ));
    }
    if let Some(folder) = &a.output {
        files::write_file(folder, "exceptional.json", &exceptional.json())?;
    }
    if matches!(a.format, AnswerFormat::Csv | AnswerFormat::Jsonl) {
        exceptional.beside_rows(Look::of_standard_error()).print();
    }
    objects::print(
        a.format,
        &["/exceptional/sets"],
        || exceptional.table(),
        || exceptional.json(),
    )?;
    Ok(exceptional.exit())
}

/// Decomposes the product with this number of copies: its components and their images. Earlier sets and doubts are
/// replaced by those of this product.
async fn product(
    a: &arguments::Exceptional,
    jobs: &Sequence,
    family: &System,
    copies: u32,
    exceptional: &mut Exceptional,
) -> Result<Level, ClientError> {
    let system = fibre_product(family, copies as usize, a.fibre_dimension as usize, a.seed);
    let folder = a.output.as_ref();
    let folder = folder.map(|folder| folder.join(format!("copies_{copies}")));
    let prepared = decomposition(a, &exceptional.name, system);
    let (summary, set) = jobs.decompose(prepared, folder.as_deref()).await?;
    exceptional
        .doubts
        .clone_from(&summary.decomposition.unsettled);
    if !summary.settled && exceptional.doubts.is_empty() {
        exceptional
            .doubts
            .push("a decomposition is not settled".into());
    }
    exceptional.sets.clear();
    let mut level = Level {
        copies,
        variables: summary.problem.variables,
        paths: summary.paths.superset.total,
        images: Vec::new(),
        not_known: -1,
    };
    if set.components.is_empty() || !exceptional.doubts.is_empty() {
        return Ok(level);
    }
    let onto = (0..exceptional.parameters.len() as u32).collect();
    let asked = question::prepared(a.preset, &set, Question::Project { onto })?;
    let answer = jobs.question(asked).await?;
    let QuestionAnswer::Project(images) = answer.answer else {
        return Err(ClientError::GaveUp("its answer is no projection".into()));
    };
    exceptional.doubts = answer.unsettled;
    level.paths += answer.paths.total;
    for image in images.components {
        level.images.push(image.dimension.map_or(-1, i64::from));
        add(exceptional, image, &set);
    }
    exceptional.divide_fibres(copies);
    Ok(level)
}

/// Adds a component to the set that is its image.
fn add(exceptional: &mut Exceptional, image: ProjectBlock, set: &KnownSet) {
    let fibre_dimension = u64::from(image.fiber_dimension.unwrap_or(0));
    let mut sets = exceptional.sets.iter_mut();
    if let Some(same_image_set) = sets.find(|s| s.components.first() == image.same_image.as_ref()) {
        same_image_set.components.push(image.id);
        same_image_set.fibre_dimension = same_image_set.fibre_dimension.max(fibre_dimension);
        return;
    }
    let mut components = set.components.iter();
    let component = components.find(|component| component.set.id.to_string() == image.id);
    let point = component.and_then(|component| component.set.points.first());
    exceptional.sets.push(Set {
        dimension: image.dimension.unwrap_or(0).into(),
        degree: image.degree,
        fibre_dimension,
        components: vec![image.id],
        point: point.map_or_else(Vec::new, |p| p[..exceptional.parameters.len()].to_vec()),
    });
}

/// A product that is to be decomposed.
fn decomposition(a: &arguments::Exceptional, name: &str, system: System) -> Prepared {
    let options = Options {
        seed: Some(a.seed),
        settings: SettingsChoice {
            preset: Some(Preset::from(a.preset)),
            ..SettingsChoice::default()
        },
        name: name.chars().take(60).collect(),
        decompose: Some(Decompose::default()),
        ..Options::default()
    };
    Prepared::new(
        Submission {
            source: Source::System(Box::new(system)),
            options,
        },
        name.to_owned(),
    )
}

fn wrong(origin: &str, message: &str) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}
