//! The session against a simulated coordinator: single rules first, then seeded random lives
//! with slow networks, lost answers, outages and frozen processes.

use super::*;
use crate::transport::tests::lease;
use cognate_numeric::random::{Purpose, RandomStream};
use std::collections::BTreeSet;

fn at(milliseconds: u64) -> Moment {
    Moment(Duration::from_millis(milliseconds))
}

fn milliseconds(count: u64) -> Duration {
    Duration::from_millis(count)
}

fn limits() -> Limits {
    Limits {
        chunks_at_once: 2,
        unacknowledged: 4,
        poll: milliseconds(20_000),
        heartbeat: milliseconds(10_000),
        end: None,
        wind_up: milliseconds(30_000),
        idle_timeout: None,
        give_up_after: None,
        drain_patience: milliseconds(5_000),
        backoff: Backoff::default(),
    }
}

fn grant(chunk: u64, lasts: u64) -> Grant {
    Grant {
        lease: lease(chunk),
        lasts: milliseconds(lasts),
        alone: false,
    }
}

/// A session that has pulled chunks 1 and 2 at 0 ms, leased for 1 s.
fn with_two_chunks(limits: Limits) -> Session<&'static str> {
    let mut session = Session::new(limits, at(0));
    let pull = Command::Pull {
        sequence: 1,
        free: 2,
        wait: milliseconds(20_000),
    };
    assert_eq!(session.poll(at(0)), [pull]);
    session.handle(Input::Pulled(vec![grant(1, 1000), grant(2, 1000)]), at(5));
    let track = [Command::Track(lease(1)), Command::Track(lease(2))];
    assert_eq!(session.poll(at(5)), track);
    session
}

#[test]
fn a_chunk_is_pulled_tracked_reported_and_forgotten() {
    let mut session = with_two_chunks(limits());
    session.handle(Input::Tracked(lease(1), "one"), at(100));
    let pull = Command::Pull {
        sequence: 2,
        free: 1,
        wait: milliseconds(20_000),
    };
    let report = Command::Report(lease(1), Arc::new("one"));
    assert_eq!(session.poll(at(100)), [report, pull]);
    session.handle(Input::Reported(lease(1), Receipt::Accepted), at(110));
    assert_eq!(session.poll(at(110)), []);
    assert_eq!(session.held(), 1);
}

#[test]
fn leases_are_renewed_and_a_lost_one_is_left_alone() {
    let mut session = with_two_chunks(limits());
    assert_eq!(session.wake_at(), Some(at(250)), "a quarter of the lease");
    assert_eq!(
        session.poll(at(250)),
        [Command::Renew(vec![lease(1), lease(2)])]
    );
    let answer = vec![
        (lease(1), Renewal::Held(milliseconds(1000))),
        (lease(2), Renewal::Lost),
    ];
    session.handle(Input::Renewed(answer), at(300));
    let commands = session.poll(at(300));
    assert_eq!(commands[0], Command::Abandon(lease(2)));
    assert!(matches!(commands[1], Command::Pull { free: 1, .. }));
    assert_eq!(
        session.wake_at(),
        Some(at(500)),
        "counted from when the renewal was made"
    );
}

#[test]
fn a_worker_that_cannot_renew_fences_itself_before_the_lease_ends() {
    let mut session = with_two_chunks(limits());
    let mut now = at(5);
    let mut abandoned = 0;
    while abandoned < 2 {
        assert!(now < at(2_000), "nothing is fenced");
        now = session.wake_at().unwrap();
        for command in session.poll(now) {
            match command {
                Command::Renew(_) => session.handle(Input::RenewFailed, now),
                Command::Pull { .. } => session.handle(Input::PullFailed, now),
                Command::Abandon(_) => abandoned += 1,
                other => panic!("{other:?}"),
            }
        }
    }
    assert_eq!(
        now,
        at(900),
        "nine tenths of the lease, counted from when the pull was made"
    );
}

#[test]
fn a_finished_chunk_is_reported_even_after_its_lease() {
    let mut session = with_two_chunks(limits());
    session.handle(Input::Tracked(lease(1), "one"), at(10));
    session.poll(at(10));
    session.handle(Input::ReportFailed(lease(1)), at(10));
    session.handle(Input::PullFailed, at(10));
    let late = at(60_000);
    let commands = session.poll(late);
    assert!(commands.contains(&Command::Report(lease(1), Arc::new("one"))));
    assert!(commands.contains(&Command::Abandon(lease(2))));
    assert!(
        !commands
            .iter()
            .any(|command| matches!(command, Command::Renew(_)))
    );
}

