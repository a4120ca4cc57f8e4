//! HelpersInMaking: the helper unknowns of the expressions that were read so far, before they are variables of a system.

use super::NodeId;
use crate::helper_unknown::{AngleUnit, Branch};
use crate::system::System;
use std::collections::BTreeMap;

/// Index of the first helper while a text is read: larger than that of any unknown.
pub(super) const FIRST: u32 = 1 << 24;

/// A helper unknown in the making.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Draft {
    Root {
        radicand: NodeId,
        degree: u32,
        branch: Branch,
    },
    /// The cosine of the unknown with this index, in this unit; its sine is the next helper.
    Cosine(u32, AngleUnit),
    Sine(u32, AngleUnit),
}

/// The helpers of the expressions that were read so far.
#[derive(Clone, Debug, Default)]
pub(super) struct HelpersInMaking {
    pub(super) drafts: Vec<Draft>,
    /// Places of the cosines of each angle, by its index, in each unit that occurs.
    pub(super) angles: BTreeMap<u32, BTreeMap<AngleUnit, usize>>,
    /// The roots that a finished system has, with their variables; `None` while equations are read.
    pub(super) finished: Option<Vec<(Draft, u32)>>,
    /// True where functions of unknowns stay in the graph, since only their values at points are wanted.
    pub(super) are_values: bool,
}

impl HelpersInMaking {
    /// Whether a variable of the graph is a helper.
    pub(super) fn is_helper(&self, variable: u32) -> bool {
        variable >= FIRST
    }

    /// The helpers of a finished system, to which no more can be added.
    pub(super) fn of(system: &System) -> Self {
        let roots = system.root_unknowns().map(|root| {
            let draft = Draft::Root {
                radicand: root.radicand,
                degree: root.degree,
                branch: root.branch,
            };
            (draft, root.variable as u32)
        });
        Self {
            finished: Some(roots.collect()),
            ..Self::default()
        }
    }

    /// The index of the helper at a place while a text is read.
    pub(super) fn variable(&self, place: usize) -> u32 {
        FIRST + u32::try_from(place).expect("fewer helpers than nodes")
    }
}
