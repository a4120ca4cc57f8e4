//! Stage and result messages to the types of `continuation`.

use super::options::{equation_sets, settings};
use super::{complexes, digest, finite, pairs, required};
use crate::error::{ProtocolError, within_limit};
use crate::flat_result::{FlatResult, OtherKind};
use crate::limits;
use crate::v1;
use cognate_continuation::bend::{Bend, Number};
use cognate_continuation::certification::{Certificate, Certification, Uncertified};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{
    AskedFit, BoundaryKey, Coordinates, Counts, LocalDimension, MovedSlice, NUMBERS, PathIndex,
    PathResult,
};
use cognate_continuation::sharpening::{MOST_DIGITS, Sharpened, Sharpening, Unsharpened};
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::start_systems::exchange::Exchange;
use cognate_continuation::start_systems::polyhedral::branches::{
    BRANCHES, BranchCount, CellBranches, CountedCells, MOST_TIME_EXPONENT,
};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::exact_text::read_exact;
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::DoubleDouble;
use cognate_systems::formats::limits as sizes;

/// A stage.
pub fn stage(m: &v1::Stage) -> Result<Stage, ProtocolError> {
    let work = match v1::Work::try_from(m.work) {
        Ok(v1::Work::Track) => Work::Track,
        Ok(v1::Work::Certify) => Work::Certify,
        Ok(v1::Work::LocalDimension) => Work::LocalDimension,
        Ok(v1::Work::Sharpen) => {
            if !(1..=MOST_DIGITS).contains(&m.digits) {
                return Err(ProtocolError::invalid(
                    "digits",
                    m.digits,
                    format!("1 to {MOST_DIGITS}"),
                ));
            }
            Work::Sharpen { digits: m.digits }
        }
        Ok(v1::Work::CountMixedCells) => Work::CountMixedCells,
        Ok(v1::Work::Bend) => Work::Bend,
        Ok(v1::Work::Unspecified) | Err(_) => {
            return Err(ProtocolError::invalid(
                "work",
                m.work,
                "a kind of work that this version knows",
            ));
        }
    };
    let stage = Stage {
        id: StageId(m.id),
        system: match m.system.is_empty() {
            true => None,
            false => Some(digest("system", &m.system)?),
        },
        work,
        homotopy: homotopy(required("homotopy", m.homotopy.as_ref())?)
            .map_err(|e| e.within("homotopy"))?,
        start_points: start_points(required("start_points", m.start_points.as_ref())?)
            .map_err(|e| e.within("start_points"))?,
        settings: complete_settings(required("settings", m.settings.as_ref())?)
            .map_err(|e| e.within("settings"))?,
        seed: m.seed,
        attempt: attempt(m.attempt)?,
    };
    match stage.items() {
        Some(items) if items <= limits::PATHS.value => Ok(stage),
        items => Err(ProtocolError::Limit {
            field: "start_points".to_owned(),
            found: items.unwrap_or(u64::MAX),
            what: limits::PATHS.what,
            name: limits::PATHS.name,
            value: limits::PATHS.value,
        }),
    }
}

/// Settings of which every field is there.
pub fn complete_settings(m: &v1::Settings) -> Result<Settings, ProtocolError> {
    settings(m)?.complete().map_err(ProtocolError::missing)
}

fn attempt(attempt: u32) -> Result<u16, ProtocolError> {
    u16::try_from(attempt)
        .map_err(|_| ProtocolError::invalid("attempt", attempt, "a number below 65536"))
}

