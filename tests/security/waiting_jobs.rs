//! Jobs that only wait cost next to nothing, and neither does who looks at them (rows 12 and 13).

use cognate_tests::builders::square_root_of_two;
use cognate_tests::client::Submission;
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// Number of waiting jobs: they took a sixth of a core when each was looked at every second.
const JOBS: usize = 400;
/// Largest cost of the waiting jobs, in cores.
const CORES: f64 = 0.05;
/// Length of the measurement.
const MEASURED: Duration = Duration::from_secs(6);
/// Longest time for a read of all metrics.
const SCRAPE: Duration = Duration::from_millis(500);

fn metrics(address: &str) -> String {
    let mut connection = TcpStream::connect(address).expect("the metrics are served");
    let request = b"GET /metrics HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";
    connection.write_all(request).expect("it takes a request");
    let mut answer = String::new();
    connection
        .read_to_string(&mut answer)
        .expect("it answers in text");
    answer
}

#[test]
fn waiting_jobs_cost_next_to_nothing() {
    let free = TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr());
    let address = free.expect("a port is free").to_string();
    let cluster = Cluster::start(CoordinatorOptions {
        metrics: Some(address.clone()),
        ..CoordinatorOptions::default()
    });
    let client = cluster.client();
    for _ in 0..JOBS {
        client.submit(&Submission::of(square_root_of_two()));
    }
    // Work that began with the last of these jobs ends.
    std::thread::sleep(Duration::from_secs(2));
    let (before, began) = (cluster.coordinator.cpu_seconds(), Instant::now());
    std::thread::sleep(MEASURED);
    let used = cluster.coordinator.cpu_seconds() - before;
    let cores = used / began.elapsed().as_secs_f64();
    println!("{JOBS} jobs that wait: {:.1} % of a core", 100.0 * cores);
    assert!(cores < CORES, "{cores} cores for {JOBS} jobs that wait");

    let began = Instant::now();
    let answer = metrics(&address);
    let took = began.elapsed();
    println!("metrics: {} ms", took.as_millis());
    assert!(answer.contains("cognate_jobs{"), "{answer}");
    assert!(took < SCRAPE, "{took:?}");
    let listed = cluster.command(&["jobs"]);
    assert_eq!(listed.status.code(), Some(0), "{listed:?}");
    cluster.stop();
}
