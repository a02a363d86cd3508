//! Environments: the chains of slot pushes above places.
//!
//! An environment is made when a walk goes through a link: it names the environment of the
//! parent's site, the site, and the link. Who goes through the same link again in the same pass
//! gets the same environment. Values are computed when somebody asks, by climbing to the nearest
//! known one, and remembered on the whole way for the rest of the pass.

use sapwood_geom::{Digest, Digester, FixedMap, fixed_state};
use sapwood_graph::{EnvId, SiteId};
use smallvec::SmallVec;

use super::{Forced, ForcedDescending, SlotKey, SlotValue, forced_against};

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
    /// The nearest environment from here upwards whose link pushes something: all below it, down
    /// to here, give most slots the same value.
    pushed: EnvId,
    /// The number of the set of slots that are forced here.
    forced: u32,
    /// The number of the list of values that are known here.
    known: u32,
}

/// Slots whose values are forced, sorted.
pub(crate) type ForcedSlots = SmallVec<[SlotKey; 2]>;

/// The number of no set: nothing is forced.
const NOTHING_FORCED: u32 = u32::MAX;

/// The number of no list: no value is known.
const NOTHING_KNOWN: u32 = u32::MAX;

/// What environments need to know of a link.
#[derive(Clone, Copy)]
pub(crate) struct LinkFacts {
    pub(crate) number: u32,
    /// Whether a component that came out of a rule is behind it.
    pub(crate) is_emitted: bool,
    /// Whether it sets any slot for what is behind it.
    pub(crate) pushes: bool,
    /// Whether it forces or protects any.
    pub(crate) forces: bool,
}

/// What a link does to the slots of whoever is behind it.
pub(crate) trait LinkPushes {
    /// What a link pushes of `slot`, where the inherited value is forced or not.
    fn push(&self, site: SiteId, link: u32, slot: SlotKey, is_forced: bool) -> Pushed<'_>;

    /// The slots that are forced behind a link, where `above` are forced before it.
    fn forced(&self, site: SiteId, link: u32, above: ForcedSlots) -> ForcedSlots;

    /// The key of the child behind a link.
    fn child_key(&self, site: SiteId, link: u32) -> u64;

    /// The value at the root of the view.
    fn root_value(&self, slot: SlotKey) -> Option<SlotValue>;
}

/// The pushes of one slot at one link.
pub(crate) enum Pushed<'a> {
    /// The slot stays as it is.
    Nothing,
    /// The link replaces what is inherited.
    Replaced(&'a SlotValue),
    /// The link merges these values into what is inherited, outermost first.
    Merged(smallvec::SmallVec<[SlotValue; 2]>),
}

/// The environments of one pass.
pub(crate) struct Environments {
    above: Vec<Above>,
    /// The values known of environments; few, for rules read few slots. Most environments have no
    /// list: what is pushed further up counts for them.
    values: Vec<SmallVec<[(SlotKey, SlotValue); 4]>>,
    entered: FixedMap<(EnvId, SiteId, u32), EnvId>,
    /// The sets of forced slots, none of them empty: those of the root, and those behind links
    /// that force or protect.
    forced: Vec<ForcedSlots>,
}

impl Environments {
    pub(crate) fn new(forced: ForcedSlots) -> Self {
        let mut new = Self {
            above: Vec::new(),
            values: Vec::new(),
            forced: Vec::new(),
            entered: FixedMap::with_hasher(fixed_state()),
        };
        new.clear(forced);
        new
    }

    pub(crate) fn root() -> EnvId {
        EnvId(ROOT)
    }

    /// Forgets everything but the root, where these slots are forced.
    pub(crate) fn clear(&mut self, forced: ForcedSlots) {
        self.above.clear();
        let nowhere = SiteId(u32::MAX);
        let root = EnvId(ROOT);
        self.forced.clear();
        let root_forced = if forced.is_empty() { NOTHING_FORCED } else { 0 };
        if !forced.is_empty() {
            self.forced.push(forced);
        }
        self.above.push(Above {
            env: root,
            site: nowhere,
            link: 0,
            n_emitted: 0,
            pushed: root,
            forced: root_forced,
            known: NOTHING_KNOWN,
        });
        self.values.clear();
        self.entered.clear();
    }

    /// The environment behind `link` of `site`.
    pub(crate) fn enter(
        &mut self,
        pushes: &dyn LinkPushes,
        env: EnvId,
        site: SiteId,
        link: LinkFacts,
    ) -> EnvId {
        let Self { above, entered, forced: sets, .. } = self;
        *entered.entry((env, site, link.number)).or_insert_with(|| {
            let new = u32::try_from(above.len()).expect("a pass meets fewer than 2^32 places");
            let Above { n_emitted, pushed, mut forced, .. } = above[env.0 as usize];
            if link.forces {
                let above = sets.get(forced as usize).cloned().unwrap_or_default();
                let behind = pushes.forced(site, link.number, above);
                if behind.is_empty() {
                    forced = NOTHING_FORCED;
                } else {
                    forced = sets.len() as u32;
                    sets.push(behind);
                }
            }
            above.push(Above {
                env,
                site,
                link: link.number,
                n_emitted: if link.is_emitted { n_emitted + 1 } else { 0 },
                pushed: if link.pushes { EnvId(new) } else { pushed },
                forced,
                known: NOTHING_KNOWN,
            });
            EnvId(new)
        })
    }