fn homotopy(m: &v1::Homotopy) -> Result<HomotopyKind, ProtocolError> {
    use v1::homotopy::Kind;
    let values = |field: &str, values: &[v1::Complex]| {
        within_limit(field, values.len(), sizes::PARAMETERS)?;
        complexes(field, values)
    };
    Ok(match required("kind", m.kind.as_ref())? {
        Kind::StraightLine(h) => HomotopyKind::StraightLine {
            parameters: values("straight_line.parameters", &h.parameters)?,
        },
        Kind::Toric(v1::Toric {}) => HomotopyKind::Toric,
        Kind::Generic(h) => HomotopyKind::Generic {
            parameters: values("generic.parameters", &h.parameters)?,
        },
        Kind::MoveSlice(h) => {
            within_limit("slide.order", h.order.len(), sizes::EQUATIONS)?;
            degrees("slide.forms", &[h.forms], 1)?;
            HomotopyKind::MoveSlice {
                parameters: values("slide.parameters", &h.parameters)?,
                order: h.order.clone(),
                level: h.level,
                forms: h.forms,
            }
        }
        Kind::ProductToEquation(h) => {
            within_limit("intersect.order", h.order.len(), sizes::EQUATIONS)?;
            HomotopyKind::ProductToEquation {
                parameters: values("intersect.parameters", &h.parameters)?,
                order: h.order.clone(),
                level: h.level,
            }
        }
        Kind::Sections(h) => {
            let start = values("sections.start", &h.start)?;
            let target = values("sections.target", &h.target)?;
            if target.len() != start.len() {
                return Err(ProtocolError::invalid(
                    "sections.target",
                    format!("{} values", target.len()),
                    format!("{} values, as at the start", start.len()),
                ));
            }
            HomotopyKind::Sections {
                parameters: values("sections.parameters", &h.parameters)?,
                direction: values("sections.direction", &h.direction)?,
                start,
                target,
            }
        }
        Kind::PathVariable(h) => HomotopyKind::PathVariable {
            parameters: values("path_variable.parameters", &h.parameters)?,
        },
        Kind::Parameter(h) => {
            within_limit("parameter.targets", h.targets.len(), limits::TARGETS)?;
            let start = values("parameter.start", &h.start)?;
            let targets = h
                .targets
                .iter()
                .enumerate()
                .map(|(i, target)| {
                    let field = format!("parameter.targets[{i}]");
                    if target.values.len() != start.len() {
                        return Err(ProtocolError::invalid(
                            field,
                            format!("{} values", target.values.len()),
                            format!("{} values, as at the start", start.len()),
                        ));
                    }
                    complexes(&field, &target.values)
                })
                .collect::<Result<Vec<_>, _>>()?;
            HomotopyKind::Parameter { start, targets }
        }
    })
}

fn start_points(m: &v1::StartPoints) -> Result<StartPoints, ProtocolError> {
    use v1::start_points::Kind;
    Ok(match required("kind", m.kind.as_ref())? {
        Kind::TotalDegree(p) => {
            let field = "total_degree.degrees";
            within_limit(field, p.degrees.len(), sizes::EQUATIONS)?;
            degrees(field, &p.degrees, 1)?;
            StartPoints::TotalDegree {
                degrees: p.degrees.clone(),
            }
        }
        Kind::Multihomogeneous(p) => {
            let field = "multihomogeneous.degrees";
            within_limit(field, p.degrees.len(), sizes::EQUATIONS)?;
            let groups = p.dimensions.len();
            within_limit("multihomogeneous.dimensions", groups, sizes::VARIABLES)?;
            for (i, row) in p.degrees.iter().enumerate() {
                let field = format!("{field}[{i}]");
                degrees(&field, &row.degrees, 0)?;
                if row.degrees.len() != groups {
                    return Err(ProtocolError::invalid(
                        field,
                        format!("{} degrees", row.degrees.len()),
                        format!("one for each of the {groups} groups"),
                    ));
                }
            }
            StartPoints::Multihomogeneous {
                degrees: p.degrees.iter().map(|row| row.degrees.clone()).collect(),
                dimensions: p.dimensions.clone(),
                exchange: p.exchange.as_ref().map(exchange).transpose()?,
            }
        }
        Kind::Stored(p) => StartPoints::Stored {
            object: digest("stored.object", &p.object)?,
            count: p.count,
        },
        Kind::LinearProduct(p) => {
            let field = "linear_product.equations";
            StartPoints::LinearProduct {
                sets: equation_sets(field, &p.equations)?,
                count: p.count,
            }
        }
        Kind::MixedCells(p) => {
            let branches = p.branches.as_ref().map(|branches| CellBranches {
                lifting: branches.lifting,
                volumes: branches.volumes.clone(),
                time_exponent: branches.time_exponent,
            });
            if branches.as_ref().is_some_and(|b| !b.is_sound(p.count)) {
                return Err(ProtocolError::invalid(
                    "mixed_cells.branches",
                    format!(
                        "{} volumes",
                        p.branches.iter().flat_map(|b| &b.volumes).count()
                    ),
                    format!("none, or {BRANCHES} that add up to the mixed volume"),
                ));
            }
            StartPoints::MixedCells {
                count: p.count,
                branches,
            }
        }
        Kind::Selected(p) => {
            let base = required("selected.base", p.base.as_deref())?;
            // A selection of a selection would let a message recurse as deep as it likes.
            if matches!(base.kind, Some(Kind::Selected(_))) {
                return Err(ProtocolError::invalid(
                    "selected.base",
                    "a selection",
                    "start points that are no selection",
                ));
            }
            let field = "selected.indices";
            within_limit(field, p.indices.len(), limits::SELECTED_PATHS)?;
            if !p.indices.is_sorted_by(|a, b| a < b) {
                return Err(ProtocolError::invalid(
                    field,
                    "not in order",
                    "ascending indices",
                ));
            }
            StartPoints::Selected {
                base: Box::new(start_points(base).map_err(|e| e.within("selected.base"))?),
                indices: p.indices.clone(),
            }
        }
    })
}

