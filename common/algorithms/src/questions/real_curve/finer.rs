//! Finer: more samples of a real curve where an arc is farther from the lines between its points than it may be.

use super::traced::{End, Task, Tracing};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Values nearer than this, relative to them, are not told apart: no sample goes between.
const SAME_VALUE: f64 = 1e-12;

/// Points of a slab's real arcs at one value of the form.
struct Row {
    value: f64,
    /// Whether arcs may turn there: a level.
    at_level: bool,
    /// A point of each arc, where one came.
    points: Vec<Option<Vec<Complex64>>>,
}

/// Samples that halve the pieces of arcs that are too coarse; none where all are fine. `seen`: a point in the
/// variables.
pub(super) fn finer_samples(
    tracing: &Tracing,
    tolerance: f64,
    seen: &dyn Fn(&[Complex64]) -> Vec<Complex64>,
) -> Vec<Task> {
    let slabs = (0..tracing.middles.len()).flat_map(|slab| {
        let rows = rows(tracing, slab, seen);
        let arcs = rows.first().map_or(0, |row| row.points.len());
        let mut coarse = vec![false; rows.len().saturating_sub(1)];
        for arc in 0..arcs {
            mark(&rows, arc, tolerance, &mut coarse);
        }
        let pieces = rows.windows(2).zip(coarse).filter(|(_, coarse)| *coarse);
        let tasks = pieces.filter_map(|(pair, _)| {
            Some(Task {
                slab,
                to: between(&pair[0], &pair[1])?,
                level: None,
                needed: true,
            })
        });
        tasks.collect::<Vec<Task>>()
    });
    slabs.collect()
}

/// Values at which points of the arcs are known, ascending.
fn rows(tracing: &Tracing, slab: usize, seen: &dyn Fn(&[Complex64]) -> Vec<Complex64>) -> Vec<Row> {
    let fibre = &tracing.fibres[slab];
    let real: Vec<usize> = (0..fibre.len()).filter(|&k| fibre[k].wanted).collect();
    if real.is_empty() {
        return Vec::new();
    }
    let mut rows = BTreeMap::new();
    let key = |value: f64| {
        // Orders doubles as they are ordered.
        let bits = value.to_bits();
        bits ^ if bits >> 63 == 1 { u64::MAX } else { 1 << 63 }
    };
    let middle = Row {
        value: tracing.middles[slab],
        at_level: false,
        points: real.iter().map(|&k| Some(seen(&fibre[k].point))).collect(),
    };
    rows.insert(key(middle.value), middle);
    let tasks = tracing.tasks.iter().zip(&tracing.ends);
    for (task, ends) in tasks.filter(|(task, _)| task.slab == slab) {
        let at_level = task.level.is_some();
        let end = |k: usize| match ends.get(k) {
            Some(Some(End::At { point, .. })) => Some(seen(point)),
            _ => None,
        };
        // All points of a fibre go to levels, and wanted ones to samples.
        let points = match at_level {
            true => real.iter().map(|&k| end(k)).collect(),
            false => (0..real.len()).map(end).collect(),
        };
        let row = Row {
            value: task.to,
            at_level,
            points,
        };
        rows.insert(key(task.to), row);
    }
    rows.into_values().collect()
}

/// Marks the pieces of an arc whose middle is farther from its line than the tolerance: by the distance of a point from
/// the line between its neighbours, which grows with the product of the two lengths where the bend is the same.
fn mark(rows: &[Row], arc: usize, tolerance: f64, coarse: &mut [bool]) {
    for (k, three) in rows.windows(3).enumerate() {
        let points = [0, 1, 2].map(|i| three[i].points[arc].as_ref());
        let [Some(a), Some(b), Some(c)] = points else {
            continue;
        };
        let (off, lengths) = (from_line(a, b, c), [apart(a, b), apart(b, c)]);
        for (i, piece) in [k, k + 1].into_iter().enumerate() {
            let [length, other] = [lengths[i], lengths[1 - i]];
            // Where one is much shorter, a bend that is the same says too much.
            let part = (length / other.max(f64::MIN_POSITIVE)).min(4.0) / 4.0;
            coarse[piece] |= off * part > tolerance;
        }
    }
}

/// A value between two: near a level, where arcs may turn like a root, a quarter of the way to it.
fn between(low: &Row, high: &Row) -> Option<f64> {
    let part = match (low.at_level, high.at_level) {
        (true, false) => 0.25,
        (false, true) => 0.75,
        _ => 0.5,
    };
    let value = low.value + part * (high.value - low.value);
    let gap = SAME_VALUE * low.value.abs().max(high.value.abs());
    (value - low.value > gap && high.value - value > gap).then_some(value)
}

fn apart(a: &[Complex64], b: &[Complex64]) -> f64 {
    let squares = a.iter().zip(b).map(|(x, y)| (x - y).norm_sqr());
    squares.sum::<f64>().sqrt()
}

/// Distance of b from the line through a and c.
fn from_line(a: &[Complex64], b: &[Complex64], c: &[Complex64]) -> f64 {
    let length = apart(a, c);
    if length == 0.0 {
        return apart(a, b);
    }
    // Real and imaginary parts are coordinates.
    let dot = |x: Complex64, y: Complex64| x.re * y.re + x.im * y.im;
    let along: f64 = (0..a.len()).map(|k| dot(b[k] - a[k], c[k] - a[k])).sum();
    let part = along / (length * length);
    let foot: Vec<Complex64> = (0..a.len()).map(|k| a[k] + (c[k] - a[k]) * part).collect();
    apart(b, &foot)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(value: f64, at_level: bool, point: [f64; 2]) -> Row {
        let point = point.map(|x| Complex64::new(x, 0.0)).to_vec();
        Row {
            value,
            at_level,
            points: vec![Some(point)],
        }
    }

    #[test]
    fn pieces_that_bend_are_coarse_and_straight_ones_are_not() {
        // y = x^2 for x > 0, straight before.
        let at = |x: f64| row(x, false, [x, if x > 0.0 { x * x } else { 0.0 }]);
        let rows: Vec<Row> = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0].map(at).into();
        let marked = |tolerance: f64| {
            let mut coarse = vec![false; 5];
            mark(&rows, 0, tolerance, &mut coarse);
            coarse
        };
        assert_eq!(marked(0.05), [false, false, true, true, true]);
        assert_eq!(marked(1.0), [false; 5]);
    }

    #[test]
    fn levels_are_come_near_by_quarters_until_doubles_end() {
        let point = [0.0, 0.0];
        let level = row(1.0, true, point);
        let between = |value: f64| between(&level, &row(value, false, point));
        assert_eq!(between(2.0), Some(1.25));
        assert_eq!(between(1.0 + 1e-13), None);
    }
}
