//! Questions to components against known answers, several seeds each: members, images, degrees by groups, real curves and
//! points, intersections.
//!
//! `SEEDS=30 cargo test -p cognate-tests --test questions` takes more seeds than the three of every run.

mod conjugate_surfaces;

use cognate_algorithms::decomposition::{self, DecompositionOptions, DecompositionSolve};
use cognate_algorithms::questions::{QuestionSolve, run_locally};
use cognate_continuation::bend::{SlicedEquations, exactly};
use cognate_solutions::witness::question::{CurveWish, GivenPoint, SecondSet};
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_solutions::witness::{Answer, Decomposition, Question, WitnessSet};
use cognate_systems::system::System;
use cognate_tests::systems::{shared, written};
use num_complex::Complex64;
use std::time::Instant;

/// The system in `tests/decomposition/systems/NAME`, or among those that other tests solve.
fn instance(name: &str) -> System {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("decomposition/systems");
    match std::fs::read(folder.join(name).join("system.bertini")) {
        Ok(content) => match cognate_systems::formats::read(name, &content) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        },
        Err(_) => shared(name),
    }
}

fn seeds() -> std::ops::RangeInclusive<u64> {
    let seeds = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    1..=seeds.unwrap_or(3)
}

fn options(seed: u64) -> DecompositionOptions {
    DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    }
}

fn components(name: &str, system: &System, seed: u64) -> Decomposition {
    let solve = match DecompositionSolve::new(system, &options(seed)) {
        Ok(solve) => solve,
        Err(error) => panic!("{name}: {error}"),
    };
    match decomposition::run_locally(solve, 8) {
        Ok(decomposition) => decomposition,
        Err(error) => panic!("{name}: {error}"),
    }
}

/// The answer, where nothing in it is in doubt.
fn ask(name: &str, system: &System, seed: u64, question: &Question) -> Answer {
    let decomposition = components(name, system, seed);
    let began = Instant::now();
    let solve = QuestionSolve::new(system, &options(seed), &decomposition.components, question);
    let solve = match solve {
        Ok(solve) => solve,
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    };
    let (answer, doubts) = match run_locally(solve, 8) {
        Ok(answer_and_doubts) => answer_and_doubts,
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    };
    let seconds = began.elapsed().as_secs_f64();
    eprintln!("{name}, {}, seed {seed}: {seconds:.2} s", answer.name());
    assert!(doubts.is_empty(), "{name}, seed {seed}: {doubts:?}");
    answer
}

#[test]
fn members_of_nid_illustrative() {
    let system = instance("nid_illustrative");
    let expected: [([f64; 3], &[u32]); 6] = [
        ([0.6, 0.8, 0.0], &[2]),
        ([2.0, 4.0, 8.0], &[1]),
        ([0.5, 0.25, 0.125], &[1, 1]),
        ([0.5, 7.0, 0.125], &[1]),
        ([0.5, 0.5, 0.5], &[0]),
        ([1.0, 1.0, 2.0], &[]),
    ];
    let given = |(values, _): &([f64; 3], &[u32])| GivenPoint {
        values: values.iter().map(|&x| Complex64::new(x, 0.0)).collect(),
        accuracy: f64::EPSILON,
    };
    let points: Vec<GivenPoint> = expected.iter().map(given).collect();
    for seed in seeds() {
        let points = points.clone();
        let answer = ask(
            "nid_illustrative",
            &system,
            seed,
            &Question::Member { points },
        );
        let Answer::Member(memberships) = answer else {
            panic!("{answer:?}");
        };
        for ((point, dimensions), membership) in expected.iter().zip(memberships) {
            let on: Vec<u32> = membership.on.iter().map(|id| id.dimension).collect();
            assert_eq!(&on, dimensions, "seed {seed}, {point:?}");
        }
    }
}

