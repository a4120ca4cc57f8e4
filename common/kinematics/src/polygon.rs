//! A closed chain of links in the plane, joined by revolute joints: connected parts of its positions, by the lengths alone.
//!
//! Kapovich and Millson, On the moduli space of polygons in the Euclidean plane, Journal of Differential Geometry 42
//! (1995).

use crate::mechanism::{Body, Framework, JointKind, Linkage, Mechanism, Space};

/// Lengths that differ by less than this part of the perimeter count as equal.
const EQUAL: f64 = 1e-9;
/// Chains of more links are not asked: each choice of signs is looked at.
const MOST_LINKS: usize = 16;

/// Number of connected parts that the real positions of a closed planar chain of revolute joints form, those of the mirrored
/// chain included; `None` for other mechanisms, and where the chain can lie on a line.
pub fn connected_parts(mechanism: &Mechanism) -> Option<u64> {
    let lengths = match &mechanism.body {
        Body::Linkage(linkage) if mechanism.space == Space::Planar => of_linkage(linkage),
        Body::Framework(framework) => of_framework(framework),
        _ => None,
    };
    parts_of_polygon(lengths?)
}

/// Number of connected parts of the polygons with sides of these lengths, one of which stands still.
fn parts_of_polygon(mut lengths: Vec<f64>) -> Option<u64> {
    let count = lengths.len();
    if !(3..=MOST_LINKS).contains(&count) {
        return None;
    }
    lengths.sort_by(|a, b| b.total_cmp(a));
    let perimeter: f64 = lengths.iter().sum();
    let signed_sum = |signs: u32| -> f64 {
        let lengths = lengths.iter().enumerate();
        lengths
            .map(|(k, length)| {
                if signs >> k & 1 == 0 {
                    *length
                } else {
                    -length
                }
            })
            .sum()
    };
    let is_straight = |signs: u32| signed_sum(signs).abs() <= EQUAL * perimeter;
    if !perimeter.is_finite() || (0..1 << (count - 1)).any(is_straight) {
        return None;
    }
    let half = perimeter / 2.0;
    Some(match lengths[..] {
        [first, ..] if first > half => 0,
        // Of three links any two are longer than all others together: they keep their orientation.
        [_, second, third, ..] if second + third > half => 2,
        _ => 1,
    })
}

/// Distances of the two joints of each link; `None` where the links form no single chain of revolute joints.
fn of_linkage(linkage: &Linkage) -> Option<Vec<f64>> {
    let mut ends: Vec<Vec<[f64; 2]>> = vec![Vec::new(); linkage.links.len()];
    for joint in &linkage.joints {
        if joint.kind != JointKind::R {
            return None;
        }
        for (link, side) in joint.links.into_iter().zip(&joint.sides) {
            ends[link].push([side.point[0].to_f64(), side.point[1].to_f64()]);
        }
    }
    let edges: Vec<[usize; 2]> = linkage.joints.iter().map(|joint| joint.links).collect();
    if !is_cycle(&edges, linkage.links.len()) {
        return None;
    }
    let length = |ends: Vec<[f64; 2]>| {
        let [x, y] = [0, 1].map(|k| ends[0][k] - ends[1][k]);
        (x * x + y * y).sqrt()
    };
    Some(ends.into_iter().map(length).collect())
}

/// Lengths of the bars; `None` where they form no single chain.
fn of_framework(framework: &Framework) -> Option<Vec<f64>> {
    let edges: Vec<[usize; 2]> = framework.bars.iter().map(|bar| bar.between).collect();
    let lengths = framework.bars.iter().map(|bar| bar.length.to_f64());
    let stands = framework.bars.iter().any(|bar| framework.is_fixed(bar));
    (stands && is_cycle(&edges, framework.points.len())).then(|| lengths.collect())
}

/// Whether edges between so many vertices form one cycle through all of them.
fn is_cycle(edges: &[[usize; 2]], vertices: usize) -> bool {
    let at = |vertex: usize| edges.iter().filter(move |edge| edge.contains(&vertex));
    if edges.len() != vertices || (0..vertices).any(|vertex| at(vertex).count() != 2) {
        return false;
    }
    let mut is_reached = vec![false; vertices];
    let mut open = vec![0];
    while let Some(vertex) = open.pop() {
        if !std::mem::replace(&mut is_reached[vertex], true) {
            open.extend(at(vertex).flatten());
        }
    }
    is_reached.into_iter().all(|is_reached| is_reached)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pentagons: the regular one is connected; one with three long sides is two tori; one side longer than all others.
    #[test]
    fn parts_of_pentagons() {
        let parts = |lengths: &[f64]| parts_of_polygon(lengths.to_vec());
        assert_eq!(parts(&[1.0; 5]), Some(1));
        assert_eq!(parts(&[4.0, 4.0, 4.0, 1.0, 1.5]), Some(2));
        assert_eq!(parts(&[10.0, 2.0, 2.0, 2.0, 2.0]), Some(0));
        // Four-bars: Grashof's condition (1883) tells two circuits from one.
        assert_eq!(parts(&[2.0, 5.0, 4.0, 4.5]), Some(2));
        assert_eq!(parts(&[3.0, 5.0, 2.5, 2.9]), Some(1));
        // A parallelogram can lie on a line.
        assert_eq!(parts(&[2.0, 5.0, 2.0, 5.0]), None);
    }

    #[test]
    fn cycles() {
        assert!(is_cycle(&[[0, 1], [2, 1], [0, 2]], 3));
        assert!(!is_cycle(&[[0, 1], [1, 2], [2, 0], [2, 0]], 4));
        let two_triangles = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3]];
        assert!(!is_cycle(&two_triangles, 6));
        assert!(!is_cycle(&[[0, 0]], 1));
    }
}
