//! Stage, PathResult and ItemResult to their messages.

use super::problem::equation_sets;
use super::{complex, complexes, digest, pairs};
use crate::flat_result::FlatResult;
use crate::submission::SettingsChoice;
use crate::v1;
use cognate_continuation::bend::Number;
use cognate_continuation::certification::{Certification, Uncertified};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{MovedSlice, PathResult};
use cognate_continuation::sharpening::{Sharpening, Unsharpened};
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::start_systems::polyhedral::branches::BranchCount;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::{Stage, Work};
use cognate_numeric::exact_text::exact_text;
use cognate_numeric::rational::ComplexRational;

/// A stage.
pub fn stage(stage: &Stage) -> v1::Stage {
    v1::Stage {
        id: stage.id.0,
        work: match stage.work {
            Work::Track => v1::Work::Track,
            Work::Certify => v1::Work::Certify,
            Work::LocalDimension => v1::Work::LocalDimension,
            Work::Sharpen { .. } => v1::Work::Sharpen,
            Work::CountMixedCells => v1::Work::CountMixedCells,
            Work::Bend => v1::Work::Bend,
        }
        .into(),
        system: stage.system.map(digest).unwrap_or_default(),
        homotopy: Some(homotopy(&stage.homotopy)),
        start_points: Some(start_points(&stage.start_points)),
        settings: Some(super::problem::settings(&SettingsChoice::all(
            &stage.settings,
        ))),
        seed: stage.seed,
        attempt: stage.attempt.into(),
        digits: match stage.work {
            Work::Sharpen { digits } => digits,
            Work::Track
            | Work::Certify
            | Work::LocalDimension
            | Work::CountMixedCells
            | Work::Bend => 0,
        },
    }
}

fn homotopy(homotopy: &HomotopyKind) -> v1::Homotopy {
    use v1::homotopy::Kind;
    v1::Homotopy {
        kind: Some(match homotopy {
            HomotopyKind::StraightLine { parameters } => Kind::StraightLine(v1::StraightLine {
                parameters: complexes(parameters),
            }),
            HomotopyKind::Parameter { start, targets } => Kind::Parameter(v1::ParameterHomotopy {
                start: complexes(start),
                targets: targets
                    .iter()
                    .map(|values| v1::ParameterValues {
                        values: complexes(values),
                    })
                    .collect(),
            }),
            HomotopyKind::Toric => Kind::Toric(v1::Toric {}),
            HomotopyKind::Generic { parameters } => Kind::Generic(v1::Generic {
                parameters: complexes(parameters),
            }),
            HomotopyKind::MoveSlice {
                parameters,
                order,
                level,
                forms,
            } => Kind::MoveSlice(v1::MoveSlice {
                parameters: complexes(parameters),
                order: order.clone(),
                level: *level,
                forms: *forms,
            }),
            HomotopyKind::ProductToEquation {
                parameters,
                order,
                level,
            } => Kind::ProductToEquation(v1::ProductToEquation {
                parameters: complexes(parameters),
                order: order.clone(),
                level: *level,
            }),
            HomotopyKind::Sections {
                parameters,
                direction,
                start,
                target,
            } => Kind::Sections(v1::Sections {
                parameters: complexes(parameters),
                direction: complexes(direction),
                start: complexes(start),
                target: complexes(target),
            }),
            HomotopyKind::PathVariable { parameters } => Kind::PathVariable(v1::PathVariable {
                parameters: complexes(parameters),
            }),
        }),
    }
}

fn indices(positions: &[usize]) -> Vec<u32> {
    let index = |&i| u32::try_from(i).expect("there are fewer variables and equations than 2^32");
    positions.iter().map(index).collect()
}

