//! One script: a random graph, random edits of it, and traversals in between.

use sapwood::geom::StreamPath;
use sapwood::scene::{Attribute, ChildPath, NodeId, PlantedFault, Scene, Switch, Transform};

use super::dice::Dice;
use super::kinds::*;
use super::mirror::{Mirror, Refusal, View, What, attribute, room};
use crate::core::kinds::{Plain, Size};

/// Occurrences that a view may show at most.
const MOST_OCCURRENCES: u64 = 3000;

pub(super) struct Script {
    pub(super) scene: Scene,
    pub(super) mirror: Mirror,
    pub(super) views: Vec<View>,
    pub(super) dice: Dice,
    /// What was done, for whoever has to find out what went wrong.
    pub(super) log: Vec<String>,
    /// Parameters that were there before an edit.
    earlier: Option<(usize, What)>,
}

impl Script {
    /// A graph of 5 to 2,000 nodes and two views of it.
    pub(super) fn new(seed: u64, fault: Option<PlantedFault>) -> Self {
        let mut scene = Scene::new();
        match fault {
            None => scene.set_check_mode(seed.is_multiple_of(3)),
            // Results alone must tell.
            Some(fault) => scene.plant(fault),
        }
        let (mut dice, mut mirror) = (Dice::new(seed), Mirror::default());
        let n = dice.log_even(5.0, 2000.0);
        let root = mirror.add(&mut scene, What::Group);
        let mut script =
            Self { scene, mirror, views: Vec::new(), dice, log: Vec::new(), earlier: None };
        let other = if script.dice.chance(50) { root } else { script.add(root, What::Group) };
        for root in [root, other] {
            let view = script.open_view(root);
            script.views.push(view);
        }
        let is_bulk = script.dice.chance(50);
        script.in_bulk(is_bulk, |script| {
            while script.mirror.nodes.len() < n {
                let what = script.dice.what();
                if script.dice.chance(12) {
                    script.share();
                } else {
                    let parent = script.some_parent();
                    script.add(parent, what);
                }
            }
        });
        script.note(format!("{n} nodes"));
        script
    }

    pub(super) fn note(&mut self, what: String) {
        self.log.push(what);
    }

    fn open_view(&mut self, root: usize) -> View {
        let variant = self.dice.variant();
        let id = self.scene.open_view(self.mirror.id(root), &variant.rules()).unwrap();
        let (size, tag, seed, time) = (1.0, 1, 0, 0.0);
        let view = View { id, root, variant, size, tag, seed, time };
        view.set_up(&mut self.scene, id);
        view
    }

    fn in_bulk(&mut self, is_bulk: bool, edits: impl FnOnce(&mut Self)) {
        if !is_bulk {
            return edits(self);
        }
        let mut scene = std::mem::take(&mut self.scene);
        scene.bulk(|scene| {
            std::mem::swap(scene, &mut self.scene);
            edits(self);
            std::mem::swap(scene, &mut self.scene);
        });
        self.scene = scene;
    }

    fn some(&mut self) -> usize {
        let all = self.mirror.all();
        self.dice.pick(&all)
    }

    /// A node that can hold one more child, rather a late one.
    fn some_parent(&mut self) -> usize {
        for _ in 0..20 {
            let node = self.some();
            let row = &self.mirror.nodes[node];
            if row.children.len() < room(&row.what) {
                return node;
            }
        }
        self.views[0].root
    }

    /// Whether views stay small enough, were the mirror like this.
    fn fits(&self, mirror: &Mirror) -> bool {
        let roots: Vec<usize> = self.views.iter().map(|view| view.root).collect();
        mirror.most_occurrences(&roots) <= MOST_OCCURRENCES
    }

    fn add(&mut self, parent: usize, what: What) -> usize {
        let node = self.mirror.add(&mut self.scene, what);
        let len = self.mirror.nodes[parent].children.len();
        if self.link(parent, len, node, |scene, parent, child| scene.append(parent, child)).is_err()
        {
            self.note(format!("{what:?} {node} stays alone"));
        }
        node
    }

    /// Makes an edge in scene and mirror, unless the views would become too large; the scene
    /// must refuse what the mirror says it will.
    fn link(
        &mut self,
        parent: usize,
        index: usize,
        child: usize,
        edit: impl FnOnce(&mut Scene, NodeId, NodeId) -> Result<(), sapwood::scene::EditError>,
    ) -> Result<(), ()> {
        let refusal = self.mirror.refusal(parent, index, child);
        if refusal.is_none() {
            self.mirror.link(parent, index, child);
            if !self.fits(&self.mirror) {
                self.mirror.unlink(parent, index);
                return Err(());
            }
        }
        let (parent, child) = (self.mirror.id(parent), self.mirror.id(child));
        assert_eq!(Refusal::of(&edit(&mut self.scene, parent, child)), refusal);
        if refusal.is_some() { Err(()) } else { Ok(()) }
    }

