//! A million components on the built-in rules: as a tree, and as a graph that shares.
//!
//! Everything is measured once, in one process, and printed as a table; no case is repeated
//! until its figure settles. `cargo bench -p sapwood --bench million [tree|shared]`.

mod clock;

use std::time::Duration;

use clock::Moment;
use sapwood::geom::glam::Vec3;
use sapwood::geom::{Aabb, Mesh};
use sapwood::graph::{Everything, Inside, Interest, Material, Order, RenderNode};
use sapwood::scene::{
    Budget, EditError, Group, Handle, HeldGeometry, NodeId, Scene, Transform, ViewId,
};

/// Leaves of the tree, and occurrences in the graph that shares.
const N: usize = 1_000_000;
const N_GEOMETRIES: usize = 16;
const GROUP: usize = 10;
/// Groups of the graph that shares, and children that all of them have in common.
const SHARED: usize = 1_000;

fn main() {
    clock::one_thread();
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| word == name);
    if is_wanted("tree") {
        println!("tree: {N} transforms over {N_GEOMETRIES} shared triangles, in groups of {GROUP}");
        measure(1_000, || tree().expect("the graph has no cycle"));
    }
    if is_wanted("shared") {
        println!("shared: {SHARED} groups, each placed, with the same {SHARED} placed triangles");
        // Each edit is seen in a thousand groups of a thousand.
        measure(10, || shared().expect("the graph has no cycle"));
    }
}

struct Forest {
    scene: Scene,
    view: ViewId,
    /// What edits move.
    leaves: Vec<Handle<Transform>>,
}

/// Measures everything; edits that are made one by one are the mean of `n_edits`.
fn measure(n_edits: usize, build: impl FnOnce() -> Forest) {
    let before = resident();
    let start = Moment::now();
    let mut forest = build();
    row("build the semantic graph", start.elapsed());
    let n_nodes = forest.scene.n_nodes();
    let built = resident();
    let start = Moment::now();
    forest.bounds();
    row("compile cold, to bounds", start.elapsed());
    let compiled = resident();
    row("nothing changed, bounds", repeated(100_000, || forest.bounds()));

    let mut n_done = 0;
    let edits = repeated(n_edits, || {
        forest.edit(&mut n_done);
        forest.bounds();
    });
    row("one edit, then bounds", edits);
    let n = forest.leaves.len() / 100;
    let start = Moment::now();
    forest.scene.bulk(|scene| {
        for leaf in forest.leaves.iter().step_by(100) {
            scene.edit(*leaf, raise).expect("no leaf was removed");
        }
    });
    forest.bounds();
    row(&format!("{n} edits, then bounds"), start.elapsed());

    let start = Moment::now();
    forest.count();
    row("count, for the first time", start.elapsed());
    let counted = repeated(n_edits, || {
        forest.edit(&mut n_done);
        forest.count();
    });
    row("one edit, then count", counted);
    let start = Moment::now();
    let n_meshes = forest.walk(&Everything);
    row(&format!("walk over all {n_meshes} meshes"), start.elapsed());
    let tenth = Aabb { min: Vec3::splat(-1e6), max: Vec3::new(99.5, 1e6, 1e6) };
    let start = Moment::now();
    let n_inside = forest.walk(&Inside(tenth));
    row(&format!("walk over the {n_inside} in a box"), start.elapsed());
    let start = Moment::now();
    let list = forest.scene.draw_list(forest.view, 2 * N).expect("each leaf is one row");
    row("draw list, rebuilt", start.elapsed());
    drop(list);
    let start = Moment::now();
    drop(forest);
    row("taking the scene down", start.elapsed());

    // Memory that an earlier scene has left is taken again, and tells nothing.
    if let (Some(before), Some(built), Some(compiled)) = (before, built, compiled)
        && before < built
        && built < compiled
    {
        let per_node = |bytes: u64| bytes / n_nodes as u64;
        println!("  {n_nodes} components; bytes for each of them:");
        println!("  {:<40} {:>10}", "semantic graph", per_node(built.saturating_sub(before)));
        println!("  {:<40} {:>10}", "compiled", per_node(compiled.saturating_sub(built)));
    }
}

