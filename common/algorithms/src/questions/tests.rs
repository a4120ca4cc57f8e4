//! Questions to small sets whose answers are known.

use super::*;
use crate::decomposition::{DecompositionSolve, run_locally as decompose};
use cognate_solutions::witness::answer::{Membership, Samples};
use cognate_solutions::witness::question::{GivenPoint, SampleWish};
use cognate_solutions::witness::{ComponentId, Decomposition};
use cognate_systems::formats;
use num_complex::Complex64;

/// A sphere, a twisted cubic, three lines and a point (Sommese, Verschelde, Wampler 2001).
const ILLUSTRATIVE: &str = "variable_group x, y, z; function f, g, h; \
    s = x^2 + y^2 + z^2 - 1; \
    f = (y - x^2)*s*(x - 1/2); g = (z - x^3)*s*(y - 1/2); h = (y - x^2)*(z - x^3)*s*(z - 1/2);";
pub(super) const TWISTED_CUBIC: &str =
    "variable_group x, y, z; function f, g, h; f = y - x^2; g = z - x*y; h = x*z - y^2;";

pub(super) fn system(text: &str) -> System {
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    formats::read("test", text.as_bytes()).unwrap().system
}

pub(super) fn components(system: &System, seed: u64) -> Decomposition {
    let options = DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    };
    let decomposition = decompose(DecompositionSolve::new(system, &options).unwrap(), 8).unwrap();
    assert!(decomposition.settled());
    decomposition
}

/// Asks with another seed than that of the decomposition: nothing may depend on it.
pub(super) fn ask(
    system: &System,
    sets: &[WitnessSet],
    question: &Question,
) -> (Answer, Vec<String>) {
    let options = DecompositionOptions {
        seed: 77,
        ..DecompositionOptions::default()
    };
    let solve = QuestionSolve::new(system, &options, sets, question).unwrap();
    run_locally(solve, 8).unwrap()
}

fn given(values: &[f64]) -> GivenPoint {
    GivenPoint {
        values: values.iter().map(|&x| Complex64::new(x, 0.0)).collect(),
        accuracy: f64::EPSILON,
    }
}

fn members(system: &System, sets: &[WitnessSet], points: Vec<GivenPoint>) -> Vec<Membership> {
    match ask(system, sets, &Question::Member { points }) {
        (Answer::Member(memberships), _) => memberships,
        (other, _) => panic!("{other:?}"),
    }
}

#[test]
fn points_are_found_on_their_components() {
    let system = system(ILLUSTRATIVE);
    for seed in 1..=3 {
        let decomposition = components(&system, seed);
        let expected: [(&[f64], &[u32]); 7] = [
            (&[0.6, 0.8, 0.0], &[2]),
            (&[2.0, 4.0, 8.0], &[1]),
            (&[0.5, 0.25, 0.125], &[1, 1]),
            (&[0.5, 7.0, 0.125], &[1]),
            (&[0.5, 0.5, 0.5], &[0]),
            (&[1.0, 1.0, 2.0], &[]),
            (&[2.0, 4.0, 8.0 + 1e-6], &[]),
        ];
        let points = expected.iter().map(|(point, _)| given(point)).collect();
        let memberships = members(&system, &decomposition.components, points);
        for ((point, dimensions), membership) in expected.iter().zip(memberships) {
            let on: Vec<u32> = membership.on.iter().map(|id| id.dimension).collect();
            assert_eq!(&on, dimensions, "seed {seed}, {point:?}: {membership:?}");
            assert!(
                membership.unsettled.is_empty(),
                "seed {seed}: {membership:?}"
            );
        }
    }
}

#[test]
fn a_point_that_is_not_known_well_enough_is_in_doubt() {
    let system = system(TWISTED_CUBIC);
    let decomposition = components(&system, 1);
    // Off the curve by more than its own error, and by less than what would be clear.
    let near = |apart: f64, accuracy: f64| GivenPoint {
        accuracy,
        ..given(&[2.0, 4.0, 8.0 + apart])
    };
    let points = vec![near(1e-8, 1e-7), near(1e-3, 1e-7), near(1.0, 1e-7)];
    let memberships = members(&system, &decomposition.components, points);
    assert_eq!(memberships[0].on.len(), 1, "{memberships:?}");
    assert_eq!(
        (memberships[1].on.len(), memberships[1].unsettled.len()),
        (0, 1),
        "{memberships:?}"
    );
    assert!(
        memberships[1].unsettled[0]
            .distance
            .is_some_and(|d| d > 1e-6)
    );
    assert!(memberships[2].on.is_empty() && memberships[2].unsettled.is_empty());
}

