//! Held impostors: boards that stand for something from afar, placed in the scene.

use std::sync::Arc;

use sapwood_geom::{Shared, content};
use sapwood_graph::{Impostor, Named};

use crate::{Component, Context, MaterialSlot, Rule, RuleError, Style, StyleSlot};

/// A finished [`Impostor`], as the last child of a [`LevelOfDetail`](crate::LevelOfDetail) beside
/// what it stands for. It shows the aspect that the view's [`Viewer`](crate::Viewer) would see, or
/// between two of them both, as they fade into each other; as wires, the edges of those that are
/// there for no eye.
#[derive(Clone, Debug)]
pub struct HeldImpostor {
    /// The boards.
    pub impostor: Arc<Impostor>,
}

content!(HeldImpostor { impostor });

impl Named for HeldImpostor {
    const NAME: &'static str = "held_impostor";
}

impl Component for HeldImpostor {}

pub(super) struct HeldImpostorRule;

impl Rule for HeldImpostorRule {
    type Component = HeldImpostor;
    type Data = ();
    const NAME: &'static str = "held_impostor";

    fn init(&self, held: &HeldImpostor, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let Impostor { mesh, material, aspects } = &*held.impostor;
        if let Some(why) = mesh.unsound() {
            return Err(RuleError::Failed(why.to_owned()));
        }
        if let Some(fault) = aspects.fault(mesh.n_triangles()) {
            return Err(RuleError::Failed(fault));
        }
        match *cx.read::<StyleSlot>() {
            Style::Solid => {
                let material = cx.own_or_forced::<MaterialSlot>(Arc::clone(material));
                cx.aspects(aspects.clone(), |cx| cx.mesh(mesh.clone(), material));
            }
            Style::Wire | Style::Skeleton => {
                let shown = aspects.drawn(mesh.n_triangles() as u32, None);
                cx.lines(Shared::new(mesh.part(shown.numbers()).edges()));
            }
        }
        Ok(())
    }
}
