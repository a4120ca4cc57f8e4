//! Families of mechanisms moved to many members: all solutions of each, and how many are real in all.
//!
//! `SEEDS=30 cargo test --release -p cognate-tests --test known_answers mechanism_families` takes more seeds than the three
//! of every run.

use cognate_algorithms::monodromy::LoopLimits;
use cognate_algorithms::plan::{GivenStart, KnownSolutions, MonodromyOptions, SolveMethod};
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::formats;
use cognate_systems::formats::points::{read_parameters, read_solutions};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::path::PathBuf;
use std::sync::Arc;

/// A family with some solutions at general parameters.
struct Family {
    folder: PathBuf,
    system: System,
    start: Vec<Complex64>,
    solutions: Arc<StoredPoints>,
}

impl Family {
    /// In `tests/families/NAME`.
    fn named(name: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join("families")
            .join(name);
        let read =
            |file: &str| std::fs::read(folder.join(file)).expect("it stands beside the system");
        let problem = formats::read("family.json", &read("family.json"));
        let system = problem.expect("it can be read").system;
        let points = read_solutions("start", &read("start.jsonl"), &system.variables);
        let points: Vec<Vec<Complex64>> = points.expect("it can be read");
        let parameters =
            read_parameters("start", &read("start_parameters.json"), &system.parameters);
        let solutions = Arc::new(StoredPoints {
            dimension: system.variables.len(),
            coordinates: points.into_iter().flatten().collect(),
        });
        Self {
            start: parameters.expect("it can be read").remove(0),
            folder,
            system,
            solutions,
        }
    }

    fn known(&self) -> KnownSolutions {
        KnownSolutions {
            points: Some(GivenStart {
                object: self.solutions.digest(),
                count: self.solutions.len() as u64,
                dimension: self.solutions.dimension,
            }),
            parameters: Some(self.start.clone()),
        }
    }

    fn solve(
        &self,
        method: SolveMethod,
        targets: Vec<Vec<Complex64>>,
        seed: u64,
    ) -> Vec<SolutionSet> {
        let options = SolveOptions {
            method,
            seed,
            target_parameters: targets,
            ..SolveOptions::default()
        };
        let mut plan = plan(&self.system, &options).expect("it can be planned");
        let find = |_: Digest| Some(Arc::clone(&self.solutions));
        let sets = run_locally(&plan.system, &mut plan.algorithm, &find, 8);
        sets.expect("it can be solved")
    }

    /// All solutions at the start, by loops from those that are known.
    fn completed(mut self, count: u64, seed: u64) -> Self {
        let method = SolveMethod::Monodromy(MonodromyOptions {
            known: self.known(),
            limits: LoopLimits {
                count: Some(count),
                ..LoopLimits::default()
            },
        });
        let sets = self.solve(method, Vec::new(), seed);
        let values = sets[0].solutions.iter().flat_map(|s| s.variables.values());
        self.solutions = Arc::new(StoredPoints {
            dimension: self.system.variables.len(),
            coordinates: values.collect(),
        });
        assert_eq!(self.solutions.len() as u64, count, "seed {seed}");
        self
    }

    /// At every member of this file there are as many regular solutions as at the start, and `real` of all are real.
    fn check_members(&self, file: &str, real: u64, seed: u64) {
        let content = std::fs::read(self.folder.join(file)).expect("it stands beside the system");
        let targets = read_parameters(file, &content, &self.system.parameters);
        let targets = targets.expect("it can be read");
        assert_eq!(targets.len(), 200, "{file}");
        let sets = self.solve(SolveMethod::Given(self.known()), targets, seed);
        let count = self.solutions.len() as u64;
        for (member, set) in sets.iter().enumerate() {
            let (paths, counts) = (&set.paths, &set.counts);
            let member_counts = [paths.total, counts.nonsingular, paths.failed];
            assert_eq!(
                member_counts,
                [count, count, 0],
                "{file}, seed {seed}, member {member}"
            );
        }
        let real_solutions: u64 = sets.iter().filter_map(|set| set.counts.real).sum();
        assert_eq!(real_solutions, real, "{file}, seed {seed}");
    }
}

fn seeds() -> std::ops::RangeInclusive<u64> {
    let seeds = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    1..=seeds.unwrap_or(3)
}

/// 16 postures of an arm of six joints (Raghavan and Roth 1990), 200 poses of one arm and 200 arms: `expected` of the family's
/// `meta.json`.
#[test]
fn six_revolute_arms() {
    for seed in seeds() {
        let family = Family::named("six_revolute").completed(16, seed);
        family.check_members("targets_one_arm.json", 508, seed);
        family.check_members("targets_random.json", 758, seed);
    }
}

/// 40 postures of a platform on six legs (Raghavan 1993, Mourrain 1993) for 200 sets of lengths.
#[test]
fn stewart_gough_platforms() {
    for seed in seeds() {
        Family::named("stewart").check_members("targets.json", 658, seed);
    }
}
