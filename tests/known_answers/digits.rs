//! Digits that are shown are right: products of lines, whose solutions are rational, against the exact points.
//!
//! `COGNATE_DIGITS=10000` asks for as many points. No coordinate is further from the exact one than one unit in the last place
//! of the point's largest coordinate, nor than `accuracy` says; a real solution has no imaginary part.

use cognate_algorithms::SolveOptions;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_solutions::solution::Solution;
use cognate_systems::formats;
use cognate_tests::planted::lines::lines;
use cognate_tests::planted::verdict::solve_within;
use std::collections::BTreeMap;
use std::time::Duration;

/// Points where no other number is asked for.
const SAMPLE: usize = 500;
const LIMIT: Duration = Duration::from_secs(60);

/// How far a solution is from the exact point.
struct Deviation {
    /// Deviation in units in the last place of the largest coordinate.
    in_units: f64,
    /// Deviation in units of the solution's `accuracy`.
    in_accuracies: f64,
    /// Real and imaginary parts that are not the exact ones rounded.
    not_rounded: u64,
    parts: u64,
    /// A real solution with an imaginary part.
    not_real: bool,
}

/// The gap between a double of this size and the next.
fn unit_in_the_last_place(size: f64) -> f64 {
    let size = size.max(f64::MIN_POSITIVE);
    f64::from_bits(size.to_bits() + 1) - size
}

fn rational(value: f64) -> Rational {
    Rational::from_f64(value).expect("a solution has finite coordinates")
}

fn parts(z: &ComplexRational) -> [Rational; 2] {
    [z.re.clone(), z.im.clone()]
}

fn deviation(solution: &Solution, exact: &[ComplexRational]) -> Deviation {
    let (mut farthest, mut largest) = (Rational::new(), Rational::new());
    let (mut not_rounded, mut count, mut imaginary) = (0, 0, false);
    for (value, exact) in solution.variables.values().zip(exact) {
        imaginary |= value.im != 0.0;
        for (part, exact) in [value.re, value.im].into_iter().zip(parts(exact)) {
            let apart = Rational::from(&rational(part) - &exact).abs();
            // Rational::to_f64 cuts; the nearest double is at most half a unit away.
            let half = rational(unit_in_the_last_place(exact.to_f64().abs())) / 2;
            let rounded = if exact == 0 {
                apart == 0
            } else {
                apart <= half
            };
            not_rounded += u64::from(!rounded);
            count += 1;
            farthest = farthest.max(apart);
            largest = largest.max(exact.abs());
        }
    }
    let apart = farthest.to_f64();
    // The point 0 is measured in units of 1.
    let size = if largest == 0 { 1.0 } else { largest.to_f64() };
    Deviation {
        in_units: apart / unit_in_the_last_place(size),
        in_accuracies: apart / size / solution.accuracy,
        not_rounded,
        parts: count,
        not_real: exact.iter().all(ComplexRational::is_real) && imaginary,
    }
}

fn distance(solution: &Solution, exact: &[ComplexRational]) -> f64 {
    let both = solution.variables.values().zip(exact);
    both.map(|(z, exact)| (z.re - exact.re.to_f64()).abs() + (z.im - exact.im.to_f64()).abs())
        .fold(0.0, f64::max)
}

/// The value that this part of the sorted values does not exceed.
fn quantile(values: &[f64], part: f64) -> f64 {
    let place = (part * (values.len() - 1) as f64).round() as usize;
    values[place]
}

#[test]
fn solutions_are_rounded_once() {
    let asked = std::env::var("COGNATE_DIGITS").ok();
    let count = asked.and_then(|n| n.parse().ok()).unwrap_or(SAMPLE);
    let mut deviations: BTreeMap<&str, Vec<Deviation>> = BTreeMap::new();
    let mut wrong = Vec::new();
    let mut points = 0;
    let mut number = 0;
    while points < count {
        let planted = lines(1, number);
        number += 1;
        points += planted.roots.len();
        let file = planted.file("");
        let system = formats::read("lines", file.as_bytes());
        let system = system.expect("products of lines are read").system;
        let options = SolveOptions {
            seed: number,
            ..SolveOptions::default()
        };
        let set = match solve_within(&system, &options, LIMIT) {
            Ok(set) => set,
            Err(verdict) => panic!("{number}: {verdict:?}\n{file}"),
        };
        assert_eq!(set.solutions.len(), planted.roots.len(), "{number}\n{file}");
        for solution in &set.solutions {
            let nearest = planted.roots.iter().min_by(|a, b| {
                distance(solution, &a.point).total_cmp(&distance(solution, &b.point))
            });
            let exact = &nearest.expect("there are solutions").point;
            let deviation = deviation(solution, exact);
            if deviation.in_units > 1.0 || deviation.in_accuracies > 1.0 || deviation.not_real {
                let Deviation {
                    in_units,
                    in_accuracies,
                    not_real,
                    ..
                } = deviation;
                wrong.push(format!(
                    "{number}: {in_units} units, {in_accuracies} of the accuracy, not real: {not_real}; \
                     condition {:e}, {} bits: {:?}",
                    solution.condition, solution.precision_bits, solution.variables
                ));
            }
            deviations.entry(planted.kind).or_default().push(deviation);
        }
    }
    for (kind, deviations) in &deviations {
        let sorted = |figure: fn(&Deviation) -> f64| {
            let mut values: Vec<f64> = deviations.iter().map(figure).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let units = sorted(|d| d.in_units);
        let accuracies = sorted(|d| d.in_accuracies);
        let sum = |figure: fn(&Deviation) -> u64| deviations.iter().map(figure).sum::<u64>();
        println!(
            "{kind}: {} points; units: median {:.3}, 90 % {:.3}, most {:.3}; beyond 1 unit {}; of the accuracy at most \
             {:.3}, beyond {}; parts not rounded to nearest {} of {}; real with an imaginary part {}",
            deviations.len(),
            quantile(&units, 0.5),
            quantile(&units, 0.9),
            quantile(&units, 1.0),
            units.iter().filter(|u| **u > 1.0).count(),
            quantile(&accuracies, 1.0),
            accuracies.iter().filter(|a| **a > 1.0).count(),
            sum(|d| d.not_rounded),
            sum(|d| d.parts),
            sum(|d| u64::from(d.not_real)),
        );
    }
    assert!(
        wrong.is_empty(),
        "{} points: {}",
        wrong.len(),
        wrong.join("\n")
    );
}
