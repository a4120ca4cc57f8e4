//! A solution followed along its curve from s = 0 until the curve leaves the segment 0 <= s <= 1 at either end, around
//! folds, where s turns.
//!
//! Piece by piece ([`Piece`]), each by the coordinate that changes most: near a singular configuration, where all others
//! change a thousand times faster than s, pieces by s would be a millionth of the segment.

use super::curve::Curve;
use super::tube::{Located, Piece, located, slopes_at};
use num_complex::Complex64;

/// The longest first piece.
const FIRST: f64 = 0.25;
/// Pieces shorter than this are not tried.
const SHORTEST: f64 = 1.0 / ((1 << 24) as f64);
/// Most attempts to prove a piece: seconds for an arm.
const MOST_ATTEMPTS: usize = 5000;
/// s is the parameter of pieces on which no other coordinate changes more than so many times faster.
const MOST_BY_S: f64 = 4.0;
/// Largest part of the segment that a piece around a fold takes.
const LONGEST_FOLD: f64 = 1e-6;
/// The rate at which s changes is steady where it changes by a smaller factor than this over half of a piece.
const STEADY: f64 = 1.5;
/// Pieces that succeed, one after the other, before the next is twice as long.
const PATIENCE: usize = 3;
/// Part of a piece by which it begins before the point from which it is made, where its parameter is another one.
const OVERLAP: f64 = 0.05;

/// A followed solution.
pub struct Trace {
    /// Points near the folds that it passed, in their order, each with the direction of the curve there.
    pub folds: Vec<NearFold>,
    /// End of the curve.
    pub end: End,
}

/// A point near a fold.
pub struct NearFold {
    /// The coordinates.
    pub point: Vec<Complex64>,
    /// Change of the coordinates along the curve.
    pub direction: Vec<Complex64>,
}

/// Where a followed solution ended.
pub enum End {
    /// At s = 1.
    Arrived(Located),
    /// At s = 0.
    Returned(Located),
    /// Beyond this point the curve could not be followed.
    Stopped(NearFold),
}

/// A place on the curve, and how the curve goes on from there.
struct Place {
    located: Located,
    /// The parameter of the curve by which it is located.
    parameter: usize,
    /// Change of the coordinates along the curve, onwards; the largest is 1 or -1.
    direction: Vec<f64>,
}

impl Place {
    /// At a located point, onwards where the parameter of the curve goes in this direction.
    fn new(curve: &mut Curve<'_>, located: Located, onwards: f64) -> Option<Self> {
        let slopes = slopes_at(curve, &located.point)?;
        let largest = slopes.iter().map(|z| z.re.abs()).fold(0.0, f64::max);
        let direction: Vec<f64> = slopes.iter().map(|z| onwards * z.re / largest).collect();
        let is_finite = direction.iter().all(|d| d.is_finite());
        is_finite.then_some(Self {
            parameter: curve.parameter,
            located,
            direction,
        })
    }

    fn s(&self, curve: &Curve<'_>) -> f64 {
        self.located.point[curve.place_of_s()].re
    }

    /// The end of the segment to which s goes.
    fn ahead(&self, curve: &Curve<'_>) -> f64 {
        if self.direction[curve.place_of_s()] > 0.0 {
            1.0
        } else {
            0.0
        }
    }

    /// The coordinate that changes most, s rather than another.
    fn fastest(&self, curve: &Curve<'_>) -> usize {
        let size = |v: usize| self.direction[v].abs();
        let mut fastest = curve.place_of_s();
        let mut most = MOST_BY_S * size(fastest);
        for v in curve.free.iter().copied().chain([curve.parameter]) {
            if size(v) > most {
                (fastest, most) = (v, size(v));
            }
        }
        fastest
    }
}

/// The place after a piece, and the fold on the piece.
struct Step {
    place: Place,
    fold: Option<NearFold>,
}

