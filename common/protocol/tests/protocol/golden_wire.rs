//! Golden wire files: bytes that clients and workers of other versions send and read.
//!
//! Each file says why it is there, shows the message, and has its bytes. A
//! change of any is a change of the wire: `UPDATE_GOLDEN=1` rewrites them, and
//! the difference is to be read before it is handed in.

use crate::support::Draw;
use cognate_protocol::submission::{Options, StartKind};
use cognate_protocol::{digest, from_proto, records, to_proto, v1};
use prost::Message;
use std::fmt::Write;
use std::path::PathBuf;

fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for line in bytes.chunks(32) {
        for byte in line {
            write!(text, "{byte:02x}").expect("a string can be written to");
        }
        text.push('\n');
    }
    text
}

fn unhex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    digits
        .chunks(2)
        .map(|pair| {
            let pair = std::str::from_utf8(pair).expect("hexadecimal digits are ASCII");
            u8::from_str_radix(pair, 16).expect("hexadecimal digits")
        })
        .collect()
}

/// Compares with the file, and gives the bytes that stand in it.
fn golden(name: &str, why: &str, shown: &str, bytes: &[u8]) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/golden/wire")
        .join(name);
    let text = format!("{why}\n\n{}\n\nbytes:\n{}", shown.trim_end(), hex(bytes));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &text).expect("the golden file can be written");
    }
    let golden_text = std::fs::read_to_string(&path)
        .unwrap_or_else(|e| panic!("{}: {e}; UPDATE_GOLDEN=1 writes it", path.display()));
    assert_eq!(
        golden_text, text,
        "{name} differs; is the change of the wire meant?"
    );
    let (_, bytes) = golden_text
        .split_once("bytes:\n")
        .expect("the file has bytes");
    unhex(bytes)
}

#[test]
fn system() {
    let system = Draw::new(11).system();
    let message = to_proto::problem::system(&system);
    let bytes = golden(
        "system.txt",
        "A system as a worker gets it; an old worker must still read it.",
        &format!("{message:#?}"),
        &message.encode_to_vec(),
    );
    let back = v1::System::decode(bytes.as_slice()).unwrap();
    assert_eq!(from_proto::problem::system(&back).unwrap(), system);
}

#[test]
fn canonical_system() {
    let system = Draw::new(11).system();
    let bytes = digest::encode_system(&system);
    let bytes = golden(
        "canonical_system.txt",
        "The bytes behind a problem's digest; a change renames every problem in every ledger.",
        &format!("digest {}", digest::of_system(&system)),
        &bytes,
    );
    assert_eq!(digest::decode_system(&bytes).unwrap(), system);
}

#[test]
fn options() {
    let options = Options {
        start: StartKind::Given,
        ..Draw::new(3).options()
    };
    let message = to_proto::problem::options(&options);
    let bytes = golden(
        "options.txt",
        "How a problem is to be solved, as clients send it and ledgers keep it.",
        &format!("{message:#?}"),
        &message.encode_to_vec(),
    );
    let back = v1::Options::decode(bytes.as_slice()).unwrap();
    assert_eq!(from_proto::problem::options(back).unwrap(), options);
}

#[test]
fn stage() {
    let stage = Draw::new(5).stage();
    let message = to_proto::path::stage(&stage);
    let bytes = golden(
        "stage.txt",
        "A stage as a worker gets it, every setting present.",
        &format!("{message:#?}"),
        &message.encode_to_vec(),
    );
    let back = v1::Stage::decode(bytes.as_slice()).unwrap();
    assert_eq!(from_proto::path::stage(&back).unwrap(), stage);
}

#[test]
fn report() {
    let results = Draw::new(0).item_results();
    let message = v1::ReportRequest {
        identity: Some(v1::WorkerIdentity {
            worker: "host-1".to_owned(),
            session: "7f".to_owned(),
        }),
        chunks: vec![v1::ChunkReport {
            lease: Some(v1::LeaseId {
                job: "0123456789abcdef".to_owned(),
                stage: 1,
                chunk: 128,
                epoch: 3,
            }),
            results: results
                .iter()
                .map(|(_, result)| to_proto::path::item_result(result))
                .collect(),
            cpu_nanoseconds: 5_000_000,
            wall_nanoseconds: 6_000_000,
        }],
    };
    let bytes = golden(
        "report.txt",
        "What a worker hands in: an old worker reports to a new coordinator.",
        &format!("{message:#?}"),
        &message.encode_to_vec(),
    );
    let back = v1::ReportRequest::decode(bytes.as_slice()).unwrap();
    for (message, (work, result)) in back.chunks[0].results.iter().zip(&results) {
        let read = from_proto::path::item_result(message, *work).unwrap();
        assert_eq!(&read, result);
    }
}

#[test]
fn result_records() {
    let results = Draw::new(0).item_results();
    let (mut shown, mut bytes) = (String::new(), Vec::new());
    for (work, result) in &results {
        let records = records::encode([result]);
        let hash = records::hash(&records);
        writeln!(shown, "{work:?}, hash {hash}\n{result:#?}").expect("a string can be written to");
        bytes.push(records);
    }
    let whole = golden(
        "result_records.txt",
        "Stored results of each kind of work; a ledger of today must be readable for ever, with the same hash.",
        &shown,
        &bytes.concat(),
    );
    let mut rest = whole.as_slice();
    for ((work, result), one) in results.into_iter().zip(&bytes) {
        let (records, others) = rest.split_at(one.len());
        assert_eq!(records::decode(records, work).unwrap(), [result]);
        rest = others;
    }
}
