//! Conformance of a store, wherever it keeps its objects: in memory, in a folder, in a bucket of S3.

use super::addresses::object_address;
use super::marker::MARKER;
use super::place::ResultsPlace;
use super::store::*;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::{ChunkId, Epoch, ItemRange, JobId, LeaseId, digest_of};
use bytes::Bytes;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::work::{StageId, Work};
use cognate_tests::skip::skip;
use num_complex::Complex64;
use object_store::ObjectStoreExt;
use object_store::path::Path as Address;

fn results(count: u64, value: f64) -> Vec<ItemResult> {
    let point = |k| vec![Complex64::new(value, k as f64); 3];
    let result = |k| {
        ItemResult::Track(PathResult {
            residual: 1e-16,
            accuracy: 1e-15,
            ..PathResult::untracked(k, 0, PathOutcome::Regular, point(k))
        })
    };
    (0..count).map(result).collect()
}

fn lease(epoch: u64) -> LeaseId {
    LeaseId {
        chunk: ChunkId {
            job: JobId(1),
            stage: StageId(0),
            first: 0,
        },
        epoch: Epoch(epoch),
    }
}

const ITEMS: ItemRange = ItemRange { first: 0, last: 5 };

async fn results_come_back_and_are_kept_once(store: &Store) {
    let put = |epoch, value| store.put_results(lease(epoch), ITEMS, results(5, value), 7);
    let object = put(1, 0.5).await.unwrap();
    assert_eq!(object.outcomes.regular, 5);
    assert_eq!(
        store.results(&object, Work::Track).await.unwrap(),
        results(5, 0.5)
    );
    assert_eq!(put(1, 0.5).await.unwrap(), object);
    let other = put(1, 0.25).await;
    assert!(matches!(other, Err(StoreError::Differs(_))));
    // Another execution is another object with the same hash.
    let second_object = put(2, 0.5).await.unwrap();
    assert_ne!(second_object.address, object.address);
    assert_eq!(second_object.hash, object.hash);
    let kept = store.results_of(JobId(1)).await.unwrap();
    let mut kept: Vec<String> = kept.into_iter().map(|(address, _)| address).collect();
    kept.sort();
    assert_eq!(
        kept,
        [object.address.clone(), second_object.address.clone()]
    );
    assert_eq!(store.jobs_with_results().await.unwrap(), [JobId(1)]);
    // It may go, where the ledger names the other.
    store.remove_results(&second_object.address).await.unwrap();
    // Two may remove at the same time.
    store.remove_results(&second_object.address).await.unwrap();
    let gone = store.results(&second_object, Work::Track).await;
    assert!(matches!(gone, Err(StoreError::Missing(_))));
    assert_eq!(
        store.results(&object, Work::Track).await.unwrap(),
        results(5, 0.5)
    );
    assert_eq!(store.remove_results_of(JobId(1)).await.unwrap().objects, 1);
    assert!(store.jobs_with_results().await.unwrap().is_empty());
}

async fn executions_that_differ_at_once_are_kept_once(store: &Store) {
    let put = |value| store.put_results(lease(9), ITEMS, results(5, value), 7);
    let (one, two, three) = tokio::join!(put(0.5), put(0.25), put(0.125));
    let outcomes = [one, two, three];
    let (mut right, mut kept) = (0, 0);
    for put in &outcomes {
        match put {
            Ok(object) => {
                kept += 1;
                // The ledger's row has the hash of what was meant.
                match store.results(object, Work::Track).await {
                    Ok(read) => right += usize::from(read.len() == 5),
                    Err(error) => assert!(matches!(error, StoreError::Damaged { .. })),
                }
            }
            Err(error) => assert!(matches!(error, StoreError::Differs(_)), "{error:?}"),
        }
    }
    assert_eq!(right, 1, "{outcomes:?}");
    // The bucket of the tests is in a server that looks and then writes (s3s-fs 0.14), where S3 does both at once.
    assert!(
        kept == 1 || matches!(store.place, Place::Bucket(_)),
        "{outcomes:?}"
    );
    store.remove_results_of(JobId(1)).await.unwrap();
}

/// Overwrites an object.
async fn spoil(store: &Store, address: &str, bytes: &[u8]) {
    let address = Address::from(address);
    let bytes = Bytes::copy_from_slice(bytes);
    store.objects.put(&address, bytes.into()).await.unwrap();
}

