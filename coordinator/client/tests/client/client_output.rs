//! Output of the client, compared with files that a person can read: tests/golden/client_output. UPDATE_GOLDEN=1
//! rewrites them.

use cognate_algorithms::start_costs::StartCosts;
use cognate_client::commands::{info, jobs, workers};
use cognate_client::output::listed::{Listed, WantedCounts};
use cognate_client::output::text::Look;
use cognate_client::output::{decomposition, summary, table};
use cognate_protocol::v1;
use cognate_solutions::solution::Solution;
use cognate_summary::decomposition::DecompositionSummary;
use num_complex::Complex64;
use std::path::PathBuf;

/// Compares with the golden file, or rewrites it.
fn check(name: &str, shown: &str) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/golden/client_output")
        .join(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, shown).expect("the golden folder is writable");
        return;
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        shown == expected,
        "{name} differs from the golden file (UPDATE_GOLDEN=1 rewrites it):\n{shown}\n--- expected\n{expected}"
    );
}

/// Checks that no line is wider than the terminal, at either width.
fn check_widths(name: &str, render: impl Fn(Look) -> String) {
    for width in [80, 120] {
        let shown = render(Look {
            width,
            color: false,
        });
        for line in shown.lines() {
            assert!(line.chars().count() <= width, "wider than {width}: {line}");
        }
        check(&format!("{name}_{width}.txt"), &shown);
    }
}

const PLATFORM: &str = r#"{
  "job": "01j9", "settled": true, "failures": {},
  "problem": {"name": "stewart_gough.bertini", "digest": "5f0c", "variables": 8, "equations": 7, "start": "total-degree", "seed": 42},
  "paths": {"total": 128, "finite": 40, "singular": 0, "positive_dimensional": 88, "excess": 0, "at_infinity": 0,
            "failed": 0, "retracked": 3, "crossings_found": 1, "crossings_resolved": 1, "decided_by_precision_limit": 0,
            "by_precision": {"53": 126, "106": 2}, "highest_precision_bits": 106},
  "solutions": {"distinct": 40, "nonsingular": 40, "singular": 0, "real": 40, "real_reason": null,
                "with_multiplicity": 40, "certified": null, "positive_dimensional": true, "degenerate": {"no pose": 0}},
  "classes": {"count": null, "group_order": null, "complete": null},
  "time": {"wall_seconds": 0.41, "cpu_seconds": 0.63, "tracking_cpu_seconds": 0.30, "paths_per_second": 312.0},
  "workers": [{"id": "worker-1", "paths": 64, "transport": "grpc"}, {"id": "worker-2", "paths": 64, "transport": "grpc"}],
  "warnings": []
}"#;

const UNSETTLED: &str = r#"{
  "job": "01j9", "settled": false, "failures": {},
  "problem": {"name": "nine_point.bertini", "digest": "aa", "variables": 10, "equations": 10, "start": "multihomogeneous", "seed": 7},
  "paths": {"total": 143360, "finite": 8652, "singular": 16, "undecided": 4, "positive_dimensional": 0, "excess": 0,
            "at_infinity": 134685, "failed": 3, "retracked": 1200, "crossings_found": 4, "crossings_resolved": 3,
            "decided_by_precision_limit": 2, "by_precision": {"53": 143360}, "highest_precision_bits": 53},
  "solutions": {"distinct": 8656, "nonsingular": 8652, "singular": 4, "undecided": 1, "real": null,
                "real_reason": "the system is not invariant under complex conjugation; name conjugate variables with --conjugates",
                "with_multiplicity": 8668, "certified": null, "positive_dimensional": null, "degenerate": {}},
  "classes": {"count": null, "group_order": null, "complete": null},
  "time": {"wall_seconds": 7300.0, "cpu_seconds": 29000.0, "tracking_cpu_seconds": 28000.0, "paths_per_second": 19.6},
  "workers": [{"id": "7c2e2a0e-6a1f-4b7e-9a53-0c1d5c1f0a11", "paths": 143360, "transport": "grpc"}],
  "warnings": ["whether 1 singular point, at which 4 paths end, is isolated is not decided: if not, no solution but a positive-dimensional set is there"],
  "a field of a newer service": 1
}"#;

