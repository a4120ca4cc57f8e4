//! Seeded mutations of a corpus: no panic, no hang, no flood of memory, on any input.
//!
//! `COGNATE_MUTATION_INPUTS` says how many inputs of each format are tried (40,000 unless given: the same on
//! every machine); `COGNATE_MUTATION_SEED` gives others. A failure prints what is needed to repeat it.

use crate::support::{Random, system_names, systems};
use cognate_systems::expression::fault::Problem as What;
use cognate_systems::formats::{self, FileSettings, Format, degenerate, options, points, symmetry};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Longer than this for one input of at most some 100 kB is a hang.
const HANG: Duration = Duration::from_secs(300);
/// More resident memory than this, all tests together, is a flood.
const MEMORY_KILOBYTES: u64 = 3 << 20;

const TOKENS: [&str; 64] = [
    "(",
    ")",
    "^",
    "**",
    "*",
    "/",
    "+",
    "-",
    ";",
    ",",
    "=",
    ":",
    "%",
    "{",
    "}",
    "[",
    "]",
    "\"",
    "\\u00e9",
    "\\",
    "~",
    "\n",
    "\r\n",
    "\t",
    "\0",
    "\u{feff}",
    "é",
    "\u{1F600}",
    "0",
    "1",
    "2",
    "1/3",
    ".5",
    "1e999999999",
    "1E-40",
    "99999999999999999999999",
    "e",
    "E1",
    "I",
    "i",
    "Pi",
    "sqrt(",
    "sin(",
    "x",
    "x1",
    "x^100000",
    "^(1/2)",
    "^-1",
    "CONFIG",
    "INPUT",
    "END;",
    "variable_group x;",
    "hom_variable_group",
    "variable ",
    "function f;",
    "constant ",
    "parameter p;",
    "pathvariable t;",
    "f = x;",
    "\"equations\":",
    "null",
    "true",
    "solution 1 :",
    "the solution for t :",
];

fn corpus_of_systems(file: &str) -> Vec<Vec<u8>> {
    system_names()
        .iter()
        .map(|name| std::fs::read(systems().join(name).join(file)).expect("a test system"))
        .collect()
}

/// One to four changes of one text of the corpus.
fn mutate(random: &mut Random, corpus: &[Vec<u8>]) -> Vec<u8> {
    let mut text = corpus[random.below(corpus.len())].clone();
    for _ in 0..=random.below(4) {
        let at = random.below(text.len() + 1);
        let longest = 1 + random.below(64);
        let length = random.below(longest);
        let end = (at + length).min(text.len());
        match random.below(8) {
            0 if at < text.len() => text[at] ^= 1 << random.below(8),
            1 => drop(text.drain(at..end)),
            2 => {
                let span = text[at..end].to_vec();
                let bits = random.below(8);
                let times = 1 + random.below(1 << bits);
                let copies = span.repeat(times);
                text.splice(at..at, copies);
            }
            3 => {
                let to = random.below(text.len() + 1);
                let span: Vec<u8> = text.drain(at..end).collect();
                let to = to.min(text.len());
                text.splice(to..to, span);
            }
            4 | 5 => {
                let token = TOKENS[random.below(TOKENS.len())];
                let times = if random.below(16) == 0 {
                    1 << random.below(14)
                } else {
                    1
                };
                text.splice(at..at, token.repeat(times).into_bytes());
            }
            6 => {
                let other = &corpus[random.below(corpus.len())];
                let from = random.below(other.len() + 1);
                let to = (from + random.below(200)).min(other.len());
                text.splice(at..at, other[from..to].iter().copied());
            }
            _ => text.truncate(at),
        }
    }
    text
}

