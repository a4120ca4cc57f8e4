//! Branches of positions along a path of targets. Each sample is solved by itself, so that nothing drifts; neighbours are
//! joined where a proof shows that one solution leads to the other, and nowhere else.

mod curve;
mod fold;
mod joints;
pub mod samples;
mod segment;
mod trace;
mod tube;

use super::parallel;
use super::postures::{Position, Postures};
use super::prepared_mechanism::PreparedMechanism;
use cognate_continuation::stage::PrepareError;
use cognate_kinematics::mechanism::MechanismError;
use cognate_numeric::interruption::is_interrupted;
use joints::{Joint, Link};
use samples::Sample;
use segment::{Equations, Segment};

/// A path of samples with the branches of their real positions.
#[derive(Clone, Debug)]
pub struct Path {
    /// The samples.
    pub samples: Vec<Sample>,
    /// Positions at each of the samples.
    pub answers: Vec<Postures>,
    /// The branches: those within limits first, longer ones first.
    pub branches: Vec<Branch>,
    /// Where two branches meet and vanish, or appear.
    pub folds: Vec<FoldOnPath>,
    /// Where joints pass their limits.
    pub limits: Vec<LimitPassed>,
    /// Branches of a closed path that end in another posture than the one in which they began, without any fold.
    pub changes: Vec<[usize; 2]>,
    /// Whether nothing is in doubt.
    pub settled: bool,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Positions that follow each other, with proof.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// The sample at which it begins.
    pub first: usize,
    /// The position at each sample from there, by its number among the sample's positions.
    pub positions: Vec<usize>,
    /// How it begins and ends.
    pub ends: [BranchEnd; 2],
    /// Whether all its positions are within their limits.
    pub within_limits: bool,
}

/// How a branch begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BranchEnd {
    /// With the path.
    Path,
    /// At a fold, by its number.
    Fold(usize),
    /// The kind of end is in doubt.
    Unknown,
}

/// A fold on the path.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldOnPath {
    /// Where: the number of the sample before it, and its part of the way to the next.
    pub at: f64,
    /// How far off that can be, where the fold is proved to be there.
    pub error: Option<f64>,
    /// The two branches, by their place in the list.
    pub branches: Vec<usize>,
    /// Whether they vanish there when the path is gone along; else they appear.
    pub vanish: bool,
}

/// A joint that passes one of its limits.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitPassed {
    /// The branch.
    pub branch: usize,
    /// The sample before.
    pub sample: usize,
    /// The joint's name.
    pub joint: String,
    /// Whether it leaves its range, going along the path; else it comes back.
    pub leaves: bool,
}

impl Branch {
    /// The last sample.
    pub fn last(&self) -> usize {
        self.first + self.positions.len() - 1
    }
}

/// Solves the samples and joins their positions.
pub fn follow(
    prepared: &PreparedMechanism<'_>,
    samples: Vec<Sample>,
) -> Result<Path, MechanismError> {
    let path = prepared.path_equations()?;
    let equations = Equations::new(&path).map_err(|message| {
        MechanismError::of_file(
            "follow",
            format!("the equations cannot be followed: {message}"),
        )
    })?;
    let mut parameters = Vec::new();
    for sample in &samples {
        let at = path.parameters(&sample.target);
        parameters.push(at.map_err(|message| MechanismError::of_file("follow", message))?);
    }
    let targets: Vec<_> = samples.iter().map(|s| s.target.clone()).collect();
    let answers = prepared.solve(&targets)?;
    let real: Vec<Vec<usize>> = answers.iter().map(followed).collect();
    let count = samples.len().saturating_sub(1);
    let links = parallel::map(count, prepared.threads(), |k| {
        if is_interrupted() {
            return None;
        }
        let segment = Segment::new(&equations, &parameters[k], &parameters[k + 1]);
        let points = |sample: usize| {
            let positions = real[sample].iter();
            positions
                .map(|p| path.point(&answers[sample].positions[*p]))
                .collect::<Vec<_>>()
        };
        Some(joints::join(segment, &points(k), &points(k + 1)))
    });
    let links: Option<Vec<Joint>> = links.into_iter().collect();
    let links = links
        .ok_or_else(|| MechanismError::of_file("follow", PrepareError::Interrupted.to_string()))?;
    Ok(Path::assemble(samples, answers, &real, &links))
}

