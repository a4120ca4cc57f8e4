//! From arguments to a submission: files read and checked here, so that mistakes are named before anything starts.

use super::arguments::{ComponentArguments, PresetName, ProblemArguments};
use super::error::ClientError;
use super::objective::{ObjectiveArguments, critical};
use super::other_files;
use super::output::text::counted;
use super::remedy::ONLY_WITH_START;
use super::selection::{SelectionArguments, View};
use super::standard_input;
use super::system_source::SystemSource;
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::settings::{Preset, ROUNDED_TO_DOUBLES};
use cognate_numeric::rational::ComplexRational;
use cognate_protocol::file_settings;
use cognate_protocol::limits::OBJECT_BYTES;
use cognate_protocol::option_misfit::{OptionMisfit, any_of};
use cognate_protocol::submission::{
    Decompose, Options, SettingsChoice, Source, StartKind, StartSolutions, Submission,
};
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::critical::Critical;
use cognate_systems::condition::Conditions;
use cognate_systems::formats::targets::{TargetSource, Targets};
use cognate_systems::formats::{self, DECOMPOSES, FormatError, OtherRun};
use cognate_systems::objective::Objective;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A submission, with warnings for the user.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The submission that is sent to the coordinator.
    pub submission: Submission,
    /// Name of the problem: the file's name.
    pub name: String,
    /// The conditions of the file on the solutions that are wanted.
    pub conditions: Conditions,
    /// The objective of the file, in the graph of the system that is submitted.
    pub objective: Option<Objective>,
    /// The run that the file asks for, where it is not one for isolated solutions.
    pub other_run: Option<OtherRun>,
}

impl Prepared {
    /// A submission that comes from no file with conditions or an objective.
    pub fn new(submission: Submission, name: String) -> Self {
        Self {
            submission,
            name,
            conditions: Conditions::default(),
            objective: None,
            other_run: None,
        }
    }

    /// Whether these are several targets of a family of which no member has been solved, by loops or by the user.
    pub fn is_sweep(&self) -> bool {
        let options = &self.submission.options;
        let is_homotopy = match &self.submission.source {
            Source::System(system) => system.path_variable.is_some(),
            Source::Text { .. } => true,
        };
        options.target_parameters.len() > 1
            && !matches!(options.start, StartKind::Given | StartKind::Monodromy)
            && options.start_solutions.is_none()
            && options.start_parameters.is_empty()
            && options.decompose.is_none()
            && options.question.is_none()
            && !is_homotopy
    }

    /// Refuses a file that asks for another run than one for isolated solutions, or than those of these numbers.
    pub fn refuse_other_run(&self, but: &[i64]) -> Result<(), ClientError> {
        match &self.other_run {
            Some(other) if !but.contains(&other.track_type) => Err(described(&other.refusal)),
            _ => Ok(()),
        }
    }

    /// View of the solutions, as the options and the file ask. An objective puts its critical points in the place of
    /// the solutions.
    pub fn view(
        &mut self,
        selection: &SelectionArguments,
        objective: &ObjectiveArguments,
    ) -> Result<View, ClientError> {
        let Source::System(given) = &self.submission.source else {
            return Ok(View::default());
        };
        // Typed unknowns are not those of the equations where functions of them have helpers.
        let mut given = match given.helpers.is_empty() {
            true => (**given).clone(),
            false => given.typed_system(),
        };
        let parameters = self.submission.options.target_parameters.clone();
        let asked = self.objective.take();
        let Source::System(system) = &mut self.submission.source else {
            return Ok(View::default());
        };
        let mut conditions = selection.conditions(&given, self.conditions.clone())?;
        let critical = critical(system, asked, objective, &mut conditions)?;
        // Critical points are selected before their helpers become what was typed.
        let variables = critical.as_ref();
        let variables = variables.map_or(given.variables.len(), Critical::unknowns);
        if critical.is_some() {
            if self.submission.options.closings.approximate {
                let message = "does not go with an objective, which has least values of its own";
                return Err(wrong("--approximate", message));
            }
            if parameters.len() > 1 {
                let message = "does not go with several sets of parameters in this version";
                return Err(wrong("an objective", message));
            }
            // Points that solve the equations need not be critical.
            given.equations.clear();
        }
        let view = selection.view(&given, variables, conditions, parameters)?;
        Ok(view.with_critical(critical))
    }

