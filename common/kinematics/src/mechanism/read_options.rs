//! How a mechanism's file is read.

/// The links between which the chain of a URDF is taken; without them the root, and the only leaf or `tool0`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChainEnds {
    /// The link that stands still.
    pub base: Option<String>,
    /// The link whose pose is meant.
    pub tip: Option<String>,
}

/// How a file is read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Rounded right angles are taken as they are written.
    pub no_snap: bool,
    /// The chain of a URDF that is read.
    pub ends: ChainEnds,
}
