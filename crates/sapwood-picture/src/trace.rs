//! Rays through the world: what one meets first, and whether anything stops it.

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{MeshHit32, Ray32};
use smallvec::{SmallVec, smallvec};

use crate::world::{Cluster, Item, Look, Surface, World};

/// Clusters that one ray may go through, so that no graph keeps a picture busy for ever; where
/// many are ahead, each counts for as many as it takes to find the nearest.
pub(crate) const MOST_CLUSTERS: u32 = 1 << 20;

/// What a ray meets first.
pub(crate) enum Met {
    /// Something that is seen.
    Hit(Hit),
    /// The bound of what stands behind a link that nobody has filled.
    Waiting(u32),
    /// Nothing.
    Nothing,
    /// More clusters than a ray may go through.
    TooMuch,
}

/// What is seen, and how far away.
pub(crate) struct Hit {
    pub(crate) distance: f32,
    pub(crate) thing: Thing,
}

/// What is seen.
pub(crate) enum Thing {
    /// A triangle of a surface.
    Triangle {
        /// The number of the surface.
        surface: u32,
        /// Where on its mesh.
        hit: MeshHit32,
        /// From the root's frame to the mesh's.
        to_local: Affine3,
    },
    /// A line.
    Line {
        /// Away from the line's axis, in the root's frame.
        normal: Vec3,
    },
}

/// Whether something stops a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passage {
    /// Nothing does.
    Clear,
    /// Something does.
    Stopped,
    /// Nothing does that is known, but something may behind this link.
    Waiting(u32),
    /// The ray may not go through so many clusters.
    TooMuch,
}

/// A cluster that a ray has yet to go through.
struct Pending {
    enters: f32,
    cluster: u32,
    /// The ray in the cluster's frame.
    ray: Ray32,
    /// From the root's frame to the cluster's.
    to_local: Affine3,
}

/// The clusters that a ray has yet to go through.
struct Ahead {
    pending: SmallVec<[Pending; 4]>,
    n_left: u32,
}

impl Ahead {
    fn new(ray: &Ray32) -> Self {
        let root = Pending { enters: 0.0, cluster: 0, ray: *ray, to_local: Affine3::IDENTITY };
        Self { pending: smallvec![root], n_left: MOST_CLUSTERS }
    }

    /// The nearest of them.
    fn next(&mut self) -> Option<Pending> {
        let mut nearest = 0;
        for (i, pending) in self.pending.iter().enumerate() {
            if pending.enters < self.pending[nearest].enters {
                nearest = i;
            }
        }
        if self.pending.is_empty() {
            return None;
        }
        self.n_left = self.n_left.saturating_sub(1 + self.pending.len() as u32 / 16);
        Some(self.pending.swap_remove(nearest))
    }
}

impl World {
    /// What a ray meets first before `reach`. `chance`, from 0 to 1, decides whether what is half
    /// there is met.
    pub(crate) fn nearest(&self, ray: &Ray32, reach: f32, chance: f32) -> Met {
        let mut met = Met::Nothing;
        let mut limit = reach;
        let mut ahead = Ahead::new(ray);
        while let Some(next) = ahead.next() {
            if next.enters > limit {
                break;
            }
            if ahead.n_left == 0 {
                return Met::TooMuch;
            }
            let cluster = &self.clusters[next.cluster as usize];
            cluster.tree.along32(&next.ray, limit, |number| {
                match &cluster.items[number as usize] {
                    Item::Surface { surface, to_local } => {
                        let Surface { mesh, look } = &self.surfaces[*surface as usize];
                        let look = &self.looks[*look as usize];
                        let ray = next.ray.transformed(to_local);
                        let hit = mesh.bvh().nearest32(mesh, &ray, limit, |hit| {
                            (hit.is_front || look.is_double_sided())
                                && is_there(mesh, look, hit, chance)
                        });
                        if let Some(hit) = hit {
                            limit = hit.distance;
                            let to_local = *to_local * next.to_local;
                            let thing = Thing::Triangle { surface: *surface, hit, to_local };
                            met = Met::Hit(Hit { distance: hit.distance, thing });
                        }
                    }
                    Item::Line(piece) => {
                        if let Some(hit) = piece.meet(&next.ray)
                            && hit.distance < limit
                        {
                            limit = hit.distance;
                            let normal = next.to_local.matrix3.transpose() * hit.normal;
                            let thing = Thing::Line { normal: normal.normalize_or(Vec3::Y) };
                            met = Met::Hit(Hit { distance: hit.distance, thing });
                        }
                    }
                    Item::Waiting(wait) => {
                        if let Some(distance) = self.waits_at(*wait, &next.ray)
                            && distance < limit
                        {
                            limit = distance;
                            met = Met::Waiting(*wait);
                        }
                    }
                    Item::Cluster { cluster, to_local } => {
                        ahead.pending.extend(self.entered(*cluster, to_local, &next, limit));
                    }
                    Item::Nothing => {}
                }
                limit
            });
        }
        met
    }

