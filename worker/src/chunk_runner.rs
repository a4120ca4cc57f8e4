//! Chunk runner: a chunk in, its path results out, in the order of the items.
//!
//! The range is cut into pieces, which the threads of a pool take first come,
//! first served; pieces of a later chunk follow, so that no core idles at a
//! chunk's end. Paths are pure, so neither cut nor thread shows in the results.

use cognate_continuation::item_result::ItemResult;
use cognate_numeric::interruption::Interruption;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Something that tracks the items of one stage; pure and blocking.
pub trait ChunkTracker: Send + Sync {
    /// One result for each item, in order; the same at every width.
    fn track(&self, items: Range<u64>, width: usize) -> Vec<ItemResult>;
    /// How many items there are; a chunk is a range below it.
    fn items(&self) -> u64;
    /// The width that suits the size of the stage's program and matrix.
    fn preferred_width(&self) -> usize;
}

/// Tells a running chunk that nobody wants it any more.
#[derive(Clone, Debug, Default)]
pub struct Abandonment(Interruption);

impl Abandonment {
    /// Stops the chunk: no further piece of it is begun, and the paths under way end.
    pub fn abandon(&self) {
        self.0.interrupt();
    }

    /// Whether the chunk was abandoned.
    pub fn is_abandoned(&self) -> bool {
        self.0.is_interrupted()
    }
}

/// A chunk that was tracked to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedChunk {
    /// One result for each item, in order.
    pub results: Vec<ItemResult>,
    /// Processor time that it took, of all threads together.
    pub cpu: Duration,
    /// Time from its first piece's beginning to its last piece's end.
    pub wall: Duration,
}

/// How a chunk ended.
#[derive(Clone, Debug, PartialEq)]
pub enum ChunkEnd {
    /// Every item has a result.
    Tracked(TrackedChunk),
    /// The chunk was abandoned before its last piece.
    Abandoned,
    /// A broken invariant: the panic's message.
    Panicked(String),
}

/// The threads that track, and how many lanes each of them uses.
pub struct ChunkRunner {
    pool: rayon::ThreadPool,
    threads: usize,
    width: Option<usize>,
}

/// Pieces of one chunk are at most this many times the width: calling a chunk off takes effect
/// after one piece, and 64 keeps the lanes' common tail (a few paths' length) below 3 %.
const LARGEST_PIECE_PER_LANE: u64 = 64;
/// Least paths per lane of a piece where a chunk is cut into more pieces than threads: with fewer, the time in which
/// a piece's last lanes run alone outweighs an even end.
const SMALLEST_PIECE_PER_LANE: u64 = 8;

/// Cuts a chunk for `threads` threads of `width` lanes; the pieces follow one another.
fn pieces(items: Range<u64>, threads: usize, width: usize) -> Vec<Range<u64>> {
    let count = items.end.saturating_sub(items.start);
    let (threads, width) = (threads.max(1) as u64, width.max(1) as u64);
    let even = count.div_ceil(threads).max(1);
    let fine = count.div_ceil(4 * threads);
    let size = even
        .min(fine.max(SMALLEST_PIECE_PER_LANE * width))
        .min(LARGEST_PIECE_PER_LANE * width);
    let mut cut = Vec::new();
    let mut first = items.start;
    while first < items.end {
        let end = first.saturating_add(size).min(items.end);
        cut.push(first..end);
        first = end;
    }
    cut
}

/// State that the pieces of a running chunk share.
struct Running {
    tracker: Arc<dyn ChunkTracker>,
    width: usize,
    abandonment: Abandonment,
    progress: Mutex<Progress>,
}

struct Progress {
    results: Vec<Option<Vec<ItemResult>>>,
    open: usize,
    first_begin: Option<Instant>,
    cpu: Duration,
    panicked: Option<String>,
    on_end: Option<Box<dyn FnOnce(ChunkEnd) + Send>>,
}

