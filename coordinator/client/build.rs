//! Lets the linker fold functions of equal code into one, where it can: generic code has many of them, and the
//! program is 0.8 MB smaller (`tests/benches/build.md`). That two functions have two addresses is nothing that Rust
//! promises or this project uses.
//!
//! Which linker is used is asked by linking an empty program with it: the one that Rust brings for x86-64 on Linux
//! (LLD) folds, GNU's does not know the argument.

use std::path::PathBuf;
use std::process::{Command, Stdio};

const FOLD: &str = "link-arg=-Wl,--icf=all";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let set = |name: &str| std::env::var(name).unwrap_or_default();
    if set("PROFILE") == "release" && linker_folds(&set) {
        println!("cargo:rustc-link-arg-bins=-Wl,--icf=all");
    }
}

/// Whether an empty program can be linked with the argument.
fn linker_folds(set: &dyn Fn(&str) -> String) -> bool {
    let folder = PathBuf::from(set("OUT_DIR"));
    let empty = folder.join("empty.rs");
    if std::fs::write(&empty, "fn main() {}\n").is_err() {
        return false;
    }
    let mut compiler = Command::new(set("RUSTC"));
    compiler.args(["--edition", "2024", "--target", &set("TARGET"), "-C", FOLD]);
    let linker = set("RUSTC_LINKER");
    if !linker.is_empty() {
        compiler.arg("-C").arg(format!("linker={linker}"));
    }
    let flags = set("CARGO_ENCODED_RUSTFLAGS");
    compiler.args(flags.split('\x1f').filter(|flag| !flag.is_empty()));
    compiler.arg("-o").arg(folder.join("empty")).arg(empty);
    let silent = compiler.stdout(Stdio::null()).stderr(Stdio::null());
    silent.status().is_ok_and(|status| status.success())
}
