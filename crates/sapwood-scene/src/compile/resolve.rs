//! Resolving: which rule serves a component, and whether what is there still answers to it.

use std::sync::Arc;

use sapwood_graph::{Kind, SiteId, Supply};

use super::cache::{Cache, KnownRule, Target};
use super::pull::Pull;
use crate::column::AnyColumn;
use crate::rules::AnyRule;
use crate::semantic::Graph;
use crate::view::View;

impl Cache {
    /// The number of a rule: the same for every view that uses an equal rule.
    fn rule_number(&mut self, rule: &Arc<dyn AnyRule>) -> u32 {
        let identity = rule.identity();
        let known = self.rules.iter().position(|known| known.identity == identity);
        let number = known.unwrap_or_else(|| {
            let data: Box<dyn AnyColumn> = rule.new_column();
            let interfaces = rule.interfaces();
            self.rules.push(KnownRule { identity, rule: Arc::clone(rule), data, interfaces });
            self.rules.len() - 1
        });
        number as u32
    }

    /// Finds the rule of every kind that has been met.
    pub(crate) fn resolve_kinds(&mut self, view: &mut View, graph: &Graph) {
        while view.authored_rules.len() < graph.storage.n_kinds() {
            let kind = graph.storage.kind_numbered(view.authored_rules.len() as u32);
            let number = view.root_values.rules.rule(kind).map(|rule| self.rule_number(rule));
            view.authored_rules.push(number);
        }
        while let Some(kind) = self.emitted.kinds().get(view.emitted_rules.len()).copied() {
            let number = view.root_values.rules.rule(kind).map(|rule| self.rule_number(rule));
            view.emitted_rules.push(number);
        }
    }
}

impl Pull<'_> {
    /// The kind of a component; nothing when it was removed.
    pub(super) fn target_kind(&self, target: Target) -> Option<Kind> {
        match target {
            Target::View(_) => None,
            Target::Authored(node) => self.graph.kind(node).ok(),
            Target::Emitted(number) => Some(self.cache.emitted.kind(number)),
        }
    }

    /// The number of the rule that serves a component, where one does.
    pub(super) fn rule_for(&self, target: Target) -> Option<u32> {
        let (rules, kind) = match target {
            Target::View(_) => return None,
            Target::Authored(node) => {
                (&self.view.authored_rules, self.graph.node(node).ok()?.component.kind)
            }
            Target::Emitted(number) => (&self.view.emitted_rules, self.cache.emitted[number].kind),
        };
        rules.get(kind as usize).copied().flatten()
    }

    /// Whether a site's plan is the one that its component and the view's rules ask for, its
    /// reads left aside; and whether everything below it is settled. One look-up for both, for
    /// this is asked of every sibling of what was edited.
    pub(super) fn standing(&self, site: SiteId) -> Standing {
        let row = &self.cache.sites[site.0];
        let plan = &self.cache.plans[row.plan];
        let (is_current, edited_below) = match plan.target {
            Target::View(_) => {
                return Standing { is_current: true, is_settled: self.is_settled(site) };
            }
            Target::Authored(node) => {
                let Ok(node) = self.graph.node(node) else {
                    return Standing { is_current: false, is_settled: false };
                };
                let rule = self.view.authored_rules.get(node.component.kind as usize);
                let is_served = rule.copied().flatten() == Some(plan.rule);
                (is_served && plan.revision == node.edited, node.edited_below)
            }
            Target::Emitted(_) => (self.rule_for(plan.target) == Some(plan.rule), 0),
        };
        let required = edited_below.max(self.view.rules_since);
        Standing { is_current, is_settled: row.is_closed && row.verified >= required }
    }

    /// The revision that everything below a site must have been brought up to.
    pub(super) fn required(&self, site: SiteId) -> u64 {
        required(self.graph, self.view, self.cache.plan_of(site).target)
    }
}

/// How a site stands towards its component.
pub(super) struct Standing {
    /// Whether its plan is the one that the component and the rules ask for.
    pub(super) is_current: bool,
    /// Whether everything below it is compiled and up to date.
    pub(super) is_settled: bool,
}

fn required(graph: &Graph, view: &View, target: Target) -> u64 {
    // What was removed is out of date whenever anything was edited since.
    let below = |node| graph.node(node).map_or(graph.revision, |node| node.edited_below);
    let edited = match target {
        Target::View(_) => below(view.root).max(view.values_since),
        Target::Authored(node) => below(node),
        Target::Emitted(_) => 0,
    };
    edited.max(view.rules_since)
}
