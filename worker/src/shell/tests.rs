//! The shell with real threads, clock and stages, and a coordinator that is a table in memory.

use super::*;
use crate::transport::address::Address;
use crate::transport::{GiveBack, Pulled, Renewal};
use async_trait::async_trait;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathIndex;
use cognate_continuation::start_points::{Digest, StartPoints, StoredPoints};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::lanes::dispatch::InstructionSet;
use cognate_systems::formats;
use cognate_systems::system::System;
use std::collections::{BTreeMap, VecDeque};
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::sync::{Mutex, MutexGuard};

/// System of x_i^2 = 2 for each of `variables` variables: 2^n paths.
fn system(variables: usize) -> System {
    let names: Vec<String> = (0..variables).map(|k| format!("x{k}")).collect();
    let functions: Vec<String> = (0..variables).map(|k| format!("f{k}")).collect();
    let equations = (0..variables).map(|k| format!("f{k} = x{k}^2 - 2;\n"));
    let text = format!(
        "CONFIG\nEND;\nINPUT\nvariable_group {};\nfunction {};\n{}END;\n",
        names.join(", "),
        functions.join(", "),
        equations.collect::<String>()
    );
    let problem = formats::read("test", text.as_bytes());
    problem.expect("a system").system
}

#[derive(Default)]
struct Table {
    ready: VecDeque<Lease>,
    leased: BTreeMap<LeaseId, (Lease, Instant)>,
    accepted: BTreeMap<LeaseId, TrackedChunk>,
    given_back: Vec<(LeaseId, GiveBack)>,
    expired: usize,
    renewals: usize,
    calls: usize,
    fetched: usize,
    left: bool,
}

struct Coordinator {
    table: Mutex<Table>,
    variables: usize,
    /// One call in this number is carried out and not answered.
    loses_one_in: Option<u64>,
}

impl Coordinator {
    fn new(variables: usize, chunks: u64, lasts: Duration) -> Self {
        let items = 1u64 << variables;
        let size = items / chunks;
        let lease = |chunk: u64| Lease {
            id: LeaseId {
                job: "job".to_owned(),
                stage: StageId(0),
                chunk,
                epoch: 1,
            },
            problem: Digest([1; 32]),
            stage: Digest([2; 32]),
            items: chunk * size..(chunk + 1) * size,
            lasts,
            alone: false,
        };
        Self {
            table: Mutex::new(Table {
                ready: (0..chunks).map(lease).collect(),
                ..Table::default()
            }),
            variables,
            loses_one_in: None,
        }
    }

    fn table(&self) -> MutexGuard<'_, Table> {
        let mut table = self.table.lock().expect("no test thread panicked");
        table.calls += 1;
        let now = Instant::now();
        let table_ref = &mut *table;
        let over = table_ref
            .leased
            .extract_if(.., |_, (_, until)| *until <= now);
        let over: Vec<_> = over.map(|(_, (lease, _))| lease).collect();
        table_ref.expired += over.len();
        for mut lease in over {
            lease.id.epoch += 1;
            table_ref.ready.push_back(lease);
        }
        table
    }

    fn answer<T>(&self, table: &Table, answer: T) -> Result<T, TransportError> {
        // By a hash: calls come at even intervals, and every third one could be the same lease's each time.
        let drawn = BuildHasherDefault::<DefaultHasher>::default().hash_one(table.calls);
        match self.loses_one_in {
            Some(many) if drawn.is_multiple_of(many) => {
                Err(TransportError::Unavailable("lost".to_owned()))
            }
            _ => Ok(answer),
        }
    }
}