fn samples(system: &System, sets: &[WitnessSet], wish: SampleWish) -> Samples {
    match ask(system, sets, &Question::Sample(wish)) {
        (Answer::Sample(mut samples), doubts) => {
            assert!(doubts.is_empty(), "{doubts:?}");
            samples.remove(0)
        }
        (other, _) => panic!("{other:?}"),
    }
}

#[test]
fn samples_lie_on_their_component_and_where_they_are_wanted() {
    let system = system("variable_group x, y; function f; f = (x^2 + y^2 - 1)*(x - 5);");
    let decomposition = components(&system, 2);
    let circle = decomposition
        .components
        .iter()
        .find(|set| set.degree == 2)
        .unwrap();
    let circle = std::slice::from_ref(circle);
    let value = |p: &[Complex64]| p[0] * p[0] + p[1] * p[1] - 1.0;
    let wishes = [
        SampleWish {
            count: 25,
            ..SampleWish::default()
        },
        SampleWish {
            count: 12,
            real: true,
            ..SampleWish::default()
        },
        SampleWish {
            count: 9,
            within: vec![[0.0, 1.0], [-1.0, 0.0]],
            ..SampleWish::default()
        },
        SampleWish {
            count: 5,
            near: Some(given(&[0.6, 0.8])),
            real: true,
            ..SampleWish::default()
        },
    ];
    for wish in wishes {
        let circle_samples = samples(&system, circle, wish.clone());
        assert_eq!(circle_samples.points.len() as u64, wish.count);
        for p in &circle_samples.points {
            assert!(
                value(p).norm_sqr() < 1e-20 * (1.0 + p[0].norm_sqr()),
                "{p:?}"
            );
            let real = p.iter().all(|z| z.im == 0.0);
            let anywhere = !wish.real && wish.within.is_empty();
            assert!(real || anywhere, "{p:?}");
            for ([low, high], z) in wish.within.iter().zip(p) {
                assert!((low..=high).contains(&&z.re), "{p:?}");
            }
            if wish.near.is_some() {
                assert!((p[0].re - 0.6).abs() < 0.1 && (p[1].re - 0.8).abs() < 0.1);
            }
        }
    }
    // No real point is there.
    let empty = system_without_real_points();
    let decomposition = components(&empty, 2);
    let wish = SampleWish {
        count: 1,
        real: true,
        ..SampleWish::default()
    };
    let (_, doubts) = ask(&empty, &decomposition.components, &Question::Sample(wish));
    assert_eq!(doubts.len(), 1);
}

fn system_without_real_points() -> System {
    system("variable_group x, y; function f; f = x^2 + y^2 + 1;")
}

#[test]
fn images_of_the_twisted_cubic() {
    let system = system(TWISTED_CUBIC);
    for seed in 1..=3 {
        let decomposition = components(&system, seed);
        let expected = [([0, 1], 2), ([1, 2], 3), ([0, 2], 3)];
        for (onto, degree) in expected {
            let onto = onto.to_vec();
            let (answer, doubts) = ask(
                &system,
                &decomposition.components,
                &Question::Project { onto },
            );
            let Answer::Project(images) = answer else {
                panic!("{answer:?}");
            };
            assert!(doubts.is_empty(), "{doubts:?}");
            let image = &images[0];
            let numbers = (image.dimension, image.degree, image.fiber_degree);
            assert_eq!(numbers, (Some(1), Some(degree), Some(1)));
        }
    }
}

#[test]
fn fibres_are_counted_apart_from_images() {
    // A cylinder over a circle, covered twice by w.
    let text = "variable_group x, y, z, w; function f, g; f = x^2 + y^2 - 1; g = w^2 - z;";
    let system = system(text);
    let decomposition = components(&system, 3);
    let onto = vec![0, 1, 2];
    let (answer, _) = ask(
        &system,
        &decomposition.components,
        &Question::Project { onto },
    );
    let Answer::Project(images) = answer else {
        panic!("{answer:?}");
    };
    let image = &images[0];
    assert_eq!((image.dimension, image.degree), (Some(2), Some(2)));
    assert_eq!(
        (image.fiber_dimension, image.fiber_degree),
        (Some(0), Some(2))
    );
    let onto = vec![0, 1];
    let (answer, _) = ask(
        &system,
        &decomposition.components,
        &Question::Project { onto },
    );
    let Answer::Project(images) = answer else {
        panic!("{answer:?}");
    };
    let image = &images[0];
    assert_eq!((image.dimension, image.degree), (Some(1), Some(2)));
    assert_eq!(
        (image.fiber_dimension, image.fiber_degree),
        (Some(1), Some(2))
    );
}