/// Every point that was sampled is a member, and the same point moved away is none.
#[test]
fn samples_are_members() {
    let name = "bennett_b";
    let system = instance(name);
    for seed in seeds() {
        let wish = cognate_solutions::witness::question::SampleWish {
            count: 50,
            ..Default::default()
        };
        let answer = ask(name, &system, seed, &Question::Sample(wish));
        let Answer::Sample(samples) = answer else {
            panic!("{answer:?}");
        };
        assert_eq!(samples[0].points.len(), 50);
        let mut points: Vec<GivenPoint> = Vec::new();
        for values in &samples[0].points {
            let mut moved = values.clone();
            moved[0] += 1e-3;
            for values in [values.clone(), moved] {
                let accuracy = 1e-12;
                points.push(GivenPoint { values, accuracy });
            }
        }
        let answer = ask(name, &system, seed, &Question::Member { points });
        let Answer::Member(memberships) = answer else {
            panic!("{answer:?}");
        };
        for (k, membership) in memberships.iter().enumerate() {
            assert_eq!(
                membership.on.len(),
                1 - k % 2,
                "seed {seed}: {membership:?}"
            );
        }
    }
}

#[test]
fn projections_of_the_twisted_cubic() {
    let system = instance("twisted_cubic");
    for seed in seeds() {
        for (onto, degree) in [([0, 1], 2), ([1, 2], 3), ([0, 2], 3)] {
            let onto = onto.to_vec();
            let answer = ask("twisted_cubic", &system, seed, &Question::Project { onto });
            let Answer::Project(images) = answer else {
                panic!("{answer:?}");
            };
            let [image] = images.as_slice() else {
                panic!("{images:?}");
            };
            let numbers = (image.dimension, image.degree, image.fiber_degree);
            assert_eq!(numbers, (Some(1), Some(degree), Some(1)), "seed {seed}");
        }
    }
}

#[test]
fn multidegree_of_conic_p1p2() {
    let system = instance("conic_p1p2");
    for seed in seeds() {
        let answer = ask("conic_p1p2", &system, seed, &Question::Multidegree);
        let Answer::Multidegree { components, .. } = answer else {
            panic!("{answer:?}");
        };
        let degrees = components[0].degrees.iter();
        let degrees: Vec<_> = degrees.map(|d| (d.slices.clone(), d.degree)).collect();
        assert_eq!(degrees, [(vec![1, 0], Some(1)), (vec![0, 1], Some(2))]);
    }
}

/// The real curves of the components of dimension 1, with two samples on either side of an arc's middle.
fn real_curves_of(name: &str, system: &System, seed: u64) -> Vec<RealCurve> {
    let question = Question::RealCurve(CurveWish {
        samples: 2,
        ..CurveWish::default()
    });
    match ask(name, system, seed, &question) {
        Answer::RealCurve(curves) => curves,
        answer => panic!("{answer:?}"),
    }
}

/// Closed loops, unbounded arcs, isolated points, singular points, connected components.
fn check_real(name: &str, system: &System, expected: [u64; 5]) {
    for seed in seeds() {
        let curves = real_curves_of(name, system, seed);
        let mut sum = [0; 5];
        for counts in curves.iter().map(|curve| curve.counts()) {
            sum[0] += counts.closed_loops;
            sum[1] += counts.unbounded_arcs;
            sum[2] += counts.isolated_points;
            sum[3] += counts.singular_points;
            sum[4] += counts.connected_components;
        }
        assert_eq!(sum, expected, "{name}, seed {seed}");
    }
}

macro_rules! real_curves {
    ($($name:ident: $expected:expr;)*) => {$(
        #[test]
        fn $name() {
            check_real(stringify!($name), &instance(stringify!($name)), $expected);
        }
    )*};
}

real_curves! {
    four_bar_loop_grashof: [2, 0, 0, 0, 2];
    real_acnode: [0, 1, 1, 1, 2];
    real_cubic: [1, 1, 0, 0, 2];
    quadrifolium: [0, 0, 0, 1, 1];
    viviani: [0, 0, 0, 1, 1];
}