impl ChunkRunner {
    /// Starts the threads. `width` of `None` leaves the width to each stage.
    pub fn new(threads: usize, width: Option<usize>) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|number| format!("track-{number}"))
            .build()?;
        Ok(Self {
            threads: pool.current_num_threads(),
            pool,
            width,
        })
    }

    /// Number of threads that track.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Begins a chunk and returns; `on_end` is called once, on a tracking thread.
    pub fn start(
        &self,
        tracker: Arc<dyn ChunkTracker>,
        items: Range<u64>,
        abandonment: Abandonment,
        on_end: impl FnOnce(ChunkEnd) + Send + 'static,
    ) {
        let width = self.width.unwrap_or_else(|| tracker.preferred_width());
        let pieces = pieces(items, self.threads, width);
        if pieces.is_empty() {
            on_end(ChunkEnd::Tracked(TrackedChunk {
                results: Vec::new(),
                cpu: Duration::ZERO,
                wall: Duration::ZERO,
            }));
            return;
        }
        let running = Arc::new(Running {
            tracker,
            width,
            abandonment,
            progress: Mutex::new(Progress {
                results: pieces.iter().map(|_| None).collect(),
                open: pieces.len(),
                first_begin: None,
                cpu: Duration::ZERO,
                panicked: None,
                on_end: Some(Box::new(on_end)),
            }),
        });
        for (number, piece) in pieces.into_iter().enumerate() {
            let running = Arc::clone(&running);
            self.pool
                .spawn_fifo(move || running.track_piece(number, piece));
        }
    }

    /// Tracks a chunk and waits for its end.
    pub fn run(&self, tracker: Arc<dyn ChunkTracker>, items: Range<u64>) -> ChunkEnd {
        let (sender, receiver) = std::sync::mpsc::channel();
        self.start(tracker, items, Abandonment::default(), move |end| {
            // The receiver waits below; it cannot be gone.
            let _ = sender.send(end);
        });
        receiver
            .recv()
            .expect("every chunk that was started ends with one call of `on_end`")
    }
}

impl Running {
    fn track_piece(&self, number: usize, piece: Range<u64>) {
        let begin = Instant::now();
        let cpu_begin = thread_cpu_time();
        let expected = piece.end - piece.start;
        let outcome = if self.abandonment.is_abandoned() {
            None
        } else {
            Some(catch_unwind(AssertUnwindSafe(|| {
                let track = || self.tracker.track(piece, self.width);
                let results = self.abandonment.0.run(track);
                assert!(
                    results.len() as u64 == expected,
                    "a tracker gives one result for each item"
                );
                results
            })))
        };
        let cpu = thread_cpu_time().saturating_sub(cpu_begin);
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.cpu += cpu;
        progress.open -= 1;
        progress.first_begin = Some(progress.first_begin.map_or(begin, |first| first.min(begin)));
        match outcome {
            None => {}
            // Paths that were ended have no results.
            Some(Ok(_)) if self.abandonment.is_abandoned() => {}
            Some(Ok(results)) => progress.results[number] = Some(results),
            Some(Err(panic)) => {
                progress.panicked = Some(panic_message(&*panic));
                // The other pieces would be for nothing.
                self.abandonment.abandon();
            }
        }
        if progress.open > 0 {
            return;
        }
        let end = progress.end();
        let on_end = progress.on_end.take();
        drop(progress);
        if let Some(on_end) = on_end {
            on_end(end);
        }
    }
}

impl Progress {
    fn end(&mut self) -> ChunkEnd {
        if let Some(message) = self.panicked.take() {
            return ChunkEnd::Panicked(message);
        }
        let pieces = std::mem::take(&mut self.results);
        match pieces.into_iter().collect::<Option<Vec<_>>>() {
            None => ChunkEnd::Abandoned,
            Some(pieces) => ChunkEnd::Tracked(TrackedChunk {
                results: pieces.into_iter().flatten().collect(),
                cpu: self.cpu,
                wall: self.first_begin.map_or(Duration::ZERO, |b| b.elapsed()),
            }),
        }
    }
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without a message".to_owned())
}

