//! A traversal that weighs a scene. It knows no component: what weighs how much, its handlers
//! say.

use std::collections::BTreeMap;

use sapwood::graph::{At, Everything, Handlers, Order};
use sapwood::scene::{Scene, ViewError, ViewId};

/// What the traversal gathers: kilograms by kind.
#[derive(Debug, Default)]
pub struct Scales(BTreeMap<&'static str, f64>);

impl Scales {
    /// Puts `cubic_metres` of something on the scales, where a walk has found it: transforms
    /// above make it larger or smaller.
    pub fn put<S>(&mut self, cubic_metres: f64, density: f64, at: &At<'_, S>) {
        let stretch = f64::from(at.world().matrix3.determinant().abs());
        *self.0.entry(at.plan().kind.name()).or_default() += cubic_metres * density * stretch;
    }

    /// Kilograms by kind, sorted by name.
    pub fn kilograms(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        self.0.iter().map(|(kind, kilograms)| (*kind, *kilograms))
    }
}

/// Weighs everything in a view; what no handler serves weighs nothing, but what is below it may.
///
/// # Errors
/// When the view is closed, or compiling was interrupted.
pub fn weigh(
    scene: &mut Scene,
    view: ViewId,
    handlers: &Handlers<Scales>,
) -> Result<Scales, ViewError> {
    let mut scales = Scales::default();
    scene.traverse(view, Order::Pre, &Everything, &mut |at| handlers.handle(&mut scales, at))?;
    Ok(scales)
}
