//! Fault: how a worker of the simulation computes wrongly.

use cognate_continuation::certification::Certification;
use cognate_continuation::item_result::{Finding, ItemResult};
use cognate_continuation::path_result::{Coordinates, PathResult};
use cognate_continuation::sharpening::Sharpening;
use cognate_continuation::start_systems::polyhedral::branches::{BranchCount, CountedCells};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_numeric::rational::ComplexRational;
use num_complex::Complex64;

/// How a worker computes wrongly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The first end of a chunk is another point.
    Gross,
    /// The first end of a chunk differs in its last bit.
    LastBit,
    /// All regular ends are moved by a thousandth, with the errors that right ones have.
    Nudge,
    /// The first regular end of a chunk is said to be at infinity.
    Infinity,
    /// The first regular end of a chunk is said to be singular.
    Singular,
    /// All certificates are of boxes a thousandth away.
    Certificate,
    /// No branch of the mixed cells has a cell.
    NoCells,
    /// All points with more digits are the origin.
    Digits,
}

impl Fault {
    /// Spoils the results of a chunk.
    pub fn spoil(self, results: &mut [ItemResult]) {
        match self {
            Self::Gross => {
                let wrong = vec![Complex64::new(1.0, 2.0); 3];
                match &mut results[0] {
                    ItemResult::Track(path) => path.endpoint = Coordinates::Double(wrong),
                    ItemResult::LocalDimension(point) => point.point = wrong,
                    _ => {}
                }
            }
            Self::LastBit => {
                let point = match &mut results[0] {
                    ItemResult::Track(PathResult {
                        endpoint: Coordinates::Double(end),
                        ..
                    }) => end,
                    ItemResult::LocalDimension(point) => &mut point.point,
                    _ => return,
                };
                if let Some(first) = point.first_mut() {
                    first.re = f64::from_bits(first.re.to_bits() ^ 1);
                }
            }
            Self::Nudge => {
                for path in regular(results) {
                    let Coordinates::Double(end) = &mut path.endpoint;
                    for z in end.iter_mut().skip(1) {
                        *z *= Complex64::new(1.001, 0.0);
                    }
                }
            }
            Self::Infinity => {
                if let Some(path) = regular(results).next() {
                    path.outcome = PathOutcome::Diverging;
                    path.accuracy = f64::INFINITY;
                    path.winding_number = Some(1);
                    path.infinity_turns = vec![1];
                }
            }
            Self::Singular => {
                if let Some(path) = regular(results).next() {
                    path.outcome = PathOutcome::Singular;
                    path.winding_number = Some(2);
                    path.condition = 1e14;
                }
            }
            Self::Certificate => {
                let moved = ComplexRational::from_doubles(Complex64::new(1e-3, 0.0));
                let moved = moved.expect("a finite number");
                for result in results {
                    let ItemResult::Certify(point) = result else {
                        continue;
                    };
                    if let Finding::Found(Certification::Certified(proof)) = &mut point.finding {
                        for centre in &mut proof.centre {
                            *centre = centre.add(&moved);
                        }
                    }
                }
            }
            Self::NoCells => {
                for result in results {
                    if let ItemResult::CountMixedCells(branch) = result {
                        let none = CountedCells {
                            cells: 0,
                            volume: 0,
                            time_exponent: 1,
                        };
                        branch.finding = Finding::Found(BranchCount::Counted(none));
                    }
                }
            }
            Self::Digits => {
                for result in results {
                    let ItemResult::Sharpen(point) = result else {
                        continue;
                    };
                    if let Finding::Found(Sharpening::Sharpened(sharpened)) = &mut point.finding {
                        let origin = ComplexRational::from_doubles(Complex64::ZERO);
                        sharpened.values.fill(origin.expect("a finite number"));
                    }
                }
            }
        }
    }
}

fn regular(results: &mut [ItemResult]) -> impl Iterator<Item = &mut PathResult> {
    let paths = results.iter_mut().filter_map(|result| match result {
        ItemResult::Track(path) => Some(path),
        _ => None,
    });
    paths.filter(|path| path.outcome == PathOutcome::Regular)
}
