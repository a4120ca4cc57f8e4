//! Command: what `cognate worker` and `cognate-worker` do. Runtime, signals, exit code.

use crate::config::{Arguments, Config};
use crate::session::Ending;
use crate::shell;
use std::io;
use tokio::signal::unix::{SignalKind, signal};
use tokio_util::sync::CancellationToken;

/// Threads that talk to the coordinator; tracking has its own.
const IO_THREADS: usize = 2;

impl Ending {
    /// The exit code: 0 where the worker ended as it should, 3 where the service gave out.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stopped | Self::WallTime | Self::Idle => 0,
            Self::Unreachable | Self::Refused(_) => 3,
        }
    }
}

/// Works until something ends it; the first SIGTERM or SIGINT drains, the second one ends at once.
///
/// Returns the exit code; what went wrong is on standard error.
pub fn execute(arguments: Arguments) -> u8 {
    let config = match Config::try_from(arguments) {
        Ok(config) => config,
        Err(error) => {
            eprintln!("error: {error}");
            return 2;
        }
    };
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(IO_THREADS)
        .thread_name("worker-io")
        .enable_all()
        .build();
    let ending = runtime.map(|runtime| {
        let ending = runtime.block_on(work(config));
        // A stage that is being compiled for nobody is not waited for.
        runtime.shutdown_background();
        ending
    });
    match ending {
        Ok(Ok(Ok(ending))) => {
            match &ending {
                Ending::Unreachable => eprintln!("error: no coordinator could be reached"),
                Ending::Refused(why) => eprintln!("error: {why}"),
                Ending::Stopped | Ending::WallTime | Ending::Idle => {}
            }
            ending.exit_code()
        }
        Ok(Ok(Err(error))) => {
            eprintln!("error: {error}");
            2
        }
        Ok(Err(error)) | Err(error) => {
            eprintln!("error: the worker could not be started: {error}");
            3
        }
    }
}

async fn work(config: Config) -> io::Result<Result<Ending, shell::WorkerError>> {
    let shutdown = CancellationToken::new();
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    let told = shutdown.clone();
    tokio::spawn(async move {
        for count in 0.. {
            tokio::select! {
                _ = terminate.recv() => {}
                _ = interrupt.recv() => {}
            }
            if count > 0 {
                // As a shell counts an interrupted process.
                std::process::exit(130);
            }
            told.cancel();
        }
    });
    Ok(shell::run(config, shutdown).await)
}
