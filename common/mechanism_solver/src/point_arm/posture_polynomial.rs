//! Postures of an arm of three joints at a place of its point: the second joint is eliminated, which leaves a polynomial of
//! degree 4 in the half-tangent of the third joint, or in its shift (D. Pieper 1968).
//!
//! With F = a + M Rot(q2) w for a second joint that turns, where a and w depend on the third joint, |M^-1 (F - a)|^2 = |w|^2.

use super::joint_polynomial::JointPolynomial;
use super::plane_map::PlaneMap;
use crate::closed_form::quartic;
use cognate_kinematics::mechanism::exact::Angle;
use num_complex::Complex64;

/// Determinants below this part of the size are 0.
const ZERO: f64 = 1e-10;
/// Determinants below this part of the size may be 0.
const NEAR_ZERO: f64 = 1e-6;
/// Differences of values that are the same, in parts of the sum of the coefficients.
const SAME: f64 = 1e-11;
/// Differences of values that may be the same.
const NEARLY_SAME: f64 = 1e-6;
/// Imaginary parts of half-tangents and shifts below this are none, and above the second are some.
const REAL: [f64; 2] = [1e-8, 1e-5];
/// The angle from which half-tangents are counted, in radians: none that an arm is likely to have.
const ORIGIN: f64 = 0.737_219;
/// Angles and shifts at which a function that is even is compared with its mirror image.
const COMPARED: [f64; 3] = [0.7, 1.9, 2.8];

/// The polynomial of which the real roots are the real postures.
pub struct PosturePolynomial {
    /// Coefficients of 1, y1, y2, y1^2, y1 y2, y2^2 for the coordinates y; each depends on the third joint.
    terms: [JointPolynomial; 6],
    /// The coefficients of `terms` for each power of the half-tangent, or of the shift.
    powers: [[f64; 6]; 5],
    third_turns: bool,
}

/// Result of the elimination for the postures of an arm.
pub enum Elimination {
    /// A combination of the coordinates depends on the third joint alone.
    ThirdJointAlone,
    /// The polynomial.
    Polynomial(Box<PosturePolynomial>),
    /// The arm is nearly one of the first kind.
    Doubtful,
}

/// Eliminates the second joint.
pub fn eliminated(map: &PlaneMap) -> Elimination {
    match map.turns[0] {
        true => without_turn(map),
        false => without_shift(map),
    }
}

/// A number that is not 0; else what that says of the arm.
fn nonzero(x: f64) -> Result<f64, Elimination> {
    match x.abs() {
        size if size < ZERO => Err(Elimination::ThirdJointAlone),
        size if size < NEAR_ZERO => Err(Elimination::Doubtful),
        _ => Ok(x),
    }
}

fn square(f: &JointPolynomial) -> JointPolynomial {
    f.times(f)
}

/// Eliminates a shift s of the second joint by the height: height = begin + rise s.
fn without_shift(map: &PlaneMap) -> Elimination {
    if !map.first_turns {
        return Elimination::ThirdJointAlone;
    }
    let rotation = map.second_frame.rotation.map(|row| row.map(|x| x.re));
    let rise = match nonzero(rotation[2][2]) {
        Ok(rise) => rise,
        Err(elimination) => return elimination,
    };
    let [x, y, z] = &map.point_at_second;
    let point = [0, 1, 2].map(|i: usize| {
        let sum = x.scaled(rotation[i][0]).plus(&y.scaled(rotation[i][1]));
        let begin = x.constant_like(map.second_frame.position[i].re);
        sum.plus(&z.scaled(rotation[i][2])).plus(&begin)
    });
    let along_shift = (0..3).fold(x.constant_like(0.0), |sum, i| {
        sum.plus(&point[i].scaled(rotation[i][2]))
    });
    let begin = &point[2];
    let squares = square(&point[0])
        .plus(&square(&point[1]))
        .plus(&square(&point[2]));
    let constant = squares
        .minus(&along_shift.times(begin).scaled(2.0 / rise))
        .plus(&square(begin).scaled(1.0 / (rise * rise)));
    let height = along_shift
        .scaled(2.0 / rise)
        .minus(&begin.scaled(2.0 / (rise * rise)));
    let number = |value: f64| x.constant_like(value);
    let terms = [
        constant,
        number(-1.0),
        height,
        number(0.0),
        number(0.0),
        number(1.0 / (rise * rise)),
    ];
    PosturePolynomial::of(terms.map(|f| f.rounded(1.0)), map.turns[1])
}

