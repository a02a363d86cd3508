//! Pruning: what a view draws, cut by an envelope from outside.
//!
//! What lies wholly inside keeps its rows, meshes and sharing; what lies wholly outside goes, and
//! is not even compiled where its bound tells. What crosses is cut: meshes are clipped triangle by
//! triangle, instances and lines one by one. A clipped mesh stays open where it is cut.
//!
//! Who knows better than triangles do registers handlers: they tell the [`Fate`] of the parts that
//! a plan has, and whatever is drawn shows by [`Shown`](crate::Shown) which part it belongs to. So
//! a stem can end where its middle leaves the envelope, and take with it what grows beyond.

mod cut;
mod fate;
mod lines;
mod stand;

use std::any::Any;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Bound, Envelope, FixedMap, Mesh, Shared, SharedMesh, Side, fixed_state};

pub use fate::{Beyond, Fate};
pub use stand::Standing;

use super::draw_list::{Builder, Top};
use super::{
    Body, CameraRow, DrawList, DrawRow, LabelRow, LightRow, LineRow, Occurrence, TooManyRows,
};
use crate::{
    At, Handlers, Interrupted, LightShape, Limiter, Material, Order, Part, Provide, RenderNode,
    Supply, discover, walk,
};
use cut::{Remains, Surface, Through};
use fate::Fates;
use stand::Within;

/// How to prune.
#[derive(Clone, Debug, PartialEq)]
pub struct Prune {
    /// What remains, in the root's frame.
    pub envelope: Envelope,
    /// How far the edges of what is clipped may be from the envelope's surface, in metres; parts
    /// of the envelope that are thinner than eight times this may be missed.
    pub tolerance: f32,
}

impl Prune {
    /// Keeps what is inside of `envelope`, to the millimetre.
    pub fn to(envelope: Envelope) -> Self {
        Self { envelope, tolerance: 1e-3 }
    }
}

/// The handlers of prunings.
pub type PruneHandlers = Handlers<Pruning, Standing>;

/// A pruning on its way: what handlers ask, and what they are told.
pub struct Pruning {
    prune: Prune,
    /// The place above each place of the walk.
    above: Vec<u32>,
    notes: FixedMap<u32, Box<dyn Any>>,
    fates: FixedMap<u32, Vec<Fates>>,
}

impl Pruning {
    /// What remains, in the root's frame.
    pub fn envelope(&self) -> &Envelope {
        &self.prune.envelope
    }

    /// Tells what becomes of a plan's parts of type `P`, in their order; what is drawn here or
    /// below and shows them follows.
    pub fn decide<P: Part>(&mut self, at: &At<'_, Standing>, fates: Vec<Fate>) {
        let fates = Fates::new::<P>(fates, *at.world());
        self.fates.entry(at.path().number()).or_default().push(fates);
    }

    /// Leaves something for the handlers of plans below.
    pub fn note<N: Any>(&mut self, at: &At<'_, Standing>, note: N) {
        self.notes.insert(at.path().number(), Box::new(note));
    }

    /// What was noted at the nearest plan above that has a note, if it is an `N`.
    pub fn noted_above<N: Any>(&self, at: &At<'_, Standing>) -> Option<&N> {
        self.upward(at.path().number())
            .skip(1)
            .find_map(|place| self.notes.get(&place))?
            .downcast_ref()
    }

    /// Nothing of the plan or of what is below it remains.
    pub fn drop_all(&mut self, at: &At<'_, Standing>) {
        at.state().set_done();
    }

    /// A place and those above it.
    fn upward(&self, place: u32) -> impl Iterator<Item = u32> + '_ {
        let mut next = Some(place);
        std::iter::from_fn(move || {
            let place = next?;
            next = (place > 0).then(|| self.above[place as usize]);
            Some(place)
        })
    }

    /// Whether anything above a place was told of.
    fn is_bound(&self, place: u32) -> bool {
        self.upward(place).any(|place| self.notes.contains_key(&place))
    }

    /// The fates of the parts that a node shows.
    fn fates_of(&self, at: &At<'_, Standing>) -> Option<&Fates> {
        let shown = at.plan().fragment.shown(at.index())?;
        self.upward(at.path().number()).find_map(|place| {
            self.fates.get(&place)?.iter().find(|fates| fates.kind == shown.kind())
        })
    }
}