    /// Refuses an objective, which only `solve` answers.
    pub fn refuse_objective(&self) -> Result<(), ClientError> {
        match &self.objective {
            None => Ok(()),
            Some(objective) => Err(wrong(
                objective.goal.name(),
                "is answered by `cognate solve`",
            )),
        }
    }

    /// Says that the conditions of the file are not followed, where there are some.
    pub fn leave_conditions(&mut self, instead: &str) {
        if !std::mem::take(&mut self.conditions).is_empty() {
            let warning = format!("the conditions of the file are not followed: {instead}");
            self.submission.options.warnings.push(warning);
        }
    }
}

/// Reads a file, or standard input for `-`; gives a name for messages with it.
pub fn read_file(path: &Path) -> Result<(String, Vec<u8>), ClientError> {
    let failed = |source| ClientError::File {
        action: "cannot read",
        path: path.to_path_buf(),
        source,
    };
    if path.as_os_str() == "-" {
        let content = read_bounded(std::io::stdin().lock()).map_err(failed)?;
        standard_input::keep(&content);
        return Ok((standard_input::NAME.into(), content));
    }
    let file = std::fs::File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.len() > OBJECT_BYTES.value {
        return Err(failed(too_large()));
    }
    let content = read_bounded(file).map_err(failed)?;
    Ok((path.display().to_string(), content))
}

/// Everything that comes, up to the size of the largest object that a service takes: a file may be endless.
fn read_bounded(source: impl Read) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    let read = source
        .take(OBJECT_BYTES.value + 1)
        .read_to_end(&mut content)?;
    match read as u64 > OBJECT_BYTES.value {
        true => Err(too_large()),
        false => Ok(content),
    }
}

fn too_large() -> io::Error {
    let most = OBJECT_BYTES.value;
    let message = format!("it has more than {most} bytes, which no service takes");
    io::Error::new(io::ErrorKind::FileTooLarge, message)
}