/// Eliminates a turn of the second joint: |M^-1 (F - a)|^2 = |w|^2.
fn without_turn(map: &PlaneMap) -> Elimination {
    let [x, y, _] = &map.point_at_second;
    let (a, m) = parts(map);
    let determinant = match nonzero(m[0][0] * m[1][1] - m[0][1] * m[1][0]) {
        Ok(determinant) => determinant,
        Err(elimination) => return elimination,
    };
    let inverse = [
        [m[1][1] / determinant, -m[0][1] / determinant],
        [-m[1][0] / determinant, m[0][0] / determinant],
    ];
    let g = |i: usize, j: usize| (0..2).map(|k| inverse[k][i] * inverse[k][j]).sum::<f64>();
    let linear = |i: usize| a[0].scaled(g(i, 0)).plus(&a[1].scaled(g(i, 1)));
    let quadratic = a[0].times(&linear(0)).plus(&a[1].times(&linear(1)));
    let size = quadratic.bound().max(1.0);
    let terms = [
        quadratic.minus(&square(x)).minus(&square(y)).rounded(size),
        linear(0).scaled(-2.0).rounded(size),
        linear(1).scaled(-2.0).rounded(size),
        x.constant_like(g(0, 0)),
        x.constant_like(2.0 * g(0, 1)),
        x.constant_like(g(1, 1)),
    ];
    PosturePolynomial::of(terms, map.turns[1])
}

/// The parts a and M of the map F = a + M Rot(q2) w, where the second joint turns.
fn parts(map: &PlaneMap) -> ([JointPolynomial; 2], [[f64; 2]; 2]) {
    let t = map.second_frame.position.map(|x| x.re);
    let rotation = map.second_frame.rotation.map(|row| row.map(|x| x.re));
    let [x, y, z] = &map.point_at_second;
    let coordinate = |i: usize| z.scaled(rotation[i][2]).plus(&z.constant_like(t[i]));
    if !map.first_turns {
        let a = [coordinate(0), coordinate(1)].map(|f| f.rounded(1.0));
        return (a, [0, 1].map(|i: usize| [rotation[i][0], rotation[i][1]]));
    }
    let along = |k: usize| (0..3).map(|i| t[i] * rotation[i][k]).sum::<f64>();
    let length = square(x).plus(&square(y)).plus(&square(z));
    let begin = x.constant_like(t.iter().map(|c| c * c).sum());
    let distance = length.plus(&begin).plus(&z.scaled(2.0 * along(2)));
    (
        [distance, coordinate(2)].map(|f| f.rounded(1.0)),
        [
            [2.0 * along(0), 2.0 * along(1)],
            [rotation[2][0], rotation[2][1]],
        ],
    )
}

impl PosturePolynomial {
    fn of(terms: [JointPolynomial; 6], third_turns: bool) -> Elimination {
        Elimination::Polynomial(Box::new(Self {
            powers: powers(&terms, third_turns),
            terms,
            third_turns,
        }))
    }

    /// Whether the polynomial has degree 2 in the third joint's shift, or in a function that is even about a value of the third
    /// joint, or depends on the place by its constant term alone; `None` in doubt.
    pub fn is_even(&self) -> Option<bool> {
        let is_zero = |power: &[f64; 6]| power.iter().all(|x| *x == 0.0);
        if !self.third_turns && self.powers[3..].iter().all(is_zero) {
            return Some(true);
        }
        if self.terms[1].is_constant() && self.terms[2].is_constant() {
            return Some(true);
        }
        let centres = self.terms.iter().find_map(|term| self.centres(term));
        let Some(centres) = centres else {
            return Some(true);
        };
        let differences = centres.iter().map(|centre| self.asymmetry(*centre));
        let least = differences.fold(f64::INFINITY, f64::min);
        match least {
            least if least < SAME => Some(true),
            least if least < NEARLY_SAME => None,
            _ => Some(false),
        }
    }

