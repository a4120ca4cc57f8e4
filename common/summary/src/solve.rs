//! Summary: a finished solve in one JSON object, field by field as the contract has it.
//!
//! With several targets the blocks hold the sums, and `targets` the blocks of each.

use super::about::{About, TimeBlock, WorkerBlock};
use cognate_algorithms::answer::IsolatedSolutions;
use cognate_algorithms::monodromy::counts::LoopCounts;
use cognate_solutions::approximate::ApproximatePoint;
use cognate_solutions::certificates::CertifiedSystem;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::{ClassCounts, PathCounts, SolutionCounts};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A finished job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Id of the job.
    pub job: String,
    /// The system, its start and its seed.
    pub problem: ProblemBlock,
    /// Every path, counted once.
    pub paths: PathCounts,
    /// The solutions, counted.
    pub solutions: SolutionCounts,
    /// Symmetry classes, counted.
    pub classes: ClassCounts,
    /// Loops that found the solutions, in a solve by monodromy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub monodromy: Option<MonodromyBlock>,
    /// Wall time and CPU time.
    pub time: TimeBlock,
    /// Workers and the number of paths that each tracked.
    pub workers: Vec<WorkerBlock>,
    /// Number of failed paths for each reason.
    pub failures: BTreeMap<String, u64>,
    /// Whether the solutions were counted without paths.
    #[serde(default)]
    pub exact_count: ExactCountBlock,
    /// Counts of each target, if there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<TargetBlock>,
    /// Points of least residual, where they were asked for: none is a solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approximate: Option<Vec<ApproximatePoint>>,
    /// Reason why there is no point of least residual, or why there may be more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approximate_reason: Option<String>,
    /// System that the certificates refer to, if there are certificates and one target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certification: Option<CertifiedSystem>,
    /// True when every path is accounted for and every count is settled.
    pub settled: bool,
    /// Doubts and refusals, one sentence each.
    pub warnings: Vec<String>,
}

/// The problem that was solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProblemBlock {
    /// Name of the problem, usually that of its file.
    pub name: String,
    /// Digest of the system.
    pub digest: String,
    /// Number of variables.
    pub variables: u64,
    /// Number of equations.
    pub equations: u64,
    /// Start of the paths: `total-degree`, for instance.
    pub start: String,
    /// Reason for this start: which variable groups, for instance, and who chose them.
    #[serde(default)]
    pub why: String,
    /// Seed of everything random.
    pub seed: u64,
}

/// Whether the solutions were counted without paths, by elimination over a prime field.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExactCountBlock {
    /// Whether there is a count.
    pub made: bool,
    /// Number of isolated solutions, each once; null if it is not known, or if there are positive-dimensional sets.
    pub isolated: Option<u64>,
    /// Number of isolated solutions with their multiplicities.
    pub with_multiplicity: Option<u64>,
    /// Reason why there is no count.
    pub reason: Option<String>,
}

impl ExactCountBlock {
    /// Block for the solution sets of all targets; a count exists only for one target.
    fn of(sets: &[SolutionSet]) -> Self {
        let first = sets.first();
        let count = match sets {
            [set] => set.counts.exact_count.as_ref(),
            _ => None,
        };
        match count {
            Some(count) => Self {
                made: true,
                isolated: count.distinct,
                with_multiplicity: count.with_multiplicity,
                reason: None,
            },
            None => Self {
                reason: first.and_then(|set| set.no_exact_count.clone()),
                ..Self::default()
            },
        }
    }
}

/// A solve by monodromy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonodromyBlock {
    /// Loops and paths.
    pub loops: LoopCounts,
    /// The parameters of the solutions, by name: what a later solve takes as start parameters.
    /// Empty where there are several targets.
    pub parameters: BTreeMap<String, Complex64>,
}

/// The counts of one target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetBlock {
    /// Counts of the paths to this target.
    pub paths: PathCounts,
    /// Counts of the solutions at this target.
    pub solutions: SolutionCounts,
    /// Counts of symmetry classes of solutions at this target.
    pub classes: ClassCounts,
    /// System that the certificates of this target refer to, if there are certificates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certification: Option<CertifiedSystem>,
    /// True when every path to this target is accounted for and every count is settled; older summaries do not say it.
    #[serde(default)]
    pub settled: bool,
}