/// An exchange of which every index is within its list; whether it fits is seen with the system.
fn exchange(m: &v1::Exchange) -> Result<Exchange, ProtocolError> {
    let indices = |name: &str, list: &[u32], most: sizes::Limit| {
        let field = format!("multihomogeneous.exchange.{name}");
        within_limit(&field, list.len(), most)?;
        if let Some(index) = list.iter().find(|&&index| index as usize >= list.len()) {
            let expected = format!("an index below {}", list.len());
            return Err(ProtocolError::invalid(field, index, expected));
        }
        Ok(list.iter().map(|&index| index as usize).collect())
    };
    Ok(Exchange {
        variables: indices("variables", &m.variables, sizes::VARIABLES)?,
        equations: indices("equations", &m.equations, sizes::EQUATIONS)?,
        groups: indices("groups", &m.groups, sizes::VARIABLES)?,
    })
}

fn degrees(field: &str, degrees: &[u32], least: u32) -> Result<(), ProtocolError> {
    for &degree in degrees {
        if degree < least {
            return Err(ProtocolError::invalid(
                field,
                degree,
                "degrees of at least 1",
            ));
        }
        within_limit(field, degree as usize, sizes::DEGREE)?;
    }
    Ok(())
}

fn boundary_key(m: &v1::BoundaryKey) -> Result<BoundaryKey, ProtocolError> {
    let wrong = |value: &dyn std::fmt::Display| {
        ProtocolError::invalid(
            "boundary",
            value,
            format!("{NUMBERS} finite numbers and a margin"),
        )
    };
    let numbers = m.numbers.as_slice().try_into();
    let key = BoundaryKey {
        numbers: numbers.map_err(|_| wrong(&m.numbers.len()))?,
        margin: m.margin,
    };
    match key.is_sound() {
        true => Ok(key),
        false => Err(wrong(&m.margin)),
    }
}

/// The result of one item of a stage that does this work.
pub fn item_result(m: &v1::PathResult, work: Work) -> Result<ItemResult, ProtocolError> {
    let flat = FlatResult {
        path: path_result(m)?,
        certification: m
            .certification
            .as_ref()
            .map(certification)
            .transpose()
            .map_err(|e| e.within("certification"))?,
        sharpening: m
            .sharpening
            .as_ref()
            .map(sharpening)
            .transpose()
            .map_err(|e| e.within("sharpening"))?,
        mixed_cells: m
            .mixed_cells
            .as_ref()
            .map(branch_count)
            .transpose()
            .map_err(|e| e.within("mixed_cells"))?,
        bend: m
            .bend
            .as_ref()
            .map(bend)
            .transpose()
            .map_err(|e| e.within("bend"))?,
    };
    flat.into_item(work).map_err(|OtherKind| {
        let expected = format!("a result of the stage's work, which is {work:?}");
        ProtocolError::invalid("result", "of another kind of work", expected)
    })
}