    /// Values of the third joint about which a function may be even; `None` where it is constant.
    fn centres(&self, term: &JointPolynomial) -> Option<Vec<f64>> {
        let coefficient = term.third_coefficients();
        let part = |k: [u8; 2]| coefficient.get(&k).copied().unwrap_or(0.0);
        let angle = |c: f64, s: f64| Angle::of_direction(Complex64::new(c, s)).radians;
        let size = term.bound();
        let is_some = |x: f64| x.abs() > SAME * size;
        if !self.third_turns {
            return match (is_some(part([0, 2])), is_some(part([0, 1]))) {
                (true, _) => Some(vec![-0.5 * part([0, 1]) / part([0, 2])]),
                (false, true) => Some(Vec::new()),
                (false, false) => None,
            };
        }
        if is_some(part([1, 0])) || is_some(part([0, 1])) {
            return Some(vec![angle(part([1, 0]), part([0, 1]))]);
        }
        if is_some(part([2, 0])) || is_some(part([1, 1])) {
            let half = 0.5 * angle(part([2, 0]), part([1, 1]));
            return Some(vec![half, half + std::f64::consts::FRAC_PI_2]);
        }
        None
    }

    /// The largest difference between values at mirrored places about a value of the third joint.
    fn asymmetry(&self, centre: f64) -> f64 {
        let difference = |term: &JointPolynomial, by: f64| {
            let value = |at: f64| {
                let [c, s] = match self.third_turns {
                    true => Angle::of_radians(at).direction,
                    false => [0.0, at],
                };
                term.value(&[0.0, 0.0, c, s])
            };
            (value(centre + by) - value(centre - by)).abs() / term.bound().max(f64::MIN_POSITIVE)
        };
        let each = self.terms.iter().flat_map(|term| {
            let differences = COMPARED.iter().map(|by| difference(term, *by));
            differences.collect::<Vec<f64>>()
        });
        each.fold(0.0, f64::max)
    }

    /// The roots at a place: half-tangents of the third joint from [`ORIGIN`], or its shifts; `None` where one is near infinity.
    pub fn roots(&self, [y1, y2]: [f64; 2]) -> Option<[Complex64; 4]> {
        let monomials = [1.0, y1, y2, y1 * y1, y1 * y2, y2 * y2];
        let coefficients = self.powers.map(|row| {
            let terms = row.iter().zip(monomials).map(|(a, m)| a * m);
            Complex64::from(terms.sum::<f64>())
        });
        quartic::roots(&coefficients)
    }

    /// The number of real postures at a place; `None` where roots are too near to each other to tell.
    pub fn postures(&self, place: [f64; 2]) -> Option<u64> {
        let mut postures = 0;
        for root in self.roots(place)? {
            let size = 1.0 + root.norm_sqr();
            match root.im.abs() {
                part if part > REAL[1] * size => {}
                part if part > REAL[0] * size => return None,
                _ => postures += 1,
            }
        }
        Some(postures)
    }
}

/// For each power of the half-tangent (the shift), the coefficients of 1, y1, y2, y1^2, y1 y2, y2^2.
fn powers(terms: &[JointPolynomial; 6], third_turns: bool) -> [[f64; 6]; 5] {
    let mut powers = [[0.0; 6]; 5];
    let [co, so] = Angle::of_radians(ORIGIN).direction;
    let (n, c, s) = ([1.0, 0.0, 1.0], [co, -2.0 * so, -co], [so, 2.0 * co, -so]);
    for (k, term) in terms.iter().enumerate() {
        for ([i, j], value) in term.third_coefficients() {
            if !third_turns {
                if let Some(power) = powers.get_mut(usize::from(j)) {
                    power[k] += value;
                }
                continue;
            }
            let factors: [[f64; 3]; 2] = match [i, j] {
                [0, 0] => [n, n],
                [1, 0] => [c, n],
                [0, 1] => [s, n],
                [2, 0] => [c, c],
                _ => [c, s],
            };
            for (p, x) in factors[0].iter().enumerate() {
                for (q, y) in factors[1].iter().enumerate() {
                    powers[p + q][k] += value * x * y;
                }
            }
        }
    }
    powers
}
