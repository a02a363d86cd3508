//! What a rule is.

use std::any::{Any, TypeId};
use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Content, Digest, Digester, FixedMap, fixed_state};
use sapwood_graph::{Interfaces, Interrupted, Kind, Offers};

use super::Context;
use crate::column::{AnyColumn, Column};
use crate::slots::{SlotKey, SlotValue};
use crate::{Component, Moving, Slot};

/// Compiles one kind of component.
///
/// A rule is a pure function of its component and of what it reads through the context: no
/// clock, no global, no file, no random number but from a stream of its own. Its identity is its
/// name, its version and the digest of its settings: two rules that could ever differ in what
/// they make must differ in one of them.
///
/// Sines, powers and the like come from `glam` as `sapwood-geom` re-exports it, or from `libm`:
/// `f32::sin` need not give the same bits on another machine.
pub trait Rule: Send + Sync + 'static {
    /// The kind that the rule compiles.
    type Component: Component;
    /// What the rule makes beside the fragment, for `visit` and for handlers.
    type Data: Any + Content + Send + Sync;
    /// The rule's name in logs and diagnostics.
    const NAME: &'static str;
    /// Raised whenever the rule makes something else of the same input.
    const VERSION: u32 = 1;

    /// Writes whatever tells this value of the rule from another of its type.
    fn settings(&self, digester: &mut Digester) {
        let _ = digester;
    }

    /// Compiles a component: adds render nodes and children through the context and returns
    /// the rule's own data.
    ///
    /// # Errors
    /// A failure stays with this component: it draws nothing, its diagnostic tells why, and it
    /// is tried again when something that it read has changed. An interruption, as the context's
    /// `reserve_` functions return it, ends the whole traversal and is not remembered.
    fn init(
        &self,
        component: &Self::Component,
        cx: &mut Context<'_>,
    ) -> Result<Self::Data, RuleError>;

    /// Brings the live values that `init` asked for up to date; runs when a moving slot has
    /// changed, allocates nothing and depends on nothing but `data` and moving slots.
    fn visit(&self, data: &Self::Data, cx: &VisitContext<'_>, live: &mut [Affine3]) {
        let _ = (data, cx, live);
    }

    /// Offers the rule's data as interfaces, for traversals that know the interface and not the
    /// rule; the one offered first is preferred.
    fn interfaces(offers: &mut Offers<Self::Data>) {
        let _ = offers;
    }
}

/// Why `init` yields no plan.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RuleError {
    /// The component cannot be compiled; remembered like any other result.
    Failed(String),
    /// The caller cancelled or a budget ran out; never remembered.
    Interrupted(Interrupted),
}

impl fmt::Display for RuleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failed(message) => f.write_str(message),
            Self::Interrupted(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for RuleError {}

impl From<Interrupted> for RuleError {
    fn from(why: Interrupted) -> Self {
        Self::Interrupted(why)
    }
}

/// What `visit` may read: the moving slots of its view.
pub struct VisitContext<'a> {
    pub(crate) moving: &'a FixedMap<TypeId, SlotValue>,
    pub(crate) defaults: &'a std::sync::Mutex<FixedMap<TypeId, SlotValue>>,
}

impl VisitContext<'_> {
    /// The value of a moving slot.
    pub fn read<S: Slot<Rate = Moving>>(&self) -> Arc<S::Value> {
        let key = SlotKey::of::<S>();
        if let Some(value) = self.moving.get(&key.type_id()) {
            return value.typed::<S>();
        }
        // The first visit that asks for a default makes it; the others find it.
        let mut defaults = self.defaults.lock().unwrap_or_else(|broken| broken.into_inner());
        defaults.entry(key.type_id()).or_insert_with(|| key.default()).typed::<S>()
    }
}

/// What tells rules apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct RuleIdentity {
    /// Two Rust types are two rules, whatever they call themselves.
    rule: TypeId,
    pub(crate) kind: Kind,
    pub(crate) name: &'static str,
    pub(crate) version: u32,
    pub(crate) settings: Digest,
}

impl RuleIdentity {
    /// What is read where it matters that this rule serves its kind.
    pub(crate) fn digest(&self) -> Digest {
        let mut digester = Digester::new();
        digester.add(self.name).add(&self.version).add(&self.settings);
        digester.add(&fixed_state().hash_one(self.rule));
        digester.finish()
    }
}

/// A rule, its type forgotten.
pub(crate) trait AnyRule: Send + Sync {
    fn identity(&self) -> RuleIdentity;
    fn new_column(&self) -> Box<dyn AnyColumn>;
    fn init(
        &self,
        component: &(dyn Any + Send + Sync),
        cx: &mut Context<'_>,
    ) -> Result<Box<dyn Any + Send + Sync>, RuleError>;
    fn visit(&self, data: &(dyn Any + Send + Sync), cx: &VisitContext<'_>, live: &mut [Affine3]);
    fn write_data(&self, data: &(dyn Any + Send + Sync), digester: &mut Digester);
    /// The name of the type of the data.
    fn data_type(&self) -> &'static str;
    fn interfaces(&self) -> Interfaces;
}

impl<R: Rule> AnyRule for R {
    fn identity(&self) -> RuleIdentity {
        let mut settings = Digester::new();
        self.settings(&mut settings);
        RuleIdentity {
            rule: TypeId::of::<R>(),
            kind: Kind::of::<R::Component>(),
            name: R::NAME,
            version: R::VERSION,
            settings: settings.finish(),
        }
    }

    fn new_column(&self) -> Box<dyn AnyColumn> {
        Box::new(Column::<R::Data>::new())
    }

    fn init(
        &self,
        component: &(dyn Any + Send + Sync),
        cx: &mut Context<'_>,
    ) -> Result<Box<dyn Any + Send + Sync>, RuleError> {
        let component = component.downcast_ref().expect("a kind's rule gets that kind");
        Ok(Box::new(Rule::init(self, component, cx)?))
    }

    fn visit(&self, data: &(dyn Any + Send + Sync), cx: &VisitContext<'_>, live: &mut [Affine3]) {
        // An error plan has no data, and nothing that lives.
        if let Some(data) = data.downcast_ref() {
            Rule::visit(self, data, cx, live);
        }
    }
    fn write_data(&self, data: &(dyn Any + Send + Sync), digester: &mut Digester) {
        if let Some(data) = data.downcast_ref::<R::Data>() {
            data.write(digester);
        }
    }

    fn data_type(&self) -> &'static str {
        std::any::type_name::<R::Data>()
    }

    fn interfaces(&self) -> Interfaces {
        Interfaces::of::<R, R::Data>(R::interfaces)
    }
}
