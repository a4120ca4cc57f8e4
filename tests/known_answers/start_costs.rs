//! Costs of each start: published numbers, found without being told the groups.

use crate::check::solve;
use cognate_algorithms::start_costs::{StartCosts, StartKind};
use cognate_algorithms::{SolveMethod, SolveOptions, plan};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::completeness::Completeness;
use cognate_systems::named::{cyclic, eco, katsura, noon};
use cognate_systems::system::{System, VariableGroup};
use cognate_tests::systems::{shared, six_revolute_axis_vectors, written};

/// All variables in one affine group, as in a file that names no groups.
fn without_groups(mut system: System) -> System {
    system.groups = vec![VariableGroup {
        variables: (0..system.variable_count()).collect(),
        homogeneous: false,
    }];
    system
}

fn costs(system: &System) -> StartCosts {
    match StartCosts::of(system) {
        Ok(costs) => costs,
        Err(error) => panic!("{error}"),
    }
}

/// Survey, section 6.1, and the tables of the mechanisms.
#[test]
fn the_best_groups_are_found_without_being_told() {
    for (name, system, total, best) in [
        (
            "nine points",
            without_groups(shared("nine_point_problem3")),
            1_048_576,
            286_720,
        ),
        (
            "6R, eight quadrics",
            without_groups(shared("six_revolute_manseur_doty_tm8")),
            256,
            96,
        ),
        ("6R, axis vectors", six_revolute_axis_vectors(), 1024, 320),
        (
            "five poses",
            without_groups(shared("burmester_five_poses_real4")),
            16,
            6,
        ),
        ("3-RPR", without_groups(shared("three_rpr_real6")), 16, 6),
    ] {
        let costs = costs(&system);
        assert_eq!(costs.total_degree, Some(total), "{name}");
        let multihomogeneous = &costs.multihomogeneous;
        assert_eq!(
            multihomogeneous.number,
            Some(best),
            "{name}: {:?}",
            multihomogeneous.groups
        );
        // Twelve equations of ten kinds are beyond the exact search.
        let exact = name != "6R, axis vectors";
        let note = &costs.notes["groups"];
        assert_eq!(note.contains("best partition"), exact, "{name}");
        let chosen = costs.choice == Some(StartKind::Multihomogeneous);
        let said = costs.why.contains("the best of all");
        assert_eq!(said, exact && chosen, "{name}");
    }
}

#[test]
fn groups_of_the_file_are_kept() {
    // The file of the five poses has the two groups that the search finds, too;
    // here they are others, which cost more.
    let mut system = shared("burmester_five_poses_real4");
    let group = |variables: Vec<usize>| VariableGroup {
        variables,
        homogeneous: false,
    };
    system.groups = vec![group(vec![0, 1, 2]), group(vec![3])];
    let costs = costs(&system);
    assert_eq!(
        costs.multihomogeneous.groups,
        [vec!["a", "b", "A"], vec!["B"]]
    );
    assert_eq!(costs.multihomogeneous.number, Some(32));
    assert!(!costs.notes.contains_key("groups"));
}

/// Noonburg (1989); Morgan (1987, chapter 10) and Verschelde's collection; the
/// tables of the mechanisms.
#[test]
fn mixed_volumes_are_the_published_ones() {
    for (name, system, expected) in [
        ("cyclic-5", cyclic(5).system, 70),
        ("cyclic-7", cyclic(7).system, 924),
        ("noon-5", noon(5).system, 233),
        ("eco-8", eco(8).system, 64),
        ("katsura-6", katsura(6).system, 64),
        ("katsura-8", katsura(8).system, 256),
        ("6R", shared("six_revolute_manseur_doty_tm8"), 64),
        ("five poses", shared("burmester_five_poses_real4"), 4),
        ("3-RPR", shared("three_rpr_real6"), 6),
    ] {
        let costs = costs(&system);
        assert_eq!(
            costs.mixed_volume,
            Some(expected),
            "{name}: {:?}",
            costs.notes
        );
    }
}

/// Ten quadrics with one leading form in ten unknowns: their differences are linear, so that two of the 1024
/// paths that degrees, groups and mixed cells say end at solutions.
fn quadrics_with_one_leading_form() -> String {
    let mut random = RandomStream::new(5, Purpose::Test, 0);
    let mut number = || random.below(19) as i64 - 9;
    let names: Vec<String> = (1..=10).map(|k| format!("x{k}")).collect();
    let mut leading = String::from("0");
    for (i, x) in names.iter().enumerate() {
        for y in &names[i..] {
            leading += &format!(" + ({})*{x}*{y}", number());
        }
    }
    let mut text = format!("variable_group {}; function ", names.join(", "));
    text += &(1..=10)
        .map(|k| format!("f{k}"))
        .collect::<Vec<_>>()
        .join(", ");
    text += ";";
    for k in 1..=10 {
        let linear = names.iter().map(|x| format!(" + ({})*{x}", number()));
        let linear: String = linear.collect();
        text += &format!(" f{k} = {leading}{linear} + {};", number() + 20);
    }
    text
}

#[test]
fn where_most_paths_are_wasted_equations_are_taken_one_by_one() {
    let system = written(&quadrics_with_one_leading_form());
    let options = SolveOptions::default();
    let chosen = plan(&system, &options).unwrap();
    assert_eq!(chosen.start, StartKind::Regeneration, "{}", chosen.why);
    assert!(
        chosen
            .why
            .contains("of the 1024 paths by the total-degree start"),
        "{}",
        chosen.why
    );
    let (_, sets) = solve(&system, &options, &|_| None);
    let counts = &sets[0].counts;
    assert_eq!((counts.distinct, counts.complete), (2, Completeness::Yes));
    assert!(sets[0].settled());
    let solve_plan = plan(&katsura(10).system, &options).unwrap();
    assert_ne!(solve_plan.start, StartKind::Regeneration);
}

/// The first equation is a square: all solutions are double, and lost where regeneration begins with it. An answer that
/// may miss solutions is settled only where that start was asked for.
#[test]
fn what_a_chosen_regeneration_leaves_behind_is_not_settled() {
    let text = quadrics_with_one_leading_form();
    let (before, after) = text.split_once("f1 = ").unwrap();
    let (_, after) = after.split_once(';').unwrap();
    let system = written(&format!("{before}f1 = (x1 + 2*x2 - 3*x5 + 1)^2;{after}"));
    let mut options = SolveOptions::default();
    assert_eq!(
        plan(&system, &options).unwrap().start,
        StartKind::Regeneration
    );
    // With a count the equations settle it.
    let (_, sets) = solve(&system, &options, &|_| None);
    let counts = &sets[0].counts;
    assert!(
        sets[0].settled() && counts.complete == Completeness::Yes,
        "{counts:?}"
    );
    options.closings.no_exact_count = true;
    let (_, sets) = solve(&system, &options, &|_| None);
    assert!(!sets[0].settled() && sets[0].paths.failed == 2);
    options.method = SolveMethod::Regeneration;
    let (_, sets) = solve(&system, &options, &|_| None);
    assert!(sets[0].settled() && sets[0].counts.complete == Completeness::NotKnown);
}
