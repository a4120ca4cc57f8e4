//! Reach: the edges of the code that inputs have taken so far, and about how often.

use crate::coverage;

/// A bit for each order of magnitude of how often an edge was taken by one input.
#[derive(Debug, Default)]
pub struct Reach {
    seen: Vec<u8>,
    edges: usize,
}

impl Reach {
    /// Whether the input since the last call took an edge that none before it took as often.
    pub fn is_new(&mut self) -> bool {
        let mut new = false;
        coverage::take(|edge, count| {
            if edge >= self.seen.len() {
                self.seen.resize(edge + 1, 0);
            }
            let often = 1 << count.ilog2();
            self.edges += usize::from(self.seen[edge] == 0);
            new |= self.seen[edge] & often == 0;
            self.seen[edge] |= often;
        });
        new
    }

    /// How far, in words; nothing where edges are not counted.
    pub fn words(&self) -> String {
        match self.edges {
            0 => String::new(),
            edges => format!(", {edges} edges"),
        }
    }
}
