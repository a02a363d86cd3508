//! The cache: plans, sites, and the indices by which they are found.

use std::any::Any;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Bound, Digest, Digester, FixedMap, fixed_state};
use sapwood_graph::{
    CountMemo, Diagnostic, Fragment, FragmentBuilder, Interfaces, Kind, Named, Parts, SiteId,
};
use smallvec::SmallVec;

use super::emitted::EmittedComponents;
use super::plan_group::PlanGroup;
use crate::NodeId;
use crate::column::{AnyColumn, Column};
use crate::log::EventLog;
use crate::rules::{AnyRule, Ingredients, Read, RuleIdentity, no_data};
use crate::slots::{NO_SCOPE, Scope, SlotKey};

/// A component that a link leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Target {
    /// What stands above a view's root: no component, a place for the view to begin.
    View(u32),
    /// A component that the user placed; its identity is its id and revision.
    Authored(NodeId),
    /// A component that came out of a rule, by its number; its identity is its content.
    Emitted(u32),
}

/// The rule number of plans that no rule made.
pub(crate) const NO_RULE: u32 = u32::MAX;

/// What a rule's `init` made. Immutable but for `revision`, `has_sites` and `slot_sets`.
pub(crate) struct Plan {
    pub(crate) target: Target,
    pub(crate) rule: u32,
    /// The edit of the authored component that the plan still answers to.
    pub(crate) revision: u64,
    pub(crate) fragment: Fragment,
    pub(crate) links: SmallVec<[PlanLink; 1]>,
    /// Shared with the environments behind its links.
    pub(crate) scopes: Arc<[Scope]>,
    /// Whether any of them forces or protects.
    pub(crate) forces: bool,
    pub(crate) parts: Parts,
    pub(crate) reads: Box<[Read]>,
    /// The slots behind `reads`, those behind projections included; sorted.
    pub(crate) slots: Arc<[SlotKey]>,
    /// The row in the rule's own column; none for an error plan.
    pub(crate) data: Option<u32>,
    pub(crate) error: Option<Box<Diagnostic>>,
    /// The plans whose data it was made of; they live as long as it does.
    pub(crate) ingredients: Option<Box<Ingredients>>,
    /// Whether the plan ever had a site.
    pub(crate) has_sites: bool,
    /// The sets of slots by which sites of this plan are found.
    pub(crate) slot_sets: SmallVec<[Arc<[SlotKey]>; 1]>,
}

/// A child of a plan: which component, under which key, below which push.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PlanLink {
    pub(crate) target: Target,
    pub(crate) key: u64,
    pub(crate) scope: u32,
}

/// A plan in a context.
///
/// `key` holds the values of all slots that are read anywhere below, as far as they are known:
/// it grows while links are filled and is exact when the site is closed. A closed site has no
/// unfilled link anywhere below it.
pub(crate) struct Site {
    pub(crate) plan: u32,
    pub(crate) view: u32,
    /// Sorted by slot.
    pub(crate) key: Vec<(SlotKey, Digest)>,
    /// Grows whenever the key does, or shrinks.
    pub(crate) key_number: u32,
    /// Which of its keys the site was made findable by last.
    pub(crate) enlisted_key: Option<u32>,
    /// The hashes under which the site is indexed.
    pub(crate) indices: SmallVec<[u64; 2]>,
    pub(crate) links: SmallVec<[Link; 1]>,
    /// The revision at which everything below was up to date.
    pub(crate) verified: u64,
    pub(crate) is_closed: bool,
    /// Whether the site or something below it has live values.
    pub(crate) is_moving: bool,
    /// Whether the site or something below it was compiled by a projection that remembers.
    pub(crate) remembers: bool,
    /// The revision at which the site was made.
    pub(crate) made_at: u64,
    /// In the site's own frame; known of closed sites.
    pub(crate) bound: Option<Bound>,
    pub(crate) live: Box<[Affine3]>,
    /// Why the latest visit failed, if it did; live values are as it left them.
    pub(crate) visit_error: Option<Box<Diagnostic>>,
    /// The settling in which the site was last looked at.
    pub(crate) settled_in: u64,
    /// The view's tick for which live values at and below the site were visited last; says
    /// nothing of a site that does not move.
    pub(crate) visited_tick: u64,
}