#[test]
fn a_grant_that_was_long_under_way_is_confirmed_before_it_is_begun() {
    let mut session = Session::<()>::new(limits(), at(0));
    session.poll(at(0));
    session.handle(Input::Pulled(vec![grant(1, 1000)]), at(15_000));
    let commands = session.poll(at(15_000));
    assert_eq!(commands[0], Command::Renew(vec![lease(1)]));
    assert!(!commands.contains(&Command::Track(lease(1))));
    let held = Renewal::Held(milliseconds(1000));
    session.handle(Input::Renewed(vec![(lease(1), held)]), at(15_002));
    assert_eq!(session.poll(at(15_002)), [Command::Track(lease(1))]);
}

#[test]
fn a_pull_without_an_answer_is_made_again_under_its_number() {
    let mut session = Session::<()>::new(limits(), at(0));
    session.poll(at(0));
    session.handle(Input::PullFailed, at(1));
    assert_eq!(session.poll(at(1)), [], "not at once");
    let retry_time = session.wake_at().unwrap();
    let sequences = |commands: &[Command<()>]| match commands {
        [Command::Pull { sequence, .. }] => *sequence,
        other => panic!("{other:?}"),
    };
    assert_eq!(sequences(&session.poll(retry_time)), 1);
    session.handle(Input::Pulled(Vec::new()), retry_time);
    let next = session.wake_at().unwrap();
    assert!(
        next > retry_time,
        "an empty answer is no reason to ask in a loop"
    );
    assert_eq!(sequences(&session.poll(next)), 2);
}

#[test]
fn a_busy_worker_is_heard_of() {
    let mut session = with_two_chunks(limits());
    let mut now = at(5);
    for _ in 0..1000 {
        now = session.wake_at().unwrap();
        for command in session.poll(now) {
            match command {
                Command::Renew(leases) => {
                    let held = Renewal::Held(milliseconds(1000));
                    let answer = leases.into_iter().map(|lease| (lease, held)).collect();
                    session.handle(Input::Renewed(answer), now);
                }
                Command::Pull { free, wait, .. } => {
                    assert_eq!((free, wait), (0, Duration::ZERO));
                    assert_eq!(now, at(10_000));
                    return;
                }
                other => panic!("{other:?}"),
            }
        }
    }
    panic!("no heartbeat until {now:?}");
}

#[test]
fn pulling_stops_while_too_many_results_wait_for_their_receipt() {
    let limits = Limits {
        unacknowledged: 2,
        ..limits()
    };
    let mut session = with_two_chunks(limits);
    session.handle(Input::Tracked(lease(1), "one"), at(10));
    let commands = session.poll(at(10));
    assert!(
        commands
            .iter()
            .any(|c| matches!(c, Command::Pull { free: 1, .. }))
    );
    session.handle(Input::Tracked(lease(2), "two"), at(11));
    session.handle(Input::Pulled(Vec::new()), at(12));
    let commands = session.poll(at(500));
    assert!(
        !commands.iter().any(|c| matches!(c, Command::Pull { .. })),
        "{commands:?}"
    );
}

#[test]
fn draining_gives_back_what_is_unfinished_and_reports_the_rest() {
    let mut session = with_two_chunks(limits());
    session.handle(Input::Tracked(lease(1), "one"), at(10));
    session.poll(at(10));
    session.handle(Input::Drain, at(20));
    assert_eq!(
        session.poll(at(20)),
        [
            Command::CancelPull,
            Command::Abandon(lease(2)),
            Command::GiveBack(lease(2), GiveBack::Draining),
        ]
    );
    // A grant that crossed the drain goes back, too.
    session.handle(Input::Pulled(vec![grant(3, 1000)]), at(21));
    assert_eq!(
        session.poll(at(21)),
        [Command::GiveBack(lease(3), GiveBack::Draining)]
    );
    session.handle(Input::GaveBack(lease(2)), at(22));
    session.handle(Input::GaveBack(lease(3)), at(22));
    assert_eq!(session.poll(at(22)), [], "a report is still under way");
    session.handle(Input::Reported(lease(1), Receipt::Accepted), at(23));
    assert_eq!(session.poll(at(23)), [Command::Leave]);
    session.handle(Input::Left, at(24));
    assert_eq!(session.poll(at(24)), [Command::Exit(Ending::Stopped)]);
    assert_eq!(session.wake_at(), None);
}