impl Forest {
    fn new(
        mut scene: Scene,
        root: Handle<Group>,
        leaves: Vec<Handle<Transform>>,
    ) -> Result<Self, EditError> {
        let view = scene.open_view(root, &sapwood::standard_rules())?;
        let budget = Budget { plans: u64::MAX, triangles: u64::MAX, ..Budget::default() };
        scene.set_budget(view, budget).expect("the view is open");
        Ok(Self { scene, view, leaves })
    }

    fn bounds(&mut self) {
        self.scene.bounds(self.view).expect("triangles keep to the budget");
    }

    fn count(&mut self) {
        self.scene.count(self.view).expect("triangles keep to the budget");
    }

    /// Moves one leaf, another one each time.
    fn edit(&mut self, n_edits: &mut usize) {
        *n_edits += 1;
        let leaf = self.leaves[*n_edits * 7919 % self.leaves.len()];
        self.scene.edit(leaf, raise).expect("no leaf was removed");
    }

    /// Walks over what an interest asks for and counts the meshes.
    fn walk<I: Interest>(&mut self, interest: &I) -> usize {
        let mut n = 0;
        self.scene
            .traverse(self.view, Order::Pre, interest, &mut |at| {
                n += usize::from(matches!(at.node(), RenderNode::Mesh { .. }));
            })
            .expect("triangles keep to the budget");
        n
    }
}

fn raise(leaf: &mut Transform) {
    leaf.0.translation.y += 1.0;
}

/// A million transforms over shared triangles, in groups of ten to the sixth level.
fn tree() -> Result<Forest, EditError> {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let mut groups: Vec<NodeId> = vec![root.id()];
    while groups.len() * GROUP < N {
        let mut below = Vec::with_capacity(groups.len() * GROUP);
        for group in groups {
            for _ in 0..GROUP {
                below.push(scene.add_to(group, Group)?.id());
            }
        }
        groups = below;
    }
    let geometries = geometries(&mut scene);
    let mut leaves = Vec::with_capacity(N);
    for i in 0..N {
        let (x, z) = ((i / 1000) as f32, (i % 1000) as f32);
        let leaf = scene.add_to(groups[i / GROUP], Transform::translation(x, 0.0, z))?;
        scene.append(leaf, geometries[i % N_GEOMETRIES])?;
        leaves.push(leaf);
    }
    Forest::new(scene, root, leaves)
}

/// A thousand placed groups that share their thousand children.
fn shared() -> Result<Forest, EditError> {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let geometries = geometries(&mut scene);
    let mut leaves = Vec::with_capacity(SHARED);
    for i in 0..SHARED {
        let leaf = scene.add(Transform::translation(0.0, 0.0, i as f32));
        scene.append(leaf, geometries[i % N_GEOMETRIES])?;
        leaves.push(leaf);
    }
    for i in 0..SHARED {
        let place = scene.add_to(root, Transform::translation(i as f32, 0.0, 0.0))?;
        let group = scene.add_to(place, Group)?;
        for leaf in &leaves {
            scene.append(group, *leaf)?;
        }
    }
    Forest::new(scene, root, leaves)
}

fn geometries(scene: &mut Scene) -> Vec<Handle<HeldGeometry>> {
    let triangle = |size: f32| Mesh {
        positions: vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Default::default(); 3],
        indices: vec![0, 1, 2],
    };
    let leaf =
        |i| HeldGeometry::new(triangle(i as f32 * 0.01), Material::matte("leaf", 0.1, 0.3, 0.05));
    (0..N_GEOMETRIES).map(|i| scene.add(leaf(i + 10))).collect()
}

/// The mean of `n` runs.
fn repeated(n: usize, mut run: impl FnMut()) -> Duration {
    let start = Moment::now();
    (0..n).for_each(|_| run());
    start.elapsed() / n as u32
}

fn row(case: &str, time: Duration) {
    println!("  {case:<40} {time:>10.3?}");
}

/// Bytes of memory that the process has now, where the system tells.
fn resident() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(text.split_whitespace().nth(1)?.parse::<u64>().ok()? * 4096)
}