/// Time that this thread has run on a processor, by the clock: the kernel's statistics are only
/// brought up to date now and then, and a short chunk would cost nothing.
fn thread_cpu_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    let seconds = u64::try_from(now.tv_sec).unwrap_or(0);
    let nanoseconds = u64::try_from(now.tv_nsec).unwrap_or(0);
    Duration::from_secs(seconds) + Duration::from_nanos(nanoseconds)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use cognate_continuation::path_result::{PathIndex, PathResult};
    use cognate_continuation::tracker::outcome::PathOutcome;
    use num_complex::Complex64;

    /// A result that is a function of its item alone.
    pub(crate) fn result_of(item: u64) -> ItemResult {
        let point = vec![Complex64::new(item as f64, 0.5)];
        ItemResult::Track(PathResult {
            residual: 0.0,
            condition: 1.0,
            accuracy: 1e-15,
            ..PathResult::untracked(item, 0, PathOutcome::Regular, point)
        })
    }

    /// Knows nothing but the items; breaks at one of them if told.
    pub(crate) struct Echo {
        pub(crate) breaks_at: Option<u64>,
        pub(crate) slow: Duration,
    }

    impl ChunkTracker for Echo {
        fn track(&self, items: Range<u64>, _: usize) -> Vec<ItemResult> {
            std::thread::sleep(self.slow);
            assert!(
                !self.breaks_at.is_some_and(|item| items.contains(&item)),
                "told to break"
            );
            items.map(result_of).collect()
        }

        fn items(&self) -> u64 {
            u64::MAX
        }

        fn preferred_width(&self) -> usize {
            8
        }
    }

    fn echo(breaks_at: Option<u64>, slow: Duration) -> Arc<dyn ChunkTracker> {
        Arc::new(Echo { breaks_at, slow })
    }

    #[test]
    fn pieces_cover_the_range_once() {
        for count in [0u64, 1, 7, 16, 17, 128, 1000, 100_000] {
            for threads in [1usize, 2, 3, 16] {
                for width in [1usize, 8, 16] {
                    let cut = pieces(5..5 + count, threads, width);
                    let mut next = 5;
                    for piece in &cut {
                        assert_eq!(piece.start, next);
                        assert!(piece.end > piece.start);
                        assert!(piece.end - piece.start <= 64 * width as u64);
                        next = piece.end;
                    }
                    assert_eq!(next, 5 + count);
                }
            }
        }
        assert_eq!(
            pieces(0..64, 2, 16),
            vec![0..32, 32..64],
            "no more than threads"
        );
        assert_eq!(
            pieces(u64::MAX - 3..u64::MAX, 1, 8).len(),
            1,
            "no overflow at the end"
        );
    }

    #[test]
    fn results_come_in_the_order_of_the_items() {
        for threads in [1, 2, 5] {
            for width in [None, Some(1), Some(16)] {
                let runner = ChunkRunner::new(threads, width).unwrap();
                for items in [0..0, 3..4, 0..1000, 90..333] {
                    let expected: Vec<_> = items.clone().map(result_of).collect();
                    let ChunkEnd::Tracked(chunk) = runner.run(echo(None, Duration::ZERO), items)
                    else {
                        panic!("the chunk must be tracked");
                    };
                    assert_eq!(chunk.results, expected);
                }
            }
        }
    }

    #[test]
    fn a_panic_is_a_value_and_the_runner_goes_on() {
        let runner = ChunkRunner::new(2, None).unwrap();
        let end = runner.run(echo(Some(77), Duration::ZERO), 0..100);
        assert_eq!(end, ChunkEnd::Panicked("told to break".to_owned()));
        assert!(matches!(
            runner.run(echo(None, Duration::ZERO), 0..100),
            ChunkEnd::Tracked(_)
        ));
    }

    #[test]
    fn an_abandoned_chunk_ends_soon_and_gives_nothing() {
        let runner = ChunkRunner::new(1, Some(1)).unwrap();
        let abandonment = Abandonment::default();
        let (sender, receiver) = std::sync::mpsc::channel();
        let begin = Instant::now();
        runner.start(
            echo(None, Duration::from_millis(20)),
            0..640_000,
            abandonment.clone(),
            move |end| sender.send(end).unwrap(),
        );
        abandonment.abandon();
        assert_eq!(receiver.recv().unwrap(), ChunkEnd::Abandoned);
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "10,000 pieces would take 200 s"
        );
    }

    #[test]
    fn two_chunks_share_the_threads() {
        let runner = ChunkRunner::new(3, None).unwrap();
        let (sender, receiver) = std::sync::mpsc::channel();
        for number in 0..10u64 {
            let sender = sender.clone();
            let items = number * 100..(number + 1) * 100;
            runner.start(
                echo(None, Duration::from_millis(1)),
                items,
                Abandonment::default(),
                move |end| sender.send((number, end)).unwrap(),
            );
        }
        drop(sender);
        let mut numbers = Vec::new();
        for (number, end) in receiver {
            let ChunkEnd::Tracked(chunk) = end else {
                panic!("chunk {number} must be tracked");
            };
            assert_eq!(chunk.results.len(), 100);
            assert_eq!(chunk.results[0].origin(), PathIndex(number * 100));
            numbers.push(number);
        }
        numbers.sort_unstable();
        assert_eq!(numbers, (0..10).collect::<Vec<_>>());
    }
}
