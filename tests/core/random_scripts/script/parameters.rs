//! Edits of parameters: of components, of what attributes push, and of views.

use sapwood::scene::{
    Attribute, ChildPath, Held, MaterialSlot, Placement, PushMode, Scene, Slot, StyleSlot, Time,
    Viewer,
};

use super::Script;
use crate::core::kinds::Size;
use crate::core::random_scripts::kinds::Tag;
use crate::core::random_scripts::mirror::{N_ROOT_SLOTS, RootValue};
use crate::core::random_scripts::what::{Push, Pushes, What, material};

impl Script {
    pub(super) fn change(&mut self) {
        let node = self.some();
        self.change_node(node);
    }

    /// Gives a node other parameters at random.
    pub(super) fn change_node(&mut self, node: usize) {
        let what = self.mirror.nodes[node].what;
        let changed = self.dice.changed(what);
        self.earlier = Some((node, what));
        self.set(node, changed);
    }

    pub(super) fn undo(&mut self) {
        if let Some((node, what)) = self.earlier.take()
            && self.mirror.nodes[node].is_there
        {
            self.set(node, what);
        }
    }

    /// Gives a node other parameters.
    fn set(&mut self, node: usize, what: What) {
        let before = std::mem::replace(&mut self.mirror.nodes[node].what, what);
        if !self.fits(&self.mirror) {
            self.mirror.nodes[node].what = before;
            return;
        }
        self.note(format!("set {node} to {what:?}"));
        what.set(&mut self.scene, self.mirror.id(node));
    }

    /// Sets or clears one slot of an attribute, or changes how strongly it is pushed.
    pub(super) fn push(&mut self) {
        let all = self.mirror.all();
        let is_attribute =
            |node: &usize| matches!(self.mirror.nodes[*node].what, What::Attribute(_));
        let attributes: Vec<usize> = all.into_iter().filter(is_attribute).collect();
        if attributes.is_empty() {
            return;
        }
        let node = self.dice.pick(&attributes);
        let What::Attribute(mut pushes) = self.mirror.nodes[node].what else { return };
        match self.dice.below(7) {
            0 | 1 => {
                let new = self.dice.push(|dice| dice.size());
                self.push_slot::<Size, _>(node, &mut pushes.size, new, |size| size);
            }
            2 => {
                let new = self.dice.push(|dice| dice.tag());
                self.push_slot::<Tag, _>(node, &mut pushes.tag, new, |tag| tag);
            }
            3 => {
                let new = self.dice.push(|dice| dice.path());
                self.push_slot::<ChildPath, _>(node, &mut pushes.path, new, |path| path);
            }
            4 => {
                let new = self.dice.push(|dice| dice.transform());
                self.push_slot::<Placement, _>(node, &mut pushes.place, new, |place| place);
            }
            5 => {
                let new = self.dice.push(|dice| dice.style());
                self.push_slot::<StyleSlot, _>(node, &mut pushes.style, new, |style| style);
            }
            _ => {
                let new = self.dice.push(|dice| dice.look());
                self.push_slot::<MaterialSlot, _>(node, &mut pushes.look, new, material);
            }
        }
        self.note(format!("push of {node}: {pushes:?}"));
        self.mirror.nodes[node].what = What::Attribute(pushes);
    }

    /// Edits what an attribute pushes of one slot, in the way that fits best.
    fn push_slot<S: Slot<Rate = Held>, T: Copy>(
        &mut self,
        node: usize,
        known: &mut Option<Push<T>>,
        new: Push<T>,
        value: impl FnOnce(T) -> S::Value,
    ) {
        let handle = self.scene.handle::<Attribute>(self.mirror.id(node)).unwrap();
        let scene: &mut Scene = &mut self.scene;
        let had = known.is_some();
        match (self.dice.below(10), new.held) {
            (0..3, _) => {
                *known = None;
                assert_eq!(scene.edit(handle, Attribute::clear::<S>).unwrap(), had);
            }
            (3..5, _) => {
                let set = |attribute: &mut Attribute| attribute.set_mode::<S>(new.mode);
                assert_eq!(scene.edit(handle, set).unwrap(), had);
                *known = known.map(|push| Push { mode: new.mode, ..push });
            }
            (_, Some(held)) if new.mode == PushMode::Normal => {
                *known = Some(new);
                scene.push::<S>(handle, value(held)).unwrap();
            }
            (_, Some(held)) => {
                *known = Some(new);
                scene.edit(handle, |it| it.set_as::<S>(new.mode, value(held))).unwrap();
            }
            (_, None) => {
                *known = Some(new);
                scene.edit(handle, |it| it.ask_as::<S>(new.mode)).unwrap();
            }
        }
    }

    /// Sets, forces or clears a slot above the root of a view.
    pub(super) fn root_value(&mut self) {
        let place = self.dice.below(self.views.len());
        let slot = self.dice.below(N_ROOT_SLOTS + 2).min(N_ROOT_SLOTS - 1);
        let (is_forced, is_cleared) = (self.dice.chance(30), self.dice.chance(25));
        let (dice, values) = (&mut self.dice, &mut self.views[place].values);
        macro_rules! set {
            ($slot:ident) => {{
                let value = dice.$slot();
                values.$slot = (!is_cleared).then_some(RootValue { value, is_forced });
            }};
        }
        match slot {
            0 => set!(size),
            1 => set!(tag),
            2 => set!(path),
            3 => set!(style),
            4 => set!(look),
            _ => set!(viewpoint),
        }
        let view = self.views[place];
        view.set_root(&mut self.scene, view.id, slot);
        self.note(format!("root values of view {place}: {:?}", view.values));
    }

    pub(super) fn tick(&mut self) {
        let place = self.dice.below(self.views.len());
        let view = &mut self.views[place];
        view.time += 1.0;
        self.scene.set_moving::<Time>(view.id, view.time).unwrap();
        let time = view.time;
        self.note(format!("time of view {place}: {time}"));
    }

    /// Moves the eye of a view.
    pub(super) fn look_from(&mut self) {
        let place = self.dice.below(self.views.len());
        let view = &mut self.views[place];
        view.eye = self.dice.eye();
        self.scene.set_moving::<Viewer>(view.id, view.eye).unwrap();
        let eye = view.eye;
        self.note(format!("eye of view {place}: {eye:?}"));
    }
}

impl Pushes {
    /// Whether anything is asked of the value sub-graph.
    pub(super) fn asks(&self) -> bool {
        fn is_asked<T>(push: &Option<Push<T>>) -> bool {
            push.as_ref().is_some_and(|push| push.held.is_none())
        }
        let Self { size, tag, path, place, style, look } = self;
        is_asked(size)
            || is_asked(tag)
            || is_asked(path)
            || is_asked(place)
            || is_asked(style)
            || is_asked(look)
    }
}
