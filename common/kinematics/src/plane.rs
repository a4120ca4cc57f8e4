//! Points of the plane as complex numbers: lengths, angles and halves of them, without libm.

use num_complex::Complex64;

/// |z|.
pub fn modulus(z: Complex64) -> f64 {
    // Scaled, so that neither a square overflows nor a small one is lost.
    let size = z.re.abs().max(z.im.abs());
    if size == 0.0 || !size.is_finite() {
        return size;
    }
    let (re, im) = (z.re / size, z.im / size);
    size * (re * re + im * im).sqrt()
}

/// z / |z|; 1 for 0.
pub fn unit(z: Complex64) -> Complex64 {
    let size = modulus(z);
    if size == 0.0 {
        Complex64::new(1.0, 0.0)
    } else {
        z / size
    }
}

/// The number that an isotropic coordinate and its conjugate, each with its own rounding, stand for.
pub fn real_place(z: Complex64, conjugate: Complex64) -> Complex64 {
    (z + conjugate.conj()) / 2.0
}

/// Divisor of lengths of this extent: the power of 2 that is not larger; `None` where differences overflow or vanish in
/// double precision.
pub fn scale(extent: f64) -> Option<f64> {
    // The exponent alone, as bits: 2^k <= extent < 2^(k+1).
    (1e-290..=1e290)
        .contains(&extent)
        .then(|| f64::from_bits(extent.to_bits() & (0x7ff << 52)))
}

/// The signed area of the parallelogram of two vectors: positive where `w` lies to the left of `z`.
pub fn cross(z: Complex64, w: Complex64) -> f64 {
    z.re * w.im - z.im * w.re
}

/// The unit vector at half of this one's angle, which is taken from -180 to 180 degrees.
pub fn half(z: Complex64) -> Complex64 {
    let z = unit(z);
    let re = ((1.0 + z.re) / 2.0).max(0.0).sqrt();
    // The larger of the two parts is the accurate one.
    if re > 0.5 {
        return unit(Complex64::new(re, z.im / (2.0 * re)));
    }
    let im = ((1.0 - z.re) / 2.0).max(0.0).sqrt();
    let re = z.im.abs() / (2.0 * im);
    Complex64::new(re, if z.im < 0.0 { -im } else { im })
}

/// Where two circles meet: the distance of their common chord from the first centre along the line of centres, and half of
/// the chord's length; 0 where they do not meet.
///
/// `apart` is the distance of the centres, not 0.
pub fn common_chord(apart: f64, [first, second]: [f64; 2]) -> [f64; 2] {
    let (sum, difference) = (first + second, (first - second).abs());
    let along = (apart * apart + (first + second) * (first - second)) / (2.0 * apart);
    // A product, which loses no digits where the chord is short.
    let product = (sum - apart) * (sum + apart) * (apart - difference) * (apart + difference);
    [along, product.max(0.0).sqrt() / (2.0 * apart)]
}

/// The angle of a vector in degrees, above -180 and at most 180; 0 for 0. Exact for multiples of 90.
pub fn degrees(z: Complex64) -> f64 {
    const HALVINGS: i32 = 3;
    // The nearest quarter turn, and the vector turned back by it: at most 45 degrees are left.
    let (quarter, rest) = if z.im.abs() <= z.re.abs() {
        match (z.re >= 0.0, z.im >= 0.0) {
            (true, _) => (0.0, z),
            (false, true) => (180.0, -z),
            (false, false) => (-180.0, -z),
        }
    } else if z.im > 0.0 {
        (90.0, Complex64::new(z.im, -z.re))
    } else {
        (-90.0, Complex64::new(-z.im, z.re))
    };
    let mut small = unit(rest);
    for _ in 0..HALVINGS {
        small = half(small);
    }
    // Below 5.7 degrees: atan(t) by its series, t^25 < 1e-25 of t.
    let t = small.im / small.re;
    let square = t * t;
    let mut sum = 0.0;
    for k in (0..12).rev() {
        let term = 1.0 / f64::from(2 * k + 1);
        sum = term - square * sum;
    }
    quarter + sum * t * f64::from(1 << HALVINGS) * (180.0 / std::f64::consts::PI)
}

