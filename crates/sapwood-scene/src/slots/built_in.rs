//! The slots that the scene itself knows.
//!
//! Held ones first, then those that move.

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Content, Digester, Envelope, StreamPath};
use sapwood_graph::{Eye, Material, Wind};

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

/// How geometry is to be shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Style {
    /// As surfaces.
    #[default]
    Solid,
    /// As the edges of its triangles.
    Wire,
    /// As the lines that it was grown along; as its edges where there are none.
    Skeleton,
}

impl Content for Style {
    fn write(&self, digester: &mut Digester) {
        digester.add(&(*self as u8));
    }
}

/// The style of whatever draws below.
#[derive(Debug)]
pub enum StyleSlot {}

impl Slot for StyleSlot {
    type Value = Style;
    type Rate = Held;
    const NAME: &'static str = "style";

    fn default() -> Style {
        Style::Solid
    }
}

/// The material of geometry that has none of its own, and of all geometry where it is forced.
#[derive(Debug)]
pub enum MaterialSlot {}

impl Slot for MaterialSlot {
    type Value = Material;
    type Rate = Held;
    const NAME: &'static str = "material";

    fn default() -> Material {
        Material::matte("plain", 0.5, 0.5, 0.5)
    }
}

/// What growth below is held inside of, in the frame of the view's root; nothing holds it by
/// default. Rules that grow something ask it; what is placed by hand stays where it is.
#[derive(Debug)]
pub enum EnvelopeSlot {}

impl Slot for EnvelopeSlot {
    type Value = Option<Envelope>;
    type Rate = Held;
    const NAME: &'static str = "envelope";

    fn default() -> Option<Envelope> {
        None
    }
}

/// Whether a switch shows what is below it, where it asks a value sub-graph.
#[derive(Debug)]
pub enum SwitchedOn {}

impl Slot for SwitchedOn {
    type Value = bool;
    type Rate = Held;
    const NAME: &'static str = "switched_on";

    fn default() -> bool {
        true
    }
}

/// Which child a selector shows, where it asks a value sub-graph.
#[derive(Debug)]
pub enum Choice {}

impl Slot for Choice {
    type Value = Option<usize>;
    type Rate = Held;
    const NAME: &'static str = "choice";

    fn default() -> Option<usize> {
        None
    }
}

/// From where detail is judged, in the frame of the view's root: levels of detail are chosen by
/// the distance to it. It is held, not moving, for another level is another plan: set it when
/// the viewer has gone far enough to matter.
#[derive(Debug)]
pub enum Viewpoint {}

impl Slot for Viewpoint {
    type Value = Option<Vec3>;
    type Rate = Held;
    const NAME: &'static str = "viewpoint";

    fn default() -> Option<Vec3> {
        None
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

/// The wind that the view shows: what sways does so by it, as [`Time`] goes by. None blows by default.
#[derive(Debug)]
pub enum WindSlot {}

impl Slot for WindSlot {
    type Value = Wind;
    type Rate = Moving;
    const NAME: &'static str = "wind";

    fn default() -> Wind {
        Wind::default()
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
