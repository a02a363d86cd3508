//! Transforms.

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Content, Digester};
use sapwood_graph::Named;

use crate::{Children, Component, Context, Placement, Question, Rule, RuleError};

/// An attribute that places its child: from the child's frame to the frame outside. Where it has
/// a value sub-graph, the product of the transforms in there follows its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(pub Affine3);

impl Content for Transform {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

impl Transform {
    /// A transform that moves by `x`, `y`, `z` metres.
    pub fn translation(x: f32, y: f32, z: f32) -> Self {
        Self(Affine3::from_translation(Vec3::new(x, y, z)))
    }
}

impl Named for Transform {
    const NAME: &'static str = "transform";
}

impl Component for Transform {
    const CHILDREN: Children = Children::One;

    fn answer(&self, question: &mut Question) {
        question.offer::<Placement>(self.0);
        question.children();
    }
}

pub(super) struct TransformRule;

impl Rule for TransformRule {
    type Component = Transform;
    type Data = ();
    const NAME: &'static str = "transform";

    fn init(&self, transform: &Transform, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let asked = cx.ask::<Placement>()?;
        let whole = asked.map_or(transform.0, |asked| transform.0 * *asked);
        if !whole.is_finite() {
            return Err(RuleError::Failed(format!("the transform is not finite: {whole:?}")));
        }
        cx.transform(whole, Context::children);
        Ok(())
    }
}
