//! What is drawn from a top on: each is looked at once, however often it occurs.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Mesh, Shared, SharedMesh};

use super::{Body, Builder, CameraRow, DrawRow, LabelRow, LightRow, LineRow, Top};
use crate::cross_fade::DrawnParts;
use crate::traversals::rigged::Rigging;
use crate::{DrawnPart, Facing, Limiter, RenderNode, Rig, Supplied, Supply, Vantage};

/// What is drawn from a top on, and the tops right below it.
pub(super) struct Look<'a> {
    body: Option<u32>,
    /// A body that is not the same everywhere, for some of it is limited.
    limited: Option<Box<LimitedBody<'a>>>,
    pub(super) below: Vec<Below>,
    /// Whether there is a body here or anywhere below.
    pub(super) draws: bool,
}

/// A top below another one.
pub(super) struct Below {
    pub(super) top: Top,
    /// From the lower frame to the upper one, before it is turned.
    pub(super) local: Affine3,
    pub(super) facing: Option<Facing>,
    /// Where the distance is measured by which it fades, if something above has it do so.
    pub(super) fades_at: Option<FadesAt>,
}

/// Where a distance is measured by which rows fade.
#[derive(Clone, Copy)]
pub(super) enum FadesAt {
    /// At a frame, which this leads from to the top's own.
    Here(Affine3),
    /// Above the top, which turns, and rows fade by a distance that does not.
    Above,
}

impl FadesAt {
    /// From where it is measured to the root, by what leads there from a top and from where its
    /// own distance is measured.
    pub(super) fn world(self, of_top: &Affine3, above: &Option<Affine3>) -> Option<Affine3> {
        match self {
            Self::Here(local) => Some(*of_top * local),
            Self::Above => *above,
        }
    }
}

/// What stands above a node in its plan.
#[derive(Clone, Copy, Default)]
struct Above<'a> {
    /// The lowest limiting node, and where the eye's distance and direction are measured.
    limiter: Option<(Limiter<'a>, FadesAt)>,
    /// The lowest rig, and from its frame to the body's.
    rig: Option<(&'a Shared<Rig>, Affine3)>,
}

struct LimitedBody<'a> {
    /// With everything in it.
    whole: Body,
    rows: Vec<LimitedRow<'a>>,
}

/// A row that is limited.
struct LimitedRow<'a> {
    /// Whether it is one of lines.
    is_lines: bool,
    number: usize,
    /// How many triangles, instances or lines it has.
    n: u32,
    limiter: Limiter<'a>,
    at: FadesAt,
}

/// What is drawn of one row, and the bits of how much larger.
pub(super) type Limits = (DrawnParts, u32);

impl LimitedBody<'_> {
    fn limits(&self, world: &Affine3, above: Option<&Affine3>, supply: &dyn Supply) -> Vec<Limits> {
        let limits = self.rows.iter().map(|row| {
            let at = row.at.world(world, &above.copied()).unwrap_or(*world);
            let vantage = Vantage::of(&at, supply.eye());
            let parts = if row.is_lines {
                DrawnPart::alone(row.limiter.drawn(row.n, &vantage))
            } else {
                row.limiter.parts(row.n, &vantage)
            };
            (parts, row.limiter.growth(&vantage).to_bits())
        });
        limits.collect()
    }

    /// What is left of the body; rows of which nothing is are gone.
    fn limited(&self, limits: &[Limits]) -> Body {
        let mut body = self.whole.clone();
        let mut others = Vec::new();
        for (row, ([first, other], growth)) in self.rows.iter().zip(limits) {
            let part = |part: &DrawnPart| (part.range.len() < row.n).then_some(part.range);
            let range = first.as_ref().and_then(part);
            if row.is_lines {
                body.lines[row.number].range = range;
                continue;
            }
            let drawn = &mut body.rows[row.number];
            drawn.range = range;
            drawn.cross_fade = first.and_then(|part| part.cross_fade);
            let growth = f32::from_bits(*growth);
            if growth != 1.0 && drawn.instances.is_some() {
                let mut grown = Mesh::default();
                grown.append(&drawn.mesh, &Affine3::from_scale(Vec3::splat(growth)));
                drawn.mesh = SharedMesh::new(grown);
            }
            others.extend(other.map(|other| DrawRow {
                range: part(&other),
                cross_fade: other.cross_fade,
                ..drawn.clone()
            }));
        }
        body.rows.extend(others);
        body.rows.retain(|row| row.range.is_none_or(|range| !range.is_empty()));
        body.lines.retain(|row| row.range.is_none_or(|range| !range.is_empty()));
        body
    }
}