/// The name without its folders.
pub fn short_name(path: &Path) -> String {
    if path.as_os_str() == "-" {
        return "standard input".into();
    }
    path.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Reads a system and puts the groups of the command line in the place of its own.
pub fn read_system(path: &Path, groups: Option<&str>) -> Result<formats::Problem, ClientError> {
    let (name, content) = read_file(path)?;
    let read = formats::read(&name, &content);
    if read.is_err()
        && let Some(refusal) = other_files::instead_of_system(&name, &content)
    {
        return Err(refusal);
    }
    with_groups(read, groups)
}

/// Reads a system of which only the equations count.
///
/// # Errors
/// When the file cannot be read, or has conditions or an objective, which would be left out.
pub fn read_equations(path: &Path) -> Result<System, ClientError> {
    equations_only(read_system(path, None)?, &path.display().to_string())
}

/// Reads a system of a file or of typed equations, of which only the equations count.
///
/// # Errors
/// As [`read_equations`].
pub fn read_equations_of(source: &SystemSource) -> Result<System, ClientError> {
    equations_only(read_source(source, None)?, &source_name(source))
}

fn equations_only(problem: formats::Problem, origin: &str) -> Result<System, ClientError> {
    if problem.objective.is_some() || !problem.conditions.is_empty() {
        let message = "has conditions or an objective, which `cognate solve` follows; expected equations only";
        return Err(wrong(origin, message));
    }
    Ok(problem.system)
}

/// A system that was read, with these groups in the place of its own.
fn with_groups(
    read: Result<formats::Problem, FormatError>,
    groups: Option<&str>,
) -> Result<formats::Problem, ClientError> {
    let mut problem = read.map_err(|e| described(&e))?;
    if let Some(groups) = groups {
        formats::options::groups(groups, &mut problem.system).map_err(|e| described(&e))?;
    }
    Ok(problem)
}

/// The name of typed equations in messages.
const TYPED: &str = "-e";

/// The name of a system in messages that a program holds in memory.
const IN_MEMORY: &str = "system";

/// The name of typed values of parameters in messages.
const TARGETS: &str = "--targets";

/// Reads the system of a file or of typed equations, and puts the groups of the command line in the place of its own.
pub fn read_source(
    source: &SystemSource,
    groups: Option<&str>,
) -> Result<formats::Problem, ClientError> {
    if let Some(content) = &source.content {
        return with_groups(formats::read(IN_MEMORY, content), groups);
    }
    if let Some(file) = &source.file {
        return read_system(file, groups);
    }
    let text = source.equation.join("\n");
    with_groups(formats::plain::typed(TYPED, &text), groups)
}

/// The name of a system's file without its folders.
pub fn source_name(source: &SystemSource) -> String {
    match &source.file {
        Some(file) => short_name(file),
        None => "equations".into(),
    }
}

/// The sets of a linear-product start: variables by index, for each factor of each equation.
pub fn read_sets(
    path: Option<&Path>,
    system: &System,
) -> Result<Option<Vec<Vec<Vec<u32>>>>, ClientError> {
    let Some(path) = path else {
        return Ok(None);
    };
    let (name, content) = read_file(path)?;
    let sets = formats::sets::read(&name, &content, system);
    sets.map(Some).map_err(|e| described(&e))
}

/// Everything that the arguments say, checked.
pub fn prepare(a: &ProblemArguments) -> Result<Prepared, ClientError> {
    let formats::Problem {
        mut system,
        settings: mut file,
        warnings,
        conditions,
        objective,
        ..
    } = read_source(&a.system, a.groups.as_deref())?;
    let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    if let Some(pairs) = &a.conjugates {
        formats::options::conjugates(pairs, &mut system).map_err(|e| described(&e))?;
    }
    if let Some(path) = &a.degenerate {
        let (name, content) = read_file(path)?;
        formats::degenerate::read(&name, &content, &mut system).map_err(|e| described(&e))?;
    }
    if let Some(path) = &a.symmetry {
        let (name, content) = read_file(path)?;
        formats::symmetry::read(&name, &content, &mut system).map_err(|e| described(&e))?;
    }
    let sets = read_sets(a.sets.as_deref(), &system)?;
    let preset = Preset::from(a.preset);
    warnings.extend(file_settings::precision_warning(&file));
    warnings.extend(file_settings::stricter_warning(&file, &preset.settings()));
    let start_solutions = match &a.start_solutions {
        None => None,
        Some(path) => Some(start_points(path, &system)?),
    };
    let start = match (a.start, &start_solutions) {
        (StartKind::Auto, Some(_)) => StartKind::Given,
        (start, _) => start,
    };
    let start_parameters = start_values(a, &system)?;
    let targets = targets(TARGETS, &a.target_parameters, &system)?;
    warnings.extend(targets.warnings.iter().map(ToString::to_string));
    file.data_accuracy = file.data_accuracy.max(accuracy_of_values(&targets));
    let mut target_parameters = targets.values;
    if start_parameters.is_empty()
        && target_parameters.is_empty()
        && let Some((values, warning)) = file.random_parameters(&system, a.seed)
    {
        target_parameters.push(values);
        warnings.push(warning);
    }
    check_values(a, start, &system, &target_parameters)?;
    let of_file = file_settings::of_file(&file, &system, &preset.settings());
    let options = Options {
        start,
        // The groups are in the system already.
        groups: None,
        conjugates: vec![],
        seed: a.seed.or(file.seed),
        settings: SettingsChoice {
            preset: Some(preset),
            exact_data: of_file.exact_data.map(|exact| exact || a.exact),
            ..of_file
        },
        precision: a.precision,
        start_parameters,
        target_parameters,
        start_solutions,
        name: source_name(&a.system).chars().take(60).collect(),
        idle_loops: a.idle_loops,
        expected_solutions: a.expect,
        closings: ClosingOptions {
            certify: a.certify,
            digits: a.digits.or(file.digits),
            deflate: a.deflate,
            no_exact_count: a.no_exact_count,
            approximate: a.approximate,
        },
        trace_test: a.trace_test,
        confidence: a.confidence,
        warnings,
        sets,
        decompose: None,
        question: None,
    };
    options.check().map_err(misfit)?;
    Ok(Prepared {
        submission: Submission {
            source: Source::System(Box::new(system)),
            options,
        },
        name: source_name(&a.system),
        conditions,
        objective,
        other_run: file.other_run,
    })
}

/// Whether parameters have values where they need some: loops go through values of their own.
fn check_values(
    a: &ProblemArguments,
    start: StartKind,
    system: &System,
    targets: &[Vec<Complex64>],
) -> Result<(), ClientError> {
    let parameters = system.parameters.iter().enumerate();
    // The value of a path variable is not asked for.
    let free = parameters.filter(|(k, _)| system.path_variable != Some(*k));
    let names: Vec<String> = free.map(|(_, name)| name.clone()).collect();
    if names.is_empty() || !targets.is_empty() || start == StartKind::Monodromy {
        return Ok(());
    }
    Err(ClientError::WithoutValues {
        origin: source_name(&a.system),
        names,
    })
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::Careful => Self::Careful,
            PresetName::Default => Self::Default,
            PresetName::Fast => Self::Fast,
            PresetName::Reckless => Self::Reckless,
        }
    }
}

