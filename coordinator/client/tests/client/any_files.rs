//! Files of people and of other programs: any bytes end in a value or an error that names a place.

use cognate_algorithms::any_algorithm::{AnyAlgorithm, AnySolve};
use cognate_algorithms::decomposition::{self, DecompositionOptions, DecompositionSolve};
use cognate_algorithms::plan::plan;
use cognate_algorithms::solve_options::SolveOptions;
use cognate_client::config_file::ConfigFile;
use cognate_client::output::decomposition::write;
use cognate_client::sets::{self, KnownSet};
use cognate_client::synthesis::{point_files, position_files};
use cognate_kinematics::mechanism;
use cognate_kinematics::mechanism::read_options::ReadOptions;
use cognate_solutions::witness::bertini::read_witness_data;
use cognate_systems::formats::{self, FileSettings, Format, degenerate, points, symmetry};
use cognate_systems::system::System;
use cognate_tests::any_bytes::read_any_bytes;
use cognate_worker::transport::tokens::read_tokens;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The files below a folder of this project whose names end so.
fn files(folder: &str, endings: &[&str]) -> Vec<Vec<u8>> {
    let mut folders = vec![root().join(folder)];
    let mut paths = Vec::new();
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{folder:?}: {e}"));
        for entry in entries.flatten() {
            let (path, name) = (entry.path(), entry.file_name());
            if path.is_dir() {
                folders.push(path);
            } else if endings.iter().any(|e| name.to_string_lossy().ends_with(e)) {
                paths.push(path);
            }
        }
    }
    paths.sort();
    let read = |path: PathBuf| std::fs::read(path).expect("it is readable");
    let small = paths
        .into_iter()
        .map(read)
        .filter(|file| file.len() < 32 << 10);
    small.collect()
}

fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

fn system(file: &str) -> System {
    let content = std::fs::read(root().join("deploy/examples").join(file)).expect("an example");
    formats::read(file, &content)
        .expect("examples are good")
        .system
}

/// Every error about a file names it.
fn named<T, E: std::fmt::Display>(read: Result<T, E>) -> bool {
    if let Err(error) = &read {
        let said = error.to_string();
        assert!(said.contains("FILE"), "{said}");
    }
    read.is_ok()
}

#[test]
fn systems_of_every_notation() {
    let mut good = files("tests/systems", &[".bertini", ".phc"]);
    good.extend(files("deploy/examples", &[".bertini", ".json"]));
    for file in ["cyclic_5.bertini", "four_bar.bertini", "noon_5.bertini"] {
        let system = system(file);
        for format in Format::ALL {
            let written = formats::write(format, &system, &FileSettings::default());
            good.extend(written.ok().map(String::into_bytes));
        }
    }
    read_any_bytes("problem_file", &good, |bytes| {
        named(formats::read("FILE", bytes))
    });
}

#[test]
fn files_beside_a_system() {
    let nine_point = system("nine_point.json");
    let good = files("deploy/examples", &["start.jsonl", "parameters.json"]);
    read_any_bytes("solutions_file", &good, |bytes| {
        named(points::read_solutions("FILE", bytes, &nine_point.variables))
    });
    read_any_bytes("parameters_file", &good, |bytes| {
        named(points::read_parameters(
            "FILE",
            bytes,
            &nine_point.parameters,
        ))
    });
    let good = files("deploy/examples", &["symmetry.json"]);
    read_any_bytes("symmetry_file", &good, |bytes| {
        named(symmetry::read("FILE", bytes, &mut nine_point.clone()))
    });
    let good = texts(&[
        r#"{"flat": {"nonzero": "x*Y - a"}}"#,
        r#"{"one": {"equations": ["x", "y - a"]}, "two": {"nonzero": "b^2"}}"#,
    ]);
    read_any_bytes("degenerate_file", &good, |bytes| {
        named(degenerate::read("FILE", bytes, &mut nine_point.clone()))
    });
    let noon = system("noon_5.bertini");
    let good = files("deploy/examples", &["sets.json"]);
    read_any_bytes("sets_file", &good, |bytes| {
        named(formats::sets::read("FILE", bytes, &noon))
    });
}

#[test]
fn mechanisms() {
    let mut good = files("tests/mechanisms", &[".urdf", ".csv", ".toml", ".json"]);
    good.extend(files("deploy/examples", &[".toml", "arm_6r.json"]));
    good.extend(texts(&[
        "type,theta,d,a,alpha,name\nrevolute,0,0.4,0.025,pi/2,one\nprismatic,30,0,0.5,-90,\n",
    ]));
    read_any_bytes("mechanism_file", &good, |bytes| {
        named(mechanism::read::read(
            "FILE",
            bytes,
            &ReadOptions::default(),
        ))
    });
}

