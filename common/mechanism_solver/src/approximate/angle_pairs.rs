//! Four-bars for more than five pairs of angles of crank (phi) and rocker (psi), by Freudenstein's equation (1954).
//!
//! With ground 1 and offsets phi0, psi0 of the two angles the error is the sum over the pairs of
//! (K1 cos(psi + psi0) - K2 cos(phi + phi0) + K3 - cos(phi + phi0 - psi - psi0))^2, where K1 = 1/crank, K2 = 1/rocker,
//! K3 = (crank^2 - coupler^2 + rocker^2 + 1) / (2 crank rocker). Unknowns are K1, K2, K3 and the cosines and sines of the
//! offsets. An offset turned by half a turn with the sign of its link gives the same linkage: four points are one.

use super::least_squares::add_square;
use super::{
    Stationary, exact_direction, kind_of, sort_minima_first, stationary_points, vanishing_sums,
};
use cognate_kinematics::mechanism::exact::radians;
use cognate_solutions::critical::Kind;
use num_complex::Complex64;

/// Number of pairs of angles that a linkage can meet exactly.
pub const EXACT_PAIRS: usize = 5;
/// Stationary points that are one linkage.
const SAME_LINKAGE: u64 = 4;
/// A link is infinitely long where its K is below this: the error does not depend on its length.
const NO_LENGTH: f64 = 1e-12;

/// A cosine of a unit vector that is 0 to rounding.
const UPRIGHT: f64 = 1e-12;

/// A linkage at a stationary point of the error; lengths in units of the ground, negative where a link is turned by half a
/// turn; offsets in radians, above -pi/2 and up to pi/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FunctionGenerator {
    /// Length of the crank.
    pub crank: f64,
    /// Length of the coupler.
    pub coupler: f64,
    /// Length of the rocker.
    pub rocker: f64,
    /// Angle that is added to angles of the crank.
    pub crank_offset: f64,
    /// Angle that is added to angles of the rocker.
    pub rocker_offset: f64,
    /// The sum of squares.
    pub error: f64,
    /// Kind of the stationary point: minimum, saddle or maximum.
    pub kind: Kind,
}

/// All real stationary points with a real coupler: minima first, each kind by its error.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionGenerators {
    /// The linkages.
    pub linkages: Vec<FunctionGenerator>,
    /// How many stationary points there are, those without real coupler among them.
    pub stationary: Stationary,
    /// Real stationary points whose coupler is not real or whose crank or rocker is infinitely long.
    pub without_linkage: u64,
    /// Why the answer is not settled.
    pub doubts: Vec<String>,
}

/// The linkages for directions of crank and rocker, each of length 1.
///
/// # Errors
/// In words, where there are too few pairs.
pub fn function_generators(
    pairs: &[[Complex64; 2]],
    seed: u64,
) -> Result<FunctionGenerators, String> {
    if pairs.len() <= EXACT_PAIRS {
        return Err(format!(
            "{} pairs are met exactly; expected more than {EXACT_PAIRS}, or type cognate synthesize function-generation",
            pairs.len()
        ));
    }
    let mut points = stationary_points(&equations(pairs), seed)?;
    if !points.complex.is_multiple_of(SAME_LINKAGE) {
        points.doubts.push(format!(
            "{} stationary points are no multiple of {SAME_LINKAGE}: some are missing",
            points.complex
        ));
    }
    // One of the four: both offsets to the right.
    let is_right = |cosine: f64, sine: f64| cosine > UPRIGHT || (cosine > -UPRIGHT && sine > 0.0);
    points
        .real
        .retain(|x| is_right(x[3], x[4]) && is_right(x[5], x[6]));
    let linkages = points.real.iter().filter_map(|x| linkage(pairs, x));
    let mut linkages: Vec<FunctionGenerator> = linkages.collect();
    sort_minima_first(&mut linkages, |linkage| (linkage.kind, linkage.error));
    Ok(FunctionGenerators {
        stationary: Stationary {
            complex: points.complex / SAME_LINKAGE,
            real: points.real.len() as u64,
        },
        without_linkage: (points.real.len() - linkages.len()) as u64,
        linkages,
        doubts: points.doubts,
    })
}