/// The submission that asks for these components instead of isolated solutions.
///
/// # Errors
/// A file with an objective, which components do not answer.
pub fn for_components(
    mut prepared: Prepared,
    wanted: &ComponentArguments,
) -> Result<Prepared, ClientError> {
    prepared.refuse_objective()?;
    prepared.refuse_other_run(&DECOMPOSES)?;
    prepared.leave_conditions("components are not selected");
    let options = &mut prepared.submission.options;
    // A file's digits are those of isolated solutions.
    if options.closings.digits.take().is_some() {
        options
            .warnings
            .push("the file asks for digits; witness points have those of doubles".into());
    }
    let known_components = options.decompose.take().and_then(|resumed| resumed.known);
    options.decompose = Some(Decompose {
        dimensions: wanted.dimension.map(|d| [d.lowest, d.highest]),
        idle_loops: wanted.loops,
        method: wanted.method.method(),
        verify: wanted.verify,
        without_split: wanted.no_split,
        known: known_components,
    });
    Ok(prepared)
}

fn start_points(path: &Path, system: &System) -> Result<StartSolutions, ClientError> {
    let (name, content) = read_file(path)?;
    // Our own objects, all bits of them: families that are kept.
    if let Ok(points) = StoredPoints::from_bytes(&content) {
        if points.dimension != system.variables.len() {
            let message = format!(
                "holds points of {}; the system has {}",
                counted(points.dimension as u64, "coordinate"),
                counted(system.variables.len() as u64, "variable")
            );
            return Err(wrong(&name, &message));
        }
        if points.is_empty() {
            return Err(wrong(&name, "holds no start solution"));
        }
        return Ok(StartSolutions::Points(points));
    }
    if !system.helpers.is_empty() {
        let message = "holds start solutions; those of equations with functions of unknowns are not in this version, \
                       because false branches are needed as well";
        return Err(wrong(&name, message));
    }
    let points = formats::points::read_solutions(&name, &content, &system.variables)
        .map_err(|e| described(&e))?;
    if points.is_empty() {
        return Err(wrong(&name, "holds no start solution"));
    }
    Ok(StartSolutions::Points(StoredPoints {
        dimension: system.variables.len(),
        coordinates: points.into_iter().flatten().collect(),
    }))
}

fn parameters(path: Option<&Path>, system: &System) -> Result<Vec<Vec<Complex64>>, ClientError> {
    let Some(path) = path else {
        return Ok(vec![]);
    };
    let (name, content) = read_file(path)?;
    if system.parameters.is_empty() {
        return Err(wrong(
            &name,
            "the system has no parameters to give values to",
        ));
    }
    formats::points::read_parameters(&name, &content, &system.parameters).map_err(|e| described(&e))
}

