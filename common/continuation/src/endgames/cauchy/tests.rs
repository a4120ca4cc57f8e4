//! The endgame on paths whose sheets are known: Puiseux series, poles and branch points near t = 0.

use super::*;
use cognate_numeric::roots_of_unity::roots_of_unity;

/// With the digits of double-doubles.
fn precise(values: &[Complex64]) -> Vec<Homogenizing> {
    let precise = |z: &Complex64| Homogenizing::from_f64((), z.re, z.im);
    values.iter().map(precise).collect()
}

/// Drives the endgame from t = `radius` along x(s) with s^c = t, all sheets known exactly; x_1 is
/// homogenising, and `valuation` is its valuation.
fn drive(
    c: u32,
    mut radius: f64,
    path: &dyn Fn(Complex64) -> Vec<Complex64>,
    valuation: &dyn Fn(Complex64) -> Vec<Complex64>,
) -> (Next, u32) {
    let settings = Settings::default();
    let fine = roots_of_unity(VERTICES * c);
    let mut cauchy = Cauchy::default();
    let root = |r: f64| {
        // The real c-th root of r, by Newton's method.
        let mut s: f64 = 1.0;
        for _ in 0..2000 {
            s -= (s - r / s.powi(c as i32 - 1)) / f64::from(c);
        }
        s
    };
    let mut at = 0u32;
    let place = |radius: f64, at: u32| fine[(at % (VERTICES * c)) as usize] * root(radius);
    let x = path(place(radius, 0));
    let circle = roots_of_unity(VERTICES);
    let doubles = [false, false];
    let mut next = cauchy.begin(radius, &x, 1e-15, &precise(&x[1..]), doubles);
    for _ in 0..10_000 {
        match next {
            Next::Vertex { .. } => {
                at += 1;
                let s = place(radius, at);
                let x = path(s);
                let form = form_of_difference(&x, cauchy.start());
                let valuation = valuation(s);
                let (t, x_1) = (circle[(at % VERTICES) as usize] * radius, precise(&x[1..]));
                next = cauchy.at_vertex(t, &x, 1e-15, form, &x_1, &valuation, &settings);
            }
            Next::Inward(r) => {
                radius = r;
                at = 0;
                let x = path(place(radius, 0));
                next = cauchy.begin(radius, &x, 1e-15, &precise(&x[1..]), doubles);
            }
            _ => break,
        }
    }
    (next, cauchy.total_turns())
}

#[test]
fn puiseux_series_end_with_their_winding_number_and_limit() {
    let one = Complex64::new(1.0, 0.0);
    for c in 1..=6 {
        let path = |s| vec![s * s * (one + s), one * 2.0 + s - s * s / (one - s)];
        let (next, _) = drive(c, 0.05, &path, &|_| vec![Complex64::default()]);
        let Next::Settled(settled) = next else {
            panic!("c = {c}: {next:?}")
        };
        assert_eq!(settled.winding_number, c);
        assert!(settled.endpoint[0].norm_sqr().sqrt() < 1e-9, "{settled:?}");
        assert!((settled.endpoint[1] - 2.0).norm_sqr().sqrt() < 1e-9);
        assert_eq!(settled.infinity_turns, vec![0]);
    }
}

/// Of 50 sheets x_1 = t^(1/50) (1 + 0.03 t^(1/50)) goes to 0, which its valuation says before the path has closed;
/// with a limit the path closes.
#[test]
fn a_path_that_does_not_close_diverges_by_its_valuation_only() {
    let one = Complex64::new(1.0, 0.0);
    let diverging = Next::Diverging {
        winding_number: None,
        infinity_turns: Vec::new(),
        power_sum: None,
    };
    let end = |limit: f64| {
        let x = |s: Complex64| s * (one + s * 0.03) + limit;
        let path = |s: Complex64| vec![one + s, x(s)];
        // t d/dt = (s/50) d/ds.
        let valuation = |s: Complex64| vec![s / 50.0 * (one + s * 0.06) / x(s)];
        drive(50, 1e-3, &path, &valuation).0
    };
    assert_eq!(end(0.0), diverging);
    let Next::Settled(settled) = end(1.0) else {
        panic!("{:?}", end(1.0))
    };
    assert_eq!(settled.winding_number, 50);
    assert!((settled.endpoint[1] - one).norm_sqr() < 1e-20);
}

