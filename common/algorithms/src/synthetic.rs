//! A make-believe tracker for this crate's tests: what each path does at each attempt is written down.

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::{ItemResult, PointResult};
use cognate_continuation::path_result::{
    BoundaryKey, LocalDimension, NUMBERS, PathIndex, PathResult,
};
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, Work};
use cognate_systems::system::{System, VariableGroup};
use num_complex::Complex64;

/// x^4 = p in one variable.
pub fn system() -> System {
    let mut system = System {
        variables: vec!["x".into()],
        parameters: vec!["p".into()],
        groups: vec![VariableGroup {
            variables: vec![0],
            homogeneous: false,
        }],
        equation_names: vec!["f".into()],
        ..System::default()
    };
    let e = &mut system.expressions;
    let (x, p) = (e.variable(0), e.parameter(0));
    let fourth = e.power(x, 4);
    system.equations = vec![e.subtract(fourth, p)];
    system
}

/// The system of this input for Bertini.
pub fn written(text: &str) -> System {
    match cognate_systems::formats::read("test", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

/// The system of these declarations, as they stand in an input for Bertini.
pub fn declared(text: &str) -> System {
    written(&format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n"))
}

/// A stage that tracks the four paths of a total degree start.
pub fn first_stage(homotopy: HomotopyKind) -> Stage {
    Stage::new(
        Work::Track,
        homotopy,
        StartPoints::TotalDegree { degrees: vec![4] },
        Settings::default(),
        7,
    )
}

/// End of a made path.
#[derive(Clone, Copy)]
pub enum SyntheticEnd {
    /// Ends regularly at this x.
    At(f64),
    /// Ends singularly at this x, after this number of turns.
    Turns(f64, u32),
    /// Ends singularly at this x without a turn, where the endgame began at this number.
    Jumps(f64, f64),
    /// Fails in a way that tracking again may help.
    Fails,
    /// Fails in a way that nothing helps.
    Hopeless,
}

/// All items of a stage: paths, each with its end at the stage's attempt; singular points are triple ones, where that
/// is asked.
pub fn track(stage: &Stage, end_of: impl Fn(u64, u16) -> SyntheticEnd) -> Vec<ItemResult> {
    let items = stage.items().unwrap();
    (0..items)
        .map(|item| {
            let origin = stage.origin(item);
            let (outcome, x) = match end_of(origin, stage.attempt) {
                SyntheticEnd::At(x) => (PathOutcome::Regular, x),
                SyntheticEnd::Turns(x, _) | SyntheticEnd::Jumps(x, _) => (PathOutcome::Singular, x),
                SyntheticEnd::Fails => (PathOutcome::Failed(Failure::StepTooSmall), 0.1),
                SyntheticEnd::Hopeless => (PathOutcome::Failed(Failure::KilledItsWorker), 0.1),
            };
            let coordinates = vec![Complex64::new(1.0, 0.0), Complex64::new(x, 0.0)];
            if stage.work == Work::LocalDimension {
                let triple = LocalDimension {
                    dual_dimensions: vec![1, 2, 3, 3],
                    bound: u64::MAX,
                    margin: 1e9,
                    moved_slices: Vec::new(),
                };
                let point = PointResult::new(PathIndex(origin), 0, coordinates, Some(triple));
                return ItemResult::LocalDimension(point);
            }
            ItemResult::Track(PathResult {
                residual: 1e-16,
                condition: 3.0,
                accuracy: 1e-15,
                winding_number: match end_of(origin, stage.attempt) {
                    SyntheticEnd::Turns(_, turns) => Some(turns),
                    SyntheticEnd::Jumps(..) => Some(1),
                    SyntheticEnd::At(_) | SyntheticEnd::Fails | SyntheticEnd::Hopeless => None,
                },
                boundary: match end_of(origin, stage.attempt) {
                    SyntheticEnd::Turns(..) => Some(0.1 * origin as f64),
                    SyntheticEnd::Jumps(_, place) => Some(place),
                    SyntheticEnd::At(_) | SyntheticEnd::Fails | SyntheticEnd::Hopeless => None,
                }
                .map(|place| {
                    Box::new(BoundaryKey {
                        numbers: [place; NUMBERS],
                        margin: 1e-6,
                    })
                }),
                ..PathResult::untracked(origin, stage.attempt, outcome, coordinates)
            })
        })
        .collect()
}
