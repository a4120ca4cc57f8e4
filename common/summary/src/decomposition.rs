//! DecompositionSummary: what a finished decomposition is in one JSON object, field by field as the contract
//! has it.

use super::about::{About, TimeBlock, WorkerBlock};
use super::family::FamilyBlock;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{
    Decomposition, Dimension, Doubt, Irreducible, Proof, RemovedComponent, TrackedPaths,
    Verification, WitnessSet,
};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// More components of one dimension than these stand together, those that are alike.
const MOST_LISTED: usize = 1000;

/// A finished decomposition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecompositionSummary {
    /// Id of the job.
    pub job: String,
    /// The system, the method and the seed.
    pub problem: DecomposedProblem,
    /// Components and dimensions.
    pub decomposition: DecompositionBlock,
    /// Paths to the witness points, and those of loops.
    pub paths: PathBlock,
    /// Wall time and CPU time.
    pub time: TimeBlock,
    /// Workers and the number of items that each did.
    pub workers: Vec<WorkerBlock>,
    /// True when every claim is settled.
    pub settled: bool,
    /// Warnings for the user, one sentence each.
    pub warnings: Vec<String>,
}

/// The problem that was decomposed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DecomposedProblem {
    /// Name of the problem, usually that of its file.
    pub name: String,
    /// Digest of the system.
    pub digest: String,
    /// Number of variables.
    pub variables: u64,
    /// Number of equations.
    pub equations: u64,
    /// Method that found the witness superset: `equations`, `cascade` or `slices`.
    pub method: String,
    /// Seed of everything random.
    pub seed: u64,
}

/// Paths that were tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathBlock {
    /// Paths to the witness points, and those that ask whether a point is on a set of higher dimension.
    #[serde(flatten)]
    pub superset: TrackedPaths,
    /// Paths along loops of the slices.
    pub loops: TrackedPaths,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecompositionBlock {
    /// Whether every claim is settled.
    pub settled: bool,
    /// Lowest and highest dimension that were asked.
    pub asked: [u32; 2],
    /// The components: by dimension, degree and multiplicity, largest first. More than 1000 of one dimension stand
    /// together where they are alike.
    pub components: Vec<ComponentBlock>,
    /// The dimensions that were asked.
    pub by_dimension: BTreeMap<u32, DimensionBlock>,
    /// Components inside others, of which only multiplicities tell: `not searched`.
    pub embedded: String,
    /// Result of a second method; `null` if none was asked for.
    pub verification: Option<Verification>,
    /// Reasons why the answer is not settled, in words; empty if it is.
    pub unsettled: Vec<String>,
    /// Fate of the components of a general member of the family; `null` if none were known.
    #[serde(default)]
    pub family: Option<FamilyBlock>,
    /// Components that were taken away from the answer, by the reason; in no other count.
    #[serde(default)]
    pub removed: BTreeMap<String, Vec<RemovedBlock>>,
}

/// Components of one dimension and degree that were taken away.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemovedBlock {
    /// The dimension of the components.
    pub dimension: u32,
    /// Degree of each component.
    pub degree: u64,
    /// Number of removed components.
    pub count: u64,
}

/// A component, or many that are alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComponentBlock {
    /// Name of the component, such as `1.3`; of an entry for several components, the name of the first.
    pub id: String,
    /// Dimension; projective in homogeneous groups.
    pub dimension: u32,
    /// Degree.
    pub degree: u64,
    /// Number of components that the entry stands for.
    pub count: u64,
    /// Multiplicity as a scheme; `null` where it is not known.
    pub multiplicity: Option<u64>,
    /// Number of paths that came to each witness point.
    pub tracked_multiplicity: u64,
    /// Whether the component is irreducible.
    pub irreducible: Irreducible,
    /// Rank of the Jacobian before each deflation; empty where the equations are regular.
    pub deflation: Vec<u32>,
    /// Degrees by groups of variables; not computed yet.
    pub multidegree: Option<Vec<(Vec<u32>, u64)>>,
    /// Whether the component is its own complex conjugate; `null` if that means nothing or was not found out.
    pub self_conjugate: Option<bool>,
    /// Orbit of the component under the symmetry group, by number in its dimension; `null` if no group was named, if
    /// the orbit was not found, or if the entry stands for several components.
    #[serde(default)]
    pub orbit: Option<u32>,
    /// Witness points that are proved; `null` where no proof was asked for.
    pub certified: Option<u64>,
    /// Evidence for the claims about the component.
    pub evidence: EvidenceBlock,
}

