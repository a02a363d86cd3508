//! Parts: rows of typed arrays in a plan that answer to a kind of their own.
//!
//! A part has no plan and no reads. Counting adds the arrays' lengths, and whoever knows the
//! type gets the whole slice.

use std::any::Any;

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

trait AnyRows: Send + Sync {
    fn as_any(&self) -> &dyn Any;
    fn as_any_mut(&mut self) -> &mut dyn Any;
    fn write(&self, digester: &mut Digester);
}

impl<P: Part> AnyRows for Vec<P> {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn write(&self, digester: &mut Digester) {
        digester.add(self);
    }
}

impl Parts {
    /// Whether there is no array at all.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds `rows` behind the parts of the same kind that are there already.
    pub fn add<P: Part>(&mut self, mut rows: Vec<P>) {
        let kind = Kind::of::<P>();
        let earlier = self.0.iter_mut().find(|array| array.kind == kind);
        match earlier
            .and_then(|array| Some((array.rows.as_any_mut().downcast_mut()?, &mut array.len)))
        {
            Some((earlier, len)) => {
                let earlier: &mut Vec<P> = earlier;
                earlier.append(&mut rows);
                *len = earlier.len();
            }
            None => self.0.push(Array { kind, len: rows.len(), rows: Box::new(rows) }),
        }
    }

    /// All parts of type `P`; empty where the plan has none.
    pub fn of<P: Part>(&self) -> &[P] {
        let kind = Kind::of::<P>();
        let array = self.0.iter().find(|array| array.kind == kind);
        array.and_then(|array| array.rows.as_any().downcast_ref::<Vec<P>>()).map_or(&[], |v| v)
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
