//! Nine-point synthesis: the examples, the family that is kept, and monodromy that finds it.

use cognate_algorithms::monodromy::LoopLimits;
use cognate_algorithms::monodromy::counts::Stop;
use cognate_algorithms::plan::{GivenStart, StartChoice};
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{PlanOptions, plan};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::formats;
use cognate_systems::named::{NINE_POINT_SOLUTIONS, nine_point, random_four_bar};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::path::PathBuf;
use std::sync::Arc;

/// The linkage of the examples.
const SEED: u64 = 9;

fn deployed(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../deploy")
        .join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(deployed(name)).unwrap_or_else(|error| panic!("deploy/{name}: {error}"))
}

/// The example file with its symmetry file, as a user would give them.
fn example() -> System {
    let mut system = match formats::read("nine_point.json", &bytes("examples/nine_point.json")) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    };
    let symmetry = bytes("examples/nine_point_symmetry.json");
    if let Err(error) = formats::symmetry::read("symmetry", &symmetry, &mut system) {
        panic!("{error}");
    }
    system
}

fn native(values: &[Complex64]) -> Vec<Complex<f64>> {
    let values = values.iter();
    values.map(|z| Complex { re: z.re, im: z.im }).collect()
}

fn random_point(count: usize, index: u64) -> Vec<Complex64> {
    let mut random = RandomStream::new(3, Purpose::Test, index);
    (0..count).map(|_| random.disc()).collect()
}

#[test]
fn the_example_is_the_named_system() {
    let (read, named) = (example(), nine_point().system);
    assert_eq!(
        (&read.variables, &read.parameters),
        (&named.variables, &named.parameters)
    );
    assert_eq!(read.degenerate.len(), 8);
    let (x, p) = (random_point(8, 1), random_point(16, 2));
    let values = |system: &System| {
        let program = Interpreter::compile(&system.expressions, &system.equations, 8, 16);
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        let mut out = vec![Complex { re: 0.0, im: 0.0 }; 8];
        program.value(&native(&x), &native(&p), &mut out, &mut scratch);
        out
    };
    for (a, b) in values(&read).iter().zip(values(&named)) {
        let (re, im) = (a.re - b.re, a.im - b.im);
        assert!(re * re + im * im < 1e-24, "{a:?} {b:?}");
    }
    let shape = PointShape::of(&named);
    let images = |system: &System| {
        let mut group = SymmetryGroup::of(system).expect("rational maps");
        group.close(&x, &shape).expect("a finite group");
        group.images(&x, &shape)
    };
    let (a, b) = (images(&read), images(&named));
    assert_eq!(a.len(), 6, "two dyads, three cognates");
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        let (a, b) = (
            shape.to_coordinates(&a.values),
            shape.to_coordinates(&b.values),
        );
        assert!(shape.distance(&a, &b) < 1e-12);
    }
}

/// A start pair as files: JSON lines and JSON.
fn pair_as_files() -> (String, String) {
    let system = nine_point().system;
    let four_bar = random_four_bar(SEED);
    let object = |names: &[String], values: &[Complex64]| {
        let fields: Vec<String> = names
            .iter()
            .zip(values)
            .map(|(name, z)| format!("\"{name}\": [{:?}, {:?}]", z.re, z.im))
            .collect();
        format!("{{{}}}", fields.join(", "))
    };
    (
        format!(
            "{{\"variables\": {}}}\n",
            object(&system.variables, &four_bar.variables)
        ),
        format!("{}\n", object(&system.parameters, &four_bar.parameters)),
    )
}

/// UPDATE_GOLDEN=1 writes the start pair again.
#[test]
fn the_start_pair_is_the_linkage_of_its_seed() {
    let (solution, parameters) = pair_as_files();
    for (name, expected) in [
        ("examples/nine_point_start.jsonl", solution),
        ("examples/nine_point_parameters.json", parameters),
    ] {
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::write(deployed(name), &expected).expect("the folder is writable");
        }
        assert_eq!(String::from_utf8_lossy(&bytes(name)), expected, "{name}");
    }
}

/// Minutes of tracking: `cargo test --release -p cognate-tests --test known_answers -- --ignored`.
#[test]
#[ignore = "minutes of tracking"]
fn one_linkage_leads_to_all() {
    let system = example();
    let four_bar = random_four_bar(SEED);
    let start = Arc::new(StoredPoints {
        dimension: 8,
        coordinates: four_bar.variables.clone(),
    });
    let options = PlanOptions {
        start: StartChoice::Monodromy,
        start_points: Some(GivenStart {
            object: start.digest(),
            count: 1,
            dimension: 8,
        }),
        start_parameters: Some(four_bar.parameters.clone()),
        loops: LoopLimits::default(),
        seed: SEED,
        ..PlanOptions::default()
    };
    let mut plan = plan(&system, &options).expect("a plan");
    let find = |digest: Digest| (digest == start.digest()).then(|| Arc::clone(&start));
    let sets = run_locally(&plan.system, &mut plan.algorithm, &find, 16).expect("it is solved");
    let counts = plan.algorithm.loops().expect("a monodromy solve").clone();
    assert_eq!(counts.stop, Some(Stop::IdleLoops));
    assert_eq!(
        (counts.solutions, counts.classes),
        (NINE_POINT_SOLUTIONS, 1442)
    );
    let set = &sets[0];
    assert_eq!(set.paths.total, NINE_POINT_SOLUTIONS);
    assert_eq!(set.classes.count, Some(1442));
    assert_eq!(set.paths.crossings_found, set.paths.crossings_resolved);
    // Every class has a member that arrived; a path that did not is named.
    assert_eq!(
        set.counts.nonsingular + set.failed.len() as u64,
        NINE_POINT_SOLUTIONS
    );
    assert!(set.failed.len() <= 8, "{:?}", set.failed);
}
