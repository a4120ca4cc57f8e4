//! Hostile callers: what they send is bounded before it is believed, and the service stays up.

mod support;

use cognate_protocol::v1;
use std::time::{Duration, Instant};
use support::{House, text};
use tonic::Code;

/// The most memory that this process has had, in MiB.
fn peak_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    let kib: u64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kib / 1024
}

/// `x_i - c` a thousand times, or its square: 26 KB that once took 15 GiB to plan.
fn thousand_variables(power: u32) -> String {
    let names = |letter: &str| {
        let names: Vec<String> = (0..1000).map(|i| format!("{letter}{i}")).collect();
        names.join(", ")
    };
    let equations: String = (0..1000)
        .map(|i| format!("f{i} = x{i}^{power} - {};\n", i + 2))
        .collect();
    format!(
        "INPUT\nvariable_group {};\nfunction {};\n{equations}END;\n",
        names("x"),
        names("f")
    )
}

#[tokio::test(flavor = "multi_thread")]
async fn a_thousand_trivial_equations_are_planned_at_once_and_in_little_memory() {
    let house = House::new().await;
    let mut client = house.client().await;
    let before = peak_mib();
    let begin = Instant::now();
    let job = client.submit("linear", text(&thousand_variables(1))).await;
    job.expect("one path");
    let refused = client.submit("quadratic", text(&thousand_variables(2))).await;
    let refused = refused.expect_err("2^1000 paths");
    assert_eq!(refused.code(), Code::Unimplemented, "{refused}");
    assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", begin.elapsed());
    let more = peak_mib() - before;
    assert!(more < 1024, "{more} MiB");
}

#[tokio::test(flavor = "multi_thread")]
async fn messages_of_empty_parts_are_refused_before_they_are_made() {
    let house = House::new().await;
    let mut worker = house.worker_api("evil").await;
    let before = peak_mib();
    // Made once here, so that what is measured is the coordinator's and not twice that.
    let request = v1::ReportRequest {
        identity: worker.identity(),
        chunks: vec![v1::ChunkReport {
            results: vec![v1::PathResult::default(); 400_000],
            ..v1::ChunkReport::default()
        }],
    };
    let made = peak_mib() - before;
    let refused = worker.api.report(request).await.expect_err("too much");
    assert_eq!(refused.code(), Code::ResourceExhausted, "{refused}");
    let more = peak_mib() - before;
    assert!(more < made + 200, "{more} MiB, {made} of them the test's");
    assert!(worker.pull(1, 0).await.leases.is_empty());
}

#[tokio::test(flavor = "multi_thread")]
async fn malformed_messages_are_the_callers_fault() {
    let house = House::new().await;
    let mut answers = Vec::new();
    for body in [&b"\xff\xff\xff"[..], b"\x0a\x05ab", b"\x08\x01", b"\x0a\x02\xc3\x28"] {
        let mut grpc = tonic::client::Grpc::new(house.channel().await);
        grpc.ready().await.unwrap();
        let request = tonic::Request::new(bytes::Bytes::copy_from_slice(body));
        let path = http::uri::PathAndQuery::from_static("/cognate.v1.ClientApi/Cancel");
        let answer = grpc.unary(request, path, raw::Raw).await;
        answers.push(answer.map(drop).map_err(|status| status.code()));
    }
    assert_eq!(answers, [Err(Code::InvalidArgument); 4]);
}

/// Messages that are sent as they are.
mod raw {
    use bytes::{Buf, BufMut, Bytes};
    use tonic::Status;
    use tonic::codec::{Codec, DecodeBuf, Decoder, EncodeBuf, Encoder};

    pub struct Raw;

    impl Codec for Raw {
        type Encode = Bytes;
        type Decode = Bytes;
        type Encoder = Self;
        type Decoder = Self;

        fn encoder(&mut self) -> Self {
            Self
        }

        fn decoder(&mut self) -> Self {
            Self
        }
    }

    impl Encoder for Raw {
        type Item = Bytes;
        type Error = Status;

        fn encode(&mut self, item: Bytes, to: &mut EncodeBuf<'_>) -> Result<(), Status> {
            to.put(item);
            Ok(())
        }
    }

    impl Decoder for Raw {
        type Item = Bytes;
        type Error = Status;

        fn decode(&mut self, from: &mut DecodeBuf<'_>) -> Result<Option<Bytes>, Status> {
            Ok(Some(from.copy_to_bytes(from.remaining())))
        }
    }
}
