//! Loops in which paths jumped from one component to another: they are found by the parts that are closed without
//! them, and taken back.

use super::Split;
use crate::decomposition::classes::{Class, parts, places};
use crate::decomposition::moved::is_closed;
use cognate_continuation::bend::length;
use num_complex::Complex64;

/// Most parts of a class of which all unions are tried, to tell a false loop.
const MOST_PARTS: usize = 12;

/// Verdict on the loops that joined a closed class.
enum Loops {
    /// Without any of the loops no proper part of the class is closed.
    Sound,
    /// Without one of the loops the class falls into more parts than can be tried in all unions.
    Untested,
    /// Without this loop the class falls into these parts, some of which are closed together.
    Jumped {
        number: usize,
        parts: Vec<Vec<usize>>,
    },
    /// Without this permutation of a symmetry group the class falls into parts, some of which are closed together.
    Exchanged { permutation: usize },
}

impl Split {
    /// Takes back what loops did in which paths jumped from one component to another: classes that one loop brought
    /// together to a closed one, of which a proper part is closed without it. No proper part of a component is.
    pub(super) fn take_jumps_back(&mut self, variable_count: usize) {
        let mut k = 0;
        while k < self.classes.len() {
            let class = &self.classes[k];
            let loops = match class.closed {
                None => self.loops_of(class, variable_count),
                Some(_) => Loops::Sound,
            };
            let parts = match loops {
                Loops::Sound | Loops::Untested => {
                    k += 1;
                    continue;
                }
                Loops::Jumped { number, parts } => {
                    let inside = &self.classes[k].points;
                    self.edges[number].retain(|pair| !inside.contains(&pair[0]));
                    parts
                }
                Loops::Exchanged { permutation } => {
                    self.symmetry.take_back(permutation);
                    let edges = self.edges.iter().flatten().copied().collect();
                    let pairs = self.symmetry.with_images(edges, None);
                    let inside = &self.classes[k].points;
                    parts(inside, &places(inside), pairs.iter())
                }
            };
            self.classes.remove(k);
            self.broken += 1;
            let open = |points| Class {
                points,
                closed: None,
            };
            self.classes.extend(parts.into_iter().map(open));
            k = 0;
        }
    }

    /// Judges the loops that joined a class, if the class is closed.
    fn loops_of(&self, class: &Class, variable_count: usize) -> Loops {
        if class.points.len() < 2 || !is_closed(&self.trace(class.points.iter().copied())) {
            return Loops::Sound;
        }
        let place = places(&class.points);
        let pairs = |without: Option<usize>| -> Vec<[usize; 2]> {
            let edges = self.edges.iter().enumerate();
            let edges = edges.filter(|(other, _)| Some(*other) != without);
            edges.flat_map(|(_, edge)| edge).copied().collect()
        };
        let mut answer = Loops::Sound;
        for number in 0..self.edges.len() {
            let others = self.symmetry.with_images(pairs(Some(number)), None);
            let parts = parts(&class.points, &place, others.iter());
            match parts.len() {
                1 => {}
                many if many > MOST_PARTS => answer = Loops::Untested,
                _ if self.has_closed_part(&parts, variable_count) => {
                    return Loops::Jumped { number, parts };
                }
                _ => {}
            }
        }
        for permutation in 0..self.symmetry.count() {
            let others = self.symmetry.with_images(pairs(None), Some(permutation));
            let parts = parts(&class.points, &place, others.iter());
            match parts.len() {
                1 => {}
                many if many > MOST_PARTS => answer = Loops::Untested,
                _ if self.has_closed_part(&parts, variable_count) => {
                    return Loops::Exchanged { permutation };
                }
                _ => {}
            }
        }
        answer
    }

    /// Whether a proper union of these parts is closed.
    fn has_closed_part(&self, parts: &[Vec<usize>], variable_count: usize) -> bool {
        let sums: Vec<(Vec<Complex64>, f64)> = parts.iter().map(|part| self.rough(part)).collect();
        let closed = |mask: u32| {
            let members = (0..parts.len()).filter(|k| mask >> k & 1 == 1);
            let mut sum = vec![Complex64::default(); variable_count];
            let mut lengths = 0.0;
            for k in members.clone() {
                lengths += sums[k].1;
                for (sum, t) in sum.iter_mut().zip(&sums[k].0) {
                    *sum += t;
                }
            }
            let points = members.flat_map(|k| parts[k].iter().copied());
            length(&sum) <= 1e-10 * lengths && is_closed(&self.trace(points))
        };
        (1..(1u32 << parts.len()) - 1).any(closed)
    }

    /// Whether an open class is closed, and more loops must confirm that no loop that joined it jumped.
    pub(super) fn is_untested(&self, class: &Class, variable_count: usize) -> bool {
        class.closed.is_none() && matches!(self.loops_of(class, variable_count), Loops::Untested)
    }
}
