//! Sweeps: many sets of nine points, in jobs of some sets each, answered set after set.

use super::{Answer, How, SEED, Search, preset, run, submission};
use crate::client::connection::Target;
use crate::client::error::ClientError;
use crate::client::output::progress::Progress;
use cognate_kinematics::nine_point::class_book::Arrival;
use cognate_kinematics::nine_point::family::CLASSES;
use cognate_kinematics::nine_point::{ClassBook, PathPoints, Point};
use futures::StreamExt;

/// Sets in one job: enough paths to keep many workers busy, few enough that answers come soon.
const SETS_A_JOB: usize = 40;

/// Jobs under way at once: while one ends, the next is followed.
const JOBS: usize = 3;

/// Follows all classes to every set, and hands the answers over in the order of the sets.
pub async fn sweep(
    target: &Target,
    sets: &[(String, PathPoints)],
    how: &How,
    mut take: impl FnMut(usize, Answer) -> Result<(), ClientError>,
) -> Result<(), ClientError> {
    // What is real is asked of a whole job.
    let alike = sets.chunk_by(|(_, one), (_, two)| one.is_real() == two.is_real());
    let batches = alike.flat_map(|sets| sets.chunks(SETS_A_JOB));
    let batches = batches.map(|batch| follow(target, batch, how));
    let mut answers = futures::stream::iter(batches).buffered(JOBS);
    let mut place = 0;
    while let Some(batch) = answers.next().await {
        for answer in batch? {
            take(place, answer)?;
            place += 1;
        }
    }
    Ok(())
}

/// One job for some sets, and what is open of each afterwards.
async fn follow(
    target: &Target,
    batch: &[(String, PathPoints)],
    how: &How,
) -> Result<Vec<Answer>, ClientError> {
    let first = ClassBook::first_round();
    let books: Vec<ClassBook> = batch
        .iter()
        .map(|(_, points)| ClassBook::new(points.parameters()))
        .collect();
    let starts: Vec<Point> = first.iter().map(|&member| books[0].start(member)).collect();
    let targets: Vec<_> = batch
        .iter()
        .map(|(_, points)| points.parameters())
        .collect();
    let real = batch.iter().all(|(_, points)| points.is_real());
    let seed = how.seed.unwrap_or(SEED);
    let job = submission(&starts, &targets, real, how, seed, preset(how.preset));
    let mut quiet = Progress::silent();
    let (_, mut ends) = run(target, job, &mut quiet).await?;
    let mut answers = Vec::with_capacity(batch.len());
    for (number, (book, (_, points))) in books.into_iter().zip(batch).enumerate() {
        let mut book = book;
        for &member in &first {
            let unknown = || Arrival::Failed("the service says nothing of its path".into());
            let path = number * CLASSES + member.class;
            book.note(member, ends.remove(&path).unwrap_or_else(unknown));
        }
        let search = Search::new(target, points, how, &mut quiet);
        answers.push(search.settle(book).await?);
    }
    Ok(answers)
}