/// Tries mutated inputs; `read` says whether it accepted one.
fn run(name: &str, corpus: &[Vec<u8>], read: impl Fn(&[u8]) -> bool) {
    let setting = |name: &str, otherwise: u64| match std::env::var(name) {
        Ok(text) => text
            .parse()
            .unwrap_or_else(|_| panic!("{name} is a whole number")),
        Err(_) => otherwise,
    };
    let inputs = setting("COGNATE_MUTATION_INPUTS", 40_000);
    let seed = setting("COGNATE_MUTATION_SEED", 1);
    let mut accepted = 0u64;
    for text in corpus {
        assert!(
            read(text),
            "{name}: the corpus itself is accepted:\n{}",
            String::from_utf8_lossy(text)
        );
    }
    for count in 0..inputs {
        let text = mutate(&mut Random(seed.wrapping_mul(1 << 32) + count), corpus);
        let start = Instant::now();
        let result = catch_unwind(AssertUnwindSafe(|| read(&text)));
        let slow = start.elapsed() > HANG;
        if result.is_err() || slow {
            let what = if slow { "takes too long" } else { "panics" };
            let text = String::from_utf8_lossy(&text);
            panic!("{name}: seed {seed}, input {count} {what}:\n{text}");
        }
        accepted += u64::from(result.unwrap_or(false));
    }
    println!("{name}: {inputs} inputs, {accepted} accepted");
    assert!(
        inputs > accepted && accepted > 0,
        "{name}: mutations neither all good nor all bad"
    );
    // Linux says how much memory the process ever had; elsewhere this is not checked.
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status
            .lines()
            .find_map(|l| l.strip_prefix("VmHWM:"))
            .expect("a peak");
        let kilobytes: u64 = peak
            .trim()
            .trim_end_matches(" kB")
            .parse()
            .expect("a number of kilobytes");
        assert!(
            kilobytes < MEMORY_KILOBYTES,
            "{name}: {kilobytes} kB of memory"
        );
    }
}

/// Reads a problem; what is accepted can be checked, written, and read again.
fn read_problem(text: &[u8]) -> bool {
    let problem = match formats::read("mutated", text) {
        Ok(problem) => problem,
        Err(e) => {
            assert!(!e.to_string().is_empty() && e.place.line > 0 && e.place.column > 0);
            return false;
        }
    };
    problem
        .system
        .check()
        .expect("readers promise a checked system");
    for format in Format::ALL {
        let Ok(written) = formats::write(format, &problem.system, &FileSettings::default()) else {
            continue;
        };
        match formats::read("written", written.as_bytes()) {
            Ok(reread_problem) => {
                assert_eq!(
                    reread_problem.system.variables.len(),
                    problem.system.variables.len()
                );
                assert_eq!(
                    reread_problem.system.equations.len(),
                    problem.system.equations.len()
                );
            }
            // Products that were not multiplied out may be when they are read again.
            Err(e) => assert!(matches!(e.problem, What::Limit { .. }), "{e}\n{written}"),
        }
    }
    true
}

#[test]
fn bertini() {
    let mut corpus = corpus_of_systems("system.bertini");
    for text in [
        "variable_group x, y; function f, g; f = x^2 - y; g = x*y - 1/2; END;",
        "CONFIG\nRandomSeed: 3; MPType: 2; UserHomotopy: 1;\nEND;\nINPUT variable x; function f;\n\
         pathvariable t; parameter s; s = t^2; constant c, d; c = 3/5 + 4/5*I;\n\
         d = sqrt(2)^2*Pi/exp(1); a = b; b = x^2; % shared\nf = (a - d)*(1 - s) + c*s*(x^2 - 1);\nEND;",
        "hom_variable_group x, y; parameter p; function f; f = (x^2 - p*y^2)/(p + 1); END; rest",
    ] {
        corpus.push(text.into());
    }
    run("Bertini-classic", &corpus, read_problem);
}

#[test]
fn phcpack() {
    let mut corpus = corpus_of_systems("system.phc");
    for text in [
        "2\n x - x + y - y + (1.5E+00 - 2*i)*x^2*y - 3;\n x**2 + (1/2)*E1 - E1 - y;\n\nTITLE : t\n",
        "1 2\n e1*e2 - 1;\n",
        "1 1\n ((x + 1)^2 - I)^3;\n",
    ] {
        corpus.push(text.replace("(1/2)*E1 - E1 - ", "").into());
    }
    run("PHCpack", &corpus, read_problem);
}

#[test]
fn notations_of_algebra() {
    let mut corpus = Vec::new();
    let notations = [
        Format::Macaulay2,
        Format::Maple,
        Format::Singular,
        Format::Msolve,
    ];
    for text in corpus_of_systems("system.bertini") {
        let system = formats::read("corpus", &text)
            .expect("a test system")
            .system;
        let written = notations.map(|n| formats::write(n, &system, &FileSettings::default()));
        let short = written.into_iter().flatten().filter(|t| t.len() < 4000);
        corpus.extend(short.map(String::into_bytes));
    }
    for text in [
        "-- two conics\nR = QQ[a][x_1..x_3, MonomialOrder => Lex];\nI = ideal({x_1^2 - a*x_2, x_2*x_3 - 2/3});\ngens I",
        "ring r = (0, a), (x, y), dp; // a comment\nideal i = x^2*y - a, /* and */ y^3 - x;\nstd(i);",
        "ring r = (0,i),(x,y),dp; minpoly = i^2+1; ideal j = x^2 - i, y - x;",
        "vars := [x, y]: # order\nsys := {x^2 = p*y, sqrt(2)*x - y[1]};",
        "x,y\n0\nx^2+y^2-1,\nx-2/3*y\n",
    ] {
        corpus.push(text.into());
    }
    run("computer algebra", &corpus, read_problem);
}

