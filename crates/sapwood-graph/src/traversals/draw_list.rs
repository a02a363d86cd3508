//! The draw list: what is drawn, where, and with which material.
//!
//! The list has two levels. A *body* is what one authored component draws, in its own frame; an
//! *occurrence* puts a body somewhere. What is shared in the scene is one body with several
//! occurrences. What turns to the eye is a body of its own, for it is turned differently at each
//! place; what fades with the distance, or shows its aspects by the direction, has a body for each
//! set of limits that some place gives it.
//! The list is built anew each time. What sways stands at rest in it, with a rig that tells how it
//! moves; moving it is the business of `poses`.

mod look;

use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Digest, FixedMap, Mesh, Polyline, Shared, SharedMesh, fixed_state};

pub use super::rigged::Follows;
use crate::{
    Camera, CrossFade, DrawRange, EnvId, Kind, Label, Light, Limiter, Material, Rig, SiteId, Supply,
};
use look::{Limits, Look};

/// Everything that a view draws.
#[derive(Clone, Debug, Default)]
pub struct DrawList {
    /// What is drawn, each once.
    pub bodies: Vec<Body>,
    /// Where it is drawn, in pre-order.
    pub occurrences: Vec<Occurrence>,
}

/// What one authored component draws, in its own frame, or the part of it that is turned to the
/// eye together.
#[derive(Clone, Debug)]
pub struct Body {
    /// The component's kind.
    pub kind: Kind,
    /// Meshes, in pre-order.
    pub rows: Vec<DrawRow>,
    /// Lines, in pre-order.
    pub lines: Vec<LineRow>,
    /// Lights, in pre-order.
    pub lights: Vec<LightRow>,
    /// Cameras, in pre-order.
    pub cameras: Vec<CameraRow>,
    /// Lines of text, in pre-order.
    pub labels: Vec<LabelRow>,
    /// How what sways does so, in the body's frame; nothing where nothing does.
    pub rig: Option<Arc<Rig>>,
    /// Whether its meshes were made to be together one closed surface, of which triangles meet at
    /// equal positions: such as welding by union makes. A claim: what changes meshes or leaves some
    /// of their triangles out keeps it, so whoever relies on it counts the triangles of edges.
    pub is_solid: bool,
}

impl Body {
    /// A body that draws nothing yet.
    pub fn new(kind: Kind) -> Self {
        let (rows, lines, lights) = (Vec::new(), Vec::new(), Vec::new());
        let (cameras, labels) = (Vec::new(), Vec::new());
        Self { kind, rows, lines, lights, cameras, labels, rig: None, is_solid: false }
    }

    /// Rows of all sorts together.
    fn n_rows(&self) -> usize {
        let Self { kind: _, rows, lines, lights, cameras, labels, rig: _, is_solid: _ } = self;
        rows.len() + lines.len() + lights.len() + cameras.len() + labels.len()
    }
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
    /// Which of the instances are drawn, or which triangles of a single mesh; nothing for all.
    /// [`DrawList::as_drawn`] is for whoever cannot draw by parts.
    pub range: Option<DrawRange>,
    /// In which pixels it is drawn, where another row of the same body is drawn in the others;
    /// nothing for all. [`DrawList::as_drawn`] keeps the foremost of such rows.
    pub cross_fade: Option<CrossFade>,
    /// Which joints of the body's rig the mesh's vertices follow, or its instances; nothing where
    /// the row does not sway.
    pub follows: Option<Follows>,
}

impl DrawRow {
    /// A single mesh, all of it, that does not sway.
    pub fn new(local: Affine3, mesh: SharedMesh, material: Arc<Material>) -> Self {
        let (instances, range, cross_fade, follows) = (None, None, None, None);
        Self { local, mesh, material, instances, range, cross_fade, follows }
    }

    /// How often the mesh is drawn.
    pub fn n_copies(&self) -> usize {
        let Some(instances) = &self.instances else { return 1 };
        self.range.map_or(instances.len(), |range| range.len() as usize)
    }

    /// How many triangles are drawn, every instance counted.
    pub fn n_triangles(&self) -> u64 {
        match (&self.instances, self.range) {
            (None, Some(range)) => u64::from(range.len()),
            _ => self.n_copies() as u64 * self.mesh.n_triangles() as u64,
        }
    }
}

impl LineRow {
    /// The lines that are drawn.
    pub fn drawn(&self) -> &[Polyline] {
        self.range.map_or(self.lines.as_slice(), |range| range.of(&self.lines))
    }
}

/// Lines with radii.
#[derive(Clone, Debug)]
pub struct LineRow {
    /// From the row's frame to the body's.
    pub local: Affine3,
    /// The lines.
    pub lines: Shared<Vec<Polyline>>,
    /// Their look; nothing where whoever draws them chooses.
    pub material: Option<Arc<Material>>,
    /// Which of them are drawn; nothing for all.
    pub range: Option<DrawRange>,
}