/// The path of a result, or the point of an item of another kind as the end of a path without steps.
///
/// The numbers of a failed path may have any value. The endpoint of any other path is finite, and an unknown residual,
/// condition or accuracy is infinite, never NaN.
fn path_result(m: &v1::PathResult) -> Result<PathResult, ProtocolError> {
    let outcome = outcome(m.outcome)?;
    within_limit("endpoint", m.endpoint.len() / 2, limits::COORDINATES)?;
    let endpoint = pairs("endpoint", &m.endpoint)?;
    let t = required("t", m.t.as_ref())?;
    let t = num_complex::Complex64::new(t.re, t.im);
    if !matches!(outcome, PathOutcome::Failed(_)) {
        if endpoint.is_empty() {
            return Err(ProtocolError::missing("endpoint"));
        }
        finite("endpoint", &endpoint)?;
        finite("t", &[t])?;
        for (field, value) in [
            ("residual", m.residual),
            ("condition", m.condition),
            ("accuracy", m.accuracy),
        ] {
            if value.is_nan() || value < 0.0 {
                return Err(ProtocolError::invalid(field, value, "at least 0"));
            }
        }
    }
    if m.winding_number == Some(0) {
        return Err(ProtocolError::invalid("winding_number", 0, "at least 1"));
    }
    within_limit("infinity_turns", m.infinity_turns.len(), sizes::VARIABLES)?;
    within_limit(
        "precision_bits",
        m.precision_bits as usize,
        limits::PRECISION_BITS,
    )?;
    let counts = m.counts.unwrap_or_default();
    Ok(PathResult {
        origin: PathIndex(m.origin),
        attempt: attempt(m.attempt)?,
        outcome,
        endpoint: Coordinates::Double(endpoint),
        t,
        residual: m.residual,
        condition: m.condition,
        accuracy: m.accuracy,
        winding_number: m.winding_number,
        infinity_turns: m.infinity_turns.clone(),
        precision_bits: m.precision_bits,
        counts: Counts {
            steps: counts.steps,
            rejections: counts.rejections,
            evaluations: counts.evaluations,
            exchanges: counts.exchanges,
            turns: counts.turns,
        },
        asked: m.asked.as_ref().map(asked_fit).transpose()?,
        local_dimension: m.local_dimension.as_ref().map(dual_space).transpose()?,
        boundary: m
            .boundary
            .as_ref()
            .map(|key| boundary_key(key).map(Box::new))
            .transpose()?,
    })
}

fn bend(m: &v1::Bend) -> Result<Box<Bend>, ProtocolError> {
    let bend = Bend {
        velocity: numbers("velocity", &m.velocity)?,
        acceleration: numbers("acceleration", &m.acceleration)?,
        error: m.error,
    };
    if !bend.is_sound() {
        let expected = "as many numbers as in velocity, and an error of at least 0";
        return Err(ProtocolError::invalid(
            "acceleration",
            format!("{} doubles, error {}", m.acceleration.len(), m.error),
            expected,
        ));
    }
    Ok(Box::new(bend))
}

/// Numbers of two doubles each for real and imaginary part.
fn numbers(field: &str, parts: &[f64]) -> Result<Vec<Number>, ProtocolError> {
    within_limit(field, parts.len(), limits::BEND_DOUBLES)?;
    let (numbers, rest) = parts.as_chunks::<4>();
    let number = |&[a, b, c, d]: &[f64; 4]| {
        let re = DoubleDouble::from_parts([a, b])?;
        let im = DoubleDouble::from_parts([c, d])?;
        Some(Number { re, im })
    };
    let numbers: Option<Vec<Number>> = numbers.iter().map(number).collect();
    numbers.filter(|_| rest.is_empty()).ok_or_else(|| {
        let expected = "four doubles a number, each second one a rounding error of the one before";
        ProtocolError::invalid(field, format!("{} doubles", parts.len()), expected)
    })
}

