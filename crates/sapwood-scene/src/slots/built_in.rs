//! The slots that the scene itself knows.

use sapwood_geom::StreamPath;
use sapwood_geom::glam::Affine3;

use super::{Held, Slot};

/// Where a component stands: the product of all transforms above it, from its frame to the
/// root's.
#[derive(Debug)]
pub enum Placement {}

impl Slot for Placement {
    type Value = Affine3;
    type Rate = Held;
    const NAME: &'static str = "placement";
    const MERGES: bool = true;

    fn default() -> Affine3 {
        Affine3::IDENTITY
    }

    fn merge(inherited: &Affine3, pushed: &Affine3) -> Affine3 {
        *inherited * *pushed
    }
}

/// The keys of all children on the way down, from the nearest ancestor that pushed a path on.
///
/// Whoever reads it tells its own copy of a shared component from the others, however they are
/// moved about.
#[derive(Debug)]
pub enum ChildPath {}

impl Slot for ChildPath {
    type Value = StreamPath;
    type Rate = Held;
    const NAME: &'static str = "child_path";
    const DESCENDS: bool = true;

    fn default() -> StreamPath {
        StreamPath::new(0)
    }

    fn descend(value: &StreamPath, key: u64) -> StreamPath {
        value.child(key)
    }
}