#[test]
fn json() {
    let mut corpus = Vec::new();
    for text in corpus_of_systems("system.bertini") {
        let system = formats::read("corpus", &text)
            .expect("a test system")
            .system;
        let text = formats::write(Format::Json, &system, &FileSettings::default()).expect("JSON");
        corpus.push(text.into());
    }
    corpus.push(
        r#"{"variables": ["x", "y"], "groups": [["x"], ["y"]], "homogeneous": [false, true],
        "parameters": ["p", "t"], "path_variable": "t", "definitions": {"b": "a^2", "a": "x + p"},
        "equations": ["b*y - t", "x*y - 1/2*I", "x\u002b1"], "conjugates": [["x", "y"]],
        "degenerate": {"no pose": {"nonzero": "x + y"}, "line": {"equations": ["x", "a"]}},
        "symmetry": [{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "1/x^2"}}]}"#
            .into(),
    );
    run("JSON", &corpus, read_problem);
}

#[test]
fn start_solutions_and_parameters() {
    let names: Vec<String> = vec!["x".into(), "e1".into()];
    let solutions: Vec<Vec<u8>> = [
        "2\n\n1.5e0 -2.0;\n3e-3 0;\n\n0.1 2.5E-1\n-7 +1e10\n",
        "THE SOLUTIONS :\n1 2\n=====\nsolution 1 :\nt : 1.0 0.0\nm : 1\nthe solution for t :\n \
         e1 : 3.0E-03 0.0\n x : 1.5 -2.0\n== err : 1.3E-15 = rco : 2.0E-01 = res : 2.2E-16 ==\n",
        "{\"variables\": {\"x\": [1.5, \"-2.00\"], \"e1\": [3e-3, 0]}, \"paths\": [1]}\n",
    ]
    .map(|text| text.into())
    .into();
    let whole = |points: Vec<points::Point>| points.iter().all(|p| p.len() == 2);
    run("start solutions", &solutions, |text| {
        points::read_solutions("mutated", text, &names).is_ok_and(whole)
    });
    let parameters: Vec<Vec<u8>> = [
        "2\n\n1.5 -2;\n0.003 0;\n",
        "[{\"e1\": [3e-3, 0], \"x\": [1.5, -2]}, {\"x\": 0.1, \"e1\": [-7, \"1e10\"]}]",
        "{\"e1\": [3e-3, 0], \"x\": [1.5, -2]}",
    ]
    .map(|text| text.into())
    .into();
    run("parameters", &parameters, |text| {
        points::read_parameters("mutated", text, &names).is_ok_and(whole)
    });
}

#[test]
fn symmetry_degenerate_sets_and_options() {
    let text = b"hom_variable_group x, y; variable_group z; parameter p; function f; f = x*y; END;";
    let system = formats::read("system", text).expect("a system").system;
    let files: Vec<Vec<u8>> = [
        r#"[{"permutation": {"x": "y", "y": "x"}}, {"map": {"z": "(x + y)^-2/(z*p)"}}]"#,
        r#"{"no pose": {"nonzero": "x*y - p"}, "line": {"equations": ["x", "y - I"]}}"#,
        "x,y;z",
        "x~y",
    ]
    .map(|text| text.into())
    .into();
    run("symmetry, degenerate sets, options", &files, |text| {
        let mut changed = system.clone();
        let mut accepted = symmetry::read("mutated", text, &mut changed).is_ok();
        accepted |= degenerate::read("mutated", text, &mut changed).is_ok();
        if let Ok(text) = std::str::from_utf8(text) {
            accepted |= options::groups(text, &mut changed).is_ok();
            accepted |= options::conjugates(text, &mut changed).is_ok();
        }
        changed.check().expect("still a system");
        assert!(
            accepted || changed == system,
            "what is refused changes nothing"
        );
        accepted
    });
}
