//! Nine-point synthesis: the examples, the family that is kept, and monodromy that finds it.

use cognate_algorithms::monodromy::LoopLimits;
use cognate_algorithms::monodromy::counts::Stop;
use cognate_algorithms::plan::{GivenStart, SolveMethod};
use cognate_algorithms::plan::{KnownSolutions, MonodromyOptions};
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::{Digest, StartPoints, StoredPoints};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::formats;
use cognate_systems::named::{
    NINE_POINT_SOLUTIONS, nine_point, nine_point_with_rotations, random_four_bar, rotations,
};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::path::PathBuf;
use std::sync::Arc;

/// The linkage of the examples.
const SEED: u64 = 9;

/// Where the family is kept.
const FAMILY: &str = "families/nine_point";

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

/// Faults of a set of points that should be all solutions for these parameters.
fn faults(points: &StoredPoints, parameters: &[Complex64]) -> Vec<String> {
    let system = nine_point().system;
    let shape = PointShape::of(&system);
    let mut faults = Vec::new();
    if points.len() as u64 != NINE_POINT_SOLUTIONS {
        faults.push(format!("{} points", points.len()));
    }
    // How far Newton's method would still move each: its error, and it is regular.
    let program = Interpreter::compile(&system.expressions, &system.equations, 8, 16);
    let mut scratch = Evaluate::<f64>::scratch(&program, ());
    let (p, still) = (native(parameters), native(&[Complex64::default(); 16]));
    for k in 0..points.len() {
        let x = points.point(k);
        let mut matrix = Matrix::<f64>::zeros((), 8, 10);
        program.linearize(&native(x), &p, &still, &mut matrix, &mut scratch);
        eliminate::<f64, 1>(&mut matrix, &mut 0.0);
        let step: f64 = (0..8).map(|i| matrix.at(i, 8).norm_sqr()).sum();
        let size = x.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
        if step.is_nan() || step > 1e-18 * size {
            faults.push(format!("point {k} is off by {:e}", (step / size).sqrt()));
        }
        // K = alpha beta' - alpha' beta, beside the size of its two terms.
        let [x, xx, a, aa, y, yy, b, bb] = x else {
            panic!("eight variables");
        };
        for d in parameters.chunks_exact(2) {
            let (alpha, beta) = (d[1] * x - aa * x, d[0] * xx - a * xx);
            let (alpha2, beta2) = (d[1] * y - bb * y, d[0] * yy - b * yy);
            let (one, two) = (alpha * beta2, alpha2 * beta);
            let size = one.norm_sqr().max(two.norm_sqr());
            if (one - two).norm_sqr().is_nan() || (one - two).norm_sqr() <= 1e-20 * size {
                faults.push(format!("at point {k} some K is 0: no linkage"));
            }
        }
    }
    let listed: Vec<(&[Complex64], f64)> =
        (0..points.len()).map(|k| (points.point(k), 1e-9)).collect();
    let mut counted = |group: &SymmetryGroup, orbits: usize, size: usize, what: &str| {
        let group_orbits = group.orbits(&listed, &shape, 1);
        let whole = group_orbits
            .iter()
            .filter(|orbit| orbit.len() == size)
            .count();
        if (group_orbits.len(), whole) != (orbits, orbits) {
            faults.push(format!(
                "{} orbits under {what}, {whole} of {size}",
                group_orbits.len()
            ));
        }
    };
    counted(&SymmetryGroup::trivial(), 8652, 1, "nothing");
    let mut swap = system.clone();
    swap.symmetry.truncate(1);
    for (system, orbits, size, what) in [
        (&swap, 4326, 2, "exchange"),
        (&system, 1442, 6, "exchange and cognates"),
    ] {
        let mut group = SymmetryGroup::of(system).expect("rational maps");
        group
            .close(points.point(0), &shape)
            .expect("a finite group");
        counted(&group, orbits, size, what);
    }
    faults
}

#[test]
fn the_family_is_whole() {
    let points = StoredPoints::from_bytes(&bytes(&format!("{FAMILY}/solutions.points")));
    let points = points.expect("points");
    let text = bytes(&format!("{FAMILY}/parameters.json"));
    let names = nine_point().system.parameters;
    let parameters = match formats::points::read_parameters("parameters.json", &text, &names) {
        Ok(sets) => sets[0].clone(),
        Err(error) => panic!("{error}"),
    };
    assert_eq!(faults(&points, &parameters), Vec::<String>::new());
    // One that is moved, one that is there twice: both are seen.
    let mut moved = points.clone();
    moved.coordinates[8 * 17] *= 1.0 + 1e-6;
    assert!(faults(&moved, &parameters)[0].starts_with("point 17 is off"));
    let mut twice = points.clone();
    let first: Vec<Complex64> = points.point(0).to_vec();
    twice.coordinates[8 * 6..8 * 7].copy_from_slice(&first);
    assert!(faults(&twice, &parameters)[0].starts_with("8651 orbits under nothing"));
}