fn real_row(seed: u32) -> Solution {
    let value = |v: u32| f64::from((seed * 37 + v * 101) % 199) / 99.0 - 1.0;
    Solution {
        variables: ["x0", "x1", "x2", "x3", "y0", "y1", "y2", "y3"]
            .iter()
            .zip(0..)
            .map(|(name, v)| (name.to_string(), Complex64::new(value(v), 1e-16)))
            .collect(),
        multiplicity: 1,
        cycles: vec![1],
        precision_bits: 53,
        class: None,
        paths: vec![u64::from(seed)],
        certificate: None,
        deflations: None,
        undecided: false,
        real: Some(true),
        singular: false,
        residual: 1e-16,
        condition: 35.0 + f64::from(seed),
        accuracy: 1e-15,
    }
}

fn listed(solution: Solution) -> Listed {
    Listed {
        solution,
        target: None,
        verdict: None,
        critical: None,
    }
}

#[test]
fn a_settled_answer() {
    let answer = summary::read(PLATFORM).expect("a summary");
    let rows: Vec<Listed> = (0..8).map(|seed| listed(real_row(seed))).collect();
    check_widths("settled", |look| {
        table::summary(&answer, &rows, &WantedCounts::default(), None, look)
    });
    assert!(summary::open_questions(&answer).is_empty());
}

#[test]
fn an_answer_with_open_questions() {
    let answer = summary::read(UNSETTLED).expect("a summary with undecided classes");
    let mut row = real_row(1);
    row.real = None;
    row.singular = true;
    row.undecided = true;
    row.multiplicity = 4;
    row.variables.0[1].value.im = -0.5;
    row.condition = f64::INFINITY;
    let rows = [listed(row)];
    check_widths("unsettled", |look| {
        let wanted = WantedCounts::default();
        table::summary(&answer, &rows, &wanted, Some("answer".as_ref()), look)
    });
    assert_eq!(summary::exit(&answer) as u8, 1);
    assert_eq!(summary::open_questions(&answer).len(), 4);
}

const DECOMPOSED: &str = r#"{
  "job": "", "settled": @settled@,
  "problem": {"name": "nid_illustrative.bertini", "digest": "5f0c", "variables": 3, "equations": 3, "method": "cascade", "seed": 42},
  "decomposition": {"settled": @settled@, "asked": [0, 2], "components": [
    {"id": "2.1", "dimension": 2, "degree": 2, "count": 1, "multiplicity": 1, "tracked_multiplicity": 1, "irreducible": "yes",
     "deflation": [], "multidegree": null, "self_conjugate": null, "certified": null,
     "evidence": {"trace_deviation": 3e-31, "noise": 1e-28, "smallest_wrong_union": 0.62, "loops": 0, "precision_bits": 106,
                  "rank_gap": null, "worst_condition": 12.0, "doubts": []}},
    {"id": "1.1", "dimension": 1, "degree": 3, "count": 1, "multiplicity": null, "tracked_multiplicity": 2, "irreducible": "unsettled",
     "deflation": [1], "multidegree": null, "self_conjugate": null, "certified": null,
     "evidence": {"trace_deviation": 0.04, "noise": 1e-28, "smallest_wrong_union": 0.02, "loops": 24, "precision_bits": 106,
                  "rank_gap": null, "worst_condition": 40.0, "doubts": [{"kind": "open", "classes": 3}, {"kind": "multiplicity"}]}},
    {"id": "0.1", "dimension": 0, "degree": 1, "count": 1208, "multiplicity": 1, "tracked_multiplicity": 1, "irreducible": "yes",
     "deflation": [], "multidegree": null, "self_conjugate": null, "certified": null,
     "evidence": {"trace_deviation": null, "noise": null, "smallest_wrong_union": null, "loops": 0, "precision_bits": null,
                  "rank_gap": null, "worst_condition": 7.0, "doubts": []}}],
   "by_dimension": {
     "0": {"components": 1208, "degree": 1208, "superset": 1220, "junk": 12, "excess": 3, "failed": 0, "complete": "yes", "doubts": []},
     "1": {"components": 1, "degree": 3, "superset": 6, "junk": 0, "excess": 0, "failed": 2, "complete": "no",
           "doubts": [{"kind": "points_missing"}, {"kind": "failed_paths", "paths": 2}]},
     "2": {"components": 1, "degree": 2, "superset": 2, "junk": 0, "excess": 0, "failed": 0, "complete": "yes", "doubts": []}},
   "embedded": "not searched", "unsettled": @doubts@},
  "paths": {"total": 1520, "failed": 2, "retracked": 7, "crossings_found": 1, "crossings_resolved": 1,
            "loops": {"total": 72, "failed": 1, "retracked": 0, "crossings_found": 0, "crossings_resolved": 0}},
  "time": {"wall_seconds": 0.41, "cpu_seconds": 0.63, "tracking_cpu_seconds": 0.63, "paths_per_second": 3880.0},
  "workers": [], "warnings": ["ParameterHomotopy: 1: solved at random parameters"]
}"#;

