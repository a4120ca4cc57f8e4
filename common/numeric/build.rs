//! Makes the linker take the static GMP, MPFR and MPC of the system, so that a program runs where they are not installed.
//!
//! `gmp-mpfr-sys` names the libraries without saying which kind. The linker takes the first folder that has either kind,
//! so a folder with links to the static ones comes before the folders of the system.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// File names of the static libraries.
const LIBRARIES: [&str; 3] = ["libgmp.a", "libmpfr.a", "libmpc.a"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if env::var_os("CARGO_CFG_BUNDLED_LIBRARIES").is_some() {
        return;
    }
    let compiler = env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it")).join("static");
    fs::create_dir_all(&folder).expect("the build folder can be written");
    for library in LIBRARIES {
        match path(&compiler, library) {
            Some(path) => link(&path, &folder.join(library)),
            // Where the system has shared libraries only, these are taken.
            None => println!(
                "cargo:warning={library} is not installed: the program needs the shared library"
            ),
        }
    }
    println!("cargo:rustc-link-search=native={}", folder.display());
}

/// Path at which the C compiler finds a library; `None` if there is none.
fn path(compiler: &str, library: &str) -> Option<PathBuf> {
    let answer = Command::new(compiler)
        .arg(format!("-print-file-name={library}"))
        .output()
        .ok()?;
    // The compiler repeats the name of a library that it does not find.
    let path = PathBuf::from(String::from_utf8(answer.stdout).ok()?.trim());
    path.is_absolute().then_some(path)
}

/// Makes `link` point at `library`, whatever it was before.
fn link(library: &Path, link: &Path) {
    let _ = fs::remove_file(link);
    #[cfg(unix)]
    std::os::unix::fs::symlink(library, link).expect("the build folder can be written");
    #[cfg(not(unix))]
    fs::copy(library, link).expect("the build folder can be written");
}
