//! Scaling: how many workers there should be, and what to do about it. Plain decisions only.

use cognate_protocol::v1::WorkerOverview;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Size and speed that the user asks of the fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wishes {
    /// Number of workers that stay even when there is nothing to do.
    pub least: u32,
    /// Largest number of workers, started or waiting in the queue.
    pub most: u32,
    /// Time in which the present backlog is to be done.
    pub finish_within: Duration,
}

/// Work that is left: unfinished jobs, and their items without a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Backlog {
    /// Jobs that have not ended.
    pub jobs: u64,
    /// Items of theirs, of all stages that are open, that have no result.
    pub items: u64,
}

/// Where a task of the batch system is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskState {
    /// The task has not begun, or not again.
    Waits,
    /// The task runs, and has time for chunks.
    Runs,
    /// The task ends, or its time is nearly over: it takes no more chunks.
    Leaves,
}

/// One worker in the batch system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Task {
    /// Identifier of the task in the cluster's queue.
    pub id: String,
    /// State of the task.
    pub state: TaskState,
}

/// Observation of the fleet at one time.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Work that is left: unfinished jobs, and their items without a result.
    pub backlog: Backlog,
    /// Items that one worker does in a second, where that is known.
    pub rate: Option<f64>,
    /// The fleet's workers.
    pub tasks: &'a [Task],
}

/// Next action: workers are submitted or withdrawn, or nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Number of workers that are submitted.
    Submit(u32),
    /// Identifiers of workers that have not begun and are not needed.
    Withdraw(Vec<String>),
    /// The number of workers is right.
    Nothing,
}

/// How many workers there should be.
///
/// As many as do the backlog in the time that is wished, at the pace that was measured; one, while
/// nothing is measured. Never more than items.
pub fn wanted(look: &Look<'_>, wishes: &Wishes) -> u32 {
    let Backlog { jobs, items } = look.backlog;
    let needed = match look.rate {
        _ if jobs == 0 => 0,
        // A job that is being planned, or waits for its next stage.
        _ if items == 0 => 1,
        None => 1,
        Some(rate) => {
            let each = (rate * wishes.finish_within.as_secs_f64()).max(f64::MIN_POSITIVE);
            // Saturates, as conversions of floats do.
            (items as f64 / each).ceil().clamp(1.0, items as f64) as u64
        }
    };
    let most = wishes.most.max(wishes.least);
    u32::try_from(needed)
        .unwrap_or(u32::MAX)
        .clamp(wishes.least, most)
}

/// Returns the action that brings the number of tasks to `wanted`. A running worker is never stopped: it ends by itself
/// when it has had no work for a while, and the work it does until then is used.
pub fn step(wanted: u32, tasks: &[Task]) -> Step {
    let here = tasks
        .iter()
        .filter(|t| t.state != TaskState::Leaves)
        .count();
    let wanted = wanted as usize;
    if here < wanted {
        return Step::Submit(u32::try_from(wanted - here).unwrap_or(u32::MAX));
    }
    // The last that came are the last to begin.
    let waiting = tasks.iter().rev().filter(|t| t.state == TaskState::Waits);
    let too_many: Vec<String> = waiting.take(here - wanted).map(|t| t.id.clone()).collect();
    if too_many.is_empty() {
        Step::Nothing
    } else {
        Step::Withdraw(too_many)
    }
}

/// Factor by which the weight of past measurements shrinks each second: half in a minute.
const KEPT_EACH_SECOND: f64 = 0.988_5;

/// How fast workers are: items they finished, over the time that they were seen with work.
#[derive(Debug, Default)]
pub struct Meter {
    last: Option<Instant>,
    known: BTreeMap<String, (u64, bool)>,
    items: f64,
    busy_seconds: f64,
    accepted: u64,
}