/// What a view draws inside of an envelope, in at most `max_rows` rows. Compiles what is not
/// wholly outside.
///
/// # Errors
/// When compiling was interrupted; inside, when there are more rows.
pub fn prune(
    provide: &mut dyn Provide,
    prune: &Prune,
    handlers: &PruneHandlers,
    max_rows: usize,
) -> Result<Result<DrawList, TooManyRows>, Interrupted> {
    discover(provide, &prune_interest(prune))?;
    Ok(prune_compiled(&*provide, prune, handlers, max_rows))
}

/// What a pruning wants compiled: everything that is not wholly outside.
pub fn prune_interest(prune: &Prune) -> impl crate::Interest<State = Standing> + use<> {
    Within(prune.envelope.clone())
}

/// As [`prune`], of what is compiled already.
///
/// # Errors
/// When there are more than `max_rows` rows.
pub fn prune_compiled(
    supply: &dyn Supply,
    prune: &Prune,
    handlers: &PruneHandlers,
    max_rows: usize,
) -> Result<DrawList, TooManyRows> {
    let map = || FixedMap::with_hasher(fixed_state());
    let mut pruning = Pruning {
        prune: prune.clone(),
        above: Vec::new(),
        notes: map(),
        fates: FixedMap::with_hasher(fixed_state()),
    };
    let mut drawing = Drawing {
        builder: Builder::new(supply, max_rows),
        cut: FixedMap::with_hasher(fixed_state()),
        owners: Vec::new(),
    };
    let mut outcome = Ok(());
    let interest = Within(prune.envelope.clone());
    walk(supply, Order::Pre, &interest, &mut |at| {
        if outcome.is_ok() && !at.state().is_done() {
            outcome = visit(&mut pruning, &mut drawing, handlers, at);
        }
    });
    outcome.map(|()| drawing.builder.finish())
}

fn visit(
    pruning: &mut Pruning,
    drawing: &mut Drawing<'_>,
    handlers: &PruneHandlers,
    at: &At<'_, Standing>,
) -> Result<(), TooManyRows> {
    let place = at.path().number();
    if at.enters_plan() {
        pruning.above.push(at.path().number_above());
        let authored = at.plan().authored;
        let owner = drawing.owners.get(at.path().number_above() as usize).copied();
        drawing.owners.push(owner.filter(|_| !authored).unwrap_or(place));
        if place == 0
            && let Some(bound) = at.bound()
            && !bound.is_empty()
        {
            at.state().set_side(pruning.prune.envelope.side_of_bound(bound));
        }
        if authored && at.state().side() == Side::Inside && !pruning.is_bound(place) {
            at.state().set_done();
            return drawing.builder.add(Top { site: at.site(), node: 0 }, *at.world());
        }
        handlers.handle(pruning, at);
        if at.state().is_done() {
            return Ok(());
        }
    }
    draw(pruning, drawing, at)
}

/// What remains, in the making.
struct Drawing<'a> {
    builder: Builder<'a>,
    /// The body of what is cut, by the place of the authored component that draws it.
    cut: FixedMap<u32, u32>,
    /// The place of the authored component that draws what is at each place.
    owners: Vec<u32>,
}

impl Drawing<'_> {
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
}

