//! Folders of decompositions, read back whole, cut and tampered with.

use super::*;
use crate::output::decomposition::write;
use cognate_algorithms::decomposition::{self, DecompositionSolve};
use cognate_systems::formats;
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

const CURVES: &str = "variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2)*(x + 3*y - 1);";

/// A decomposition as a coordinator gives it.
fn found(text: &str, seed: u64) -> Value {
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    let system = formats::read("test", text.as_bytes()).unwrap().system;
    let options = DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    };
    let solve = DecompositionSolve::new(&system, &options).unwrap();
    let decomposition = decomposition::run_locally(solve, WIDTH).unwrap();
    assert!(decomposition.settled());
    let mut value = serde_json::to_value(&decomposition).unwrap();
    value["seed"] = json!(seed);
    value["system"] = json!(formats::json::write(&system).unwrap());
    value
}

fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "{}", found(text, 3)).unwrap();
    folder
}

/// Error for a folder; empty if there is none.
fn said(folder: &Path) -> String {
    let read = KnownSet::read(folder).and_then(|set| set.check());
    read.err()
        .map(|error| error.to_string())
        .unwrap_or_default()
}

/// Error after a file of the folder was changed; the file is put back.
fn after(folder: &TempDir, file: &str, change: impl Fn(&str) -> String) -> String {
    let path = folder.path().join(file);
    let text = fs::read_to_string(&path).unwrap();
    let changed = change(&text);
    assert_ne!(changed, text);
    fs::write(&path, changed).unwrap();
    let answer = match file {
        "witness_data" => said(&path),
        _ => said(folder.path()),
    };
    fs::write(&path, text).unwrap();
    answer
}

#[test]
fn a_folder_is_read_back() {
    let folder = folder(CURVES);
    assert_eq!(said(folder.path()), "");
    assert_eq!(said(&folder.path().join("decomposition.json")), "");
    let ours = KnownSet::read(folder.path()).unwrap();
    let degrees: Vec<u64> = ours.sets().iter().map(|set| set.degree).collect();
    assert_eq!(degrees, [2, 1, 1]);
    // Bertini's files give an equal set; only points and slices are taken from them.
    let data = folder.path().join("witness_data");
    assert_eq!(said(&data), "");
    let theirs = KnownSet::read(&data).unwrap();
    for (a, b) in ours.sets().iter().zip(theirs.sets()) {
        assert_eq!(
            (&a.points, &a.slice, &a.deflation),
            (&b.points, &b.slice, &b.deflation)
        );
        assert_eq!(a.multiplicity.scheme, b.multiplicity.scheme);
    }
}

#[test]
fn a_component_is_chosen_by_its_name() {
    let folder = folder(CURVES);
    let mut set = KnownSet::read(folder.path()).unwrap();
    let error = set
        .choose(&["2.1".parse().unwrap()])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("no component 2.1") && error.contains("1.1, 1.2, 1.3"),
        "{error}"
    );
    set.choose(&["1.2".parse().unwrap()]).unwrap();
    assert_eq!(set.components.len(), 1);
}

#[test]
fn what_was_changed_is_found_and_named() {
    let folder = folder(CURVES);
    let points = "witness_points.jsonl";
    let line = |text: &str, k: usize| text.lines().nth(k).unwrap().to_owned();
    let without = |text: &str, k: usize| -> String {
        let kept = text.lines().enumerate().filter(|(i, _)| *i != k);
        kept.map(|(_, line)| format!("{line}\n")).collect()
    };
    // A lost point: the degree does not fit.
    let error = after(&folder, points, |text| without(text, 1));
    assert!(
        error.contains("component 1.1 has 1 witness point"),
        "{error}"
    );
    // A cut file.
    let error = after(&folder, points, |text| text[..text.len() - 9].to_owned());
    assert!(error.contains("witness_points.jsonl:4"), "{error}");
    // A wrong digit.
    let error = after(&folder, points, |text| {
        let point_line = line(text, 1);
        let place = point_line.find("[").unwrap() + 5;
        let digit = if &point_line[place..=place] == "7" {
            "1"
        } else {
            "7"
        };
        let changed = format!(
            "{}{digit}{}",
            &point_line[..place],
            &point_line[place + 1..]
        );
        text.replace(&point_line, &changed)
    });
    assert!(
        error.contains("witness_points.jsonl:2") && error.contains("does not lie"),
        "{error}"
    );
    // Points of two components are exchanged.
    let error = after(&folder, points, |text| {
        let (a, b) = (line(text, 0), line(text, 2));
        let swapped = |point_line: &str, other: &str| {
            point_line.replacen(&point_line[14..17], &other[14..17], 1)
        };
        text.replace(&a, &swapped(&a, &b))
            .replace(&b, &swapped(&b, &a))
    });
    assert!(
        error.contains("do not sum to 0") || error.contains("does not lie"),
        "{error}"
    );
    // A point of no component, and of one that is not there.
    let error = after(&folder, points, |text| text.replacen("1.1", "4.1", 1));
    assert!(
        error.contains("jsonl:1: component 4.1 is not in"),
        "{error}"
    );
    let data = "decomposition.json";
    let error = after(&folder, data, |text| {
        text.replacen("\"scheme\": 2", "\"scheme\": 3", 1)
    });
    assert!(
        error.contains("multiplicity 3, but the dual space") && error.contains("dimension 2"),
        "{error}"
    );
    let error = after(&folder, data, |text| {
        text.replacen("\"scheme\": 1", "\"scheme\": 2", 1)
    });
    assert!(error.contains("regular at its points: 1"), "{error}");
    let error = after(&folder, data, |text| text[..text.len() / 2].to_owned());
    assert!(error.contains("decomposition.json:"), "{error}");
    let error = after(&folder, "system.json", |text| text.replacen("3", "4", 1));
    assert!(!error.is_empty());
}

#[test]
fn what_was_changed_in_witness_data_is_found_and_named() {
    let folder = folder(CURVES);
    let error = after(&folder, "witness_data", |text| {
        text[..text.len() / 2].to_owned()
    });
    assert!(error.contains("witness_data:"), "{error}");
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    // The first point's second coordinate, in the line after precision, 1 and x.
    let error = after(&folder, "witness_data", |text| {
        let mut lines = lines(text);
        lines[7] = "0.5 0.25".into();
        lines.join("\n")
    });
    assert!(
        error.contains("witness_data:5") && error.contains("does not lie"),
        "{error}"
    );
    // The component of the first point: its number stands 15 lines below the point's first.
    let error = after(&folder, "witness_data", |text| {
        let mut lines = lines(text);
        assert_eq!(lines[4 + 14], "0");
        lines[4 + 14] = "1".into();
        lines.join("\n")
    });
    let there = error.contains("does not lie") && error.contains("component 1.2");
    assert!(there || error.contains("do not sum to 0"), "{error}");
}