impl Meter {
    /// Takes what the coordinator says about its workers at this time.
    pub fn take(&mut self, workers: &[WorkerOverview], now: Instant) {
        let seconds = self.last.map_or(0.0, |last| (now - last).as_secs_f64());
        self.last = Some(now);
        // Not `powf`: the same everywhere.
        let mut kept = 1.0;
        for _ in 0..(seconds.min(3600.0) as u32) {
            kept *= KEPT_EACH_SECOND;
        }
        self.items *= kept;
        self.busy_seconds *= kept;
        for worker in workers {
            let busy = worker.leased_chunks > 0;
            let before = self.known.get(&worker.worker).copied();
            // A counter may begin anew; who is new is only remembered.
            let done = before.map_or(0, |b| worker.accepted_paths.saturating_sub(b.0));
            self.accepted += done;
            if before.is_some_and(|(_, was_busy)| was_busy) || done > 0 {
                self.items += done as f64;
                self.busy_seconds += seconds;
            }
            self.known
                .insert(worker.worker.clone(), (worker.accepted_paths, busy));
        }
        self.known
            .retain(|name, _| workers.iter().any(|w| w.worker == *name));
    }

    /// Items that one worker does in a second; `None` while nobody was seen at work. As if one item
    /// were done now: where items take minutes, the pace falls with the time they take.
    pub fn rate(&self) -> Option<f64> {
        (self.busy_seconds > 0.0).then(|| (self.items + 1.0) / self.busy_seconds)
    }

    /// Items that were seen to be finished since the first look.
    pub fn accepted(&self) -> u64 {
        self.accepted
    }
}

/// The first pause after workers that ended at once.
const FIRST_PAUSE: Duration = Duration::from_secs(30);
/// The longest pause after workers that ended at once: each pause is twice the one before.
const LONGEST_PAUSE: Duration = Duration::from_secs(600);

/// Waits longer each time that workers vanish without having done anything: a wrong path or an
/// expired token would otherwise fill the queue for ever.
#[derive(Debug, Default)]
pub struct Patience {
    last: Option<Submitted>,
    pause: Duration,
    until: Option<Instant>,
}

#[derive(Debug)]
struct Submitted {
    tasks: usize,
    accepted: u64,
}

impl Patience {
    /// Whether more workers may be submitted, at this number of tasks and of finished items.
    pub fn may_submit(&mut self, now: Instant, tasks: usize, accepted: u64) -> bool {
        if let Some(last) = self.last.take() {
            if accepted > last.accepted {
                self.pause = Duration::ZERO;
                self.until = None;
            } else if tasks < last.tasks {
                self.pause = (self.pause * 2).clamp(FIRST_PAUSE, LONGEST_PAUSE);
                self.until = Some(now + self.pause);
            }
        }
        self.until.is_none_or(|until| now >= until)
    }

    /// Records that workers were submitted: the number of tasks now, and of accepted items.
    pub fn submitted(&mut self, tasks: usize, accepted: u64) {
        self.last = Some(Submitted { tasks, accepted });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wishes(least: u32, most: u32) -> Wishes {
        Wishes {
            least,
            most,
            finish_within: Duration::from_secs(600),
        }
    }

    fn tasks(waiting: usize, running: usize, leaving: usize) -> Vec<Task> {
        let tasks_in = |state, count| std::iter::repeat_n(state, count);
        let states = tasks_in(TaskState::Runs, running)
            .chain(tasks_in(TaskState::Leaves, leaving))
            .chain(tasks_in(TaskState::Waits, waiting));
        let named = states.enumerate();
        named
            .map(|(k, state)| Task {
                id: format!("7_{k}"),
                state,
            })
            .collect()
    }

    fn look(jobs: u64, items: u64, rate: Option<f64>) -> Look<'static> {
        Look {
            backlog: Backlog { jobs, items },
            rate,
            tasks: &[],
        }
    }

    #[test]
    fn as_many_as_finish_in_time() {
        let wishes = wishes(0, 100);
        assert_eq!(wanted(&look(0, 0, None), &wishes), 0);
        assert_eq!(wanted(&look(0, 0, Some(5.0)), &wishes), 0);
        assert_eq!(wanted(&look(1, 0, Some(5.0)), &wishes), 1, "it is planned");
        assert_eq!(
            wanted(&look(1, 1_000_000, None), &wishes),
            1,
            "one to measure"
        );
        // 60,000 items at 10 a second and worker: ten workers for ten minutes.
        assert_eq!(wanted(&look(3, 60_000, Some(10.0)), &wishes), 10);
        assert_eq!(wanted(&look(3, 60_001, Some(10.0)), &wishes), 11);
        assert_eq!(wanted(&look(1, u64::MAX, Some(1e-9)), &wishes), 100);
        assert_eq!(wanted(&look(1, 5, Some(1e-9)), &wishes), 5, "one each");
    }

