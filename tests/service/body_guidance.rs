//! From five poses of a body to every four-bar linkage that guides it, as a person types it.

use cognate_tests::builders::example;
use cognate_tests::cluster::Cluster;
use serde_json::Value;

/// Pivots and joints of the four dyads, computed by PHCpack and by Bertini 2.
const DYADS: [[f64; 4]; 4] = [
    [
        -0.9773805232962519,
        -0.9395441382973349,
        0.9433702612242476,
        -0.2892432167330635,
    ],
    [
        1.7099570913779074,
        -0.7498079967480109,
        -1.2559218745800964,
        2.6444887972676034,
    ],
    [
        0.40646810924459603,
        -4.252218780248218,
        -3.104425681162751,
        -1.9747288399765734,
    ],
    [
        0.049019040277046344,
        -1.400565832732699,
        -0.35266398790553233,
        0.33127658814121197,
    ],
];

#[test]
fn five_poses_have_four_dyads_and_six_linkages() {
    let cluster = Cluster::with_workers(2);
    std::fs::write(
        cluster.folder().join("poses.csv"),
        example("five_poses.csv"),
    )
    .unwrap();
    let address = cluster.address();
    let arguments = [
        "synthesize",
        "body-guidance",
        "poses.csv",
        "--coordinator",
        &address,
        "--format",
        "json",
        "--certify",
        "--output",
        "kept",
    ];
    let output = cluster.command(&arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    let synthesis: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let paths = &synthesis["paths"];
    assert_eq!(
        (&paths["finite"], &paths["at_infinity"]),
        (&4.into(), &2.into()),
        "{paths:#}"
    );
    let dyads = synthesis["dyads"].as_array().expect("a list");
    assert_eq!(dyads.len(), 4);
    for expected in DYADS {
        let near = |dyad: &&Value| {
            let ends = [
                &dyad["pivot"][0],
                &dyad["pivot"][1],
                &dyad["joint"][0],
                &dyad["joint"][1],
            ];
            ends.iter()
                .zip(expected)
                .all(|(z, e)| z.as_f64().is_some_and(|z| (z - e).abs() < 1e-9))
        };
        let dyad = dyads.iter().find(near);
        let dyad = dyad.unwrap_or_else(|| panic!("{expected:?} is not among {dyads:#?}"));
        assert_eq!(dyad["certified"], true);
    }
    let linkages = synthesis["linkages"].as_array().expect("a list");
    assert_eq!(linkages.len(), 6, "every pair of four");
    for linkage in linkages {
        assert!(linkage["error"].as_f64() < Some(1e-9), "{linkage:#}");
    }
    for name in ["summary.json", "linkages.csv", "linkages.html", "dxf/6.dxf"] {
        assert!(cluster.folder().join("kept").join(name).is_file(), "{name}");
    }
    // Two equal poses are refused by their lines.
    let twice = example("five_poses.csv").replace("-1.02,-2.64,11.421186274999286", "0,0,360");
    std::fs::write(cluster.folder().join("poses.csv"), twice).unwrap();
    let output = cluster.command(&arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("line 3 and line 7: poses 1 and 5 are the same"),
        "{errors}"
    );
}
