//! Rule sets: which rule serves which kind.

use std::fmt;
use std::panic::Location;
use std::sync::Arc;

use sapwood_graph::Kind;

use super::{AnyRule, Rule};

/// Which rule serves which kind, in layers: what a layer lacks is looked for below it.
#[derive(Clone, Default)]
pub struct RuleSet {
    rules: Vec<Registered>,
    below: Option<Arc<RuleSet>>,
}

#[derive(Clone)]
struct Registered {
    kind: Kind,
    rule: Arc<dyn AnyRule>,
    by: &'static Location<'static>,
}

impl RuleSet {
    /// A set without rules; compiles nothing, not even groups.
    pub fn new() -> Self {
        Self::default()
    }

    /// The set with one more rule.
    ///
    /// # Panics
    /// When this layer has a rule for the kind already. To replace a rule of a set made
    /// elsewhere, put a layer [`over`](Self::over) it.
    #[track_caller]
    pub fn with<R: Rule>(mut self, rule: R) -> Self {
        let kind = Kind::of::<R::Component>();
        if let Some(earlier) = self.rules.iter().find(|earlier| earlier.kind == kind) {
            panic!("the rule for {kind} is registered twice, first at {}", earlier.by);
        }
        let by = Location::caller();
        self.rules.push(Registered { kind, rule: Arc::new(rule), by });
        self
    }

    /// The set as a layer over another: its rules come first.
    pub fn over(mut self, below: &RuleSet) -> Self {
        self.below = Some(Arc::new(match self.below.take() {
            None => below.clone(),
            Some(middle) => (*middle).clone().over(below),
        }));
        self
    }

    /// The rule for a kind, from the highest layer that has one.
    pub(crate) fn rule(&self, kind: Kind) -> Option<&Arc<dyn AnyRule>> {
        let mut layer = Some(self);
        while let Some(set) = layer {
            if let Some(found) = set.rules.iter().find(|rule| rule.kind == kind) {
                return Some(&found.rule);
            }
            layer = set.below.as_deref();
        }
        None
    }
}

impl fmt::Debug for RuleSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rules = self.rules.iter().map(|rule| (rule.kind, rule.rule.identity().name));
        f.debug_map().entries(rules).finish()?;
        self.below.as_ref().map_or(Ok(()), |below| write!(f, " over {below:?}"))
    }
}