#[test]
fn draining_does_not_wait_for_a_dead_coordinator() {
    let mut session = with_two_chunks(limits());
    session.handle(Input::Drain, at(20));
    session.poll(at(20));
    let mut now = at(20);
    loop {
        assert!(now < at(60_000), "it waits for ever");
        now = session.wake_at().unwrap_or(now);
        let commands = session.poll(now);
        if commands.contains(&Command::Exit(Ending::Stopped)) {
            break;
        }
        for command in commands {
            match command {
                Command::GiveBack(lease, _) => session.handle(Input::GiveBackFailed(lease), now),
                Command::Leave => {}
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(now <= at(5_020));
}

#[test]
fn an_untrackable_chunk_is_given_back_with_its_reason() {
    let mut session = with_two_chunks(limits());
    session.handle(
        Input::Untrackable(lease(1), "no program".to_owned()),
        at(10),
    );
    let commands = session.poll(at(10));
    let failed = GiveBack::Failed("no program".to_owned());
    assert_eq!(commands[0], Command::GiveBack(lease(1), failed));
    assert!(
        matches!(commands[1], Command::Pull { free: 1, .. }),
        "the worker goes on"
    );
    // The tracking of the chunk may still end; nothing is reported then.
    session.handle(Input::Tracked(lease(1), "late"), at(11));
    assert_eq!(session.poll(at(11)), []);
}

#[test]
fn a_report_that_makes_no_sense_is_a_failure_of_its_chunk() {
    let mut session = with_two_chunks(limits());
    session.handle(Input::Tracked(lease(1), "one"), at(10));
    session.poll(at(10));
    let invalid = Receipt::Invalid("too long".to_owned());
    session.handle(Input::Reported(lease(1), invalid), at(11));
    let failed = GiveBack::Failed("too long".to_owned());
    assert_eq!(session.poll(at(11)), [Command::GiveBack(lease(1), failed)]);
}

#[test]
fn a_suspected_chunk_runs_alone() {
    let mut session = Session::new(limits(), at(0));
    session.poll(at(0));
    let suspected = Grant {
        alone: true,
        ..grant(2, 100_000)
    };
    session.handle(Input::Pulled(vec![grant(1, 100_000), suspected]), at(1));
    assert_eq!(session.poll(at(1)), [Command::Track(lease(1))]);
    session.handle(Input::Tracked(lease(1), "one"), at(2));
    let report = Command::Report(lease(1), Arc::new("one"));
    let commands = session.poll(at(2));
    assert_eq!(
        commands,
        [Command::Track(lease(2)), report],
        "and nothing is pulled"
    );
    session.handle(Input::Tracked(lease(2), "two"), at(3));
    let commands = session.poll(at(3));
    assert!(matches!(
        commands[..],
        [Command::Report(..), Command::Pull { free: 2, .. }]
    ));
}

#[test]
fn ends_are_kept() {
    let idle = Limits {
        idle_timeout: Some(milliseconds(700)),
        ..limits()
    };
    check_end(idle, false, Ending::Idle, at(700));
    let wall = Limits {
        end: Some(at(60_000)),
        ..limits()
    };
    check_end(wall, false, Ending::WallTime, at(30_000));
    let unreachable = Limits {
        give_up_after: Some(milliseconds(3_000)),
        ..limits()
    };
    check_end(unreachable, true, Ending::Unreachable, at(3_000));
}

/// A worker that never gets a chunk, from a coordinator that is dead or has none.
fn check_end(limits: Limits, dead: bool, expected: Ending, when: Moment) {
    let mut session = Session::<()>::new(limits, at(0));
    let mut now = at(0);
    loop {
        assert!(now < at(120_000), "it never ends");
        for command in session.poll(now) {
            match command {
                Command::Pull { .. } if dead => session.handle(Input::PullFailed, now),
                Command::Pull { .. } | Command::CancelPull => {}
                Command::Leave => session.handle(Input::Left, now),
                Command::Exit(ending) => {
                    assert_eq!((ending, now), (expected, when));
                    return;
                }
                other => panic!("{other:?}"),
            }
        }
        now = session.wake_at().map_or(now, |wake| wake.max(now));
    }
}

#[test]
fn a_refused_worker_ends_with_the_reason() {
    let mut session = Session::<()>::new(limits(), at(0));
    session.poll(at(0));
    session.handle(Input::Refused("old".to_owned()), at(3));
    assert_eq!(session.poll(at(3)), [Command::Leave]);
    session.handle(Input::Left, at(4));
    let refused = Ending::Refused("old".to_owned());
    assert_eq!(session.poll(at(4)), [Command::Exit(refused)]);
}

// ---- a whole life under a simulated coordinator ----

#[derive(Clone, Copy, Debug, PartialEq)]
enum Row {
    Ready,
    Leased { until: Moment },
    Accepted,
}

/// The rows of a stage's chunks, kept as the ledger keeps them.
struct ChunkRows {
    rows: Vec<(Row, u64)>,
    lasts: Duration,
    accepted: u64,
    stale: u64,
}

impl ChunkRows {
    fn named(chunk: usize, epoch: u64) -> LeaseId {
        LeaseId {
            epoch,
            ..lease(chunk as u64)
        }
    }

    fn expire(&mut self, now: Moment) {
        for (row, _) in &mut self.rows {
            if matches!(*row, Row::Leased { until } if until <= now) {
                *row = Row::Ready;
            }
        }
    }

    fn holds(&self, lease: &LeaseId) -> bool {
        let (row, epoch) = self.rows[lease.chunk as usize];
        matches!(row, Row::Leased { .. }) && epoch == lease.epoch
    }

    fn answer(&mut self, call: &Command<u64>, now: Moment) -> Input<u64> {
        self.expire(now);
        let until = now + self.lasts;
        match call {
            Command::Pull { free, .. } => {
                let mut grants = Vec::new();
                for (chunk, (row, epoch)) in self.rows.iter_mut().enumerate() {
                    if *row == Row::Ready && grants.len() < *free {
                        *row = Row::Leased { until };
                        *epoch += 1;
                        grants.push(Grant {
                            lease: Self::named(chunk, *epoch),
                            lasts: self.lasts,
                            alone: chunk % 7 == 3,
                        });
                    }
                }
                Input::Pulled(grants)
            }
            Command::Renew(leases) => {
                let renewals = leases.iter().map(|lease| {
                    if self.holds(lease) {
                        self.rows[lease.chunk as usize].0 = Row::Leased { until };
                        (lease.clone(), Renewal::Held(self.lasts))
                    } else {
                        (lease.clone(), Renewal::Lost)
                    }
                });
                Input::Renewed(renewals.collect())
            }
            Command::Report(lease, content) => {
                assert_eq!(**content, lease.chunk, "the results are those of the chunk");
                let (row, epoch) = &mut self.rows[lease.chunk as usize];
                let receipt = match *row {
                    Row::Leased { .. } if *epoch == lease.epoch => {
                        *row = Row::Accepted;
                        self.accepted += 1;
                        Receipt::Accepted
                    }
                    Row::Accepted if *epoch == lease.epoch => Receipt::AlreadyAccepted,
                    _ => {
                        self.stale += 1;
                        Receipt::Stale
                    }
                };
                Input::Reported(lease.clone(), receipt)
            }
            Command::GiveBack(lease, _) => {
                if self.holds(lease) {
                    self.rows[lease.chunk as usize].0 = Row::Ready;
                }
                Input::GaveBack(lease.clone())
            }
            Command::Leave => Input::Left,
            other => panic!("no call: {other:?}"),
        }
    }
}

fn failure(call: &Command<u64>) -> Input<u64> {
    match call {
        Command::Pull { .. } => Input::PullFailed,
        Command::Renew(_) => Input::RenewFailed,
        Command::Report(lease, _) => Input::ReportFailed(lease.clone()),
        Command::GiveBack(lease, _) => Input::GiveBackFailed(lease.clone()),
        Command::Leave => Input::Left,
        other => panic!("no call: {other:?}"),
    }
}

/// An event to come: calls that arrive at the coordinator, answers that arrive at the worker.
enum Future {
    Arrives(Command<u64>),
    Happens(Input<u64>),
}

#[derive(Default)]
struct Tally {
    fenced: u64,
    stale: u64,
}

/// A worker's life under the simulated coordinator.
struct Life {
    seed: u64,
    /// Whether the first minute has outages, lost replies and frozen processes.
    trouble: bool,
    random: RandomStream,
    rows: ChunkRows,
    session: Session<u64>,
    future: BTreeMap<(Moment, u64), Future>,
    /// Number of the latest event, so that events of one moment keep their order.
    number: u64,
    now: Moment,
    /// Leases whose chunks are tracked, and when their tracking ends.
    tracking: BTreeMap<LeaseId, Moment>,
    begun: BTreeSet<LeaseId>,
    drained: bool,
    /// Calls that are under way.
    pulls: u64,
    renewals: u64,
    fenced: u64,
}

impl Life {
    fn new(seed: u64, trouble: bool) -> Self {
        let mut random = RandomStream::new(seed, Purpose::Test, 0);
        let chunks = 1 + random.below(12) as usize;
        let rows = ChunkRows {
            rows: vec![(Row::Ready, 0); chunks],
            lasts: milliseconds(400 + random.below(2000)),
            accepted: 0,
            stale: 0,
        };
        Self {
            seed,
            trouble,
            random,
            rows,
            session: Session::new(limits(), at(0)),
            future: BTreeMap::new(),
            number: 0,
            now: at(0),
            tracking: BTreeMap::new(),
            begun: BTreeSet::new(),
            drained: false,
            pulls: 0,
            renewals: 0,
            fenced: 0,
        }
    }

    /// Trouble lasts for a minute: every third stretch of 1.5 s is an outage, replies are lost,
    /// the process is frozen. Afterwards everything must come to rest.
    fn is_troubled(&self, moment: Moment) -> bool {
        self.trouble && moment < at(60_000)
    }

    fn is_outage(&self, moment: Moment) -> bool {
        let stretch = moment.0.as_millis() as u64 / 1500;
        self.is_troubled(moment)
            && RandomStream::new(self.seed, Purpose::Test, 1 + stretch).below(3) == 0
    }

    fn all_accepted(&self) -> bool {
        self.rows.accepted == self.rows.rows.len() as u64
    }

    fn schedule(&mut self, moment: Moment, event: Future) {
        self.number += 1;
        self.future.insert((moment, self.number), event);
    }

    /// Time that a call or an answer is under way.
    fn network_delay(&mut self) -> Duration {
        milliseconds(self.random.below(if self.trouble { 120 } else { 10 }))
    }

    fn carry_out(&mut self, command: Command<u64>) {
        match command {
            Command::Track(lease) => self.track(lease),
            Command::Abandon(lease) => self.abandon(&lease),
            Command::CancelPull => assert!(self.drained),
            call => self.send(call),
        }
    }

    fn track(&mut self, lease: LeaseId) {
        let Self { seed, now, .. } = *self;
        let duration = milliseconds(self.random.below(if self.trouble { 3000 } else { 300 }));
        let tracked = Input::Tracked(lease.clone(), lease.chunk);
        self.schedule(now + duration, Future::Happens(tracked));
        self.tracking.insert(lease.clone(), now + duration);
        assert!(
            self.begun.insert(lease),
            "seed {seed}: a lease is begun once"
        );
    }

    fn abandon(&mut self, lease: &LeaseId) {
        let seed = self.seed;
        // It may have ended in the same moment.
        self.fenced += u64::from(self.tracking.remove(lease).is_some());
        assert!(
            self.begun.contains(lease),
            "seed {seed}: only what was begun is abandoned"
        );
        assert!(
            self.trouble || self.drained,
            "seed {seed}: without trouble nothing is abandoned"
        );
    }

    fn send(&mut self, call: Command<u64>) {
        let seed = self.seed;
        match &call {
            Command::Pull { free, .. } => {
                self.pulls += 1;
                assert!(
                    !self.drained && self.pulls == 1,
                    "seed {seed}: one pull at a time"
                );
                assert!(*free + self.tracking.len() <= 2, "seed {seed}");
            }
            Command::Renew(_) => {
                self.renewals += 1;
                assert_eq!(self.renewals, 1, "seed {seed}: one renewal at a time");
            }
            _ => {}
        }
        let delay = self.network_delay();
        self.schedule(self.now + delay, Future::Arrives(call));
    }

    /// A chunk that is tracked is leased: nobody else can have got it, by any clock.
    fn check_leases(&self) {
        let Self { seed, now, .. } = *self;
        for (lease, end) in &self.tracking {
            assert!(
                self.rows.holds(lease) || *end <= now,
                "seed {seed}: {lease} runs though it is another's"
            );
        }
    }

    /// Goes on to the moment of the next event, or past it if the process is frozen.
    fn advance(&mut self) {
        let Self { seed, now, .. } = *self;
        let wake = self.session.wake_at();
        assert!(
            wake.is_none_or(|wake| wake > now),
            "seed {seed}: {wake:?} is not after {now:?}"
        );
        let next_event = self.future.keys().next().map(|key| key.0);
        let Some(next) = wake.into_iter().chain(next_event).min() else {
            panic!("seed {seed}: nothing will ever happen");
        };
        self.now = now.max(next);
        if self.is_troubled(self.now) && self.random.below(40) == 0 {
            // The process is frozen: it wakes late, and everything has gone on without it.
            self.now = self.now + milliseconds(self.random.below(4000));
        }
        self.rows.expire(self.now);
    }

    /// Events up to now, each in its turn.
    fn let_happen(&mut self) {
        while let Some(entry) = self.future.first_entry() {
            let when = entry.key().0;
            if when > self.now {
                break;
            }
            match entry.remove() {
                Future::Happens(input) => self.hear(input),
                Future::Arrives(call) => self.answer(&call, when),
            }
        }
    }

    fn hear(&mut self, input: Input<u64>) {
        if let Input::Tracked(lease, _) = &input
            && self.tracking.remove(lease).is_none()
        {
            // It was abandoned: its threads stopped.
            return;
        }
        self.pulls -= u64::from(matches!(input, Input::Pulled(_) | Input::PullFailed));
        self.renewals -= u64::from(matches!(input, Input::Renewed(_) | Input::RenewFailed));
        self.session.handle(input, self.now);
    }

    fn answer(&mut self, call: &Command<u64>, when: Moment) {
        let answer = if self.is_outage(when) {
            failure(call)
        } else {
            self.rows.answer(call, when)
        };
        // A reply can be lost although the call was done.
        let lost_reply = self.is_troubled(when) && self.random.below(8) == 0;
        let answer = if lost_reply { failure(call) } else { answer };
        let delay = self.network_delay();
        self.schedule(when + delay, Future::Happens(answer));
    }

    fn check_end(&self) {
        let seed = self.seed;
        assert!(self.drained, "seed {seed}: only a drained worker ends");
        assert_eq!(
            self.rows.accepted,
            self.rows.rows.len() as u64,
            "seed {seed}"
        );
        let mut rows = self.rows.rows.iter();
        assert!(rows.all(|(row, _)| *row == Row::Accepted));
    }
}

/// One life: a worker tracks chunks until all are accepted, then it is drained.
fn live(seed: u64, trouble: bool, tally: &mut Tally) {
    let mut life = Life::new(seed, trouble);
    for turn in 0.. {
        assert!(turn < 200_000, "seed {seed}: the life does not end");
        for command in life.session.poll(life.now) {
            if let Command::Exit(_) = command {
                life.check_end();
                tally.fenced += life.fenced;
                tally.stale += life.rows.stale;
                return;
            }
            life.carry_out(command);
        }
        life.check_leases();
        if !life.drained && life.all_accepted() && !life.is_troubled(life.now) {
            life.drained = true;
            life.session.handle(Input::Drain, life.now);
            continue;
        }
        life.advance();
        life.let_happen();
    }
}

#[test]
fn every_chunk_is_accepted_once_in_quiet_lives() {
    let mut tally = Tally::default();
    for seed in 0..300 {
        live(seed, false, &mut tally);
    }
    assert_eq!((tally.fenced, tally.stale), (0, 0));
}

#[test]
fn every_chunk_is_accepted_once_in_troubled_lives() {
    let mut tally = Tally::default();
    for seed in 0..300 {
        live(seed, true, &mut tally);
    }
    // The trouble was real: leases were lost and late reports came.
    assert!(tally.fenced > 100, "{}", tally.fenced);
    assert!(tally.stale > 10, "{}", tally.stale);
}
