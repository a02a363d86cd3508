//! Picking: what a ray meets first.
//!
//! Only what the ray needs is compiled: components whose bound it misses are not, nor those
//! that lie behind what was compiled before and is met. Of what is compiled, plans are gone
//! into from near to far, and never behind the nearest hit so far. Triangles and instances are
//! found through trees that are made when a ray first comes by, and kept with the mesh and with
//! the plan.
//!
//! Meshes, lines and labels are picked; lights and cameras are not, and what an image's coverage
//! leaves out is picked all the same.

mod hit;
mod lines;
mod search;
mod sight;

pub use hit::{Hit, PickedPart, Struck};
pub use sight::AlongRay;

use sapwood_geom::Ray;

use crate::{Interrupted, Provide, Supply, discover};

/// What a ray may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickOptions {
    /// Which sides of triangles.
    pub sides: PickedSides,
    /// Whether labels, by the rectangle that holds them.
    pub labels: bool,
    /// How many metres the ray may pass by a line; lines are not met where there is none.
    pub line_radius: Option<f32>,
    /// How many places the ray may come by, so that no graph keeps a pick busy for ever.
    pub most_occurrences: u32,
}

impl Default for PickOptions {
    /// Both sides of triangles, and labels; ten million places.
    fn default() -> Self {
        Self {
            sides: PickedSides::Both,
            labels: true,
            line_radius: None,
            most_occurrences: 10_000_000,
        }
    }
}

/// Which sides of triangles a ray meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PickedSides {
    /// Both.
    #[default]
    Both,
    /// Those that are drawn: both where the material says so, else the front.
    AsDrawn,
}

/// What a ray in the root's frame meets first; where several things are as near, that which
/// comes first in pre-order. A ray that is not sound meets nothing.
///
/// # Errors
/// When compiling was cancelled or a budget ran out, or the ray comes by too many places.
pub fn pick(
    provide: &mut dyn Provide,
    ray: &Ray,
    options: &PickOptions,
) -> Result<Option<Hit>, Interrupted> {
    let compiled = pick_compiled(&*provide, ray, options)?;
    if !ray.is_sound() || provide.is_settled(provide.root().1) {
        return Ok(compiled);
    }
    discover(provide, &AlongRay::new(ray, options, compiled.as_ref()))?;
    pick_compiled(&*provide, ray, options)
}

/// What a ray meets first of what is compiled and up to date.
///
/// # Errors
/// When the ray comes by more places than the options allow.
pub fn pick_compiled(
    supply: &dyn Supply,
    ray: &Ray,
    options: &PickOptions,
) -> Result<Option<Hit>, Interrupted> {
    if ray.is_sound() { search::Search::new(supply, ray, options).run() } else { Ok(None) }
}