    fn share(&mut self) {
        let (child, parent) = (self.some(), self.some_parent());
        let len = self.mirror.nodes[parent].children.len();
        self.note(format!("append {child} to {parent}"));
        let _ = self.link(parent, len, child, |scene, parent, child| scene.append(parent, child));
    }

    fn insert(&mut self) {
        let (child, parent) = (self.some(), self.some());
        let len = self.mirror.nodes[parent].children.len();
        let index = self.dice.below(len + 2);
        self.note(format!("insert {child} into {parent} at {index}"));
        let _ = self
            .link(parent, index, child, |scene, parent, child| scene.insert(parent, index, child));
    }

    fn some_edge(&mut self) -> Option<(usize, usize)> {
        for _ in 0..20 {
            let parent = self.some();
            let children = &self.mirror.nodes[parent].children;
            if !children.is_empty() {
                return Some((parent, self.dice.below(children.len())));
            }
        }
        None
    }

    fn detach(&mut self) {
        let Some((parent, index)) = self.some_edge() else { return };
        let child = self.mirror.nodes[parent].children[index].0;
        self.note(format!("detach {child} from {parent}"));
        let children = &mut self.mirror.nodes[parent].children;
        let first = children.iter().position(|(other, _)| *other == child).unwrap();
        children.remove(first);
        self.scene.detach(self.mirror.id(parent), self.mirror.id(child)).unwrap();
    }

    fn reorder(&mut self) {
        let Some((parent, from)) = self.some_edge() else { return };
        let to = self.dice.below(self.mirror.nodes[parent].children.len());
        self.note(format!("reorder {parent} from {from} to {to}"));
        let children = &mut self.mirror.nodes[parent].children;
        let child = children.remove(from);
        children.insert(to, child);
        self.scene.reorder(self.mirror.id(parent), from, to).unwrap();
    }

    fn reparent(&mut self) {
        let Some((from, index)) = self.some_edge() else { return };
        let (child, to) = (self.mirror.nodes[from].children[index].0, self.some());
        self.note(format!("reparent {child} from {from} to {to}"));
        let mut mirror = self.mirror.clone();
        let first =
            mirror.nodes[from].children.iter().position(|(other, _)| *other == child).unwrap();
        let refusal = if from == to {
            let edge = mirror.nodes[from].children.remove(first);
            mirror.nodes[from].children.push(edge);
            None
        } else {
            let len = mirror.nodes[to].children.len();
            let refusal = mirror.refusal(to, len, child);
            if refusal.is_none() {
                mirror.nodes[from].children.remove(first);
                mirror.link(to, len, child);
            }
            refusal
        };
        if !self.fits(&mirror) {
            return;
        }
        self.mirror = mirror;
        let id = |node| self.mirror.id(node);
        let result = self.scene.reparent(id(child), id(from), id(to));
        assert_eq!(Refusal::of(&result), refusal);
    }

    fn detach_stranger(&mut self) {
        let (parent, child) = (self.some(), self.some());
        if self.mirror.nodes[parent].children.iter().all(|(other, _)| *other != child) {
            let result = self.scene.detach(self.mirror.id(parent), self.mirror.id(child));
            assert_eq!(Refusal::of(&result), Some(Refusal::NotAChild));
        }
    }

    fn remove(&mut self) {
        let node = self.some();
        let mut mirror = self.mirror.clone();
        mirror.remove(node);
        let n = mirror.all().len();
        if self.views.iter().any(|view| !mirror.nodes[view.root].is_there)
            || n * 2 < self.mirror.all().len()
        {
            return;
        }
        self.note(format!("remove {node}"));
        let n_gone = self.mirror.all().len() - n;
        self.mirror = mirror;
        assert_eq!(self.scene.remove(self.mirror.id(node)).unwrap().len(), n_gone);
    }

    fn change(&mut self) {
        let node = self.some();
        let what = self.mirror.nodes[node].what;
        let changed = self.dice.changed(what);
        self.earlier = Some((node, what));
        self.set(node, changed);
    }

    fn undo(&mut self) {
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
        let (scene, id) = (&mut self.scene, self.mirror.id(node));
        macro_rules! edit {
            ($kind:ty, $new:expr) => {{
                let handle = scene.handle::<$kind>(id).unwrap();
                scene.edit(handle, |component| *component = $new).unwrap();
            }};
        }
        match what {
            What::Transform(transform) => edit!(Transform, Transform(transform)),
            What::Attribute { size, tag, seed } => edit!(Attribute, attribute(size, tag, seed)),
            What::Switch(on) => edit!(Switch, Switch { on }),
            What::Porch(tag) => edit!(Porch, Porch { tag }),
            What::Spinner(speed) => edit!(Spinner, Spinner { speed }),
            What::Plain(size) => edit!(Plain, Plain { size }),
            What::Nest(depth) => edit!(Nest, Nest { depth }),
            What::Fragile(value) => edit!(Fragile, Fragile { value }),
            What::Keyed => edit!(Keyed, Keyed {}),
            _ => {}
        }
    }

