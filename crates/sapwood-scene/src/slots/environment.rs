//! Environments: the chains of slot pushes above places.
//!
//! An environment is made when a walk goes through a link: it names the environment of the
//! parent's site, the site, and the link. Who goes through the same link again in the same pass
//! gets the same environment. Values are computed when somebody asks, by climbing to the nearest
//! known one, and remembered on the whole way for the rest of the pass. An environment keeps what
//! its link pushes, so that values can be asked for while others are published.

use std::sync::Arc;

use sapwood_geom::{Digest, Digester, FixedMap, fixed_state};
use sapwood_graph::{EnvId, SiteId};
use smallvec::SmallVec;

use super::{Forced, ForcedDescending, LinkPushes, Pushed, SlotKey, SlotValue, forced_against};
use crate::view::RootValues;

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
    /// The number of what the link pushes.
    pushes: u32,
    /// The number of the set of slots that are forced here.
    forced: u32,
    /// The number of the list of values that are known here.
    known: u32,
    /// The key of the child behind the link.
    child_key: u64,
}

/// Slots whose values are forced, sorted.
pub(crate) type ForcedSlots = SmallVec<[SlotKey; 2]>;

/// The number of no set: nothing is forced.
const NOTHING_FORCED: u32 = u32::MAX;

/// The number of no list: no value is known.
const NOTHING_KNOWN: u32 = u32::MAX;

/// The number of no pushes.
const NOTHING_PUSHED: u32 = u32::MAX;

/// What environments need to know of a link.
#[derive(Clone)]
pub(crate) struct LinkFacts {
    pub(crate) number: u32,
    pub(crate) child_key: u64,
    /// Whether a component that came out of a rule is behind it.
    pub(crate) is_emitted: bool,
    /// What it sets for what is behind it, if it sets any slot.
    pub(crate) pushes: Option<LinkPushes>,
    /// Whether it forces or protects any.
    pub(crate) forces: bool,
}

/// The environments of one pass.
pub(crate) struct Environments {
    above: Vec<Above>,
    /// The values known of environments; few, for rules read few slots. Most environments have no
    /// list: what is pushed further up counts for them.
    values: Vec<SmallVec<[(SlotKey, SlotValue); 4]>>,
    entered: FixedMap<(EnvId, SiteId, u32), EnvId>,
    /// What is pushed by links that push something.
    pushes: Vec<LinkPushes>,
    /// What holds above all.
    root_values: Arc<RootValues>,
    /// The sets of forced slots, none of them empty: those of the root, and those behind links
    /// that force or protect.
    forced: Vec<ForcedSlots>,
}

impl Environments {
    pub(crate) fn new(root_values: &Arc<RootValues>) -> Self {
        let mut new = Self {
            above: Vec::new(),
            values: Vec::new(),
            pushes: Vec::new(),
            root_values: Arc::clone(root_values),
            forced: Vec::new(),
            entered: FixedMap::with_hasher(fixed_state()),
        };
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
        let root = EnvId(ROOT);
        self.forced.clear();
        let forced = self.root_values.forced();
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
            pushes: NOTHING_PUSHED,
            forced: root_forced,
            known: NOTHING_KNOWN,
            child_key: 0,
        });
        self.values.clear();
        self.pushes.clear();
        self.entered.clear();
    }

    /// The environment behind `link` of `site`.
    pub(crate) fn enter(&mut self, env: EnvId, site: SiteId, link: LinkFacts) -> EnvId {
        let Self { above, entered, pushes: all_pushes, forced: sets, .. } = self;
        *entered.entry((env, site, link.number)).or_insert_with(|| {
            let LinkFacts { number, child_key, is_emitted, pushes, forces } = link;
            let new = u32::try_from(above.len()).expect("a pass meets fewer than 2^32 places");
            let Above { n_emitted, mut pushed, mut forced, .. } = above[env.0 as usize];
            let mut row = NOTHING_PUSHED;
            if let Some(pushes) = pushes {
                if forces {
                    let above = sets.get(forced as usize).cloned().unwrap_or_default();
                    let behind = pushes.forced(above);
                    if behind.is_empty() {
                        forced = NOTHING_FORCED;
                    } else {
                        forced = sets.len() as u32;
                        sets.push(behind);
                    }
                }
                row = all_pushes.len() as u32;
                all_pushes.push(pushes);
                pushed = EnvId(new);
            }
            above.push(Above {
                env,
                site,
                link: number,
                n_emitted: if is_emitted { n_emitted + 1 } else { 0 },
                pushed,
                pushes: row,
                forced,
                known: NOTHING_KNOWN,
                child_key,
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
    fn forced_digest(&mut self, env: EnvId, all: SlotKey) -> Digest {
        let mut forced = ForcedSlots::from(self.forced(env));
        forced.retain(|slot| forced_against(*slot) == all);
        if forced.is_empty() {
            return Digest::from_bits(0);
        }
        let mut digester = Digester::new();
        for slot in forced {
            digester.add(slot.name()).add(&self.digest(env, slot));
        }
        digester.finish()
    }

    /// The digest of a slot's value.
    pub(crate) fn digest(&mut self, env: EnvId, slot: SlotKey) -> Digest {
        if [SlotKey::of::<Forced>(), SlotKey::of::<ForcedDescending>()].contains(&slot) {
            return self.forced_digest(env, slot);
        }
        match self.known(self.pushed(env, slot), slot) {
            Some(value) => value.digest,
            None => self.value(env, slot).digest,
        }
    }

    /// The value of a slot.
    pub(crate) fn value(&mut self, env: EnvId, slot: SlotKey) -> SlotValue {
        if let Some(known) = self.known(self.pushed(env, slot), slot) {
            return known.clone();
        }
        // Places between here and the nearest known value, with what is merged in at each.
        let mut passed: SmallVec<[(EnvId, SmallVec<[SlotValue; 2]>); 4]> = SmallVec::new();
        let mut at = self.pushed(env, slot);
        let mut value = loop {
            if let Some(known) = self.known(at, slot) {
                break known.clone();
            }
            let Some(above) = self.above(at) else {
                let value = self.root_values.value(slot).unwrap_or_else(|| slot.default());
                self.note(EnvId(ROOT), slot, value.clone());
                break value;
            };
            let is_forced = self.is_forced(above.env, slot);
            let pushes = self.pushes.get(above.pushes as usize);
            match pushes.map_or(Pushed::Nothing, |pushes| pushes.of(slot, is_forced)) {
                Pushed::Nothing => passed.push((at, SmallVec::new())),
                Pushed::Merged(values) => passed.push((at, values)),
                Pushed::Replaced(new) => {
                    // Whatever is inherited here does not matter.
                    passed.push((at, SmallVec::new()));
                    break new;
                }
            }
            at = self.pushed(above.env, slot);
        };
        // Remembered at every place, so that no stretch of the way up is climbed twice.
        for (place, merged) in passed.into_iter().rev() {
            value = merged.iter().fold(value, |value, new| slot.merge(&value, new));
            if slot.descends()
                && let Some(above) = self.above(place)
            {
                value = slot.descend(value, above.child_key);
            }
            self.note(place, slot, value.clone());
        }
        value
    }
}
