//! Certificates from a solve to a checker that uses nothing of ours, and certificates that were tampered with.

use cognate_tests::builders::example;
use cognate_tests::processes::cognate;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PAIRS: &str = "p~P,t1~T1,t2~T2,t3~T3,g~G";

/// A problem, solved with certificates.
struct Solved {
    folder: tempfile::TempDir,
    problem: PathBuf,
    summary: Value,
    table: String,
}

fn solve(text: &str, options: &[&str]) -> Solved {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let problem = folder.path().join("problem.bertini");
    std::fs::write(&problem, text).expect("written");
    let out = folder.path().join("out");
    let output = Command::new(cognate())
        .args(["solve", "--certify", "--seed", "5", "--workers", "1"])
        .args(["--threads", "1", "--output"])
        .arg(&out)
        .args(options)
        .arg(&problem)
        .output()
        .expect("cognate can be started");
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{table}\n{errors}");
    let summary = std::fs::read_to_string(out.join("summary.json")).expect("a summary");
    Solved {
        summary: serde_json::from_str(&summary).expect("JSON"),
        folder,
        problem,
        table,
    }
}

fn check(problem: &Path, certificates: &Path) -> Output {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("certificate_checker/check.py");
    Command::new("python3")
        .arg(script)
        .args([problem, certificates])
        .output()
        .expect("Python 3 can be started: the checker is written in it")
}

impl Solved {
    fn counts(&self) -> [Option<u64>; 3] {
        let solutions = &self.summary["solutions"];
        ["nonsingular", "certified", "certified_real"].map(|name| solutions[name].as_u64())
    }

    fn certificates(&self) -> Value {
        let path = self.folder.path().join("out/certificates.json");
        let text = std::fs::read_to_string(path).expect("certificates");
        serde_json::from_str(&text).expect("JSON")
    }

    /// The checker's verdict on these certificates: its text, or why it refuses.
    fn checked(&self, certificates: &Value) -> Result<String, String> {
        let path = self.folder.path().join("to_check.json");
        std::fs::write(&path, certificates.to_string()).expect("written");
        let output = check(&self.problem, &path);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
        match output.status.code() {
            Some(0) => Ok(text(&output.stdout)),
            Some(1) => Err(text(&output.stderr)),
            code => panic!("{code:?}: {}", text(&output.stderr)),
        }
    }
}

#[test]
fn a_planar_platform_is_certified_and_nothing_else_passes_the_checker() {
    let text = example("three_rpr.bertini");
    let solved = solve(&text, &["--conjugates", PAIRS]);
    assert_eq!(solved.counts(), [Some(6); 3], "{}", solved.table);
    assert!(solved.table.contains("6 proved real"), "{}", solved.table);
    let good = solved.certificates();
    let said = solved.checked(&good).expect("what was certified holds");
    assert_eq!(said, "6 solutions proved, all distinct, 6 of them real");

    let refused = |why: &str, change: &dyn Fn(&mut Value)| {
        let mut bad = good.clone();
        change(&mut bad["targets"][0]);
        let said = solved.checked(&bad).expect_err(why);
        assert!(said.contains(why), "{said}, not {why}");
    };
    refused("not mapped into its interior", &|target| {
        // 1 + 2^-20 for a coordinate of modulus 1 or less.
        target["certificates"][2]["coordinates"][0]["re"] = json!("0x100001p-20");
    });
    refused("not mapped into its interior", &|target| {
        target["certificates"][1]["coordinates"][3]["radius"] = json!("0x1p-900");
    });
    refused("farther from the centre", &|target| {
        target["certificates"][1]["coordinates"][3]["error"] = json!("0x1p-900");
    });
    refused("one and the same", &|target| {
        target["certificates"][4] = target["certificates"][3].clone();
    });
    refused("claims", &|target| {
        target["claims"]["certified"] = json!(7);
    });
    refused("claims", &|target| {
        target["claims"]["real"] = json!(5);
    });
    refused("claims", &|target| {
        let list = target["certificates"].as_array_mut().expect("a list");
        list.pop();
    });
    refused("not invariant", &|target| {
        target["system"]["conjugates"] = json!([]);
    });
    refused("not proved to be other", &|target| {
        target["certificates"][0]["real"] = json!(false);
    });
    // Another problem: the certificates are none of its.
    let other = text.replace("29*t1/10", "29001*t1/10000");
    assert_ne!(other, text);
    std::fs::write(&solved.problem, other).expect("written");
    let said = solved.checked(&good).expect_err("another problem");
    assert!(said.contains("not mapped"), "{said}");
}