/// Draws what remains of a node.
fn draw(
    pruning: &Pruning,
    drawing: &mut Drawing<'_>,
    at: &At<'_, Standing>,
) -> Result<(), TooManyRows> {
    let (local, envelope) = (*at.world(), &pruning.prune.envelope);
    let fragment = at.plan().fragment;
    // What is cut does not fade: it is there as from nearby, and from all sides.
    let n_drawn = fragment.n_drawn(at.index());
    if let (Some(Limiter::Fading(fading)), Some(n)) = (fragment.limiter_of(at.index()), n_drawn)
        && fading.drawn(n as u32, 0.0).is_empty()
    {
        return Ok(());
    }
    let is_here = || at.state().side() == Side::Inside || envelope.contains(local.translation);
    match at.node() {
        RenderNode::Mesh { mesh, material } => {
            let Some(mesh) = of_mesh(pruning, at, mesh) else { return Ok(()) };
            let material = Arc::clone(material);
            drawing.add(at, |body| {
                let (instances, range, follows) = (None, None, None);
                body.rows.push(DrawRow { local, mesh, material, instances, range, follows });
            })
        }
        RenderNode::Instances { mesh, material, transforms } => {
            for (mesh, instances) in of_instances(pruning, at, mesh, transforms) {
                let material: Arc<Material> = Arc::clone(material);
                drawing.add(at, |body| {
                    let (range, follows) = (None, None);
                    body.rows.push(DrawRow { local, mesh, material, instances, range, follows });
                })?;
            }
            Ok(())
        }
        RenderNode::Lines(lines) => {
            let Some(lines) = of_lines(pruning, at, lines) else { return Ok(()) };
            let material = fragment.line_material(at.index()).cloned();
            drawing.add(at, |body| {
                body.lines.push(LineRow { local, lines, material, range: None });
            })
        }
        RenderNode::Light(light) => {
            if light.shape != LightShape::Directional && !is_here() {
                return Ok(());
            }
            drawing.add(at, |body| body.lights.push(LightRow { local, light: light.clone() }))
        }
        RenderNode::Camera(camera) => {
            drawing.add(at, |body| body.cameras.push(CameraRow { local, camera: camera.clone() }))
        }
        RenderNode::Label(label) => {
            if !is_here() {
                return Ok(());
            }
            drawing.add(at, |body| body.labels.push(LabelRow { local, label: label.clone() }))
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

/// How something drawn with a bound stands.
fn side(pruning: &Pruning, at: &At<'_, Standing>, bound: &Bound, world: &Affine3) -> Side {
    match at.state().side() {
        Side::Inside => Side::Inside,
        _ => pruning.prune.envelope.side_of_bound(&bound.transformed(world)),
    }
}

fn surface<'a>(pruning: &'a Pruning, world: Affine3) -> Surface<'a> {
    Surface { envelope: &pruning.prune.envelope, world, tolerance: pruning.prune.tolerance }
}

/// What remains of a mesh; itself where that is all.
fn of_mesh(pruning: &Pruning, at: &At<'_, Standing>, mesh: &SharedMesh) -> Option<SharedMesh> {
    if let (Some(fates), Some(shown)) = (pruning.fates_of(at), at.plan().fragment.shown(at.index()))
    {
        if fates.rows.iter().all(|fate| matches!(fate, Fate::Whole)) {
            return Some(mesh.clone());
        }
        let to_plan = fates.world.inverse() * *at.world();
        let mut remains = Remains::new();
        let mut last = None;
        // Those of one part together, so that each is capped once: a mesh that fades has them lie
        // between others.
        let mut triangles: Vec<usize> = (0..mesh.n_triangles()).collect();
        triangles.sort_by_cached_key(|triangle| shown.row(*triangle as u32));
        for triangle in triangles {
            let row = shown.row(triangle as u32);
            if row != last {
                remains.cap();
                last = row;
            }
            match fates.of(row) {
                Fate::Whole => remains.add(mesh, triangle),
                Fate::Gone => {}
                Fate::Cut(part) => {
                    remains.add_cut(mesh, triangle, &Through { part: &**part, to_plan });
                }
            }
        }
        remains.cap();
        return Some(remains.finish()).filter(|mesh| !mesh.is_empty()).map(SharedMesh::new);
    }
    match side(pruning, at, mesh.bound(), at.world()) {
        Side::Inside => Some(mesh.clone()),
        Side::Outside => None,
        Side::Crossing => {
            let surface = surface(pruning, *at.world());
            let mut remains = Remains::new();
            let mut is_all = true;
            for triangle in 0..mesh.n_triangles() {
                is_all &= remains.add_cut(mesh, triangle, &surface);
            }
            remains.leave_open();
            if is_all {
                return Some(mesh.clone());
            }
            Some(remains.finish()).filter(|mesh| !mesh.is_empty()).map(SharedMesh::new)
        }
    }
}

/// Rows of what remains of a repeated mesh: those that are whole, and one mesh of all that were
/// clipped.
fn of_instances(
    pruning: &Pruning,
    at: &At<'_, Standing>,
    mesh: &SharedMesh,
    transforms: &Shared<Vec<Affine3>>,
) -> Vec<(SharedMesh, Option<Shared<Vec<Affine3>>>)> {
    let fates = pruning.fates_of(at);
    let shown = at.plan().fragment.shown(at.index());
    let (mut whole, mut clipped) = (Vec::new(), Mesh::default());
    for (number, transform) in (0..).zip(transforms.iter()) {
        let world = *at.world() * *transform;
        let mut remains = Remains::new();
        let triangles = 0..mesh.n_triangles();
        if let (Some(fates), Some(shown)) = (fates, shown) {
            match fates.of(shown.row(number)) {
                Fate::Whole => whole.push(*transform),
                Fate::Gone => {}
                Fate::Cut(part) => {
                    let to_plan = fates.world.inverse() * world;
                    let through = Through { part: &**part, to_plan };
                    triangles.for_each(|t| {
                        remains.add_cut(mesh, t, &through);
                    });
                    remains.cap();
                }
            }
        } else {
            match side(pruning, at, mesh.bound(), &world) {
                Side::Inside => whole.push(*transform),
                Side::Outside => {}
                Side::Crossing => {
                    let surface = surface(pruning, world);
                    let is_all =
                        triangles.fold(true, |all, t| remains.add_cut(mesh, t, &surface) & all);
                    remains.leave_open();
                    if is_all {
                        whole.push(*transform);
                        continue;
                    }
                }
            }
        }
        let remains = remains.finish();
        if !remains.is_empty() {
            clipped.append(&remains, transform);
        }
    }
    let mut rows = Vec::new();
    if whole.len() == transforms.len() {
        rows.push((mesh.clone(), Some(transforms.clone())));
    } else if !whole.is_empty() {
        rows.push((mesh.clone(), Some(Shared::new(whole))));
    }
    if !clipped.is_empty() {
        rows.push((SharedMesh::new(clipped), None));
    }
    rows
}

/// What remains of lines; themselves where that is all.
fn of_lines(
    pruning: &Pruning,
    at: &At<'_, Standing>,
    lines: &Shared<Vec<sapwood_geom::Polyline>>,
) -> Option<Shared<Vec<sapwood_geom::Polyline>>> {
    let world = *at.world();
    let mut remains = Vec::new();
    if let (Some(fates), Some(shown)) = (pruning.fates_of(at), at.plan().fragment.shown(at.index()))
    {
        let to_plan = fates.world.inverse() * world;
        for (number, line) in (0..).zip(lines.iter()) {
            match fates.of(shown.row(number)) {
                Fate::Whole => remains.push(line.clone()),
                Fate::Gone => {}
                Fate::Cut(part) => {
                    let through = Through { part: &**part, to_plan };
                    remains.extend(lines::cut_line(line, &through, |_, _| false));
                }
            }
        }
    } else {
        for line in lines.iter() {
            match side(pruning, at, &line.bound(), &world) {
                Side::Inside => remains.push(line.clone()),
                Side::Outside => {}
                Side::Crossing => {
                    remains.extend(lines::cut_line(line, &surface(pruning, world), |from, to| {
                        let [from, to] = [from, to].map(|end| world.transform_point3(end));
                        lines::is_near(&pruning.prune.envelope, from, to)
                    }));
                }
            }
        }
    }
    if remains == **lines {
        return Some(lines.clone());
    }
    (!remains.is_empty()).then(|| Shared::new(remains))
}
