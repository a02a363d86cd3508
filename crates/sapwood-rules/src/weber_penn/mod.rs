//! The tree model of Weber and Penn (SIGGRAPH 95).
//!
//! Some parameters are read, checked and kept, but do not act: ZScale and ZScaleV (the paper
//! never uses them), Arbaro's Smooth, and tree-gen's blossoms.
//!
//! A [`Species`] holds the parameters as files write them; [`Crown`], [`Level`], [`LeafParams`]
//! and [`TrunkForm`] are what growth reads of them, each in a slot of its own. Growth and
//! geometry are pure functions that need no scene. [`Tree`] is the component that users place;
//! the rules compile it, through branches, into meshes.

mod components;
mod fading;
mod geometry;
mod growth;
mod leaf_params;
mod look;
mod params;
mod prune;
mod rules;
mod slots;
mod species;
mod survey;
mod sway;
#[cfg(test)]
mod tests;

pub use components::{
    Branch, Children, LeafModel, LeafSurface, Leaves, Roots, Seed, StemSurface, SurveyedBranches,
    SurveyedGrowth, Tree, TreeSurvey, Twigs,
};
pub use fading::{FadingItem, FadingParams, Season, faded};
pub use geometry::{
    Detail, LeafMesh, LeafMeshFault, LevelDetail, OwnLeafImage, closed_stems, leaf_card, leaf_mesh,
    segments as stem_segments, surface,
};
pub use growth::{
    Frame, Leaf, LeafPlaces, Limit, Segment, Stem, StemSeed, Stems, children, fit, foreseen, grow,
    leaf_places, leaves, roots, trunks,
};
pub use leaf_params::LeafParams;
pub use look::{BarkLook, LeafLook};
pub use params::{Crown, Level, PruningParams, RootParams, TrunkForm};
pub use prune::prune_handlers;
pub use rules::{fading, full, map, segments, skeleton, swaying, text};
pub use slots::{
    BarkLookSlot, BarkSlot, CrownSlot, DetailSlot, FadingSlot, FoliageSlot, IsPrunedSlot,
    LeafLookSlot, LeafTargetSlot, LeavesSlot, LevelDetailSlot, LevelSlot, PruneRatioSlot, RigSlot,
    RootsSlot, SpeciesNameSlot, StemTargetSlot, SwaySlot, TrunkFormSlot,
};
pub use species::{
    Accepted, BarkSpec, CrownShape, Dialect, Fault, Key, LeafShape, LeafTarget, LeavesSpec,
    LevelSpec, Origin, PruningSpec, RootsSpec, Species, Target, TreeGenExt, TrunkSpec, Value,
    Variation, WrittenEnvelope, WrittenImage, WrittenMesh, key, keys,
};
pub use sway::{Riding, SwayParams};
