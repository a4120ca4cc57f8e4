//! Lines that people really type wrong: every refusal has exit code 2, one message that names the place, and a line to
//! type at its end.

mod components;
mod equations;
mod mechanisms;
mod mistake;
mod options;
mod service;

use super::program::text;
use mistake::Mistake;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Files that are right, by name; every line is typed in a folder with these files and the components of a circle.
const FILES: &[(&str, &str)] = &[
    ("system.txt", "x^2 + y^2 = 5\nx*y = 2\n"),
    ("family.txt", "parameters: p\nx^2 = p\n"),
    ("points.csv", "x,y\n1,2\n2,3\n"),
    ("poses.csv", "x,y,z,qw,qx,qy,qz\n-0.4,-0.15,0.35,0,1,0,0\n"),
    (
        "arm.csv",
        "# angles: deg\nname,theta,d,a,alpha\npan,0,0.1625,0,90\nlift,0,0,-0.425,0\nelbow,0,0,-0.3922,0\n\
         wrist1,0,0.1333,0,90\nwrist2,0,0.0997,0,-90\nwrist3,0,0.0996,0,0\n",
    ),
    (
        "arm.urdf",
        "<robot name=\"a\"><link name=\"base\"/><link name=\"tip\"/><joint name=\"swing\" type=\"continuous\">\
         <parent link=\"base\"/><child link=\"tip\"/><axis xyz=\"0 0 1\"/></joint></robot>\n",
    ),
    (
        "four_bar.json",
        "{\"name\": \"four-bar\", \"space\": \"planar\", \"links\": [\"ground\", \"crank\", \"coupler\", \"rocker\"],\n\
         \"joints\": [{\"name\": \"A0\", \"type\": \"R\", \"links\": [\"ground\", \"crank\"], \"point\": [0, 0]},\n\
         {\"name\": \"A\", \"type\": \"R\", \"links\": [\"crank\", \"coupler\"], \"point\": [0, 1]},\n\
         {\"name\": \"B\", \"type\": \"R\", \"links\": [\"coupler\", \"rocker\"], \"point\": [3, 2]},\n\
         {\"name\": \"B0\", \"type\": \"R\", \"links\": [\"rocker\", \"ground\"], \"point\": [4, 0]}],\n\
         \"inputs\": [\"A0\"], \"output\": {\"link\": \"coupler\", \"point\": [1.5, 3]}}\n",
    ),
];

/// Runs a line in a folder, as a shell does.
fn shell(line: &str, folder: &Path) -> Output {
    let program = PathBuf::from(env!("CARGO_BIN_EXE_cognate"));
    let programs = program.parent().expect("a folder").display().to_string();
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = Command::new("sh");
    command.arg("-c").arg(line).current_dir(folder);
    command.env("PATH", format!("{programs}:{path}"));
    command.output().expect("there is a shell")
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a new folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let there = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &there),
            false => drop(std::fs::copy(entry.path(), there).expect("it is readable")),
        }
    }
}

/// The refusal of a mistake, if it lacks something.
fn faults((typed, place, line): &Mistake, folder: &Path) -> Option<String> {
    let output = shell(typed, folder);
    let said = text(&output.stderr);
    let last = said.trim_end().lines().last().unwrap_or_default();
    let to_type = last.split_once("try: ").map(|(_, line)| line);
    let named = place.iter().all(|word| said.contains(word));
    let lines = said.lines().count();
    let is_right = output.status.code() == Some(2)
        && output.stdout.is_empty()
        && named
        && lines <= 14
        && !said.contains("panicked")
        && (to_type.is_some() || last.contains("`cognate "))
        && last.contains(line)
        && to_type.is_none_or(|line| is_understood(line, folder));
    (!is_right).then(|| format!("$ {typed}\n{} {place:?} {line:?}\n{said}\n", output.status))
}

/// Whether the program understands a line that it gave. A line with equations is run; with `--help` no other is refused.
fn is_understood(line: &str, folder: &Path) -> bool {
    let is_ours = line.starts_with("cognate ") && !line.contains(['|', '&', '>', '<']);
    // Words in capitals stand for values.
    let is_value = |word: &str| {
        word.chars()
            .all(|c| c.is_ascii_uppercase() || "|,=".contains(c))
    };
    let is_form = line.ends_with("--help") || line.split(' ').any(is_value);
    if !is_ours || is_form {
        return true;
    }
    let has_equations = ["cognate solve -e", "cognate decompose -e"];
    match has_equations.iter().any(|start| line.starts_with(start)) {
        true => shell(line, folder).status.code() != Some(2),
        false => shell(&format!("{line} --help"), folder).status.success(),
    }
}

fn check(mistakes: &[Mistake]) {
    let right = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in FILES {
        std::fs::write(right.path().join(name), content).expect("it is writable");
    }
    let circle = "cognate decompose -e 'x^2 + y^2 = 1' --output set";
    assert!(shell(circle, right.path()).status.success());
    let fault = |mistake: &Mistake| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        copy(right.path(), folder.path());
        faults(mistake, folder.path())
    };
    let faults: Vec<String> = mistakes.iter().filter_map(fault).collect();
    assert!(
        faults.is_empty(),
        "{} of {}:\n{}",
        faults.len(),
        mistakes.len(),
        faults.join("\n")
    );
}

#[test]
fn equations_and_files_that_are_wrong() {
    check(equations::MISTAKES);
}

#[test]
fn commands_and_options_that_are_wrong() {
    check(options::MISTAKES);
}

#[test]
fn questions_to_components_that_are_wrong() {
    check(components::MISTAKES);
}

#[test]
fn mechanisms_that_are_wrong() {
    check(mechanisms::MISTAKES);
}

#[test]
fn words_to_the_service_that_are_wrong() {
    check(service::MISTAKES);
}

#[test]
fn the_program_alone_shows_five_things_to_type() {
    let output = Command::new(env!("CARGO_BIN_EXE_cognate")).output();
    let output = output.expect("the program starts");
    let said = text(&output.stderr);
    let lines = said.lines().filter(|line| line.starts_with("  cognate "));
    assert_eq!(
        (output.status.code(), lines.count()),
        (Some(2), 5),
        "{said}"
    );
}
