//! Interfaces: what a rule lets traversals see of its data without knowing them.
//!
//! A rule offers its data as, say, `dyn Weighs`; a traversal of another crate has one handler
//! for everything that weighs. Neither knows the other: both know the trait.

use std::any::{Any, TypeId};
use std::marker::PhantomData;

/// The interfaces of one rule's data, in the order in which the rule offers them.
pub struct Interfaces {
    rule: TypeId,
    data: TypeId,
    casts: Casts,
}

/// By the type of the interface, each a [`Cast`] whose type is forgotten.
type Casts = Vec<(TypeId, Box<dyn Any + Send + Sync>)>;

/// How data of a type that is forgotten is seen as an `I`.
type Cast<I> = Box<dyn for<'a> Fn(&'a (dyn Any + Send + Sync)) -> Option<&'a I> + Send + Sync>;

/// The interfaces that a rule offers of its data `D`.
pub struct Offers<D>(Casts, PhantomData<fn(&D)>);

impl<D: Any> Offers<D> {
    /// Offers the data as an `I`, such as `dyn Weighs`.
    ///
    /// # Panics
    /// When it is offered as an `I` already.
    pub fn offer<I: ?Sized + 'static>(&mut self, seen_as: fn(&D) -> &I) {
        let id = TypeId::of::<I>();
        let is_new = self.0.iter().all(|(earlier, _)| *earlier != id);
        assert!(is_new, "{} is offered twice", std::any::type_name::<I>());
        let cast: Cast<I> = Box::new(move |data| data.downcast_ref().map(seen_as));
        self.0.push((id, Box::new(cast)));
    }
}

impl Interfaces {
    /// What a rule of type `R` with data `D` offers.
    pub fn of<R: 'static, D: Any>(offer: impl FnOnce(&mut Offers<D>)) -> Self {
        let mut offers = Offers(Vec::new(), PhantomData);
        offer(&mut offers);
        Self { rule: TypeId::of::<R>(), data: TypeId::of::<D>(), casts: offers.0 }
    }

    /// The data of a plan, seen as an `I`: nothing where the rule does not offer that, or where
    /// the plan is an error and has no data.
    pub fn see<'a, I: ?Sized + 'static>(&self, data: &'a (dyn Any + Send + Sync)) -> Option<&'a I> {
        let id = TypeId::of::<I>();
        let (_, cast) = self.casts.iter().find(|(offered, _)| *offered == id)?;
        cast.downcast_ref::<Cast<I>>()?(data)
    }

    /// What tells rules apart.
    pub(crate) fn rule(&self) -> TypeId {
        self.rule
    }

    /// The type of the rule's data.
    pub(crate) fn data(&self) -> TypeId {
        self.data
    }

    /// What is offered, in order.
    pub(crate) fn offered(&self) -> impl Iterator<Item = TypeId> + '_ {
        self.casts.iter().map(|(id, _)| *id)
    }
}
