//! Components under a symmetry group, and dimensions whose points stay one set.

use super::{counted, decompose, doubts, instance};
use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, run_locally};
use cognate_solutions::witness::{Decomposition, Doubt, Irreducible};
use cognate_systems::formats;
use cognate_systems::system::System;
use cognate_tests::systems::written;

/// The system `system` with generators in the notation of `--symmetry`.
fn with_symmetry(mut system: System, generators: &str) -> System {
    match formats::symmetry::read("generators", generators.as_bytes(), &mut system) {
        Ok(()) => system,
        Err(error) => panic!("{error}"),
    }
}

fn orbits(decomposition: &Decomposition) -> Vec<Option<u32>> {
    decomposition
        .components
        .iter()
        .map(|set| set.orbit)
        .collect()
}

/// Turning the variables exchanges x0 x1 = 1 and x0 x1 = -1.
const TURN: &str = r#"[{"permutation": {"x0": "x1", "x1": "x2", "x2": "x3", "x3": "x0"}}]"#;

#[test]
fn components_that_a_symmetry_exchanges_are_one_orbit() {
    for seed in 1..=3 {
        let decomposition = decompose(&with_symmetry(instance("cyclic_4"), TURN), seed);
        assert!(
            decomposition.settled(),
            "seed {seed}: {}",
            doubts(&decomposition)
        );
        assert_eq!(counted(&decomposition), [(1, 2, 1, 2)]);
        assert_eq!(orbits(&decomposition), [Some(1), Some(1)]);
    }
    // Each of them is its own image where the group is the square of that.
    let half = r#"[{"permutation": {"x0": "x2", "x1": "x3", "x2": "x0", "x3": "x1"}}]"#;
    let decomposition = decompose(&with_symmetry(instance("cyclic_4"), half), 1);
    assert_eq!(orbits(&decomposition), [Some(1), Some(2)]);
}

/// Thirty points, too many for all unions to be tried: loops bring them together, of one point of each orbit.
#[test]
fn one_component_of_an_orbit_is_split() {
    let system = || {
        written(
            "variable_group x, y; function f; f = (x^15 + y^4*x^7 - 2*y + 1)*(y^15 + x^4*y^7 - 2*x + 1);",
        )
    };
    let exchange = r#"[{"permutation": {"x": "y", "y": "x"}}]"#;
    for system in [system(), with_symmetry(system(), exchange)] {
        let decomposition = decompose(&system, 1);
        assert!(decomposition.settled(), "{}", doubts(&decomposition));
        assert_eq!(counted(&decomposition), [(1, 15, 1, 2)]);
        let loops = decomposition.components[0].evidence.loops;
        assert!(loops > 0);
    }
    let decomposition = decompose(&with_symmetry(system(), exchange), 1);
    assert_eq!(orbits(&decomposition), [Some(1), Some(1)]);
}

/// Isolated points have orbits, too: two that are exchanged and one that stays.
#[test]
fn points_have_orbits() {
    let system = written("variable_group x, y; function f, g; f = x*y*(x - y); g = x + y - 1;");
    let exchange = r#"[{"permutation": {"x": "y", "y": "x"}}]"#;
    let decomposition = decompose(&with_symmetry(system, exchange), 1);
    assert!(decomposition.settled(), "{}", doubts(&decomposition));
    let of_middle = |set: &&cognate_solutions::witness::WitnessSet| {
        (set.points[0][0] - set.points[0][1]).norm_sqr() < 1e-12
    };
    let middle = decomposition
        .components
        .iter()
        .find(of_middle)
        .unwrap()
        .orbit;
    let others: Vec<Option<u32>> = orbits(&decomposition)
        .into_iter()
        .filter(|o| *o != middle)
        .collect();
    assert_eq!(others.len(), 2);
    assert_eq!(others[0], others[1]);
}

/// A claimed symmetry that is none does not change the components that are found, and is not believed.
#[test]
fn what_is_no_symmetry_is_a_doubt() {
    let wrong = r#"[{"map": {"x0": "2*x0"}}]"#;
    let decomposition = decompose(&with_symmetry(instance("cyclic_4"), wrong), 1);
    assert_eq!(counted(&decomposition), [(1, 2, 1, 2)]);
    assert!(!decomposition.settled());
    let doubt = Doubt::Symmetry { generators: 1 };
    let curves = decomposition
        .dimensions
        .iter()
        .find(|d| d.number == 1)
        .unwrap();
    assert_eq!(curves.doubts, [doubt]);
    assert_eq!(orbits(&decomposition), [None, None]);
}

#[test]
fn points_stay_one_set_where_that_is_asked() {
    let options = DecompositionOptions {
        split: false,
        ..DecompositionOptions::default()
    };
    for (system, degree) in [(instance("twisted_cubic"), 3), (instance("cyclic_4"), 4)] {
        let solve = DecompositionSolve::new(&system, &options).unwrap();
        let decomposition = run_locally(solve, 8).unwrap();
        assert!(decomposition.settled(), "{}", doubts(&decomposition));
        let [set] = decomposition.components.as_slice() else {
            panic!("{:?}", counted(&decomposition));
        };
        assert_eq!(
            (set.degree, set.irreducible),
            (degree, Irreducible::NotAsked)
        );
    }
}
