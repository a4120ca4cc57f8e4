//! From five points with the crank's angles, from five pairs of angles, and from poses and points mixed,
//! to every four-bar linkage, as a person types it.

use cognate_tests::builders::example;
use cognate_tests::cluster::Cluster;
use serde_json::Value;

/// Runs one synthesis of an example file; its JSON.
fn synthesize(cluster: &Cluster, what: &str, file: &str, more: &[&str]) -> Value {
    std::fs::write(cluster.folder().join(file), example(file)).unwrap();
    let address = cluster.address();
    let mut arguments = vec!["synthesize", what, file, "--coordinator", &address];
    arguments.extend(["--format", "json"]);
    arguments.extend(more);
    let output = cluster.command(&arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The lengths of the example's linkage: ground, crank, coupler, rocker.
const MADE_OF: [f64; 4] = [4.0, 1.5, 4.0, 3.0];

/// The linkage that drew the example, whichever side is named first.
fn drawn_by(linkages: &[Value]) -> &Value {
    let made = linkages.iter().find(|linkage| {
        let lengths = &linkage["lengths"];
        let mut sides = [0, 1].map(|side| number(&lengths["sides"][side]));
        sides.sort_by(f64::total_cmp);
        let side_lengths = [
            number(&lengths["ground"]),
            sides[0],
            number(&lengths["coupler"]),
            sides[1],
        ];
        let pairs = side_lengths.iter().zip(MADE_OF);
        pairs
            .into_iter()
            .all(|(side_length, length)| (side_length - length).abs() < 1e-7)
    });
    made.unwrap_or_else(|| panic!("it is not among {linkages:#?}"))
}

#[test]
fn the_linkage_that_drew_poses_and_points_is_among_the_answers() {
    let cluster = Cluster::with_workers(2);
    let file = "three_poses_four_points.csv";
    let more = ["--certify", "--output", "kept"];
    let synthesis = synthesize(&cluster, "poses-and-points", file, &more);
    // 402 solutions for generic ones (Brake, Hauenstein, Murray, Myszka, Wampler 2016): 201 linkages,
    // each with its dyads in either order.
    let paths = &synthesis["paths"];
    assert_eq!(
        (&paths["total"], &paths["failed"]),
        (&1536.into(), &0.into()),
        "{paths:#}"
    );
    assert_eq!(
        synthesis["solutions"]["nonsingular"], 402,
        "{:#}",
        synthesis["solutions"]
    );
    let linkages = synthesis["linkages"].as_array().expect("a list");
    let real = number(&synthesis["solutions"]["real"]);
    assert_eq!(
        2.0 * linkages.len() as f64,
        real,
        "each real pair is one linkage"
    );
    for linkage in linkages {
        assert!(number(&linkage["error"]) < 1e-6, "{linkage:#}");
    }
    let made = drawn_by(linkages);
    assert_eq!(made["grade"], "in-order", "{made:#}");
    assert!(cluster.folder().join("kept/linkages.html").is_file());
    // Too few points for these poses: refused with the numbers that there may be.
    let whole = example(file);
    let short: Vec<&str> = whole.lines().take(6).collect();
    std::fs::write(cluster.folder().join("short.csv"), short.join("\n")).unwrap();
    let output = cluster.command(&["synthesize", "poses-and-points", "short.csv"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("expected 2, 3 or 4 poses with 6, 4 or 2 points"),
        "{errors}"
    );
}

#[test]
fn the_linkage_that_drew_five_timed_points_is_among_the_answers() {
    let cluster = Cluster::with_workers(2);
    let more = ["--certify", "--output", "kept"];
    let synthesis = synthesize(&cluster, "path-timing", "five_timed_points.csv", &more);
    // Four drivers (survey, section 4); what is real of them has a round of its own.
    assert_eq!(synthesis["paths"]["finite"], 4, "{:#}", synthesis["paths"]);
    let rounds = synthesis["rounds"].as_array().expect("a list");
    for round in &rounds[1..] {
        assert_eq!(round["paths"]["finite"], 4, "{round:#}");
    }
    let dyads = synthesis["dyads"].as_array().expect("a list");
    let drivers = rounds.len() - 1;
    assert!((1..=4).contains(&drivers), "{synthesis:#}");
    assert!(
        dyads[..drivers]
            .iter()
            .all(|dyad| dyad["certified"] == true)
    );
    let linkages = synthesis["linkages"].as_array().expect("a list");
    assert_eq!(
        linkages.len(),
        dyads.len() - drivers,
        "a partner makes one linkage"
    );
    assert!(linkages.len() <= 3 * drivers);
    for linkage in linkages {
        assert!(number(&linkage["error"]) < 1e-8, "{linkage:#}");
        assert_eq!(linkage["driver"], 0, "the crank drives");
    }
    let made = drawn_by(linkages);
    assert_eq!(
        (&made["grade"], &made["type"]),
        (&"in-order".into(), &"crank-rocker".into())
    );
    for name in ["summary.json", "linkages.csv", "linkages.html"] {
        assert!(cluster.folder().join("kept").join(name).is_file(), "{name}");
    }
}

#[test]
fn five_pairs_of_angles_have_three_linkages() {
    let cluster = Cluster::with_workers(1);
    let synthesis = synthesize(
        &cluster,
        "function-generation",
        "five_angle_pairs.json",
        &["--output", "kept"],
    );
    // Three linkages and the root 0, computed by PHCpack and by Bertini 2: |z1| and |z2|.
    assert_eq!(synthesis["paths"]["finite"], 4, "{:#}", synthesis["paths"]);
    let expected = [
        [0.558_773_525_689, 0.389_969_661_934],
        [0.044_785_131_855, 0.040_169_415_236],
        [0.505_691_697_432, 0.624_760_228_278],
    ];
    let linkages = synthesis["linkages"].as_array().expect("a list");
    assert_eq!(linkages.len(), 3);
    for sides in expected {
        let near = |linkage: &&Value| {
            let linkage_sides = &linkage["lengths"]["sides"];
            (0..2).all(|k| (number(&linkage_sides[k]) - sides[k]).abs() < 1e-9)
        };
        assert!(
            linkages.iter().any(|linkage| near(&linkage)),
            "{sides:?}: {linkages:#?}"
        );
    }
    for linkage in linkages {
        assert!(number(&linkage["error"]) < 1e-9, "{linkage:#}");
        assert_eq!(linkage["driver"], 0, "the input drives");
    }
    // A mistake is named by its place, before anything starts.
    let wrong = example("five_angle_pairs.json").replace("0.28, -0.96", "\"x\", 1");
    std::fs::write(cluster.folder().join("wrong.json"), wrong).unwrap();
    let output = cluster.command(&["synthesize", "function-generation", "wrong.json"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("angles[4]: expected [input, output]"),
        "{errors}"
    );
}
