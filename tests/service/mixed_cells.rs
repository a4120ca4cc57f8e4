//! Mixed cells that are too many for planning: workers count them, branch by branch, and follow the
//! paths from them.

use cognate_protocol::v1;
use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::named::cyclic;
use cognate_tests::client::{Answer, Submission, has_ended};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};

fn polyhedral(text: String) -> Submission {
    let mut submission = Submission::of(text);
    submission.options.start = v1::StartKind::Polyhedral.into();
    submission
}

fn cyclic_7() -> Submission {
    let text = formats::write(Format::Bertini, &cyclic(7).system, &FileSettings::default());
    polyhedral(text.expect("systems of our own can be written"))
}

/// A coordinator that counts hardly anything itself, and workers by their widths.
fn cluster(widths: &[Option<u32>], chunk_paths: Option<u64>) -> Cluster {
    let mut cluster = Cluster::start(CoordinatorOptions {
        counting_operations: Some(10),
        chunk_paths,
        ..CoordinatorOptions::default()
    });
    for &lane_width in widths {
        cluster.add_worker(&WorkerOptions {
            lane_width,
            ..WorkerOptions::default()
        });
    }
    cluster
}

/// The answer, and how far each stage came: items, mixed cells.
fn answer(cluster: &Cluster) -> (Answer, Vec<(u64, Option<u64>)>) {
    let client = cluster.client();
    let job = client.submit(&cyclic_7());
    client.wait_until_solved(&job);
    let progress = client.progress_once(&job, "it ended", has_ended);
    let stages = progress.stages.iter();
    let stages = stages.map(|s| (s.accepted, s.mixed_cells)).collect();
    (client.answer(&job), stages)
}

#[test]
fn mixed_cells_are_counted_by_any_workers() {
    let lone = cluster(&[None], None);
    let (expected, stages) = answer(&lone);
    assert_eq!(expected.counts.paths_total, 924);
    assert_eq!(expected.counts.solutions_nonsingular, 924);
    assert_eq!(expected.paths.len(), 924);
    let [(1024, Some(cells)), (924, None), (924, None), ..] = stages[..] else {
        panic!("{stages:?}");
    };
    assert!((100..=924).contains(&cells), "{cells}");
    let explained = lone.command(&["explain", "--format", "json", &lone_job(&lone)]);
    let explained = String::from_utf8_lossy(&explained.stdout).into_owned();
    assert!(explained.contains("counting mixed cells"), "{explained}");
    lone.stop();
    let several = cluster(&[Some(1), Some(8)], Some(50));
    let (several_answer, several_stages) = answer(&several);
    assert_eq!(several_stages, stages);
    assert!(several_answer == expected, "the same answer, bit for bit");
    several.stop();
}

/// The job that a cluster had.
fn lone_job(cluster: &Cluster) -> String {
    let jobs = cluster.client().call(|mut client| async move {
        let request = v1::ListJobsRequest { limit: 1, skip: 0 };
        client.list_jobs(request).await
    });
    let jobs = jobs.expect("the jobs").into_inner().jobs;
    jobs.into_iter().next().expect("there is one").job
}

#[test]
fn a_mixed_volume_that_cannot_be_followed_is_told_by_the_job() {
    let cluster = cluster(&[None], None);
    // Two equations in x alone.
    let text = "variable_group x, y; function f, g; f = x^2 - 3*x + 1; g = x^3 - x + 2;";
    let client = cluster.client();
    let job = client.submit(&polyhedral(text.to_owned()));
    let progress = client.progress_once(&job, "it ended", has_ended);
    assert_eq!(progress.state(), v1::JobState::Failed);
    let message = &progress.message;
    assert!(message.contains("the mixed volume is 0"), "{message}");
    cluster.stop();
}
