//! Fading as a traversal of its own: from the geometry of trees that know nothing of it, what is
//! left of it at a distance. Nothing is compiled for it, and whoever drops the result has taken it
//! back.
//!
//! What fades by its own rule, or was compiled for one range, is given as it is drawn; so is
//! everything that is no tree.

use std::sync::Arc;

use sapwood_geom::{FixedMap, Mesh, Polyline, Shared, SharedMesh, fixed_state};
use sapwood_graph::{
    At, Body, CameraRow, DrawList, DrawRange, DrawRow, Everything, Eye, Fading, Kind, LabelRow,
    LightRow, LineRow, Material, Named, Occurrence, Order, RenderNode, TooManyRows, Vantage,
    even_order, n_drawn,
};
use sapwood_scene::{Scene, ViewError, ViewId};

use glam::Affine3;

use super::{FadingItem, FadingParams, leaf_point};
use crate::weber_penn::{Leaf, LeafShape, Segment, Stem};

/// What plans hold whose geometry fades by itself, or has.
#[derive(Debug)]
pub(crate) struct SelfFading;

sapwood_geom::content!(SelfFading {});

/// The kind of the body that the traversal gives.
struct Faded;

impl Named for Faded {
    const NAME: &'static str = "faded";
}

/// What is left of a view for an eye: trees as `params` say, by the distance of each. Compiles the
/// view, under whatever rules it has. The range that `params` may fix holds for all trees.
///
/// An item of a stem is a quad of its surface, and a segment where it is a line; a leaf from afar
/// is a triangle, whatever its shape is. All of it is one body in the root's frame.
///
/// # Errors
/// When the view is closed, compiling was interrupted, or there would be more than `max_rows` rows
/// of all sorts together.
pub fn faded(
    scene: &mut Scene,
    view: ViewId,
    params: &FadingParams,
    eye: Option<&Eye>,
    max_rows: usize,
) -> Result<DrawList, ViewError> {
    let mut emitting = Emitting {
        params,
        eye,
        stems: FixedMap::with_hasher(fixed_state()),
        above: FixedMap::with_hasher(fixed_state()),
        body: Body::new(Kind::of::<Faded>()),
        n_left: max_rows,
        refused: None,
    };
    scene.traverse(view, Order::Pre, &Everything, &mut |at| emitting.visit(at))?;
    if let Some(kind) = emitting.refused {
        return Err(TooManyRows { limit: max_rows, kind }.into());
    }
    let occurrence = Occurrence { body: 0, world: Affine3::IDENTITY };
    Ok(DrawList { bodies: vec![emitting.body], occurrences: vec![occurrence] })
}

struct Emitting<'a> {
    params: &'a FadingParams,
    eye: Option<&'a Eye>,
    /// The level of the stems that a plan has as parts, and their segments as lines, by the number
    /// of its place.
    stems: FixedMap<u32, (u8, Vec<Polyline>)>,
    /// The limiting nodes above the node at hand, by the number of the place: where each ends, and
    /// from where it is looked at.
    above: FixedMap<u32, Vec<(u32, Vantage)>>,
    body: Body,
    /// Rows that may still be added.
    n_left: usize,
    /// The kind of what would have been one row too many.
    refused: Option<Kind>,
}

