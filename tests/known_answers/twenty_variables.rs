//! Random sparse systems in twenty variables whose mixed volume is a product of areas.
//!
//! The variables come in pairs. The two equations of a pair have random monomials of it, each times
//! a random monomial of earlier pairs: the mixed volume is the product of the plane ones, what
//! earlier variables do (Steffens, Theobald: Mixed volume techniques for embeddings of Laman
//! graphs, 2010, lemma 6). In the plane it is area(P + Q) - area(P) - area(Q), by Pick's and
//! nobody's mixed cells. A shear of the exponents changes no volume, and hides all of it.

use crate::check::solve;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_continuation::start_systems::polyhedral::mixed_cells::mixed_cells;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_tests::systems::written;
use std::fmt::Write;

const VARIABLES: usize = 20;

type Point = [i64; 2];

/// Twice the area of the convex hull of some points of the plane.
fn twice_the_area(points: &[Point]) -> i64 {
    let turn = |a: Point, b: Point, c: Point| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let mut sorted = points.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    // Andrew's monotone chain: below from the left, then above from the right.
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = chain.as_slice()
                && turn(*a, *b, p) <= 0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.append(&mut chain(&mut sorted.iter().rev().copied()));
    (0..hull.len())
        .map(|i| (hull[i], hull[(i + 1) % hull.len()]))
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum()
}

/// The mixed volume of two supports in the plane.
fn mixed_area(p: &[Point], q: &[Point]) -> i64 {
    let sum: Vec<Point> = p
        .iter()
        .flat_map(|a| q.iter().map(move |b| [a[0] + b[0], a[1] + b[1]]))
        .collect();
    (twice_the_area(&sum) - twice_the_area(p) - twice_the_area(q)) / 2
}

struct Sparse {
    supports: Vec<Vec<Vec<i64>>>,
    mixed_volume: u64,
}

/// A random one with a mixed volume up to `most`; variables of earlier pairs have exponents up to
/// `earlier` in it.
fn sparse(seed: u64, most: i64, earlier: u64) -> Sparse {
    let mut random = RandomStream::new(seed, Purpose::Test, 20);
    let mut volume = 1;
    let mut supports = Vec::new();
    for pair in (0..VARIABLES).step_by(2) {
        let simplex = vec![[0, 0], [1, 0], [0, 1]];
        let mut draw = || -> Vec<Point> {
            let mut support = vec![[0, 0]];
            while support.len() < 4 {
                let point = [random.below(4) as i64, random.below(4) as i64];
                if !support.contains(&point) {
                    support.push(point);
                }
            }
            support
        };
        let (mut p, mut q) = (draw(), draw());
        let area = mixed_area(&p, &q);
        if area == 0 || volume * area > most {
            (p, q) = (simplex.clone(), simplex);
        } else {
            volume *= area;
        }
        for support in [p, q] {
            let term = |point: Point| {
                let mut exponents = vec![0; VARIABLES];
                [exponents[pair], exponents[pair + 1]] = point;
                if pair > 0 && point != [0, 0] {
                    let v = random.below(pair as u64) as usize;
                    exponents[v] = random.below(earlier + 1) as i64;
                }
                exponents
            };
            supports.push(support.into_iter().map(term).collect());
        }
    }
    Sparse {
        supports,
        mixed_volume: volume as u64,
    }
}

/// Adds rows of the exponents to others, and shuffles equations and variables.
fn hidden(mut supports: Vec<Vec<Vec<i64>>>, seed: u64) -> Vec<Vec<Vec<i64>>> {
    let mut random = RandomStream::new(seed, Purpose::Test, 21);
    let mut below = |n: usize| random.below(n as u64) as usize;
    for _ in 0..VARIABLES {
        let (from, to) = (below(VARIABLES), below(VARIABLES));
        if from != to {
            for point in supports.iter_mut().flatten() {
                point[to] += point[from];
            }
        }
    }
    for i in (1..VARIABLES).rev() {
        let (j, v) = (below(i + 1), below(i + 1));
        supports.swap(i, j);
        for point in supports.iter_mut().flatten() {
            point.swap(i, v);
        }
    }
    supports
}

#[test]
fn areas_of_the_plane() {
    let square = [[0, 0], [1, 0], [0, 1], [1, 1]];
    assert_eq!(twice_the_area(&square), 2);
    assert_eq!(mixed_area(&square, &square), 2);
    let line = [[0, 0], [1, 0], [0, 1]];
    let cubic = [[0, 0], [3, 0], [0, 3], [1, 1]];
    assert_eq!(mixed_area(&line, &cubic), 3);
    assert_eq!(mixed_area(&[[0, 0], [2, 1]], &[[0, 0], [4, 2]]), 0);
}

#[test]
fn mixed_volumes_in_twenty_variables_are_products_of_areas() {
    for seed in 0..2 {
        let Sparse {
            supports,
            mixed_volume,
        } = sparse(seed, 1000, 3);
        for supports in [hidden(supports.clone(), seed), supports] {
            let cell_volume = mixed_cells(&supports, seed, u64::MAX);
            let cell_volume = cell_volume.map(|cells| cells.mixed_volume);
            assert_eq!(cell_volume, Ok(mixed_volume), "seed {seed}");
        }
    }
}

/// With random coefficients there are as many solutions, all regular (Bernstein 1975).
#[test]
fn a_random_sparse_system_in_twenty_variables_is_solved() {
    let Sparse {
        supports,
        mixed_volume,
    } = sparse(3, 100, 1);
    assert!(mixed_volume > 20, "{mixed_volume}");
    let mut random = RandomStream::new(3, Purpose::Test, 22);
    let list = |letter: char, first: usize| -> String {
        let names: Vec<String> = (first..first + VARIABLES)
            .map(|k| format!("{letter}{k}"))
            .collect();
        names.join(", ")
    };
    let mut text = format!(
        "variable_group {}; function {};",
        list('x', 0),
        list('f', 0)
    );
    for (i, support) in supports.iter().enumerate() {
        let terms: Vec<String> = support
            .iter()
            .map(|point| {
                let (a, b) = (random.below(199) as i64 - 99, 1 + random.below(99));
                let mut term = format!("({a} + {b}*I)/50");
                for (v, e) in point.iter().enumerate().filter(|(_, e)| **e > 0) {
                    let _ = write!(term, "*x{v}^{e}");
                }
                term
            })
            .collect();
        let _ = write!(text, " f{i} = {};", terms.join(" + "));
    }
    for seed in 1..=3 {
        let options = SolveOptions {
            method: SolveMethod::Polyhedral,
            seed,
            ..SolveOptions::default()
        };
        let (paths, sets) = solve(&written(&text), &options, &|_| None);
        let set = &sets[0];
        assert_eq!(
            (paths, set.paths.failed),
            (mixed_volume, 0),
            "{:?}",
            set.failed
        );
        assert_eq!(set.counts.nonsingular, mixed_volume, "seed {seed}");
        assert!(set.settled(), "{:?}", set.warnings);
    }
}