/// Two circuits where the shortest and the longest bar together are shorter than the other two (Grashof), one where they
/// are longer, a crossing where they are as long: cranks `a` and `b` about (0, 0) and (d, 0), coupler `c`.
#[test]
fn circuits_of_four_bars() {
    let cases = [
        ([1, 3, 3, 3], [2, 0, 0, 0, 2]),
        ([2, 3, 3, 5], [1, 0, 0, 0, 1]),
        ([1, 2, 3, 4], [0, 0, 0, 1, 1]),
    ];
    for ([a, c, b, d], expected) in cases {
        let system = written(&format!(
            "variable_group x, y, u, v; function f, g, h; f = x^2 + y^2 - {}; g = (u - {d})^2 + v^2 - {};
             h = (x - u)^2 + (y - v)^2 - {};",
            a * a,
            b * b,
            c * c
        ));
        check_real("four-bar", &system, expected);
    }
}

/// The singular points of a real curve: the point, and how many branches come to it.
fn singular_points(name: &str, system: &System, seed: u64) -> Vec<(Vec<f64>, usize)> {
    let curves = real_curves_of(name, system, seed);
    let [curve] = curves.as_slice() else {
        panic!("{name}: one component");
    };
    let vertices = curve.vertices.iter().enumerate();
    let singular = vertices.filter(|(_, vertex)| vertex.is_singular());
    singular
        .map(|(k, vertex)| {
            let ends = curve.edges.iter().flat_map(|edge| edge.ends);
            let point = vertex.point.iter().map(|z| z.re).collect();
            (point, ends.filter(|end| *end == Some(k)).count())
        })
        .collect()
}

/// A coupler's point P is at the origin in two poses, one turned against the other by twice the angle of 3/5 + 4/5 i: so
/// its curve crosses itself there. Crank about A = (2, 0), rocker about B = 2 (-5 + 12 i)/13; (c, s) is the coupler's turn,
/// in which both bars' lengths are linear.
const COUPLER_CURVE: &str = "variable_group x, y; function f;
    c1 = 2*((x - 2)*6/5 - y*8/5); s1 = 2*((x - 2)*8/5 + y*6/5); l1 = 16/5 - 4 - (x - 2)^2 - y^2;
    c2 = 2*((x + 10/13)*33/65 + (y - 24/13)*56/65); s2 = 2*(-(x + 10/13)*56/65 + (y - 24/13)*33/65);
    l2 = 13/5 - 1 - (x + 10/13)^2 - (y - 24/13)^2;
    f = (l1*s2 - l2*s1)^2 + (c1*l2 - c2*l1)^2 - (c1*s2 - c2*s1)^2;";

#[test]
fn crossings_are_at_their_places() {
    let at = |point: &[f64], place: &[f64]| {
        let apart = point.iter().zip(place).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max) < 1e-7
    };
    for seed in seeds() {
        let viviani = singular_points("viviani", &instance("viviani"), seed);
        assert!(
            matches!(viviani.as_slice(), [(p, 4)] if at(p, &[2.0, 0.0, 0.0])),
            "seed {seed}: {viviani:?}"
        );
        // Four loops.
        let petals = singular_points("quadrifolium", &instance("quadrifolium"), seed);
        assert!(
            matches!(petals.as_slice(), [(p, 8)] if at(p, &[0.0, 0.0])),
            "seed {seed}: {petals:?}"
        );
        let coupler = singular_points("coupler curve", &written(COUPLER_CURVE), seed);
        assert!(
            coupler
                .iter()
                .any(|(p, branches)| *branches == 4 && at(p, &[0.0, 0.0])),
            "seed {seed}: {coupler:?}"
        );
    }
}

/// A circle in isotropic coordinates is real where they are conjugates.
#[test]
fn a_circle_in_isotropic_coordinates() {
    let system = written("variable_group p, P; function f; f = p*P - 1;");
    let system = cognate_tests::systems::with_conjugates(system, "p~P");
    check_real("circle", &system, [1, 0, 0, 0, 1]);
    // The upper half of it, with proofs: the second range is for the imaginary part.
    for seed in seeds() {
        let question = Question::RealCurve(CurveWish {
            samples: 2,
            within: vec![[-2.0, 2.0], [0.25, 2.0]],
            certify: true,
            ..CurveWish::default()
        });
        let Answer::RealCurve(curves) = ask("circle", &system, seed, &question) else {
            panic!("a curve was asked");
        };
        let counts = curves[0].counts();
        assert_eq!(
            (counts.arcs_across_box, counts.connected_components),
            (1, 1)
        );
        assert_eq!(curves[0].proved_slabs(), Some(curves[0].proofs.len()));
    }
}

