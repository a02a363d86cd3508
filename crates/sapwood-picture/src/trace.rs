//! Rays through the world: what one meets first, and whether anything stops it.

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Aim, MeshHit32, Ray32, SharedMesh};
use sapwood_graph::CrossFade;
use smallvec::{SmallVec, smallvec};

use crate::world::{Item, Look, Place, Surface, World};

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
        /// The number of its look, where it has one.
        look: Option<u32>,
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
    /// What a ray meets first before `reach`; `chance` decides whether what is half there is met.
    pub(crate) fn nearest(&self, ray: &Ray32, reach: f32, chance: Chance) -> Met {
        let mut met = Met::Nothing;
        let mut limit = reach;
        // The place and the triangle, where that is the nearest so far.
        let mut on: Option<(u32, u32)> = None;
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
                match cluster.items[number as usize] {
                    Item::Triangles { place, first, n_packs } => {
                        let near = self.approached(place, &next.ray);
                        for pack in self.packs.of(first, n_packs) {
                            for triangle in pack.on_the_way(&near.aim) {
                                let Some(hit) = MeshHit32::on(near.mesh, &near.aim, triangle)
                                else {
                                    continue;
                                };
                                // As near, the first on its mesh goes before.
                                let precedes = hit.distance < limit
                                    || hit.distance == limit
                                        && on.is_some_and(|(p, t)| p == place && triangle < t);
                                if precedes && near.is_seen(&hit, chance) {
                                    limit = hit.distance;
                                    on = Some((place, triangle));
                                    met = near.met(hit, &next.to_local);
                                }
                            }
                        }
                    }
                    Item::Surface(place) => {
                        let near = self.approached(place, &next.ray);
                        let accept = |hit: &MeshHit32| near.is_seen(hit, chance);
                        let hit = near.mesh.bvh().nearest32(near.mesh, &near.aim, limit, accept);
                        if let Some(hit) = hit {
                            limit = hit.distance;
                            on = None;
                            met = near.met(hit, &next.to_local);
                        }
                    }
                    Item::Line(piece) => {
                        if let Some(hit) = self.lines[piece as usize].meet(&next.ray)
                            && hit.distance < limit
                        {
                            limit = hit.distance;
                            let normal = next.to_local.matrix3.transpose() * hit.normal;
                            let look = self.lines[piece as usize].look;
                            let thing = Thing::Line { normal: normal.normalize_or(Vec3::Y), look };
                            met = Met::Hit(Hit { distance: hit.distance, thing });
                        }
                    }
                    Item::Waiting(wait) => {
                        if let Some(distance) = self.waits_at(wait, &next.ray)
                            && distance < limit
                        {
                            limit = distance;
                            met = Met::Waiting(wait);
                        }
                    }
                    Item::Cluster(place) => {
                        ahead.pending.extend(self.entered(place, &next, limit));
                    }
                    Item::Nothing => {}
                }
                limit
            });
        }
        met
    }

    /// Whether anything stops a ray before `reach`, whichever side of it is met.
    pub(crate) fn passage(&self, ray: &Ray32, reach: f32, chance: Chance) -> Passage {
        let mut is_stopped = false;
        let mut waiting: Option<(f32, u32)> = None;
        let mut ahead = Ahead::new(ray);
        while let Some(next) = ahead.next() {
            if ahead.n_left == 0 {
                return Passage::TooMuch;
            }
            let cluster = &self.clusters[next.cluster as usize];
            cluster.tree.along32(&next.ray, reach, |number| {
                if is_stopped {
                    return -1.0;
                }
                match cluster.items[number as usize] {
                    Item::Triangles { place, first, n_packs } => {
                        let near = self.approached(place, &next.ray);
                        let packs = self.packs.of(first, n_packs).iter();
                        let mut triangles = packs.flat_map(|pack| pack.on_the_way(&near.aim));
                        is_stopped = triangles.any(|triangle| {
                            MeshHit32::on(near.mesh, &near.aim, triangle).is_some_and(|hit| {
                                hit.distance < reach && near.is_there(&hit, chance)
                            })
                        });
                    }
                    Item::Surface(place) => {
                        let near = self.approached(place, &next.ray);
                        let accept = |hit: &MeshHit32| near.is_there(hit, chance);
                        is_stopped = near.mesh.bvh().is_met32(near.mesh, &near.aim, reach, accept);
                    }
                    Item::Line(piece) => {
                        let hit = self.lines[piece as usize].meet(&next.ray);
                        is_stopped = hit.is_some_and(|hit| hit.distance < reach);
                    }
                    Item::Waiting(wait) => {
                        if let Some(distance) = self.waits_at(wait, &next.ray)
                            && waiting.is_none_or(|nearest| (distance, wait) < nearest)
                            && distance < reach
                        {
                            waiting = Some((distance, wait));
                        }
                    }
                    Item::Cluster(place) => {
                        ahead.pending.extend(self.entered(place, &next, reach));
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
    fn entered(&self, place: u32, above: &Pending, reach: f32) -> Option<Pending> {
        let Place { to_local, number: cluster } = &self.places[place as usize];
        let ray = above.ray.transformed(to_local);
        let enters = ray.enters(&self.clusters[*cluster as usize].aabb)?;
        let to_local = *to_local * above.to_local;
        (enters <= reach).then_some(Pending { enters, cluster: *cluster, ray, to_local })
    }

    /// A surface and a ray, seen from its frame.
    #[inline]
    fn approached(&self, place: u32, ray: &Ray32) -> Approached<'_> {
        let Place { to_local, number: surface } = &self.places[place as usize];
        let Surface { mesh, look, cross_fade } = &self.surfaces[*surface as usize];
        let look = &self.looks[*look as usize];
        let aim = Aim::new(ray.transformed(to_local));
        Approached { surface: *surface, mesh, look, cross_fade: *cross_fade, to_local, aim }
    }
}

/// The numbers from 0 to 1 by which a ray meets what is half there.
#[derive(Clone, Copy)]
pub(crate) struct Chance {
    /// Of the whole path: where it meets one of two that fade into each other, the other casts no
    /// shadow on it.
    of_path: f32,
    /// Of this ray alone, for coverage.
    own: Option<f32>,
}

impl Chance {
    /// Of a ray that has no number of its own.
    pub(crate) fn of_path(number: f32) -> Self {
        Self { of_path: number, own: None }
    }

    /// The same with a number of its own, so that rays of one path do not meet all of them the
    /// same.
    pub(crate) fn with(self, own: f32) -> Self {
        Self { own: Some(own), ..self }
    }

    /// The number that decides about coverage, where the thing is drawn at all.
    fn within(self, fade: Option<CrossFade>) -> Option<f32> {
        let Some(fade) = fade else { return Some(self.own.unwrap_or(self.of_path)) };
        // What is drawn has only some of the path's numbers left, which stand for all of them.
        let rest = || {
            let first = f32::from(fade.first);
            (self.of_path * f32::from(CrossFade::STEPS) - first) / (f32::from(fade.end) - first)
        };
        fade.shows(self.of_path).then(|| self.own.unwrap_or_else(rest))
    }
}

/// A surface that a ray comes by.
struct Approached<'a> {
    surface: u32,
    mesh: &'a SharedMesh,
    look: &'a Look,
    cross_fade: Option<CrossFade>,
    /// From the cluster's frame to the mesh's.
    to_local: &'a Affine3,
    /// In the mesh's frame.
    aim: Aim,
}

impl Approached<'_> {
    /// Whether the surface is there where it was hit.
    #[inline]
    fn is_there(&self, hit: &MeshHit32, chance: Chance) -> bool {
        chance.within(self.cross_fade).is_some_and(|chance| {
            !self.look.has_holes || self.look.is_there(uv_at(self.mesh, hit), chance)
        })
    }

    /// Whether it is, and is seen from the side that was hit.
    #[inline]
    fn is_seen(&self, hit: &MeshHit32, chance: Chance) -> bool {
        (hit.is_front || self.look.is_double_sided()) && self.is_there(hit, chance)
    }

    fn met(&self, hit: MeshHit32, outside: &Affine3) -> Met {
        let to_local = *self.to_local * *outside;
        let thing = Thing::Triangle { surface: self.surface, hit, to_local };
        Met::Hit(Hit { distance: hit.distance, thing })
    }
}

/// The texture coordinate of a hit.
pub(crate) fn uv_at(mesh: &sapwood_geom::Mesh, hit: &MeshHit32) -> Vec2 {
    let first = 3 * hit.triangle as usize;
    let uv = |corner: usize| mesh.uvs[mesh.indices[first + corner] as usize];
    uv(0) * hit.weights.x + uv(1) * hit.weights.y + uv(2) * hit.weights.z
}