async fn every_damage_is_seen(store: &Store) {
    let put = store.put_results(lease(1), ITEMS, results(5, 0.5), 7);
    let object = put.await.unwrap();
    let address = Address::from(object.address.as_str());
    let good = store.objects.get(&address).await.unwrap();
    let good = good.bytes().await.unwrap();
    for at in 0..good.len() {
        let mut bad = good.to_vec();
        bad[at] ^= 0x41;
        spoil(store, &object.address, &bad).await;
        let error = store
            .results(&object, Work::Track)
            .await
            .expect_err("damage is seen");
        assert!(matches!(error, StoreError::Damaged { .. }), "byte {at}");
        spoil(store, &object.address, &good[..at]).await;
        assert!(
            store.results(&object, Work::Track).await.is_err(),
            "cut at {at}"
        );
    }
    store.remove_results(&object.address).await.unwrap();
    let error = store.results(&object, Work::Track).await;
    assert!(matches!(error, Err(StoreError::Missing(_))));
}

async fn bytes_of_a_record_are_read_without_a_copy(store: &Store) {
    const KIND: RecordKind = RecordKind(b"CGNTST01");
    const OTHER: RecordKind = RecordKind(b"CGNTST02");
    // Longer than what is compressed at once; and one whose number of bytes takes one byte.
    for length in [0_usize, 100, (3 << 18) + 7] {
        let bytes: Vec<u8> = (0..length).map(|i| (i * i % 251) as u8).collect();
        let kept = store.put_record(&KIND, bytes.clone()).await.unwrap();
        assert_eq!(store.bytes_record(&KIND, kept).await.unwrap(), bytes);
        let read: Vec<u8> = store.record(&KIND, kept).await.unwrap();
        assert_eq!(read, bytes);
        assert!(store.is_of_kind(&KIND, kept).await.unwrap());
        assert!(!store.is_of_kind(&OTHER, kept).await.unwrap());
    }
    let other = store.put_record(&KIND, (5usize, [1u8, 2])).await.unwrap();
    let refused = store.bytes_record(&KIND, other).await;
    assert!(matches!(refused, Err(StoreError::Damaged { .. })));
}

async fn objects_and_problems_are_checked_when_read(store: &Store) {
    let digest = store.put(Bytes::from_static(b"start")).await.unwrap();
    assert_eq!(
        store.put(Bytes::from_static(b"start")).await.unwrap(),
        digest
    );
    assert_eq!(&store.get(digest).await.unwrap()[..], b"start");
    store.is_here(digest).await.unwrap();
    spoil(store, object_address(digest).as_ref(), b"stare").await;
    assert!(store.get(digest).await.is_err());
    let content = b"variable_group x;\nfunction f;\nf = x^2 - 2;\n";
    let system = cognate_systems::formats::read("test", content)
        .unwrap()
        .system;
    let digest = store.put_problem(&system).await.unwrap();
    assert_eq!(store.problem(digest).await.unwrap(), system);
    spoil(store, object_address(digest).as_ref(), b"nonsense").await;
    let error = store.problem(digest).await.expect_err("damage is seen");
    assert!(matches!(error, StoreError::Damaged { .. }));
    let never = store.is_here(digest_of(b"never")).await;
    assert!(matches!(never, Err(StoreError::Missing(_))));
}

async fn large_objects_come_back(store: &Store) {
    let bytes: Vec<u8> = (0..PART + 12_345).map(|i| (i * 7 % 251) as u8).collect();
    let digest = store.put(bytes.clone().into()).await.unwrap();
    assert!(store.get(digest).await.unwrap() == bytes);
}