/// Intersection of two components of a decomposition, which must consist of points: the values of the variables at each
/// point.
fn common_points(name: &str, degrees: [(u32, u64); 2], seed: u64) -> Vec<Vec<f64>> {
    let system = instance(name);
    let decomposition = components(name, &system, seed);
    let sets_like = |(dimension, degree): (u32, u64)| -> Vec<WitnessSet> {
        let witness_sets = decomposition.components.iter();
        let witness_sets =
            witness_sets.filter(|set| (set.dimension(), set.degree) == (dimension, degree));
        witness_sets.cloned().collect()
    };
    let second = SecondSet {
        own: system.equations.len() as u32,
        from: 0,
        components: sets_like(degrees[1]),
    };
    let first = sets_like(degrees[0]);
    let question = Question::Intersect(second);
    let solve = match QuestionSolve::new(&system, &options(seed), &first, &question) {
        Ok(solve) => solve,
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    };
    let (answer, _) = match run_locally(solve, 8) {
        Ok(answer_and_doubts) => answer_and_doubts,
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    };
    let Answer::Components(intersection) = answer else {
        panic!("{answer:?}");
    };
    assert!(
        intersection.settled(),
        "{name}, seed {seed}: {intersection:#?}"
    );
    let of_point = |set: &WitnessSet| {
        assert_eq!(set.dimension(), 0, "{name}, seed {seed}");
        let values = set.points[0].iter();
        values
            .map(|z| {
                assert!(z.im.abs() < 1e-8);
                z.re
            })
            .collect()
    };
    intersection.components.iter().map(of_point).collect()
}

/// Where the mechanism goes from two degrees of freedom to one: c = 0, both points above or below (`intersections` of
/// its `meta.json`).
#[test]
fn switching_points_of_a_kinematotropic_mechanism() {
    for seed in seeds() {
        let points = common_points("kinematotropic", [(2, 4), (1, 2)], seed);
        assert_eq!(points.len(), 4, "seed {seed}: {points:?}");
        for point in points {
            let [xa, ya, xb, yb, c] = point[..] else {
                panic!("five variables");
            };
            let near = |a: f64, b: f64| (a - b).abs() < 1e-7;
            assert!(near(xa, 0.0) && near(xb, 0.0) && near(c, 0.0));
            assert!(near(ya.abs(), 1.0) && near(yb.abs(), 1.0));
        }
    }
}

/// A parallelogram folds onto its base line, where it can go on as an antiparallelogram.
#[test]
fn folding_points_of_a_parallelogram() {
    for seed in seeds() {
        let mut points = common_points("four_bar_parallelogram", [(1, 2), (1, 4)], seed);
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert_eq!(points.len(), 2, "seed {seed}: {points:?}");
        let expected = [[-2.0, 0.0, 1.0, 0.0], [2.0, 0.0, 5.0, 0.0]];
        for (point, expected) in points.iter().zip(expected) {
            let apart = point.iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-7, "{point:?}");
        }
    }
}

/// A part of the real points, by their coordinates.
type Part = fn(&[f64]) -> bool;

fn check_real_points(name: &str, system: &System, parts: &[Part]) {
    for seed in seeds() {
        let answer = ask(name, system, seed, &Question::RealPoints);
        let Answer::RealPoints(real_points) = answer else {
            panic!("{answer:?}");
        };
        let points = real_points.iter().flat_map(|c| &c.points);
        let points: Vec<Vec<f64>> = points
            .map(|p| p.point.iter().map(|z| z.re).collect())
            .collect();
        assert_eq!(points.is_empty(), parts.is_empty(), "{name}, seed {seed}");
        for (k, part) in parts.iter().enumerate() {
            let met = points.iter().any(|p| part(p));
            assert!(met, "{name}, seed {seed}: part {k} of {points:?}");
        }
    }
}

