//! Selectors: showing one of several.

use sapwood_geom::content;
use sapwood_graph::Named;

use crate::{Children, Choice, Component, Context, Question, Rule, RuleError};

/// Shows one of its children, or none. What is not shown is not compiled. Where it has a value
/// sub-graph that answers for [`Choice`], that counts instead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selector {
    /// The place of the child that is shown; beyond the last one, none is.
    pub shown: Option<usize>,
}

content!(Selector { shown });

impl Named for Selector {
    const NAME: &'static str = "selector";
}

impl Component for Selector {
    const CHILDREN: Children = Children::Many;

    fn answer(&self, question: &mut Question) {
        question.offer::<Choice>(self.shown);
        if let Some(shown) = self.shown {
            question.child(shown);
        }
    }
}

pub(super) struct SelectorRule;

impl Rule for SelectorRule {
    type Component = Selector;
    type Data = ();
    const NAME: &'static str = "selector";

    fn init(&self, selector: &Selector, cx: &mut Context<'_>) -> Result<(), RuleError> {
        if let Some(shown) = cx.ask::<Choice>()?.map_or(selector.shown, |choice| *choice) {
            cx.child(shown);
        }
        Ok(())
    }
}