#[test]
fn points_and_positions() {
    let good = files("deploy/examples", &[".csv"]);
    read_any_bytes("points_file", &good, |bytes| {
        let (one, many) = (
            point_files::read("FILE", bytes).is_ok(),
            point_files::read_many("FILE", bytes).is_ok(),
        );
        one || many
    });
    let good = files("deploy/examples", &[".csv", "pairs.json"]);
    read_any_bytes("positions_file", &good, |bytes| {
        [
            position_files::read_poses("FILE", bytes).is_ok(),
            position_files::read_timed_points("FILE", bytes).is_ok(),
            position_files::read_angles("FILE", bytes).is_ok(),
            position_files::read_poses_and_points("FILE", bytes).is_ok(),
        ]
        .contains(&true)
    });
}

/// A file of a folder that is written anew for each input.
struct Written {
    folder: tempfile::TempDir,
    name: &'static str,
}

impl Written {
    fn new(name: &'static str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        Self { folder, name }
    }

    fn with(&self, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(self.name);
        std::fs::write(&path, bytes).expect("there is room");
        path
    }
}

#[test]
fn tokens_and_settings() {
    let good = texts(&[
        "client 0123456789abcdef0123 name=ada tenant=gears jobs=20 paths=1000 bytes=5000 calls=5\n\
         worker abcdef0123456789abcd name=rack-1 # a comment\n0123456789abcdef\n",
    ]);
    let file = Written::new("FILE");
    read_any_bytes("token_file", &good, |bytes| {
        named(read_tokens(&file.with(bytes)))
    });
    let good = files("deploy/config", &[".toml"]);
    read_any_bytes("config_file", &good, |bytes| {
        let read = ConfigFile::read(&file.with(bytes));
        let rules = read.as_ref().ok().map(|config| config.rules().is_ok());
        named(read) && rules == Some(true)
    });
}

#[test]
fn sets_of_components() {
    const CURVES: &[u8] = b"variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2);";
    let curves = formats::read("curves", CURVES).expect("it is good").system;
    let solve = DecompositionSolve::new(&curves, &DecompositionOptions::default());
    let decomposition = decomposition::run_locally(solve.expect("it can be decomposed"), 8);
    let mut value = serde_json::to_value(decomposition.expect("it is")).expect("it is JSON");
    value["seed"] = 1.into();
    value["system"] = formats::json::write(&curves)
        .expect("it can be written")
        .into();
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "{}", value).expect("there is room");
    for name in [
        "decomposition.json",
        "witness_points.jsonl",
        "system.json",
        "witness_data",
    ] {
        let path = folder.path().join(name);
        let good = std::fs::read(&path).expect("it was written");
        let asked = match name {
            "witness_data" => path.clone(),
            _ => folder.path().to_owned(),
        };
        read_any_bytes(name, std::slice::from_ref(&good), |bytes| {
            std::fs::write(&path, bytes).expect("there is room");
            let read = KnownSet::read(&asked);
            read.is_ok_and(|set| set.check().is_ok())
        });
        std::fs::write(&path, good).expect("there is room");
    }
    let data = std::fs::read(folder.path().join("witness_data")).expect("it was written");
    read_any_bytes("witness_data_text", &[data], |bytes| {
        std::str::from_utf8(bytes).is_ok_and(|text| read_witness_data(text, 2).is_ok())
    });
    let good = texts(&[
        "x,y\n1,2\n3/5,0.25+1.5i\n",
        r#"[{"x": 1, "y": "3/5"}]"#,
        "{\"x\": [1, 2], \"y\": 0}\n",
    ]);
    let file = Written::new("FILE");
    read_any_bytes("question_points", &good, |bytes| {
        sets::points::read(&file.with(bytes), &curves.variables, None).is_ok()
    });
}

#[test]
fn states_of_algorithms() {
    let states = [
        "cyclic_5.bertini",
        "noon_5.bertini",
        "stewart_gough_dietmaier.bertini",
    ]
    .map(|file| {
        let plan = plan(&system(file), &SolveOptions::default());
        plan.expect("examples have plans").algorithm.snapshot()
    });
    let system = system("noon_5.bertini");
    let decomposition = DecompositionSolve::new(&system, &DecompositionOptions::default());
    let decomposition = AnySolve::Decomposition(Box::new(decomposition.expect("a solve")));
    let decomposition = AnyAlgorithm::from(decomposition).snapshot();
    let states = [&states[..], &[decomposition]].concat();
    read_any_bytes("state", &states, |bytes| {
        AnyAlgorithm::restore(bytes).is_ok()
    });
}
