//! Measures: CPU time of the thread that asks, memory of a process, as Linux tells them.

use std::io;

fn field(path: &str, text: Option<&str>) -> io::Result<f64> {
    let number = text.and_then(|text| text.parse().ok());
    number.ok_or_else(|| io::Error::other(format!("{path} is not as expected")))
}

/// CPU seconds of this thread so far.
///
/// # Errors
/// Where the system does not say.
pub fn cpu_seconds() -> io::Result<f64> {
    let path = "/proc/thread-self/schedstat";
    let text = std::fs::read_to_string(path)?;
    Ok(field(path, text.split_whitespace().next())? * 1e-9)
}

/// CPU seconds of a process (by its number) so far; 0 where the system does not say, or the process has ended.
#[must_use]
pub fn process_cpu_seconds(process: u32) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // Fields 14 and 15, in hundredths of a second; the name in field 2 may hold spaces.
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let mut ticks = fields.split_whitespace().skip(11).map(str::parse::<f64>);
    let (user, system) = (ticks.next(), ticks.next());
    let seconds = |ticks: Option<Result<f64, _>>| ticks.and_then(Result::ok).unwrap_or(0.0);
    (seconds(user) + seconds(system)) / 100.0
}

/// A line of a process's status (`self`, or its number) that counts memory, in bytes: `VmRSS`,
/// `VmHWM`.
///
/// # Errors
/// Where the system does not say.
pub fn memory_bytes(process: &str, line: &str) -> io::Result<u64> {
    let path = format!("/proc/{process}/status");
    let text = std::fs::read_to_string(&path)?;
    let memory_field = text
        .lines()
        .find_map(|l| l.strip_prefix(line)?.strip_prefix(':'));
    let kib = field(
        &path,
        memory_field.and_then(|rest| rest.split_whitespace().next()),
    )?;
    Ok(1024 * kib as u64)
}
