//! Traversals of views. Each compiles what it needs first.

use sapwood_geom::{Bound, Ray};
use sapwood_graph::{
    AlongRay, At, Counts, Diagnostic, DrawList, Everything, Finding, Hit, Interest, Interrupted,
    Moved, Order, PickOptions, Poses, Provide, Prune, PruneHandlers, PruneLimits, Remaining,
    Report, Severity, Standing, Supply, count, diagnostics, discover, draw_list, dump, outline,
    pick_compiled, prune_compiled, prune_each, prune_interest, verify, walk,
};

use super::Scene;
use crate::built_in::kinds_of_attributes;
use crate::compile::{Cache, Pull};
use crate::rules::VisitContext;
use crate::{Time, ViewError, ViewId, Viewer, WindSlot};

/// How often a traversal begins again after room was made for it.
const MOST_ATTEMPTS: usize = 64;

/// Traversals. Each compiles what it needs first.
impl Scene {
    /// The view's side of the opening between scene and walks, for foreign traversals.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn supply(&mut self, view: ViewId) -> Result<impl Provide + '_, ViewError> {
        self.evict_if_bloated(view);
        self.pull(view)
    }

    pub(super) fn pull(&mut self, view: ViewId) -> Result<Pull<'_>, ViewError> {
        let row = self.views.get_mut(view.number).filter(|row| row.generation == view.generation);
        let row = row.ok_or(ViewError::Closed)?;
        self.graph.pull();
        Ok(Pull::new(
            &self.graph,
            &mut self.cache,
            row,
            view.number,
            #[cfg(feature = "planted-faults")]
            self.drops_reads,
        ))
    }

    /// Compiles what `interest` asks for, walks over it in `order` and calls `visitor` for each
    /// node.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted; nothing is walked then.
    pub fn traverse<I: Interest>(
        &mut self,
        view: ViewId,
        order: Order,
        interest: &I,
        visitor: &mut dyn FnMut(&At<'_, I::State>),
    ) -> Result<(), ViewError> {
        self.discover(view, interest)?;
        walk(&self.pull(view)?, order, interest, visitor);
        self.evict_if_bloated(view);
        Ok(())
    }

    /// Compiles what `interest` asks for. Where a budget runs out, what no view shows any more
    /// makes room, as long as there is any.
    pub(super) fn discover<I: Interest>(
        &mut self,
        view: ViewId,
        interest: &I,
    ) -> Result<(), ViewError> {
        for _ in 0..MOST_ATTEMPTS {
            match discover(&mut self.pull(view)?, interest) {
                Err(Interrupted::Exhausted { .. }) if self.make_room() => {}
                outcome => return Ok(outcome?),
            }
        }
        Ok(discover(&mut self.pull(view)?, interest)?)
    }

    /// Throws away what no view shows, and tells whether that left more of any budget.
    fn make_room(&mut self) -> bool {
        let used = |cache: &Cache| (cache.triangles, cache.n_parts, cache.plans.len());
        let before = used(&self.cache);
        self.evict();
        before != used(&self.cache)
    }

    /// Compiles everything and reads the result.
    pub(super) fn complete<R>(
        &mut self,
        view: ViewId,
        read: impl FnOnce(&mut Pull<'_>) -> R,
    ) -> Result<R, ViewError> {
        self.discover(view, &Everything)?;
        let result = read(&mut self.pull(view)?);
        self.evict_if_bloated(view);
        Ok(result)
    }

    /// The bound of everything in a view, in the root's frame. O(1) when nothing has changed.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn bounds(&mut self, view: ViewId) -> Result<Bound, ViewError> {
        self.complete(view, |pull| {
            let (_, root) = pull.root();
            pull.bound(root).copied().unwrap_or(Bound::EMPTY)
        })
    }

    /// How many components and parts of each kind a view shows, every occurrence counted.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn count(&mut self, view: ViewId) -> Result<Counts, ViewError> {
        self.complete(view, |pull| {
            let mut memo = pull.take_counts();
            let counts = count(&*pull, &mut memo);
            pull.give_counts(memo);
            counts
        })
    }

    /// What a view draws, in at most `max_rows` rows.
    ///
    /// # Errors
    /// When the view is closed, compiling was interrupted, or there are more rows.
    pub fn draw_list(&mut self, view: ViewId, max_rows: usize) -> Result<DrawList, ViewError> {
        Ok(self.complete(view, |pull| draw_list(&*pull, max_rows))??)
    }

    /// Moves the poses of a list that the view draws to its [`Time`], in its wind ([`WindSlot`]), as
    /// far as its [`Viewer`] can see it. Compiles nothing and looks at no component: the list is as
    /// it was made.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn sway(&self, view: ViewId, poses: &mut Poses) -> Result<Moved, ViewError> {
        let row = self.views.get(view.number).filter(|row| row.generation == view.generation);
        let row = row.ok_or(ViewError::Closed)?;
        let cx = VisitContext { moving: &row.moving, defaults: &row.moving_defaults };
        let (wind, time) = (*cx.read::<WindSlot>(), *cx.read::<Time>());
        Ok(poses.update(wind, time, cx.read::<Viewer>().as_ref().as_ref()))
    }

    /// What a view draws inside of an envelope, in at most `max_rows` rows; `handlers` know how
    /// parts are cut. Compiles only what is not wholly outside. The scene stays as it is.
    ///
    /// The view's token ends cutting as it ends compiling, and what is cut may have as many triangles
    /// as the view's budget allows.
    ///
    /// # Errors
    /// When the view is closed, compiling or cutting was interrupted, or there are more rows.
    pub fn prune(
        &mut self,
        view: ViewId,
        prune: &Prune,
        handlers: &PruneHandlers,
        max_rows: usize,
    ) -> Result<DrawList, ViewError> {
        self.pruned(view, prune, max_rows, |pull, limits| {
            Ok(prune_compiled(pull, prune, handlers, limits)??)
        })
    }

    /// As [`prune`](Self::prune), but calls `visitor` for each node of which something may remain
    /// instead of making a draw list.
    ///
    /// # Errors
    /// When the view is closed, or compiling or cutting was interrupted.
    pub fn traverse_pruned(
        &mut self,
        view: ViewId,
        prune: &Prune,
        handlers: &PruneHandlers,
        visitor: &mut dyn FnMut(&Remaining<'_>, &At<'_, Standing>),
    ) -> Result<(), ViewError> {
        self.pruned(view, prune, usize::MAX, |pull, limits| {
            Ok(prune_each(pull, prune, handlers, limits, visitor)?)
        })
    }

    /// Compiles what a pruning wants, and reads the result within the view's limits.
    fn pruned<R>(
        &mut self,
        view: ViewId,
        prune: &Prune,
        rows: usize,
        read: impl FnOnce(&Pull<'_>, &PruneLimits<'_>) -> Result<R, ViewError>,
    ) -> Result<R, ViewError> {
        self.discover(view, &prune_interest(prune))?;
        let token = self.cancel_token(view)?;
        let triangles = self.view_mut(view)?.budget.triangles;
        let goes_on = || !token.is_cancelled();
        let limits = PruneLimits { rows, triangles, goes_on: &goes_on };
        let result = read(&self.pull(view)?, &limits);
        self.evict_if_bloated(view);
        result
    }

    /// What a view compiled to, as stable text of at most `max_lines` lines.
    ///
    /// What was read, and what is found by what, is told by [`explain`](Self::explain).
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn dump(&mut self, view: ViewId, max_lines: usize) -> Result<String, ViewError> {
        self.complete(view, |pull| dump(&*pull, max_lines))
    }

    /// What a view shows, as an outline that a person can read: a paragraph for each component,
    /// indented below the one that holds it, for at most `max_entries` of them. Where rules made
    /// lines of text of a component, these are told.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn outline(&mut self, view: ViewId, max_entries: usize) -> Result<String, ViewError> {
        let folded = kinds_of_attributes();
        self.complete(view, |pull| outline(&*pull, &folded, max_entries))
    }

    /// What a ray, in the root's frame, meets first. Compiles only what the ray may meet.
    ///
    /// # Errors
    /// When the view is closed, compiling was interrupted, or the ray comes by too many places.
    pub fn pick(
        &mut self,
        view: ViewId,
        ray: &Ray,
        options: &PickOptions,
    ) -> Result<Option<Hit>, ViewError> {
        let pull = self.pull(view)?;
        let compiled = pick_compiled(&pull, ray, options)?;
        if !ray.is_sound() || pull.is_settled(pull.root().1) {
            return Ok(compiled);
        }
        self.discover(view, &AlongRay::new(ray, options, compiled.as_ref()))?;
        let hit = pick_compiled(&self.pull(view)?, ray, options)?;
        self.evict_if_bloated(view);
        Ok(hit)
    }

    /// Looks for faults in everything that a view compiled to and in the scene's own structure,
    /// and tells `limit` of them at most. Changes nothing; costs every distinct triangle.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn verify(&mut self, view: ViewId, limit: usize) -> Result<Report, ViewError> {
        let fault = self.fault();
        self.complete(view, |pull| {
            let mut report = verify(&*pull, limit);
            if let Some(message) = fault {
                let (severity, kind) = (Severity::Error, pull.plan(pull.root().1).kind);
                report.add(Finding { severity, path: Vec::new(), kind, message });
            }
            report
        })
    }

    /// What could not be compiled, components without a rule included, each with the links that
    /// lead there; at most `limit`.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn diagnostics(
        &mut self,
        view: ViewId,
        limit: usize,
    ) -> Result<Vec<(Vec<u32>, Diagnostic)>, ViewError> {
        self.complete(view, |pull| diagnostics(&*pull, limit))
    }
}