fn start_points(points: &StartPoints) -> v1::StartPoints {
    use v1::start_points::Kind;
    v1::StartPoints {
        kind: Some(match points {
            StartPoints::TotalDegree { degrees } => Kind::TotalDegree(v1::TotalDegree {
                degrees: degrees.clone(),
            }),
            StartPoints::Multihomogeneous {
                degrees,
                dimensions,
                exchange,
            } => Kind::Multihomogeneous(v1::Multihomogeneous {
                exchange: exchange.as_ref().map(|exchange| v1::Exchange {
                    variables: indices(&exchange.variables),
                    equations: indices(&exchange.equations),
                    groups: indices(&exchange.groups),
                }),
                degrees: degrees
                    .iter()
                    .map(|row| v1::GroupDegrees {
                        degrees: row.clone(),
                    })
                    .collect(),
                dimensions: dimensions.clone(),
            }),
            StartPoints::Stored { object, count } => Kind::Stored(v1::Stored {
                object: digest(*object),
                count: *count,
            }),
            StartPoints::LinearProduct { sets, count } => Kind::LinearProduct(v1::LinearProduct {
                equations: equation_sets(sets),
                count: *count,
            }),
            StartPoints::MixedCells { count, branches } => Kind::MixedCells(v1::MixedCells {
                count: *count,
                branches: branches.as_ref().map(|branches| v1::CellBranches {
                    lifting: branches.lifting,
                    volumes: branches.volumes.clone(),
                    time_exponent: branches.time_exponent,
                }),
            }),
            StartPoints::Selected { base, indices } => Kind::Selected(Box::new(v1::Selected {
                base: Some(Box::new(start_points(base))),
                indices: indices.clone(),
            })),
        }),
    }
}

/// The result of one path.
pub fn path_result(r: &PathResult) -> v1::PathResult {
    v1::PathResult {
        origin: r.origin.0,
        attempt: r.attempt.into(),
        outcome: outcome(r.outcome).into(),
        endpoint: pairs(r.endpoint.to_double()),
        t: Some(complex(&r.t)),
        residual: r.residual,
        condition: r.condition,
        accuracy: r.accuracy,
        winding_number: r.winding_number,
        infinity_turns: r.infinity_turns.clone(),
        precision_bits: r.precision_bits,
        counts: Some(counts(r)),
        asked: asked_fit(r),
        local_dimension: r
            .local_dimension
            .as_ref()
            .map(|local_dimension| v1::LocalDimension {
                dual_dimensions: local_dimension.dual_dimensions.clone(),
                bound: local_dimension.bound,
                margin: local_dimension.margin,
                moved_slices: local_dimension
                    .moved_slices
                    .iter()
                    .map(moved_slice)
                    .collect(),
            }),
        boundary: r.boundary.as_ref().map(|key| v1::BoundaryKey {
            numbers: key.numbers.to_vec(),
            margin: key.margin,
        }),
        ..v1::PathResult::default()
    }
}

/// Report to clients about the result of one path.
pub fn ended_path(r: &PathResult) -> v1::EndedPath {
    v1::EndedPath {
        origin: r.origin.0,
        attempt: r.attempt.into(),
        outcome: outcome(r.outcome).into(),
        endpoint: pairs(r.endpoint.to_double()),
        t: Some(complex(&r.t)),
        residual: r.residual,
        condition: r.condition,
        accuracy: r.accuracy,
        winding_number: r.winding_number,
        infinity_turns: r.infinity_turns.clone(),
        precision_bits: r.precision_bits,
        counts: Some(counts(r)),
        asked: asked_fit(r),
    }
}

fn counts(r: &PathResult) -> v1::Counts {
    v1::Counts {
        steps: r.counts.steps,
        rejections: r.counts.rejections,
        evaluations: r.counts.evaluations,
        exchanges: r.counts.exchanges,
        turns: r.counts.turns,
    }
}

fn asked_fit(r: &PathResult) -> Option<v1::AskedFit> {
    r.asked.map(|fit| v1::AskedFit {
        residual: fit.residual,
        correction: fit.correction,
    })
}

/// The result of one item of any kind.
pub fn item_result(result: &ItemResult) -> v1::PathResult {
    let flat = FlatResult::from(result);
    v1::PathResult {
        certification: flat.certification.as_ref().map(certification),
        sharpening: flat.sharpening.as_ref().map(sharpening),
        mixed_cells: flat.mixed_cells.map(|count| v1::BranchCount {
            outcome: Some(branch_count(count)),
        }),
        bend: flat.bend.as_ref().map(|bend| v1::Bend {
            velocity: parts(&bend.velocity),
            acceleration: parts(&bend.acceleration),
            error: bend.error,
        }),
        ..path_result(&flat.path)
    }
}