/// Values of the parameters at the start solutions; none where none are given.
fn start_values(a: &ProblemArguments, system: &System) -> Result<Vec<Complex64>, ClientError> {
    let option = "--start-parameters";
    let mut values = match &a.start_parameters {
        Some(_) if a.start_solutions.is_none() => {
            let message = "belongs to start solutions; expected --start-solutions FILE, too";
            return Err(wrong(option, message));
        }
        Some(path) if typed_values(path).is_some() => {
            targets(option, std::slice::from_ref(path), system)?.values
        }
        path => parameters(path.as_deref(), system)?,
    };
    if values.len() > 1 {
        let message = format!("holds {} sets of parameters; expected one", values.len());
        return Err(wrong(option, &message));
    }
    Ok(values.pop().unwrap_or_default())
}

/// A text `NAME=VALUES` in place of a file of this name.
fn typed_values(path: &Path) -> Option<&str> {
    let typed = path.to_str().filter(|text| text.contains('='));
    typed.filter(|_| !path.is_file())
}

/// The values of an option that is given several times: files, and texts `NAME=VALUES`.
fn targets(option: &str, given: &[PathBuf], system: &System) -> Result<Targets, ClientError> {
    let mut contents = Vec::with_capacity(given.len());
    for path in given {
        contents.push(match typed_values(path) {
            Some(text) => (option.to_owned(), text.as_bytes().to_vec(), true),
            None => {
                let (name, content) = read_file(path)?;
                (name, content, false)
            }
        });
    }
    if let Some((name, ..)) = contents.first().filter(|_| system.parameters.is_empty()) {
        return Err(wrong(
            name,
            "the system has no parameters to give values to",
        ));
    }
    let sources: Vec<TargetSource<'_>> = contents
        .iter()
        .map(|(name, content, is_typed)| TargetSource {
            name,
            content,
            is_typed: *is_typed,
        })
        .collect();
    formats::targets::read(&sources, &system.parameters).map_err(|e| described(&e))
}

/// Relative accuracy of the values of parameters: of their decimals, or of doubles where a value is no short number, as
/// sqrt(2).
fn accuracy_of_values(targets: &Targets) -> f64 {
    let mut values = targets.values.iter().flatten();
    match values.all(|value| ComplexRational::from_short(*value).is_some()) {
        true => targets.data_accuracy,
        false => targets.data_accuracy.max(ROUNDED_TO_DOUBLES),
    }
}

/// A misfit in the words of the command line.
fn misfit(misfit: OptionMisfit) -> ClientError {
    let typed = |field: &str| match field {
        "expected_solutions" => "--expect".to_owned(),
        field => format!("--{}", field.replace('_', "-")),
    };
    match misfit {
        OptionMisfit::OnlyWith { field, starts } => {
            let message = format!("{ONLY_WITH_START}{}", any_of(starts));
            wrong(&typed(field), &message)
        }
        OptionMisfit::NotWith { field, other } => {
            wrong(&typed(field), &format!("does not go with {}", typed(other)))
        }
        OptionMisfit::SeveralTargets { field } => {
            wrong(&typed(field), "goes with one set of parameters")
        }
        OptionMisfit::NoStartSolutions => wrong("--start given", "needs --start-solutions FILE"),
    }
}

fn wrong(origin: &str, message: &str) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}

/// The whole message of a reader: it names file, line and column itself.
fn described(error: &FormatError) -> ClientError {
    ClientError::Format(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Attack X of the third attack on the service (2026-11): `/dev/zero` was read until memory ran out.
    #[test]
    fn a_file_without_an_end_is_refused_by_its_size() {
        let limit = OBJECT_BYTES.value;
        let refused = read_bounded(io::repeat(0)).unwrap_err();
        assert!(
            refused.to_string().contains(&limit.to_string()),
            "{refused}"
        );
        assert_eq!(read_bounded(&b"x - 1"[..]).unwrap(), b"x - 1");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.bertini");
        let file = std::fs::File::create(&path).unwrap();
        file.set_len(limit + 1).unwrap();
        assert!(read_file(&path).is_err());
    }
}