#[async_trait]
impl Transport for Coordinator {
    async fn pull(&self, _: u64, free: usize, wait: Duration) -> Result<Pulled, TransportError> {
        let begin = Instant::now();
        loop {
            {
                let mut table = self.table();
                let count = free.min(table.ready.len());
                let leases: Vec<Lease> = table.ready.drain(..count).collect();
                if !leases.is_empty() || begin.elapsed() >= wait {
                    for lease in &leases {
                        let until = Instant::now() + lease.lasts;
                        table
                            .leased
                            .insert(lease.id.clone(), (lease.clone(), until));
                    }
                    let pulled = Pulled {
                        leases,
                        ..Pulled::default()
                    };
                    return self.answer(&table, pulled);
                }
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }

    async fn renew(&self, leases: &[LeaseId]) -> Result<Vec<Renewal>, TransportError> {
        let mut table = self.table();
        table.renewals += 1;
        let mut renewals = Vec::new();
        for id in leases {
            renewals.push(match table.leased.get_mut(id) {
                Some((lease, until)) => {
                    *until = Instant::now() + lease.lasts;
                    Renewal::Held(lease.lasts)
                }
                None => Renewal::Lost,
            });
        }
        self.answer(&table, renewals)
    }

    async fn report(&self, id: &LeaseId, chunk: &TrackedChunk) -> Result<Receipt, TransportError> {
        let mut table = self.table();
        let receipt = match (table.accepted.get(id), table.leased.contains_key(id)) {
            (Some(before), _) if before.results == chunk.results => Receipt::AlreadyAccepted,
            (Some(_), _) => Receipt::HashDiffers,
            (None, false) => Receipt::Stale,
            (None, true) => {
                table.leased.remove(id);
                table.accepted.insert(id.clone(), chunk.clone());
                Receipt::Accepted
            }
        };
        self.answer(&table, receipt)
    }

    async fn give_back(&self, leases: &[LeaseId], why: &GiveBack) -> Result<(), TransportError> {
        let mut table = self.table();
        for id in leases {
            table.leased.remove(id);
            table.given_back.push((id.clone(), why.clone()));
        }
        self.answer(&table, ())
    }

    async fn leave(&self) -> Result<(), TransportError> {
        self.table().left = true;
        Ok(())
    }

    async fn system(&self, problem: Digest) -> Result<System, TransportError> {
        if problem == Digest([1; 32]) {
            Ok(system(self.variables))
        } else {
            Err(TransportError::Refused("no such problem".to_owned()))
        }
    }

    async fn stage(&self, _: &str, id: StageId) -> Result<Stage, TransportError> {
        let mut table = self.table();
        table.fetched += 1;
        let stage = Stage {
            id,
            system: None,
            work: Work::Track,
            homotopy: HomotopyKind::StraightLine {
                parameters: Vec::new(),
            },
            start_points: StartPoints::TotalDegree {
                degrees: vec![2; self.variables],
            },
            settings: Settings::default(),
            seed: 11,
            attempt: 0,
        };
        self.answer(&table, stage)
    }

    async fn points(&self, _: Digest) -> Result<StoredPoints, TransportError> {
        Err(TransportError::Refused("no such object".to_owned()))
    }
}

fn announcement() -> Announcement {
    Announcement {
        worker: "test".to_owned(),
        session: "test-1".to_owned(),
        machine: Machine {
            host: "here".to_owned(),
            cores: 2,
            instruction_set: InstructionSet::Avx2,
            memory_bytes: None,
        },
        threads: 2,
        lane_width: 8,
    }
}

fn config() -> Config {
    Config {
        threads: 2,
        idle_timeout: Some(Duration::from_millis(500)),
        poll: Duration::from_millis(200),
        ..Config::new(vec![Address::Tcp("nowhere:1".to_owned())])
    }
}

fn work(coordinator: &Arc<Coordinator>, config: Config, stop_after: Option<Duration>) -> Ending {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .expect("a runtime");
    let shutdown = CancellationToken::new();
    let transport = Arc::clone(coordinator) as Arc<dyn Transport>;
    runtime.block_on(async {
        if let Some(after) = stop_after {
            let shutdown = shutdown.clone();
            tokio::spawn(async move {
                tokio::time::sleep(after).await;
                shutdown.cancel();
            });
        }
        let working = run_over(config, announcement(), transport, shutdown);
        let ending = tokio::time::timeout(Duration::from_secs(60), working).await;
        ending.expect("the worker ends").expect("the worker begins")
    })
}

/// All items in order, each once.
fn check_all_accepted(coordinator: &Coordinator, items: u64) {
    let table = coordinator.table();
    assert!(table.ready.is_empty() && table.leased.is_empty());
    let results = table.accepted.values().flat_map(|chunk| &chunk.results);
    let mut origins: Vec<PathIndex> = results.map(ItemResult::origin).collect();
    origins.sort_unstable();
    assert_eq!(origins, (0..items).map(PathIndex).collect::<Vec<_>>());
    assert!(table.left, "it said goodbye");
}

#[test]
fn all_chunks_are_tracked_and_an_idle_worker_ends() {
    let coordinator = Arc::new(Coordinator::new(6, 8, Duration::from_secs(30)));
    assert_eq!(work(&coordinator, config(), None), Ending::Idle);
    check_all_accepted(&coordinator, 64);
    assert_eq!(coordinator.table().fetched, 1, "a stage is fetched once");
}

#[test]
fn lost_replies_lose_no_chunk() {
    let mut coordinator = Coordinator::new(6, 16, Duration::from_millis(300));
    coordinator.loses_one_in = Some(3);
    let coordinator = Arc::new(coordinator);
    let patient = Config {
        idle_timeout: Some(Duration::from_secs(5)),
        ..config()
    };
    assert_eq!(work(&coordinator, patient, None), Ending::Idle);
    check_all_accepted(&coordinator, 64);
}

#[test]
fn leases_are_renewed_while_every_thread_tracks() {
    // A machine with other work may stand still for longer than a short lease, and chunks may be too quick
    // to tell: then both last twice as long.
    let tries: Vec<String> = (0..5).map_while(|longer| renewed(longer).err()).collect();
    assert!(tries.len() < 5, "{tries:?}");
}

/// Whether leases of 0.4 s · 2^`longer` outlast chunks that take longer; what happened where not.
fn renewed(longer: u32) -> Result<(), String> {
    // More threads than cores, and chunks that take much longer than a lease on any machine.
    let cores = Machine::detect().cores;
    let variables = 14 + (cores.div_ceil(2).ilog2() + longer) as usize;
    let lease = Duration::from_millis(400 << longer);
    let coordinator = Arc::new(Coordinator::new(variables, 2, lease));
    let busy = Config {
        threads: 2 * cores,
        lane_width: Some(crate::config::LaneWidth::One),
        ..config()
    };
    let begin = Instant::now();
    assert_eq!(work(&coordinator, busy, None), Ending::Idle);
    let table = coordinator.table();
    if table.expired > 0 {
        return Err(format!("a lease ended in {:?}", begin.elapsed()));
    }
    let longest = table.accepted.values().map(|chunk| chunk.wall).max();
    let longest = longest.expect("chunks were tracked");
    if longest <= lease || table.renewals < 3 {
        return Err(format!("{} renewals in {longest:?}", table.renewals));
    }
    drop(table);
    check_all_accepted(&coordinator, 1 << variables);
    Ok(())
}

#[test]
fn what_cannot_be_tracked_is_given_back_and_the_worker_goes_on() {
    let coordinator = Arc::new(Coordinator::new(4, 4, Duration::from_secs(30)));
    {
        let mut table = coordinator.table();
        table.ready[1].problem = Digest([9; 32]);
        table.ready[2].items = 14..17;
    }
    assert_eq!(work(&coordinator, config(), None), Ending::Idle);
    let table = coordinator.table();
    assert_eq!(table.accepted.len(), 2);
    let mut reasons: Vec<_> = table
        .given_back
        .iter()
        .map(|(id, why)| (id.chunk, why))
        .collect();
    reasons.sort_by_key(|(chunk, _)| *chunk);
    let failed = |why: &str| GiveBack::Failed(why.to_owned());
    // That an object is not there is nobody's failure but the storage's.
    assert!(matches!(reasons[0], (1, GiveBack::Unfetched(_))));
    let beyond = failed("the chunk ends at item 17, the stage has 16");
    assert_eq!(reasons[1], (2, &beyond));
}

#[test]
fn a_stopped_worker_gives_back_what_is_unfinished() {
    let coordinator = Arc::new(Coordinator::new(16, 2, Duration::from_secs(30)));
    let stop = Some(Duration::from_millis(150));
    assert_eq!(work(&coordinator, config(), stop), Ending::Stopped);
    let table = coordinator.table();
    assert!(table.leased.is_empty());
    assert_eq!(table.given_back.len() + table.accepted.len(), 2);
    assert!(
        table
            .given_back
            .iter()
            .all(|(_, why)| *why == GiveBack::Draining)
    );
    assert!(!table.given_back.is_empty());
}

#[test]
fn a_machine_without_fused_multiply_add_does_not_begin() {
    let coordinator = Coordinator::new(4, 4, Duration::from_secs(30));
    let mut announcement = announcement();
    announcement.machine.instruction_set = InstructionSet::Software;
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let stopped = CancellationToken::new();
    let working = run_over(config(), announcement, Arc::new(coordinator), stopped);
    let error = runtime.block_on(working).expect_err("it must not track");
    assert!(error.to_string().contains("fused multiply-add"), "{error}");
}
