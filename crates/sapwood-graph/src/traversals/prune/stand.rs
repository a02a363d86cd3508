//! Where the walk of a pruning goes: into what is not wholly outside of the envelope.

use std::cell::Cell;
use std::rc::Rc;

use sapwood_geom::{Bound, Envelope, Side};

use crate::{Approach, Interest};

/// How what a walk is in stands towards the envelope.
#[derive(Clone, Debug)]
pub struct Standing(Rc<State>);

#[derive(Debug)]
struct State {
    side: Cell<Side>,
    is_done: Cell<bool>,
}

impl Standing {
    fn new(side: Side) -> Self {
        Self(Rc::new(State { side: Cell::new(side), is_done: Cell::new(false) }))
    }

    /// How everything below the plan stands towards the envelope.
    pub fn side(&self) -> Side {
        self.0.side.get()
    }

    /// Becomes what a closer look tells.
    pub(super) fn set_side(&self, side: Side) {
        self.0.side.set(side);
    }

    /// Nothing of the plan or below it is looked at any more.
    pub(super) fn set_done(&self) {
        self.0.is_done.set(true);
    }

    pub(super) fn is_done(&self) -> bool {
        self.0.is_done.get()
    }
}

/// The interest in everything that is not wholly outside of an envelope in the root's frame.
pub(super) struct Within(pub(super) Envelope);

impl Interest for Within {
    type State = Standing;

    fn start(&self) -> Standing {
        Standing::new(Side::Crossing)
    }

    fn enter(&self, above: &Standing, child: &Approach<'_>) -> Option<Standing> {
        if above.is_done() {
            return None;
        }
        // What has no extent may still be a light.
        let known = child.bound.filter(|bound| !bound.is_empty());
        let side = match (above.side(), known) {
            (Side::Inside, _) => Side::Inside,
            (_, None) => Side::Crossing,
            (_, Some(bound)) => side_of(&self.0, bound, child),
        };
        (side != Side::Outside).then(|| Standing::new(side))
    }
}

fn side_of(envelope: &Envelope, bound: &Bound, child: &Approach<'_>) -> Side {
    envelope.side_of_bound(&bound.transformed(child.world))
}
