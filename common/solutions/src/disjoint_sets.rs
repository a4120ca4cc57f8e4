//! Disjoint sets of the numbers below a count, which only ever grow together.

/// A partition of numbers into sets.
#[derive(Clone, Debug)]
pub struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    /// A partition in which each number is a set by itself.
    pub fn new(count: usize) -> Self {
        Self {
            parent: (0..count).collect(),
        }
    }

    /// The smallest member of the set of a member.
    pub fn root(&mut self, mut member: usize) -> usize {
        while self.parent[member] != member {
            self.parent[member] = self.parent[self.parent[member]];
            member = self.parent[member];
        }
        member
    }

    /// Joins the sets of two members; false where they were one. The smallest member is the root, so that roots do not
    /// depend on the order of joining.
    pub fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
        a != b
    }

    /// All sets, by their smallest members, each ascending.
    pub fn clusters(mut self) -> Vec<Vec<usize>> {
        let mut place = vec![usize::MAX; self.parent.len()];
        let mut clusters: Vec<Vec<usize>> = Vec::new();
        for member in 0..self.parent.len() {
            let root = self.root(member);
            if place[root] == usize::MAX {
                place[root] = clusters.len();
                clusters.push(Vec::new());
            }
            clusters[place[root]].push(member);
        }
        clusters
    }
}
