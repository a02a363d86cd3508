//! Parts: rows of typed arrays in a plan that answer to a kind of their own.
//!
//! A part has no plan and no reads. Counting adds the arrays' lengths, and whoever knows the
//! type gets the whole slice.

use std::any::Any;
use std::sync::LazyLock;

use sapwood_geom::{Content, Digester};

use crate::{Kind, Named};

/// A type that can stand in a plan as parts.
pub trait Part: Named + Content + Send + Sync {}

/// A plan's arrays of parts, one for each kind, in the order in which the rule added them.
#[derive(Default)]
pub struct Parts(Vec<Array>);

struct Array {
    kind: Kind,
    len: usize,
    rows: Box<dyn AnyRows>,
}

/// The rows of one kind, wherever they lie.
pub(crate) struct Rows<P>(Box<dyn AsRef<[P]> + Send + Sync>);

impl<P> Rows<P> {
    pub(crate) fn as_slice(&self) -> &[P] {
        (*self.0).as_ref()
    }
}

/// Rows that are made when they are looked at.
struct Later<P>(LazyLock<Vec<P>, Box<dyn FnOnce() -> Vec<P> + Send + Sync>>);

impl<P> AsRef<[P]> for Later<P> {
    fn as_ref(&self) -> &[P] {
        &self.0
    }
}

trait AnyRows: Send + Sync {
    fn as_any(&self) -> &dyn Any;
    fn write(&self, digester: &mut Digester);
}

impl<P: Part> AnyRows for Rows<P> {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn write(&self, digester: &mut Digester) {
        digester.add(self.as_slice());
    }
}

impl Parts {
    /// Whether there is no part.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many parts there are of all kinds together.
    pub fn len(&self) -> usize {
        self.0.iter().map(|array| array.len).sum()
    }

    /// Adds the plan's parts of type `P`: a vector, or something shared that holds a slice.
    ///
    /// # Panics
    /// When parts of this type were added before.
    pub fn add<P: Part>(&mut self, rows: impl AsRef<[P]> + Send + Sync + 'static) {
        let kind = Kind::of::<P>();
        assert!(!self.has(kind), "{kind} parts were added twice");
        let len = rows.as_ref().len();
        self.0.push(Array { kind, len, rows: Box::new(Rows(Box::new(rows))) });
    }

    /// Adds the plan's parts of type `P`, `len` of them, which are made when somebody asks for them
    /// for the first time.
    ///
    /// # Panics
    /// When parts of this type were added before; later, when other than `len` are made.
    pub fn add_later<P: Part>(
        &mut self,
        len: usize,
        make: impl FnOnce() -> Vec<P> + Send + Sync + 'static,
    ) {
        let kind = Kind::of::<P>();
        assert!(!self.has(kind), "{kind} parts were added twice");
        let make = move || {
            let rows = make();
            assert_eq!(rows.len(), len, "other {kind} parts are made than were announced");
            rows
        };
        let rows = Later(LazyLock::new(Box::new(make)));
        self.0.push(Array { kind, len, rows: Box::new(Rows(Box::new(rows))) });
    }

    fn has(&self, kind: Kind) -> bool {
        self.0.iter().any(|array| array.kind == kind)
    }

    /// All parts of type `P`; empty where the plan has none.
    pub fn of<P: Part>(&self) -> &[P] {
        let kind = Kind::of::<P>();
        let array = self.0.iter().find(|array| array.kind == kind);
        let rows = array.and_then(|array| array.rows.as_any().downcast_ref::<Rows<P>>());
        rows.map_or(&[], Rows::as_slice)
    }

    /// The kinds of parts and how many there are of each.
    pub fn lengths(&self) -> impl Iterator<Item = (Kind, usize)> + '_ {
        self.0.iter().map(|array| (array.kind, array.len))
    }

    /// One array as it is, for handlers that are found by kind.
    pub(crate) fn arrays(&self) -> impl Iterator<Item = (Kind, &dyn Any)> + '_ {
        self.0.iter().map(|array| (array.kind, array.rows.as_any()))
    }
}

impl Content for Parts {
    fn write(&self, digester: &mut Digester) {
        self.0.len().write(digester);
        for array in &self.0 {
            digester.add(array.kind.name());
            array.rows.write(digester);
        }
    }
}
