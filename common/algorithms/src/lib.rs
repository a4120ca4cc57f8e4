//! Whole solves, as plans that ask for paths and learn from results.
//!
//! A [`PathAlgorithm`] is a state machine: it opens stages, is fed their
//! results in index order, and knows at any moment how far it is. The service
//! feeds it from leases, a test from a loop.
#![forbid(unsafe_code)]

use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{Stage, StageId};

/// What an algorithm wants next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Open this stage; several may be open.
    Open(Box<Stage>),
    /// Nothing until an open stage has been absorbed.
    Wait,
    /// All is known.
    Done,
}

/// A whole solve.
pub trait PathAlgorithm: Send {
    /// What is wanted next. Called until it says `Wait` or `Done`, and again after each absorption.
    fn next(&mut self) -> Next;
    /// Takes the results of one stage, complete and in item order.
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = PathResult>);
    /// The whole state, to be restored where another process goes on.
    fn snapshot(&self) -> Vec<u8>;
}
