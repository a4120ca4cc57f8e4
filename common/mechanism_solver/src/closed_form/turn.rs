//! Turn: the angle of a joint by its cosine and sine, which are complex where a posture is.

use num_complex::Complex64;

/// Two turns whose sines differ by less than the root of this are not told apart: the arm is near a fold.
pub const NEAR_FOLD: f64 = 1e-10;

/// Cosine and sine of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// The cosine.
    pub c: Complex64,
    /// The sine.
    pub s: Complex64,
}

/// The turns of an arm's joints, from the first to the last.
pub type Turns = [Turn; 6];

impl Turn {
    /// The angle 0.
    pub const NONE: Self = Self {
        c: Complex64::new(1.0, 0.0),
        s: Complex64::new(0.0, 0.0),
    };

    /// The turn that takes one vector of the plane to another of the same square (subproblem 1 of B. Paden 1986); `None`
    /// where that square is nearly 0, so that every turn does, or none.
    pub fn between(from: [Complex64; 2], to: [Complex64; 2]) -> Option<Self> {
        let square = from[0] * from[0] + from[1] * from[1];
        if square.norm_sqr() < NEAR_FOLD * NEAR_FOLD {
            return None;
        }
        Some(Self {
            c: (from[0] * to[0] + from[1] * to[1]) / square,
            s: (from[0] * to[1] - from[1] * to[0]) / square,
        })
    }

    /// The two turns with this cosine, that of the principal root first; `None` where they are nearly one.
    pub fn of_cosine(c: Complex64) -> Option<[Self; 2]> {
        let square = 1.0 - c * c;
        let is_clear = square.norm_sqr() > NEAR_FOLD * NEAR_FOLD;
        is_clear.then(|| {
            let s = square_root(square);
            [Self { c, s }, Self { c, s: -s }]
        })
    }

    /// This turn, then the other.
    pub fn then(&self, other: &Self) -> Self {
        Self {
            c: self.c * other.c - self.s * other.s,
            s: self.s * other.c + self.c * other.s,
        }
    }

    /// The turn that takes back.
    pub fn inverse(&self) -> Self {
        Self {
            c: self.c,
            s: -self.s,
        }
    }

    /// The image of a vector of the plane.
    pub fn of(&self, [x, y]: [Complex64; 2]) -> [Complex64; 2] {
        [self.c * x - self.s * y, self.s * x + self.c * y]
    }

    /// How large its numbers are: 1 for real turns, up to rounding.
    pub fn size(&self) -> f64 {
        self.c.norm_sqr().max(self.s.norm_sqr()).sqrt().max(1.0)
    }

    /// The largest imaginary part.
    pub fn imaginary(&self) -> f64 {
        self.c.im.abs().max(self.s.im.abs())
    }
}

/// The principal root, without libm; of a real number it is real or imaginary, exactly.
pub fn square_root(z: Complex64) -> Complex64 {
    if z.im == 0.0 {
        let root = z.re.abs().sqrt();
        return match z.re < 0.0 {
            true => Complex64::new(0.0, root),
            false => Complex64::new(root, 0.0),
        };
    }
    let half = (z.norm_sqr().sqrt() + z.re.abs()) / 2.0;
    let large = half.sqrt();
    let small = z.im.abs() / (2.0 * large);
    let sign = z.im.signum();
    match z.re < 0.0 {
        true => Complex64::new(small, sign * large),
        false => Complex64::new(large, sign * small),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_principal_and_real_ones_exact() {
        for z in [(3.0, 4.0), (-3.0, 4.0), (-3.0, -4.0), (1e-9, -2.0)] {
            let z = Complex64::new(z.0, z.1);
            let root = square_root(z);
            assert!((root * root - z).norm_sqr() < 1e-30 && root.re > 0.0, "{z}");
        }
        assert_eq!(square_root((-4.0).into()), Complex64::new(0.0, 2.0));
        assert_eq!(square_root(9.0.into()), Complex64::new(3.0, 0.0));
    }

    #[test]
    fn turns_take_vectors_to_vectors() {
        let [turn, other] = Turn::of_cosine(Complex64::new(1.7, 0.0)).expect("clear of the fold");
        assert_eq!(turn.s, -other.s);
        let from = [Complex64::new(0.3, -0.2), Complex64::new(-0.7, 0.1)];
        let same = Turn::between(from, turn.of(from)).expect("a square that is not 0");
        assert!((same.c - turn.c).norm_sqr() + (same.s - turn.s).norm_sqr() < 1e-28);
        let rest = turn.then(&turn.inverse());
        assert!((rest.c - 1.0).norm_sqr() + rest.s.norm_sqr() < 1e-28);
        assert_eq!(Turn::of_cosine(1.0.into()), None);
        assert_eq!(Turn::between([1e-7.into(), 0.0.into()], from), None);
    }
}
