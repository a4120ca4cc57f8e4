//! Slurm, by its commands: who of the fleet waits and runs, an array of more, fewer that wait.
//!
//! The job script is the one that people submit by hand, `deploy/slurm/workers.sbatch`.

use super::scaling::{Task, TaskState};
use crate::error::ClientError;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::process::Command;

/// The script of one worker; it asks Slurm how long it may run.
const SCRIPT: &str = include_str!("../../../../deploy/slurm/workers.sbatch");
/// A worker that may not run longer takes no chunk any more: the worker stops pulling half a
/// minute before its end, and the next one takes a while to come.
const TOO_LATE: Duration = Duration::from_secs(90);
/// Arguments of one `scancel`.
const AT_ONCE: usize = 200;

/// A fleet in Slurm: all tasks of one name of this user.
#[derive(Clone, Debug)]
pub struct Slurm {
    /// The name of its jobs.
    pub name: String,
    /// How long a worker may run, as `sbatch --time` takes it.
    pub time: String,
    /// Environment variables of the workers: name and value.
    pub environment: Vec<(&'static str, String)>,
    /// Further arguments of `sbatch`: partition, account, memory.
    pub more: Vec<String>,
    /// Where the workers' logs go.
    pub logs: PathBuf,
}

impl Slurm {
    /// The fleet's tasks, those that came last at the end.
    pub async fn tasks(&self) -> Result<Vec<Task>, ClientError> {
        let mut command = Command::new("squeue");
        command.args(["--noheader", "--me", "--array", "--sort=i", "--states=all"]);
        command.args(["--format=%i|%T|%L", "--name", &self.name]);
        let said = said(command, "").await?;
        said.lines()
            .filter_map(|line| task(line).transpose())
            .collect()
    }

    /// Submits an array of workers; its job's number.
    pub async fn submit(&self, count: u32) -> Result<String, ClientError> {
        let mut command = Command::new("sbatch");
        command.args(self.submission(count));
        command.envs(self.environment.iter().map(|(name, value)| (name, value)));
        let said = said(command, SCRIPT).await?;
        // `JOB` or `JOB;CLUSTER`.
        Ok(said.trim().split(';').next().unwrap_or_default().to_owned())
    }

    fn submission(&self, count: u32) -> Vec<String> {
        let mut arguments = vec![
            "--parsable".to_owned(),
            format!("--job-name={}", self.name),
            format!("--array=1-{count}"),
            format!("--time={}", self.time),
            format!("--output={}/%x-%A-%a.log", self.logs.display()),
            "--export=ALL".to_owned(),
        ];
        arguments.extend(self.more.iter().cloned());
        arguments
    }

