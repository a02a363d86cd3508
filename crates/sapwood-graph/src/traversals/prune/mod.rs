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
mod drawing;
mod fate;
mod lines;
mod meter;
mod remaining;
mod stand;

use std::any::Any;

use sapwood_geom::{Envelope, FixedMap, Side, fixed_state};

pub use fate::{Beyond, Fate};
pub use meter::PruneLimits;
pub use remaining::Remaining;
pub use stand::Standing;

use super::draw_list::Top;
use super::{DrawList, TooManyRows};
use crate::{At, Handlers, Interrupted, Order, Part, Provide, Supply, discover, walk};
use drawing::Drawing;
use fate::Fates;
use meter::Meters;
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

    /// Notes a place that the walk enters, and how the root stands.
    fn enter(&mut self, at: &At<'_, Standing>) {
        self.above.push(at.path().number_above());
        if at.path().number() == 0
            && let Some(bound) = at.bound()
            && !bound.is_empty()
        {
            at.state().set_side(self.prune.envelope.side_of_bound(bound));
        }
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

/// What a view draws inside of an envelope. Compiles what is not wholly outside.
///
/// # Errors
/// When compiling or cutting was interrupted; inside, when there are more rows than allowed.
pub fn prune(
    provide: &mut dyn Provide,
    prune: &Prune,
    handlers: &PruneHandlers,
    limits: &PruneLimits<'_>,
) -> Result<Result<DrawList, TooManyRows>, Interrupted> {
    discover(provide, &prune_interest(prune))?;
    prune_compiled(&*provide, prune, handlers, limits)
}

/// What a pruning wants compiled: everything that is not wholly outside.
pub fn prune_interest(prune: &Prune) -> impl crate::Interest<State = Standing> + use<> {
    Within(prune.envelope.clone())
}

/// As [`prune`], of what is compiled already.
///
/// # Errors
/// When cutting was interrupted; inside, when there are more rows than allowed.
pub fn prune_compiled(
    supply: &dyn Supply,
    prune: &Prune,
    handlers: &PruneHandlers,
    limits: &PruneLimits<'_>,
) -> Result<Result<DrawList, TooManyRows>, Interrupted> {
    let mut drawing = Drawing::new(supply, limits.rows);
    let mut outcome = Ok(());
    walk_pruned(supply, prune, limits, &mut |pruning, meters, at| {
        if outcome.is_ok() {
            outcome = visit(pruning, meters, &mut drawing, handlers, at);
        }
    })?;
    Ok(outcome.map(|()| drawing.finish()))
}

/// Calls `visit` for every node of which something may remain, in pre-order, of what is compiled
/// already: for traversals that make something else than a draw list.
///
/// # Errors
/// When cutting was interrupted; some nodes were visited then, and others not.
pub fn prune_each(
    supply: &dyn Supply,
    prune: &Prune,
    handlers: &PruneHandlers,
    limits: &PruneLimits<'_>,
    visit: &mut dyn FnMut(&Remaining<'_>, &At<'_, Standing>),
) -> Result<(), Interrupted> {
    walk_pruned(supply, prune, limits, &mut |pruning, meters, at| {
        if at.enters_plan() {
            pruning.enter(at);
            handlers.handle(pruning, at);
        }
        if !at.state().is_done() {
            visit(&Remaining { pruning, meters }, at);
        }
    })
}

fn walk_pruned(
    supply: &dyn Supply,
    prune: &Prune,
    limits: &PruneLimits<'_>,
    visit: &mut dyn FnMut(&mut Pruning, &Meters<'_>, &At<'_, Standing>),
) -> Result<(), Interrupted> {
    let mut pruning = Pruning {
        prune: prune.clone(),
        above: Vec::new(),
        notes: FixedMap::with_hasher(fixed_state()),
        fates: FixedMap::with_hasher(fixed_state()),
    };
    let meters = Meters::new(limits);
    let mut outcome = Ok(());
    walk(supply, Order::Pre, &Within(prune.envelope.clone()), &mut |at| {
        if outcome.is_err() {
            // Nothing below is looked at either.
            at.state().set_done();
        } else if !at.state().is_done() {
            visit(&mut pruning, &meters, at);
            outcome = meters.outcome(at.plan().kind);
        }
    });
    outcome
}

fn visit(
    pruning: &mut Pruning,
    meters: &Meters<'_>,
    drawing: &mut Drawing<'_>,
    handlers: &PruneHandlers,
    at: &At<'_, Standing>,
) -> Result<(), TooManyRows> {
    let place = at.path().number();
    if at.enters_plan() {
        pruning.enter(at);
        let authored = at.plan().authored;
        drawing.enter(at, authored);
        if authored && at.state().side() == Side::Inside && !pruning.is_bound(place) {
            at.state().set_done();
            return drawing.add_whole(Top { site: at.site(), node: 0 }, *at.world());
        }
        handlers.handle(pruning, at);
        if at.state().is_done() {
            return Ok(());
        }
    }
    drawing.draw(pruning, &meters.drawn, at)
}