    /// Sets or clears one slot of an attribute.
    fn push(&mut self) {
        let all = self.mirror.all();
        let is_attribute =
            |node: &usize| matches!(self.mirror.nodes[*node].what, What::Attribute { .. });
        let attributes: Vec<usize> = all.into_iter().filter(is_attribute).collect();
        if attributes.is_empty() {
            return;
        }
        let node = self.dice.pick(&attributes);
        let handle = self.scene.handle::<Attribute>(self.mirror.id(node)).unwrap();
        let (slot, clears) = (self.dice.below(3), self.dice.chance(30));
        let (new_size, new_tag) = (self.dice.size(), self.dice.tag());
        let What::Attribute { size, tag, seed } = &mut self.mirror.nodes[node].what else { return };
        let scene = &mut self.scene;
        let had = match (slot, clears) {
            (0, false) => return self.push_size(node, new_size),
            (1, false) => {
                *tag = Some(new_tag);
                scene.push::<Tag>(handle, new_tag).unwrap();
                true
            }
            (_, false) => {
                *seed = Some(u64::from(new_tag));
                scene.push::<ChildPath>(handle, StreamPath::new(u64::from(new_tag))).unwrap();
                true
            }
            (0, true) => {
                size.take().is_some() == scene.edit(handle, Attribute::clear::<Size>).unwrap()
            }
            (1, true) => {
                tag.take().is_some() == scene.edit(handle, Attribute::clear::<Tag>).unwrap()
            }
            (_, true) => {
                seed.take().is_some() == scene.edit(handle, Attribute::clear::<ChildPath>).unwrap()
            }
        };
        assert!(had);
        self.note(format!("slot {slot} of {node}: {:?}", self.mirror.nodes[node].what));
    }

    fn push_size(&mut self, node: usize, new: f32) {
        let handle = self.scene.handle::<Attribute>(self.mirror.id(node)).unwrap();
        if let What::Attribute { size, .. } = &mut self.mirror.nodes[node].what {
            *size = Some(new);
        }
        self.scene.push::<Size>(handle, new).unwrap();
        self.note(format!("size of {node}: {new}"));
    }

    fn root_value(&mut self) {
        let place = self.dice.below(self.views.len());
        let view = &mut self.views[place];
        match self.dice.below(3) {
            0 => {
                view.size = self.dice.size();
                self.scene.set_held::<Size>(view.id, view.size).unwrap();
            }
            1 => {
                view.tag = self.dice.tag();
                self.scene.set_held::<Tag>(view.id, view.tag).unwrap();
            }
            _ => {
                view.seed = self.dice.below(3) as u64;
                self.scene.set_held::<ChildPath>(view.id, StreamPath::new(view.seed)).unwrap();
            }
        }
        let view = *view;
        self.note(format!("root values: {view:?}"));
    }

    fn tick(&mut self) {
        let place = self.dice.below(self.views.len());
        let view = &mut self.views[place];
        view.time += 1.0;
        self.scene.set_moving::<Time>(view.id, view.time).unwrap();
        let time = view.time;
        self.note(format!("time of view {place}: {time}"));
    }

    fn replace_rules(&mut self) {
        let place = self.dice.below(self.views.len());
        let view = &mut self.views[place];
        view.variant = self.dice.variant();
        self.scene.set_rules(view.id, &view.variant.rules()).unwrap();
        let view = *view;
        self.note(format!("rules: {view:?}"));
    }

    fn reopen_view(&mut self) {
        let place = self.dice.below(self.views.len());
        self.note(format!("open view {place} again"));
        self.scene.close_view(self.views[place].id).unwrap();
        self.views[place] = self.open_view(self.views[place].root);
    }

    /// One random operation.
    pub(super) fn operate(&mut self, may_bulk: bool) {
        match self.dice.below(34) {
            0..=2 => {
                let (what, parent) = (self.dice.what(), self.some_parent());
                let node = self.add(parent, what);
                self.note(format!("add {what:?} {node} to {parent}"));
            }
            3..=4 => self.share(),
            5..=6 => self.insert(),
            7..=8 => self.detach(),
            9..=10 => self.reorder(),
            11..=13 => self.reparent(),
            14 => self.remove(),
            15 => self.detach_stranger(),
            16..=20 => self.change(),
            21..=22 => self.undo(),
            23..=25 => self.push(),
            26 => self.root_value(),
            27..=28 => self.tick(),
            29 => self.replace_rules(),
            30 => self.reopen_view(),
            31 => {
                self.note("evict".to_owned());
                self.scene.evict();
            }
            _ if may_bulk => {
                self.note("bulk".to_owned());
                self.in_bulk(true, |script| {
                    for _ in 0..2 + script.dice.below(5) {
                        script.operate(false);
                        if script.dice.chance(10) {
                            script.traverse();
                        }
                    }
                });
                self.note("end of bulk".to_owned());
            }
            _ => self.change(),
        }
    }
}
