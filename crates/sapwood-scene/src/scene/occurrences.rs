//! What stands along a path of links: the way back from a pick to what can be edited.
//!
//! An event is an edit: pick, find the component along the occurrence's path, edit it through
//! its handle. Each question compiles the path, and nothing beside it.

use sapwood_geom::glam::Affine3;
use sapwood_graph::{Approach, At, Interest, Order, Supplied, Supply as _, walk};

use super::Scene;
use crate::{Component, Handle, NodeId, ViewError, ViewId};

impl Scene {
    /// The components that the user placed along a path of links, from the view's root on. Where
    /// the path leaves what is there now, there are none.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn components_along(
        &mut self,
        view: ViewId,
        path: &[u32],
    ) -> Result<Vec<NodeId>, ViewError> {
        self.discover(view, &Along(path))?;
        let pull = self.pull(view)?;
        let (mut env, mut site) = pull.root();
        let mut components = Vec::new();
        for link in path {
            if *link >= pull.plan(site).fragment.n_links() {
                return Ok(Vec::new());
            }
            components.extend(pull.authored_behind(site, *link));
            match pull.enter(env, site, *link) {
                (below, Supplied::Ready(child)) => (env, site) = (below, child),
                // What cannot be compiled has a component all the same.
                _ => break,
            }
        }
        Ok(components)
    }

    /// The component that the user placed at the end of a path of links, or else the nearest one
    /// above: the one whose edits change what stands there. Nothing where the path leaves what
    /// is there now.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn component_at(
        &mut self,
        view: ViewId,
        path: &[u32],
    ) -> Result<Option<NodeId>, ViewError> {
        Ok(self.components_along(view, path)?.last().copied())
    }

    /// The nearest component of type `C` at the end of a path of links or above, among those that
    /// the user placed.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn nearest<C: Component>(
        &mut self,
        view: ViewId,
        path: &[u32],
    ) -> Result<Option<Handle<C>>, ViewError> {
        let components = self.components_along(view, path)?;
        Ok(components.iter().rev().find_map(|node| self.handle(*node)))
    }

    /// From the frame of whatever stands at the end of a path of links to the root's, turns to
    /// the eye and live values included. Nothing where the path leaves what is there now.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn frame_at(&mut self, view: ViewId, path: &[u32]) -> Result<Option<Affine3>, ViewError> {
        self.discover(view, &Along(path))?;
        let mut frame = None;
        walk(&self.pull(view)?, Order::Pre, &Along(path), &mut |at: &At<'_, usize>| {
            if at.enters_plan() && *at.state() == path.len() {
                frame = Some(*at.world());
            }
        });
        Ok(frame)
    }
}

/// The interest in the places along a path, and in nothing below its end.
struct Along<'a>(&'a [u32]);

impl Interest for Along<'_> {
    /// How many links are behind us.
    type State = usize;

    fn start(&self) -> usize {
        0
    }

    fn enter(&self, done: &usize, child: &Approach<'_>) -> Option<usize> {
        (self.0.get(*done) == Some(&child.link)).then_some(done + 1)
    }
}
