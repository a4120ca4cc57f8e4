//! Designs: a linkage that was found, in all positions that were asked for, with its assessment.

use crate::assessment::Assessment;
use crate::linkage::{Linkage, Side};

/// A four-bar linkage of two dyads.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The dyads that it is made of, by their places in a list.
    pub dyads: [usize; 2],
    /// Positions of the linkage, one or more.
    pub positions: Vec<Linkage>,
    /// The largest change of a link's length between them, relative to the size of the task.
    pub error: f64,
    /// Assessment of the linkage.
    pub assessment: Assessment,
}

impl Design {
    /// Assesses positions of one linkage; `extent` is the size of the task. The side that serves better drives it, if
    /// none is named.
    ///
    /// # Panics
    /// When there is no position.
    pub fn new(
        dyads: [usize; 2],
        positions: Vec<Linkage>,
        extent: f64,
        driver: Option<Side>,
    ) -> Self {
        let first = positions[0].lengths().around();
        let change = |position: &Linkage| {
            let lengths = position.lengths().around();
            let pairs = lengths.iter().zip(first);
            pairs
                .map(|(length, first_length)| (length - first_length).abs())
                .fold(0.0, f64::max)
        };
        let assessment = Assessment::new(&positions);
        Self {
            dyads,
            error: positions.iter().map(change).fold(0.0, f64::max) / extent,
            assessment: match driver {
                Some(side) => assessment.driven_from(side),
                None => assessment,
            },
            positions,
        }
    }
}

/// Best first: by grade, then by quality.
pub fn ranked(mut designs: Vec<Design>) -> Vec<Design> {
    designs.sort_by(|one, two| one.assessment.order(&two.assessment));
    designs
}
