//! Upload: an object whose bytes come one piece after the other, and whose digest is known at the end only.
//!
//! The pieces are written in parts as they come, to an address of the upload's own; the finished object is then
//! renamed to the address of its digest. So an upload takes the memory of one part, however large the object is.

use super::addresses::{UPLOADS, object_address};
use super::store::{PART, Place, Store, StoreError};
use bytes::{Bytes, BytesMut};
use cognate_continuation::start_points::Digest;
use futures::TryStreamExt;
use object_store::path::Path as Address;
use object_store::{MultipartUpload, ObjectStore, ObjectStoreExt};
use std::time::{Duration, SystemTime};

/// Bytes of a part where the store is no bucket.
const LOCAL_PART: usize = 1 << 20;
/// Age at which files are removed that a coordinator left when it was killed between two steps of an upload's end.
const LEFT_BEHIND: Duration = Duration::from_secs(24 * 3600);

/// An object that is on its way. Dropped before its end, it leaves nothing.
pub struct Upload {
    store: Store,
    address: Address,
    /// `None` once the upload has ended.
    parts: Option<Box<dyn MultipartUpload>>,
    hasher: blake3::Hasher,
    waiting: BytesMut,
    part_bytes: usize,
}

impl Store {
    /// Begins an upload.
    pub async fn begin_upload(&self) -> Result<Upload, StoreError> {
        self.is_there().await?;
        let address = Address::from(format!("{UPLOADS}/{}", uuid::Uuid::new_v4()));
        let parts = self.objects.put_multipart(&address).await?;
        Ok(Upload {
            store: self.clone(),
            address,
            parts: Some(parts),
            hasher: blake3::Hasher::new(),
            waiting: BytesMut::new(),
            part_bytes: match self.place {
                Place::Bucket(_) => PART,
                Place::Memory | Place::Folder(_) => LOCAL_PART,
            },
        })
    }

    /// Removes what uploads left whose coordinator was killed; how many objects.
    pub async fn remove_left_uploads(&self) -> Result<u64, StoreError> {
        let prefix = Address::from(UPLOADS);
        let listed: Vec<_> = self.objects.list(Some(&prefix)).try_collect().await?;
        let mut removed = 0;
        for object in listed {
            let age = SystemTime::now().duration_since(object.last_modified.into());
            if age.is_ok_and(|age| age > LEFT_BEHIND) {
                self.objects.delete(&object.location).await?;
                removed += 1;
            }
        }
        Ok(removed)
    }
}

impl Upload {
    /// Takes the next bytes.
    pub async fn take(&mut self, piece: &[u8]) -> Result<(), StoreError> {
        self.hasher.update(piece);
        self.waiting.extend_from_slice(piece);
        while self.waiting.len() >= self.part_bytes {
            let part = self.waiting.split_to(self.part_bytes).freeze();
            self.put(part).await?;
        }
        Ok(())
    }

    async fn put(&mut self, part: Bytes) -> Result<(), StoreError> {
        match &mut self.parts {
            Some(parts) => Ok(parts.put_part(part.into()).await?),
            None => Ok(()),
        }
    }

    /// The digest under which the object is kept from now on.
    pub async fn finish(mut self) -> Result<Digest, StoreError> {
        let digest = Digest(*self.hasher.finalize().as_bytes());
        let address = object_address(digest);
        let last = self.waiting.split().freeze();
        self.put(last).await?;
        // The object may exist already. It is not in the trash, as this upload needs it.
        if self.store.objects.head(&address).await.is_ok() {
            return Ok(digest);
        }
        self.store.is_there().await?;
        if let Some(mut parts) = self.parts.take() {
            parts.complete().await?;
            self.store.objects.rename(&self.address, &address).await?;
        }
        Ok(digest)
    }
}

impl Drop for Upload {
    fn drop(&mut self) {
        let Some(mut parts) = self.parts.take() else {
            return;
        };
        // Parts that stay in a bucket cost money.
        if let Ok(runtime) = tokio::runtime::Handle::try_current() {
            runtime.spawn(async move {
                if let Err(error) = parts.abort().await {
                    tracing::debug!(%error, "parts of an upload may stay");
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::identity::digest_of;

    async fn uploaded(store: &Store, bytes: &[u8], piece: usize) -> Digest {
        let mut upload = store.begin_upload().await.unwrap();
        for piece in bytes.chunks(piece) {
            upload.take(piece).await.unwrap();
        }
        upload.finish().await.unwrap()
    }

    #[tokio::test]
    async fn an_object_in_pieces_is_kept_under_its_digest_and_nothing_else_is() {
        let folder = tempfile::tempdir().unwrap();
        let stores = [
            Store::in_memory(),
            Store::folder(folder.path(), true).unwrap(),
        ];
        for store in &stores {
            for length in [0, 1, LOCAL_PART, 3 * LOCAL_PART + 7] {
                let object: Vec<u8> = (0..length).map(|i| (i % 251) as u8).collect();
                for piece in [1 << 10, 5 << 20] {
                    let digest = uploaded(store, &object, piece).await;
                    assert_eq!(digest, digest_of(&object));
                    assert_eq!(store.get(digest).await.unwrap(), object);
                }
            }
            assert_eq!(store.objects().await.unwrap().len(), 4);
            let mut left = store.begin_upload().await.unwrap();
            left.take(&[7; 2 * LOCAL_PART]).await.unwrap();
            drop(left);
            tokio::task::yield_now().await;
            assert_eq!(store.objects().await.unwrap().len(), 4);
            let uploads = store.objects.list(Some(&UPLOADS.into()));
            let uploads: Vec<_> = uploads.try_collect().await.unwrap();
            assert!(uploads.is_empty(), "{uploads:?}");
            assert_eq!(store.remove_left_uploads().await.unwrap(), 0);
        }
    }
}