/// `real_pieces` of the `meta.json` of these systems; the rest by their equations.
#[test]
fn real_points_are_on_every_part() {
    let everywhere: Part = |_| true;
    check_real_points(
        "real_cubic",
        &instance("real_cubic"),
        &[|p| p[0] < 0.5, |p| p[0] > 0.5],
    );
    check_real_points(
        "real_acnode",
        &instance("real_acnode"),
        &[|p| p[0].abs() < 1e-4, |p| p[0] > 0.9],
    );
    let torus = "variable_group x, y, z; function f; f = (x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2);";
    check_real_points("torus", &written(torus), &[everywhere]);
    let sphere = "variable_group x, y, z; function f; f = x^2 + y^2 + z^2 - 1;";
    check_real_points("sphere", &written(sphere), &[everywhere]);
    let sheets = "variable_group x, y, z; function f; f = z^2 - x^2 - y^2 - 1;";
    check_real_points(
        "hyperboloid of two sheets",
        &written(sheets),
        &[|p| p[2] > 0.0, |p| p[2] < 0.0],
    );
    let none = "variable_group x, y; function f; f = x^2 + y^2 + 1;";
    check_real_points("empty conic", &written(none), &[]);
    let circle = written("variable_group p, P; function f; f = p*P - 1;");
    let circle = cognate_tests::systems::with_conjugates(circle, "p~P");
    check_real_points("isotropic circle", &circle, &[everywhere]);
}

/// Euler characteristic with compact support, whether it is bounded, connected parts.
fn check_surface(name: &str, equation: &str, expected: (i64, bool, u64)) {
    let system = written(&format!(
        "variable_group x, y, z; function f; f = {equation};"
    ));
    for seed in seeds() {
        let answer = ask(name, &system, seed, &Question::RealSurface { samples: 3 });
        let Answer::RealSurface(surfaces) = answer else {
            panic!("{answer:?}");
        };
        let [surface] = surfaces.as_slice() else {
            panic!("{name}: one component");
        };
        let counts = surface.mesh.counts();
        let topology = (surface.euler, surface.compact, counts.parts);
        assert_eq!(topology, expected, "{name}, seed {seed}: {counts:?}");
        if surface.compact {
            assert_eq!(
                (counts.euler, counts.border),
                (surface.euler, 0),
                "{name}, seed {seed}"
            );
        }
        // The points are on the surface.
        let equation = SlicedEquations::new(&system, Vec::new());
        for point in surface.mesh.vertices.iter().step_by(97) {
            assert!(
                relative_residual(&equation, point) < 1e-6,
                "{name}, seed {seed}: {point:?}"
            );
        }
    }
}

/// The value of an equation at a vertex of a mesh, relative to how the fourth power of the coordinates grows.
fn relative_residual(equation: &SlicedEquations, vertex: &[f64; 3]) -> f64 {
    let size = vertex.iter().map(|x| x.abs()).fold(1.0, f64::max);
    let point = vertex.map(|x| exactly(Complex64::new(x, 0.0)));
    equation.residuals(&point)[0].0 / size.powi(4)
}

macro_rules! real_surfaces {
    ($($name:ident: $equation:expr, $expected:expr;)*) => {$(
        #[test]
        fn $name() {
            check_surface(stringify!($name), $equation, $expected);
        }
    )*};
}

