//! What a tree comes to as a whole: how high and wide it is, how many stems of which length it has.
//!
//! A [`Survey`] holds what growth made, shared with whoever draws it; [`Figures`] are taken from it
//! for a tree that stands in the world somehow. What becomes of them, a map or a text, is up to the
//! rules.

mod figures;

pub(super) use figures::{Crown as SurveyedCrown, Figures, LevelFigures, NamedBranch};

use glam::Vec3;
use sapwood_geom::{Shared, content};

use super::{Leaf, Stems};

/// What grew, in batches, each with all that grows on it right behind.
#[derive(Clone, Debug, Default)]
pub(super) struct Survey {
    pub(super) stems: Vec<Shared<Stems>>,
    pub(super) leaves: Vec<Shared<LeafTally>>,
    /// Apart from what grows above ground.
    pub(super) roots: Vec<Shared<Stems>>,
}

content!(Survey { stems, leaves, roots });

impl Survey {
    /// Adds what grew elsewhere on the same tree.
    pub(super) fn extend(&mut self, other: &Self) {
        self.stems.extend_from_slice(&other.stems);
        self.leaves.extend_from_slice(&other.leaves);
        self.roots.extend_from_slice(&other.roots);
    }
}

/// Leaves, as far as counting and measuring needs them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LeafTally {
    /// Their tips, in tree space.
    pub(super) tips: Vec<Vec3>,
    /// How long the longest of them is, in metres.
    pub(super) length: f32,
}

content!(LeafTally { tips, length });

impl LeafTally {
    pub(super) fn of(leaves: &[Leaf]) -> Self {
        let tip = |leaf: &Leaf| leaf.frame.origin + leaf.length * leaf.frame.axes.z_axis;
        let length = leaves.iter().fold(0.0, |length: f32, leaf| length.max(leaf.length));
        Self { tips: leaves.iter().map(tip).collect(), length }
    }
}
