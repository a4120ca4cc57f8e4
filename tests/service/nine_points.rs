//! From nine points to every four-bar linkage, as a person types it.

use cognate_numeric::random::{Purpose, RandomStream};
use cognate_tests::cluster::Cluster;
use num_complex::Complex64;
use serde_json::Value;
use std::process::Output;

fn json(output: &Output) -> Value {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    serde_json::from_slice(&output.stdout).expect("one JSON object, nothing else")
}

fn synthesize(cluster: &Cluster, file: &str, more: &[&str]) -> Output {
    let address = cluster.address();
    let mut arguments = vec!["synthesize", "nine-point", file, "--coordinator", &address];
    arguments.extend(more);
    cluster.command(&arguments)
}

/// Every class is in one place.
fn check_classes(sheet: &Value) {
    let classes = &sheet["classes"];
    let ends = ["finite", "multiple", "degenerate", "at_infinity", "failed"];
    let sum: u64 = ends.iter().filter_map(|end| classes[end].as_u64()).sum();
    assert_eq!(
        (sum, classes["count"].as_u64()),
        (1442, Some(1442)),
        "{classes:#}"
    );
    assert_eq!(classes["failed"], 0, "{classes:#}");
}

fn place(value: &Value) -> Complex64 {
    let part = |k: usize| value[k].as_f64().expect("a coordinate");
    Complex64::new(part(0), part(1))
}

fn linkages(sheet: &Value) -> impl Iterator<Item = &Value> {
    let curves = sheet["curves"].as_array().expect("a list").iter();
    curves.flat_map(|curve| curve["linkages"].as_array().expect("a list"))
}

/// A random linkage by pivots and joints, and nine points of its coupler curve, the first where
/// it stands.
struct FourBar {
    pivots: [Complex64; 2],
    joints: [Complex64; 2],
    points: Vec<Complex64>,
}

fn size(z: Complex64) -> f64 {
    z.norm_sqr().sqrt()
}

fn random_four_bar(seed: u64) -> FourBar {
    let mut random = RandomStream::new(seed, Purpose::Test, 77);
    let pivots = [random.disc(), random.disc() * 2.0];
    let joints = [
        pivots[0] + random.disc() * 1.5,
        pivots[1] + random.disc() * 2.0,
    ];
    let point = joints[0] + random.disc() * 2.0;
    let shape = (point - joints[0]) / (joints[1] - joints[0]);
    let (side, held) = (size(joints[0] - pivots[0]), size(joints[1] - pivots[1]));
    let coupler = size(joints[1] - joints[0]);
    let mut points = vec![point];
    while points.len() < 9 {
        let joint = pivots[0] + random.unit() * side;
        let way = pivots[1] - joint;
        let distance = size(way);
        let along = (distance * distance + coupler * coupler - held * held) / (2.0 * distance);
        let across = (coupler * coupler - along * along).sqrt();
        let sign = if random.bits() & 1 == 1 { 1.0 } else { -1.0 };
        let turned = way / distance * Complex64::new(along, sign * across);
        let point = joint + turned * shape;
        // Points that nearly coincide make a problem of their own, which takes many digits.
        let apart = points.iter().all(|&p| size(p - point) > 0.1);
        if !across.is_nan() && apart {
            points.push(point);
        }
    }
    FourBar {
        pivots,
        joints,
        points,
    }
}

/// Roberts: the third pivot, c = (b x - a y)/(x - y) from the coupler point.
fn third_pivot(bar: &FourBar) -> Complex64 {
    let p = bar.points[0];
    let [a, b] = bar.pivots.map(|z| z - p);
    let [x, y] = bar.joints.map(|z| z - p);
    p + (b * x - a * y) / (x - y)
}

#[test]
fn a_four_bar_and_its_cognates_are_among_the_answers_ten_times_of_ten() {
    let cluster = Cluster::with_workers(2);
    for seed in 0..10 {
        let bar = random_four_bar(seed);
        // Any units: millimetres and light years.
        let unit = [1.0, 1e-3, 1e16][seed as usize % 3];
        let rows = bar
            .points
            .iter()
            .map(|p| format!("{:?},{:?}\n", p.re * unit, p.im * unit));
        let text = format!("x,y\n{}", rows.collect::<String>());
        std::fs::write(cluster.folder().join("points.csv"), text).unwrap();
        let sheet = json(&synthesize(&cluster, "points.csv", &["--format", "json"]));
        check_classes(&sheet);
        let extent = bar
            .pivots
            .iter()
            .chain(&bar.joints)
            .map(|&z| size(z))
            .fold(1.0, f64::max);
        let near = |z: Complex64, w: Complex64| size(z / unit - w) < 1e-5 * extent;
        let itself = linkages(&sheet).find(|linkage| {
            let (pivots, joints) = (&linkage["pivots"], &linkage["joints"]);
            [[0, 1], [1, 0]].iter().any(|sides| {
                (0..2).all(|k| {
                    near(place(&pivots[sides[k]]), bar.pivots[k])
                        && near(place(&joints[sides[k]]), bar.joints[k])
                })
            })
        });
        let itself = itself.unwrap_or_else(|| panic!("seed {seed}: it is not among the answers"));
        // The cognates of the linkage stand beside it: together they have three pivots, each on two of them.
        let name = itself["name"].as_str().expect("a name");
        let curve: usize = name
            .trim_end_matches(char::is_alphabetic)
            .parse()
            .expect("a number");
        let family = &sheet["curves"][curve - 1]["linkages"];
        assert_eq!(family.as_array().map(Vec::len), Some(3), "seed {seed}");
        let third = third_pivot(&bar);
        for pivot in bar.pivots.into_iter().chain([third]) {
            let scale = size(pivot).max(extent);
            let on = family.as_array().into_iter().flatten().filter(|linkage| {
                (0..2).any(|k| size(place(&linkage["pivots"][k]) / unit - pivot) < 1e-5 * scale)
            });
            assert_eq!(on.count(), 2, "seed {seed}: {pivot}");
        }
        for linkage in family.as_array().into_iter().flatten() {
            assert!(
                linkage["error"].as_f64() < Some(1e-6),
                "seed {seed}: {linkage:#}"
            );
        }
    }
}

