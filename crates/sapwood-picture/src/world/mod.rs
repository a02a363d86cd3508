//! What rays meet: everything that is compiled, and a bound for everything that is not yet.
//!
//! Two levels: trees over things, down to the triangles of small meshes, and a tree over triangles
//! with each large mesh. A *cluster* is what one tree holds: the scene's root has one, and so has
//! every component whose bound was foreseen, and everything large that is shared, which then is
//! there once however often it occurs.

mod cluster;
mod gather;
mod line;
mod look;
mod packs;
mod survey;
mod wanted;

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Bound, Digest, FixedMap, SharedMesh, fixed_state};
use sapwood_graph::{
    CrossFade, EnvId, Interrupted, Light, Material, Provide, SiteId, Supplied, discover,
};

pub(crate) use cluster::{Cluster, Item, Place};
pub(crate) use line::{LinePiece, LineWidth};
pub(crate) use look::{Look, Matter};

use gather::{Gather, Task};
use packs::Packs;
use survey::Survey;
use wanted::Wanted;

use crate::texture::Textures;

/// Things and sites that a world may hold, so that no graph fills all memory: with their boxes and
/// their share of a tree about 150 bytes each, and 160 more where triangles lie open.
const MOST_ITEMS: u64 = 1 << 24;

/// What rays meet.
pub(crate) struct World {
    /// The root's is the first.
    pub(crate) clusters: Vec<Cluster>,
    /// Where the surfaces and clusters in them stand.
    pub(crate) places: Vec<Place>,
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) packs: Packs,
    pub(crate) lines: Vec<LinePiece>,
    pub(crate) looks: Vec<Look>,
    pub(crate) waits: Vec<Wait>,
    pub(crate) lights: Vec<PlacedLight>,
    pub(crate) n_filled: u64,
    line_width: LineWidth,
    has_lines: bool,
    n_items: u64,
    /// The looks of materials, by the content of those.
    look_of: FixedMap<Digest, u32>,
    /// The images of all looks, each once.
    textures: Textures,
    survey: Survey,
    /// The clusters of sites that look the same everywhere.
    cluster_of: FixedMap<SiteId, u32>,
    /// The ways to waiting links: the way above and the link; the first is the root.
    ways: Vec<(u32, u32)>,
}

/// A mesh with its look.
pub(crate) struct Surface {
    pub(crate) mesh: SharedMesh,
    pub(crate) look: u32,
    /// In which pixels it is seen; nothing for all.
    pub(crate) cross_fade: Option<CrossFade>,
}

/// A light at its place.
pub(crate) struct PlacedLight {
    pub(crate) light: Light,
    pub(crate) world: Affine3,
}

/// A link that nobody has filled yet.
pub(crate) struct Wait {
    /// What is behind it, in the cluster's frame.
    pub(crate) bound: Bound,
    cluster: u32,
    item: u32,
    /// From the link's frame to the cluster's.
    frame: Affine3,
    /// From the cluster's frame to the root's.
    outside: Affine3,
    way: u32,
}

impl World {
    /// Everything that is compiled, after what has no foreseen bound was compiled too.
    pub(crate) fn new(
        provide: &mut dyn Provide,
        line_width: LineWidth,
    ) -> Result<Self, Interrupted> {
        let mut world = Self {
            clusters: Vec::new(),
            places: Vec::new(),
            surfaces: Vec::new(),
            packs: Packs::default(),
            lines: Vec::new(),
            looks: Vec::new(),
            waits: Vec::new(),
            lights: Vec::new(),
            n_filled: 0,
            line_width,
            has_lines: false,
            n_items: 0,
            look_of: FixedMap::with_hasher(fixed_state()),
            textures: Textures::default(),
            survey: Survey::default(),
            cluster_of: FixedMap::with_hasher(fixed_state()),
            ways: vec![(0, 0)],
        };
        discover(provide, &Wanted::all_unforeseen())?;
        let (env, site) = provide.root();
        let (base, outside) = (Affine3::IDENTITY, Affine3::IDENTITY);
        let task = Task { env, site, base, outside, way: 0, above: None, shows_lights: true };
        Gather::run(&mut world, &*provide, task)?;
        Ok(world)
    }

    /// Whether the world is the same for lines of this width.
    pub(crate) fn suits(&self, line_width: LineWidth) -> bool {
        !self.has_lines || self.line_width == line_width
    }

    /// Compiles what stands behind waiting links, each named once, and whatever has no foreseen
    /// bound below it.
    pub(crate) fn fill(
        &mut self,
        provide: &mut dyn Provide,
        waits: &[u32],
    ) -> Result<(), Interrupted> {
        let paths: Vec<Vec<u32>> = waits.iter().map(|wait| self.path(*wait)).collect();
        discover(provide, &Wanted::new(&paths))?;
        for (wait, path) in waits.iter().zip(&paths) {
            self.n_filled += 1;
            let Wait { cluster, item, frame, outside, way, .. } = self.waits[*wait as usize];
            let filled = match behind(&*provide, path) {
                None => Item::Nothing,
                Some((env, site)) => {
                    let (base, above, shows_lights) = (frame, Some(cluster), false);
                    let task = Task { env, site, base, outside, way, above, shows_lights };
                    Gather::run(self, &*provide, task)?
                }
            };
            self.clusters[cluster as usize].items[item as usize] = filled;
        }
        let mut stale: Vec<u32> =
            waits.iter().map(|wait| self.waits[*wait as usize].cluster).collect();
        // Those further down have larger numbers than those that hold them.
        while let Some(cluster) = stale.iter().copied().max() {
            stale.retain(|other| *other != cluster);
            self.grow_tree(cluster);
            stale.extend(self.clusters[cluster as usize].above);
        }
        Ok(())
    }

    /// Makes the tree of a cluster; those of the clusters in it are there.
    fn grow_tree(&mut self, cluster: u32) {
        let boxes = self.clusters[cluster as usize].boxes(self);
        self.clusters[cluster as usize].set_tree(&boxes);
    }

    /// The links from the root to a waiting one, which is the last.
    fn path(&self, wait: u32) -> Vec<u32> {
        let mut way = self.waits[wait as usize].way;
        let mut links = Vec::new();
        while way != 0 {
            let (above, link) = self.ways[way as usize];
            links.push(link);
            way = above;
        }
        links.reverse();
        links
    }

    /// The number of a place.
    fn place(&mut self, to_local: Affine3, number: u32) -> u32 {
        self.places.push(Place { to_local, number });
        self.places.len() as u32 - 1
    }

    /// The number of a material's look.
    fn look(&mut self, material: &Arc<Material>) -> u32 {
        let next = self.looks.len() as u32;
        let number = *self.look_of.entry(Digest::of(&**material)).or_insert(next);
        if number == next {
            self.looks.push(Look::new(material, &mut self.textures));
        }
        number
    }
}

/// What stands behind the last of these links.
fn behind(provide: &dyn Provide, path: &[u32]) -> Option<(EnvId, SiteId)> {
    let mut here = provide.root();
    for link in path {
        match provide.enter(here.0, here.1, *link) {
            (env, Supplied::Ready(site)) => here = (env, site),
            _ => return None,
        }
    }
    Some(here)
}

impl PlacedLight {
    /// Where the light is.
    pub(crate) fn origin(&self) -> Vec3 {
        self.world.translation
    }

    /// Where it shines, with unit length.
    pub(crate) fn axis(&self) -> Vec3 {
        (-self.world.matrix3.z_axis).normalize_or(Vec3::NEG_Z)
    }
}