impl<'a> Builder<'a> {
    /// The number of the body that is drawn at a place; `fades_at` is where the distance is
    /// measured of what fades above a top that turns.
    pub(super) fn body_at(
        &mut self,
        look: usize,
        world: &Affine3,
        fades_at: Option<&Affine3>,
    ) -> Option<u32> {
        let Some(limited) = &self.looks[look].limited else { return self.looks[look].body };
        let limits = limited.limits(world, fades_at, self.supply);
        if let Some(known) = self.faded.get(&(look, limits.clone())) {
            return *known;
        }
        let body = limited.limited(&limits);
        let number = self.list.add(body);
        self.faded.insert((look, limits), number);
        number
    }

    /// Looks at an authored site and whatever its rule and the rules below it emitted.
    pub(super) fn look(&mut self, top: Top) -> usize {
        if let Some(look) = self.seen.get(&top) {
            return *look;
        }
        let mut body = Body::new(self.supply.plan(top.site).kind);
        let mut below = Vec::new();
        let mut limited_rows = Vec::new();
        let mut rigging: Option<Rigging> = None;
        let limiter = self.limiter_above.get(&top).map(|limiter| (*limiter, FadesAt::Above));
        let above = Above { limiter, rig: None };
        let mut stack = vec![(top.site, top.node, Affine3::IDENTITY, above)];
        while let Some((site, index, local, above)) = stack.pop() {
            let plan = self.supply.plan(site);
            let first = stack.len();
            let mut inside_of = |local: Affine3, above: Above<'a>| {
                let children = plan.fragment.children(index);
                stack.extend(children.map(|child| (site, child, local, above)));
            };
            let mut inside = |local: Affine3| inside_of(local, above);
            let follows = above.rig.zip(plan.fragment.followed(index));
            let follows = follows.map(|((rig, local), numbers)| {
                rigging.get_or_insert_with(Rigging::new).follows(numbers, rig, &local)
            });
            if let (Some((limiter, at)), Some(n)) = (above.limiter, plan.fragment.n_drawn(index)) {
                let is_lines = matches!(plan.fragment.node(index), RenderNode::Lines(_));
                let number = if is_lines { body.lines.len() } else { body.rows.len() };
                let n = n as u32;
                limited_rows.push(LimitedRow { is_lines, number, n, limiter, at });
            }
            match plan.fragment.node(index) {
                RenderNode::Group => inside(local),
                RenderNode::Transform(transform) => inside(local * *transform),
                RenderNode::Live(value) => inside(local * plan.live[value as usize]),
                RenderNode::Facing(facing) => {
                    let here = Top { site, node: index };
                    if here == top {
                        inside(local);
                    } else {
                        if let Some((limiter, _)) = above.limiter {
                            self.limiter_above.insert(here, limiter);
                        }
                        let (facing, fades_at) = (Some(*facing), above.limiter.map(|(_, at)| at));
                        below.push(Below { top: here, local, facing, fades_at });
                    }
                }
                limiting @ (RenderNode::Fading(_) | RenderNode::Aspects(_)) => {
                    let limiter = limiting.limiter().map(|by| (by, FadesAt::Here(local)));
                    inside_of(local, Above { limiter, ..above });
                }
                RenderNode::Swaying(rig) => {
                    inside_of(local, Above { rig: Some((rig, local)), ..above });
                }
                RenderNode::Mesh { mesh, material } => body.rows.push(DrawRow {
                    follows,
                    ..DrawRow::new(local, mesh.clone(), Arc::clone(material))
                }),
                RenderNode::Instances { mesh, material, transforms } => body.rows.push(DrawRow {
                    instances: Some(transforms.clone()),
                    follows,
                    ..DrawRow::new(local, mesh.clone(), Arc::clone(material))
                }),
                RenderNode::Lines(lines) => {
                    let material = plan.fragment.line_material(index).cloned();
                    body.lines.push(LineRow { local, lines: lines.clone(), material, range: None });
                }
                RenderNode::Light(light) => {
                    body.lights.push(LightRow { local, light: light.clone() });
                }
                RenderNode::Camera(camera) => {
                    body.cameras.push(CameraRow { local, camera: camera.clone() });
                }
                RenderNode::Label(label) => {
                    body.labels.push(LabelRow { local, label: label.clone() });
                }
                RenderNode::Deferred(run) => {
                    for link in run.first..run.first + run.count {
                        let (_, Supplied::Ready(child)) = self.supply.enter(self.env, site, link)
                        else {
                            continue;
                        };
                        if self.supply.plan(child).authored {
                            let top = Top { site: child, node: 0 };
                            below.push(Below { top, local, facing: None, fades_at: None });
                        } else {
                            stack.push((child, 0, local, Above::default()));
                        }
                    }
                }
            }
            stack[first..].reverse();
        }
        body.rig = rigging.map(Rigging::finish);
        let look = if limited_rows.is_empty() {
            let body = self.list.add(body);
            Look { body, limited: None, below, draws: body.is_some() }
        } else {
            let limited = Some(Box::new(LimitedBody { whole: body, rows: limited_rows }));
            Look { body: None, limited, below, draws: true }
        };
        self.looks.push(look);
        let look = self.looks.len() - 1;
        self.seen.insert(top, look);
        look
    }
}
