//! Messages, records and objects that come from a network or a disk: any bytes end in a value or an error, and a value
//! that is taken is the same again once it was sent.

use crate::support::Draw;
use cognate_continuation::start_points::StoredPoints;
use cognate_protocol::decoded_size::decoded_size;
use cognate_protocol::{digest, from_proto, records, to_proto, v1};
use cognate_tests::any_bytes::read_any_bytes;
use num_complex::Complex64;
use prost::Message;

/// Messages drawn with the seeds below `seeds`.
fn drawn(seeds: u64, mut draw: impl FnMut(&mut Draw) -> Vec<u8>) -> Vec<Vec<u8>> {
    (0..seeds).map(|seed| draw(&mut Draw::new(seed))).collect()
}

#[test]
fn systems_are_read_or_refused() {
    let canonical = drawn(40, |draw| digest::encode_system(&draw.system()));
    read_any_bytes("canonical_system", &canonical, |bytes| {
        let Ok(system) = digest::decode_system(bytes) else {
            return false;
        };
        // A system that was read is written in one way.
        let written = digest::encode_system(&system);
        let second_copy = digest::decode_system(&written);
        let second_copy = second_copy.map(|system| digest::encode_system(&system));
        assert_eq!(second_copy.ok(), Some(written));
        true
    });
    let messages = drawn(40, |draw| {
        to_proto::problem::system(&draw.system()).encode_to_vec()
    });
    read_any_bytes("system", &messages, |bytes| {
        let Ok(message) = v1::System::decode(bytes) else {
            return false;
        };
        let Ok(system) = from_proto::problem::system(&message) else {
            return false;
        };
        let second_message = to_proto::problem::system(&system);
        assert_eq!(
            from_proto::problem::system(&second_message).as_ref(),
            Ok(&system)
        );
        true
    });
}

#[test]
fn submissions_are_read_or_refused() {
    let problems = drawn(40, |draw| {
        let system = to_proto::problem::system(&draw.system());
        let problem = v1::Problem {
            source: Some(v1::problem::Source::System(system)),
            options: Some(to_proto::problem::options(&draw.options())),
        };
        problem.encode_to_vec()
    });
    read_any_bytes("submission", &problems, |bytes| {
        let Ok(problem) = v1::Problem::decode(bytes) else {
            return false;
        };
        from_proto::problem::submission(problem).is_ok()
    });
}

#[test]
fn stages_are_read_or_refused() {
    let stages = drawn(60, |draw| {
        let stage = match draw.below(2) {
            0 => draw.stage(),
            _ => draw.later_stage(),
        };
        to_proto::path::stage(&stage).encode_to_vec()
    });
    read_any_bytes("stage", &stages, |bytes| {
        let Ok(message) = v1::Stage::decode(bytes) else {
            return false;
        };
        from_proto::path::stage(&message).is_ok()
    });
}

#[test]
fn results_are_read_or_refused() {
    let mut draw = Draw::new(1);
    let item_results: Vec<_> = (0..40).flat_map(|_| draw.item_results()).collect();
    let messages: Vec<Vec<u8>> = item_results
        .iter()
        .map(|(_, result)| to_proto::path::item_result(result).encode_to_vec())
        .collect();
    let works: Vec<_> = item_results.iter().map(|(work, _)| *work).collect();
    read_any_bytes("item_result", &messages, |bytes| {
        let Ok(message) = v1::PathResult::decode(bytes) else {
            return false;
        };
        let taken = works.iter().take(12);
        taken
            .filter(|work| from_proto::path::item_result(&message, **work).is_ok())
            .count()
            > 0
    });
    let kept: Vec<Vec<u8>> = item_results
        .chunks(3)
        .map(|some| {
            let results: Vec<_> = some.iter().map(|(_, result)| result.clone()).collect();
            records::encode(&results)
        })
        .chain(
            item_results
                .iter()
                .map(|(_, one)| records::encode(std::slice::from_ref(one))),
        )
        .collect();
    read_any_bytes("result_records", &kept, |bytes| {
        let mut taken = false;
        for work in works.iter().take(12) {
            if let Ok(results) = records::decode(bytes, *work) {
                // Results that were read are written in one way.
                let written = records::encode(&results);
                let second_copy = records::decode(&written, *work);
                let second_copy = second_copy.map(|results| records::encode(&results));
                assert_eq!(second_copy.ok(), Some(written));
                taken = true;
            }
        }
        taken
    });
}

#[test]
fn stored_points_are_read_or_refused() {
    let points = drawn(20, |draw| {
        let (count, dimension) = (draw.below(5), 1 + draw.below(4));
        let coordinate = |k: usize| Complex64::new(k as f64, -0.5);
        let coordinates = (0..count * dimension).map(coordinate).collect();
        StoredPoints {
            dimension,
            coordinates,
        }
        .to_bytes()
    });
    read_any_bytes("stored_points", &points, |bytes| {
        StoredPoints::from_bytes(bytes).is_ok()
    });
}

#[test]
fn sizes_are_bounds_of_what_is_decoded() {
    let problems = drawn(20, |draw| {
        let system = to_proto::problem::system(&draw.system());
        let problem = v1::Problem {
            source: Some(v1::problem::Source::System(system)),
            options: Some(to_proto::problem::options(&draw.options())),
        };
        v1::SubmitRequest {
            problem: Some(problem),
            ..v1::SubmitRequest::default()
        }
        .encode_to_vec()
    });
    read_any_bytes("decoded_size", &problems, |bytes| {
        let size = decoded_size("cognate.v1.SubmitRequest", bytes);
        let decoded = v1::SubmitRequest::decode(bytes);
        // Every decoded message has a size; a message whose size cannot be computed is not decoded.
        assert!(size.is_ok() || decoded.is_err(), "{size:?} {decoded:?}");
        decoded.is_ok()
    });
}
