//! What a slot is, and slot values whose type is forgotten.

use std::any::{Any, TypeId};
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use sapwood_geom::{Content, Digest};
use sapwood_graph::Kind;

use crate::Component;

/// How often a slot's value changes: [`Held`] or [`Moving`].
pub trait Rate: sealed::Sealed + 'static {}

/// The rate of slots that change when somebody edits: placement, style, parameters.
#[derive(Debug)]
pub enum Held {}

/// The rate of slots that change every frame: time, camera. Rules read them in `visit` alone.
#[derive(Debug)]
pub enum Moving {}

impl Rate for Held {}
impl Rate for Moving {}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Held {}
    impl Sealed for super::Moving {}
}

/// A typed value that is inherited from above.
///
/// A held slot is pushed by attributes and rules for everything below them. What is pushed
/// replaces what was inherited, unless the slot merges. The functions of a slot, and the content
/// of its values, must not panic: they run outside of any rule.
pub trait Slot: 'static {
    /// The type of the values.
    type Value: Content + Send + Sync + 'static;
    /// [`Held`] or [`Moving`].
    type Rate: Rate;
    /// The slot's name in dumps and diagnostics; unique among the slots of one program.
    const NAME: &'static str;
    /// Whether a pushed value is merged with the inherited one.
    const MERGES: bool = false;
    /// Whether the value changes from a parent to each of its children.
    const DESCENDS: bool = false;

    /// Whether two values that a value sub-graph offers are combined; else the later one counts.
    /// Slots that merge are merged unless they combine.
    const COMBINES: bool = false;

    /// The value where nothing was pushed.
    fn default() -> Self::Value;

    /// What a push below `inherited` results in; asked only of slots that merge.
    fn merge(inherited: &Self::Value, pushed: &Self::Value) -> Self::Value {
        let _ = (inherited, pushed);
        Self::default()
    }

    /// What an earlier and a later offer of a value sub-graph come to; asked only of slots that
    /// combine.
    fn combine(earlier: &Self::Value, later: &Self::Value) -> Self::Value {
        let _ = (earlier, later);
        Self::default()
    }

    /// The value for the child with this key; asked only of slots that descend.
    fn descend(value: &Self::Value, key: u64) -> Self::Value {
        let _ = (value, key);
        Self::default()
    }
}

/// A slot value with its digest, its type forgotten.
#[derive(Clone)]
pub(crate) struct SlotValue {
    pub(crate) digest: Digest,
    value: Arc<dyn Any + Send + Sync>,
}

impl SlotValue {
    pub(crate) fn new<S: Slot>(value: S::Value) -> Self {
        Self { digest: Digest::of(&value), value: Arc::new(value) }
    }

    /// Takes another value of the same slot; allocates nothing where nobody else holds the one
    /// before.
    pub(crate) fn set<S: Slot>(&mut self, value: S::Value) {
        match Arc::get_mut(&mut self.value).and_then(|held| held.downcast_mut::<S::Value>()) {
            Some(held) => {
                self.digest = Digest::of(&value);
                *held = value;
            }
            None => *self = Self::new::<S>(value),
        }
    }

    /// A digest that stands for the value, which nobody asks for.
    pub(crate) fn standing_for(digest: Digest) -> Self {
        Self { digest, value: Arc::new(()) }
    }

    /// The value behind it, which a key of slot `S` must have led to.
    pub(crate) fn typed<S: Slot>(&self) -> Arc<S::Value> {
        let value = Arc::clone(&self.value);
        value.downcast().expect("a slot's key leads to values of its type")
    }

    fn as_ref<S: Slot>(&self) -> &S::Value {
        self.value.downcast_ref().expect("a slot's key leads to values of its type")
    }
}

/// A slot, its type forgotten.
#[derive(Clone, Copy)]
pub(crate) struct SlotKey {
    /// A hash of the name, which tells nearly all slots apart without a look at their tables;
    /// they are sorted by it, for names take longer to compare.
    rank: u64,
    table: &'static SlotTable,
}

struct SlotTable {
    id: TypeId,
    name: &'static str,
    default: fn() -> SlotValue,
    merge: Option<fn(&SlotValue, &SlotValue) -> SlotValue>,
    combine: Option<fn(&SlotValue, &SlotValue) -> SlotValue>,
    descend: Option<fn(&SlotValue, u64) -> SlotValue>,
    /// The kind whose rule is meant, where the slot stands for one.
    served: Option<fn() -> Kind>,
}