#[test]
fn degrees_by_groups() {
    let text = "hom_variable_group s, t; hom_variable_group x, y, z; function f, g; \
                f = s*x + t*y; g = s*y + t*z;";
    let system = system(text);
    let seed = 77;
    let decomposition = components(&system, seed);
    let (answer, doubts) = ask(&system, &decomposition.components, &Question::Multidegree);
    let Answer::Multidegree { components, groups } = answer else {
        panic!("{answer:?}");
    };
    assert!(doubts.is_empty() && groups.len() == 2, "{doubts:?}");
    let degrees: Vec<(Vec<u32>, Option<u64>)> = components[0]
        .degrees
        .iter()
        .map(|d| (d.slices.clone(), d.degree))
        .collect();
    assert_eq!(degrees, [(vec![1, 0], Some(1)), (vec![0, 1], Some(2))]);
}

#[test]
fn a_double_line_is_asked_by_its_deflated_equations() {
    let system = system("variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2);");
    let decomposition = components(&system, 4);
    let points = vec![given(&[3.0, 3.0]), given(&[2.0, 2.0]), given(&[1.0, -1.0])];
    let memberships = members(&system, &decomposition.components, points);
    let on: Vec<usize> = memberships.iter().map(|m| m.on.len()).collect();
    assert_eq!(on, [1, 2, 1], "{memberships:?}");
}

#[test]
fn mobility_of_points_of_two_components() {
    let system = system("variable_group x, y; function f; f = x*y*(x^2 + y^2 - 1);");
    let decomposition = components(&system, 5);
    let points = vec![given(&[0.0, 0.0]), given(&[0.6, 0.8]), given(&[0.5, 0.5])];
    let question = Question::Mobility { points, depth: 6 };
    let (answer, _) = ask(&system, &decomposition.components, &question);
    let Answer::Mobility(points) = answer else {
        panic!("{answer:?}");
    };
    assert_eq!(points[0].infinitesimal, Some(2), "{points:?}");
    assert_eq!(points[0].dimensions_by_order[..3], [1, 3, 5]);
    assert_eq!(
        (points[0].local_dimension, points[0].on.len()),
        (Some(1), 2)
    );
    assert_eq!(
        (points[1].local_dimension, points[1].on.len()),
        (Some(1), 1)
    );
    assert_eq!(points[2].local_dimension, None);
}

#[test]
fn what_is_not_whole_is_found() {
    let system = system(ILLUSTRATIVE);
    let decomposition = components(&system, 6);
    let ok = ask(&system, &decomposition.components, &Question::Check);
    assert!(ok.1.is_empty(), "{ok:?}");
    // A lost witness point.
    let mut lost = decomposition.components.clone();
    let cubic = lost.iter().position(|set| set.degree == 3).unwrap();
    let point = lost[cubic].points.pop().unwrap();
    lost[cubic].degree -= 1;
    assert_eq!(ask(&system, &lost, &Question::Check).1.len(), 1);
    // It is another component's.
    let line = lost.iter().position(|set| set.degree == 1).unwrap();
    lost[line].points.push(point);
    lost[line].degree += 1;
    assert_eq!(ask(&system, &lost, &Question::Check).1.len(), 2);
    // A coordinate, a multiplicity, a name.
    let options = DecompositionOptions::default();
    let refused = |sets: &[WitnessSet]| {
        let solve = QuestionSolve::new(&system, &options, sets, &Question::Check);
        solve
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    let mut moved = decomposition.components.clone();
    moved[cubic].points[1][2].im += 1e-6;
    assert!(
        refused(&moved).contains("witness point 2"),
        "{}",
        refused(&moved)
    );
    let mut multiple = decomposition.components.clone();
    multiple[0].multiplicity.scheme = Some(2);
    assert!(refused(&multiple).contains("multiplicity 2"));
    let mut deflated = decomposition.components.clone();
    for ranks in [vec![1000; 3], vec![0; 9], vec![u32::MAX]] {
        deflated[0].deflation = ranks;
        assert!(refused(&deflated).contains("deflations"));
    }
    let mut too_large = decomposition.components.clone();
    too_large[0].id.dimension = 3;
    assert!(refused(&too_large).contains("dimensions 0 to 2"));
    let mut twice = decomposition.components.clone();
    twice[1].id = twice[2].id;
    assert!(refused(&twice).contains("there twice"));
    assert_eq!(
        decomposition.components[0].id,
        ComponentId {
            dimension: 2,
            number: 1
        }
    );
}

#[test]
fn witness_points_are_proved_and_different() {
    for text in [
        ILLUSTRATIVE,
        "variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2);",
    ] {
        let system = system(text);
        let decomposition = components(&system, 2);
        let (answer, doubts) = ask(&system, &decomposition.components, &Question::Certify);
        let Answer::Certify(proved) = answer else {
            panic!("{answer:?}");
        };
        assert!(doubts.is_empty(), "{doubts:?}");
        let points: u64 = proved.iter().map(|c| c.certified).sum();
        assert_eq!(
            points,
            decomposition
                .components
                .iter()
                .map(|set| set.degree)
                .sum::<u64>()
        );
    }
}