fn branch_count(m: &v1::BranchCount) -> Result<BranchCount, ProtocolError> {
    use v1::branch_count::Outcome;
    Ok(match required("outcome", m.outcome.as_ref())? {
        Outcome::Counted(m) => {
            if !(1..=MOST_TIME_EXPONENT).contains(&m.time_exponent) {
                let expected = format!("1 to {MOST_TIME_EXPONENT}");
                let field = "counted.time_exponent";
                return Err(ProtocolError::invalid(field, m.time_exponent, expected));
            }
            BranchCount::Counted(CountedCells {
                cells: m.cells,
                volume: m.volume,
                time_exponent: m.time_exponent,
            })
        }
        Outcome::Uncounted(reason) => match v1::Uncounted::try_from(*reason) {
            Ok(v1::Uncounted::Tie) => BranchCount::Tie,
            Ok(v1::Uncounted::TooLarge) => BranchCount::TooLarge,
            Ok(v1::Uncounted::Unspecified) | Err(_) => {
                return Err(ProtocolError::invalid(
                    "uncounted",
                    *reason,
                    "a reason that this version knows",
                ));
            }
        },
    })
}

fn certification(m: &v1::Certification) -> Result<Certification, ProtocolError> {
    use v1::certification::Outcome;
    Ok(match required("outcome", m.outcome.as_ref())? {
        Outcome::Certificate(m) => Certification::Certified(Box::new(
            certificate(m).map_err(|e| e.within("certificate"))?,
        )),
        Outcome::Uncertified(reason) => {
            Certification::Uncertified(match v1::Uncertified::try_from(*reason) {
                Ok(v1::Uncertified::DamagedPoint) => Uncertified::DamagedPoint,
                Ok(v1::Uncertified::NoEnclosure) => Uncertified::NoEnclosure,
                Ok(v1::Uncertified::NewtonLeaves) => Uncertified::NewtonLeaves,
                Ok(v1::Uncertified::Singular) => Uncertified::Singular,
                Ok(v1::Uncertified::NoContraction) => Uncertified::NoContraction,
                Ok(v1::Uncertified::Unspecified) | Err(_) => {
                    return Err(ProtocolError::invalid(
                        "uncertified",
                        *reason,
                        "a reason that this version knows",
                    ));
                }
            })
        }
    })
}

/// Exact numbers from their parts.
fn exact_parts(field: &str, parts: &[String]) -> Result<Vec<ComplexRational>, ProtocolError> {
    within_limit(field, parts.len() / 2, sizes::VARIABLES)?;
    if !parts.len().is_multiple_of(2) {
        return Err(ProtocolError::invalid(
            field,
            format!("{} numbers", parts.len()),
            "real and imaginary part of every coordinate",
        ));
    }
    let exact = |i: usize| {
        read_exact(&parts[i]).ok_or_else(|| {
            ProtocolError::invalid(
                format!("{field}[{i}]"),
                &parts[i],
                "an exact number such as -0x1fp-3",
            )
        })
    };
    (0..parts.len() / 2)
        .map(|i| Ok(ComplexRational::new(exact(2 * i)?, exact(2 * i + 1)?)))
        .collect()
}

fn sharpening(m: &v1::Sharpening) -> Result<Sharpening, ProtocolError> {
    use v1::sharpening::Outcome;
    Ok(match required("outcome", m.outcome.as_ref())? {
        Outcome::Sharpened(m) => {
            within_limit(
                "precision_bits",
                m.precision_bits as usize,
                limits::PRECISION_BITS,
            )?;
            let sharpened_point = Sharpened {
                values: exact_parts("values", &m.values)?,
                accuracy: m.accuracy,
                deflations: m.deflations,
                precision_bits: m.precision_bits,
            };
            if !sharpened_point.is_sound() {
                let expected = "at least 0 and below 1";
                return Err(ProtocolError::invalid("accuracy", m.accuracy, expected));
            }
            Sharpening::Sharpened(Box::new(sharpened_point))
        }
        Outcome::Unsharpened(reason) => {
            Sharpening::Unsharpened(match v1::Unsharpened::try_from(*reason) {
                Ok(v1::Unsharpened::DamagedPoint) => Unsharpened::DamagedPoint,
                Ok(v1::Unsharpened::NotRegular) => Unsharpened::NotRegular,
                Ok(v1::Unsharpened::NewtonLeaves) => Unsharpened::NewtonLeaves,
                Ok(v1::Unsharpened::Unspecified) | Err(_) => {
                    return Err(ProtocolError::invalid(
                        "unsharpened",
                        *reason,
                        "a reason that this version knows",
                    ));
                }
            })
        }
    })
}

