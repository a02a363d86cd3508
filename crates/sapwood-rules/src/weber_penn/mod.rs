//! The tree model of Weber and Penn (SIGGRAPH 95), complete.
//!
//! A [`Species`] holds the parameters as files write them; [`Crown`], [`Level`], [`LeafParams`]
//! and [`TrunkForm`] are what growth reads of them. Growth is pure functions from a parent's
//! facts to stems, segments and leaves, and needs no scene.

mod accepted;
mod attraction;
mod children;
mod choices;
mod components;
mod curve;
mod frame;
mod grow;
mod keys;
mod leaf_shape;
mod leaves;
mod params;
mod placement;
mod ring_places;
mod rules;
mod shape_ratio;
mod slots;
mod species;
mod split;
mod stem;
mod surface;
mod taper;
#[cfg(test)]
mod tests;
mod trunks;
mod value;
mod variation;

pub use accepted::Accepted;
pub use children::children;
pub use choices::{CrownShape, Dialect, LeafShape, LeafTarget, Origin, Target, Variation};
pub use components::{Branch, Children, Leaves, Seed, StemSurface, Tree, Twigs};
pub use frame::Frame;
pub use grow::grow;
pub use keys::{Fault, Key, key, keys};
pub use leaf_shape::leaf_mesh;
pub use leaves::leaves;
pub use params::{Crown, Envelope, LeafParams, Level, TrunkForm};
pub use rules::{full, skeleton};
pub use slots::{
    BarkSlot, CrownSlot, DetailSlot, FoliageSlot, LeafTargetSlot, LeavesSlot, LevelSlot,
    StemTargetSlot, TrunkFormSlot,
};
pub use species::{LeavesSpec, LevelSpec, PruningSpec, Species, TreeGenExt, TrunkSpec};
pub use stem::{Leaf, Segment, Stem, StemSeed, Stems};
pub use surface::{Detail, surface};
pub use trunks::trunks;
pub use value::Value;
