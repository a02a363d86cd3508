//! The draw list: what is drawn, where, and with which material.
//!
//! The list has two levels. A *body* is what one authored component draws, in its own frame; an
//! *occurrence* puts a body somewhere. What is shared in the scene is one body with several
//! occurrences. The list is built anew each time.

use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{FixedMap, Polyline, Shared, SharedMesh, fixed_state};

use crate::{EnvId, Kind, Material, RenderNode, SiteId, Supplied, Supply};

/// Everything that a view draws.
#[derive(Debug, Default)]
pub struct DrawList {
    /// What is drawn, each once.
    pub bodies: Vec<Body>,
    /// Where it is drawn, in pre-order.
    pub occurrences: Vec<Occurrence>,
}

/// What one authored component draws, in its own frame.
#[derive(Clone, Debug)]
pub struct Body {
    /// The component's kind.
    pub kind: Kind,
    /// Meshes, in pre-order.
    pub rows: Vec<DrawRow>,
    /// Lines, in pre-order.
    pub lines: Vec<LineRow>,
}

/// A body put somewhere.
#[derive(Clone, Debug)]
pub struct Occurrence {
    /// Number of the body.
    pub body: u32,
    /// From the body's frame to the root's.
    pub world: Affine3,
}

/// A mesh, once or many times.
#[derive(Clone, Debug)]
pub struct DrawRow {
    /// From the row's frame to the body's.
    pub local: Affine3,
    /// The triangles.
    pub mesh: SharedMesh,
    /// Their look.
    pub material: Arc<Material>,
    /// Where the mesh is repeated, in the row's frame; nothing for a single mesh.
    pub instances: Option<Shared<Vec<Affine3>>>,
}

/// Lines with radii.
#[derive(Clone, Debug)]
pub struct LineRow {
    /// From the row's frame to the body's.
    pub local: Affine3,
    /// The lines.
    pub lines: Shared<Vec<Polyline>>,
}

impl DrawList {
    /// Every mesh row of every occurrence, with its transform to the root's frame.
    pub fn placed_rows(&self) -> impl Iterator<Item = (Affine3, &DrawRow)> {
        self.occurrences.iter().flat_map(|occurrence| {
            let rows = self.bodies[occurrence.body as usize].rows.iter();
            rows.map(|row| (occurrence.world * row.local, row))
        })
    }

    /// Every line row of every occurrence, with its transform to the root's frame.
    pub fn placed_lines(&self) -> impl Iterator<Item = (Affine3, &LineRow)> {
        self.occurrences.iter().flat_map(|occurrence| {
            let rows = self.bodies[occurrence.body as usize].lines.iter();
            rows.map(|row| (occurrence.world * row.local, row))
        })
    }

    /// Number of vertices and of triangles that are drawn, every instance counted.
    pub fn n_vertices_and_triangles(&self) -> (u64, u64) {
        self.placed_rows().fold((0, 0), |(vertices, triangles), (_, row)| {
            let n = row.instances.as_ref().map_or(1, |instances| instances.len() as u64);
            (
                vertices + n * row.mesh.n_vertices() as u64,
                triangles + n * row.mesh.n_triangles() as u64,
            )
        })
    }
}

/// The list would have more rows than the caller allows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooManyRows {
    /// How many rows were allowed.
    pub limit: usize,
    /// The kind of the component whose occurrences went beyond the limit.
    pub kind: Kind,
}

impl fmt::Display for TooManyRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "more than {} rows would be drawn; {} occurs too often", self.limit, self.kind)
    }
}

impl std::error::Error for TooManyRows {}