async fn trash_is_read_taken_back_and_emptied(store: &Store) {
    let digest = store.put(Bytes::from_static(b"unnamed")).await.unwrap();
    let before = store.objects().await.unwrap().len();
    assert!(store.trash(digest, LedgerTime(5)).await.unwrap());
    assert!(!store.trash(digest, LedgerTime(6)).await.unwrap());
    assert_eq!(store.objects().await.unwrap().len(), before - 1);
    assert_eq!(&store.get(digest).await.unwrap()[..], b"unnamed");
    let trash = store.in_trash().await.unwrap();
    let [trashed] = &trash[..] else {
        panic!("{trash:?}");
    };
    assert_eq!((trashed.digest, trashed.since), (digest, LedgerTime(5)));
    assert!(store.take_back(trashed, false).await.unwrap());
    assert!(!store.take_back(trashed, false).await.unwrap());
    assert!(store.in_trash().await.unwrap().is_empty());
    // It is written anew while it is in the trash; that copy goes when it is old.
    assert!(store.trash(digest, LedgerTime(7)).await.unwrap());
    let trashed = store.in_trash().await.unwrap().remove(0);
    store.put(Bytes::from_static(b"unnamed")).await.unwrap();
    assert!(!store.take_back(&trashed, false).await.unwrap());
    assert_eq!(store.in_trash().await.unwrap().len(), 1);
    assert!(!store.take_back(&trashed, true).await.unwrap());
    assert!(store.in_trash().await.unwrap().is_empty());
    assert_eq!(&store.get(digest).await.unwrap()[..], b"unnamed");
    assert!(store.trash(digest, LedgerTime(8)).await.unwrap());
    let trashed = store.in_trash().await.unwrap().remove(0);
    assert!(store.remove_from_trash(&trashed).await.unwrap());
    let gone = store.get(digest).await;
    assert!(matches!(gone, Err(StoreError::Missing(_))));
}

async fn conforms(store: &Store) {
    results_come_back_and_are_kept_once(store).await;
    executions_that_differ_at_once_are_kept_once(store).await;
    every_damage_is_seen(store).await;
    bytes_of_a_record_are_read_without_a_copy(store).await;
    objects_and_problems_are_checked_when_read(store).await;
    large_objects_come_back(store).await;
    trash_is_read_taken_back_and_emptied(store).await;
}

/// A place that outlives its process is not made anew where the ledger knows of it, and belongs to one ledger.
async fn is_marked(place: &ResultsPlace) {
    let away = Store::open(place, false).await;
    assert!(matches!(away, Err(StoreError::Away(_))), "{away:?}");
    let (one, two) = tokio::join!(Store::open(place, true), Store::open(place, true));
    let (store, two) = (one.unwrap(), two.unwrap());
    two.is_there().await.unwrap();
    Store::open(place, false).await.unwrap();
    assert!(!store.has_results().await.unwrap());
    conforms(&store).await;

    let ended = store.belongs_to(None).await;
    assert!(matches!(ended, Err(StoreError::Foreign(_))));
    assert!(store.belongs_to(Some("one")).await.unwrap());
    store.give_to("one").await.unwrap();
    assert!(!two.belongs_to(Some("one")).await.unwrap());
    let foreign = two.belongs_to(Some("two")).await;
    assert!(matches!(foreign, Err(StoreError::Foreign(_))));

    // The marker goes, and what is not found is not lost.
    let lease = lease(1);
    let put = store.put_results(lease, ITEMS, results(5, 0.5), 7);
    let object = put.await.unwrap();
    assert!(store.has_results().await.unwrap());
    store.remove_results(&object.address).await.unwrap();
    store.objects.delete(&Address::from(MARKER)).await.unwrap();
    for error in [
        store.is_there().await.err(),
        store.results(&object, Work::Track).await.err(),
        store.objects().await.err(),
    ] {
        assert!(matches!(error, Some(StoreError::Away(_))), "{error:?}");
    }
    // Objects without a marker are from before there were markers.
    Store::open(place, false).await.unwrap();
    store.is_there().await.unwrap();
}

#[tokio::test]
async fn memory_conforms() {
    conforms(&Store::in_memory()).await;
}

#[tokio::test]
async fn a_folder_conforms() {
    let folder = tempfile::tempdir().unwrap();
    is_marked(&folder.path().join("results").into()).await;
}

/// A bucket that tests may use, with its endpoint and keys in the environment: see `tests/support/s3.sh`.
#[tokio::test]
async fn a_bucket_conforms() {
    let Ok(bucket) = std::env::var("COGNATE_TEST_S3_BUCKET") else {
        skip("COGNATE_TEST_S3_BUCKET names no bucket; tests/run.sh starts a server");
        return;
    };
    let prefix = uuid::Uuid::new_v4().simple();
    is_marked(&format!("s3://{bucket}/{prefix}/results").parse().unwrap()).await;
}
