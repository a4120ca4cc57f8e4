//! A family solved by loops, kept, and solved again from the kept solutions: as a user types it.

use cognate_tests::cluster::Cluster;
use serde_json::Value;
use std::process::Output;

/// Under signs and exchange the 8 solutions are 2 classes of 4.
const FAMILY: &str = r#"{"variables": ["x", "y"], "parameters": ["p", "q", "r"],
    "equations": ["x^4 + p*x^2*y^2 + y^4 - q", "x*y - r"]}"#;
const SYMMETRY: &str =
    r#"[{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "-x", "y": "-y"}}]"#;
/// x^4 + y^4 = 17, x y = 2: (2, 1), (1, 2) and their negatives are real.
const WANTED: &str = r#"{"p": [0, 0], "q": [17, 0], "r": [2, 0]}"#;

fn summary(output: &Output) -> Value {
    let (out, errors) = (&output.stdout, String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{errors}");
    serde_json::from_slice(out).expect("one JSON object, nothing else")
}

#[test]
fn a_family_is_solved_once_and_kept() {
    let cluster = Cluster::with_workers(2);
    for (name, text) in [
        ("family.json", FAMILY),
        ("symmetry.json", SYMMETRY),
        ("wanted.json", WANTED),
    ] {
        std::fs::write(cluster.folder().join(name), text).unwrap();
    }
    // On the cluster.
    let submit = [
        "submit",
        "family.json",
        "--start",
        "monodromy",
        "--symmetry",
        "symmetry.json",
    ];
    let job = cluster.command(&submit);
    let job = String::from_utf8_lossy(&job.stdout).trim().to_string();
    assert_eq!(cluster.command(&["watch", &job]).status.code(), Some(0));
    let results = ["results", &job, "--output", "kept", "--format", "json"];
    let family_summary = summary(&cluster.command(&results));
    assert_eq!(family_summary["problem"]["start"], "monodromy");
    assert_eq!(family_summary["paths"]["total"], 8, "{family_summary:#}");
    assert_eq!(family_summary["solutions"]["nonsingular"], 8);
    let loops = &family_summary["monodromy"]["loops"];
    assert_eq!(
        (&loops["solutions"], &loops["classes"]),
        (&8.into(), &2.into())
    );
    assert_eq!(loops["stop"], "idle-loops");
    assert!(loops["tracked"].as_u64() > Some(20), "{loops:#}");
    assert_eq!(family_summary["classes"]["count"], 2);
    assert_eq!(family_summary["classes"]["complete"], 2);
    let explained = cluster.command(&["explain", &job]);
    let explained = String::from_utf8_lossy(&explained.stdout).into_owned();
    assert!(
        explained.contains("monodromy: 8 solutions in 2 classes"),
        "{explained}"
    );
    // Two classes leave few permutations: loops that stay need not be random ones.
    let estimated = explained.contains("estimate: 2 classes");
    assert!(
        estimated && explained.contains("capture and recapture"),
        "{explained}"
    );

    // From the kept solutions to the wanted parameters, in a solve of its own.
    let target_output = cluster.command(&[
        "solve",
        "family.json",
        "--start-solutions",
        "kept/solutions.points",
        "--start-parameters",
        "kept/parameters.json",
        "--target-parameters",
        "wanted.json",
        "--format",
        "json",
    ]);
    let target_summary = summary(&target_output);
    assert_eq!(
        target_summary["solutions"]["nonsingular"], 8,
        "{target_summary:#}"
    );
    assert_eq!(target_summary["solutions"]["real"], 4);
    assert_eq!(target_summary["monodromy"], Value::Null);
    // Loops that end by an estimate.
    let sure = cluster.command(&[
        "solve",
        "family.json",
        "--start",
        "monodromy",
        "--confidence",
        "0.999",
        "--seed",
        "3",
        "--format",
        "json",
    ]);
    let sure = summary(&sure);
    let loops = &sure["monodromy"]["loops"];
    assert_eq!(
        (&loops["stop"], &loops["solutions"]),
        (&"confidence".into(), &8.into())
    );
    let estimate = &loops["estimate"];
    assert_eq!(estimate["likeliest"], 8, "{loops:#}");
    assert!(estimate["confidence"].as_f64() >= Some(0.999));
    let assumption = estimate["assumption"].as_str().unwrap();
    assert!(assumption.contains("at random"), "{assumption}");
    cluster.stop();
}

#[test]
fn what_does_not_fit_is_refused_with_its_reason() {
    let cluster = Cluster::with_workers(0);
    std::fs::write(cluster.folder().join("family.json"), FAMILY).unwrap();
    for (arguments, reason) in [
        (
            &[
                "solve",
                "family.json",
                "--targets",
                "p=1",
                "--targets",
                "q=1",
                "--targets",
                "r=1",
                "--idle-loops",
                "7",
            ][..],
            "only goes with --start monodromy",
        ),
        (
            &[
                "solve",
                "family.json",
                "--start",
                "monodromy",
                "--confidence",
                "1",
            ],
            "expected a probability between 0 and 1",
        ),
    ] {
        let output = cluster.command(arguments);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(reason), "{errors}");
    }
    cluster.stop();
}
