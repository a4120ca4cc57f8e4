//! Chains of two joints in space through poses that one of them made, as a person types it.

use cognate_tests::cluster::Cluster;
use serde_json::Value;

/// Ten poses with the point (0.5, -0.25, 1) of the body at distance 2 from (1, 1, 0): positions of a ball on a sphere, less the
/// turned point, each turned about an axis by its quaternion (w, x, y, z), to be normalised.
const TURNS: [[f64; 4]; 10] = [
    [1.0, 0.0, 0.0, 0.0],
    [1.0, 0.25, 0.0, -0.125],
    [1.0, -0.5, 0.25, 0.25],
    [0.5, 1.0, 0.25, -0.25],
    [-0.25, 0.5, 1.0, 0.75],
    [0.75, 0.25, -1.0, 0.5],
    [0.25, -0.75, 0.5, 1.0],
    [1.0, 0.75, 0.25, 0.5],
    [-0.5, 0.25, 0.75, -0.25],
    [0.75, -1.0, 0.25, 0.125],
];
/// Directions from the centre to the ball in each pose, to be normalised.
const DIRECTIONS: [[f64; 3]; 10] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.5],
    [-1.0, 0.25, 1.0],
    [0.5, -1.0, 0.25],
    [0.25, 0.5, -1.0],
    [1.0, 1.0, 1.0],
    [-0.5, 0.25, -0.25],
    [0.125, 1.0, -0.5],
    [-1.0, -0.25, 0.5],
    [0.5, 0.125, 0.75],
];
const CENTRE: [f64; 3] = [1.0, 1.0, 0.0];
const BALL: [f64; 3] = [0.5, -0.25, 1.0];
const LENGTH: f64 = 2.0;

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Poses as a table.
fn poses(count: usize) -> String {
    let mut table = String::from("x,y,z,qw,qx,qy,qz\n");
    for (turn, direction) in TURNS.iter().zip(&DIRECTIONS).take(count) {
        let size = length(turn);
        let [w, x, y, z] = turn.map(|c| c / size);
        let rows = [
            [
                1.0 - 2.0 * (y * y + z * z),
                2.0 * (x * y - w * z),
                2.0 * (x * z + w * y),
            ],
            [
                2.0 * (x * y + w * z),
                1.0 - 2.0 * (x * x + z * z),
                2.0 * (y * z - w * x),
            ],
            [
                2.0 * (x * z - w * y),
                2.0 * (y * z + w * x),
                1.0 - 2.0 * (x * x + y * y),
            ],
        ];
        let away = direction.map(|c| c * LENGTH / length(direction));
        let place = (0..3).map(|k| {
            let turned: f64 = (0..3).map(|i| rows[k][i] * BALL[i]).sum();
            CENTRE[k] + away[k] - turned
        });
        let cells = place.chain([w, x, y, z]).map(|c| c.to_string());
        table += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    table
}

/// Numbers of solutions for general poses: Innocenti 1995 (SS), Su, McCarthy and Watson 2004 (CS, and RPS, which has two
/// solutions for each), Bottema and Roth 1979 (the others).
#[test]
fn poses_in_space_have_the_known_numbers_of_chains() {
    let cluster = Cluster::with_workers(2);
    let address = cluster.address();
    let cases = [
        ("SS", 7, 20, 0),
        ("PPS", 6, 10, 0),
        ("CC", 5, 6, 0),
        ("spherical-RR", 5, 6, 1),
        ("CS", 8, 804, 0),
        ("RPS", 10, 2048, 0),
    ];
    for (chain, count, finite, most_pairs) in cases {
        std::fs::write(cluster.folder().join("poses.csv"), poses(count)).unwrap();
        let arguments = [
            "synthesize",
            "spatial-dyads",
            "poses.csv",
            "--chain",
            chain,
            "--coordinator",
            &address,
            "--format",
            "json",
            "--output",
            "kept",
            "--certify",
        ];
        // Proofs of 2048 solutions take longer than the solve.
        let certify = chain != "RPS";
        let output = cluster.command(&arguments[..arguments.len() - usize::from(!certify)]);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{chain}: {errors}");
        let answer: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
        assert_eq!(answer["paths"]["finite"], finite, "{chain}");
        assert_eq!(answer["chain"], chain);
        assert_eq!(answer["settled"], true);
        assert_eq!(answer["solutions"]["complete"], "yes", "{chain}");
        let dyads = answer["dyads"].as_array().expect("a list");
        if chain != "RPS" {
            // Nonreal chains come in pairs.
            assert_eq!(dyads.len() % 2, 0, "{chain}: {dyads:#?}");
        }
        for dyad in dyads {
            assert!(dyad["error"].as_f64() < Some(1e-9), "{chain}: {dyad:#}");
            assert_eq!(dyad["certified"], certify && chain != "CC", "{chain}");
        }
        let linkages = answer["linkages"].as_array().expect("a list");
        let pairs = dyads.len() * dyads.len().saturating_sub(1) / 2;
        assert_eq!(linkages.len(), pairs * most_pairs, "{chain}");
        if chain == "SS" {
            let made = |dyad: &&Value| {
                let near = |part: &Value, expected: [f64; 3]| {
                    let pairs = (0..3).map(|k| (part["point"][k].as_f64(), expected[k]));
                    pairs.fold(true, |is_near, (x, e)| {
                        is_near && x.is_some_and(|x| (x - e).abs() < 1e-9)
                    })
                };
                let ball: [f64; 3] = std::array::from_fn(|k| {
                    CENTRE[k] + DIRECTIONS[0][k] * LENGTH / length(&DIRECTIONS[0])
                });
                near(&dyad["fixed"], CENTRE) && near(&dyad["moving"], ball)
            };
            let dyad = dyads.iter().find(made).expect("the chain of the poses");
            assert!((dyad["distance"].as_f64().unwrap() - LENGTH).abs() < 1e-9);
        }
        for name in ["summary.json", "dyads.csv"] {
            assert!(cluster.folder().join("kept").join(name).is_file(), "{name}");
        }
    }
    // Another number of poses is refused with the number that is needed.
    let output = cluster.command(&[
        "synthesize",
        "spatial-dyads",
        "poses.csv",
        "--chain",
        "SS",
        "--coordinator",
        &address,
    ]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(errors.contains("expected 7 poses, found 10"), "{errors}");
}