/// The positions of a sample that take part: real and regular.
fn followed(answer: &Postures) -> Vec<usize> {
    let positions = answer.positions.iter().enumerate();
    positions
        .filter(|(_, p)| p.is_real && !p.is_singular)
        .map(|(k, _)| k)
        .collect()
}

/// Branches that are being put together.
struct Assembly<'a> {
    real: &'a [Vec<usize>],
    answers: &'a [Postures],
    branches: Vec<Branch>,
    folds: Vec<FoldOnPath>,
    warnings: Vec<String>,
    /// The branch of each position of the sample that was reached.
    open: Vec<usize>,
}

impl Assembly<'_> {
    fn begin(&mut self, sample: usize, place: usize, end: BranchEnd) -> usize {
        self.branches.push(Branch {
            first: sample,
            positions: vec![self.real[sample][place]],
            ends: [end, BranchEnd::Unknown],
            within_limits: true,
        });
        self.branches.len() - 1
    }

    /// Goes on from sample `k` by what is known of the way to the next.
    fn advance(&mut self, k: usize, joint: &Joint) {
        let folds_before = self.folds.len();
        self.folds.extend(joint.folds.iter().map(|fold| FoldOnPath {
            at: k as f64 + fold.s,
            error: fold.error,
            branches: Vec::new(),
            vanish: fold.vanish,
        }));
        let mut next = vec![None; self.real[k + 1].len()];
        for (place, link) in joint.onward.iter().enumerate() {
            let branch = self.open[place];
            match link {
                Link::Joined(other) => {
                    self.branches[branch]
                        .positions
                        .push(self.real[k + 1][*other]);
                    next[*other] = Some(branch);
                }
                Link::Fold(fold) => {
                    let number = folds_before + fold;
                    self.branches[branch].ends[1] = BranchEnd::Fold(number);
                    self.folds[number].branches.push(branch);
                }
                Link::Unknown(why) => self.doubt(k, why),
            }
        }
        for (place, link) in joint.back.iter().enumerate() {
            if next[place].is_some() {
                continue;
            }
            let end = match link {
                Some(Link::Fold(fold)) => BranchEnd::Fold(folds_before + fold),
                Some(Link::Unknown(why)) => {
                    self.doubt(k, why);
                    BranchEnd::Unknown
                }
                _ => BranchEnd::Unknown,
            };
            let branch = self.begin(k + 1, place, end);
            if let BranchEnd::Fold(fold) = end {
                self.folds[fold].branches.push(branch);
            }
            next[place] = Some(branch);
        }
        self.open = next.into_iter().flatten().collect();
    }

    fn doubt(&mut self, k: usize, why: &str) {
        self.warnings.push(format!(
            "between samples {} and {}: a branch is not known to go on: {why}",
            k + 1,
            k + 2
        ));
    }

    fn position(&self, branch: &Branch, k: usize) -> &Position {
        &self.answers[branch.first + k].positions[branch.positions[k]]
    }
}

impl Path {
    fn assemble(
        samples: Vec<Sample>,
        answers: Vec<Postures>,
        real: &[Vec<usize>],
        links: &[Joint],
    ) -> Self {
        let mut assembly = Assembly {
            real,
            answers: &answers,
            branches: Vec::new(),
            folds: Vec::new(),
            warnings: Vec::new(),
            open: Vec::new(),
        };
        let first = real.first().map_or(0, Vec::len);
        assembly.open = (0..first)
            .map(|place| assembly.begin(0, place, BranchEnd::Path))
            .collect();
        for (k, joint) in links.iter().enumerate() {
            assembly.advance(k, joint);
        }
        for branch in &assembly.open {
            assembly.branches[*branch].ends[1] = BranchEnd::Path;
        }
        for (i, answer) in answers.iter().enumerate() {
            if !answer.settled {
                let words = answer.warnings.join("; ");
                assembly
                    .warnings
                    .push(format!("sample {} is not settled: {words}", i + 1));
            }
        }
        assembly.warnings.extend(left_out(&answers));
        let (limits, within) = limits(&assembly);
        for (branch, within) in assembly.branches.iter_mut().zip(within) {
            branch.within_limits = within;
        }
        let mut path = Self {
            changes: Vec::new(),
            settled: assembly.warnings.is_empty(),
            branches: assembly.branches,
            folds: assembly.folds,
            warnings: assembly.warnings,
            limits,
            samples,
            answers,
        };
        path.order();
        path.find_changes();
        path
    }

