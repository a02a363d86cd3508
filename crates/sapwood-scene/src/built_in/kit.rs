//! Kits: groups with named parts and a few parameters, used like one component.

use std::any::TypeId;
use std::marker::PhantomData;
use std::sync::Arc;

use sapwood_geom::{Content, Digester, FixedSet, fixed_state};
use sapwood_graph::Named;

use crate::{Children, Component, Context, EditError, Handle, NodeId, Rule, RuleError, Scene};

/// A group that a [`KitTemplate`] has made: its parameters drive the fields of its parts.
///
/// Its kind is that of its parameters, so that a rule set may show the whole kit as something
/// else; to show its parts, register a [`KitRule`].
#[derive(Clone, Debug)]
pub struct Kit<P> {
    /// What users of the kit set.
    pub parameters: P,
    parts: Arc<[(&'static str, NodeId)]>,
}

impl<P> Kit<P> {
    /// The names of the parts, in the order in which the template lists them.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.parts.iter().map(|(name, _)| *name)
    }

    /// The node of a part; it may have been removed since.
    pub fn part(&self, name: &str) -> Option<NodeId> {
        self.parts.iter().find(|(known, _)| *known == name).map(|(_, node)| *node)
    }
}

/// Which nodes the parts are is not content: they are the kit's children, or below them.
impl<P: Content> Content for Kit<P> {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.parameters);
    }
}

impl<P: Named> Named for Kit<P> {
    const NAME: &'static str = P::NAME;
}

impl<P: Named + Content + Send + Sync> Component for Kit<P> {
    const CHILDREN: Children = Children::Many;
}

/// Shows the parts of kits with parameters `P`.
pub struct KitRule<P>(PhantomData<fn() -> P>);

impl<P> KitRule<P> {
    /// The rule.
    pub fn new() -> Self {
        Self(PhantomData)
    }
}

impl<P> Default for KitRule<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Named + Content + Send + Sync> Rule for KitRule<P> {
    type Component = Kit<P>;
    type Data = ();
    const NAME: &'static str = "kit";

    fn init(&self, _: &Kit<P>, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.children();
        Ok(())
    }
}

/// How to make kits with parameters `P`: the parts, and which of their fields the parameters
/// drive.
pub struct KitTemplate<P> {
    parts: Vec<TemplatePart>,
    inputs: Vec<Box<Connect<P>>>,
}

struct TemplatePart {
    name: &'static str,
    component: TypeId,
    kind: &'static str,
    /// The number of the part that it is below; the kit itself if there is none.
    under: Option<usize>,
    add: Box<Place>,
}

/// Places a part in a scene, below nothing yet.
type Place = dyn Fn(&mut Scene) -> Result<NodeId, EditError> + Send + Sync;

/// Connects an input of one of the parts, which are given in the order of the template.
type Connect<P> =
    dyn Fn(&mut Scene, Handle<Kit<P>>, &[NodeId]) -> Result<(), EditError> + Send + Sync;

impl<P: Named + Content + Send + Sync> KitTemplate<P> {
    /// A template without parts.
    pub fn new() -> Self {
        Self { parts: Vec::new(), inputs: Vec::new() }
    }

    /// The template with one more part right below the kit.
    ///
    /// # Panics
    /// When there is a part of this name.
    #[track_caller]
    pub fn part<C: Component + Clone>(self, name: &'static str, component: C) -> Self {
        self.with_part::<C>(name, None, placing(component))
    }

    /// The template with a whole kit as one more part right below it; its parameters can be
    /// driven like the fields of any part. A rule set needs a rule for either kit.
    ///
    /// # Panics
    /// When there is a part of this name.
    #[track_caller]
    pub fn kit<Q: Named + Content + Clone + Send + Sync>(
        self,
        name: &'static str,
        template: KitTemplate<Q>,
        parameters: Q,
    ) -> Self {
        let place = move |scene: &mut Scene| Ok(template.fill(scene, parameters.clone())?.id());
        self.with_part::<Kit<Q>>(name, None, Box::new(place))
    }

    /// The template with one more part below another part.
    ///
    /// # Panics
    /// When there is a part of this name, or none of the other name.
    #[track_caller]
    pub fn part_under<C: Component + Clone>(
        self,
        parent: &str,
        name: &'static str,
        component: C,
    ) -> Self {
        let parent = self.number(parent);
        self.with_part::<C>(name, Some(parent), placing(component))
    }

    #[track_caller]
    fn with_part<C: Component>(
        mut self,
        name: &'static str,
        under: Option<usize>,
        add: Box<Place>,
    ) -> Self {
        let is_taken = self.parts.iter().any(|part| part.name == name);
        assert!(!is_taken, "kit {} has a part {name} already", P::NAME);
        let (component, kind) = (TypeId::of::<C>(), C::NAME);
        self.parts.push(TemplatePart { name, component, kind, under, add });
        self
    }

