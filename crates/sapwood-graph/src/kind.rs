//! Kinds: what sort of component, or of part, something is.

use std::any::TypeId;
use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

/// A type with a name of its own in dumps, counts and diagnostics.
///
/// Names are `snake_case` and unique among the kinds of one program; rule sets prefix theirs
/// where a plain word would clash.
pub trait Named: 'static {
    /// The name.
    const NAME: &'static str;
}

/// The kind of a component or of a part: a Rust type and its name.
#[derive(Clone, Copy)]
pub struct Kind {
    id: TypeId,
    name: &'static str,
}

impl Kind {
    /// The kind of `T`.
    pub fn of<T: Named>() -> Self {
        Self { id: TypeId::of::<T>(), name: T::NAME }
    }

    /// The kind's name.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// The Rust type behind the kind.
    pub fn type_id(self) -> TypeId {
        self.id
    }
}

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Kind {}

impl Hash for Kind {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.id.hash(state);
    }
}

/// By name: the order of type ids changes from build to build.
impl Ord for Kind {
    fn cmp(&self, other: &Self) -> Ordering {
        self.name.cmp(other.name).then_with(|| self.id.cmp(&other.id))
    }
}

impl PartialOrd for Kind {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Debug for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
