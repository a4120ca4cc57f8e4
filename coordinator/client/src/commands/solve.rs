//! `cognate solve`: a coordinator and workers for one problem, here.

use super::results::Answer;
use super::{critical_jobs, results, submit, sweep, watch};
use crate::arguments::{
    AnswerFormat, OutputArguments, OwnOrRunning, ProblemArguments, ProgressArguments, Shown, Solve,
};
use crate::connection::{Connection, Target};
use crate::embedded::Embedded;
use crate::error::{ClientError, Exit};
use crate::interruption::{interrupted, unless_interrupted};
use crate::objective::ObjectiveArguments;
use crate::output::progress::Progress;
use crate::output::summary;
use crate::problem::{self, Prepared};
use crate::selection::{SelectionArguments, View};
use cognate_protocol::v1::JobState;
use cognate_systems::formats::{self, Format};
use std::io::IsTerminal;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

/// Number of paths to critical points, at most, with which spheres are looked at: their two jobs follow some ten times as
/// many.
const MOST_PATHS_BEFORE_SPHERES: u64 = 100;

/// Solves, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &Solve) -> Result<Exit, ClientError> {
    let (prepared, mut view) = prepared(a)?;
    let page = a.page.as_deref();
    let service = Embedded::start_with_page(a.workers, a.threads, page).await?;
    if let Some(url) = service.page() {
        eprintln!("page at {url}");
        show(url);
    }
    embedded(&a.output, &a.progress, prepared, &mut view, service).await
}

/// The problem that is asked, and the view of its solutions.
fn prepared(a: &Solve) -> Result<(Prepared, View), ClientError> {
    let typed = with_objective(a);
    let (problem, selection, objective) = match &typed {
        Some((problem, selection)) => (problem, selection, &ObjectiveArguments::default()),
        None => (&a.problem, &a.selection, &a.objective),
    };
    let mut prepared = problem::prepare(problem)?;
    prepared.refuse_other_run(&[])?;
    let view = prepared.view(selection, objective)?;
    Ok((prepared, view))
}

/// Solves, and gives the answer with all solutions that are wanted; stops everything that it started, also when interrupted.
pub async fn answer(a: &Solve, progress: Progress) -> Result<Answer, ClientError> {
    let asked = SingleProblem::of(a)?;
    let mut service = Embedded::start(a.workers, a.threads).await?;
    let target = service.target();
    let ended = service.attend(asked.answer(&target, progress)).await;
    service.stop().await;
    ended
}

/// Solves in this process alone, and gives the answer with all solutions that are wanted. Starts no process and catches no
/// signal.
pub async fn answer_in_process(a: &Solve) -> Result<Answer, ClientError> {
    let asked = SingleProblem::of(a)?;
    let mut service = Embedded::start_in_process(a.threads).await?;
    let target = service.target();
    let answer = asked.answer(&target, Progress::silent());
    let ended = service.attend_in_process(answer).await;
    service.stop().await;
    ended
}

/// A problem with one answer, whose solutions are wanted as values.
struct SingleProblem {
    prepared: Prepared,
    view: View,
    output: OutputArguments,
}

impl SingleProblem {
    /// # Errors
    /// When the problem is not one, or has an answer for each of several targets.
    fn of(a: &Solve) -> Result<Self, ClientError> {
        let (prepared, view) = prepared(a)?;
        if prepared.is_sweep() {
            let message = "several targets of a family are for `cognate solve`";
            return Err(ClientError::Misfit(message.to_owned()));
        }
        let output = OutputArguments {
            format: AnswerFormat::Table,
            show: Some(Shown::All),
            output: a.output.output.clone(),
            axes: Vec::new(),
        };
        Ok(Self {
            prepared,
            view,
            output,
        })
    }

    /// Has it solved by the coordinator of this address.
    async fn answer(mut self, target: &Target, progress: Progress) -> Result<Answer, ClientError> {
        let (mut connection, job) =
            finished(self.prepared, &mut self.view, target, progress).await?;
        let json = connection.summary(&job).await?;
        let summary = summary::read(&json)?;
        Answer::gather(
            &mut connection,
            &job,
            json,
            summary,
            &self.output,
            &mut self.view,
        )
        .await
    }
}

/// The problem with the objective among its conditions, where nothing or conditions alone are typed, or all that a file
/// holds, and what else selects: without equations the critical points are those of the objective alone, and an unknown may
/// be in a condition only. So it is where the objective has functions, which become unknowns with equations.
fn with_objective(a: &Solve) -> Option<(ProblemArguments, SelectionArguments)> {
    let line = a.objective.line()?;
    let (mut problem, mut selection) = (a.problem.clone(), a.selection.clone());
    let system = &mut problem.system;
    let is_condition = |text: &String| text.contains(['<', '>', '≤', '≥']);
    match system.file.take() {
        Some(file) => system.equation = vec![plain_text_beside(&file, &line)?],
        None if has_functions(&line) => {}
        None if !system.equation.iter().all(is_condition) => return None,
        None => {}
    }
    let conditions = std::mem::take(&mut selection.conditions).into_iter();
    let conditions = conditions.map(|text| format!("where: {text}"));
    system.equation.extend(conditions);
    system.equation.push(line);
    Some((problem, selection))
}