    /// Whether anything stops a ray before `reach`, whichever side of it is met.
    pub(crate) fn passage(&self, ray: &Ray32, reach: f32, chance: f32) -> Passage {
        let mut is_stopped = false;
        let mut waiting: Option<(f32, u32)> = None;
        let mut ahead = Ahead::new(ray);
        while let Some(next) = ahead.next() {
            if ahead.n_left == 0 {
                return Passage::TooMuch;
            }
            let cluster: &Cluster = &self.clusters[next.cluster as usize];
            cluster.tree.along32(&next.ray, reach, |number| {
                match &cluster.items[number as usize] {
                    Item::Surface { surface, to_local } => {
                        let Surface { mesh, look } = &self.surfaces[*surface as usize];
                        let look = &self.looks[*look as usize];
                        let ray = next.ray.transformed(to_local);
                        is_stopped = is_stopped
                            || mesh.bvh().is_met32(mesh, &ray, reach, |hit| {
                                is_there(mesh, look, hit, chance)
                            });
                    }
                    Item::Line(piece) => {
                        let hit = piece.meet(&next.ray);
                        is_stopped |= hit.is_some_and(|hit| hit.distance < reach);
                    }
                    Item::Waiting(wait) => {
                        if let Some(distance) = self.waits_at(*wait, &next.ray)
                            && waiting.is_none_or(|nearest| (distance, *wait) < nearest)
                            && distance < reach
                        {
                            waiting = Some((distance, *wait));
                        }
                    }
                    Item::Cluster { cluster, to_local } => {
                        ahead.pending.extend(self.entered(*cluster, to_local, &next, reach));
                    }
                    Item::Nothing => {}
                }
                if is_stopped { -1.0 } else { reach }
            });
            if is_stopped {
                return Passage::Stopped;
            }
        }
        waiting.map_or(Passage::Clear, |(_, wait)| Passage::Waiting(wait))
    }

    /// Where a ray enters the bound of what waits, if it does.
    fn waits_at(&self, wait: u32, ray: &Ray32) -> Option<f32> {
        let bound = &self.waits[wait as usize].bound;
        Some(ray.enters(&bound.aabb)?.max(ray.enters_sphere(&bound.sphere)?))
    }

    /// A cluster in another one, if a ray enters it before `reach`.
    fn entered(
        &self,
        cluster: u32,
        to_local: &Affine3,
        above: &Pending,
        reach: f32,
    ) -> Option<Pending> {
        let ray = above.ray.transformed(to_local);
        let enters = ray.enters(&self.clusters[cluster as usize].aabb)?;
        let to_local = *to_local * above.to_local;
        (enters <= reach).then_some(Pending { enters, cluster, ray, to_local })
    }
}

/// Whether a surface is there where it was hit.
#[inline]
fn is_there(mesh: &sapwood_geom::Mesh, look: &Look, hit: &MeshHit32, chance: f32) -> bool {
    !look.has_holes || look.is_there(uv_at(mesh, hit), chance)
}

/// The texture coordinate of a hit.
pub(crate) fn uv_at(mesh: &sapwood_geom::Mesh, hit: &MeshHit32) -> Vec2 {
    let first = 3 * hit.triangle as usize;
    let uv = |corner: usize| mesh.uvs[mesh.indices[first + corner] as usize];
    uv(0) * hit.weights.x + uv(1) * hit.weights.y + uv(2) * hit.weights.z
}
