//! Session: what the worker does next. Pull, renew, track, report, fence itself, drain.
//!
//! Pure: inputs and the time come in, commands go out; no socket, clock or
//! thread. The shell (`shell.rs`) carries the commands out.

use crate::reports::Reports;
use crate::retry::{Backoff, Moment, Retry};
use crate::transport::{GiveBack, LeaseId, Receipt, Renewal};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// The numbers that the session decides by; `Config` says where each comes from.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Chunks that may be unfinished at once.
    pub chunks_at_once: usize,
    /// Finished chunks that may wait for their receipt before pulling stops.
    pub unacknowledged: usize,
    /// How long a pull may wait at the coordinator.
    pub poll: Duration,
    /// Longest time between two calls of a worker without free slots, which show that it is alive.
    pub heartbeat: Duration,
    /// Time at which the process must have ended.
    pub end: Option<Moment>,
    /// Time before `end` from which no chunk is pulled any more.
    pub wind_up: Duration,
    /// Time without work after which the worker ends.
    pub idle_timeout: Option<Duration>,
    /// Time without an answer after which the worker ends.
    pub give_up_after: Option<Duration>,
    /// How long a draining worker goes on trying to give back and report.
    pub drain_patience: Duration,
    /// Pauses after calls without an answer.
    pub backoff: Backoff,
}

/// A lease as it came: it ends `lasts` after the coordinator granted it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grant {
    /// Lease of the chunk.
    pub lease: LeaseId,
    /// Duration of the lease from the moment of granting.
    pub lasts: Duration,
    /// The chunk is suspected to kill its worker: nothing else may be lost with it.
    pub alone: bool,
}

/// An event that the session reacts to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input<C> {
    /// A pull was answered.
    Pulled(Vec<Grant>),
    /// A pull was not answered.
    PullFailed,
    /// The coordinator will never give this worker a chunk.
    Refused(String),
    /// A renewal was answered, lease by lease.
    Renewed(Vec<(LeaseId, Renewal)>),
    /// A renewal was not answered.
    RenewFailed,
    /// A chunk was tracked to its end.
    Tracked(LeaseId, C),
    /// A chunk cannot be tracked here, and why.
    Untrackable(LeaseId, String),
    /// Objects that a chunk needs have been unavailable for a while, and why.
    Unfetched(LeaseId, String),
    /// A report was answered.
    Reported(LeaseId, Receipt),
    /// A report was not answered.
    ReportFailed(LeaseId),
    /// A chunk was given back.
    GaveBack(LeaseId),
    /// Giving it back was not answered.
    GiveBackFailed(LeaseId),
    /// The goodbye was answered, or not: it is said once.
    Left,
    /// Someone wants the worker to stop.
    Drain,
}

/// An action that the session asks its owner to take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Command<C> {
    /// Ask for chunks.
    Pull {
        /// Number of the pull; the same after one without an answer.
        sequence: u64,
        /// Number of chunks that there is room for.
        free: usize,
        /// How long the coordinator may wait for some.
        wait: Duration,
    },
    /// Forget the pull that is on its way.
    CancelPull,
    /// Keep these leases.
    Renew(Vec<LeaseId>),
    /// Begin this chunk.
    Track(LeaseId),
    /// Stop working on this chunk; its result is not wanted.
    Abandon(LeaseId),
    /// Hand in this finished chunk.
    Report(LeaseId, Arc<C>),
    /// Give this chunk back.
    GiveBack(LeaseId, GiveBack),
    /// Say goodbye.
    Leave,
    /// The process ends.
    Exit(Ending),
}

/// Why a worker ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// A signal told the worker to stop.
    Stopped,
    /// The worker's wall time is over.
    WallTime,
    /// The worker had nothing to do for too long.
    Idle,
    /// No coordinator answered for too long.
    Unreachable,
    /// The coordinator refuses the worker, and why.
    Refused(String),
}

