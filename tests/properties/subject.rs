//! Subject: a stage of a real solve, with all that a worker needs to do its items.

use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve};
use cognate_algorithms::plan::GivenStart;
use cognate_algorithms::run_locally::drive;
use cognate_algorithms::{PathAlgorithm, Root, SolveOptions, plan};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::Stage;
use cognate_numeric::lanes::dispatch::{InstructionSet, limited_to};
use cognate_protocol::records;
use cognate_solutions::witness::Method;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::HashMap;
use std::sync::Arc;

/// Largest number of items of a stage that are done: enough for every kind of end, few enough for seconds.
const MOST_ITEMS: u64 = 48;

/// A stage of a solve by seed 7.
pub struct Subject {
    system: System,
    /// The stage.
    pub stage: Stage,
    points: HashMap<Digest, Arc<StoredPoints>>,
}

/// Hash of the records of these results: what an audit compares. An unknown number (NaN) equals itself.
pub fn hash(results: &[ItemResult]) -> String {
    records::hash(&records::encode(results)).to_string()
}

impl Subject {
    /// The first wanted stage of this solve. Stages before it are done on the way.
    ///
    /// # Panics
    /// When the solve has no such stage.
    pub fn of(system: &System, options: SolveOptions, wanted: &dyn Fn(&Stage) -> bool) -> Self {
        Self::from(system, Vec::new(), options, wanted)
    }

    /// The first wanted stage of a solve that starts from these points.
    pub fn from(
        system: &System,
        start: Vec<Complex64>,
        options: SolveOptions,
        wanted: &dyn Fn(&Stage) -> bool,
    ) -> Self {
        let mut points = HashMap::new();
        let mut options = SolveOptions { seed: 7, ..options };
        if !start.is_empty() {
            let given = StoredPoints {
                dimension: system.variables.len(),
                coordinates: start,
            };
            options.method = options.method.with_points(GivenStart::of(&given));
            points.insert(given.digest(), Arc::new(given));
        }
        let mut plan = plan(system, &options).expect("a plan");
        Self::on_the_way(&plan.system, &mut plan.algorithm, points, wanted)
    }

    /// The first wanted stage of a decomposition.
    ///
    /// # Panics
    /// When it has no such stage.
    pub fn of_decomposition(system: &System, wanted: &dyn Fn(&Stage) -> bool) -> Self {
        let options = DecompositionOptions {
            seed: 7,
            method: Some(Method::Cascade),
            ..DecompositionOptions::default()
        };
        let solve = DecompositionSolve::new(system, &options);
        let mut root = Root::new(solve.expect("it can be decomposed"));
        Self::on_the_way(system, &mut root, HashMap::new(), wanted)
    }

    fn on_the_way(
        system: &System,
        algorithm: &mut dyn PathAlgorithm,
        mut points: HashMap<Digest, Arc<StoredPoints>>,
        wanted: &dyn Fn(&Stage) -> bool,
    ) -> Self {
        let mut stage_on_the_way = None;
        let ended = drive::<(), _>(algorithm, &mut |opening| {
            let brought = opening.objects.iter();
            points.extend(brought.map(|object| (object.digest(), Arc::clone(object))));
            let system = opening.system.as_deref().unwrap_or(system);
            if wanted(&opening.stage) {
                stage_on_the_way = Some((system.clone(), opening.stage.clone()));
                return Err(());
            }
            let find = |digest: Digest| points.get(&digest).cloned();
            let prepared = PreparedWork::new(system, &opening.stage, &find);
            let prepared = prepared.expect("a stage of a solve can be prepared");
            Ok(prepared.run(0..prepared.items(), 8))
        });
        assert_eq!(ended, Err(()), "the solve has no such stage");
        let (system, stage) = stage_on_the_way.expect("it ended there");
        let subject = Self {
            system,
            stage,
            points,
        };
        // Solves put paths aside at first: here their endgames are wanted.
        subject.with_endgame_bits(u32::MAX)
    }

    /// The stage with a limit on the bits of an endgame: paths whose endgame needs more bits are put aside.
    #[must_use]
    pub fn with_endgame_bits(mut self, most: u32) -> Self {
        self.stage.settings.max_endgame_bits = most;
        self
    }

    fn prepare(&self) -> Result<PreparedWork, PrepareError> {
        PreparedWork::new(&self.system, &self.stage, &|digest| {
            self.points.get(&digest).cloned()
        })
    }

    fn prepared(&self) -> (PreparedWork, u64) {
        let prepared = self.prepare().expect("a stage of a solve can be prepared");
        assert_eq!(Some(prepared.items()), self.stage.items());
        let end = prepared.items().min(MOST_ITEMS);
        assert!(end > 1, "one item has no neighbours");
        (prepared, end)
    }

    /// How many items are done and the hash of their results, for the golden file.
    pub fn golden(&self) -> (u64, String) {
        let (prepared, end) = self.prepared();
        (end, hash(&prepared.run(0..end, 8)))
    }

    /// Results are the same bits at every width, in every split and order, on every instruction set and
    /// after another preparation; each is that of its item; records give them back.
    ///
    /// # Panics
    /// When that is not so.
    pub fn check_purity(&self) {
        let (prepared, end) = self.prepared();
        let expected = prepared.run(0..end, 16);
        assert_eq!(expected.len() as u64, end);
        for (item, result) in (0..).zip(&expected) {
            assert_eq!(result.origin().0, self.stage.origin(item), "item {item}");
            assert_eq!(result.attempt(), self.stage.attempt, "item {item}");
            assert!(result.is_of(self.stage.work), "item {item}");
        }
        let check = |what: &str, results: Vec<ItemResult>| {
            assert!(
                hash(&results) == hash(&expected),
                "{what} changes the results"
            );
        };
        check("width 8", prepared.run(0..end, 8));
        check("width 1", prepared.run(0..end, 1));
        let one_by_one = (0..end).flat_map(|item| prepared.run(item..item + 1, 8));
        check("having no neighbours", one_by_one.collect());
        let mut parts = Vec::new();
        for k in (0..end.div_ceil(5)).rev() {
            parts.push(prepared.run(5 * k..(5 * k + 5).min(end), 16));
        }
        parts.reverse();
        check("another order of chunks", parts.concat());
        for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
            let there = limited_to(set, || {
                let (prepared, _) = self.prepared();
                prepared.run(0..end, 8)
            });
            check(set.name(), there);
        }
        check("preparing again", self.prepared().0.run(0..end, 16));
        let read = records::decode(&records::encode(&expected), self.stage.work);
        check("a record", read.expect("records are read"));
    }
}