/// A light.
#[derive(Clone, Debug)]
pub struct LightRow {
    /// From the light's frame to the body's.
    pub local: Affine3,
    /// The light.
    pub light: Light,
}

/// A camera.
#[derive(Clone, Debug)]
pub struct CameraRow {
    /// From the camera's frame to the body's.
    pub local: Affine3,
    /// The camera.
    pub camera: Camera,
}

/// A line of text.
#[derive(Clone, Debug)]
pub struct LabelRow {
    /// From the text's frame to the body's.
    pub local: Affine3,
    /// The text.
    pub label: Label,
}

impl DrawList {
    /// Adds a body that draws something, and tells its number.
    fn add(&mut self, body: Body) -> Option<u32> {
        (body.n_rows() > 0).then(|| {
            self.bodies.push(body);
            self.bodies.len() as u32 - 1
        })
    }

    /// The body behind an occurrence.
    pub fn body(&self, occurrence: &Occurrence) -> &Body {
        &self.bodies[occurrence.body as usize]
    }

    /// Every mesh row of every occurrence, with its transform to the root's frame.
    pub fn placed_rows(&self) -> impl Iterator<Item = (Affine3, &DrawRow)> {
        self.placed(|body| body.rows.iter().map(|row| (row.local, row)))
    }

    /// Every line row of every occurrence, with its transform to the root's frame.
    pub fn placed_lines(&self) -> impl Iterator<Item = (Affine3, &LineRow)> {
        self.placed(|body| body.lines.iter().map(|row| (row.local, row)))
    }

    /// Every light of every occurrence, with its transform to the root's frame.
    pub fn placed_lights(&self) -> impl Iterator<Item = (Affine3, &Light)> {
        self.placed(|body| body.lights.iter().map(|row| (row.local, &row.light)))
    }

    /// Every camera of every occurrence, with its transform to the root's frame.
    pub fn placed_cameras(&self) -> impl Iterator<Item = (Affine3, &Camera)> {
        self.placed(|body| body.cameras.iter().map(|row| (row.local, &row.camera)))
    }

    /// Every line of text of every occurrence, with its transform to the root's frame.
    pub fn placed_labels(&self) -> impl Iterator<Item = (Affine3, &Label)> {
        self.placed(|body| body.labels.iter().map(|row| (row.local, &row.label)))
    }

