//! Bytes of a stage, as a store keeps them: those of its message.

use crate::error::ProtocolError;
use crate::{from_proto, to_proto, v1};
use bytes::Bytes;
use cognate_continuation::work::Stage;
use prost::Message;

/// Bytes that hold no stage.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DamagedStage {
    /// The bytes are no message of a stage.
    #[error(transparent)]
    Encoding(#[from] prost::DecodeError),
    /// The message says no stage.
    #[error(transparent)]
    Content(#[from] ProtocolError),
}

/// The bytes of a stage.
pub fn encode(stage: &Stage) -> Bytes {
    to_proto::path::stage(stage).encode_to_vec().into()
}

/// Reads what [`encode`] wrote, with every check of a message.
pub fn decode(bytes: Bytes) -> Result<Stage, DamagedStage> {
    Ok(from_proto::path::stage(&v1::Stage::decode(bytes)?)?)
}
