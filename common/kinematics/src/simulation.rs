//! The verdicts of `Drive` and `Linkage::circuit` against a linkage that is really moved: its
//! whole circuit in small steps, knowing nothing but the lengths.

use crate::assessment::Assessment;
use crate::linkage::{Linkage, Side};
use crate::plane::{angle_between, cross, modulus};
use crate::test_linkages::{at_points, random_linkage};
use num_complex::Complex64;

/// Step along the curve of positions, in the scale of the linkages.
const STEP: f64 = 8e-3;

/// Joints A and B.
type State = [Complex64; 2];

fn gap(p: &State, q: &State) -> f64 {
    ((p[0] - q[0]).norm_sqr() + (p[1] - q[1]).norm_sqr()).sqrt()
}

/// Gradients of the three squared lengths |A - a|^2, |B - b|^2, |A - B|^2, without the 2.
fn gradients(pivots: &State, s: &State) -> [[Complex64; 2]; 3] {
    let zero = Complex64::new(0.0, 0.0);
    let coupler = s[0] - s[1];
    [
        [s[0] - pivots[0], zero],
        [zero, s[1] - pivots[1]],
        [coupler, -coupler],
    ]
}

/// The direction that changes no length: A turns around a, B around b, at speeds that keep the
/// coupler's length.
fn tangent(pivots: &State, s: &State) -> State {
    let turned = [0, 1].map(|k| Complex64::i() * (s[k] - pivots[k]));
    let coupler = s[0] - s[1];
    let dot = |z: Complex64| coupler.re * z.re + coupler.im * z.im;
    let way = [turned[0] * dot(turned[1]), turned[1] * dot(turned[0])];
    let size = gap(&way, &[Complex64::default(); 2]);
    way.map(|z| z / size)
}

/// Back onto the curve: Gauss and Newton, by solving the 3x3 system of gradients.
fn corrected(pivots: &State, squares: [f64; 3], mut s: State) -> State {
    for _ in 0..6 {
        let g = gradients(pivots, &s);
        let dot = |p: &[Complex64; 2], q: &[Complex64; 2]| {
            p.iter()
                .zip(q)
                .map(|(a, b)| a.re * b.re + a.im * b.im)
                .sum::<f64>()
        };
        let square_lengths =
            [s[0] - pivots[0], s[1] - pivots[1], s[0] - s[1]].map(|z| z.norm_sqr());
        let mut m = [[0.0; 4]; 3];
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] = dot(&g[i], &g[j]);
            }
            m[i][3] = (squares[i] - square_lengths[i]) / 2.0;
        }
        for k in 0..3 {
            let pivot = (k..3).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs()));
            m.swap(k, pivot.expect("three rows"));
            for i in 0..3 {
                if i != k {
                    let factor = m[i][k] / m[k][k];
                    for j in 0..4 {
                        m[i][j] -= factor * m[k][j];
                    }
                }
            }
        }
        for i in 0..3 {
            let weight = m[i][3] / m[i][i];
            s = [0, 1].map(|k| s[k] + g[i][k] * weight);
        }
    }
    s
}

/// The whole circuit of a position, from it back to it.
fn circuit(linkage: &Linkage) -> Vec<State> {
    let pivots = linkage.pivots;
    let start = linkage.joints;
    let squares = {
        let [p, q] = start;
        [p - pivots[0], q - pivots[1], p - q].map(|z| z.norm_sqr())
    };
    let mut states = vec![start];
    let mut before = tangent(&pivots, &start);
    let mut at = start;
    loop {
        let mut way = tangent(&pivots, &at);
        let along: f64 = (0..2).map(|k| (way[k] * before[k].conj()).re).sum();
        if along < 0.0 {
            way = way.map(|z| -z);
        }
        before = way;
        at = corrected(&pivots, squares, [0, 1].map(|k| at[k] + way[k] * STEP));
        if states.len() > 20 && gap(&at, &start) < STEP {
            return states;
        }
        states.push(at);
        assert!(states.len() < 100_000, "the circuit closes");
    }
}

/// Result of the simulation for one driver.
#[derive(Debug)]
struct Seen {
    one_branch: bool,
    order: Vec<usize>,
    least_angle: f64,
}

/// The joint between coupler and driven side, along the circuit.
fn fold(pivots: &State, s: &State, driver: Side) -> (f64, f64) {
    let (driver_index, other) = (driver.index(), driver.other().index());
    let (coupler, driven) = (s[driver_index] - s[other], pivots[other] - s[other]);
    let angle = angle_between(coupler, driven);
    (cross(coupler, driven), angle.min(180.0 - angle))
}

fn seen(states: &[State], pivots: &State, places: &[usize], driver: Side) -> Seen {
    let n = states.len();
    let folds: Vec<(f64, f64)> = states.iter().map(|s| fold(pivots, s, driver)).collect();
    let dead: Vec<usize> = (0..n)
        .filter(|&k| (folds[k].0 < 0.0) != (folds[(k + 1) % n].0 < 0.0))
        .collect();
    // A branch starts behind a dead centre; without one the circuit is the branch.
    let origin = dead.first().map_or(0, |&k| k + 1);
    let branch = |place: usize| dead.iter().filter(|&&k| k < place).count() % dead.len().max(1);
    let one_branch = places.iter().all(|&p| branch(p) == branch(places[0]));
    let shifted = |place: usize| match dead.is_empty() || !one_branch {
        true => (place + n - places[0]) % n,
        false => (place + n - origin) % n,
    };
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by_key(|&k| shifted(places[k]));
    let span: Vec<usize> = match (one_branch, dead.is_empty()) {
        (false, _) => places.to_vec(),
        (true, true) => (0..n).collect(),
        (true, false) => {
            let (first, last) = (places[order[0]], places[order[places.len() - 1]]);
            (0..=(last + n - first) % n)
                .map(|k| (first + k) % n)
                .collect()
        }
    };
    let angles = span.iter().map(|&k| folds[k].1);
    Seen {
        one_branch,
        order,
        least_angle: angles.fold(90.0, f64::min),
    }
}

