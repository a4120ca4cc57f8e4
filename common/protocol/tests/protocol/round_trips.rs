//! Everything that is written is read back equal; equal things have equal names.

use crate::support::Draw;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::Coordinates;
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::start_systems::polyhedral::branches::{BRANCHES, CellBranches};
use cognate_continuation::work::{Stage, Work};
use cognate_protocol::submission::{Asked, Decompose, Options, Source, Submission};
use cognate_protocol::{digest, from_proto, records, to_proto, v1};
use cognate_solutions::witness::question::{CurveWish, SecondSet};
use cognate_solutions::witness::witness_set::Multiplicity;
use cognate_solutions::witness::{
    ComponentId, Evidence, Irreducible, KnownComponents, Method, Question, WitnessSet,
};
use num_complex::Complex64;
use proptest::prelude::*;
use prost::Message;

/// Through the bytes of a message.
fn sent<M: Message + Default>(message: &M) -> M {
    M::decode(message.encode_to_vec().as_slice()).expect("what was encoded can be decoded")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn systems_come_back_with_their_digest(seed: u64) {
        let system = match seed % 2 {
            0 => Draw::new(seed).system(),
            _ => Draw::new(seed).system_with_helpers(),
        };
        let back = from_proto::problem::system(&sent(&to_proto::problem::system(&system))).unwrap();
        prop_assert_eq!(&back, &system);
        let bytes = digest::encode_system(&system);
        prop_assert_eq!(&digest::decode_system(&bytes).unwrap(), &system);
        prop_assert_eq!(digest::of_system(&back), digest::of_bytes(&bytes));
    }

    #[test]
    fn submissions_come_back(seed: u64) {
        let mut draw = Draw::new(seed);
        let source = if seed % 2 == 0 {
            Source::System(Box::new(draw.system()))
        } else {
            Source::Text { name: "a.txt".to_owned(), content: b"x^2 - 2;".to_vec() }
        };
        let options = draw.options();
        let dimensions = (seed % 2 == 0).then_some([(seed % 5) as u32, 5 + (seed % 7) as u32]);
        let idle_loops = (seed % 3 == 0).then_some(1 + (seed % 200) as u32);
        let method = Method::ALL.get((seed % 5) as usize).copied();
        let known_components = (seed % 4 == 1).then_some(KnownComponents {
            equations: 1 + (seed % 9) as u32,
            components: vec![component(1, 2), component(0, 1)],
            parameters: vec![Complex64::new(0.5, -2.0); (seed % 3) as usize],
        });
        let verify = seed % 3 == 1;
        let without_split = seed % 5 == 2;
        let decompose = Some(Decompose { dimensions, idle_loops, method, verify, without_split, known: known_components });
        for options in [Options { decompose, ..options.clone() }, options] {
            let submission = Submission { source: source.clone(), options };
            let message: v1::Problem = sent(&to_proto::problem::submission(&submission));
            prop_assert_eq!(from_proto::problem::submission(message).unwrap(), submission);
        }
    }

    #[test]
    fn stages_come_back(seed: u64) {
        let mut draw = Draw::new(seed);
        let sharpening = Stage { work: Work::Sharpen { digits: 50 }, ..draw.stage() };
        let of_cells = |count, branches| StartPoints::MixedCells { count, branches: Some(branches) };
        let counting = Stage {
            work: Work::CountMixedCells,
            start_points: of_cells(0, CellBranches::uncounted(2)),
            ..draw.stage()
        };
        let branches = CellBranches {
            lifting: 1,
            volumes: (0..BRANCHES).collect(),
            time_exponent: 3,
        };
        let counted = Stage {
            start_points: of_cells(BRANCHES * (BRANCHES - 1) / 2, branches),
            ..draw.stage()
        };
        let made = Stage { system: Some(draw.digest()), ..draw.stage() };
        let bend = Stage { work: Work::Bend, ..draw.stage() };
        for stage in [bend, draw.stage(), draw.later_stage(), sharpening, counting, counted, made] {
            let message: v1::Stage = sent(&to_proto::path::stage(&stage));
            prop_assert_eq!(from_proto::path::stage(&message).unwrap(), stage);
        }
    }

    #[test]
    fn results_come_back_by_both_ways(seed: u64) {
        let mut draw = Draw::new(seed);
        for (work, result) in draw.item_results() {
            let message: v1::PathResult = sent(&to_proto::path::item_result(&result));
            let back = from_proto::path::item_result(&message, work).unwrap();
            prop_assert_eq!(&back, &result);
            let bytes = records::encode([&result, &result]);
            let back = records::decode(&bytes, work).unwrap();
            prop_assert_eq!(back, [result.clone(), result]);
        }
    }

    #[test]
    fn facts_of_another_kind_of_work_are_refused(seed: u64) {
        let item_results = Draw::new(seed).item_results();
        for (work, result) in &item_results {
            let message = to_proto::path::item_result(result);
            let bytes = records::encode([result]);
            for (other, _) in item_results.iter().filter(|(other, _)| other != work) {
                // Without a fact, a point is a point, whatever was asked of it.
                let read = from_proto::path::item_result(&message, *other);
                prop_assert!(read.is_err() || !has_fact(result), "{result:?} as {other:?}");
                prop_assert_eq!(records::decode(&bytes, *other).is_err(), read.is_err());
            }
        }
    }
}

