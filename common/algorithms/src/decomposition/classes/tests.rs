//! Classes of points whose second derivatives are made up: closed unions, points that are missing, and paths that jump.

use super::*;
use crate::decomposition::moved::misses_points;
use crate::decomposition::symmetry::WAYS;
use cognate_continuation::bend::{Bend, exactly};
use cognate_numeric::random::{Purpose, RandomStream};

/// Second derivatives of points in one variable.
fn second_derivatives(values: &[Complex64]) -> MovedPoints {
    let mut moved = MovedPoints::with_capacity(values.len(), 1);
    for &z in values {
        moved.push(Some(&Bend {
            velocity: vec![exactly(Complex64::new(1.0, 0.0))],
            acceleration: vec![exactly(z)],
            error: 1e-28,
        }));
    }
    moved
}

/// Points with these second derivatives, each a class.
fn single_points(values: &[Complex64]) -> Classes {
    let mut classes = Classes::of_single_points(values.len());
    classes.add_second_derivatives(second_derivatives(values));
    classes
}

/// Two components of `degree` points each, whose second derivatives sum to 0.
fn two_components(degree: usize) -> Classes {
    let mut random = RandomStream::new(5, Purpose::Test, 1);
    let mut values = Vec::new();
    for _ in 0..2 {
        let mut sum = Complex64::default();
        for k in 0..degree {
            // Few bits: the sum is exact.
            let part = |random: &mut RandomStream| random.below(1 << 20) as f64 / 1024.0 - 512.0;
            let z = Complex64::new(part(&mut random), part(&mut random));
            let z = if k + 1 == degree { -sum } else { z };
            sum += z;
            values.push(z);
        }
    }
    single_points(&values)
}

/// Numbers of the points of each of two components.
fn component_points(degree: usize) -> [Vec<usize>; 2] {
    [(0..degree).collect(), (degree..2 * degree).collect()]
}

/// A loop in which the points of each component go `by` places around among themselves.
fn around(degree: usize, by: usize) -> Vec<usize> {
    let mut images: Vec<usize> = (0..2 * degree).collect();
    images[..degree].rotate_left(by);
    images[degree..].rotate_left(by);
    images
}

/// A loop after which the point at each place is where it says.
fn go_around(classes: &mut Classes, images: &[usize]) {
    let sources: Vec<usize> = (0..images.len()).collect();
    classes.join_by_loop(&sources, images);
    classes.close();
}

/// Points of closed classes, ascending.
fn closed(classes: &Classes) -> Vec<Vec<usize>> {
    let closed = classes.classes.iter().filter(|c| c.closed.is_some());
    let mut closed: Vec<Vec<usize>> = closed
        .map(|class| {
            let mut points = class.points.clone();
            points.sort_unstable();
            points
        })
        .collect();
    closed.sort();
    closed
}

fn real(x: f64) -> Complex64 {
    Complex64::new(x, 0.0)
}

#[test]
fn smallest_unions_with_the_sum_0_are_components() {
    let i = Complex64::new(0.0, 1.0);
    // Two pairs, and a point that is a line.
    let mut classes = single_points(&[real(1.0), 2.0 * i, real(-1.0), real(0.0), -2.0 * i]);
    classes.close();
    assert_eq!(closed(&classes), [vec![0, 2], vec![1, 4], vec![3]]);
    assert!(!classes.may_be_joined() && classes.open_points().is_empty());
    // 1 + 2i, relative to the lengths of both second derivatives and of both velocities.
    let smallest_wrong = classes.smallest_wrong().unwrap();
    assert!((smallest_wrong - 5f64.sqrt() / 5.0).abs() < 1e-15);
}

#[test]
fn many_classes_wait_for_loops() {
    const DEGREE: usize = 20;
    let mut classes = two_components(DEGREE);
    classes.close();
    assert!(closed(&classes).is_empty() && classes.may_be_joined());
    // Two loops join all points of each component: one confirms the other.
    go_around(&mut classes, &around(DEGREE, 1));
    go_around(&mut classes, &around(DEGREE, 3));
    assert_eq!(closed(&classes), component_points(DEGREE));
    assert!(!classes.may_be_joined());
}

#[test]
fn a_point_that_was_missing_closes_a_class() {
    let mut classes = single_points(&[real(1.0), real(3.0), real(-1.0)]);
    classes.symmetry.take(Some(vec![2, 1, 0]));
    classes.close();
    assert_eq!(closed(&classes), [[0, 2]]);
    assert!(misses_points(&classes.open_trace()));
    // The images of a new point are not known.
    classes.add_points(3..4);
    assert!(!classes.symmetry.are_known());
    classes.add_second_derivatives(second_derivatives(&[real(-3.0)]));
    assert!(is_closed(&classes.open_trace()));
    classes.close();
    assert_eq!(closed(&classes), [[0, 2], [1, 3]]);
}

#[test]
fn a_loop_in_which_two_paths_jumped_is_taken_back() {
    const DEGREE: usize = 40;
    let components = component_points(DEGREE);
    let around = around(DEGREE, 1);
    let point_indices: Vec<usize> = (0..2 * DEGREE).collect();
    // Loops in groups of four points, so that there are more classes than unions that can be tried.
    let mut fours: Vec<usize> = point_indices.clone();
    fours.chunks_mut(4).for_each(|four| four.rotate_left(1));
    let mut classes = two_components(DEGREE);
    go_around(&mut classes, &around);
    // One loop alone has nothing beside it that says that it did not jump.
    assert!(closed(&classes).is_empty() && classes.may_be_joined());
    go_around(&mut classes, &around);
    assert_eq!(closed(&classes), components);
    // Ends of two paths are exchanged, in the first loop and in the second.
    let jumped = |images: &[usize]| {
        let mut images = images.to_vec();
        images.swap(3, DEGREE + 4);
        images
    };
    let mut classes = two_components(DEGREE);
    go_around(&mut classes, &jumped(&point_indices));
    go_around(&mut classes, &around);
    go_around(&mut classes, &around);
    let expected = (components.to_vec(), 1);
    assert_eq!((closed(&classes), classes.taken_back()), expected);
    let mut classes = two_components(DEGREE);
    go_around(&mut classes, &fours);
    go_around(&mut classes, &jumped(&around));
    // No loop says yet that the second one is wrong: nothing is closed before one does.
    assert!(closed(&classes).is_empty());
    go_around(&mut classes, &around);
    assert_eq!((closed(&classes), classes.taken_back()), expected);
}

/// Two components that a symmetry exchanges; by one of two ways two of its paths exchanged their ends.
#[test]
fn an_image_to_which_a_path_jumped_brings_nothing_together() {
    const DEGREE: usize = 40;
    let exchanged: Vec<usize> = (0..2 * DEGREE)
        .map(|k| (k + DEGREE) % (2 * DEGREE))
        .collect();
    let around = around(DEGREE, 1);
    for jumps in [false, true] {
        let mut classes = two_components(DEGREE);
        for way in 0..WAYS {
            let mut images = exchanged.clone();
            if jumps && way == 1 {
                images.swap(3, DEGREE + 7);
            }
            classes.symmetry.take(Some(images));
        }
        // Points of one component stand for all.
        for _ in 0..3 {
            let sources = classes.symmetry.least_of_each(&classes.open_points());
            let images: Vec<usize> = sources.iter().map(|&k| around[k]).collect();
            classes.join_by_loop(&sources, &images);
            classes.close();
        }
        assert_eq!(closed(&classes), component_points(DEGREE), "jumps: {jumps}");
        assert_eq!(classes.symmetry.refused(), u64::from(jumps));
    }
}