/// Follows a real solution from s = 0; `None` where it is not shown to be one there. `around_folds`: by other coordinates
/// than s, too, which must be real.
pub fn trace(curve: &mut Curve<'_>, x: &[Complex64], around_folds: bool) -> Option<Trace> {
    let s = curve.place_of_s();
    curve.set_parameter(s);
    let first = [x, &[Complex64::default()]].concat();
    let first = located(curve, &first)?;
    let mut place = Place::new(curve, first, 1.0)?;
    let mut folds = Vec::new();
    let (mut length, mut successes) = (FIRST, PATIENCE);
    for _ in 0..MOST_ATTEMPTS {
        let is_at_end = place.s(curve) == 0.0 || !around_folds;
        let parameter = if is_at_end { s } else { place.fastest(curve) };
        match step(curve, &place, parameter, length).or_else(|| last_step(curve, &place, length)) {
            Some(next) => {
                place = next.place;
                folds.extend(next.fold);
                successes += 1;
                if successes >= PATIENCE {
                    length *= 2.0;
                }
                let end = match place.s(curve) {
                    1.0 => End::Arrived(place.located),
                    0.0 => End::Returned(place.located),
                    _ => continue,
                };
                return Some(Trace { folds, end });
            }
            None => (length, successes) = (0.5 * length, 0),
        }
        if length < SHORTEST {
            break;
        }
    }
    let direction = place.direction.iter();
    let end = End::Stopped(NearFold {
        direction: direction.map(|d| Complex64::new(*d, 0.0)).collect(),
        point: place.located.point,
    });
    Some(Trace { folds, end })
}

/// A proved piece by a parameter that changes by `length` times its part of the direction, or to the end of the segment.
/// s only grows or only falls on it, as far as its rate tells, or turns within a millionth of the segment.
fn step(curve: &mut Curve<'_>, place: &Place, parameter: usize, length: f64) -> Option<Step> {
    let s = curve.place_of_s();
    let (piece, next) = proved_piece(curve, place, parameter, length)?;
    if parameter == s || piece.is_monotone(s) || is_steady(&piece, [place, &next], parameter, s) {
        let place = next;
        return Some(Step { place, fold: None });
    }
    let (here, there) = (place.direction[s], next.direction[s]);
    if here.signum() != there.signum() {
        return over_fold(piece, next, s);
    }
    // A longer piece, with the fold in its middle.
    let longer = 2.0 * length * here / (here - there);
    if !(longer > 0.0 && 0.25 * longer * here.abs() < LONGEST_FOLD) {
        return None;
    }
    let (piece, next) = proved_piece(curve, place, parameter, longer)?;
    let turns = here.signum() != next.direction[s].signum();
    turns.then(|| over_fold(piece, next, s)).flatten()
}

/// Whether s changes at nearly one rate at both ends and in the middle of a piece: too short a piece for two folds.
fn is_steady(piece: &Piece, ends: [&Place; 2], parameter: usize, s: usize) -> bool {
    let middle = piece.slope[s].re;
    ends.iter().all(|end| {
        let ratio = end.direction[s] / end.direction[parameter] / middle;
        (1.0 / STEADY..STEADY).contains(&ratio)
    })
}

/// A step over the fold on a piece on which s turns, where the piece is short.
fn over_fold(piece: Piece, place: Place, s: usize) -> Option<Step> {
    let values = piece.values(s);
    let fold = NearFold {
        point: piece.middle,
        direction: piece.slope,
    };
    (values.upper() - values.lower() < LONGEST_FOLD).then_some(Step {
        place,
        fold: Some(fold),
    })
}

/// A proved piece and the place at its end. The piece lies within the segment 0 <= s <= 1.
fn proved_piece(
    curve: &mut Curve<'_>,
    place: &Place,
    parameter: usize,
    length: f64,
) -> Option<(Piece, Place)> {
    let s = curve.place_of_s();
    curve.set_parameter(parameter);
    let onwards = place.direction[parameter].signum();
    let start = place.located.point[parameter].re;
    let change = length * place.direction[parameter];
    let left = place.ahead(curve) - start;
    // No piece ends a rounding error before the end of the segment.
    let end = if parameter == s && change.abs() * (1.0 + 1e-3) >= left.abs() {
        place.ahead(curve)
    } else {
        start + change
    };
    let overlap = if parameter == place.parameter {
        0.0
    } else {
        OVERLAP * (end - start)
    };
    let piece = Piece::new(curve, &place.located.point, [start - overlap, end])?;
    if !piece.holds(&place.located) {
        return None;
    }
    let there = located(curve, &piece.point_at(end))?;
    if !piece.holds(&there) {
        return None;
    }
    let values = piece.values(s);
    let is_within = *values.lower() > 0.0 && *values.upper() < 1.0;
    if parameter != s && !is_within {
        return None;
    }
    let next = Place::new(curve, there, onwards)?;
    Some((piece, next))
}

