//! Any number of workers, any width, any size of chunks: the same answer, bit for bit.

use cognate_tests::builders::{example, katsura};
use cognate_tests::client::{Answer, Submission};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};

/// Workers by their widths; one thread each, the last one with two.
fn answer(text: &str, widths: &[Option<u32>], chunk_paths: Option<u64>) -> Answer {
    let options = CoordinatorOptions {
        lease: None,
        chunk_paths,
        ..CoordinatorOptions::default()
    };
    let mut cluster = Cluster::start(options);
    for (number, &lane_width) in widths.iter().enumerate() {
        cluster.add_worker(&WorkerOptions {
            threads: 1 + usize::from(number + 1 == widths.len()),
            lane_width,
            ..WorkerOptions::default()
        });
    }
    let answer = cluster.client().solve(&Submission::of(text));
    cluster.stop();
    answer
}

fn check(text: &str, paths: u64, solutions: u64) {
    let expected = answer(text, &[None], None);
    assert_eq!(expected.counts.paths_total, paths);
    assert_eq!(expected.counts.solutions_nonsingular, solutions);
    assert_eq!(expected.paths.len() as u64, paths);
    let splits: [(&[Option<u32>], Option<u64>); 5] = [
        (&[Some(1)], Some(paths)),
        (&[Some(8)], Some(7)),
        (&[Some(16), Some(16)], Some(16)),
        (&[Some(1), Some(8), Some(16)], Some(13)),
        (&[None, None, None], Some(1)),
    ];
    for (widths, chunk_paths) in splits {
        let split_answer = answer(text, widths, chunk_paths);
        assert!(
            split_answer == expected,
            "widths {widths:?}, {chunk_paths:?} paths in a chunk: another answer"
        );
    }
}

#[test]
fn a_platform_with_singular_endpoints_is_the_same_in_any_split() {
    check(&example("stewart_gough_dietmaier.bertini"), 128, 40);
}

#[test]
fn katsura_is_the_same_in_any_split() {
    check(&katsura(7), 128, 128);
}
