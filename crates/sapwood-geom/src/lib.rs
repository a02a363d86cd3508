//! Geometry without a graph: bounds, meshes, polylines, images, content digests and random streams.
//!
//! Right-handed, metres, radians. Every type is plain data; nothing here knows that a scene, a
//! rule or a render graph exists. All arithmetic goes through `glam` with `libm` and scalar
//! maths, so that the same input gives the same bytes in debug and release builds.

mod aim;
mod bounds;
mod box_tree;
mod digest;
mod edges;
mod envelope;
mod fixed_map;
mod hull;
mod image;
mod mesh;
mod mesh_bvh;
mod polyline;
mod ray;
mod ray32;
mod section;
#[cfg(test)]
mod shapes;
#[cfg(feature = "simplify")]
mod simplify;
mod smooth;
mod solid;
mod stream;
mod sweep;
mod triangle_pack;
mod trig;
mod weld;

pub use aim::Aim;
pub use bounds::{Aabb, Bound, Sphere};
pub use box_tree::BoxTree;
pub use digest::{Content, Digest, Digester, Shared};
pub use envelope::{ClosedMesh, Envelope, NotClosed, Profile, Side};
pub use fixed_map::{FixedMap, FixedSet, fixed_state};
pub use hull::{Circle, convex_hull, smallest_circle};
pub use image::Image;
pub use mesh::{Mesh, SharedMesh};
pub use mesh_bvh::{MeshBvh, MeshHit, MeshHit32, Sides, closest_on_transformed};
pub use polyline::Polyline;
pub use ray::Ray;
pub use ray32::Ray32;
pub use section::Section;
#[cfg(feature = "simplify")]
pub use simplify::Simplify;
#[cfg(feature = "union")]
pub use solid::{Member, Mended, Union, UnionError, UnionStep, UnionWork, Unions, dressed, union};
pub use solid::{Solid, SolidReport};
pub use stream::{Purpose, Stream, StreamPath};
pub use sweep::{
    Around, Cap, Fork, Forking, Ring, RingPlane, Sweep, SweepOptions, SweepStart, Swept, Written,
};
pub use triangle_pack::TrianglePack;
pub use trig::{atan2, atan2_4, sin_cos, sin_cos_4};
pub use weld::{Pieces, Rim, VertexIdentity};

/// The maths library in the version that Sapwood is built with.
pub use glam;
