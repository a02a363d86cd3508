//! Field connections: an output of one component drives an input of another.
//!
//! A driven component keeps the fields that its user set; what its inputs make of them is
//! computed when somebody looks at it, and kept until a component that drives it is edited.
//! Connections run beside the edges of the graph: a component may drive its own children or
//! its parent, but not itself, by whatever detour.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

use sapwood_geom::{FixedMap, fixed_state};
use smallvec::SmallVec;

use super::{Graph, NodeId};
use crate::panic::words_of;
use crate::{Component, EditError};

type AnyRef = dyn Any + Send + Sync;
type Drive = Box<dyn Fn(&AnyRef, &mut AnyRef) + Send + Sync>;

/// One input and what drives it.
struct Connection {
    source: NodeId,
    input: &'static str,
    drive: Drive,
    /// Its place among all that the source drives.
    place: usize,
}

/// A component with driven inputs.
struct Driven {
    connections: SmallVec<[Connection; 1]>,
    copy: fn(&AnyRef) -> Box<AnyRef>,
    /// The component as its inputs make it, or why they cannot; empty while nobody has looked
    /// since something that drives it was edited.
    effective: OnceLock<Result<Box<AnyRef>, String>>,
}

/// All connections of a scene.
pub(crate) struct Fields {
    driven: FixedMap<NodeId, Driven>,
    /// The components that each component drives, each once for every input.
    drives: FixedMap<NodeId, SmallVec<[(NodeId, &'static str); 2]>>,
}

impl Fields {
    pub(crate) fn new() -> Self {
        Self {
            driven: FixedMap::with_hasher(fixed_state()),
            drives: FixedMap::with_hasher(fixed_state()),
        }
    }

    fn driven_by(&self, source: NodeId) -> impl Iterator<Item = NodeId> + '_ {
        self.drives.get(&source).into_iter().flatten().map(|(target, _)| *target)
    }

    /// What drives a component, and through which inputs.
    pub(crate) fn inputs(&self, target: NodeId) -> impl Iterator<Item = (NodeId, &'static str)> {
        let connections = self.driven.get(&target).map(|driven| driven.connections.iter());
        connections.into_iter().flatten().map(|each| (each.source, each.input))
    }

    /// The nodes from `first` to `last` along connections, if there is a way.
    fn path(&self, first: NodeId, last: NodeId) -> Option<Vec<NodeId>> {
        if first != last && !self.driven.contains_key(&last) {
            return None;
        }
        let mut came_from: FixedMap<NodeId, NodeId> = FixedMap::with_hasher(fixed_state());
        let mut stack = vec![first];
        while let Some(node) = stack.pop() {
            if node == last {
                let back = std::iter::successors(Some(node), |node| came_from.get(node).copied());
                let mut path: Vec<NodeId> = back.collect();
                path.reverse();
                return Some(path);
            }
            for target in self.driven_by(node) {
                if target != first && !came_from.contains_key(&target) {
                    came_from.insert(target, node);
                    stack.push(target);
                }
            }
        }
        None
    }

    /// Takes away what drives an input, and tells whether anything did.
    fn disconnect(&mut self, target: NodeId, is_gone: impl Fn(&NodeId, &str) -> bool) -> bool {
        let mut was_driven = false;
        while let Some(driven) = self.driven.get_mut(&target) {
            let mut connections = driven.connections.iter();
            let Some(number) = connections.position(|each| is_gone(&each.source, each.input))
            else {
                break;
            };
            let Connection { source, place, .. } = driven.connections.remove(number);
            driven.effective.take();
            if driven.connections.is_empty() {
                self.driven.remove(&target);
            }
            self.forget_driven(source, place);
            was_driven = true;
        }
        was_driven
    }

    /// Takes one place out of what a component drives; the last one moves there.
    fn forget_driven(&mut self, source: NodeId, place: usize) {
        let Some(targets) = self.drives.get_mut(&source) else { return };
        targets.swap_remove(place);
        if targets.is_empty() {
            self.drives.remove(&source);
        } else if let Some((moved, input)) = targets.get(place)
            && let Some(driven) = self.driven.get_mut(moved)
            && let Some(moved) = driven.connections.iter_mut().find(|each| each.input == *input)
        {
            moved.place = place;
        }
    }
}

impl Graph {
    /// Lets `source` drive an input of `target`; what drove that input before does so no
    /// longer.
    pub(crate) fn connect<A: Component, B: Component + Clone>(
        &mut self,
        source: NodeId,
        target: NodeId,
        input: &'static str,
        drive: impl Fn(&A, &mut B) + Send + Sync + 'static,
    ) -> Result<(), EditError> {
        if !self.component(source)?.is::<A>() {
            return Err(EditError::Gone { node: source });
        }
        if !self.component(target)?.is::<B>() {
            return Err(EditError::Gone { node: target });
        }
        if let Some(path) = self.fields.path(target, source) {
            return Err(self.cycle(path));
        }
        // Who takes over an input takes over its turn.
        let turn = self.fields.inputs(target).position(|(_, other)| other == input);
        self.fields.disconnect(target, |_, other| other == input);
        let driven = self.fields.driven.entry(target).or_insert_with(|| Driven {
            connections: SmallVec::new(),
            copy: |component| {
                let component = component.downcast_ref::<B>();
                Box::new(component.expect("a driven component keeps its type").clone())
            },
            effective: OnceLock::new(),
        });
        driven.effective.take();
        let drive: Drive = Box::new(move |source, target| {
            if let (Some(source), Some(target)) = (source.downcast_ref(), target.downcast_mut()) {
                drive(source, target);
            }
        });
        let targets = self.fields.drives.entry(source).or_default();
        let turn = turn.unwrap_or(driven.connections.len());
        driven.connections.insert(turn, Connection { source, input, drive, place: targets.len() });
        targets.push((target, input));
        self.touch(target);
        Ok(())
    }

