//! Billboards: turning what is below them to whoever looks.

use sapwood_geom::content;
use sapwood_graph::{Facing, Named};

use crate::{Children, Component, Context, Rule, RuleError};

/// An attribute that turns its child's +z axis to the view's [`Viewer`](crate::Viewer).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Billboard {
    /// Freely, or about an axis alone, whose length does not matter.
    pub facing: Facing,
}

content!(Billboard { facing });

impl Named for Billboard {
    const NAME: &'static str = "billboard";
}

impl Component for Billboard {
    const CHILDREN: Children = Children::One;
}

pub(super) struct BillboardRule;

impl Rule for BillboardRule {
    type Component = Billboard;
    type Data = ();
    const NAME: &'static str = "billboard";

    fn init(&self, billboard: &Billboard, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let facing = match billboard.facing {
            Facing::Eye => Facing::Eye,
            Facing::Axis(axis) => match axis.try_normalize() {
                Some(axis) => Facing::Axis(axis),
                None => return Err(RuleError::Failed(format!("axis {axis} has no direction"))),
            },
        };
        cx.facing(facing, Context::children);
        Ok(())
    }
}
