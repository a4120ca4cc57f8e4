//! A disk that fills up in the middle: the service stays, says why, loses nothing, and goes on when there is room
//! again. Shared memory between workers and a coordinator is tested in this way, too.

use crate::worker_lost::{begun, nervous, problem, quiet_answer, slow_worker, stuck};
use cognate_tests::client::{accepted, has_ended, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::namespaces::SmallDisk;
use cognate_tests::processes::until;
use std::path::Path;
use std::time::Duration;

#[test]
fn a_full_disk_stops_nothing_for_good() {
    let expected = quiet_answer();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let Some(disk) = SmallDisk::mount(folder.path(), 48) else {
        return;
    };
    let mut cluster = Cluster::start(CoordinatorOptions {
        data: Some(folder.path().to_owned()),
        within: disk.within(),
        ..nervous()
    });
    let (client, job) = begun(&mut cluster);
    disk.fill();
    let said = |what: &str| cluster.coordinator.log().to_lowercase().contains(what);
    until("the coordinator says what is wrong", || {
        (said("no space left") || said("disk is full")).then_some(())
    });
    stuck(&client, &job);
    assert_eq!(client.workers().len(), 2);
    std::thread::sleep(Duration::from_secs(1));
    let still = client.progress(&job).expect("it still answers");
    assert!(!has_ended(&still), "{still:?}");
    disk.clear();
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    let end = client.progress(&job).expect("the job is known");
    assert_eq!(accepted(&end), total(&end));
    let counted: u64 = client.workers().iter().map(|w| w.accepted_paths).sum();
    assert_eq!(counted, total(&end), "each path was accepted once");
    cluster.stop();
    drop(disk);
}

#[test]
fn shared_memory_that_fills_up_is_left_for_grpc() {
    let expected = quiet_answer();
    let Some(memory) = SmallDisk::mount(Path::new("/dev/shm"), 64) else {
        return;
    };
    let mut cluster = Cluster::start(CoordinatorOptions {
        within: memory.within(),
        ..nervous()
    });
    for _ in 0..2 {
        cluster.add_worker(&WorkerOptions {
            transport: Some("shared-memory"),
            within: memory.within(),
            ..slow_worker()
        });
    }
    let client = cluster.client();
    until("both work by shared memory", || {
        let by = |w: &cognate_tests::processes::Process| w.log().contains("by shared memory");
        cluster.workers.iter().all(by).then_some(())
    });
    let job = client.submit(&problem());
    let before = client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 100);
    memory.fill();
    assert!(
        accepted(&before) < total(&before),
        "there was a middle: {before:?}"
    );
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    for worker in &mut cluster.workers {
        assert!(worker.is_alive(), "nobody dies of it");
    }
    memory.clear();
    cluster.stop();
}