/// The gradient of the error; the offset of the rocker is (c1, s1), that of the crank (c2, s2).
fn equations(turns: &[[Complex64; 2]]) -> String {
    let mut text = String::from(
        "unknowns: K1, K2, K3, c1, s1, c2, s2\ngroups: K1 K2 K3 | c1 s1 | c2 s2\n\
         c1^2 + s1^2 = 1\nc2^2 + s2^2 = 1\n",
    );
    let mut gradient: [Vec<String>; 5] = Default::default();
    for (j, [crank, rocker]) in turns.iter().enumerate() {
        let [cp, sp] = exact_direction(*crank);
        let [cr, sr] = exact_direction(*rocker);
        let lines = format!(
            "rc{j} := {cr}*c1 - {sr}*s1\nrs{j} := {sr}*c1 + {cr}*s1\n\
             cc{j} := {cp}*c2 - {sp}*s2\ncs{j} := {sp}*c2 + {cp}*s2\n\
             dc{j} := rc{j}*cc{j} + rs{j}*cs{j}\nds{j} := cs{j}*rc{j} - cc{j}*rs{j}\n\
             f{j} := K1*rc{j} - K2*cc{j} + K3 - dc{j}\n"
        );
        text.push_str(&lines);
        let factors = [
            format!("rc{j}"),
            format!("cc{j}"),
            "1".to_owned(),
            format!("(K1*rs{j} + ds{j})"),
            format!("(K2*cs{j} + ds{j})"),
        ];
        for (terms, factor) in gradient.iter_mut().zip(factors) {
            terms.push(format!("f{j}*{factor}"));
        }
    }
    text + &vanishing_sums(&gradient)
}

/// The linkage of a stationary point; `None` where a link has no real length.
fn linkage(turns: &[[Complex64; 2]], x: &[f64]) -> Option<FunctionGenerator> {
    let [k1, k2, k3] = [x[0], x[1], x[2]];
    if k1.abs() < NO_LENGTH || k2.abs() < NO_LENGTH {
        return None;
    }
    let (crank, rocker) = (1.0 / k1, 1.0 / k2);
    let square = crank * crank + rocker * rocker + 1.0 - 2.0 * crank * rocker * k3;
    if square <= 0.0 {
        return None;
    }
    let offsets = [Complex64::new(x[5], x[6]), Complex64::new(x[3], x[4])];
    let mut error = 0.0;
    let mut rows = [[0.0; 5]; 5];
    for turn in turns {
        let [crank, rocker] = [turn[0] * offsets[0], turn[1] * offsets[1]];
        let apart = crank * rocker.conj();
        let residual = k1 * rocker.re - k2 * crank.re + k3 - apart.re;
        error += residual * residual;
        let by_rocker = -k1 * rocker.im - apart.im;
        let by_crank = k2 * crank.im + apart.im;
        let gradient = [rocker.re, -crank.re, 1.0, by_rocker, by_crank];
        add_square(&mut rows, &gradient);
        let second = [(0, 3, -rocker.im), (1, 4, crank.im), (3, 4, -apart.re)];
        for (i, j, derivative) in second {
            rows[i][j] += residual * derivative;
            rows[j][i] += residual * derivative;
        }
        rows[3][3] += residual * (apart.re - k1 * rocker.re);
        rows[4][4] += residual * (apart.re + k2 * crank.re);
    }
    let [crank_offset, rocker_offset] = offsets.map(radians);
    Some(FunctionGenerator {
        crank,
        coupler: square.sqrt(),
        rocker,
        crank_offset,
        rocker_offset,
        error,
        kind: kind_of(&rows),
    })
}
