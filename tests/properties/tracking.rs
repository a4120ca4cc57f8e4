//! A path's result is pure: not a function of width, neighbours, chunk or instruction set, and
//! the same bits on every day: a golden hash notices a change of compiler or order of operations.

use cognate_algorithms::plan::StartChoice;
use cognate_algorithms::{Next, PathAlgorithm, PlanOptions, plan};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::stage::PreparedStage;
use cognate_numeric::NUMERICS_REVISION;
use cognate_numeric::lanes::dispatch::InstructionSet;
use cognate_protocol::records;
use cognate_systems::formats;
use cognate_tests::builders::{example, katsura};
use std::path::Path;

/// The first stage of a problem, by seed 7.
fn first_stage(start: StartChoice, text: &str) -> PreparedStage {
    let problem = formats::read("golden", text.as_bytes()).expect("a system");
    let options = PlanOptions {
        start,
        seed: 7,
        ..PlanOptions::default()
    };
    let mut plan = plan(&problem.system, &options).expect("a plan");
    let Next::Open(opening) = plan.algorithm.next() else {
        panic!("a solve begins with a stage");
    };
    PreparedStage::new(&plan.system, &opening.stage, &|_| None).expect("a stage to track")
}

/// Problems by name: regular, multihomogeneous, with paths to infinity and to singular ends,
/// from mixed cells.
fn problems() -> Vec<(&'static str, StartChoice, String)> {
    use StartChoice::{Auto, Polyhedral, TotalDegree};
    let double_root = "variable_group x, y;\nfunction f, g;\nf = (x - 1)^2 + y^3;\ng = x*y - y;";
    vec![
        ("katsura_6", Auto, katsura(6)),
        ("three_rpr", Auto, example("three_rpr.bertini")),
        (
            "stewart_gough",
            Auto,
            example("stewart_gough_dietmaier.bertini"),
        ),
        ("cyclic_5", TotalDegree, example("cyclic_5.bertini")),
        (
            "double_root",
            Auto,
            format!("CONFIG\nEND;\nINPUT\n{double_root}\nEND;\n"),
        ),
        (
            "cyclic_5_polyhedral",
            Polyhedral,
            example("cyclic_5.bertini"),
        ),
    ]
}

/// Enough for every kind of end, few enough for a second.
const ITEMS: u64 = 48;

fn hash(results: &[PathResult]) -> String {
    records::hash(&records::encode(results)).to_string()
}

#[test]
fn results_do_not_depend_on_how_they_are_had() {
    for (name, start, text) in problems() {
        let stage = first_stage(start, &text);
        let end = stage.items().min(ITEMS);
        let expected = stage.track(0..end, 16);
        assert_eq!(expected.len() as u64, end);
        let check = |what: &str, found: Vec<PathResult>| {
            // By their records: an unknown number equals itself.
            assert!(
                hash(&found) == hash(&expected),
                "{name}: {what} changes the results"
            );
        };
        check("width 8", stage.track(0..end, 8));
        check("width 1", stage.track(0..end, 1));
        let one_by_one = (0..end).flat_map(|item| stage.track(item..item + 1, 8));
        check("having no neighbours", one_by_one.collect());
        let mut parts = Vec::new();
        for k in (0..end.div_ceil(5)).rev() {
            parts.push(stage.track(5 * k..(5 * k + 5).min(end), 16));
        }
        parts.reverse();
        check("another order of chunks", parts.concat());
        for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
            check(set.name(), stage.track_on(set, 0..end, 8));
        }
        let again = first_stage(start, &text);
        check("preparing the stage again", again.track(0..end, 16));
    }
}

#[test]
fn chunks_have_their_golden_hashes() {
    let mut found = format!(
        "# Hashes of the first results of a first stage, seed 7; `UPDATE_GOLDEN=1 cargo test` rewrites them.\n\
         # A change here is a change of results: NUMERICS_REVISION in numeric/src/lib.rs must grow with it.\n\
         numerics revision {NUMERICS_REVISION}\n"
    );
    for (name, start, text) in problems() {
        let stage = first_stage(start, &text);
        let end = stage.items().min(ITEMS);
        found += &format!("{name} 0..{end} {}\n", hash(&stage.track(0..end, 8)));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/chunk_hashes.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &found).expect("the golden file can be written");
    }
    let expected = std::fs::read_to_string(&path).expect("the golden file is there");
    assert!(found == expected, "expected\n{expected}\nfound\n{found}");
}