impl Summary {
    /// The summary of a job whose algorithm is done.
    pub fn new(about: &About, solutions: &IsolatedSolutions) -> Self {
        let sets = &solutions.sets[..];
        let mut warnings = about.warnings.clone();
        let mut failures = BTreeMap::new();
        for (target, set) in sets.iter().enumerate() {
            for path in &set.failed {
                *failures
                    .entry(path.reason.describe().to_owned())
                    .or_default() += 1;
            }
            warnings.extend(set.warnings.iter().map(|warning| match sets.len() {
                1 => warning.clone(),
                _ => format!("target {target}: {warning}"),
            }));
        }
        let block = |set: &SolutionSet| TargetBlock {
            paths: set.paths.clone(),
            solutions: set.counts.clone(),
            classes: set.classes.clone(),
            certification: set.certified_system.clone(),
            settled: set.settled(),
        };
        let approximate = match sets {
            [one] => one.approximate.clone(),
            _ => None,
        };
        let sum = match sets {
            [one] => block(one),
            _ => sum(sets),
        };
        Self {
            job: about.job.clone(),
            problem: ProblemBlock {
                name: about.name.clone(),
                digest: about.digest.clone(),
                variables: about.variables,
                equations: about.equations,
                start: about.start.clone(),
                why: about.why.clone(),
                seed: about.seed,
            },
            paths: sum.paths,
            solutions: sum.solutions,
            classes: sum.classes,
            monodromy: solutions.loops.clone().map(|loops| MonodromyBlock {
                loops: loops.counts,
                parameters: loops.parameters,
            }),
            approximate_reason: approximate.as_ref().and_then(|a| a.reason.clone()),
            approximate: approximate.map(|approximate| approximate.points),
            certification: sum.certification,
            time: about.time.clone(),
            workers: about.workers.clone(),
            failures,
            exact_count: ExactCountBlock::of(sets),
            targets: match sets {
                [_] => Vec::new(),
                several => several.iter().map(block).collect(),
            },
            settled: sum.settled,
            warnings,
        }
    }
}

/// Adds numbers to those of the same names.
fn add_by_name<K: Ord + Clone>(sum: &mut BTreeMap<K, u64>, terms: &BTreeMap<K, u64>) {
    for (name, number) in terms {
        *sum.entry(name.clone()).or_default() += number;
    }
}

/// The counts of several targets together.
fn sum(sets: &[SolutionSet]) -> TargetBlock {
    TargetBlock {
        paths: sum_of_paths(sets),
        solutions: sum_of_solutions(sets),
        classes: ClassCounts::default(),
        // Each target has its own.
        certification: None,
        settled: sets.iter().all(SolutionSet::settled),
    }
}

/// A sum is known where every term is.
fn add(sum: &mut Option<u64>, term: Option<u64>) {
    *sum = sum.zip(term).map(|(a, b)| a + b);
}

fn sum_of_paths(sets: &[SolutionSet]) -> PathCounts {
    let mut paths = PathCounts {
        positive_dimensional: Some(0),
        excess: Some(0),
        ..PathCounts::default()
    };
    for set in sets {
        let PathCounts {
            total,
            finite,
            singular,
            positive_dimensional,
            excess,
            at_infinity,
            failed,
            retracked,
            crossings_found,
            crossings_resolved,
            decided_by_precision_limit,
            by_precision,
            highest_precision_bits,
            degenerate,
            images,
            undecided,
            within_data_accuracy,
            decided_by_exact_count,
            removed,
        } = &set.paths;
        paths.total += total;
        paths.finite += finite;
        paths.singular += singular;
        add(&mut paths.positive_dimensional, *positive_dimensional);
        add(&mut paths.excess, *excess);
        paths.at_infinity += at_infinity;
        paths.failed += failed;
        paths.retracked += retracked;
        paths.crossings_found += crossings_found;
        paths.crossings_resolved += crossings_resolved;
        paths.decided_by_precision_limit += decided_by_precision_limit;
        add_by_name(&mut paths.by_precision, by_precision);
        paths.highest_precision_bits = paths.highest_precision_bits.max(*highest_precision_bits);
        add_by_name(&mut paths.degenerate, degenerate);
        paths.images += images;
        paths.undecided += undecided;
        paths.within_data_accuracy += within_data_accuracy;
        paths.decided_by_exact_count += decided_by_exact_count;
        paths.removed += removed;
    }
    paths
}