/// The unit vector of an angle in degrees, without libm.
pub fn direction(degrees: f64) -> Complex64 {
    // Whole turns and quarters are exact; the rest is at most 45 degrees.
    let within = degrees % 360.0;
    let quarters = (within / 90.0).round();
    let rest = (within - quarters * 90.0) * (std::f64::consts::PI / 180.0);
    let square = rest * rest;
    let series = |first: f64, from: u32| {
        // Eight terms: the ninth is below 1e-17 of the first.
        let mut sum = 0.0;
        for k in (1..9u32).rev() {
            let n = f64::from(2 * k + from);
            sum = -(square / (n * (n - 1.0))) * (1.0 + sum);
        }
        first * (1.0 + sum)
    };
    let turned = Complex64::new(series(1.0, 0), series(rest, 1));
    let quarter = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    let (re, im) = quarter[(quarters as i64).rem_euclid(4) as usize];
    unit(turned * Complex64::new(re, im))
}

/// The angle between two vectors in degrees, from 0 to 180.
pub fn angle_between(z: Complex64, w: Complex64) -> f64 {
    degrees(w * z.conj()).abs()
}

/// A number that grows with the angle of a unit vector, from -2 to 2 as the angle goes from -180
/// to 180 degrees; 0 at 0.
pub fn turn(z: Complex64) -> f64 {
    let size = z.re.abs() + z.im.abs();
    if size == 0.0 {
        return 0.0;
    }
    let share = 1.0 - z.re / size;
    if z.im < 0.0 { -share } else { share }
}

/// `count` unit vectors from one angle to another, counterclockwise, evenly spaced, both ends
/// among them; the way is shorter than a whole turn, and `count` is one more than a power of 2.
///
/// # Panics
/// When `count` is not that.
pub fn arc(from: Complex64, to: Complex64, count: usize) -> Vec<Complex64> {
    assert!(
        count > 1 && (count - 1).is_power_of_two(),
        "an arc is halved again and again"
    );
    let mut points = vec![Complex64::default(); count];
    let (from, to) = (unit(from), unit(to));
    points[0] = from;
    points[count - 1] = to;
    let mut width = count - 1;
    while width > 1 {
        for start in (0..count - 1).step_by(width) {
            let (low, high) = (points[start], points[start + width]);
            let mut way = half(high * low.conj());
            // More than half a turn: the half of the angle that `half` did not take.
            if way.im < 0.0 {
                way = -way;
            }
            points[start + width / 2] = unit(low * way);
        }
        width /= 2;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::roots_of_unity::roots_of_unity;

    #[test]
    fn angles_are_those_of_the_roots_of_unity() {
        for (k, z) in roots_of_unity(720).into_iter().enumerate() {
            let expected = if k <= 360 {
                k as f64 / 2.0
            } else {
                k as f64 / 2.0 - 360.0
            };
            let angle = degrees(z * 3e-7);
            assert!((angle - expected).abs() < 1e-13, "{k}: {angle}");
            let twice = half(z) * half(z);
            assert!((twice - z).norm_sqr() < 1e-30, "{k}");
        }
        for k in -1440..1440 {
            let angle = f64::from(k) / 4.0;
            let back = degrees(direction(angle));
            let off = (back - angle).abs() % 360.0;
            assert!(off.min(360.0 - off) < 1e-13, "{angle}: {back}");
            assert!((modulus(direction(angle)) - 1.0).abs() < 1e-15);
        }
        assert_eq!(direction(-270.0), Complex64::new(0.0, 1.0));
        let quarters = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        let exact = quarters.map(|(re, im)| degrees(Complex64::new(re, im)));
        assert_eq!(exact, [0.0, 90.0, 180.0, -90.0]);
        assert!((angle_between(Complex64::i(), Complex64::new(-2.0, 0.0)) - 90.0).abs() < 1e-12);
    }

    #[test]
    fn turns_grow_with_the_angle() {
        let roots = roots_of_unity(360);
        let around: Vec<f64> = (181..360).chain(0..181).map(|k| turn(roots[k])).collect();
        assert!(around.windows(2).all(|w| w[0] < w[1]), "{around:?}");
    }

    #[test]
    fn arcs_are_even_and_have_their_ends() {
        let roots = roots_of_unity(360);
        for (from, to) in [(0usize, 90usize), (350, 340), (10, 300), (180, 179)] {
            let points = arc(roots[from], roots[to], 65);
            let step = ((to + 360 - from) % 360) as f64 / 64.0;
            for pair in points.windows(2) {
                assert!((degrees(pair[1] * pair[0].conj()) - step).abs() < 1e-9);
            }
        }
    }
}
