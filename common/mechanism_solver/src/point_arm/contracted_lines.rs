//! Contracted lines: values of the third joint at which the point lies on the axis of the second, so that all turns of the
//! second joint lead to one place of the point.
//!
//! The determinant is 0 along such a line. It is divided out, because cusps are counted on the rest of the singular curve.

use super::joint_polynomial::JointPolynomial;
use super::plane_map::PlaneMap;
use cognate_kinematics::mechanism::exact::Angle;

/// Distances below this part of the arm's size are 0.
const ON_AXIS: f64 = 1e-10;
/// Distances below this part of the arm's size may be 0.
const NEAR_AXIS: f64 = 1e-6;
/// Remainders below this part of the determinant's coefficients are rounding.
const REMAINDER: f64 = 1e-9;
/// Places at which the search for the least distances begins.
const PLACES: u32 = 256;
/// Steps of Newton's method at most.
const STEPS: usize = 60;

/// The lines, and the rest of the determinant.
pub struct ContractedLines {
    /// Values of the third joint, in radians.
    pub values: Vec<f64>,
    /// The determinant without the factor that is 0 on the lines.
    pub rest: JointPolynomial,
}

/// The contracted lines of an arm; an error gives the doubt.
pub fn contracted_lines(map: &PlaneMap) -> Result<ContractedLines, String> {
    let none = ContractedLines {
        values: Vec::new(),
        rest: map.determinant.clone(),
    };
    if map.turns != [true, true] {
        return Ok(none);
    }
    let values = values(map)?;
    match values[..] {
        [] => Ok(none),
        [first, second] => Ok(ContractedLines {
            rest: rest(map, first, second)?,
            values,
        }),
        _ => Err("the point lies on the second axis at one value of the third joint: cusps are not counted".into()),
    }
}

/// Values of the third joint at which the point is on the axis of the second.
fn values(map: &PlaneMap) -> Result<Vec<f64>, String> {
    let [x, y, _] = &map.point_at_second;
    let square = x.times(x).plus(&y.times(y));
    let slope = square.derivative(1);
    let bend = slope.derivative(1);
    let mut values: Vec<f64> = Vec::new();
    for k in 0..PLACES {
        let mut at = std::f64::consts::TAU * f64::from(k) / f64::from(PLACES);
        for _ in 0..STEPS {
            let place = map.place([0.0, at]);
            let (s, b) = (slope.value(&place), bend.value(&place));
            if b <= 0.0 {
                break;
            }
            at -= (s / b).clamp(-0.05, 0.05);
        }
        let place = map.place([0.0, at]);
        // From the coordinates: the square has half as many digits near 0.
        let [u, v] = [x, y].map(|f| f.value(&place));
        let distance = (u * u + v * v).sqrt();
        if (ON_AXIS..NEAR_AXIS).contains(&distance) {
            return Err("the point comes so near to the second axis that it may lie on it".into());
        }
        let is_other = |value: &f64| {
            let [a, b] = [*value, at].map(|x| Angle::of_radians(x).direction);
            (a[0] - b[0]).abs() + (a[1] - b[1]).abs() > 1e-3
        };
        if distance < ON_AXIS && values.iter().all(is_other) {
            values.push(at);
        }
    }
    Ok(values)
}

/// The determinant divided by cos(q3 - m) - cos(h), where the lines are m + h and m - h.
fn rest(map: &PlaneMap, first: f64, second: f64) -> Result<JointPolynomial, String> {
    let (middle, half) = (0.5 * (first + second), 0.5 * (first - second));
    let [cm, sm] = Angle::of_radians(middle).direction;
    let [ch, _] = Angle::of_radians(half).direction;
    let turns = map.turns;
    let constant = |x: f64| JointPolynomial::constant(turns, x);
    let (c, s) = (
        JointPolynomial::cosine(turns, 1),
        JointPolynomial::sine(turns, 1),
    );
    // Cosine and sine of q3 - m.
    let cosine = c.scaled(cm).plus(&s.scaled(sm));
    let sine = s.scaled(cm).minus(&c.scaled(sm));
    // The determinant is of degree 2: k0 + k1 cos + l1 sin + k2 cos^2 + l2 cos sin, of q3 - m. Its coefficients come from those in
    // cosine and sine of q3: cos q3 = cm cos - sm sin, sin q3 = sm cos + cm sin.
    let zero = || constant(0.0);
    let [mut k1, mut l1, mut k2, mut l2] = [zero(), zero(), zero(), zero()];
    for (exponents, part) in map.determinant.by_third_joint() {
        match exponents {
            [0, 0] => {}
            [1, 0] => {
                k1 = k1.plus(&part.scaled(cm));
                l1 = l1.minus(&part.scaled(sm));
            }
            [0, 1] => {
                k1 = k1.plus(&part.scaled(sm));
                l1 = l1.plus(&part.scaled(cm));
            }
            // cos^2 q3 = (cm^2 - sm^2) cos^2 - 2 cm sm cos sin + sm^2.
            [2, 0] => {
                k2 = k2.plus(&part.scaled(cm * cm - sm * sm));
                l2 = l2.minus(&part.scaled(2.0 * cm * sm));
            }
            // cos q3 sin q3 = 2 cm sm cos^2 + (cm^2 - sm^2) cos sin - cm sm.
            [1, 1] => {
                k2 = k2.plus(&part.scaled(2.0 * cm * sm));
                l2 = l2.plus(&part.scaled(cm * cm - sm * sm));
            }
            _ => return Err("the determinant has an unexpected degree".into()),
        }
    }
    // (cos - ch)(r0 + k2 cos + l2 sin) = k2 cos^2 + l2 cos sin + (r0 - ch k2) cos - ch l2 sin - ch r0.
    let r0 = k1.plus(&k2.scaled(ch));
    let quotient = r0.plus(&k2.times(&cosine)).plus(&l2.times(&sine));
    let factor = cosine.minus(&constant(ch));
    let size = map.determinant.bound();
    let remainder = map.determinant.minus(&quotient.times(&factor));
    if remainder.bound() > REMAINDER * size {
        return Err(
            "the singular curve does not split where the point lies on the second axis".into(),
        );
    }
    let bound = size.max(quotient.bound());
    Ok(quotient.rounded(bound))
}
