//! Real processes: start, kill -9, freeze, thaw, tell to stop; their logs where a test fails.
//!
//! The program is the `cognate` that cargo builds beside the test; nothing
//! outlives the test that started it.

use crate::measures::{memory_bytes, process_cpu_seconds};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Where the built programs are: beside the running program, or beside the folder of the running test.
fn built() -> PathBuf {
    let running = std::env::current_exe().expect("a test knows its own program");
    let folder = running.parent().expect("a program is in a folder");
    match folder.ends_with("deps") {
        true => folder.parent().expect("cargo's layout").to_owned(),
        false => folder.to_owned(),
    }
}

/// The `cognate` program, built now if it is not up to date.
///
/// `COGNATE_PROGRAM` names another one, for instance to test a package.
///
/// # Panics
/// When it cannot be built.
pub fn cognate() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        if let Some(path) = std::env::var_os("COGNATE_PROGRAM") {
            return path.into();
        }
        let folder = built();
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(cargo);
        build.args(["build", "-p", "cognate-client", "--bin", "cognate"]);
        if folder.ends_with("release") {
            build.arg("--release");
        }
        let target = folder.parent().expect("cargo's layout");
        // The output of cargo is shown: it may compile for minutes, or wait for another build.
        eprintln!(
            "cognate is built if it is not up to date; COGNATE_PROGRAM names one that is there"
        );
        let built = build
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("CARGO_TARGET_DIR", target)
            .stdin(Stdio::null())
            .status()
            .expect("cargo can be started");
        assert!(
            built.success(),
            "cognate cannot be built: its reasons are above"
        );
        folder.join("cognate")
    })
}

/// A process of the service. It is killed when it goes out of scope.
pub struct Process {
    name: String,
    child: Child,
    log: PathBuf,
    ended: Option<ExitStatus>,
}

/// How long a process may take to do what it was told.
pub const PATIENCE: Duration = Duration::from_secs(600);

impl Process {
    /// Starts `cognate` with these arguments; its output goes to `folder/name.log`.
    ///
    /// # Panics
    /// When it cannot be started.
    pub fn start(folder: &Path, name: &str, arguments: &[String]) -> Self {
        Self::start_within(&[], &[], folder, name, arguments)
    }

    /// Starts `cognate` behind the words `within`, a command that becomes the one that follows it (`nsenter`), and with
    /// these names and values in its environment.
    ///
    /// # Panics
    /// When it cannot be started.
    pub fn start_within(
        within: &[String],
        environment: &[(String, String)],
        folder: &Path,
        name: &str,
        arguments: &[String],
    ) -> Self {
        let mut command = match within {
            [] => Command::new(cognate()),
            [first, words @ ..] => {
                let mut command = Command::new(first);
                command.args(words).arg(cognate());
                command
            }
        };
        command.envs(environment.iter().cloned());
        Self::start_command(command, folder, name, arguments)
    }

    /// The running program itself with other arguments.
    ///
    /// # Panics
    /// When it cannot be started.
    pub fn start_again(folder: &Path, name: &str, arguments: &[String]) -> Self {
        let program = std::env::current_exe().expect("a program knows itself");
        Self::start_command(Command::new(program), folder, name, arguments)
    }

    fn start_command(
        mut command: Command,
        folder: &Path,
        name: &str,
        arguments: &[String],
    ) -> Self {
        let log = folder.join(format!("{name}.log"));
        let append = || {
            let file = File::options().create(true).append(true).open(&log);
            Stdio::from(file.expect("the test's folder is writable"))
        };
        let child = command
            .args(arguments)
            .env("RUST_LOG", "info,cognate_worker=debug")
            .env_remove("COGNATE_COORDINATOR")
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(append())
            .stderr(append())
            .spawn()
            .expect("the program can be started");
        Self {
            name: name.to_owned(),
            child,
            log,
            ended: None,
        }
    }

    /// Name of the process in the test.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The number by which the system knows the process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Output of the process so far.
    pub fn log(&self) -> String {
        let bytes = std::fs::read(&self.log).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Memory that it holds now, in bytes; 0 where the system does not say (Linux does).
    pub fn memory_bytes(&self) -> u64 {
        memory_bytes(&self.child.id().to_string(), "VmRSS").unwrap_or(0)
    }

    /// The most memory that it has held so far, likewise.
    pub fn peak_memory_bytes(&self) -> u64 {
        memory_bytes(&self.child.id().to_string(), "VmHWM").unwrap_or(0)
    }

    /// CPU time that it has used, in seconds; 0 where the system does not say.
    pub fn cpu_seconds(&self) -> f64 {
        process_cpu_seconds(self.child.id())
    }

    fn signal(&mut self, signal: &str) {
        assert!(self.is_alive(), "{} has ended already", self.name);
        // The shell's own `kill`: a program of that name is not on every machine.
        let command = format!("kill -{signal} {}", self.child.id());
        let status = Command::new("sh").args(["-c", &command]).status();
        assert!(status.is_ok_and(|status| status.success()), "{command}");
    }

    /// `kill -9`: it can do nothing about it.
    pub fn kill(&mut self) {
        self.signal("KILL");
        self.wait(PATIENCE);
    }

    /// SIGSTOP: it stands still, and its clock goes on.
    pub fn freeze(&mut self) {
        self.signal("STOP");
    }

    /// SIGCONT: it goes on where it was.
    pub fn thaw(&mut self) {
        self.signal("CONT");
    }

    /// SIGHUP: its terminal is closed.
    pub fn hang_up(&mut self) {
        self.signal("HUP");
    }

    /// SIGTERM: it is asked to stop.
    pub fn terminate(&mut self) {
        self.signal("TERM");
    }

    /// Whether it still runs.
    pub fn is_alive(&mut self) -> bool {
        if self.ended.is_none() {
            self.ended = self.child.try_wait().expect("a child can be waited for");
        }
        self.ended.is_none()
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// When it goes on for longer.
    pub fn wait(&mut self, patience: Duration) -> ExitStatus {
        let begin = Instant::now();
        while self.is_alive() {
            assert!(begin.elapsed() < patience, "{} does not end", self.name);
            std::thread::sleep(Duration::from_millis(5));
        }
        self.ended.expect("it has ended")
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let log = self.log();
            let lines: Vec<&str> = log.lines().collect();
            let last = lines[lines.len().saturating_sub(60)..].join("\n");
            eprintln!("---- {} ----\n{last}", self.name);
        }
        if self.is_alive() {
            // A frozen process dies of it, too.
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

/// Asks again and again until there is an answer.
///
/// # Panics
/// When there is none in time.
pub fn until<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(
            begin.elapsed() < PATIENCE,
            "{what}: not within {PATIENCE:?}"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
}
