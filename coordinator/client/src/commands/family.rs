//! A family at many values of its parameters: one decomposition at general values, from which components are followed
//! to all others.

use super::general_values::{general_values, sizes};
use super::sequence::{Sequence, Working, served};
use crate::arguments::{AnswerFormat, Decompose};
use crate::connection::Target;
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::family::{Member, Sweep};
use crate::problem::Prepared;
use crate::sets::KnownSet;
use cognate_protocol::submission::Source;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::KnownComponents;
use cognate_summary::decomposition::DecompositionSummary;
use num_complex::Complex64;
use std::path::Path;

/// Seed of everything random where none is given.
const SEED: u64 = 1;

/// Decomposes at general values, then at all that were given, prints, stops everything that it started.
pub async fn run(
    a: &Decompose,
    running: Option<Target>,
    prepared: Prepared,
) -> Result<Exit, ClientError> {
    if matches!(a.format, AnswerFormat::Jsonl | AnswerFormat::Csv) {
        return Err(ClientError::Input {
            origin: "--format".into(),
            message: "jsonl and csv are of one set of parameters; several have table and json"
                .into(),
        });
    }
    let shown = (a.progress.progress, a.format == AnswerFormat::Json);
    let work = |jobs| -> Working<'_> { Box::pin(sweep(a, jobs, prepared)) };
    served(&a.service, shown, running, Box::new(work)).await
}

async fn sweep(a: &Decompose, jobs: Sequence, mut prepared: Prepared) -> Result<Exit, ClientError> {
    let options = &mut prepared.submission.options;
    let seed = *options.seed.get_or_insert(SEED);
    let values = std::mem::take(&mut options.target_parameters);
    let general = general_values(&sizes(&values), seed);
    let names = match &prepared.submission.source {
        Source::System(system) => system.parameters.clone(),
        Source::Text { .. } => Vec::new(),
    };
    let folder = a.output.as_deref();
    let ask = Asking {
        a,
        jobs,
        prepared: &prepared,
    };
    ask.jobs
        .say("decomposing at general values of the parameters");
    let at = folder.map(|folder| folder.join("general"));
    let (first, set) = ask.decompose(&general, None, at.as_deref()).await?;
    let general_components = known(&ask, &first, &set, &general);
    let mut sweep = Sweep {
        name: prepared.name.clone(),
        parameters: names,
        general: Member::new(general, first),
        members: Vec::with_capacity(values.len()),
    };
    for (k, values) in values.iter().enumerate() {
        let at = folder.map(|folder| folder.join(format!("{:04}", k + 1)));
        let (summary, _) = ask
            .decompose(values, general_components.as_ref(), at.as_deref())
            .await?;
        sweep.members.push(Member::new(values.clone(), summary));
    }
    let text = match a.format {
        AnswerFormat::Table => sweep.table(folder),
        _ => sweep.json(),
    };
    if let Some(folder) = folder {
        output::files::write_file(folder, "sweep.json", &sweep.json())?;
    }
    output::print(&text)?;
    Ok(sweep.exit())
}

/// The components at general values, where they are a base for others.
fn known(
    ask: &Asking<'_>,
    first: &DecompositionSummary,
    set: &KnownSet,
    general: &[Complex64],
) -> Option<KnownComponents> {
    let lowest = first.decomposition.by_dimension.first_key_value();
    let whole = lowest.is_some_and(|(_, d)| d.complete == Completeness::Yes);
    if !whole || ask.a.components.dimension.is_some() {
        ask.jobs
            .say("no base for other values: the lowest dimension was not asked or is not settled");
        return None;
    }
    let Source::System(system) = &ask.prepared.submission.source else {
        return None;
    };
    Some(KnownComponents {
        equations: u32::try_from(system.equations.len()).ok()?,
        components: set.sets(),
        parameters: general.to_vec(),
    })
}

/// Data that all jobs of a sweep share.
struct Asking<'a> {
    a: &'a Decompose,
    jobs: Sequence,
    prepared: &'a Prepared,
}

impl Asking<'_> {
    /// The family at these values.
    async fn decompose(
        &self,
        values: &[Complex64],
        general_components: Option<&KnownComponents>,
        folder: Option<&Path>,
    ) -> Result<(DecompositionSummary, KnownSet), ClientError> {
        let mut prepared = self.prepared.clone();
        let options = &mut prepared.submission.options;
        options.target_parameters = vec![values.to_vec()];
        if let Some(wanted) = &mut options.decompose {
            wanted.known = general_components.cloned();
        }
        self.jobs.decompose(prepared, folder).await
    }
}
