//! libcognate as programs of other languages call it: `example.c` compiled as C and as C++ with every warning an error, and
//! Python's ctypes with mistakes.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The folder of this crate, with the header and the example.
fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The archive that cargo has built before this test, beside it: the newest, since those of older builds stay there.
fn archive() -> PathBuf {
    let test = std::env::current_exe().expect("this test has a path");
    let folder = test.parent().expect("it is in a folder");
    let archives = std::fs::read_dir(folder)
        .expect("it can be read")
        .flatten()
        .filter(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            name.starts_with("libcognate-") && name.ends_with(".a")
        });
    let newest = archives.max_by_key(|entry| entry.metadata().and_then(|m| m.modified()).ok());
    newest.expect("cargo has built libcognate").path()
}

/// A folder with libcognate.so, made as people make it.
fn linked() -> tempfile::TempDir {
    let scratch = tempfile::tempdir().expect("a folder");
    let mut link = Command::new(folder().join("link.sh"));
    let output = link.arg(archive()).arg(scratch.path()).output();
    let output = output.expect("it can be started");
    assert!(output.status.success(), "{}", text(&output.stderr));
    scratch
}

/// Output of a program that finds libcognate.so in this folder, and keeps nothing elsewhere.
fn run(command: &mut Command, library: &Path) -> Output {
    command.env("LD_LIBRARY_PATH", library);
    command.env("XDG_CACHE_HOME", library);
    command.output().expect("it can be started")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_example_solves_and_finds_eight_postures_in_c_and_in_cpp() {
    let scratch = linked();
    for (compiler, language, standard) in [("cc", "c", "-std=c99"), ("c++", "c++", "-std=c++11")] {
        if Command::new(compiler).arg("--version").output().is_err() {
            assert_eq!(compiler, "c++", "a build needs a compiler of C");
            continue;
        }
        let program = scratch.path().join(language.replace('+', "p"));
        let compiled = Command::new(compiler)
            .args([
                "-x",
                language,
                standard,
                "-Wall",
                "-Wextra",
                "-Wpedantic",
                "-Werror",
            ])
            .arg(folder().join("example.c"))
            .args(["-x", "none", "-I"])
            .arg(folder())
            .arg("-L")
            .arg(scratch.path())
            .args(["-lcognate", "-o"])
            .arg(&program)
            .output()
            .expect("the compiler can be started");
        assert!(compiled.status.success(), "{}", text(&compiled.stderr));
        let output = run(&mut Command::new(&program), scratch.path());
        let said = text(&output.stdout);
        assert!(output.status.success(), "{said}{}", text(&output.stderr));
        assert!(said.contains("\"certified\":4"), "{said}");
        assert_eq!(said.lines().count(), 1 + 8, "{said}");
    }
}

/// Calls with mistakes, each with its answer.
const MISTAKES: &str = r#"
import ctypes, json, sys
library = ctypes.CDLL("libcognate.so")
library.cognate_version.restype = ctypes.c_char_p
library.cognate_arm_open.restype = ctypes.c_void_p
library.cognate_arm_joints.restype = ctypes.c_size_t
library.cognate_arm_joints.argtypes = [ctypes.c_void_p]
assert library.cognate_version() == sys.argv[1].encode()

def solve(system, options=None):
    answer = ctypes.c_char_p()
    code = library.cognate_solve(system, options, ctypes.byref(answer))
    value = json.loads(answer.value)
    library.cognate_free(answer)
    return code, value

code, answer = solve(b"x^2 = 2")
assert code == 0 and answer["summary"]["solutions"]["real"] == 2, answer
for system, options, part in [
    (None, None, "NULL"),
    (b"x^2 + = 2", None, "system:1:"),
    (b"\xff", None, "UTF-8"),
    (b"x = 1", b"--seed 3", "JSON array"),
    (b"x = 1", b'["--sed", "3"]', "--seed"),
    (b"", None, "error"),
]:
    code, answer = solve(system, options)
    assert code == 2 and part in str(answer), (system, options, code, answer)

error = ctypes.c_char_p()
assert library.cognate_arm_open(b"theta,d,a\n1,2", None, ctypes.byref(error)) is None
assert error.value, "a reason"
library.cognate_free(error)

table = b"theta,d,a,alpha\n0,0.2,0,90\n0,0,0.5,0\n0,0,0.4,0\n0,0.1,0,90\n0,0.1,0,-90\n0,0.08,0,0\n"
arm = ctypes.c_void_p(library.cognate_arm_open(table, b'["--angles", "deg"]', None))
assert arm.value and library.cognate_arm_joints(arm) == 6
pose = [0, 0, 1, 0.4, 1, 0, 0, 0.3, 0, 1, 0, 0.35, 0, 0, 0, 1]
far = pose[:3] + [100] + pose[4:]
poses = (ctypes.c_double * 32)(*(pose + far))
joints = (ctypes.c_double * 96)()
offsets = (ctypes.c_size_t * 3)()
settled = (ctypes.c_uint8 * 2)()
def inverse(poses, capacity):
    error = ctypes.c_char_p()
    code = library.cognate_arm_inverse(
        arm, poses, ctypes.c_size_t(2), joints, ctypes.c_size_t(capacity), offsets, settled, ctypes.byref(error))
    said = error.value
    library.cognate_free(error)
    return code, list(offsets), said
assert inverse(poses, 16) == (0, [0, 8, 8], None) and list(settled) == [1, 1]
code, counts, said = inverse(poses, 7)
assert code == 2 and counts[2] == 8 and b"room for 7 postures, there are 8" in said, said
skew = (ctypes.c_double * 32)(*(pose + [2] * 16))
code, counts, said = inverse(skew, 16)
assert code == 2 and counts == [0, 0, 0] and b"pose 1" in said, said

answer = ctypes.c_char_p()
line = b'{"position": [0.4, 0.3, 0.35], "quaternion": [0.5, 0.5, 0.5, 0.5]}\n'
assert library.cognate_arm_answer(arm, line, ctypes.byref(answer)) == 0
assert json.loads(answer.value)["configurations"]["real"] == 8
library.cognate_free(answer)
assert library.cognate_arm_answer(arm, b"nonsense\n", ctypes.byref(answer)) == 2
assert "error" in json.loads(answer.value)
library.cognate_free(answer)
library.cognate_arm_close(arm)
library.cognate_arm_close(None)
library.cognate_free(None)
print("done")
"#;

#[test]
fn mistakes_of_a_caller_have_answers() {
    let scratch = linked();
    let mut python = Command::new("python3");
    python.args(["-c", MISTAKES, env!("CARGO_PKG_VERSION")]);
    let output = run(&mut python, scratch.path());
    let said = text(&output.stdout);
    assert!(
        output.status.success() && said == "done\n",
        "{said}{}",
        text(&output.stderr)
    );
}
