//! Ingredients as a rule asks for them: found if they are there, else noted as needed.

use std::any::Any;
use std::sync::Arc;

use sapwood_geom::Digest;
use sapwood_graph::Kind;

use super::{Context, Stock};
use crate::Component;
use crate::rules::{
    CompiledPlan, Found, Ingredient, MOST_ABOVE_EACH_OTHER, MOST_INGREDIENTS, Need, Read, ReadKey,
    RuleError, too_high, too_many,
};
use crate::slots::SlotKey;

impl<'a> Context<'a> {
    /// What another component compiles to here: the [data](crate::Rule::Data), of type `D`, that
    /// the rule serving its kind in this view makes of it where this rule's own component stands.
    /// That may be an image, a profile, a table; render nodes and children of its own are left
    /// aside, and so is what this rule pushes.
    ///
    /// Like any plan it is compiled once however many ask for it, found by what its rule read and
    /// kept. What was read for it counts as read here, which rule serves the kind included. To
    /// compile what is not there yet, `init` is begun again from its start: ask before other work
    /// is done, and pass errors on.
    ///
    /// # Errors
    /// When no rule serves the kind, when its rule failed or makes data of another type.
    /// Ingredients may have ingredients, up to 16 above each other, and a component up to 256 of
    /// its own; beyond, it fails whatever its rule makes of the error.
    pub fn ingredient<D: Any>(&mut self, component: impl Component) -> Result<&'a D, RuleError> {
        let plan = self.ingredient_plan(component)?;
        let failed = |why: String| RuleError::Failed(format!("ingredient {}: {why}", plan.kind()));
        let data = plan.data.map_err(|error| failed(error.message.clone()))?;
        data.downcast_ref().ok_or_else(|| {
            let (name, made) = (plan.rule.identity().name, plan.rule.data_type());
            let asked = std::any::type_name::<D>();
            failed(format!("rule {name} makes data of type {made}, not {asked}"))
        })
    }

    fn ingredient_plan<C: Component>(
        &mut self,
        component: C,
    ) -> Result<CompiledPlan<'a>, RuleError> {
        let kind = Kind::of::<C>();
        if self.need.is_some() || self.refused.is_some() {
            return Err(RuleError::Failed(format!("ingredient {kind}: not had")));
        }
        let served = SlotKey::serving::<C>();
        let value = self.slots.value(served);
        self.record(Read { key: ReadKey::Slot(served), value: value.digest, memory: None });
        let content = Digest::of(&component);
        let is_it = |known: &&Ingredient| known.kind == kind && known.content == content;
        let is_new = !self.draft.ingredients.list.iter().any(|known| is_it(&known));
        if is_new && self.draft.ingredients.list.len() == MOST_INGREDIENTS {
            return Err(self.refuse(too_many()));
        }
        let Stock { plans, known } = self.stock;
        let found = match known.iter().find(is_it) {
            Some(known) => Found::Plan(plans.plan(known.plan)),
            None => plans.find(kind, content, &mut self.slots.fork(), self.memories),
        };
        let plan = match found {
            Found::NoRule => {
                let why = format!("ingredient {kind}: the view has no rule for its kind");
                return Err(RuleError::Failed(why));
            }
            Found::Missing => {
                self.need = Some(Need { kind, content, component: Arc::new(component) });
                return Err(RuleError::Failed(format!("ingredient {kind}: not compiled yet")));
            }
            Found::Plan(plan) => plan,
        };
        self.slots.note(plan.slots);
        #[cfg(feature = "planted-faults")]
        let reads = if self.limits.drops_ingredients { &[] } else { plan.reads };
        #[cfg(not(feature = "planted-faults"))]
        let reads = plan.reads;
        for read in reads {
            self.record(read.clone());
        }
        let ingredients = &mut self.draft.ingredients;
        if is_new {
            ingredients.list.push(Ingredient { kind, content, plan: plan.number });
        }
        ingredients.height = ingredients.height.max(1 + plan.height);
        if ingredients.height > MOST_ABOVE_EACH_OTHER {
            ingredients.height = MOST_ABOVE_EACH_OTHER + 1;
            return Err(self.refuse(too_high(kind)));
        }
        Ok(plan)
    }

    fn refuse(&mut self, why: String) -> RuleError {
        self.refused = Some(why.clone());
        RuleError::Failed(why)
    }
}