    /// Leaves an input to its user again, and tells whether anything drove it.
    pub(crate) fn disconnect(&mut self, target: NodeId, input: &str) -> Result<bool, EditError> {
        self.node(target)?;
        let was_driven = self.fields.disconnect(target, |_, other| other == input);
        if was_driven {
            self.touch(target);
        }
        Ok(was_driven)
    }

    /// Forgets all connections of a node that is about to be removed.
    pub(super) fn disconnect_all(&mut self, node: NodeId) {
        self.fields.disconnect(node, |_, _| true);
        let targets: Vec<NodeId> = self.fields.driven_by(node).collect();
        for target in targets {
            if self.fields.disconnect(target, |source, _| *source == node) {
                self.touch(target);
            }
        }
    }

    /// Notes that a node that was edited, and everything driven by it, by whatever detour, must
    /// be computed again. Returns what of the latter was not noted before.
    pub(super) fn outdate_driven(&mut self, node: NodeId) -> SmallVec<[NodeId; 4]> {
        let mut outdated: SmallVec<[NodeId; 4]> = SmallVec::new();
        if self.fields.drives.is_empty() {
            return outdated;
        }
        if let Some(driven) = self.fields.driven.get_mut(&node) {
            driven.effective.take();
        }
        #[cfg(feature = "planted-faults")]
        if self.keeps_driven {
            return outdated;
        }
        let mut stack: SmallVec<[NodeId; 8]> = self.fields.driven_by(node).collect();
        while let Some(target) = stack.pop() {
            let was_known = self.fields.driven.get_mut(&target).map(|row| row.effective.take());
            let Some(row) = self.nodes.get_mut(target) else { continue };
            if was_known.flatten().is_none() && row.edited > self.pulled_at {
                // Outdated before, and nobody has looked since.
                continue;
            }
            row.edited = self.revision;
            outdated.push(target);
            stack.extend(self.fields.driven_by(target));
        }
        outdated
    }

    /// A component as its inputs make it.
    pub(crate) fn effective(&self, id: NodeId) -> Result<&AnyRef, String> {
        let own = |id| self.component(id).map_err(|error| error.to_string());
        if self.fields.driven.is_empty() {
            return own(id);
        }
        // Whatever drives it comes first; those that drive nobody yet known are on top.
        let mut stack = vec![id];
        while let Some(&at) = stack.last() {
            let Some(driven) = self.fields.driven.get(&at) else {
                stack.pop();
                continue;
            };
            let is_open = |source: &NodeId| {
                self.fields.driven.get(source).is_some_and(|row| row.effective.get().is_none())
            };
            let sources = driven.connections.iter().map(|connection| connection.source);
            if driven.effective.get().is_none()
                && let Some(source) = sources.into_iter().find(is_open)
            {
                stack.push(source);
                continue;
            }
            driven.effective.get_or_init(|| self.driven_component(at, driven));
            stack.pop();
        }
        match self.fields.driven.get(&id).and_then(|driven| driven.effective.get()) {
            None => own(id),
            Some(Ok(component)) => Ok(&**component),
            Some(Err(message)) => Err(message.clone()),
        }
    }

    /// Computes a driven component from those that drive it, which are computed already.
    fn driven_component(&self, id: NodeId, driven: &Driven) -> Result<Box<AnyRef>, String> {
        let own = self.component(id).map_err(|error| error.to_string())?;
        let caught = |input: &str, panic: Box<dyn Any + Send>| {
            format!("what drives input {input} panicked: {}", words_of(&*panic))
        };
        let copy = catch_unwind(AssertUnwindSafe(|| (driven.copy)(own)));
        let mut component =
            copy.map_err(|panic| format!("its copying panicked: {}", words_of(&*panic)))?;
        for Connection { source, input, drive, .. } in &driven.connections {
            let known = self.fields.driven.get(source).and_then(|row| row.effective.get());
            let source = match known {
                None => self.component(*source).map_err(|error| error.to_string())?,
                Some(Ok(source)) => &**source,
                Some(Err(message)) => return Err(message.clone()),
            };
            catch_unwind(AssertUnwindSafe(|| drive(source, &mut *component)))
                .map_err(|panic| caught(input, panic))?;
        }
        Ok(component)
    }
}