/// The number of no key: a link whose site was not found to fit yet.
pub(crate) const NOT_CHECKED: u32 = u32::MAX;

/// What stands behind a link.
pub(crate) enum Link {
    Unfilled,
    /// A site, and which of its keys was found to fit when the site above was closed last: as
    /// long as it has that key it fits wherever the site above does.
    Site(SiteId, u32),
    /// Nothing, for a reason found at a revision; it holds until something above is newer.
    Failed(Box<(Diagnostic, u64)>),
}

/// A rule that some view has used.
pub(crate) struct KnownRule {
    pub(crate) identity: RuleIdentity,
    pub(crate) rule: Arc<dyn AnyRule>,
    /// The data of all plans that the rule made.
    pub(crate) data: Box<dyn AnyColumn>,
    /// As what the data can be seen.
    pub(crate) interfaces: Interfaces,
}

/// Everything that was compiled.
pub(crate) struct Cache {
    pub(crate) plans: Column<Plan>,
    pub(crate) sites: Column<Site>,
    pub(crate) emitted: EmittedComponents,
    pub(crate) rules: Vec<KnownRule>,
    /// What plans offer that no rule made.
    no_interfaces: Interfaces,
    pub(crate) groups: FixedMap<(Target, u32), PlanGroup>,
    pub(crate) site_index: FixedMap<u64, SiteId>,
    /// Triangles in all plans together.
    pub(crate) triangles: u64,
    /// Parts in all plans together.
    pub(crate) n_parts: u64,
    /// Number of the latest settling.
    pub(crate) settling: u64,
    /// What was reachable when it was last looked.
    pub(crate) n_reachable: Reachable,
    pub(crate) counts: CountMemo,
    pub(crate) log: EventLog,
    pub(crate) is_checking: bool,
    #[cfg(feature = "planted-faults")]
    pub(crate) stops_early: bool,
    #[cfg(feature = "planted-faults")]
    pub(crate) forgets_forced: bool,
    #[cfg(feature = "planted-faults")]
    pub(crate) drops_ingredients: bool,
}

/// How much could be reached from the views.
#[derive(Clone, Copy, Default)]
pub(crate) struct Reachable {
    pub(crate) plans: usize,
    pub(crate) sites: usize,
}

/// The kind of what stands above a view's root.
pub(crate) struct ViewRoot;

impl Named for ViewRoot {
    const NAME: &'static str = "view";
}

impl Cache {
    pub(crate) fn new() -> Self {
        Self {
            plans: Column::new(),
            sites: Column::new(),
            emitted: EmittedComponents::new(),
            rules: Vec::new(),
            no_interfaces: Interfaces::of::<ViewRoot, ()>(|_| {}),
            groups: FixedMap::with_hasher(fixed_state()),
            site_index: FixedMap::with_hasher(fixed_state()),
            triangles: 0,
            n_parts: 0,
            settling: 0,
            n_reachable: Reachable::default(),
            counts: CountMemo::default(),
            log: EventLog::default(),
            is_checking: false,
            #[cfg(feature = "planted-faults")]
            stops_early: false,
            #[cfg(feature = "planted-faults")]
            forgets_forced: false,
            #[cfg(feature = "planted-faults")]
            drops_ingredients: false,
        }
    }

    pub(crate) fn plan_of(&self, site: SiteId) -> &Plan {
        &self.plans[self.sites[site.0].plan]
    }