struct TableOf<S>(S);

impl<S: Slot> TableOf<S> {
    const TABLE: SlotTable = SlotTable {
        id: TypeId::of::<S>(),
        name: S::NAME,
        default: || SlotValue::new::<S>(S::default()),
        merge: if S::MERGES {
            Some(|inherited, pushed| {
                SlotValue::new::<S>(S::merge(inherited.as_ref::<S>(), pushed.as_ref::<S>()))
            })
        } else {
            None
        },
        combine: if S::COMBINES {
            Some(|earlier, later| {
                SlotValue::new::<S>(S::combine(earlier.as_ref::<S>(), later.as_ref::<S>()))
            })
        } else {
            None
        },
        descend: if S::DESCENDS {
            Some(|value, key| SlotValue::new::<S>(S::descend(value.as_ref::<S>(), key)))
        } else {
            None
        },
        served: None,
    };
}

struct ServingTableOf<C>(C);

impl<C: Component> ServingTableOf<C> {
    const TABLE: SlotTable = SlotTable {
        id: TypeId::of::<Self>(),
        name: C::NAME,
        default: || SlotValue::standing_for(Digest::from_bits(0)),
        merge: None,
        combine: None,
        descend: None,
        served: Some(Kind::of::<C>),
    };
}

impl SlotKey {
    pub(crate) fn of<S: Slot>() -> Self {
        Self { rank: const { rank(S::NAME) }, table: &TableOf::<S>::TABLE }
    }

    /// What stands for the rule that serves components of type `C` in the view: it is read like
    /// a slot by whoever is made of what that rule makes. Nobody pushes it.
    pub(crate) fn serving<C: Component>() -> Self {
        // Not the rank of a slot that is called as the kind is.
        Self { rank: const { !rank(C::NAME) }, table: &ServingTableOf::<C>::TABLE }
    }

    /// The kind whose rule is meant, where the slot stands for one.
    pub(crate) fn served(self) -> Option<Kind> {
        self.table.served.map(|kind| kind())
    }

    pub(crate) fn name(self) -> &'static str {
        self.table.name
    }

    pub(crate) fn type_id(self) -> TypeId {
        self.table.id
    }

    pub(crate) fn default(self) -> SlotValue {
        (self.table.default)()
    }

    pub(crate) fn merges(self) -> bool {
        self.table.merge.is_some()
    }

    pub(crate) fn descends(self) -> bool {
        self.table.descend.is_some()
    }

    /// The value below a push.
    pub(crate) fn merge(self, inherited: &SlotValue, pushed: &SlotValue) -> SlotValue {
        self.table.merge.map_or_else(|| pushed.clone(), |merge| merge(inherited, pushed))
    }

    /// What two offers of a value sub-graph come to.
    pub(crate) fn combine(self, earlier: &SlotValue, later: &SlotValue) -> SlotValue {
        let combine = self.table.combine.or(self.table.merge);
        combine.map_or_else(|| later.clone(), |combine| combine(earlier, later))
    }

    /// The value for the child with this key.
    pub(crate) fn descend(self, value: SlotValue, key: u64) -> SlotValue {
        self.table.descend.map_or_else(|| value.clone(), |descend| descend(&value, key))
    }
}

impl PartialEq for SlotKey {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.rank == other.rank
            && (std::ptr::eq(self.table, other.table) || self.table.id == other.table.id)
    }
}

impl Eq for SlotKey {}

impl Hash for SlotKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.rank.hash(state);
    }
}

/// By name, in an order that is the same in every build, as that of type ids is not.
impl Ord for SlotKey {
    #[inline]
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_rank = self.rank.cmp(&other.rank);
        by_rank.then_with(|| {
            if std::ptr::eq(self.table, other.table) {
                return std::cmp::Ordering::Equal;
            }
            let by_name = self.name().cmp(other.name());
            by_name.then_with(|| self.table.id.cmp(&other.table.id))
        })
    }
}

/// The FNV-1a hash of a name.
const fn rank(name: &str) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325;
    let mut i = 0;
    while i < name.len() {
        hash = (hash ^ name.as_bytes()[i] as u64).wrapping_mul(0x100_0000_01b3);
        i += 1;
    }
    hash
}

impl PartialOrd for SlotKey {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Debug for SlotKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
