//! Traversals of a script, each compared with the reference, and with a scene built anew.

use std::collections::BTreeMap;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Aabb, Polyline, SharedMesh};
use sapwood::graph::{DrawList, Inside, Interest, Order, RenderNode, Under};

use super::mirror::View;
use super::reference::{Expected, Item, Sort, expected};
use super::script::Script;

/// More than any view shows.
const MANY: usize = 1_000_000;

/// So many components of a view are told of in outlines.
const A_FEW: usize = 300;

/// How far from where it must be something may be that turns by any angle, relative to how far
/// out it is: the engine reckons in 32 bits.
const TOLERANCE: f64 = 1e-3;

/// Something that the engine draws.
#[derive(Debug)]
struct Found {
    sort: Sort,
    world: Affine3,
    size: f32,
    look: String,
    /// Which triangles are drawn, where that was asked.
    part: Option<[u32; 2]>,
}

impl Script {
    /// A random traversal of a random view.
    pub(super) fn traverse(&mut self) {
        let place = self.dice.below(self.views.len());
        let view = self.views[place];
        let kind = self.dice.below(10);
        self.note(format!("traverse view {place}: {kind}"));
        match kind {
            0 => self.check_cold(&view),
            1 => self.check_bounds(&view),
            2 => self.check_counts(&view),
            3 | 4 => self.check_rows(&view),
            5 => self.check_diagnostics(&view),
            6 | 7 => self.cull(&view),
            _ => self.pick(&view),
        }
    }

    /// Every traversal of every view.
    pub(super) fn check_all(&mut self) {
        self.note("check all".to_owned());
        for view in self.views.clone() {
            self.check_rows(&view);
            self.check_counts(&view);
            self.check_diagnostics(&view);
            self.check_bounds(&view);
            self.check_cold(&view);
        }
        assert_eq!(self.scene.fault(), None);
    }

    fn check_rows(&mut self, view: &View) {
        let list = self.scene.draw_list(view.id, MANY).unwrap();
        let found = drawn(&list);
        let mut expected = expected(&self.mirror, view, &[]).items;
        expected.sort_by_key(|item| item.sort);
        assert_eq!(found.len(), expected.len(), "rows are drawn");
        found.iter().zip(&expected).for_each(|(found, expected)| assert_fits(found, expected));
    }

    fn check_counts(&mut self, view: &View) {
        let counts = self.scene.count(view.id).unwrap();
        let counts: Vec<_> = counts.components.iter().map(|(k, n)| (k.name(), *n)).collect();
        let expected = expected(&self.mirror, view, &[]).counts;
        assert_same(&counts, &expected.into_iter().collect::<Vec<_>>(), "counts");
    }

    fn check_diagnostics(&mut self, view: &View) {
        let found = self.scene.diagnostics(view.id, MANY).unwrap();
        let mut kinds: Vec<_> = found.iter().map(|(_, found)| found.kind.name()).collect();
        kinds.sort_unstable();
        assert_same(&kinds, &expected(&self.mirror, view, &[]).errors, "diagnostics");
    }

    /// What is turned must lie inside the bounds, everything else must reach to them.
    fn check_bounds(&mut self, view: &View) {
        let found = self.scene.bounds(view.id).unwrap().aabb;
        let items = expected(&self.mirror, view, &[]).items;
        let boxes =
            |items: &[&Item]| items.iter().fold(Aabb::EMPTY, |all, item| all.union(item.around));
        let all: Vec<&Item> = items.iter().collect();
        assert_eq!(found.is_empty(), boxes(&all).is_empty());
        let sure: Vec<&Item> = items.iter().filter(|item| !item.is_vague).collect();
        let needed = boxes(&sure);
        if needed.is_empty() {
            return;
        }
        let slack = 0.01 + 2.0 * TOLERANCE as f32 * needed.min.abs().max(needed.max.abs());
        let is_inside =
            needed.min.cmpge(found.min - slack).all() && needed.max.cmple(found.max + slack).all();
        assert!(is_inside, "{needed:?} is not inside the bounds {found:?}");
        if items.iter().all(|item| !item.is_turned) {
            let apart = (found.min - needed.min).abs().max((found.max - needed.max).abs());
            assert!(apart.max_element() < 0.01, "bounds {found:?} instead of {needed:?}");
        }
    }

    /// Compares with a scene that never knew anything else.
    fn check_cold(&mut self, view: &View) {
        let (mut cold, id) = self.mirror.rebuilt(view);
        let bounds = self.scene.bounds(view.id).unwrap();
        assert_eq!(bounds, cold.bounds(id).unwrap(), "bounds");
        let outlines = [self.scene.outline(view.id, A_FEW), cold.outline(id, A_FEW)];
        let outlines = outlines.map(|outline| {
            let outline = outline.unwrap();
            outline.lines().map(str::to_owned).collect::<Vec<_>>()
        });
        let dumps = [self.scene.dump(view.id, MANY), cold.dump(id, MANY)];
        let [dump, cold] = dumps.map(|dump| {
            let dump = dump.unwrap();
            dump.lines().map(str::to_owned).collect::<Vec<_>>()
        });
        assert_same(&dump, &cold, "dumps");
        assert_same(&outlines[0], &outlines[1], "outlines");
    }