    /// The template with one more input of a part driven by the parameters.
    ///
    /// # Panics
    /// When there is no part of this name, or it is another component.
    #[track_caller]
    pub fn expose<C: Component + Clone>(
        mut self,
        part: &str,
        input: &'static str,
        drive: impl Fn(&P, &mut C) + Send + Sync + 'static,
    ) -> Self {
        let part = self.number_of::<C>(part);
        let drive = Arc::new(drive);
        self.inputs.push(Box::new(move |scene, kit, nodes| {
            let drive = Arc::clone(&drive);
            let part = Handle::<C>::new(nodes[part]);
            scene.connect(kit, part, input, move |kit: &Kit<P>, part| drive(&kit.parameters, part))
        }));
        self
    }

    /// The template with one more input of a part driven by another part.
    ///
    /// # Panics
    /// When there is no part of either name, or it is another component.
    #[track_caller]
    pub fn wire<A: Component, B: Component + Clone>(
        mut self,
        source: &str,
        target: &str,
        input: &'static str,
        drive: impl Fn(&A, &mut B) + Send + Sync + 'static,
    ) -> Self {
        let (source, target) = (self.number_of::<A>(source), self.number_of::<B>(target));
        let drive = Arc::new(drive);
        self.inputs.push(Box::new(move |scene, _, nodes| {
            let drive = Arc::clone(&drive);
            let (source, target) = (Handle::new(nodes[source]), Handle::new(nodes[target]));
            scene.connect(source, target, input, move |source: &A, target: &mut B| {
                drive(source, target);
            })
        }));
        self
    }

    /// The number of a part that must be a `C`.
    #[track_caller]
    fn number_of<C: Component>(&self, name: &str) -> usize {
        let number = self.number(name);
        let TemplatePart { name, component, kind, .. } = self.parts[number];
        let is_right = component == TypeId::of::<C>();
        assert!(is_right, "part {name} of kit {} is a {kind}, no {}", P::NAME, C::NAME);
        number
    }

    #[track_caller]
    fn number(&self, name: &str) -> usize {
        let number = self.parts.iter().position(|part| part.name == name);
        number.unwrap_or_else(|| panic!("kit {} has no part {name}", P::NAME))
    }

    fn fill(&self, scene: &mut Scene, parameters: P) -> Result<Handle<Kit<P>>, EditError> {
        let mut nodes = Vec::with_capacity(self.parts.len());
        let outcome = self.join(scene, parameters, &mut nodes);
        if outcome.is_err() {
            // Those that were joined go with what they were joined to.
            for node in nodes {
                let _ = scene.remove(node);
            }
        }
        outcome
    }

    /// Places everything and joins it; tells in `nodes` what was placed, whatever comes of it.
    fn join(
        &self,
        scene: &mut Scene,
        parameters: P,
        nodes: &mut Vec<NodeId>,
    ) -> Result<Handle<Kit<P>>, EditError> {
        for part in &self.parts {
            nodes.push((part.add)(scene)?);
        }
        let names = self.parts.iter().map(|part| part.name);
        let parts = names.zip(nodes.iter().copied()).collect();
        let kit = scene.add(Kit { parameters, parts });
        nodes.push(kit.id());
        for (part, node) in self.parts.iter().zip(&*nodes) {
            let parent = part.under.map_or(kit.id(), |under| nodes[under]);
            scene.append(parent, *node)?;
        }
        self.inputs.iter().try_for_each(|connect| connect(scene, kit, nodes))?;
        Ok(kit)
    }
}

/// How a component becomes a part.
fn placing<C: Component + Clone>(component: C) -> Box<Place> {
    Box::new(move |scene| Ok(scene.add(component.clone()).id()))
}

impl<P: Named + Content + Send + Sync> Default for KitTemplate<P> {
    fn default() -> Self {
        Self::new()
    }
}

/// Kits.
impl Scene {
    /// Places a kit in the scene, below nothing yet.
    ///
    /// # Errors
    /// When a part of the template cannot hold what the template puts below it; nothing is
    /// placed then.
    pub fn add_kit<P: Named + Content + Send + Sync>(
        &mut self,
        template: &KitTemplate<P>,
        parameters: P,
    ) -> Result<Handle<Kit<P>>, EditError> {
        self.bulk(|scene| template.fill(scene, parameters))
    }

    /// A handle on a part of a kit, if there is one of this name that still stands below the kit
    /// and holds a `C`.
    pub fn part<P: Named + Content + Send + Sync, C: Component>(
        &self,
        kit: Handle<Kit<P>>,
        name: &str,
    ) -> Option<Handle<C>> {
        let part = self.get(kit)?.part(name)?;
        let mut seen = FixedSet::with_hasher(fixed_state());
        let mut above: Vec<NodeId> = self.parents(part).collect();
        while let Some(node) = above.pop() {
            if node == kit.id() {
                return self.handle(part);
            }
            if seen.insert(node) {
                above.extend(self.parents(node));
            }
        }
        None
    }
}