    /// Branches within limits first, longer ones first, then as they begin.
    fn order(&mut self) {
        let mut order: Vec<usize> = (0..self.branches.len()).collect();
        let key = |b: usize| {
            let branch = &self.branches[b];
            (
                !branch.within_limits,
                std::cmp::Reverse(branch.positions.len()),
                branch.first,
                branch.positions[0],
            )
        };
        order.sort_by_key(|b| key(*b));
        let mut place = vec![0; order.len()];
        for (new, old) in order.iter().enumerate() {
            place[*old] = new;
        }
        self.branches = order.iter().map(|b| self.branches[*b].clone()).collect();
        for fold in &mut self.folds {
            fold.branches.iter_mut().for_each(|b| *b = place[*b]);
            fold.branches.sort_unstable();
        }
        for limit in &mut self.limits {
            limit.branch = place[limit.branch];
        }
        self.limits
            .sort_by_key(|limit| (limit.sample, limit.branch));
    }

    /// On a path that ends where it began: whole branches that lead from one position to another.
    fn find_changes(&mut self) {
        let targets = (self.samples.first(), self.samples.last());
        let closed = matches!(targets, (Some(a), Some(b)) if a.target == b.target);
        if !closed || self.samples.len() < 2 {
            return;
        }
        let last = self.samples.len();
        for branch in self.branches.iter().filter(|b| b.positions.len() == last) {
            let (from, to) = (branch.positions[0], branch.positions[last - 1]);
            if from != to {
                self.changes.push([from, to]);
            }
        }
    }
}

/// Warnings about postures that take no part in branches: those of sets, and singular ones of samples one after the other. A
/// fold at a sample has one sample alone.
fn left_out(answers: &[Postures]) -> Vec<String> {
    let (mut on_sets, mut singular, mut before) = (0, 0, false);
    for answer in answers {
        on_sets += usize::from(!answer.sets.is_empty());
        let is_isolated = |p: &Position| p.is_real && p.is_singular && p.multiplicity > 0;
        let here = answer.positions.iter().any(is_isolated);
        singular += usize::from(here && before);
        before = here;
    }
    let mut warnings = Vec::new();
    let samples = answers.len();
    if on_sets > 0 {
        warnings.push(format!(
            "at {on_sets} of {samples} samples there are postures that are not isolated, along which the mechanism moves while \
             its output is at rest: they are on no branch"
        ));
    }
    if singular > 0 {
        warnings.push(format!(
            "at {} of {samples} samples, some of them one after the other, there are singular postures: they are on no branch",
            singular + 1
        ));
    }
    warnings
}

/// Where joints pass limits on each branch, and whether none is ever beyond.
fn limits(assembly: &Assembly<'_>) -> (Vec<LimitPassed>, Vec<bool>) {
    let mut passed = Vec::new();
    let mut within = Vec::new();
    for (number, branch) in assembly.branches.iter().enumerate() {
        let beyond = |k: usize| &assembly.position(branch, k).violated;
        within.push((0..branch.positions.len()).all(|k| beyond(k).is_empty()));
        for k in 1..branch.positions.len() {
            let (before, after) = (beyond(k - 1), beyond(k));
            for (there, other, leaves) in [(after, before, true), (before, after, false)] {
                for joint in there.iter().filter(|joint| !other.contains(joint)) {
                    passed.push(LimitPassed {
                        branch: number,
                        sample: branch.first + k - 1,
                        joint: joint.clone(),
                        leaves,
                    });
                }
            }
        }
    }
    (passed, within)
}