/// Where a held chunk stands.
enum Step {
    /// The answer took as long as the lease lasts: renewed before it is begun.
    Confirming,
    /// To be begun as soon as nothing forbids it: a chunk that is to run alone does.
    Waiting,
    /// On the threads.
    Tracking,
    /// Finished; `Reports` keeps it. The lease is renewed until the receipt, or until it is lost.
    Reporting,
    /// On its way back.
    GivingBack(GiveBack, Retry),
}

struct Held {
    step: Step,
    /// The lease is known to have been valid at this moment: when the call that was answered was made.
    since: Moment,
    lasts: Duration,
    alone: bool,
}

impl Held {
    /// A tenth of the lease is kept back, so that the chunk is off the threads when the lease ends.
    fn fence(&self) -> Moment {
        self.since + (self.lasts - self.lasts / 10)
    }

    /// At once where the lease is in doubt; else so early that two renewals may fail.
    fn renew_at(&self) -> Moment {
        match self.step {
            Step::Confirming => Moment::default(),
            _ => self.since + self.lasts / 4,
        }
    }

    fn is_unfinished(&self) -> bool {
        matches!(self.step, Step::Confirming | Step::Waiting | Step::Tracking)
    }

    fn is_renewed(&self) -> bool {
        !matches!(self.step, Step::GivingBack(..))
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Phase {
    Working,
    /// Chunks in hand are finished, and no new ones are begun.
    WindingUp,
    Draining {
        ending: Ending,
        until: Moment,
        leaving: bool,
    },
    Ended,
}

/// The state of a worker's conversation with its coordinator.
pub struct Session<C> {
    limits: Limits,
    phase: Phase,
    held: BTreeMap<LeaseId, Held>,
    reports: Reports<C>,
    pull: Retry,
    pull_sequence: u64,
    /// When the pull of this sequence was first made: leases in its answer are no older.
    pull_first_made: Option<Moment>,
    last_pull: Moment,
    renewal: Retry,
    renewal_made: Moment,
    /// Since when there is no work.
    idle_since: Moment,
    /// Since when no call is answered.
    failing_since: Option<Moment>,
    commands: Vec<Command<C>>,
}

impl<C> Session<C> {
    /// A worker that begins now.
    pub fn new(limits: Limits, now: Moment) -> Self {
        Self {
            limits,
            phase: Phase::Working,
            held: BTreeMap::new(),
            reports: Reports::default(),
            pull: Retry::default(),
            pull_sequence: 1,
            pull_first_made: None,
            last_pull: now,
            renewal: Retry::default(),
            renewal_made: now,
            idle_since: now,
            failing_since: None,
            commands: Vec::new(),
        }
    }

    /// Takes note of what happened. `poll` says what follows from it.
    pub fn handle(&mut self, input: Input<C>, now: Moment) {
        match input {
            Input::Pulled(grants) => {
                self.answered();
                let made = self.pull_first_made.take();
                if self.pull.is_in_flight() {
                    self.pull.succeed();
                    self.pull_sequence += 1;
                    if grants.is_empty() {
                        // A coordinator that answers at once with nothing is not asked in a loop.
                        self.pull
                            .rest_until(self.last_pull + self.limits.backoff.first);
                    }
                }
                for grant in grants {
                    self.take(grant, made.unwrap_or(now), now);
                }
            }
            Input::PullFailed => {
                self.unanswered(now);
                if self.pull.is_in_flight() {
                    self.pull.fail(now, &self.limits.backoff);
                }
            }
            Input::Refused(why) => {
                self.answered();
                self.pull.succeed();
                self.begin_draining(Ending::Refused(why), now);
            }
            Input::Renewed(renewals) => {
                self.answered();
                self.renewal.succeed();
                for (lease, renewal) in renewals {
                    self.renewed(&lease, renewal);
                }
            }
            Input::RenewFailed => {
                self.unanswered(now);
                self.renewal.fail(now, &self.limits.backoff);
            }
            Input::Tracked(lease, content) => self.tracked(lease, content),
            Input::Untrackable(lease, why) => {
                if let Some(held) = self.held.get_mut(&lease)
                    && matches!(held.step, Step::Tracking)
                {
                    held.step = Step::GivingBack(GiveBack::Failed(why), Retry::default());
                }
            }
            Input::Unfetched(lease, why) => {
                if let Some(held) = self.held.get_mut(&lease)
                    && matches!(held.step, Step::Tracking)
                {
                    held.step = Step::GivingBack(GiveBack::Unfetched(why), Retry::default());
                }
            }
            Input::Reported(lease, receipt) => {
                self.answered();
                self.reports.answered(&lease);
                match (receipt, self.held.get_mut(&lease)) {
                    // The chunk is still leased, and its results are of no use: a failure of the chunk.
                    (Receipt::Invalid(why), Some(held)) => {
                        held.step = Step::GivingBack(GiveBack::Failed(why), Retry::default());
                    }
                    _ => {
                        self.held.remove(&lease);
                    }
                }
            }
            Input::ReportFailed(lease) => {
                self.unanswered(now);
                self.reports.failed(&lease, now, &self.limits.backoff);
            }
            Input::GaveBack(lease) => {
                self.answered();
                self.held.remove(&lease);
            }
            Input::GiveBackFailed(lease) => {
                self.unanswered(now);
                if let Some(held) = self.held.get_mut(&lease)
                    && let Step::GivingBack(_, retry) = &mut held.step
                {
                    retry.fail(now, &self.limits.backoff);
                }
            }
            Input::Left => {
                if let Phase::Draining { ending, .. } = &self.phase {
                    let exit = Command::Exit(ending.clone());
                    self.commands.push(exit);
                    self.phase = Phase::Ended;
                }
            }
            Input::Drain => self.begin_draining(Ending::Stopped, now),
        }
    }

    /// Commands that are due now. Call it after every input, and at `wake_at`.
    pub fn poll(&mut self, now: Moment) -> Vec<Command<C>> {
        if self.phase != Phase::Ended {
            self.fence(now);
            self.change_phase(now);
            self.begin_waiting();
            self.renew(now);
            let due = self.reports.send_due(now).into_iter();
            let due = due.map(|(lease, content)| Command::Report(lease, content));
            self.commands.extend(due);
            self.give_back(now);
            self.pull(now);
            self.leave(now);
        }
        std::mem::take(&mut self.commands)
    }

    /// When `poll` is to be called even if nothing happens. Not in the past once `poll` was called.
    pub fn wake_at(&self) -> Option<Moment> {
        if self.phase == Phase::Ended {
            return None;
        }
        let mut moments = vec![self.reports.due_at()];
        for held in self.held.values() {
            moments.push(match &held.step {
                Step::GivingBack(_, retry) => Some(
                    retry
                        .due_at()
                        .map_or(held.fence(), |due| due.min(held.fence())),
                ),
                _ => Some(held.fence()),
            });
        }
        if let Some(due) = self.renewal.due_at() {
            let first = self.renewed_chunks().map(Held::renew_at).min();
            moments.push(first.map(|at| at.max(due)));
        }
        match &self.phase {
            Phase::Working => {
                if let Some(due) = self.pull.due_at() {
                    let heartbeat = self.last_pull + self.limits.heartbeat;
                    moments.push(Some(if self.free_slots() > 0 {
                        due
                    } else {
                        due.max(heartbeat)
                    }));
                }
                moments.push(self.idle_at());
                moments.push(self.wind_up_at());
                moments.push(self.give_up_at());
            }
            Phase::WindingUp => {
                moments.push(self.drain_at());
                moments.push(self.give_up_at());
            }
            Phase::Draining { until, .. } => moments.push(Some(*until)),
            Phase::Ended => {}
        }
        moments.into_iter().flatten().min()
    }

    /// How many chunks are held, finished ones without a receipt among them.
    pub fn held(&self) -> usize {
        self.held.len()
    }

    fn answered(&mut self) {
        self.failing_since = None;
    }

    fn unanswered(&mut self, now: Moment) {
        self.failing_since.get_or_insert(now);
    }

    fn take(&mut self, grant: Grant, since: Moment, now: Moment) {
        if self.held.contains_key(&grant.lease) || self.reports.contains(&grant.lease) {
            // The answer to a pull that was made twice.
            return;
        }
        let mut held = Held {
            step: Step::Confirming,
            since,
            lasts: grant.lasts,
            alone: grant.alone,
        };
        if self.phase != Phase::Working {
            held.step = Step::GivingBack(GiveBack::Draining, Retry::default());
        } else if now < held.fence() {
            held.step = Step::Waiting;
        } else {
            // Long under way: whether it is still ours is asked first. The fence counts from now,
            // because nothing is tracked until the renewal's answer sets it right.
            held.since = now;
        }
        self.held.insert(grant.lease, held);
    }

    fn renewed(&mut self, lease: &LeaseId, renewal: Renewal) {
        let Some(held) = self.held.get_mut(lease) else {
            return;
        };
        match (renewal, &held.step) {
            (_, Step::GivingBack(..)) => {}
            (Renewal::Held(lasts), step) => {
                let confirmed = matches!(step, Step::Confirming);
                held.since = self.renewal_made;
                held.lasts = lasts;
                if confirmed {
                    held.step = Step::Waiting;
                }
            }
            (Renewal::Lost, Step::Reporting) => {
                // Perhaps it was accepted and the reply was lost: the report says so.
                self.held.remove(lease);
            }
            (Renewal::Lost, Step::Confirming | Step::Waiting) => {
                self.held.remove(lease);
            }
            (Renewal::Lost, Step::Tracking) => {
                self.held.remove(lease);
                self.commands.push(Command::Abandon(lease.clone()));
            }
        }
    }

    fn tracked(&mut self, lease: LeaseId, content: C) {
        // A chunk that was abandoned or given back in the meantime is not held as `Tracking`.
        if let Some(held) = self.held.get_mut(&lease)
            && matches!(held.step, Step::Tracking)
        {
            held.step = Step::Reporting;
            self.reports.keep(lease, content);
        }
    }

    /// Leaves alone whatever could not be renewed in time: another worker may have it.
    fn fence(&mut self, now: Moment) {
        let commands = &mut self.commands;
        self.held.retain(|lease, held| {
            if now < held.fence() {
                return true;
            }
            if matches!(held.step, Step::Tracking) {
                commands.push(Command::Abandon(lease.clone()));
            }
            // A finished chunk's report stays in `reports`; only its lease is not renewed any more.
            false
        });
    }

    fn change_phase(&mut self, now: Moment) {
        if !self.held.is_empty() || !self.reports.is_empty() {
            self.idle_since = now;
        }
        let passed = |moment: Option<Moment>| moment.is_some_and(|moment| now >= moment);
        if self.phase == Phase::Working && passed(self.wind_up_at()) {
            self.phase = Phase::WindingUp;
        }
        let nothing_left = self.held.is_empty() && self.reports.is_empty();
        if self.phase == Phase::WindingUp && (passed(self.drain_at()) || nothing_left) {
            self.begin_draining(Ending::WallTime, now);
        }
        if self.phase == Phase::Working && passed(self.idle_at()) {
            self.begin_draining(Ending::Idle, now);
        }
        if passed(self.give_up_at()) {
            self.begin_draining(Ending::Unreachable, now);
        }
    }

    /// Begins what waits, a chunk that is to run alone only when nothing else runs.
    fn begin_waiting(&mut self) {
        let tracking = |held: &&Held| matches!(held.step, Step::Tracking);
        let mut running = self.held.values().filter(tracking).count();
        let mut alone = self.held.values().filter(tracking).any(|held| held.alone);
        for (lease, held) in &mut self.held {
            if matches!(held.step, Step::Waiting) && !alone && (running == 0 || !held.alone) {
                held.step = Step::Tracking;
                running += 1;
                alone = held.alone;
                self.commands.push(Command::Track(lease.clone()));
            }
        }
    }

    fn begin_draining(&mut self, ending: Ending, now: Moment) {
        if matches!(self.phase, Phase::Draining { .. } | Phase::Ended) {
            return;
        }
        self.cancel_pull();
        for (lease, held) in &mut self.held {
            if matches!(held.step, Step::Tracking) {
                self.commands.push(Command::Abandon(lease.clone()));
            }
            if held.is_unfinished() {
                held.step = Step::GivingBack(GiveBack::Draining, Retry::default());
            }
        }
        let patience = match ending {
            // Nobody is there to give anything back to.
            Ending::Unreachable => Duration::ZERO,
            _ => self.limits.drain_patience,
        };
        self.phase = Phase::Draining {
            ending,
            until: now + patience,
            leaving: false,
        };
    }

    fn cancel_pull(&mut self) {
        if self.pull.is_in_flight() {
            self.commands.push(Command::CancelPull);
        }
    }

    fn renewed_chunks(&self) -> impl Iterator<Item = &Held> {
        self.held.values().filter(|held| held.is_renewed())
    }

    fn renew(&mut self, now: Moment) {
        let due = self.renewed_chunks().any(|held| now >= held.renew_at());
        if !due || !self.renewal.is_due(now) {
            return;
        }
        let renewed = self.held.iter().filter(|(_, held)| held.is_renewed());
        let leases = renewed.map(|(lease, _)| lease.clone()).collect();
        self.renewal.begin();
        self.renewal_made = now;
        self.commands.push(Command::Renew(leases));
    }

    fn give_back(&mut self, now: Moment) {
        for (lease, held) in &mut self.held {
            if let Step::GivingBack(why, retry) = &mut held.step
                && retry.is_due(now)
            {
                retry.begin();
                let command = Command::GiveBack(lease.clone(), why.clone());
                self.commands.push(command);
            }
        }
    }

    fn free_slots(&self) -> usize {
        let unfinished = self.held.values().filter(|held| held.is_unfinished());
        let (mut count, mut alone) = (0, false);
        for held in unfinished {
            count += 1;
            alone |= held.alone;
        }
        let at_once = if alone { 0 } else { self.limits.chunks_at_once };
        let for_work = at_once.saturating_sub(count);
        let for_results = self
            .limits
            .unacknowledged
            .saturating_sub(self.reports.len());
        for_work.min(for_results)
    }

    fn pull(&mut self, now: Moment) {
        let free = self.free_slots();
        let heartbeat = now >= self.last_pull + self.limits.heartbeat;
        if self.phase != Phase::Working || !self.pull.is_due(now) || (free == 0 && !heartbeat) {
            return;
        }
        self.pull.begin();
        self.pull_first_made.get_or_insert(now);
        self.last_pull = now;
        self.commands.push(Command::Pull {
            sequence: self.pull_sequence,
            free,
            wait: if free > 0 {
                self.limits.poll
            } else {
                Duration::ZERO
            },
        });
    }

    fn leave(&mut self, now: Moment) {
        let Phase::Draining {
            ending,
            until,
            leaving,
        } = &mut self.phase
        else {
            return;
        };
        if now >= *until {
            self.commands.push(Command::Exit(ending.clone()));
            self.phase = Phase::Ended;
        } else if !*leaving && self.held.is_empty() && self.reports.is_empty() {
            *leaving = true;
            self.commands.push(Command::Leave);
        }
    }

    fn idle_at(&self) -> Option<Moment> {
        let working = !self.held.is_empty() || !self.reports.is_empty();
        let timeout = self.limits.idle_timeout.filter(|_| !working)?;
        Some(self.idle_since + timeout)
    }

    fn wind_up_at(&self) -> Option<Moment> {
        self.limits.end.map(|end| end - self.limits.wind_up)
    }

    fn drain_at(&self) -> Option<Moment> {
        self.limits.end.map(|end| end - self.limits.drain_patience)
    }

    fn give_up_at(&self) -> Option<Moment> {
        let draining = matches!(self.phase, Phase::Draining { .. } | Phase::Ended);
        let limit = self.limits.give_up_after.filter(|_| !draining)?;
        self.failing_since.map(|since| since + limit)
    }
}

#[cfg(test)]
mod tests;