fn sum_of_solutions(sets: &[SolutionSet]) -> SolutionCounts {
    let mut counts = SolutionCounts {
        real: Some(0),
        certified: Some(0),
        certified_real: Some(0),
        positive_dimensional: Some(false),
        complete: Completeness::Yes,
        complete_reason: sets
            .first()
            .and_then(|set| set.counts.complete_reason.clone()),
        ..SolutionCounts::default()
    };
    for set in sets {
        let SolutionCounts {
            distinct,
            nonsingular,
            singular,
            real,
            real_reason,
            with_multiplicity,
            certified,
            certified_real,
            positive_dimensional,
            degenerate,
            sharpened,
            undecided,
            doubtful_multiplicity,
            complete,
            complete_reason,
            // Each target has its own.
            exact_count: _,
            removed,
            doubtful_denominators,
            without_path,
            without_conjugate,
            ill_conditioned,
        } = &set.counts;
        counts.distinct += distinct;
        counts.nonsingular += nonsingular;
        counts.singular += singular;
        counts.undecided += undecided;
        counts.doubtful_multiplicity += doubtful_multiplicity;
        counts.doubtful_denominators += doubtful_denominators;
        counts.without_path += without_path;
        counts.without_conjugate += without_conjugate;
        counts.ill_conditioned += ill_conditioned;
        add_by_name(&mut counts.removed, removed);
        if counts.complete == Completeness::Yes && *complete != Completeness::Yes {
            counts.complete_reason.clone_from(complete_reason);
        }
        counts.complete = counts.complete.and(*complete);
        add(&mut counts.real, *real);
        counts.real_reason = counts.real_reason.or_else(|| real_reason.clone());
        counts.with_multiplicity += with_multiplicity;
        add(&mut counts.certified, *certified);
        add(&mut counts.certified_real, *certified_real);
        counts.positive_dimensional = counts
            .positive_dimensional
            .zip(*positive_dimensional)
            .map(|(a, b)| a || b);
        add_by_name(&mut counts.degenerate, degenerate);
        if let Some(sharpened_counts) = sharpened {
            let sum = counts.sharpened.get_or_insert_default();
            sum.digits = sharpened_counts.digits;
            sum.solutions += sharpened_counts.solutions;
            sum.by_deflation += sharpened_counts.by_deflation;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(finite: u64, real: Option<u64>) -> SolutionSet {
        SolutionSet {
            paths: PathCounts {
                total: finite + 1,
                finite,
                failed: 1,
                positive_dimensional: Some(0),
                by_precision: [(53, finite + 1)].into(),
                highest_precision_bits: 53,
                ..PathCounts::default()
            },
            counts: SolutionCounts {
                distinct: finite,
                nonsingular: finite,
                real,
                real_reason: real.is_none().then(|| "because".to_owned()),
                degenerate: [("no pose".to_owned(), 1)].into(),
                ..SolutionCounts::default()
            },
            ..SolutionSet::default()
        }
    }

    #[test]
    fn sums_add_up_and_know_what_they_do_not_know() {
        let both = sum(&[set(3, Some(1)), set(4, Some(2))]);
        assert_eq!((both.paths.total, both.paths.sum()), (9, 9));
        assert_eq!(both.solutions.real, Some(3));
        assert_eq!(both.solutions.degenerate["no pose"], 2);
        assert_eq!(both.paths.by_precision[&53], 9);
        let unknown = sum(&[set(3, Some(1)), set(4, None)]);
        assert_eq!(unknown.solutions.real, None);
        assert_eq!(unknown.solutions.real_reason.as_deref(), Some("because"));
    }
}
