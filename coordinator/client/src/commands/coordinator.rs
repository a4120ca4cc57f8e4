//! `cognate coordinator`: the service.

use crate::arguments::Coordinator;
use crate::commands::mechanism::page::PageMechanisms;
use crate::config_file::{ConfigFile, DAY, age_ms};
use crate::error::{ClientError, Exit};
use cognate_coordinator::api::security::{Tls, Tokens};
use cognate_coordinator::config::Config;
use cognate_coordinator::server::{self, RunningServer, ServerError};
use cognate_worker::transport::connect::CredentialError;
use std::sync::Arc;

/// Serves until somebody wants it to end; then lets running calls finish.
pub async fn run(a: &Coordinator) -> Result<Exit, ClientError> {
    cognate_worker::log::to_standard_error(a.log_format);
    // Ledger, results and sockets are private to this user, because they hold all problems and answers.
    rustix::process::umask(rustix::fs::Mode::RWXG | rustix::fs::Mode::RWXO);
    let config = config(a)?;
    let started = |server: &RunningServer| {
        for address in &server.addresses {
            eprintln!("listening on {address}");
        }
        if let Some(url) = &server.page {
            eprintln!("page at {url}");
        }
    };
    match server::run(config, started).await {
        Ok(()) => Ok(Exit::Solved),
        Err(ServerError::Listener(e)) => Err(ClientError::Input {
            origin: "--listen".into(),
            message: e.to_string(),
        }),
        Err(e) => Err(ClientError::Local(format!(
            "the coordinator could not be started: {e}"
        ))),
    }
}

/// Configuration from the arguments and the file, checked; the arguments win.
fn config(a: &Coordinator) -> Result<Config, ClientError> {
    let wrong = |origin: &str, e: &dyn std::fmt::Display| ClientError::Input {
        origin: origin.into(),
        message: e.to_string(),
    };
    let file = match &a.config {
        Some(path) => ConfigFile::read(path)?,
        None => ConfigFile::default(),
    };
    let rules = file.rules().map_err(|e| wrong("--config", &e))?;
    let mut config = Config {
        shared_memory: file.shared_memory_least_free(),
        rules,
        ..Config::default()
    };
    let listen = if a.listen.is_empty() {
        file.listen
    } else {
        Some(a.listen.clone())
    };
    if let Some(listen) = listen {
        let addresses = listen.iter().map(|address| address.parse());
        config.listen = addresses
            .collect::<Result<_, _>>()
            .map_err(|e| wrong("--listen", &e))?;
    }
    if let Some(ledger) = a.ledger.clone().or(file.ledger) {
        config.ledger = ledger.parse().map_err(|e| wrong("--ledger", &e))?;
    }
    if let Some(results) = a.results.clone().or(file.results) {
        config.results = Some(results.parse().map_err(|e| wrong("--results", &e))?);
    }
    let failed = |error: CredentialError| ClientError::Input {
        origin: error.file,
        message: error.what,
    };
    let tokens = a.token_file.clone().or(file.token_file);
    config.security.tokens = tokens
        .map(|path| Tokens::read(&path).map_err(failed))
        .transpose()?;
    let certificate = a.tls_certificate.clone().or(file.tls_certificate);
    let key = a.tls_key.clone().or(file.tls_key);
    let authority = a.tls_client_ca.clone().or(file.tls_client_ca);
    config.security.tls = match (certificate, key) {
        (Some(certificate), Some(key)) => {
            Some(Tls::read(&certificate, &key, authority.as_deref()).map_err(failed)?)
        }
        (None, None) if authority.is_none() => None,
        _ => {
            let what = "tls_certificate and tls_key belong together";
            return Err(wrong("--config", &what));
        }
    };
    if let Some(days) = a.retain_days {
        let keep = age_ms("--retain-days", days, DAY);
        config.rules.policy.retention.keep_ms = keep.map_err(|e| wrong("--retain-days", &e))?;
    }
    config.metrics = a.metrics.clone().or(file.metrics);
    config.traces = a.traces.clone().or(file.traces);
    config.audit_log = a.audit_log.clone().or(file.audit_log);
    config.page = a.page.clone().or(file.page);
    config.mechanisms = Some(Arc::new(PageMechanisms));
    config.insecure = a.insecure || file.insecure.unwrap_or(false);
    Ok(config)
}
