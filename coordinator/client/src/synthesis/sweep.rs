//! Sweeps: many sets of nine points, in jobs of some sets each, answered set after set.

use super::{Answer, How, SEED, carry_out, preset, run, submission};
use crate::connection::Target;
use crate::error::ClientError;
use crate::output::progress::Progress;
use cognate_kinematics::nine_point::{PathPoints, Search};
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
    // Real solutions are asked of a whole job, so a batch holds only real or only complex sets.
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

/// Runs one job for the first round of some sets, and then the open rounds of each set.
async fn follow(
    target: &Target,
    batch: &[(String, PathPoints)],
    how: &How,
) -> Result<Vec<Answer>, ClientError> {
    // The first round is the same for every set: one job follows it to all of them.
    let mut searches: Vec<Search> = batch
        .iter()
        .map(|(_, points)| Search::new(points))
        .collect();
    let mut starts = Vec::new();
    for search in &mut searches {
        let round = search.next_round().expect("a search begins with a round");
        starts = round.starts;
    }
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
    for (mut search, (_, points)) in searches.into_iter().zip(batch) {
        let later = ends.split_off(&starts.len());
        search.absorb(ends);
        // Paths are numbered through all sets.
        let of_the_next = |(path, arrival)| (path - starts.len(), arrival);
        ends = later.into_iter().map(of_the_next).collect();
        answers.push(carry_out(target, points, how, &mut quiet, search).await?);
    }
    Ok(answers)
}