    /// Takes tasks back that have not begun. One that has begun meanwhile goes on.
    pub async fn withdraw(&self, ids: &[String]) -> Result<(), ClientError> {
        for ids in ids.chunks(AT_ONCE) {
            let mut command = Command::new("scancel");
            command.arg("--state=PENDING").args(ids);
            said(command, "").await?;
        }
        Ok(())
    }
}

/// A line of `squeue`; `None` for a task that has ended.
fn task(line: &str) -> Result<Option<Task>, ClientError> {
    let mut fields = line.trim().split('|');
    let (Some(id), Some(state), Some(left), None) =
        (fields.next(), fields.next(), fields.next(), fields.next())
    else {
        return Err(ClientError::GaveUp(format!(
            "squeue said `{line}`; expected ID|STATE|TIME LEFT"
        )));
    };
    let state = match state {
        "PENDING" | "CONFIGURING" | "REQUEUED" | "REQUEUE_HOLD" | "SPECIAL_EXIT"
        | "RESV_DEL_HOLD" | "REQUEUE_FED" => TaskState::Waits,
        "RUNNING" if time_left(left).is_some_and(|left| left < TOO_LATE) => TaskState::Leaves,
        "RUNNING" | "RESIZING" | "SUSPENDED" | "STOPPED" | "SIGNALING" => TaskState::Runs,
        "COMPLETING" | "STAGE_OUT" => TaskState::Leaves,
        _ => return Ok(None),
    };
    Ok(Some(Task {
        id: id.to_owned(),
        state,
    }))
}

/// `[DAYS-][[HOURS:]MINUTES:]SECONDS`; `None` for no limit.
fn time_left(text: &str) -> Option<Duration> {
    let (days, time) = match text.split_once('-') {
        Some((days, time)) => (days.parse::<u64>().ok()?, time),
        None => (0, text),
    };
    let mut seconds = 0u64;
    for part in time.split(':') {
        seconds = seconds.checked_mul(60)?.checked_add(part.parse().ok()?)?;
    }
    Some(Duration::from_secs(
        days.checked_mul(86_400)?.checked_add(seconds)?,
    ))
}

/// Runs a command of Slurm's and returns its output.
async fn said(mut command: Command, input: &str) -> Result<String, ClientError> {
    let name = command
        .as_std()
        .get_program()
        .to_string_lossy()
        .into_owned();
    let failed = |what: String| ClientError::GaveUp(format!("{name}: {what}"));
    let child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = child.map_err(|e| failed(format!("{e}; is Slurm installed here?")))?;
    if let Some(mut stdin) = child.stdin.take() {
        // A command that does not read its input reports the fault itself.
        let _ = stdin.write_all(input.as_bytes()).await;
    }
    let output = child.wait_with_output().await;
    let output = output.map_err(|e| failed(e.to_string()))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        let why = String::from_utf8_lossy(&output.stderr);
        Err(failed(format!("{} ({})", why.trim(), output.status)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_squeue_says_is_read() {
        let read_task = |line: &str| task(line).unwrap().map(|task| (task.id, task.state));
        let is = |id: &str, state| Some((id.to_owned(), state));
        assert_eq!(
            read_task("12_3|PENDING|4:00:00"),
            is("12_3", TaskState::Waits)
        );
        assert_eq!(
            read_task("12_3|RUNNING|3:59:59"),
            is("12_3", TaskState::Runs)
        );
        assert_eq!(
            read_task("12_4|RUNNING|1-00:00:00"),
            is("12_4", TaskState::Runs)
        );
        assert_eq!(
            read_task("12_4|RUNNING|UNLIMITED"),
            is("12_4", TaskState::Runs)
        );
        assert_eq!(
            read_task("12_4|RUNNING|1:29"),
            is("12_4", TaskState::Leaves)
        );
        assert_eq!(
            read_task("12_4|COMPLETING|0:00"),
            is("12_4", TaskState::Leaves)
        );
        assert_eq!(read_task("12_4|FAILED|0:00"), None);
        assert_eq!(read_task("12_4|CANCELLED|0:00"), None);
        assert!(task("slurm_load_jobs error").is_err());
    }

    #[test]
    fn times_are_read() {
        let seconds = |text| time_left(text).map(|d| d.as_secs());
        assert_eq!(seconds("59"), Some(59));
        assert_eq!(seconds("2:05"), Some(125));
        assert_eq!(seconds("01:00:00"), Some(3600));
        assert_eq!(seconds("2-00:00:01"), Some(172_801));
        assert_eq!(seconds("UNLIMITED"), None);
        assert_eq!(seconds("INVALID"), None);
        assert_eq!(seconds("NOT_SET"), None);
    }

    #[test]
    fn the_script_takes_what_it_is_given() {
        for name in [
            "COGNATE_COORDINATOR",
            "COGNATE_PROGRAM",
            "COGNATE_IDLE_TIMEOUT",
        ] {
            assert!(SCRIPT.contains(name), "{name}");
        }
        let slurm = Slurm {
            name: "fleet".into(),
            time: "60".into(),
            environment: Vec::new(),
            more: vec!["--partition=long".into()],
            logs: "/logs".into(),
        };
        let arguments = slurm.submission(3);
        assert!(arguments.contains(&"--array=1-3".to_owned()));
        assert!(arguments.contains(&"--output=/logs/%x-%A-%a.log".to_owned()));
        assert_eq!(arguments.last().unwrap(), "--partition=long");
    }
}