    #[test]
    fn never_fewer_nor_more_than_wished() {
        assert_eq!(wanted(&look(0, 0, None), &wishes(2, 4)), 2);
        assert_eq!(wanted(&look(1, 9_000_000, Some(1.0)), &wishes(2, 4)), 4);
        assert_eq!(wanted(&look(1, 9_000_000, Some(1.0)), &wishes(0, 0)), 0);
    }

    #[test]
    fn who_leaves_is_replaced_and_who_waits_in_vain_is_withdrawn() {
        assert_eq!(step(4, &tasks(1, 2, 0)), Step::Submit(1));
        assert_eq!(step(3, &tasks(1, 2, 0)), Step::Nothing);
        assert_eq!(step(3, &tasks(0, 2, 2)), Step::Submit(1));
        // The two that came last of three that wait.
        let withdrawn = Step::Withdraw(vec!["7_4".into(), "7_3".into()]);
        assert_eq!(step(3, &tasks(3, 2, 0)), withdrawn);
        // A running worker is not stopped.
        assert_eq!(step(1, &tasks(0, 2, 0)), Step::Nothing);
        assert_eq!(step(0, &tasks(1, 2, 0)), Step::Withdraw(vec!["7_2".into()]));
    }

    fn at_work(name: &str, accepted_paths: u64) -> WorkerOverview {
        WorkerOverview {
            worker: name.into(),
            accepted_paths,
            leased_chunks: 1,
            ..WorkerOverview::default()
        }
    }

    #[test]
    fn the_pace_is_measured() {
        let begin = Instant::now();
        let after = |s| begin + Duration::from_secs(s);
        let mut meter = Meter::default();
        meter.take(&[at_work("a", 1000), at_work("b", 0)], begin);
        assert_eq!(meter.rate(), None);
        meter.take(&[at_work("a", 1500), at_work("b", 300)], after(10));
        let rate = meter.rate().unwrap();
        assert!((39.0..42.0).contains(&rate), "800 in twice 10 s: {rate}");
        assert_eq!(meter.accepted(), 800);
        // Nothing for a long time: items that take long. Then nobody at all.
        let mut slow = Meter::default();
        for s in [0, 60, 120] {
            slow.take(&[at_work("a", 7)], after(s));
        }
        let rate = slow.rate().unwrap();
        assert!(
            (0.008..0.02).contains(&rate),
            "at most one a minute: {rate}"
        );
        slow.take(&[], after(130));
        slow.take(&[at_work("a", 0)], after(140));
        assert_eq!(slow.accepted(), 0, "a counter that begins anew");
    }

    #[test]
    fn workers_that_end_at_once_are_not_submitted_for_ever() {
        let begin = Instant::now();
        let after = |s| begin + Duration::from_secs(s);
        let mut patience = Patience::default();
        assert!(patience.may_submit(begin, 0, 0));
        patience.submitted(4, 0);
        assert!(!patience.may_submit(after(10), 0, 0));
        assert!(!patience.may_submit(after(39), 0, 0));
        assert!(patience.may_submit(after(41), 0, 0));
        patience.submitted(4, 0);
        assert!(!patience.may_submit(after(51), 1, 0));
        assert!(!patience.may_submit(after(110), 1, 0), "twice as long");
        assert!(patience.may_submit(after(112), 1, 0));
        // They wait in the queue, and more are wanted.
        patience.submitted(4, 0);
        assert!(patience.may_submit(after(122), 4, 0));
        // They worked, and ended.
        patience.submitted(8, 0);
        assert!(patience.may_submit(after(132), 0, 50));
    }
}