/// Seven solutions of which a homogenising coordinate is the root of 1e-9, as cyclic-7 has them: until t
/// is as small they are like t^(1/7), as a path to infinity is.
#[test]
fn a_solution_that_is_near_infinity_is_no_divergence() {
    let (sheets, a) = (7, 1e-9);
    let settings = Settings::default();
    let circle = roots_of_unity(VERTICES);
    let mut last = Complex64::new(1.0, 0.0);
    let follow = |last: &mut Complex64, from: Complex64, to: Complex64| {
        for k in 1..=100 {
            let t = from + (to - from) * (f64::from(k) / 100.0);
            for _ in 0..20 {
                let power = last.powu(sheets - 1);
                *last -= (power * *last - t - a) / (power * f64::from(sheets));
            }
        }
        vec![*last, *last + 1.0]
    };
    let valuation = |t: Complex64| vec![t / (t + a) / f64::from(sheets)];
    let mut cauchy = Cauchy::default();
    let mut t = Complex64::new(1e-3, 0.0);
    let x = follow(&mut last, Complex64::new(1.0, 0.0), t);
    let doubles = [false, false];
    let mut next = cauchy.begin(t.re, &x, 1e-15, &precise(&x[..1]), doubles);
    let settled = loop {
        let to = match &next {
            Next::Vertex { radius, vertex } => circle[(vertex % VERTICES) as usize] * *radius,
            Next::Inward(radius) => Complex64::new(*radius, 0.0),
            Next::Settled(settled) => break settled.clone(),
            other => panic!("{other:?} at {t}"),
        };
        if matches!(next, Next::Inward(_)) {
            // Wherever on the seven sheets a turn ends, inwards it goes on from its start.
            last = cauchy.start()[0];
            t = Complex64::new(cauchy.radius(), 0.0);
        }
        let x = follow(&mut last, t, to);
        t = to;
        next = match next {
            Next::Inward(radius) => cauchy.begin(radius, &x, 1e-15, &precise(&x[..1]), doubles),
            _ => {
                let form = form_of_difference(&x, cauchy.start());
                let x_0 = precise(&x[..1]);
                cauchy.at_vertex(to, &x, 1e-15, form, &x_0, &valuation(to), &settings)
            }
        };
    };
    assert_eq!(
        (settled.winding_number, &settled.infinity_turns[..]),
        (1, &[0][..])
    );
    assert!((settled.endpoint[0].powu(sheets) / a - 1.0).norm_sqr() < 1e-12);
}

#[test]
fn endpoints_that_are_only_close_are_told_apart() {
    // x = 1 +- sqrt(t + d^2) ends at two regular points; large turns see a double one.
    for distance in [1e-2, 1e-3, 1e-4] {
        let settings = Settings::default();
        let circle = roots_of_unity(VERTICES);
        let mut cauchy = Cauchy::default();
        let mut last = Complex64::new(1.0, 0.0);
        // Follows the sheet by continuity, in small steps.
        let mut follow = |from: Complex64, to: Complex64| {
            for k in 1..=200 {
                let t = from + (to - from) * (f64::from(k) / 200.0);
                let square = t + distance * distance;
                for _ in 0..60 {
                    last = 0.5 * (last + square / last);
                }
            }
            vec![last + 1.0, last * 2.0 - 3.0]
        };
        let mut radius = 0.05;
        let mut t = Complex64::new(radius, 0.0);
        let x = follow(Complex64::new(1.0, 0.0), t);
        let mut next = cauchy.begin(radius, &x, 1e-15, &[], [false, false]);
        let settled = loop {
            match next {
                Next::Vertex { vertex, .. } => {
                    let to = circle[(vertex % VERTICES) as usize] * radius;
                    let x = follow(t, to);
                    t = to;
                    let form = form_of_difference(&x, cauchy.start());
                    next = cauchy.at_vertex(to, &x, 1e-15, form, &[], &[], &settings);
                }
                Next::Inward(r) => {
                    // After a closed curve the path is where it began.
                    let to = Complex64::new(r, 0.0);
                    let x = follow(t, to);
                    (t, radius) = (to, r);
                    next = cauchy.begin(radius, &x, 1e-15, &[], [false, false]);
                }
                Next::Settled(settled) => break settled,
                Next::Diverging { .. } | Next::PreciseSamples | Next::Finer | Next::Unsettled => {
                    panic!("{next:?} at {distance}")
                }
            }
        };
        assert_eq!(settled.winding_number, 1, "distance {distance}");
        let error = (settled.endpoint[0] - 1.0).norm_sqr().sqrt() - distance;
        assert!(error.abs() < 1e-9, "distance {distance}: {error}");
    }
}

#[test]
fn a_branch_point_inside_the_first_radius_is_left_outside() {
    let one = Complex64::new(1.0, 0.0);
    let path = |t| vec![one / (t - 0.01), one * 2.0 + t];
    let (next, turns) = drive(1, 0.05, &path, &|_| vec![Complex64::default()]);
    let Next::Settled(settled) = next else {
        panic!("{next:?}")
    };
    assert!((settled.endpoint[0] + 100.0).norm_sqr().sqrt() < 1e-6 && turns >= 3);
}