/// Whether a text may hold functions: a letter before a bracket, or a power that is a fraction.
fn has_functions(text: &str) -> bool {
    let mut previous = ' ';
    let mut has_call = false;
    for character in text.chars().filter(|character| !character.is_whitespace()) {
        has_call |= character == '(' && previous.is_alphabetic();
        has_call |= previous == '^' && (character == '(' || character == '0');
        has_call |= character == '√';
        previous = character;
    }
    has_call
}

/// The text of a file that holds conditions and no equations, or plain equations beside an objective with functions;
/// `objective` is a line of plain equations.
fn plain_text_beside(file: &Path, objective: &str) -> Option<String> {
    // Standard input is read once.
    if file.as_os_str() == "-" {
        return None;
    }
    let (name, content) = problem::read_file(file).ok()?;
    if let Ok(problem) = formats::read(&name, &content) {
        let takes_functions = problem.format == Format::Plain && has_functions(objective);
        let text = String::from_utf8(content).ok();
        return text.filter(|_| takes_functions);
    }
    let text = String::from_utf8(content).ok()?;
    let with_objective = formats::plain::typed(&name, &format!("{text}\n{objective}")).ok()?;
    let is_free = with_objective.objective.is_some_and(|o| o.is_free);
    is_free.then_some(text)
}

/// Opens a page in this user's browser, where there is one; its address was said in any case.
fn show(url: &str) {
    let has_windows = ["DISPLAY", "WAYLAND_DISPLAY"].map(std::env::var_os);
    if std::io::stderr().is_terminal() && has_windows.iter().any(Option::is_some) {
        let mut browser = std::process::Command::new("xdg-open");
        browser.arg(url).stdin(Stdio::null()).stdout(Stdio::null());
        let _ = browser.stderr(Stdio::null()).spawn();
    }
}

/// Has a problem solved by the running coordinator that was named, or by one of the command's own.
pub async fn anywhere(
    service: &OwnOrRunning,
    running: Option<&Target>,
    output: &OutputArguments,
    progress: &ProgressArguments,
    prepared: Prepared,
) -> Result<Exit, ClientError> {
    let view = &mut View::default();
    match running {
        Some(target) => unless_interrupted(follow(output, progress, prepared, view, target)).await,
        None => embedded(output, progress, prepared, view, service.start().await?).await,
    }
}

/// Has a problem solved by this service, then stops it.
async fn embedded(
    output: &OutputArguments,
    progress: &ProgressArguments,
    prepared: Prepared,
    view: &mut View,
    mut service: Embedded,
) -> Result<Exit, ClientError> {
    let target = service.target();
    let ended = service.attend(follow(output, progress, prepared, view, &target));
    let ended = ended.await;
    if let Some(url) = service.page().filter(|_| ended.is_ok()) {
        eprintln!("the page stays at {url} until this command is interrupted (Ctrl-C)");
        interrupted().await;
    }
    service.stop().await;
    ended
}

/// Submits a problem, follows its job and shows the answer; a family at many values takes several jobs.
pub async fn follow(
    output: &OutputArguments,
    progress: &ProgressArguments,
    prepared: Prepared,
    view: &mut View,
    target: &Target,
) -> Result<Exit, ClientError> {
    if prepared.is_sweep() {
        return sweep::run(output, progress, prepared, view, target).await;
    }
    let quiet = output.format != AnswerFormat::Table;
    let progress = Progress::of(progress.progress, quiet, Instant::now());
    let (mut connection, job) = finished(prepared, view, target, progress).await?;
    results::show(&mut connection, &job, output, view).await
}

/// Submits a problem and follows its job to the end. Gives the connection that has the answer, and the job's id.
async fn finished(
    prepared: Prepared,
    view: &mut View,
    target: &Target,
    mut progress: Progress,
) -> Result<(Connection, String), ClientError> {
    let mut connection = Connection::open(target).await?;
    let request_id = uuid::Uuid::new_v4().to_string();
    let critical = view.is_critical().then(|| prepared.clone());
    let (job, warnings) = submit::send(&mut connection, &request_id, prepared).await?;
    for warning in &warnings {
        progress.say(&format!("warning: {warning}"));
    }
    let followed = followed(target, &job, critical, view, &mut progress).await;
    progress.finish();
    Ok((followed?, job))
}

/// A job to its end; then, where it found sets of critical points of the problem, these. Gives the connection that has the
/// job's answer.
async fn followed(
    target: &Target,
    job: &str,
    critical: Option<Prepared>,
    view: &mut View,
    progress: &mut Progress,
) -> Result<Connection, ClientError> {
    let (mut connection, last) = watch::follow(target, job, progress).await?;
    match last.state() {
        JobState::Failed => return Err(ClientError::GaveUp(last.message)),
        JobState::Cancelled => return Err(ClientError::Cancelled),
        _ => {}
    }
    if let Some(problem) = critical {
        let summary = summary::read(&connection.summary(job).await?)?;
        if summary.solutions.positive_dimensional == Some(true) {
            critical_jobs::add_sets(target, problem, view, progress).await?;
        } else if summary.settled && summary.paths.total <= MOST_PATHS_BEFORE_SPHERES {
            let connection = &mut connection;
            critical_jobs::add_sphere(connection, job, target, problem, view, progress).await?;
        }
    }
    Ok(connection)
}