impl Emitting<'_> {
    fn visit(&mut self, at: &At<'_, ()>) {
        if self.refused.is_some() {
            return;
        }
        let (plan, number, local) = (at.plan(), at.path().number(), *at.world());
        let n_before = self.n_rows();
        if at.enters_plan() {
            let segments = plan.parts.of::<Segment>();
            if let (Some(first), false) = (plan.parts.of::<Stem>().first(), segments.is_empty()) {
                let lines = segments.iter().map(line).collect();
                self.stems.insert(number, (first.seed.level, lines));
            }
        }
        let index = at.index();
        if let Some(above) = self.above.get_mut(&number) {
            while above.pop_if(|(end, _)| *end <= index).is_some() {}
        }
        let range = self.params.fixed_range.unwrap_or_else(|| Fading::range(&local, self.eye));
        let shows = plan.fragment.shown(index).map(|shown| shown.kind());
        let fades = !plan.data.is::<SelfFading>();
        match at.node() {
            RenderNode::Group
            | RenderNode::Transform(_)
            | RenderNode::Live(_)
            | RenderNode::Facing(_)
            | RenderNode::Swaying(_)
            | RenderNode::Deferred(_) => {}
            RenderNode::Fading(_) | RenderNode::Aspects(_) => {
                let above = self.above.entry(number).or_default();
                above.push((plan.fragment.after(index), Vantage::of(&local, self.eye)));
            }
            RenderNode::Mesh { mesh, material } => {
                let row = DrawRow {
                    range: self.limit(at, mesh.n_triangles()),
                    ..DrawRow::new(local, mesh.clone(), material.clone())
                };
                let stems = self.stems.get(&at.path().number_above());
                match stems.filter(|_| fades && shows == Some(Kind::of::<Stem>())) {
                    Some((level, lines)) => {
                        let item = FadingItem::of_level(*level);
                        let lines = lines_left(lines, item, self.params, range);
                        self.add_lines(local, lines, material);
                        let share = item.polygons(self.params).share(range);
                        self.add(DrawRow { mesh: quads_left(mesh, item, share), ..row });
                    }
                    None => self.add(row),
                }
            }
            RenderNode::Instances { mesh, material, transforms } => {
                let row = DrawRow {
                    instances: Some(transforms.clone()),
                    range: self.limit(at, transforms.len()),
                    ..DrawRow::new(local, mesh.clone(), material.clone())
                };
                if fades && shows == Some(Kind::of::<Leaf>()) {
                    self.add_leaves(&row, transforms, range);
                } else {
                    self.add(row);
                }
            }
            RenderNode::Lines(lines) => {
                let material = plan.fragment.line_material(index).cloned();
                let range = self.limit(at, lines.len());
                self.body.lines.push(LineRow { local, lines: lines.clone(), material, range });
            }
            RenderNode::Light(light) => {
                self.body.lights.push(LightRow { local, light: light.clone() });
            }
            RenderNode::Camera(camera) => {
                self.body.cameras.push(CameraRow { local, camera: camera.clone() });
            }
            RenderNode::Label(label) => {
                self.body.labels.push(LabelRow { local, label: label.clone() });
            }
        }
        let n_added = self.n_rows() - n_before;
        match self.n_left.checked_sub(n_added) {
            Some(n_left) => self.n_left = n_left,
            None => self.refused = Some(plan.kind),
        }
    }

    fn n_rows(&self) -> usize {
        let Body { kind: _, rows, lines, lights, cameras, labels, rig: _, is_solid: _ } =
            &self.body;
        rows.len() + lines.len() + lights.len() + cameras.len() + labels.len()
    }

    /// What the limiting nodes above leave of `n` triangles, instances or lines.
    fn limit(&self, at: &At<'_, ()>, n: usize) -> Option<DrawRange> {
        let (_, vantage) = self.above.get(&at.path().number())?.last()?;
        let limiter = at.plan().fragment.limiter_of(at.index())?;
        Some(limiter.drawn(n as u32, vantage))
    }

    fn add(&mut self, row: DrawRow) {
        if row.n_triangles() > 0 {
            self.body.rows.push(row);
        }
    }

    fn add_lines(&mut self, local: Affine3, lines: Vec<Polyline>, bark: &Arc<Material>) {
        if !lines.is_empty() {
            let (lines, material) = (Shared::new(lines), Some(Arc::clone(bark)));
            self.body.lines.push(LineRow { local, lines, material, range: None });
        }
    }

    /// Some of the leaves as they are, and some as triangles.
    fn add_leaves(&mut self, row: &DrawRow, transforms: &[Affine3], range: f32) {
        let item = FadingItem::Leaves;
        let n = transforms.len() as u32;
        let order: Vec<u32> = even_order(n, item.mass()).collect();
        let n_left = |share: f32| n_drawn(n, item.mass(), share) as usize;
        let (whole, all) = (
            n_left(item.polygons(self.params).share(range)),
            n_left(item.lines(self.params).share(range)),
        );
        let growth = if self.params.keeps_coverage && all > 0 {
            (n as f32 / all.max(whole) as f32).sqrt()
        } else {
            1.0
        };
        let grown = Affine3::from_scale(glam::Vec3::splat(growth));
        let instances = |numbers: &[u32]| {
            let places = numbers.iter().map(|number| transforms[*number as usize] * grown);
            Some(Shared::new(places.collect::<Vec<_>>()))
        };
        self.add(DrawRow { instances: instances(&order[..whole]), ..row.clone() });
        let points = order.get(whole..all.max(whole)).unwrap_or_default();
        if !points.is_empty() {
            let mesh = SharedMesh::new(leaf_point(LeafShape::Oval));
            self.add(DrawRow { mesh, instances: instances(points), ..row.clone() });
        }
    }
}

/// A segment as a line.
fn line(segment: &Segment) -> Polyline {
    Polyline {
        points: vec![segment.frame.origin, segment.end()],
        radii: vec![segment.radius_foot, segment.radius_end],
    }
}

/// The lines that are drawn instead of polygons.
fn lines_left(
    lines: &[Polyline],
    item: FadingItem,
    params: &FadingParams,
    range: f32,
) -> Vec<Polyline> {
    let n = lines.len() as u32;
    let behind = |share: f32| n_drawn(n, item.mass(), share) as usize;
    let first = behind(item.polygons(params).share(range));
    let end = behind(item.lines(params).share(range));
    let order = even_order(n, item.mass()).take(end).skip(first);
    order.map(|number| lines[number as usize].clone()).collect()
}

/// The mesh with this share of its quads.
fn quads_left(mesh: &SharedMesh, item: FadingItem, share: f32) -> SharedMesh {
    let quads: Vec<&[u32]> = mesh.indices.chunks(6).collect();
    let n_left = n_drawn(quads.len() as u32, item.mass(), share) as usize;
    if n_left == quads.len() {
        return mesh.clone();
    }
    let order = even_order(quads.len() as u32, item.mass()).take(n_left);
    let indices: Vec<u32> = order.flat_map(|number| quads[number as usize]).copied().collect();
    let n_triangles = indices.len() as u32 / 3;
    let left = Mesh { indices, ..Mesh::clone(mesh) };
    SharedMesh::new(left.part(0..n_triangles))
}
