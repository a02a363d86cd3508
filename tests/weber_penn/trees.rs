//! Scenes with trees in them, and what tests ask of them.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Aabb, Digest, Digester};
use sapwood::graph::{DrawList, Everything, Order};
use sapwood::rules::weber_penn::{Leaf, Origin, Value};
use sapwood::rules::weber_penn::{Seed, Segment, Species, Stem, Tree, key};
use sapwood::scene::{Action, Attribute, Handle, Scene, ViewId};

/// The species that tests take which grow each one very often: all whose numbers were published.
/// They have between them what the model knows; those of the library's own would only make such
/// tests slow, and are held by the tests that grow each once or a few times.
pub(super) fn published() -> Vec<&'static str> {
    let is_published = |name: &&str| built_in(name).origin != Origin::Sapwood;
    sapwood::io::built_in_names().filter(is_published).collect()
}

/// One tree below its species, with a view of the whole.
pub(super) struct Grown {
    pub(super) scene: Scene,
    pub(super) family: Handle<Attribute>,
    pub(super) tree: Handle<Tree>,
    pub(super) view: ViewId,
}

/// A scene with its log on and in check mode.
pub(super) fn checked_scene() -> Scene {
    let mut scene = Scene::new();
    scene.set_logging(true);
    scene.set_check_mode(true);
    scene
}

/// A tree in a checked scene, not compiled yet.
pub(super) fn planted(species: &Species, seed: u64) -> Grown {
    planted_in(checked_scene(), species, seed)
}

pub(super) fn planted_in(mut scene: Scene, species: &Species, seed: u64) -> Grown {
    let family = scene.add(species.attribute());
    let tree = scene.add_to(family, Tree { seed: Seed::Explicit(seed) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    Grown { scene, family, tree, view }
}

/// A tree in a checked scene, compiled, with an empty log.
pub(super) fn grown(species: &Species, seed: u64) -> Grown {
    let mut grown = planted(species, seed);
    grown.scene.bounds(grown.view).unwrap();
    grown.scene.take_log();
    grown
}

impl Grown {
    /// Sets the species that the tree is of.
    pub(super) fn set(&mut self, species: &Species) {
        self.scene.edit(self.family, |attribute| species.set(attribute)).unwrap();
    }

    /// Brings everything up to date and tells what was compiled for it.
    pub(super) fn compiled(&mut self) -> Vec<(&'static str, usize)> {
        compiled(&mut self.scene, self.view)
    }

    pub(super) fn parts(&mut self) -> Parts {
        parts(&mut self.scene, self.view)
    }

    pub(super) fn draw_list(&mut self) -> DrawList {
        self.scene.draw_list(self.view, 1_000_000).unwrap()
    }
}

/// Brings a view up to date and tells what was compiled since the log was taken last, as sorted
/// kinds with numbers.
pub(super) fn compiled(scene: &mut Scene, view: ViewId) -> Vec<(&'static str, usize)> {
    scene.bounds(view).unwrap();
    let log = scene.take_log();
    let compiled = log.iter().filter(|event| event.action == Action::Compiled);
    let mut names: Vec<_> = compiled.map(|event| event.kind.name()).collect();
    names.sort_unstable();
    names.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
}

/// The parts of all trees in a view: stems and segments by level, and leaves, each with its
/// transform to the world.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) stems: Vec<Vec<Stem>>,
    pub(super) segments: Vec<Vec<(Affine3, Segment)>>,
    pub(super) leaves: Vec<(Affine3, Leaf)>,
}

pub(super) fn parts(scene: &mut Scene, view: ViewId) -> Parts {
    let mut parts = Parts::default();
    let visit = &mut |at: &sapwood::graph::At<'_, ()>| {
        if !at.enters_plan() {
            return;
        }
        let plan = at.plan();
        let leaves = plan.parts.of::<Leaf>();
        parts.leaves.extend(leaves.iter().map(|leaf| (*at.world(), *leaf)));
        let stems = plan.parts.of::<Stem>();
        let Some(first) = stems.first() else { return };
        let level = usize::from(first.seed.level);
        if parts.stems.len() <= level {
            parts.stems.resize_with(level + 1, Vec::new);
            parts.segments.resize_with(level + 1, Vec::new);
        }
        parts.stems[level].extend_from_slice(stems);
        let segments = plan.parts.of::<Segment>();
        parts.segments[level].extend(segments.iter().map(|segment| (*at.world(), *segment)));
    };
    scene.traverse(view, Order::Pre, &Everything, visit).unwrap();
    parts
}

/// The digest of everything that is drawn, to the last bit: not the digests that the cache
/// keeps, but the values.
pub(super) fn digest(list: &DrawList) -> Digest {
    let mut digester = Digester::new();
    for (world, row) in list.placed_rows() {
        digester.add(&world).add(&*row.material).add(&*row.mesh);
        digester.add(&row.instances.as_deref());
    }
    for (world, row) in list.placed_lines() {
        digester.add(&world);
        for line in row.lines.iter() {
            digester.add(&line.points).add(&line.radii);
        }
    }
    digester.finish()
}

/// The first thing wrong with what is drawn: a faulty mesh, a number that is none, something
/// outside the bound.
pub(super) fn fault(list: &DrawList, bound: &Aabb) -> Option<String> {
    let slack = Vec3::splat(1e-4 * (1.0 + bound.size().max_element()));
    let all = Aabb { min: bound.min - slack, max: bound.max + slack };
    let inside = |point: Vec3| point.cmpge(all.min).all() && point.cmple(all.max).all();
    for (world, row) in list.placed_rows() {
        if let Some(fault) = row.mesh.fault() {
            return Some(fault);
        }
        let transforms = match &row.instances {
            Some(instances) => instances.iter().map(|instance| world * *instance).collect(),
            None => vec![world],
        };
        for transform in transforms {
            if !transform.is_finite() {
                return Some(format!("{transform:?}"));
            }
            let mut points = row.mesh.positions.iter().map(|p| transform.transform_point3(*p));
            if let Some(outside) = points.find(|point| !inside(*point)) {
                return Some(format!("{outside} lies outside {bound:?}"));
            }
        }
    }
    None
}

/// A built-in species.
pub(super) fn built_in(name: &str) -> Species {
    sapwood::io::built_in(name).unwrap()
}

/// An aspen with few branches and leaves, for tests with many trees.
pub(super) fn sapling() -> Species {
    let aspen = built_in("quaking_aspen");
    with(&aspen, &[("level.1.branches", 6.0), ("level.2.branches", 5.0), ("leaves.count", 4.0)])
}

/// A species with some values changed.
pub(super) fn with(species: &Species, values: &[(&str, f32)]) -> Species {
    let mut species = species.clone();
    for (name, value) in values {
        key(name).unwrap().set(&mut species, &Value::Number(*value)).unwrap();
    }
    species
}
