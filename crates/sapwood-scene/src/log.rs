//! The event log: what the compiler did, for tests and for people who write rules.

use sapwood_graph::Kind;

use crate::NodeId;
use crate::compile::Target;
use crate::rules::RuleIdentity;

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Action {
    /// A rule's `init` ran; told once where it was begun again for the sake of an ingredient.
    Compiled,
    /// A plan was found that answers to what was read, and used again.
    Reused,
    /// A plan that nothing shows was thrown away.
    Discarded,
    /// A rule's `visit` ran.
    Visited,
}

/// Something that happened to a component of a kind, by a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// What happened.
    pub action: Action,
    /// The component's kind.
    pub kind: Kind,
    /// The rule's name.
    pub rule: &'static str,
    /// The component, where the user placed it; nothing where it came out of a rule.
    pub node: Option<NodeId>,
}

/// Events in the order in which they happened; off until somebody turns it on.
#[derive(Debug, Default)]
pub(crate) struct EventLog {
    pub(crate) is_on: bool,
    pub(crate) events: Vec<Event>,
}

impl EventLog {
    pub(crate) fn note(&mut self, action: Action, rule: &RuleIdentity, target: Target) {
        let RuleIdentity { kind, name: rule, .. } = *rule;
        let node = match target {
            Target::Authored(node) => Some(node),
            Target::View(_) | Target::Emitted(_) => None,
        };
        tracing::trace!(?action, %kind, rule, ?node);
        if self.is_on {
            self.events.push(Event { action, kind, rule, node });
        }
    }
}
