//! `cognate fleet`: keeps as many workers in a batch system as the backlog asks for.

use crate::arguments::{Fleet as Arguments, FleetSlurm};
use crate::error::{ClientError, Exit};
use crate::fleet::Fleet;
use crate::fleet::scaling::Wishes;
use crate::fleet::slurm::Slurm;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Keeps the fleet until it is interrupted; its workers go on.
pub async fn run(a: &Arguments) -> Result<Exit, ClientError> {
    let Arguments::Slurm(a) = a;
    cognate_worker::log::to_standard_error(cognate_worker::log::LogFormat::Text);
    let fleet = fleet(a)?;
    if a.once {
        fleet.once().await?;
        return Ok(Exit::Solved);
    }
    fleet.keep().await
}

fn fleet(a: &FleetSlurm) -> Result<Fleet, ClientError> {
    let wrong = |origin: &str, message: String| ClientError::Input {
        origin: origin.into(),
        message,
    };
    if a.min > a.max {
        let message = format!("{} is more than --max {}", a.min, a.max);
        return Err(wrong("--min", message));
    }
    let program = match &a.program {
        Some(program) => program.clone(),
        None => std::env::current_exe().map_err(|e| wrong("--program", e.to_string()))?,
    };
    let workers = a.for_workers.as_deref().unwrap_or(&a.service.coordinator);
    let mut environment = vec![
        ("COGNATE_COORDINATOR", workers.to_owned()),
        ("COGNATE_PROGRAM", program.display().to_string()),
        ("COGNATE_IDLE_TIMEOUT", a.idle_timeout.to_string()),
    ];
    let credentials = &a.service.credentials;
    let files = [
        (
            "COGNATE_TOKEN_FILE",
            a.worker_token_file
                .as_ref()
                .or(credentials.token_file.as_ref()),
        ),
        ("COGNATE_TLS_CA", credentials.tls_ca.as_ref()),
    ];
    for (name, file) in files {
        if let Some(file) = file {
            environment.push((name, absolute(file)?.display().to_string()));
        }
    }
    Ok(Fleet {
        target: a.service.target()?,
        slurm: Slurm {
            name: a.name.clone(),
            time: a.time.clone(),
            environment,
            more: a.sbatch.clone(),
            logs: absolute(&a.logs)?,
        },
        wishes: Wishes {
            least: a.min,
            most: a.max,
            finish_within: Duration::from_secs(a.finish_within),
        },
        pause: Duration::from_secs(a.every),
    })
}

/// Workers begin in folders of their own.
fn absolute(file: &Path) -> Result<PathBuf, ClientError> {
    std::path::absolute(file).map_err(|source| ClientError::File {
        action: "cannot find",
        path: file.to_owned(),
        source,
    })
}