#[test]
fn solutions_that_are_not_real_are_proved_not_to_be() {
    // katsura-3: eight solutions, of which some come in pairs.
    let text = "CONFIG\nEND;\nINPUT\nvariable_group u0, u1, u2, u3;\nfunction f0, f1, f2, f3;\n\
                f0 = u0 + 2*u1 + 2*u2 + 2*u3 - 1;\n\
                f1 = u0^2 + 2*u1^2 + 2*u2^2 + 2*u3^2 - u0;\n\
                f2 = 2*u0*u1 + 2*u1*u2 + 2*u2*u3 - u1;\n\
                f3 = 2*u0*u2 + u1^2 + 2*u1*u3 - u2;\nEND;\n";
    let solved = solve(text, &[]);
    let [nonsingular, certified, real] = solved.counts();
    assert_eq!((nonsingular, certified), (Some(8), Some(8)));
    assert_eq!(real, solved.summary["solutions"]["real"].as_u64());
    let good = solved.certificates();
    let said = solved.checked(&good).expect("what was certified holds");
    assert!(said.starts_with("8 solutions proved"), "{said}");
    let list = good["targets"][0]["certificates"]
        .as_array()
        .expect("a list");
    let Some(complex) = list.iter().position(|c| c["real"] == json!(false)) else {
        return;
    };
    let mut bad = good.clone();
    bad["targets"][0]["certificates"][complex]["real"] = json!(true);
    let said = solved.checked(&bad).expect_err("it is not real");
    assert!(said.contains("not proved to be real"), "{said}");
}

#[test]
fn a_platform_in_homogeneous_coordinates_is_certified() {
    let solved = solve(&example("stewart_gough_dietmaier.bertini"), &[]);
    assert_eq!(solved.counts(), [Some(40); 3], "{}", solved.table);
    let said = solved.checked(&solved.certificates());
    let expected = "40 solutions proved, all distinct, 40 of them real";
    assert_eq!(said.as_deref(), Ok(expected));
}

#[test]
fn a_serial_arm_is_certified() {
    let solved = solve(&example("six_revolute_manseur_doty.bertini"), &[]);
    assert_eq!(solved.counts(), [Some(32); 3], "{}", solved.table);
    let said = solved.checked(&solved.certificates());
    let expected = "32 solutions proved, all distinct, 32 of them real";
    assert_eq!(said.as_deref(), Ok(expected));
}

#[test]
fn a_singular_solution_is_told_why_and_not_counted() {
    // (1, 1) is regular; at (0, 0) three solutions come together.
    let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;\n\
                f = x^2 - y;\ng = y^2 - x*y;\nEND;\n";
    let solved = solve(text, &[]);
    assert_eq!(solved.counts(), [Some(1); 3], "{}", solved.table);
    let lines = solved.folder.path().join("out/solutions.jsonl");
    let lines = std::fs::read_to_string(lines).expect("solutions");
    let singular: Vec<Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .filter(|solution: &Value| solution["singular"] == json!(true))
        .collect();
    let [singular] = singular.as_slice() else {
        panic!("one singular solution: {lines}");
    };
    assert_eq!(singular["certificate"]["certified"], json!(false));
    let reason = singular["certificate"]["reason"]
        .as_str()
        .expect("a reason");
    assert!(reason.contains("singular"), "{reason}");
    assert!(solved.checked(&solved.certificates()).is_ok());
}