/// Evidence for the claims about a component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EvidenceBlock {
    /// Sum of the second derivatives of the witness points over the sum of their lengths; `null` for a point.
    pub trace_deviation: Option<f64>,
    /// Bound of the trace deviation that rounding errors alone explain.
    pub noise: Option<f64>,
    /// Smallest trace deviation of points that are no component; `null` if none was tried.
    pub smallest_wrong_union: Option<f64>,
    /// Loops that were made.
    pub loops: u32,
    /// Precision of the derivatives, in bits; `null` for a point.
    pub precision_bits: Option<u32>,
    /// Least gap between singular values that were taken as not 0 and as 0.
    pub rank_gap: Option<f64>,
    /// Largest condition number of the witness points.
    pub worst_condition: Option<f64>,
    /// Facts that are proved; `null` if no proof was asked for.
    #[serde(default)]
    pub proof: Option<Proof>,
    /// Reasons why this part of the answer is not settled.
    pub doubts: Vec<Doubt>,
}

/// Counts of the paths to one dimension.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DimensionBlock {
    /// Number of components.
    pub components: u64,
    /// Sum of the degrees of the components.
    pub degree: u64,
    /// Paths that ended at solutions.
    pub superset: u64,
    /// Paths that ended at solutions on sets of higher dimension, counted in `superset`.
    pub junk: u64,
    /// Paths that ended at solutions on components that were removed, counted in `superset`.
    #[serde(default)]
    pub removed: u64,
    /// Paths that ended at solutions of combinations of the equations alone.
    pub excess: u64,
    /// Paths that failed on the way.
    pub failed: u64,
    /// Paths that must have been lost, by witness points that loops found and to which none came.
    #[serde(default)]
    pub found_by_loops: u64,
    /// Orbits of the components under the symmetry group; `null` if no group was named, or the orbits were not found.
    #[serde(default)]
    pub orbits: Option<u64>,
    /// Whether all components of this dimension are found.
    pub complete: Completeness,
    /// Reasons why this part of the answer is not settled.
    pub doubts: Vec<Doubt>,
}

impl DecompositionBlock {
    /// The answer as the contract has it.
    pub fn new(decomposition: &Decomposition) -> Self {
        let mut unsettled = Vec::new();
        for dimension in &decomposition.dimensions {
            let said = dimension.doubts.iter();
            unsettled.extend(said.map(|doubt| format!("dimension {}: {doubt}", dimension.number)));
        }
        for set in &decomposition.components {
            let said = set.evidence.doubts.iter();
            unsettled.extend(said.map(|doubt| format!("component {}: {doubt}", set.id)));
        }
        let settled = decomposition.settled();
        if !settled && unsettled.is_empty() {
            unsettled.push("whether all components are found is not known".into());
        }
        Self {
            settled,
            asked: decomposition.asked,
            components: components(&decomposition.components),
            by_dimension: decomposition
                .dimensions
                .iter()
                .map(|dimension| {
                    (
                        dimension.number,
                        block(dimension, &decomposition.components),
                    )
                })
                .collect(),
            embedded: "not searched".into(),
            verification: decomposition.verification.clone(),
            family: decomposition.family.as_ref().map(FamilyBlock::new),
            removed: removed(&decomposition.removed),
            unsettled,
        }
    }
}

/// A JSON number, where it is one.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn components(sets: &[WitnessSet]) -> Vec<ComponentBlock> {
    let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
    for set in sets {
        *counts.entry(set.dimension()).or_default() += 1;
    }
    let mut blocks: Vec<ComponentBlock> = Vec::new();
    for set in sets {
        let block = component(set);
        let many = counts[&set.dimension()] > MOST_LISTED;
        match blocks
            .iter_mut()
            .find(|similar_block| many && similar_block.is_like(&block))
        {
            Some(similar_block) => similar_block.add(block),
            None => blocks.push(block),
        }
    }
    blocks
}

impl ComponentBlock {
    /// Whether the two can stand together.
    fn is_like(&self, other: &Self) -> bool {
        let kind = |b: &Self| {
            let multiplicity = (b.multiplicity, b.tracked_multiplicity);
            (
                b.dimension,
                b.degree,
                multiplicity,
                b.irreducible,
                b.self_conjugate,
            )
        };
        kind(self) == kind(other)
            && self.deflation == other.deflation
            && self.evidence.doubts == other.evidence.doubts
    }

    /// Takes another that is like it: of the evidence what is worst.
    fn add(&mut self, other: Self) {
        self.count += other.count;
        self.orbit = self.orbit.filter(|_| self.orbit == other.orbit);
        let (a, b) = (&mut self.evidence, other.evidence);
        // Where one is not known the worst is not, either.
        let worst = |x: Option<f64>, y: Option<f64>| x.zip(y).map(|(x, y)| x.max(y));
        let least = |x: Option<f64>, y: Option<f64>| x.zip(y).map(|(x, y)| x.min(y));
        a.trace_deviation = worst(a.trace_deviation, b.trace_deviation);
        a.noise = worst(a.noise, b.noise);
        a.smallest_wrong_union = least(a.smallest_wrong_union, b.smallest_wrong_union);
        a.rank_gap = least(a.rank_gap, b.rank_gap);
        a.worst_condition = worst(a.worst_condition, b.worst_condition);
        if let (Some(total_proof), Some(other)) = (&mut a.proof, b.proof) {
            total_proof.add(&other);
        }
        self.certified = a.proof.map(|proof| proof.points);
    }
}