    /// The plans that a plan was made of, without what those were made of.
    pub(crate) fn ingredients_of(&self, plan: u32) -> impl Iterator<Item = u32> + '_ {
        let ingredients = self.plans[plan].ingredients.iter();
        ingredients.flat_map(|made_of| made_of.list.iter().map(|ingredient| ingredient.plan))
    }

    /// The kind that a plan was compiled from.
    pub(crate) fn kind_of(&self, plan: &Plan) -> Kind {
        match self.rules.get(plan.rule as usize) {
            Some(known) => known.identity.kind,
            None => Kind::of::<ViewRoot>(),
        }
    }

    /// What the rule made beside the fragment.
    pub(crate) fn data_of(&self, plan: &Plan) -> &(dyn Any + Send + Sync) {
        match (plan.data, self.rules.get(plan.rule as usize)) {
            (Some(row), Some(known)) => known.data.row(row),
            _ => no_data(),
        }
    }

    /// As what the rule offers the plan's data.
    pub(crate) fn interfaces_of(&self, plan: &Plan) -> &Interfaces {
        self.rules.get(plan.rule as usize).map_or(&self.no_interfaces, |known| &known.interfaces)
    }

    /// The digest of everything that a plan is, the reads left out.
    pub(crate) fn digest_of(&self, plan: &Plan) -> Digest {
        let mut digester = Digester::new();
        digester.add(&plan.fragment).add(&plan.parts).add(&plan.links.len());
        for link in &plan.links {
            match link.target {
                Target::View(number) => digester.add(&0u8).add(&number),
                Target::Authored(node) => {
                    digester.add(&1u8).add(&slotmap::Key::data(&node).as_ffi())
                }
                Target::Emitted(number) => digester.add(&2u8).add(&number),
            };
            digester.add(&link.key).add(&link.scope);
        }
        digester.add(&plan.scopes.len());
        for scope in plan.scopes.iter() {
            digester
                .add(&scope.outer)
                .add(scope.slot.name())
                .add(&scope.mode)
                .add(&scope.value.digest);
        }
        digester.add(&plan.error.as_ref().map(|error| error.message.as_str()));
        if let Some(known) = self.rules.get(plan.rule as usize) {
            known.rule.write_data(self.data_of(plan), &mut digester);
        }
        digester.finish()
    }

    /// Makes the site that stands above a view's root: one link, no component.
    pub(crate) fn add_root_site(&mut self, view: u32, root: NodeId, kind: Kind) -> SiteId {
        let mut fragment = FragmentBuilder::new();
        fragment.deferred(kind, None);
        let plan = self.plans.insert(Plan {
            target: Target::View(view),
            rule: NO_RULE,
            revision: 0,
            fragment: fragment.finish(),
            links: smallvec::smallvec![PlanLink {
                target: Target::Authored(root),
                key: 0,
                scope: NO_SCOPE
            }],
            scopes: Arc::default(),
            forces: false,
            parts: Parts::default(),
            reads: Box::default(),
            slots: Arc::default(),
            data: None,
            error: None,
            ingredients: None,
            has_sites: true,
            slot_sets: SmallVec::new(),
        });
        SiteId(self.sites.insert(Site {
            plan,
            view,
            key: Vec::new(),
            key_number: 0,
            enlisted_key: None,
            indices: SmallVec::new(),
            links: smallvec::smallvec![Link::Unfilled],
            verified: 0,
            is_closed: false,
            is_moving: false,
            remembers: false,
            made_at: 0,
            bound: None,
            live: Box::default(),
            visit_error: None,
            settled_in: 0,
            visited_tick: 0,
        }))
    }

    /// Takes a plan and its data out.
    pub(crate) fn remove_plan(&mut self, number: u32) {
        let Some(plan) = self.plans.remove(number) else { return };
        self.triangles -= plan.fragment.n_triangles();
        self.n_parts -= plan.parts.len() as u64;
        if let (Some(row), Some(known)) = (plan.data, self.rules.get_mut(plan.rule as usize)) {
            known.data.discard(row);
        }
    }
}