fn certificate(m: &v1::Certificate) -> Result<Certificate, ProtocolError> {
    let certificate = Certificate {
        centre: exact_parts("centre", &m.centre)?,
        radius: m.radius.clone(),
        error: m.error.clone(),
        contraction: m.contraction,
        precision_bits: m.precision_bits,
    };
    if certificate.is_sound() {
        Ok(certificate)
    } else {
        Err(ProtocolError::invalid(
            "radius",
            format!("{:?}", m.radius),
            "for each coordinate a radius and an error below it",
        ))
    }
}

fn asked_fit(m: &v1::AskedFit) -> Result<AskedFit, ProtocolError> {
    for (field, value) in [
        ("asked.residual", m.residual),
        ("asked.correction", m.correction),
    ] {
        if value.is_nan() || value < 0.0 {
            return Err(ProtocolError::invalid(field, value, "at least 0"));
        }
    }
    Ok(AskedFit {
        residual: m.residual,
        correction: m.correction,
    })
}

fn dual_space(m: &v1::LocalDimension) -> Result<LocalDimension, ProtocolError> {
    within_limit(
        "local_dimension.dual_dimensions",
        m.dual_dimensions.len(),
        limits::DUAL_DIMENSIONS,
    )?;
    if m.margin.is_nan() || m.margin < 0.0 {
        let field = "local_dimension.margin";
        return Err(ProtocolError::invalid(field, m.margin, "at least 0"));
    }
    within_limit(
        "local_dimension.moved_slices",
        m.moved_slices.len(),
        limits::MOVED_SLICES,
    )?;
    let slice = |m: &v1::MovedSlice| {
        let slice = MovedSlice {
            distance: m.distance,
            residual: m.residual,
            reached: m.reached,
        };
        let field = "local_dimension.moved_slices";
        let sound = slice.is_sound().then_some(slice);
        sound
            .ok_or_else(|| ProtocolError::invalid(field, m.residual, "numbers that are at least 0"))
    };
    Ok(LocalDimension {
        dual_dimensions: m.dual_dimensions.clone(),
        bound: m.bound,
        margin: m.margin,
        moved_slices: m.moved_slices.iter().map(slice).collect::<Result<_, _>>()?,
    })
}

fn outcome(outcome: i32) -> Result<PathOutcome, ProtocolError> {
    use v1::PathOutcome as M;
    Ok(match M::try_from(outcome) {
        Ok(M::Regular) => PathOutcome::Regular,
        Ok(M::Singular) => PathOutcome::Singular,
        Ok(M::Diverging) => PathOutcome::Diverging,
        Ok(M::PutAside) => PathOutcome::PutAside,
        Ok(M::InvalidStartPoint) => PathOutcome::Failed(Failure::InvalidStartPoint),
        Ok(M::StepTooSmall) => PathOutcome::Failed(Failure::StepTooSmall),
        Ok(M::TooManySteps) => PathOutcome::Failed(Failure::TooManySteps),
        Ok(M::EndgameUnsettled) => PathOutcome::Failed(Failure::EndgameUnsettled),
        Ok(M::KilledItsWorker) => PathOutcome::Failed(Failure::KilledItsWorker),
        Ok(M::Unspecified) | Err(_) => {
            return Err(ProtocolError::invalid(
                "outcome",
                outcome,
                "an outcome that this version knows",
            ));
        }
    })
}