#[test]
fn the_classical_points_have_sixty_four_curves() {
    let cluster = Cluster::with_workers(2);
    let example = cognate_tests::builders::example("nine_points.csv");
    std::fs::write(cluster.folder().join("points.csv"), example).unwrap();
    let more = ["--format", "json", "--certify", "--output", "kept"];
    let sheet = json(&synthesize(&cluster, "points.csv", &more));
    check_classes(&sheet);
    let classes = &sheet["classes"];
    assert_eq!(
        (&classes["finite"], &classes["real"]),
        (&1442.into(), &64.into())
    );
    assert_eq!(classes["certified_real"], 64, "{classes:#}");
    assert_eq!(linkages(&sheet).count(), 192);
    for linkage in linkages(&sheet) {
        assert!(linkage["error"].as_f64() < Some(1e-6), "{linkage:#}");
    }
    // Every notation holds equal answers.
    let kept = |name: &str| {
        let path = cluster.folder().join("kept").join(name);
        std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    let stored_summary: Value = serde_json::from_str(&kept("summary.json")).expect("JSON");
    assert_eq!(stored_summary["curves"], sheet["curves"]);
    assert_eq!(kept("linkages.csv").lines().count(), 193);
    let page = kept("linkages.html");
    assert!(!page.contains("@TITLE@") && !page.contains("@DATA@"));
    assert!(
        !page.contains("http://") && !page.contains("https://"),
        "it needs no server"
    );
    let drawing = kept("dxf/1a.dxf");
    assert!(drawing.ends_with("  0\r\nEOF\r\n"), "a whole drawing");
    let lines = drawing.lines().filter(|line| *line == "LINE").count();
    assert_eq!(lines, 6, "ground, two sides, three sides of the coupler");
    // And without a coordinator of one's own.
    let table = std::process::Command::new(cognate_tests::processes::cognate())
        .args(["synthesize", "nine-point", "points.csv"])
        .current_dir(cluster.folder())
        .output()
        .expect("cognate can be started");
    let text = String::from_utf8_lossy(&table.stdout);
    assert_eq!(table.status.code(), Some(0), "{text}");
    assert!(
        text.contains("64 coupler curves through the nine points, 192 linkages"),
        "{text}"
    );
}

#[test]
fn many_sets_are_answered_line_by_line_as_each_alone() {
    let cluster = Cluster::with_workers(2);
    let bars = [3, 4, 5].map(random_four_bar);
    let row = |bar: &FourBar| {
        let points = bar
            .points
            .iter()
            .map(|p| format!("[{:?}, {:?}]", p.re, p.im));
        format!("[{}]", points.collect::<Vec<_>>().join(", "))
    };
    let many: Vec<String> = bars
        .iter()
        .zip(["one", "two", "three"])
        .map(|(bar, name)| format!("{{\"name\": \"{name}\", \"points\": {}}}\n", row(bar)))
        .collect();
    std::fs::write(cluster.folder().join("many.jsonl"), many.concat()).unwrap();
    let address = cluster.address();
    let arguments = [
        "synthesize",
        "nine-point",
        "--targets",
        "many.jsonl",
        "--format",
        "json",
    ];
    let output = cluster.command(&[&arguments[..], &["--coordinator", &address]].concat());
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("3 sets in ") && errors.contains("4,326 paths"),
        "{errors}"
    );
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    let sets: Vec<Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).expect("an object on each line"))
        .collect();
    let names: Vec<_> = sets.iter().map(|set| set["name"].as_str()).collect();
    assert_eq!(names, [Some("one"), Some("two"), Some("three")]);
    for (set, bar) in sets.iter().zip(&bars) {
        check_classes(set);
        std::fs::write(cluster.folder().join("alone.json"), row(bar)).unwrap();
        let alone = json(&synthesize(&cluster, "alone.json", &["--format", "json"]));
        assert_eq!(set["classes"], alone["classes"]);
        let lengths = |sheet: &Value| -> Vec<Value> {
            linkages(sheet)
                .map(|linkage| linkage["lengths"].clone())
                .collect()
        };
        assert_eq!(lengths(set), lengths(&alone), "the same bits");
    }
}

#[test]
fn bad_points_are_refused_before_anything_starts() {
    let cluster = Cluster::with_workers(0);
    let example = cognate_tests::builders::example("nine_points.csv");
    let cases = [
        (
            example.replace("0.20,1.00", "0.20,1.O"),
            "points.csv:10: y: expected a finite number",
        ),
        (
            example.replace("0.20,1.00", "0.52,0.10"),
            "line 4 and line 10: points 2 and 8 coincide",
        ),
        (
            example.replace("0.02,0.40\n", ""),
            "expected nine points, found 8",
        ),
        (
            example.replace("x,y", "u,v"),
            "points.csv:2: expected the header x,y",
        ),
    ];
    for (text, expected) in cases {
        std::fs::write(cluster.folder().join("points.csv"), text).unwrap();
        let output = synthesize(&cluster, "points.csv", &[]);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(expected), "{errors}\nexpected {expected}");
    }
}
