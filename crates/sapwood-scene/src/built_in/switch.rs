//! Switches: turning what is below on and off.

use sapwood_geom::content;
use sapwood_graph::Named;

use crate::{Children, Component, Context, Question, Rule, RuleError, SwitchedOn};

/// An attribute that shows its child or hides it. What is hidden is not compiled. Where it has a
/// value sub-graph that answers for [`SwitchedOn`], that counts instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switch {
    /// Whether the child is shown.
    pub on: bool,
}

content!(Switch { on });

impl Named for Switch {
    const NAME: &'static str = "switch";
}

impl Component for Switch {
    const CHILDREN: Children = Children::One;

    fn answer(&self, question: &mut Question) {
        question.offer::<SwitchedOn>(self.on);
        if self.on {
            question.children();
        }
    }
}

pub(super) struct SwitchRule;

impl Rule for SwitchRule {
    type Component = Switch;
    type Data = ();
    const NAME: &'static str = "switch";

    fn init(&self, switch: &Switch, cx: &mut Context<'_>) -> Result<(), RuleError> {
        if cx.ask::<SwitchedOn>()?.map_or(switch.on, |on| *on) {
            cx.children();
        }
        Ok(())
    }
}
