//! The program under test: its exit code and its output.

use std::process::{Command, Output};

/// Runs the command `cognate` with these arguments to its end.
pub fn cognate(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Printed bytes, as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