/// The step by s that reaches the end of the segment, where that is not farther than the next piece goes.
fn last_step(curve: &mut Curve<'_>, place: &Place, length: f64) -> Option<Step> {
    let s = curve.place_of_s();
    let left = (place.ahead(curve) - place.s(curve)).abs();
    let change = place.direction[s].abs();
    if place.fastest(curve) == s || 2.0 * length * change < left {
        return None;
    }
    step(curve, place, s, left / change)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::evaluation::Interpreter;
    use cognate_systems::formats::read;

    fn program(equation: &str) -> Interpreter {
        let text =
            format!(r#"{{"variables": ["x"], "parameters": ["p"], "equations": ["{equation}"]}}"#);
        let system = read("test", text.as_bytes()).unwrap().system;
        Interpreter::compile(&system.expressions, &system.equations, 1, 1)
    }

    fn end(
        program: &Interpreter,
        [from, to]: [f64; 2],
        x: f64,
        around_folds: bool,
    ) -> Option<Trace> {
        let real = |v: f64| vec![Complex64::new(v, 0.0)];
        let mut curve = Curve::new(program, vec![0], &real(from), &real(to));
        trace(&mut curve, &real(x), around_folds)
    }

    #[test]
    fn each_root_goes_to_its_own() {
        // x^2 = p: no way from one root to the other as long as p is not 0.
        let program = program("x^2 - p");
        for around_folds in [true, false] {
            for (x, expected) in [(1.0, 3.0), (-1.0, -3.0)] {
                let followed = end(&program, [1.0, 9.0], x, around_folds).expect("a root");
                let End::Arrived(root) = followed.end else {
                    panic!("{x} does not arrive");
                };
                assert!((root.point[0] - expected).norm_sqr() < 1e-24);
                assert!(root.error[0] < root.radius[0] && root.radius[0] < 1e-6);
                assert!(followed.folds.is_empty());
            }
            // Very near to each other, and still apart.
            let followed = end(&program, [1.0, 1e-4], 1.0, around_folds).expect("a root");
            let End::Arrived(root) = followed.end else {
                panic!("the root is regular all the way");
            };
            assert!((root.point[0] - 1e-2).norm_sqr() < 1e-20);
            let nowhere = end(&program, [1.0, 2.0], 0.3, around_folds);
            assert!(nowhere.is_none_or(|f| matches!(f.end, End::Arrived(_))));
        }
    }

    #[test]
    fn a_fold_leads_back() {
        let program = program("x^2 - p");
        let followed = end(&program, [1.0, -1.0], 1.0, true).expect("a root");
        let End::Returned(root) = followed.end else {
            panic!("beyond p = 0 there is no real root");
        };
        assert!((root.point[0] + 1.0).norm_sqr() < 1e-20);
        let [fold] = &followed.folds[..] else {
            panic!("one fold");
        };
        assert!((fold.point[1].re - 0.5).abs() < 1e-6);
        let followed = end(&program, [1.0, -1.0], 1.0, false).expect("a root");
        assert!(matches!(followed.end, End::Stopped(near) if near.point[1].re > 0.49));
    }

    #[test]
    fn two_folds_lead_on() {
        // Three roots for |p| < 1/4, between two folds at x = 1/2 and x = -1/2, and one elsewhere; or always one.
        for (sign, folds) in [("-", 2), ("+", 0)] {
            let program = program(&format!("x^3 {sign} 3/4*x - p"));
            let from = if sign == "-" { -0.828 } else { -2.628 };
            let followed = end(&program, [from, 1.0], -1.2, true).expect("a root");
            assert!(matches!(followed.end, End::Arrived(_)));
            assert_eq!(followed.folds.len(), folds);
        }
    }
}