    /// How an environment was reached; nothing for the root.
    pub(crate) fn above(&self, env: EnvId) -> Option<Above> {
        (env.0 != ROOT).then(|| self.above[env.0 as usize])
    }

    /// The environment that stands for `env` where `slot` is asked for.
    fn pushed(&self, env: EnvId, slot: SlotKey) -> EnvId {
        if slot.served().is_some() {
            // One for the whole view.
            return EnvId(ROOT);
        }
        if slot.descends() { env } else { self.above[env.0 as usize].pushed }
    }

    fn known(&self, env: EnvId, slot: SlotKey) -> Option<&SlotValue> {
        let values = self.values.get(self.above[env.0 as usize].known as usize)?;
        values.iter().find(|(known, _)| *known == slot).map(|(_, value)| value)
    }

    fn note(&mut self, env: EnvId, slot: SlotKey, value: SlotValue) {
        let row = &mut self.above[env.0 as usize].known;
        if *row == NOTHING_KNOWN {
            *row = self.values.len() as u32;
            self.values.push(SmallVec::new());
        }
        self.values[*row as usize].push((slot, value));
    }

    /// The slots that are forced in an environment.
    fn forced(&self, env: EnvId) -> &[SlotKey] {
        self.forced.get(self.above[env.0 as usize].forced as usize).map_or(&[], |set| set)
    }

    /// Whether a slot is forced in an environment.
    pub(crate) fn is_forced(&self, env: EnvId, slot: SlotKey) -> bool {
        self.forced(env).contains(&slot)
    }

    /// The digest of everything that is forced in an environment, as far as `all` stands for it.
    fn forced_digest(&mut self, pushes: &dyn LinkPushes, env: EnvId, all: SlotKey) -> Digest {
        let mut forced = ForcedSlots::from(self.forced(env));
        forced.retain(|slot| forced_against(*slot) == all);
        if forced.is_empty() {
            return Digest::from_bits(0);
        }
        let mut digester = Digester::new();
        for slot in forced {
            digester.add(slot.name()).add(&self.digest(pushes, env, slot));
        }
        digester.finish()
    }

    /// The digest of a slot's value.
    pub(crate) fn digest(&mut self, pushes: &dyn LinkPushes, env: EnvId, slot: SlotKey) -> Digest {
        if [SlotKey::of::<Forced>(), SlotKey::of::<ForcedDescending>()].contains(&slot) {
            return self.forced_digest(pushes, env, slot);
        }
        match self.known(self.pushed(env, slot), slot) {
            Some(value) => value.digest,
            None => self.value(pushes, env, slot).digest,
        }
    }

    /// The value of a slot.
    pub(crate) fn value(
        &mut self,
        pushes: &dyn LinkPushes,
        env: EnvId,
        slot: SlotKey,
    ) -> SlotValue {
        if let Some(known) = self.known(self.pushed(env, slot), slot) {
            return known.clone();
        }
        // Places between here and the nearest known value, with what happens at each.
        let mut passed: smallvec::SmallVec<[(EnvId, Pushed<'_>); 4]> = smallvec::SmallVec::new();
        let mut at = self.pushed(env, slot);
        let mut value = loop {
            if let Some(known) = self.known(at, slot) {
                break known.clone();
            }
            let Some(above) = self.above(at) else {
                let value = pushes.root_value(slot).unwrap_or_else(|| slot.default());
                self.note(EnvId(ROOT), slot, value.clone());
                break value;
            };
            let is_forced = self.is_forced(above.env, slot);
            let pushed = pushes.push(above.site, above.link, slot, is_forced);
            let replaced = match &pushed {
                Pushed::Replaced(new) => Some(SlotValue::clone(new)),
                Pushed::Nothing | Pushed::Merged(_) => None,
            };
            passed.push((at, pushed));
            if let Some(new) = replaced {
                // Whatever is inherited here does not matter.
                break new;
            }
            at = self.pushed(above.env, slot);
        };
        // Remembered at every place, so that no stretch of the way up is climbed twice.
        for (place, pushed) in passed.into_iter().rev() {
            match pushed {
                Pushed::Nothing | Pushed::Replaced(_) => {}
                Pushed::Merged(list) => {
                    value = list.iter().fold(value, |value, new| slot.merge(&value, new));
                }
            }
            if slot.descends()
                && let Some(above) = self.above(place)
            {
                value = slot.descend(value, pushes.child_key(above.site, above.link));
            }
            self.note(place, slot, value.clone());
        }
        value
    }
}