/// The four doubles of each number.
fn parts(numbers: &[Number]) -> Vec<f64> {
    let parts = numbers.iter().flat_map(|z| [z.re.parts(), z.im.parts()]);
    parts.flatten().collect()
}

fn branch_count(count: BranchCount) -> v1::branch_count::Outcome {
    use v1::branch_count::Outcome;
    match count {
        BranchCount::Counted(counted) => Outcome::Counted(v1::CountedCells {
            cells: counted.cells,
            volume: counted.volume,
            time_exponent: counted.time_exponent,
        }),
        BranchCount::Tie => Outcome::Uncounted(v1::Uncounted::Tie.into()),
        BranchCount::TooLarge => Outcome::Uncounted(v1::Uncounted::TooLarge.into()),
    }
}

/// Real and imaginary parts of dyadic numbers.
fn exact_parts(values: &[ComplexRational]) -> Vec<String> {
    let parts = values.iter().flat_map(|z| [&z.re, &z.im]);
    parts
        .map(|part| exact_text(part).expect("numbers of points and boxes are dyadic"))
        .collect()
}

fn sharpening(sharpening: &Sharpening) -> v1::Sharpening {
    use v1::sharpening::Outcome;
    let outcome = match sharpening {
        Sharpening::Sharpened(point) => Outcome::Sharpened(v1::Sharpened {
            values: exact_parts(&point.values),
            accuracy: point.accuracy,
            deflations: point.deflations,
            precision_bits: point.precision_bits,
        }),
        Sharpening::Unsharpened(reason) => {
            let reason = match reason {
                Unsharpened::DamagedPoint => v1::Unsharpened::DamagedPoint,
                Unsharpened::NotRegular => v1::Unsharpened::NotRegular,
                Unsharpened::NewtonLeaves => v1::Unsharpened::NewtonLeaves,
            };
            Outcome::Unsharpened(reason.into())
        }
    };
    v1::Sharpening {
        outcome: Some(outcome),
    }
}

fn moved_slice(slice: &MovedSlice) -> v1::MovedSlice {
    v1::MovedSlice {
        distance: slice.distance,
        residual: slice.residual,
        reached: slice.reached,
    }
}

fn certification(certification: &Certification) -> v1::Certification {
    use v1::certification::Outcome;
    let outcome = match certification {
        Certification::Certified(certificate) => Outcome::Certificate(v1::Certificate {
            centre: exact_parts(&certificate.centre),
            radius: certificate.radius.clone(),
            error: certificate.error.clone(),
            contraction: certificate.contraction,
            precision_bits: certificate.precision_bits,
        }),
        Certification::Uncertified(reason) => {
            let reason = match reason {
                Uncertified::DamagedPoint => v1::Uncertified::DamagedPoint,
                Uncertified::NoEnclosure => v1::Uncertified::NoEnclosure,
                Uncertified::NewtonLeaves => v1::Uncertified::NewtonLeaves,
                Uncertified::Singular => v1::Uncertified::Singular,
                Uncertified::NoContraction => v1::Uncertified::NoContraction,
            };
            Outcome::Uncertified(reason.into())
        }
    };
    v1::Certification {
        outcome: Some(outcome),
    }
}

fn outcome(outcome: PathOutcome) -> v1::PathOutcome {
    use v1::PathOutcome as M;
    match outcome {
        PathOutcome::Regular => M::Regular,
        PathOutcome::Singular => M::Singular,
        PathOutcome::Diverging => M::Diverging,
        PathOutcome::PutAside => M::PutAside,
        PathOutcome::Failed(Failure::InvalidStartPoint) => M::InvalidStartPoint,
        PathOutcome::Failed(Failure::StepTooSmall) => M::StepTooSmall,
        PathOutcome::Failed(Failure::TooManySteps) => M::TooManySteps,
        PathOutcome::Failed(Failure::EndgameUnsettled) => M::EndgameUnsettled,
        PathOutcome::Failed(Failure::KilledItsWorker) => M::KilledItsWorker,
    }
}
