//! Groups.

use sapwood_geom::content;
use sapwood_graph::Named;

use crate::{Children, Component, Context, Rule, RuleError};

/// Holds any number of children together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Group;

content!(Group {});

impl Named for Group {
    const NAME: &'static str = "group";
}

impl Component for Group {
    const CHILDREN: Children = Children::Many;
}

pub(super) struct GroupRule;

impl Rule for GroupRule {
    type Component = Group;
    type Data = ();
    const NAME: &'static str = "group";

    fn init(&self, _: &Group, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.children();
        Ok(())
    }
}