#[test]
fn components_by_dimension() {
    let doubts = r#"["dimension 1: second derivatives do not sum to 0: witness points are missing",
        "dimension 1: 2 paths failed that may have ended here",
        "component 1.1: 3 classes of witness points that loops did not bring together"]"#;
    for (name, settled, doubts) in [
        ("decomposition", "true", "[]"),
        ("decomposition_unsettled", "false", doubts),
    ] {
        let json = DECOMPOSED
            .replace("@settled@", settled)
            .replace("@doubts@", doubts);
        let answer: DecompositionSummary = serde_json::from_str(&json).expect("a summary");
        check_widths(name, |look| {
            decomposition::table(&answer, (settled == "false").then(|| "here".as_ref()), look)
        });
        let exit = decomposition::exit(&answer) as u8;
        assert_eq!(exit, u8::from(settled == "false"));
    }
}

fn read(file: &str) -> cognate_systems::formats::Problem {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../deploy/examples")
        .join(file);
    let content = std::fs::read(&path).expect("the example is there");
    cognate_systems::formats::read(file, &content).expect("the example is well formed")
}

#[test]
fn what_a_file_holds() {
    for file in ["three_rpr.bertini", "stewart_gough_dietmaier.bertini"] {
        let problem = read(file);
        let costs = StartCosts::of(&problem.system).expect("the example is polynomial");
        let name = format!("info_{}", file.trim_end_matches(".bertini"));
        check_widths(&name, |look| info::table(file, &problem, &costs, look));
    }
}

#[test]
fn lists_of_jobs_and_workers() {
    let job = |job: &str, name: &str, state: v1::JobState, done, total, age: i64| v1::JobOverview {
        job: job.into(),
        name: name.into(),
        state: state.into(),
        submitted_unix_ms: (1_000_000 - age) * 1000,
        items_accepted: done,
        items_total: total,
        ..Default::default()
    };
    let jobs = [
        job(
            "01j9",
            "nine_point.bertini",
            v1::JobState::Running,
            81_000,
            143_360,
            95,
        ),
        job(
            "01j8",
            "a_system_with_a_name_that_is_much_too_long_for_a_table.bertini",
            v1::JobState::Solved,
            128,
            128,
            4_000,
        ),
        job("01j7", "", v1::JobState::Cancelled, 0, 16, 400_000),
        // The ledger's clock may be a little ahead of ours.
        job("01j6", "x.phc", v1::JobState::Queued, 0, 0, -1),
    ];
    check_widths("jobs", |look| jobs::table(&jobs, 1e6, look));
    let worker = |worker: &str, chunks, refused: &str| v1::WorkerOverview {
        worker: worker.into(),
        host: "node-17".into(),
        threads: 16,
        lane_width: 16,
        instruction_set: "avx512".into(),
        transport: "grpc".into(),
        idle_seconds: 3.2,
        leased_chunks: chunks,
        accepted_chunks: 12,
        accepted_paths: 48_000,
        refused: refused.into(),
        ..Default::default()
    };
    let workers = [
        worker("node-17-4711", 2, ""),
        worker("node-18-4712", 0, ""),
        worker("node-19-4713", 0, "numerics revision 1; this service has 2"),
    ];
    check_widths("workers", |look| workers::table(&workers, look));
}
