//! The third attack on the service (2026-11), by its letters: lost objects (D), uploads (E), the page's connections (K).

use crate::support::{FOUR_POINTS, House, MANY_PATHS, durable_config, text};
use cognate_coordinator::config::Config;
use cognate_coordinator::ledger::identity::JobId;
use cognate_coordinator::ledger::rows::StageRow;
use cognate_coordinator::server::Server;
use cognate_protocol::v1;
use std::path::PathBuf;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpSocket, TcpStream};

/// Far longer than anything here takes: a test that hangs ends.
const HANGS: Duration = Duration::from_secs(120);

/// Stages of a job once it has some.
async fn stages(house: &House, job: &str) -> Vec<StageRow> {
    let job: JobId = job.parse().unwrap();
    let opened = async {
        loop {
            let stages = house.server.coordinator().ledger().stages(job).await;
            let stages = stages.unwrap();
            if !stages.is_empty() {
                return stages;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    };
    tokio::time::timeout(HANGS, opened).await.expect("a stage")
}

/// The file of an object.
fn object(house: &House, digest: &str) -> PathBuf {
    let objects = house.folder.path().join("data/results/objects");
    objects.join(&digest[..2]).join(digest)
}

async fn ends(client: &mut crate::support::Client, job: &str) -> v1::JobProgress {
    client.watch(job).await.pop().unwrap()
}

/// D: a stage whose object is lost or flipped is made again, and no other job waits for it.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_lost_stage_is_made_again() {
    for damage in ["lost", "flipped"] {
        let house = House::durable(tempfile::tempdir().unwrap()).await;
        let mut client = house.client().await;
        let sick = client.submit("sick", text(MANY_PATHS)).await.unwrap();
        let stage = stages(&house, &sick).await.remove(0);
        let file = object(&house, &stage.definition.to_string());
        let mut bytes = std::fs::read(&file).unwrap();
        match damage {
            "lost" => std::fs::remove_file(&file).unwrap(),
            _ => {
                bytes[20] ^= 4;
                std::fs::write(&file, &bytes).unwrap();
                bytes[20] ^= 4;
            }
        }
        let other = client.submit("other", text(FOUR_POINTS)).await.unwrap();
        let worker = house.worker("worker");
        for job in [&other, &sick] {
            let end = ends(&mut client, job).await;
            let solved = i32::from(v1::JobState::Solved);
            assert_eq!(end.state, solved, "{damage}: {}", end.message);
        }
        assert_eq!(std::fs::read(&file).unwrap(), bytes, "{damage}");
        worker.stop().await;
        house.server.shutdown().await;
    }
}

/// D: a job whose objects are lost for good fails by name; no other job waits for it.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_cannot_be_made_again_fails_by_name() {
    let house = House::durable(tempfile::tempdir().unwrap()).await;
    let mut client = house.client().await;
    let sick = client.submit("sick", text(MANY_PATHS)).await.unwrap();
    stages(&house, &sick).await;
    // Everything that this job has: the coordinator has its problem in memory, and not its first state.
    let objects = house.folder.path().join("data/results/objects");
    for folder in std::fs::read_dir(objects).unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            std::fs::remove_file(file.unwrap().path()).unwrap();
        }
    }
    let other = client.submit("other", text(FOUR_POINTS)).await.unwrap();
    let worker = house.worker("worker");
    let end = ends(&mut client, &other).await;
    assert_eq!(end.state, i32::from(v1::JobState::Solved));
    let end = ends(&mut client, &sick).await;
    assert_eq!(end.state, i32::from(v1::JobState::Failed));
    assert!(
        end.message.contains("storage has lost") && end.message.contains("stage 0"),
        "{}",
        end.message
    );
    let request = v1::ExplainRequest { job: sick };
    let explained = client.0.explain(request).await;
    explained.expect("a job that has failed is explained");
    worker.stop().await;
    house.server.shutdown().await;
}

/// E: an upload whose client sends nothing has a place for a while, and four of one caller are the most.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn uploads_that_stand_still_leave() {
    let folder = tempfile::tempdir().unwrap();
    let mut config = durable_config(folder.path());
    config.rules.uploads.most_of_one = 1;
    config.rules.uploads.patience = Duration::from_millis(300);
    let server = Server::start(config).await.unwrap();
    let house = House { server, folder };
    let mut client = house.client().await;
    let mut other = house.client().await;
    let piece = |bytes: usize| v1::ObjectPiece {
        data: vec![7; bytes].into(),
    };
    let (sender, receiver) = tokio::sync::mpsc::channel(1);
    sender.send(piece(1 << 20)).await.unwrap();
    let silent = tokio_stream::wrappers::ReceiverStream::new(receiver);
    let silent = tokio::spawn(async move { client.0.upload(silent).await });
    // The silent one has the place, or had it.
    let kept = loop {
        match other
            .0
            .upload(tokio_stream::iter([piece(3), piece(5)]))
            .await
        {
            Ok(kept) => break kept.into_inner(),
            Err(status) => assert_eq!(status.code(), tonic::Code::Unavailable, "{status}"),
        }
    };
    assert_eq!(kept.size, 8);
    let left = silent.await.unwrap().unwrap_err();
    assert_eq!(left.code(), tonic::Code::DeadlineExceeded, "{left}");
    drop(sender);
    let uploads = house.folder.path().join("data/results/uploads");
    let files = std::fs::read_dir(uploads).map(|files| files.count());
    assert_eq!(files.unwrap_or(0), 0, "nothing is left of it");
    house.server.shutdown().await;
}

/// The answer to `GET /` by HTTP/1.1, from an address of loopback; `None` where the connection is closed.
async fn page_from(address: &str, page: &str) -> Option<String> {
    let socket = TcpSocket::new_v4().unwrap();
    socket
        .bind(format!("{address}:0").parse().unwrap())
        .unwrap();
    let mut stream = socket.connect(page.parse().unwrap()).await.ok()?;
    let head = format!("GET / HTTP/1.1\r\nHost: {page}\r\nConnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).await.ok()?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await.ok()?;
    (!answer.is_empty()).then_some(answer)
}

/// K: connections of one address that say no more than the beginning of HTTP/2 do not shut the page for others.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn silent_connections_of_one_address_leave_the_page_to_others() {
    const PREFACE: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0";
    let folder = tempfile::tempdir().unwrap();
    let config = Config {
        page: Some("127.0.0.1:0".to_owned()),
        ..durable_config(folder.path())
    };
    let server = Server::start(config).await.unwrap();
    let page = server.page.clone().unwrap();
    let page = page.trim_start_matches("http://").trim_end_matches('/');
    let mut silent = Vec::new();
    for _ in 0..256 {
        let mut stream = TcpStream::connect(page).await.unwrap();
        // Refused ones are closed.
        let _ = stream.write_all(PREFACE).await;
        silent.push(stream);
    }
    let asked = tokio::time::timeout(HANGS, page_from("127.0.0.2", page)).await;
    let answer = asked.expect("it is answered").expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    // A connection that answers no ping is closed, and the address has places again.
    let reopened = async {
        while page_from("127.0.0.1", page).await.is_none() {
            tokio::time::sleep(Duration::from_millis(500)).await;
        }
    };
    let reopened = tokio::time::timeout(HANGS, reopened).await;
    reopened.expect("silent connections are closed");
    drop(silent);
    server.shutdown().await;
}