/// True where a result says what only results of its kind do.
fn has_fact(result: &ItemResult) -> bool {
    match result {
        // A path without a turn or step is like a point.
        ItemResult::Track(_) => false,
        ItemResult::Certify(point) => point.fact().is_some(),
        ItemResult::LocalDimension(point) => point.fact().is_some(),
        ItemResult::Sharpen(point) => point.fact().is_some(),
        ItemResult::CountMixedCells(branch) => branch.fact().is_some(),
        ItemResult::Bend(point) => point.fact().is_some(),
    }
}

#[test]
fn different_systems_have_different_digests() {
    let plain = (0..500).map(|seed| Draw::new(seed).system());
    let with_helpers = (0..500).map(|seed| Draw::new(seed).system_with_helpers());
    let mut systems: Vec<_> = plain.chain(with_helpers).collect();
    systems.dedup();
    let mut digests: Vec<_> = systems.iter().map(digest::of_system).collect();
    digests.sort();
    digests.dedup();
    let mut distinct = 0;
    for (i, a) in systems.iter().enumerate() {
        distinct += usize::from(!systems[..i].contains(a));
    }
    assert_eq!(digests.len(), distinct);
    assert!(distinct > 800, "the generator is not that poor");
}

#[test]
fn signs_of_zero_and_kinds_of_nan_are_kept_or_made_one() {
    let with = |value: f64| {
        let mut result = Draw::new(1).path_result();
        result.outcome = cognate_continuation::tracker::outcome::PathOutcome::Failed(
            cognate_continuation::tracker::outcome::Failure::StepTooSmall,
        );
        result.endpoint = Coordinates::Double(vec![Complex64::new(value, 0.0)]);
        records::hash(&records::encode([&ItemResult::Track(result)]))
    };
    assert_ne!(with(0.0), with(-0.0));
    assert_eq!(with(f64::NAN), with(-f64::NAN));
    assert_eq!(with(f64::NAN), with(f64::from_bits(0x7ff8_0000_dead_beef)));
}

/// A component with this number of points in two coordinates.
fn component(dimension: u32, points: usize) -> WitnessSet {
    let number = |k: usize| Complex64::new(k as f64, 0.5);
    WitnessSet {
        id: ComponentId {
            dimension,
            number: 2,
        },
        degree: points as u64,
        multiplicity: Multiplicity {
            scheme: None,
            tracked: 1,
            dual_dimensions: Vec::new(),
        },
        irreducible: Irreducible::Yes,
        deflation: vec![1, 3],
        self_conjugate: None,
        orbit: None,
        slice: vec![vec![number(7); 3]; dimension as usize].into(),
        points: (0..points)
            .map(|k| vec![number(k), number(k + 1)])
            .collect(),
        evidence: Evidence::default(),
    }
}

/// As of a program that does not know why equations have names.
#[test]
fn equations_without_names_are_numbered() {
    let mut system = Draw::new(1).system();
    let count = system.equation_count();
    system.equation_names.clear();
    let source = Source::System(Box::new(system));
    let submission = Submission {
        source,
        options: Options::default(),
    };
    let message: v1::Problem = sent(&to_proto::problem::submission(&submission));
    let Ok(Submission {
        source: Source::System(system),
        ..
    }) = from_proto::problem::submission(message)
    else {
        panic!("a submission is a submission");
    };
    assert_eq!(system.equation_names.len(), count);
    assert_eq!(system.equation_names[0], "equation 1");
}

#[test]
fn questions_about_loci_come_back() {
    let second = |components| SecondSet {
        own: 3,
        from: 2,
        components,
    };
    for question in [
        Question::SingularLocus,
        Question::RealPoints,
        Question::RealCurve(CurveWish {
            samples: 3,
            projection: Some(1),
            tolerance: Some(1e-3),
            within: vec![[-1.0, 2.0], [0.5, 3.0]],
            certify: true,
        }),
        Question::RealSurface { samples: 4 },
        Question::Intersect(second(Vec::new())),
        Question::Intersect(second(vec![component(1, 4), component(0, 1)])),
    ] {
        let asked = Asked {
            components: vec![component(1, 2)],
            question,
        };
        let options = Options {
            question: Some(asked),
            ..Options::default()
        };
        let source = Source::System(Box::new(Draw::new(1).system()));
        let submission = Submission { source, options };
        let message: v1::Problem = sent(&to_proto::problem::submission(&submission));
        assert_eq!(
            from_proto::problem::submission(message).unwrap(),
            submission
        );
    }
}

#[test]
fn solutions_come_back() {
    use cognate_solutions::solution::{NamedValue, NamedValues, Solution};
    let solution = Solution {
        variables: NamedValues(vec![
            NamedValue {
                name: "x".to_owned(),
                value: Complex64::new(0.1, -0.0),
                digits: None,
            },
            NamedValue {
                name: "y".to_owned(),
                value: Complex64::new(2.0, 0.0),
                digits: Some(["2.00000000000000000000".into(), "1.5e-21".into()]),
            },
        ]),
        multiplicity: 3,
        cycles: vec![1, 2],
        real: Some(false),
        singular: true,
        residual: 1e-16,
        condition: f64::INFINITY,
        accuracy: 1e-9,
        precision_bits: 53,
        class: Some(0),
        paths: vec![3, 4, 17],
        certificate: None,
        deflations: Some(2),
        undecided: true,
    };
    let message: v1::Solution = sent(&to_proto::solution::solution(&solution, 0));
    assert_eq!(from_proto::solution::solution(&message).unwrap(), solution);
    let nameless = v1::Solution {
        multiplicity: 0,
        ..message
    };
    let error = from_proto::solution::solution(&nameless).unwrap_err();
    assert_eq!(error.to_string(), "multiplicity is 0; expected at least 1");
}
