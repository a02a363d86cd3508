//! Publishing: a draft becomes a plan, and the components in it get their identity.

use std::sync::Arc;

use sapwood_geom::Digest;
use sapwood_graph::Interrupted;
use smallvec::SmallVec;

use super::cache::{Plan, PlanLink, Target};
use super::pull::Pull;
use crate::PushMode;
use crate::rules::{Draft, DraftTarget, Read};
use crate::slots::Scope;

impl Pull<'_> {
    /// Stores a draft as a plan and tells its number.
    pub(super) fn publish(
        &mut self,
        target: Target,
        rule: u32,
        revision: u64,
        draft: Draft,
    ) -> Result<u32, Interrupted> {
        let component = self.cache.rules[rule as usize].identity.kind.name();
        let limits = self.limits();
        limits.check_triangles(draft.fragment.n_triangles(), component)?;
        limits.check_parts(draft.tables.parts.len() as u64, component)?;
        limits.check_plans(1, component)?;
        Ok(self.publish_unlimited(target, rule, revision, draft))
    }

    /// As [`publish`](Self::publish), whatever the budget says.
    pub(super) fn publish_unlimited(
        &mut self,
        target: Target,
        rule: u32,
        revision: u64,
        draft: Draft,
    ) -> u32 {
        let Draft { fragment, tables, data, slots, error } = draft;
        let links = tables.links.into_iter().map(|link| {
            let target = match link.target {
                DraftTarget::Authored(node) => Target::Authored(node),
                DraftTarget::Emitted(digest, component) => {
                    Target::Emitted(self.cache.emitted.identify(digest, component))
                }
            };
            PlanLink { target, key: link.key, scope: link.scope }
        });
        let links = links.collect();
        let (mut reads, ingredients) = (tables.reads, tables.ingredients);
        // One order for one set, in whatever order the rule happened to ask.
        let digest = |read: &Read| Digest::of(&read.key);
        reads.sort_unstable_by(|a, b| a.key.order(&b.key).then_with(|| digest(a).cmp(&digest(b))));
        let column = &mut self.cache.rules[rule as usize].data;
        let data = data.map(|data| column.insert_boxed(data));
        self.cache.triangles += fragment.n_triangles();
        self.cache.n_parts += tables.parts.len() as u64;
        self.cache.plans.insert(Plan {
            target,
            rule,
            revision,
            fragment,
            links,
            forces: tables
                .scopes
                .iter()
                .any(|scope| matches!(scope.mode, PushMode::Force | PushMode::Protect)),
            scopes: shared(tables.scopes),
            parts: tables.parts,
            reads: reads.into(),
            has_sites: false,
            slot_sets: smallvec::smallvec![slots.clone()],
            slots,
            data,
            error,
            ingredients: (ingredients.height > 0).then(|| Box::new(ingredients)),
        })
    }
}

/// Scopes as plans keep them; most plans push nothing, and take no memory for it.
fn shared(scopes: SmallVec<[Scope; 1]>) -> Arc<[Scope]> {
    if scopes.is_empty() { Arc::default() } else { scopes.into_iter().collect() }
}