    fn placed<'a, T: 'a, I: Iterator<Item = (Affine3, T)> + 'a>(
        &'a self,
        rows: impl Fn(&'a Body) -> I + 'a,
    ) -> impl Iterator<Item = (Affine3, T)> + 'a {
        self.occurrences.iter().flat_map(move |occurrence| {
            let world = occurrence.world;
            rows(self.body(occurrence)).map(move |(local, row)| (world * local, row))
        })
    }

    /// The list with other meshes: `change` is asked once for each distinct mesh. What becomes
    /// empty is no longer drawn, and neither is what a range left out; single meshes no longer
    /// sway. All else stays as it is, the claim to be [solid](Body::is_solid) too.
    pub fn with_meshes(&self, mut change: impl FnMut(&Mesh) -> Mesh) -> Self {
        let mut changed: FixedMap<Digest, SharedMesh> = FixedMap::with_hasher(fixed_state());
        let Self { mut bodies, occurrences } = self.as_drawn().into_owned();
        for row in bodies.iter_mut().flat_map(|body| &mut body.rows) {
            let mesh = changed
                .entry(Digest::of(&row.mesh))
                .or_insert_with(|| SharedMesh::new(change(&row.mesh)));
            row.mesh = mesh.clone();
            row.follows.take_if(|_| row.instances.is_none());
        }
        for body in &mut bodies {
            body.rows.retain(|row| !row.mesh.is_empty());
        }
        Self { bodies, occurrences }
    }

    /// The same with nothing left out by ranges: what is not drawn is not there, and of what fades
    /// into each other, only the foremost is. Copies the rows that have a range, if there are any.
    pub fn as_drawn(&self) -> Cow<'_, Self> {
        let has_range = |body: &Body| {
            body.rows.iter().any(|row| row.range.is_some() || row.cross_fade.is_some())
                || body.lines.iter().any(|row| row.range.is_some())
        };
        if !self.bodies.iter().any(has_range) {
            return Cow::Borrowed(self);
        }
        let mut bodies = self.bodies.clone();
        for body in &mut bodies {
            body.rows.retain(|row| row.cross_fade.is_none_or(|fade| fade.is_foremost()));
            for row in &mut body.rows {
                row.cross_fade = None;
                let Some(range) = row.range.take() else { continue };
                let follows = row.follows.as_ref();
                match &mut row.instances {
                    Some(instances) => {
                        row.follows = follows.map(|follows| follows.of_instances(range));
                        *instances = Shared::new(range.of(instances).to_vec());
                    }
                    None => {
                        let indices = &row.mesh.indices;
                        row.follows = follows.map(|follows| follows.of_triangles(indices, range));
                        row.mesh = SharedMesh::new(row.mesh.part(range.numbers()));
                    }
                }
            }
            for row in &mut body.lines {
                let Some(range) = row.range.take() else { continue };
                row.lines = Shared::new(range.of(&row.lines).to_vec());
            }
        }
        Cow::Owned(Self { bodies, occurrences: self.occurrences.clone() })
    }

    /// Number of vertices and of triangles that are drawn, every instance counted; vertices of a
    /// mesh count whatever part of it is drawn.
    pub fn n_vertices_and_triangles(&self) -> (u64, u64) {
        self.placed_rows().fold((0, 0), |(vertices, triangles), (_, row)| {
            let n = row.n_copies() as u64;
            (vertices + n * row.mesh.n_vertices() as u64, triangles + row.n_triangles())
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
/// When there are more than `max_rows` rows of all sorts together; of two that fade into each other
/// both count.
pub fn draw_list(supply: &dyn Supply, max_rows: usize) -> Result<DrawList, TooManyRows> {
    let mut builder = Builder::new(supply, max_rows);
    let (_, root) = supply.root();
    builder.add(Top { site: root, node: 0 }, Affine3::IDENTITY)?;
    Ok(builder.finish())
}

/// Where a body begins: the site of an authored component, or a node in it that turns.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Top {
    pub(super) site: SiteId,
    /// 0 for the whole site, else a node that faces the eye, whose children are meant.
    pub(super) node: u32,
}

/// A draw list in the making.
pub(super) struct Builder<'a> {
    supply: &'a dyn Supply,
    env: EnvId,
    pub(super) list: DrawList,
    max_rows: usize,
    n_rows: usize,
    seen: FixedMap<Top, usize>,
    looks: Vec<Look<'a>>,
    /// What limits tops that turn.
    limiter_above: FixedMap<Top, Limiter<'a>>,
    /// Bodies that fade, by the look and what is left of them.
    faded: FixedMap<(usize, Vec<Limits>), Option<u32>>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(supply: &'a dyn Supply, max_rows: usize) -> Self {
        Self {
            supply,
            env: supply.root().0,
            list: DrawList::default(),
            max_rows,
            n_rows: 0,
            seen: FixedMap::with_hasher(fixed_state()),
            looks: Vec::new(),
            limiter_above: FixedMap::with_hasher(fixed_state()),
            faded: FixedMap::with_hasher(fixed_state()),
        }
    }

    pub(super) fn finish(self) -> DrawList {
        self.list
    }

    /// Adds what is drawn from a top on, `world` leading from its frame to the root's.
    pub(super) fn add(&mut self, top: Top, world: Affine3) -> Result<(), TooManyRows> {
        self.look_at_all(top);
        let mut stack = vec![(top, world, None)];
        while let Some((top, world, fades_at)) = stack.pop() {
            let look = self.look(top);
            // What draws nothing is passed over, however often it occurs.
            if !self.looks[look].draws {
                continue;
            }
            if let Some(number) = self.body_at(look, &world, fades_at.as_ref()) {
                let body = &self.list.bodies[number as usize];
                let (n_rows, kind) = (body.n_rows(), body.kind);
                self.count(n_rows, kind)?;
                self.list.occurrences.push(Occurrence { body: number, world });
            }
            let eye = self.supply.eye();
            stack.extend(self.looks[look].below.iter().rev().map(|below| {
                let outside = world * below.local;
                let turn = below.facing.map(|facing| facing.turn(&outside, eye));
                let fades_at = below.fades_at.and_then(|place| place.world(&world, &fades_at));
                (below.top, turn.map_or(outside, |turn| outside * turn), fades_at)
            }));
        }
        Ok(())
    }

    /// Counts rows that are about to be added.
    pub(super) fn count(&mut self, n_rows: usize, kind: Kind) -> Result<(), TooManyRows> {
        self.n_rows += n_rows;
        if self.n_rows > self.max_rows {
            return Err(TooManyRows { limit: self.max_rows, kind });
        }
        Ok(())
    }

    /// Looks at every top once and finds out which of them draw.
    fn look_at_all(&mut self, root: Top) {
        let mut stack = vec![(root, false)];
        while let Some((top, is_done)) = stack.pop() {
            let is_new = !self.seen.contains_key(&top);
            let look = self.look(top);
            if is_done {
                let mut below = self.looks[look].below.iter();
                let draws = below.any(|below| self.looks[self.seen[&below.top]].draws);
                self.looks[look].draws |= draws;
            } else if is_new {
                stack.push((top, true));
                let below = self.looks[look].below.iter().rev();
                stack.extend(below.map(|below| (below.top, false)));
            }
        }
    }
}