// Euler characteristics by hand: a sphere has 2, a torus 0, a plane 1, a cylinder 0; at a cone's apex two planes meet. The
// cubic of Cayley is a ball with four cones at its nodes, 2 + 4 * 0. That of Clebsch, with 27 real lines, has -5 with its
// points at infinity, which are three lines, 3 - 6. The tangle is a sphere with five handles,
// which by its symmetries has critical values near each other. Cartan's umbrella is a graph over the plane without the origin, 0,
// and a line, -1.
real_surfaces! {
    surface_sphere: "x^2 + y^2 + z^2 - 1", (2, true, 1);
    surface_ellipsoid: "x^2 + 4*y^2 + 9*z^2 - 2*x - 5", (2, true, 1);
    surface_torus: "(x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2)", (0, true, 1);
    surface_hyperboloid: "x^2 + y^2 - z^2 - 1", (0, false, 1);
    surface_two_sheets: "x^2 + y^2 - z^2 + 1", (2, false, 2);
    surface_paraboloid: "x^2 + 2*y^2 - z", (1, false, 1);
    surface_saddle: "x*y - z", (1, false, 1);
    surface_cone: "x^2 + y^2 - z^2", (1, false, 1);
    surface_empty: "x^2 + y^2 + z^2 + 1", (0, true, 0);
    surface_point: "x^2 + 2*y^2 + 3*z^2", (1, true, 1);
    surface_quartic_ball: "x^4 + y^4 + z^4 - 1", (2, true, 1);
    surface_tangle: "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5", (-8, true, 1);
    surface_three_handles: "x^4 - 5*x^2 + x + y^4 - 4*y^2 - y/2 + z^4 - 3*z^2 + z/3 + 11/2", (-4, true, 1);
    surface_cartan: "x^3 - z*(x^2 + y^2)", (-1, false, 1);
    surface_cayley: "x^2 + y^2 + z^2 - 2*x*y*z - 1", (2, false, 1);
    surface_clebsch: "x^3 + y^3 + z^3 + 1 - (x + y + z + 1)^3", (-2, false, 1);
}

/// Properties of a surface that are answered without doubt: its Euler characteristic, and whether it is bounded.
fn surface_without_doubt(name: &str, equation: &str, seed: u64) -> Option<(i64, bool)> {
    let system = written(&format!(
        "variable_group x, y, z; function f; f = {equation};"
    ));
    let decomposition = components(name, &system, seed);
    let question = Question::RealSurface { samples: 2 };
    let solve = QuestionSolve::new(
        &system,
        &options(seed),
        &decomposition.components,
        &question,
    );
    let (answer, doubts) = run_locally(solve.expect("it can be asked"), 8).expect("stages run");
    let Answer::RealSurface(surfaces) = answer else {
        panic!("{answer:?}");
    };
    let said = (surfaces[0].euler, surfaces[0].compact);
    doubts.is_empty().then_some(said)
}

/// Whitney's umbrella with its handle, the half of the double line that is on no sheet: the image of a plane with
/// (0, t) and (0, -t) glued together, 1 + 1, and an open half-line, -1.
#[test]
fn whitneys_umbrella_has_its_handle() {
    for seed in seeds() {
        let said = surface_without_doubt("whitney", "x^2 - y^2*z", seed);
        assert_eq!(said, Some((1, false)), "{seed}");
    }
}

/// A torus twenty times its radius from the origin, where critical points were lost once without a word.
#[test]
fn a_torus_far_away_is_a_torus() {
    let torus = "((x - 20)^2 + (y + 10)^2 + z^2 + 3)^2 - 16*((x - 20)^2 + (y + 10)^2)";
    for seed in seeds() {
        let said = surface_without_doubt("torus", torus, seed);
        assert_eq!(said, Some((0, true)), "{seed}");
    }
}

/// Surfaces with double lines, and a quartic with 16 nodes: right, or now and then a doubt; why they have these Euler
/// characteristics stands in `tests/surfaces/known.json`.
#[test]
fn surfaces_with_double_lines_and_nodes_are_right_or_in_doubt() {
    let euler_numbers = [
        ("kolibri", "x^3 + x^2*z^2 - y^2", 3),
        ("steiner", "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z", -1),
        (
            "kummer",
            "7*(x^4 + y^4 + z^4 + 1) + 396*x*y*z - 19*(x^2 + y^2*z^2) - 91*(y^2 + x^2*z^2) - 91*(z^2 + x^2*y^2)",
            0,
        ),
    ];
    for (name, equation, euler) in euler_numbers {
        for seed in seeds().step_by(3) {
            let said = surface_without_doubt(name, equation, seed);
            let wrong = said.is_some_and(|said| said != (euler, false));
            assert!(!wrong, "{name}, seed {seed}: {said:?}");
            assert!(said.is_some() || seed > 1, "{name}, seed {seed}");
        }
    }
}