fn removed(components: &[RemovedComponent]) -> BTreeMap<String, Vec<RemovedBlock>> {
    let mut by_reason: BTreeMap<String, Vec<RemovedBlock>> = BTreeMap::new();
    for &RemovedComponent {
        ref reason,
        dimension,
        degree,
    } in components
    {
        let blocks = by_reason.entry(reason.clone()).or_default();
        match blocks.last_mut() {
            Some(last) if (last.dimension, last.degree) == (dimension, degree) => last.count += 1,
            _ => blocks.push(RemovedBlock {
                dimension,
                degree,
                count: 1,
            }),
        }
    }
    by_reason
}

fn component(set: &WitnessSet) -> ComponentBlock {
    let evidence = &set.evidence;
    ComponentBlock {
        id: set.id.to_string(),
        dimension: set.dimension(),
        degree: set.degree,
        count: 1,
        multiplicity: set.multiplicity.scheme,
        tracked_multiplicity: set.multiplicity.tracked,
        irreducible: set.irreducible,
        deflation: set.deflation.clone(),
        multidegree: None,
        self_conjugate: set.self_conjugate,
        orbit: set.orbit,
        certified: evidence.proof.map(|proof| proof.points),
        evidence: EvidenceBlock {
            trace_deviation: evidence.trace.and_then(|trace| finite(trace.deviation)),
            noise: evidence.trace.and_then(|trace| finite(trace.noise)),
            smallest_wrong_union: evidence.smallest_wrong_union.and_then(finite),
            loops: evidence.loops,
            precision_bits: evidence.trace.map(|trace| trace.precision_bits),
            rank_gap: evidence.rank_gap.and_then(finite),
            worst_condition: finite(evidence.worst_condition),
            proof: evidence.proof,
            doubts: evidence.doubts.clone(),
        },
    }
}

fn block(dimension: &Dimension, sets: &[WitnessSet]) -> DimensionBlock {
    let sets_of_dimension = sets
        .iter()
        .filter(|set| set.dimension() == dimension.number);
    let orbits: Option<BTreeSet<u32>> = sets_of_dimension.clone().map(|set| set.orbit).collect();
    let orbits = orbits.map(|orbits| orbits.len() as u64);
    DimensionBlock {
        components: sets_of_dimension.clone().count() as u64,
        degree: dimension.degree,
        superset: dimension.superset,
        junk: dimension.junk,
        removed: dimension.removed,
        excess: dimension.excess,
        failed: dimension.failed,
        found_by_loops: dimension.found_by_loops,
        orbits: orbits.filter(|&orbits| orbits > 0),
        complete: dimension.complete,
        doubts: dimension.doubts.clone(),
    }
}

impl DecompositionSummary {
    /// The summary of a job that has found this.
    pub fn new(about: &About, decomposition: &Decomposition) -> Self {
        Self {
            job: about.job.clone(),
            problem: DecomposedProblem {
                name: about.name.clone(),
                digest: about.digest.clone(),
                variables: about.variables,
                equations: about.equations,
                method: decomposition.method.name().into(),
                seed: about.seed,
            },
            decomposition: DecompositionBlock::new(decomposition),
            paths: PathBlock {
                superset: decomposition.paths,
                loops: decomposition.paths_of_loops,
            },
            time: about.time.clone(),
            workers: about.workers.clone(),
            settled: decomposition.settled(),
            warnings: about.warnings.clone(),
        }
    }

    /// Lines that `explain` prints about the decomposition.
    pub fn lines(&self) -> Vec<String> {
        let block = &self.decomposition;
        let mut lines = Vec::new();
        for (number, d) in block.by_dimension.iter().rev() {
            lines.push(format!(
                "dimension {number}: {} components of degree {} in all, complete: {}; {} paths to solutions, {} of \
                 them on sets of higher dimension; {} failed on the way",
                d.components,
                d.degree,
                d.complete.name(),
                d.superset,
                d.junk,
                d.failed
            ));
        }
        let unsettled = block.unsettled.iter();
        lines.extend(unsettled.map(|doubt| format!("not settled: {doubt}")));
        lines.extend(self.warnings.iter().map(|w| format!("warning: {w}")));
        lines
    }
}