/// With the rotations as unknowns each equation has few of the 24: what is eliminated by lists
/// ends where the eight equations end.
#[test]
fn rotations_as_unknowns_end_at_the_same_linkages() {
    let points = StoredPoints::from_bytes(&bytes(&format!("{FAMILY}/solutions.points")));
    let points = points.expect("points");
    let text = bytes(&format!("{FAMILY}/parameters.json"));
    let names = nine_point().system.parameters;
    let start = match formats::points::read_parameters("parameters.json", &text, &names) {
        Ok(sets) => sets[0].clone(),
        Err(error) => panic!("{error}"),
    };
    let few: Vec<&[Complex64]> = (0..points.len())
        .step_by(61)
        .map(|k| points.point(k))
        .collect();
    let target = random_point(16, 4);
    let endpoints = |system: &System, dimension: usize, starts: Vec<Complex64>| {
        let stored = Arc::new(StoredPoints {
            dimension,
            coordinates: starts,
        });
        let stage = Stage {
            id: StageId(0),
            system: None,
            work: Work::Track,
            homotopy: HomotopyKind::Parameter {
                start: start.clone(),
                targets: vec![target.clone()],
            },
            start_points: StartPoints::Stored {
                object: stored.digest(),
                count: stored.len() as u64,
            },
            settings: Settings::default(),
            seed: 4,
            attempt: 0,
        };
        let find = |_| Some(Arc::clone(&stored));
        let prepared = PreparedStage::new(system, &stage, &find).expect("a stage");
        let results = prepared.track(0..prepared.items(), 16);
        let ends = results.iter().map(|r| {
            assert_eq!(r.outcome, PathOutcome::Regular, "{:?}", r.origin);
            let y = r.endpoint.to_double();
            y[1..9].iter().map(|z| z / y[0]).collect::<Vec<Complex64>>()
        });
        ends.collect::<Vec<_>>()
    };
    let short = endpoints(&nine_point().system, 8, few.concat());
    let lifted = few
        .iter()
        .flat_map(|x| [x.to_vec(), rotations(x, &start)].concat());
    let long = endpoints(&nine_point_with_rotations().system, 24, lifted.collect());
    assert_eq!(short.len(), 142);
    for (k, (a, b)) in short.iter().zip(&long).enumerate() {
        let size = a.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).norm_sqr() < 1e-16 * size, "{k}: {a} {b}");
        }
    }
}

/// One solution of each class, from all of them: of six the one whose largest coordinate is the smallest. `cognate
/// synthesize` carries these solutions. UPDATE_GOLDEN=1 writes them again.
#[test]
fn the_representatives_are_one_of_each_class() {
    let points = StoredPoints::from_bytes(&bytes(&format!("{FAMILY}/solutions.points")));
    let points = points.expect("points");
    let system = nine_point().system;
    let shape = PointShape::of(&system);
    let mut group = SymmetryGroup::of(&system).expect("rational maps");
    group
        .close(points.point(0), &shape)
        .expect("a finite group");
    let listed: Vec<(&[Complex64], f64)> =
        (0..points.len()).map(|k| (points.point(k), 1e-9)).collect();
    let size = |k: usize| {
        let sizes = points.point(k).iter().map(|z| z.norm_sqr());
        sizes.fold(0.0, f64::max)
    };
    let orbits = group.orbits(&listed, &shape, 1);
    let chosen = orbits.iter().map(|orbit| {
        let best = orbit.iter().min_by(|&&j, &&k| size(j).total_cmp(&size(k)));
        *best.expect("an orbit has members")
    });
    let made = StoredPoints {
        dimension: 8,
        coordinates: chosen.flat_map(|k| points.point(k).to_vec()).collect(),
    };
    assert_eq!(made.len(), 1442);
    let name = format!("{FAMILY}/representatives.points");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(deployed(&name), made.to_bytes()).expect("the folder is writable");
    }
    assert!(
        bytes(&name) == made.to_bytes(),
        "{name}: UPDATE_GOLDEN=1 writes it again"
    );
}

/// All 8652 solutions from one linkage, by loops: half a minute of tracking.
#[test]
fn one_linkage_leads_to_all() {
    let system = example();
    let four_bar = random_four_bar(SEED);
    let start = Arc::new(StoredPoints {
        dimension: 8,
        coordinates: four_bar.variables.clone(),
    });
    let options = SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            known: KnownSolutions {
                points: Some(GivenStart {
                    object: start.digest(),
                    count: 1,
                    dimension: 8,
                }),
                parameters: Some(four_bar.parameters.clone()),
            },
            limits: LoopLimits::default(),
        }),
        seed: SEED,
        ..SolveOptions::default()
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
    // A solution that did not arrive, not even by another member of its class, is named.
    let named = set.counts.nonsingular + set.failed.len() as u64;
    assert_eq!(named, NINE_POINT_SOLUTIONS, "{:?}", set.failed);
    assert!(set.failed.len() <= 2, "{:?}", set.failed);
}
