//! Lets the linker make the program smaller, where it and the system can (`tests/benches/build.md`): functions of equal
//! code become one, since generic code has many of them (0.8 MB), and relocations are packed (1.4 MB). That two functions
//! have two addresses is nothing that Rust promises or this project uses.
//!
//! An empty program tests the abilities of the linker and of the system's loader: the linker that Rust brings for
//! x86-64 on Linux (LLD) folds, GNU's does not know the argument; GNU's C library loads packed relocations from its
//! version 2.36 on. A program for another system is linked without them.

use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Functions of equal code become one.
const FOLD: &str = "-Wl,--icf=all";
/// Relocations of addresses inside the program are packed.
const PACK: &str = "-Wl,-z,pack-relative-relocs";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if variable("PROFILE") != "release" {
        return;
    }
    if linked_with(FOLD).is_some() {
        println!("cargo:rustc-link-arg-bins={FOLD}");
    }
    if variable("HOST") == variable("TARGET") && linked_with(PACK).is_some_and(runs) {
        println!("cargo:rustc-link-arg-bins={PACK}");
    }
}

/// A variable of the environment; empty where it is not set.
fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_default()
}

/// An empty program that was linked with an argument; `None` where it could not be.
fn linked_with(argument: &str) -> Option<PathBuf> {
    let folder = PathBuf::from(variable("OUT_DIR"));
    let (source, program) = (folder.join("empty.rs"), folder.join("empty"));
    std::fs::write(&source, "fn main() {}\n").ok()?;
    let mut compiler = Command::new(variable("RUSTC"));
    compiler.args(["--edition", "2024", "--target", &variable("TARGET")]);
    compiler.arg("-C").arg(format!("link-arg={argument}"));
    let linker = variable("RUSTC_LINKER");
    if !linker.is_empty() {
        compiler.arg("-C").arg(format!("linker={linker}"));
    }
    let flags = variable("CARGO_ENCODED_RUSTFLAGS");
    compiler.args(flags.split('\x1f').filter(|flag| !flag.is_empty()));
    compiler.arg("-o").arg(&program).arg(source);
    succeeds(&mut compiler).then_some(program)
}

/// Whether this system loads a program.
fn runs(program: PathBuf) -> bool {
    succeeds(&mut Command::new(program))
}

fn succeeds(command: &mut Command) -> bool {
    let silent = command.stdout(Stdio::null()).stderr(Stdio::null());
    silent.status().is_ok_and(|status| status.success())
}
