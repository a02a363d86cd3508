//! Traversals of a script, each compared with the reference, and with a scene built anew.

use sapwood::geom::Aabb;
use sapwood::geom::glam::Vec3;
use sapwood::graph::{Inside, Interest, Order, RenderNode, Under};

use super::mirror::{View, size_of};
use super::reference::{Expected, Row, expected, row};
use super::script::Script;

/// More than any view shows.
const MANY: usize = 1_000_000;

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
        let rows: Vec<Row> =
            list.placed_rows().map(|(world, drawn)| row(&world, size_of(&drawn.mesh))).collect();
        assert_same(&rows, &expected(&self.mirror, view, &[]).rows, "draw rows");
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

    fn check_bounds(&mut self, view: &View) {
        let bounds = self.scene.bounds(view.id).unwrap();
        let boxes = expected(&self.mirror, view, &[]).boxes;
        let all = boxes.into_iter().fold(Aabb::EMPTY, Aabb::union);
        assert_eq!(bounds.aabb.is_empty(), all.is_empty());
        if !all.is_empty() {
            let difference =
                (bounds.aabb.min - all.min).abs().max((bounds.aabb.max - all.max).abs());
            assert!(difference.max_element() < 0.01, "{:?} is not {all:?}", bounds.aabb);
        }
    }

    /// Compares with a scene that never knew anything else.
    fn check_cold(&mut self, view: &View) {
        let (mut cold, id) = self.mirror.rebuilt(view);
        let bounds = self.scene.bounds(view.id).unwrap();
        assert_eq!(bounds, cold.bounds(id).unwrap(), "bounds");
        let dumps = [self.scene.dump(view.id, MANY), cold.dump(id, MANY)];
        let [dump, cold] = dumps.map(|dump| {
            let dump = dump.unwrap();
            dump.lines().map(str::to_owned).collect::<Vec<_>>()
        });
        assert_same(&dump, &cold, "dumps");
    }

    /// Meshes met on a walk, each with its box.
    fn meshes<I: Interest>(&mut self, view: &View, interest: &I) -> Vec<(Row, Aabb)> {
        let orders = [Order::Pre, Order::In, Order::Post, Order::Level];
        let order = self.dice.pick(&orders);
        let mut met = Vec::new();
        let visitor = &mut |at: &sapwood::graph::At<'_, I::State>| {
            if let RenderNode::Mesh { mesh, .. } = at.node() {
                let corners = mesh.positions.iter().map(|p| at.world().transform_point3(*p));
                met.push((row(at.world(), size_of(mesh)), Aabb::of_points(corners)));
            }
        };
        self.scene.traverse(view.id, order, interest, visitor).unwrap();
        met
    }

    /// Everything that lies inside a box must be met; what lies outside may be.
    fn cull(&mut self, view: &View) {
        let Expected { rows, boxes, .. } = expected(&self.mirror, view, &[]);
        let middle = match boxes.len() {
            0 => Vec3::ZERO,
            n => boxes[self.dice.below(n)].min,
        };
        // No face of the box touches a corner of a mesh.
        let half = Vec3::splat(0.13 + self.dice.log_even(1.0, 200.0) as f32);
        let inside = Aabb { min: middle - half, max: middle + half };
        let met = self.meshes(view, &Inside(inside));
        let mut needed: Vec<Row> = rows
            .iter()
            .zip(&boxes)
            .filter(|(_, each)| each.intersects(&inside))
            .map(|(row, _)| *row)
            .collect();
        let within = met.iter().filter(|(_, each)| each.intersects(&inside));
        let mut within: Vec<Row> = within.map(|(row, _)| *row).collect();
        sort(&mut needed);
        sort(&mut within);
        assert_same(&within, &needed, "rows inside a box");
        let mut all = rows;
        sort(&mut all);
        let mut met: Vec<Row> = met.into_iter().map(|(row, _)| row).collect();
        sort(&mut met);
        let mut rest = all.iter();
        for row in &met {
            assert!(rest.any(|other| other == row), "{row:?} is not in the scene");
        }
    }

    /// Exactly what lies on the way to a place and below it must be met.
    fn pick(&mut self, view: &View) {
        let mut paths = expected(&self.mirror, view, &[]).paths;
        let place = self.dice.below(paths.len());
        let path = paths.swap_remove(place);
        let mut needed = expected(&self.mirror, view, &path).rows;
        let met = self.meshes(view, &Under(path));
        let mut met: Vec<Row> = met.into_iter().map(|(row, _)| row).collect();
        sort(&mut needed);
        sort(&mut met);
        assert_same(&met, &needed, "rows under a path");
    }
}

fn sort(rows: &mut [Row]) {
    rows.sort_by(|a, b| a.partial_cmp(b).expect("rows are finite"));
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
