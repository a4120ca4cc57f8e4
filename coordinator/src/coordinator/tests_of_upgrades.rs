//! Jobs that run while the program is replaced by one of another version: they end, and their reason says so.

use super::simulation::*;
use super::*;
use crate::ledger::rows::{Advance, JobRow};

/// The program before this one: it has the right to drive jobs for a moment.
fn other_version() -> CoordinatorId {
    CoordinatorId::new("other-version").expect("a good name")
}

/// A coordinator and its worker, who have tracked some paths of a job.
async fn running() -> Cluster {
    let mut cluster = cluster(3, 1);
    cluster.start_coordinator();
    cluster.start_worker();
    cluster.submit(&problem()).await;
    cluster.drive(0).await;
    cluster.pull(0, 0).await;
    cluster.report(0, 0).await;
    assert_eq!(cluster.row().await.state, JobState::Running);
    cluster
}

/// Row of the cluster's job after this coordinator has driven it; the former steward has lost its right.
async fn ended(cluster: &mut Cluster, process: usize) -> JobRow {
    for _ in 0..4 {
        cluster.clock.advance_ms(10_000);
        cluster.drive(process).await;
    }
    cluster.row().await
}

#[tokio::test]
async fn a_job_with_the_state_of_another_version_ends_with_that_reason() {
    let mut cluster = running().await;
    cluster.clock.advance_ms(10_000);
    let state = cluster.store.put_record(&STATE, vec![99u8]).await.unwrap();
    let (job, ledger) = (cluster.job, Arc::clone(&cluster.ledger));
    let epoch = ledger.steward(job, &other_version(), 1).await;
    let step = Advance {
        snapshot: Some(state),
        ..Advance::default()
    };
    let epoch = epoch.unwrap().expect("nobody else has the right");
    ledger.advance(job, epoch, step).await.unwrap();
    let row = ended(&mut cluster, 0).await;
    let reason = row.reason.unwrap_or_default();
    assert_eq!(row.state, JobState::Failed);
    let said =
        "the job's state cannot be read: the snapshot has version 99, this program reads version ";
    assert!(reason.starts_with(said), "{reason}");
}

#[tokio::test]
async fn a_job_with_the_plan_of_another_version_ends_with_that_reason() {
    let mut cluster = running().await;
    let mut asked = cluster.row().await.asked;
    asked.options[0] += 1;
    let request = RequestId::new("before-the-upgrade").expect("a good name");
    cluster.job = cluster.ledger.submit(request, asked).await.unwrap().job;
    // The first coordinator drives the other job.
    cluster.start_coordinator();
    let row = ended(&mut cluster, 1).await;
    assert_eq!(row.state, JobState::Failed);
    let said = "the job's state cannot be read: the plan of the job cannot be read: it is of another version";
    assert_eq!(row.reason.as_deref(), Some(said));
}
