//! Environments: the chains of slot pushes above places.
//!
//! An environment is made when a walk goes through a link: it names the environment of the
//! parent's site, the site, and the link. Values are computed when somebody asks, by climbing to
//! the nearest known one, and remembered on the whole way for the rest of the pass.

use std::any::TypeId;

use sapwood_geom::{FixedMap, fixed_state};
use sapwood_graph::{EnvId, SiteId};

use super::{SlotKey, SlotValue};

/// The environment above all: a view's root.
const ROOT: u32 = 0;

/// How an environment was reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Above {
    pub(crate) env: EnvId,
    pub(crate) site: SiteId,
    pub(crate) link: u32,
    /// How many emitted components lie between here and the nearest authored one above.
    pub(crate) n_emitted: u32,
}

/// What a link does to the slots of whoever is behind it.
pub(crate) trait LinkPushes {
    /// The value that stands for `slot` behind a link, given a way to ask for the inherited
    /// one's value if needed: `None` when the link leaves the slot alone.
    fn push(&self, site: SiteId, link: u32, slot: SlotKey) -> Pushed<'_>;

    /// The key of the child behind a link.
    fn child_key(&self, site: SiteId, link: u32) -> u64;

    /// The value at the root of the view.
    fn root_value(&self, slot: SlotKey) -> Option<SlotValue>;
}

/// The pushes of one slot at one link.
pub(crate) enum Pushed<'a> {
    /// The link leaves the slot alone.
    Nothing,
    /// The link replaces what is inherited.
    Replaced(&'a SlotValue),
    /// The link merges these values into what is inherited, outermost first.
    Merged(smallvec::SmallVec<[SlotValue; 2]>),
}

/// The environments of one pass.
pub(crate) struct Environments {
    above: Vec<Above>,
    values: FixedMap<(u32, TypeId), SlotValue>,
}

impl Environments {
    pub(crate) fn new() -> Self {
        let mut new = Self { above: Vec::new(), values: FixedMap::with_hasher(fixed_state()) };
        new.clear();
        new
    }

    pub(crate) fn root() -> EnvId {
        EnvId(ROOT)
    }

    /// Forgets everything but the root.
    pub(crate) fn clear(&mut self) {
        self.above.clear();
        let nowhere = SiteId(u32::MAX);
        self.above.push(Above { env: EnvId(ROOT), site: nowhere, link: 0, n_emitted: 0 });
        self.values.clear();
    }

    /// The environment behind `link` of `site`.
    pub(crate) fn enter(&mut self, env: EnvId, site: SiteId, link: u32, emitted: bool) -> EnvId {
        let n_emitted = if emitted { self.above[env.0 as usize].n_emitted + 1 } else { 0 };
        self.above.push(Above { env, site, link, n_emitted });
        EnvId(u32::try_from(self.above.len() - 1).expect("a pass meets fewer than 2^32 places"))
    }

    /// How an environment was reached; nothing for the root.
    pub(crate) fn above(&self, env: EnvId) -> Option<Above> {
        (env.0 != ROOT).then(|| self.above[env.0 as usize])
    }

    /// The value of a slot.
    pub(crate) fn value(
        &mut self,
        pushes: &dyn LinkPushes,
        env: EnvId,
        slot: SlotKey,
    ) -> SlotValue {
        // Places between here and the nearest known value, with what happens at each.
        let mut passed: smallvec::SmallVec<[(EnvId, Pushed<'_>); 4]> = smallvec::SmallVec::new();
        let mut at = env;
        let mut value = loop {
            if let Some(known) = self.values.get(&(at.0, slot.type_id())) {
                break known.clone();
            }
            let Some(above) = self.above(at) else {
                break pushes.root_value(slot).unwrap_or_else(|| slot.default());
            };
            let pushed = pushes.push(above.site, above.link, slot);
            let is_replaced = matches!(pushed, Pushed::Replaced(_));
            passed.push((at, pushed));
            if is_replaced {
                // Whatever is inherited here does not matter.
                break slot.default();
            }
            at = above.env;
        };
        // Remembered at every place, so that no stretch of the way up is climbed twice.
        for (place, pushed) in passed.into_iter().rev() {
            match pushed {
                Pushed::Nothing => {}
                Pushed::Replaced(new) => value = new.clone(),
                Pushed::Merged(list) => {
                    value = list.iter().fold(value, |value, new| slot.merge(&value, new));
                }
            }
            if slot.descends()
                && let Some(above) = self.above(place)
            {
                value = slot.descend(value, pushes.child_key(above.site, above.link));
            }
            self.values.insert((place.0, slot.type_id()), value.clone());
        }
        value
    }
}
