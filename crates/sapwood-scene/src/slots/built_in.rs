//! The slots that the scene itself knows.

use sapwood_geom::StreamPath;
use sapwood_geom::glam::Affine3;
use sapwood_graph::Eye;

use super::{Held, Moving, Slot};

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

/// Seconds since some beginning: what rotors and everything else that runs by itself go by.
#[derive(Debug)]
pub enum Time {}

impl Slot for Time {
    type Value = f64;
    type Rate = Moving;
    const NAME: &'static str = "time";

    fn default() -> f64 {
        0.0
    }
}

/// From where the view is looked at, in its root's frame: what billboards turn to.
#[derive(Debug)]
pub enum Viewer {}

impl Slot for Viewer {
    type Value = Option<Eye>;
    type Rate = Moving;
    const NAME: &'static str = "viewer";

    fn default() -> Option<Eye> {
        None
    }
}
