//! The draw list of a pruning: what lies inside as it is, and what remains of what was cut.

use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{FixedMap, Shared, SharedMesh, Side, fixed_state};

use super::meter::Meter;
use super::remaining::{of_instances, of_lines, of_mesh};
use super::{Pruning, Standing};
use crate::traversals::draw_list::{Builder, Top};
use crate::traversals::{
    Body, CameraRow, DrawList, DrawRow, LabelRow, LightRow, LineRow, Occurrence, TooManyRows,
};
use crate::{At, LightShape, Limiter, Material, RenderNode, Supply, Vantage};

/// What remains, in the making.
pub(super) struct Drawing<'a> {
    builder: Builder<'a>,
    /// The body of what is cut, by the place of the authored component that draws it.
    cut: FixedMap<u32, u32>,
    /// The place of the authored component that draws what is at each place.
    owners: Vec<u32>,
}

impl<'a> Drawing<'a> {
    pub(super) fn new(supply: &'a dyn Supply, max_rows: usize) -> Self {
        let cut = FixedMap::with_hasher(fixed_state());
        Self { builder: Builder::new(supply, max_rows), cut, owners: Vec::new() }
    }

    pub(super) fn finish(self) -> DrawList {
        self.builder.finish()
    }

    /// Notes a place that the walk enters.
    pub(super) fn enter(&mut self, at: &At<'_, Standing>, authored: bool) {
        let owner = self.owners.get(at.path().number_above() as usize).copied();
        self.owners.push(owner.filter(|_| !authored).unwrap_or(at.path().number()));
    }

    /// Adds everything that a component draws, as it is.
    pub(super) fn add_whole(&mut self, top: Top, world: Affine3) -> Result<(), TooManyRows> {
        self.builder.add(top, world)
    }

    /// Adds a row of what is cut.
    fn add(
        &mut self,
        at: &At<'_, Standing>,
        push: impl FnOnce(&mut Body),
    ) -> Result<(), TooManyRows> {
        let owner = self.owners[at.path().number() as usize];
        let list = &mut self.builder.list;
        let number = *self.cut.entry(owner).or_insert_with(|| {
            let number = list.bodies.len() as u32;
            list.bodies.push(Body::new(at.plan().kind));
            list.occurrences.push(Occurrence { body: number, world: Affine3::IDENTITY });
            number
        });
        push(&mut list.bodies[number as usize]);
        let kind = list.bodies[number as usize].kind;
        self.builder.count(1, kind)
    }

    /// Draws what remains of a node.
    pub(super) fn draw(
        &mut self,
        pruning: &Pruning,
        meter: &Meter<'_>,
        at: &At<'_, Standing>,
    ) -> Result<(), TooManyRows> {
        let (local, envelope) = (*at.world(), &pruning.prune.envelope);
        let fragment = at.plan().fragment;
        // What is cut does not fade: it is there as from nearby, and as for no eye.
        let n_drawn = fragment.n_drawn(at.index());
        let mut aspects = None;
        if let (Some(limiter), Some(n)) = (fragment.limiter_of(at.index()), n_drawn) {
            let range = limiter.drawn(n as u32, &Vantage::default());
            if range.is_empty() {
                return Ok(());
            }
            // Parts are told of all aspects together.
            let is_part = matches!(limiter, Limiter::Aspects(_)) && (range.len() as usize) < n;
            aspects = (is_part && fragment.shown(at.index()).is_none()).then_some(range);
        }
        let is_here = || at.state().side() == Side::Inside || envelope.contains(local.translation);
        match at.node() {
            RenderNode::Mesh { mesh, material } => {
                let part = aspects.map(|range| SharedMesh::new(mesh.part(range.numbers())));
                let mesh = of_mesh(pruning, meter, at, part.as_ref().unwrap_or(mesh), None);
                let Some(mesh) = mesh else { return Ok(()) };
                let material = Arc::clone(material);
                self.add(at, |body| {
                    body.rows.push(DrawRow::new(local, mesh, material));
                })
            }
            RenderNode::Instances { mesh, material, transforms } => {
                let part = aspects.map(|range| Shared::new(range.of(transforms).to_vec()));
                let transforms = part.as_ref().unwrap_or(transforms);
                for (mesh, instances) in of_instances(pruning, meter, at, mesh, transforms) {
                    let material: Arc<Material> = Arc::clone(material);
                    self.add(at, |body| {
                        body.rows
                            .push(DrawRow { instances, ..DrawRow::new(local, mesh, material) });
                    })?;
                }
                Ok(())
            }
            RenderNode::Lines(lines) => {
                let part = aspects.map(|range| Shared::new(range.of(lines).to_vec()));
                let lines = of_lines(pruning, at, part.as_ref().unwrap_or(lines));
                let Some(lines) = lines else { return Ok(()) };
                let material = fragment.line_material(at.index()).cloned();
                self.add(at, |body| {
                    body.lines.push(LineRow { local, lines, material, range: None });
                })
            }
            RenderNode::Light(light) => {
                if light.shape != LightShape::Directional && !is_here() {
                    return Ok(());
                }
                self.add(at, |body| body.lights.push(LightRow { local, light: light.clone() }))
            }
            RenderNode::Camera(camera) => {
                self.add(at, |body| body.cameras.push(CameraRow { local, camera: camera.clone() }))
            }
            RenderNode::Label(label) => {
                if !is_here() {
                    return Ok(());
                }
                self.add(at, |body| body.labels.push(LabelRow { local, label: label.clone() }))
            }
            RenderNode::Group
            | RenderNode::Transform(_)
            | RenderNode::Live(_)
            | RenderNode::Facing(_)
            | RenderNode::Fading(_)
            | RenderNode::Aspects(_)
            | RenderNode::Swaying(_)
            | RenderNode::Deferred(_) => Ok(()),
        }
    }
}