/// Checks that two lists have the same order, forwards or backwards; around from the first element if `around`.
fn same_order(one: &[usize], two: &[usize], around: bool) -> bool {
    let mut back = two.to_vec();
    back.reverse();
    if around {
        back.rotate_right(1);
    }
    one == two || one == back
}

/// Compares the verdicts; `None` where a position lies too near to a border to be simulated.
fn check(seed: u64) -> Option<[bool; 3]> {
    let linkage = random_linkage(seed);
    let around = linkage.lengths().around();
    let (least, most) = around
        .iter()
        .fold((f64::MAX, 0.0f64), |(l, m), &x| (l.min(x), m.max(x)));
    let excess = 2.0 * (least + most) - around.iter().sum::<f64>();
    // Nearly change-point, or nearly without a link.
    if excess.abs() < 0.03 || least < 0.05 {
        return None;
    }
    let poses = at_points(&linkage, seed, 9);
    let states = circuit(&linkage);
    let nearest = |pose: &Linkage| {
        let gaps = states.iter().map(|s| gap(s, &pose.joints));
        let (place, gap) = gaps
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("states");
        (gap < STEP).then_some(place)
    };
    let places: Vec<Option<usize>> = poses.iter().map(nearest).collect();
    let assessment = Assessment::new(&poses);
    let on_circuit: Option<Vec<usize>> = places.into_iter().collect();
    assert_eq!(
        assessment.one_circuit,
        on_circuit.is_some(),
        "seed {seed}: {linkage:?}"
    );
    let Some(places) = on_circuit else {
        assert!(
            assessment
                .drives
                .iter()
                .all(|d| !d.one_branch && d.order.is_none())
        );
        return Some([false; 3]);
    };
    let mut sorted = places.clone();
    sorted.sort_unstable();
    if sorted.windows(2).any(|w| w[1] - w[0] < 3) {
        return None;
    }
    for drive in &assessment.drives {
        let near_dead = |pose: &Linkage| fold(&pose.pivots, &pose.joints, drive.driver).1 < 1.0;
        if poses.iter().any(near_dead) {
            return None;
        }
        let seen = seen(&states, &linkage.pivots, &places, drive.driver);
        assert_eq!(
            drive.one_branch, seen.one_branch,
            "seed {seed}: {drive:?}, {seen:?}"
        );
        let order = drive.order.as_ref().expect("one circuit");
        let around = !drive.one_branch || drive.turns_round;
        assert!(
            same_order(order, &seen.order, around),
            "seed {seed}: {drive:?}, {seen:?}"
        );
        let error = (drive.transmission_degrees - seen.least_angle).abs();
        assert!(error < 1.0, "seed {seed}: {drive:?}, {seen:?}");
    }
    Some([
        true,
        assessment.drives[0].one_branch,
        assessment.drives[1].one_branch,
    ])
}

#[test]
fn verdicts_are_those_of_a_simulation_of_a_thousand_linkages() {
    let mut counts = [0; 3];
    let mut checked = 0;
    let mut seed = 0;
    while checked < 1000 {
        if let Some(verdicts) = check(seed) {
            checked += 1;
            for (count, verdict) in counts.iter_mut().zip(verdicts) {
                *count += usize::from(verdict);
            }
        }
        seed += 1;
        assert!(seed < 3000, "most linkages can be simulated");
    }
    // Each verdict came up often, both ways.
    assert!(
        counts.iter().all(|n| (150..900).contains(n)),
        "{counts:?} of {seed}"
    );
}

#[test]
fn the_simulation_notices_a_wrong_verdict() {
    let seed = (0..500).find(|&seed| check(seed).is_some_and(|v| v[0] && !v[1]));
    let linkage = random_linkage(seed.expect("one of them has a dead centre"));
    let poses = at_points(&linkage, seed.expect("as before"), 9);
    let states = circuit(&linkage);
    // The curve is closed and every link keeps its length on it.
    for state in &states {
        let lengths = Linkage {
            joints: *state,
            ..linkage
        }
        .lengths();
        let was = linkage.lengths();
        assert!((lengths.coupler - was.coupler).abs() < 1e-10);
        assert!((0..2).all(|k| (lengths.sides[k] - was.sides[k]).abs() < 1e-10));
    }
    let drive = &Assessment::new(&poses).drives[0];
    assert!(!drive.one_branch && drive.swing_degrees.is_none());
    assert!(
        poses
            .iter()
            .any(|pose| pose.assembly(Side::A) != poses[0].assembly(Side::A))
            || drive.order.is_some()
    );
    assert!(modulus(states[0][0] - linkage.joints[0]) == 0.0);
}