/// The list of everything below the root.
///
/// # Errors
/// When there are more than `max_rows` mesh and line rows.
pub fn draw_list(supply: &dyn Supply, max_rows: usize) -> Result<DrawList, TooManyRows> {
    let (env, root) = supply.root();
    let mut builder = Builder {
        supply,
        env,
        list: DrawList::default(),
        seen: FixedMap::with_hasher(fixed_state()),
        looks: Vec::new(),
    };
    builder.look_at_all(root);
    let mut stack = vec![(root, Affine3::IDENTITY)];
    let mut n_rows = 0;
    while let Some((site, world)) = stack.pop() {
        let look = builder.look(site);
        let look = &builder.looks[look];
        // What draws nothing is passed over, however often it occurs.
        if !look.draws {
            continue;
        }
        if let Some(body) = look.body {
            let Body { rows, lines, kind } = &builder.list.bodies[body as usize];
            n_rows += rows.len() + lines.len();
            if n_rows > max_rows {
                return Err(TooManyRows { limit: max_rows, kind: *kind });
            }
            builder.list.occurrences.push(Occurrence { body, world });
        }
        stack.extend(look.below.iter().rev().map(|(site, local)| (*site, world * *local)));
    }
    Ok(builder.list)
}

/// What an authored site draws itself, and the authored sites right below it.
struct Look {
    body: Option<u32>,
    below: Vec<(SiteId, Affine3)>,
    /// Whether there is a body here or anywhere below.
    draws: bool,
}

struct Builder<'a> {
    supply: &'a dyn Supply,
    env: EnvId,
    list: DrawList,
    seen: FixedMap<SiteId, usize>,
    looks: Vec<Look>,
}

impl Builder<'_> {
    /// Looks at every authored site once and finds out which of them draw.
    fn look_at_all(&mut self, root: SiteId) {
        let mut stack = vec![(root, false)];
        while let Some((site, is_done)) = stack.pop() {
            let is_new = !self.seen.contains_key(&site);
            let look = self.look(site);
            if is_done {
                let mut below = self.looks[look].below.iter();
                let draws = below.any(|(site, _)| self.looks[self.seen[site]].draws);
                self.looks[look].draws |= draws;
            } else if is_new {
                stack.push((site, true));
                let below = self.looks[look].below.iter().rev();
                stack.extend(below.map(|(site, _)| (*site, false)));
            }
        }
    }

    /// Looks at an authored site and whatever its rule and the rules below it emitted.
    fn look(&mut self, top: SiteId) -> usize {
        if let Some(look) = self.seen.get(&top) {
            return *look;
        }
        let mut body = Body { kind: self.supply.plan(top).kind, rows: vec![], lines: vec![] };
        let mut below = Vec::new();
        let mut stack = vec![(top, 0, Affine3::IDENTITY)];
        while let Some((site, index, local)) = stack.pop() {
            let plan = self.supply.plan(site);
            let first = stack.len();
            let mut inside = |local: Affine3| {
                let children = plan.fragment.children(index);
                stack.extend(children.map(|child| (site, child, local)));
            };
            match plan.fragment.node(index) {
                RenderNode::Group => inside(local),
                RenderNode::Transform(transform) => inside(local * *transform),
                RenderNode::Live(value) => inside(local * plan.live[value as usize]),
                RenderNode::Mesh { mesh, material } => body.rows.push(DrawRow {
                    local,
                    mesh: mesh.clone(),
                    material: Arc::clone(material),
                    instances: None,
                }),
                RenderNode::Instances { mesh, material, transforms } => body.rows.push(DrawRow {
                    local,
                    mesh: mesh.clone(),
                    material: Arc::clone(material),
                    instances: Some(transforms.clone()),
                }),
                RenderNode::Lines(lines) => {
                    body.lines.push(LineRow { local, lines: lines.clone() });
                }
                RenderNode::Deferred(run) => {
                    for link in run.first..run.first + run.count {
                        let (_, Supplied::Ready(child)) = self.supply.enter(self.env, site, link)
                        else {
                            continue;
                        };
                        if self.supply.plan(child).authored {
                            below.push((child, local));
                        } else {
                            stack.push((child, 0, local));
                        }
                    }
                }
            }
            stack[first..].reverse();
        }
        let body = (!body.rows.is_empty() || !body.lines.is_empty()).then(|| {
            self.list.bodies.push(body);
            self.list.bodies.len() as u32 - 1
        });
        self.looks.push(Look { body, below, draws: body.is_some() });
        let look = self.looks.len() - 1;
        self.seen.insert(top, look);
        look
    }
}