    /// What is met on a walk, by the links that lead there.
    fn met<I: Interest>(&mut self, view: &View, interest: &I) -> BTreeMap<Vec<u32>, Found> {
        let order = self.dice.pick(&[Order::Pre, Order::In, Order::Post, Order::Level]);
        let mut met = BTreeMap::new();
        let visitor = &mut |at: &sapwood::graph::At<'_, I::State>| {
            if let Some(found) = found(*at.world(), at.node()) {
                let path = at.path().links();
                let before = met.insert(path, found);
                assert!(before.is_none(), "{before:?} was met at the same place");
            }
        };
        self.scene.traverse(view.id, order, interest, visitor).unwrap();
        met
    }

    /// Everything that lies inside a box must be met; what lies outside may be.
    fn cull(&mut self, view: &View) {
        let Expected { items, .. } = expected(&self.mirror, view, &[]);
        let seen: Vec<&Item> = items.iter().filter(|item| !item.around.is_empty()).collect();
        let middle = match seen.len() {
            0 => Vec3::ZERO,
            n => seen[self.dice.below(n)].around.min,
        };
        // No face of the box touches a corner of a mesh.
        let half = Vec3::splat(0.13 + self.dice.log_even(1.0, 200.0) as f32);
        let inside = Aabb { min: middle - half, max: middle + half };
        let met = self.met(view, &Inside(inside));
        for item in &items {
            // Whatever is turned must lie well inside.
            let slack = if item.is_turned { 0.1 + middle.length() * 1e-2 } else { 0.0 };
            let within = Aabb { min: inside.min + slack, max: inside.max - slack };
            let is_inside = !within.is_empty() && item.around.intersects(&within);
            let is_needed = is_inside && !item.is_vague && !item.around.is_empty();
            match met.get(&item.path) {
                Some(found) => assert_fits(found, item),
                None => assert!(!is_needed, "{item:?} is inside {inside:?} and not met"),
            }
        }
        let known = |path: &Vec<u32>| items.iter().any(|item| item.path == *path);
        let n_known = items.iter().filter(|item| met.contains_key(&item.path)).count();
        let stranger = || met.iter().find(|(path, _)| !known(path));
        assert_eq!(n_known, met.len(), "{:?} is not in the scene", stranger());
    }

    /// Exactly what lies on the way to a place and below it must be met.
    fn pick(&mut self, view: &View) {
        let mut paths = expected(&self.mirror, view, &[]).paths;
        let place = self.dice.below(paths.len());
        let path = paths.swap_remove(place);
        let needed = expected(&self.mirror, view, &path).items;
        let met = self.met(view, &Under(path));
        for item in &needed {
            let found = met.get(&item.path);
            assert_fits(found.unwrap_or_else(|| panic!("{item:?} is not met")), item);
        }
        assert_eq!(met.len(), needed.len(), "what is met under a path");
    }
}

/// What is drawn, by sort, in order.
fn drawn(list: &DrawList) -> Vec<Found> {
    let meshes = list.placed_rows().map(|(world, row)| {
        let all = [0, row.mesh.n_triangles() as u32];
        let part = Some(row.range.map_or(all, |range| [range.first, range.end]));
        Found { part, ..mesh(world, &row.mesh, &row.material.name) }
    });
    let lines = list.placed_lines().map(|(world, row)| lines(world, &row.lines));
    let lights =
        list.placed_lights().map(|(world, light)| plain(Sort::Light, world, light.intensity));
    let cameras =
        list.placed_cameras().map(|(world, camera)| plain(Sort::Camera, world, camera.near));
    let labels = list.placed_labels().map(|(world, label)| plain(Sort::Label, world, label.height));
    meshes.chain(lines).chain(lights).chain(cameras).chain(labels).collect()
}

fn found(world: Affine3, node: RenderNode<'_>) -> Option<Found> {
    match node {
        RenderNode::Mesh { mesh: drawn, material } => Some(mesh(world, drawn, &material.name)),
        RenderNode::Lines(drawn) => Some(lines(world, drawn)),
        RenderNode::Light(light) => Some(plain(Sort::Light, world, light.intensity)),
        RenderNode::Camera(camera) => Some(plain(Sort::Camera, world, camera.near)),
        RenderNode::Label(label) => Some(plain(Sort::Label, world, label.height)),
        RenderNode::Group
        | RenderNode::Transform(_)
        | RenderNode::Live(_)
        | RenderNode::Facing(_)
        | RenderNode::Fading(_)
        | RenderNode::Aspects(_)
        | RenderNode::Swaying(_)
        | RenderNode::Instances { .. }
        | RenderNode::Deferred(_) => None,
    }
}

fn plain(sort: Sort, world: Affine3, size: f32) -> Found {
    Found { sort, world, size, look: String::new(), part: None }
}

/// The edge length tells the tests' triangles apart.
fn mesh(world: Affine3, mesh: &SharedMesh, look: &str) -> Found {
    Found { look: look.to_owned(), ..plain(Sort::Mesh, world, mesh.positions[1].x) }
}

fn lines(world: Affine3, lines: &[Polyline]) -> Found {
    let points = lines.iter().flat_map(|line| &line.points);
    plain(Sort::Lines, world, points.fold(0.0, |size, point| size.max(point.x)))
}

fn assert_fits(found: &Found, item: &Item) {
    let tolerance = if item.is_turned { TOLERANCE } else { 0.0 };
    let is_same = found.sort == item.sort
        && found.look == item.look
        && (item.is_vague || found.part.zip(item.part).is_none_or(|(a, b)| a == b))
        && (item.is_vague
            || found.size == item.size && item.world.distance(&found.world) <= tolerance);
    assert!(is_same, "{found:?} instead of {item:?}");
}

/// Compares, and shows no more than the first difference.
fn assert_same<T: PartialEq + std::fmt::Debug>(found: &[T], expected: &[T], what: &str) {
    if found != expected {
        let same = found.iter().zip(expected).take_while(|(a, b)| a == b).count();
        panic!(
            "{what}: {} instead of {}; number {same} is {:?} instead of {:?}",
            found.len(),
            expected.len(),
            found.get(same),
            expected.get(same),
        );
    }
}
