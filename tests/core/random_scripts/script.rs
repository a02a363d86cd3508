//! One script: a random graph, random edits of it, and traversals in between.

mod inputs;
mod parameters;

use sapwood::scene::{EditError, NodeId, PlantedFault, Scene};

use super::dice::Dice;
use super::mirror::{Mirror, Refusal, RootValues, View};
use super::what::What;

/// Occurrences that a view may show at most.
const MOST_OCCURRENCES: u64 = 3000;

/// Occurrences that a value sub-graph may have at most.
const MOST_ASKED: u64 = 300;

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
                match script.dice.below(100) {
                    0..12 => script.share(),
                    12..17 => script.ask(),
                    17..21 => script.connect(),
                    21 => script.add_kit(),
                    _ => {
                        let parent = script.some_parent();
                        script.add(parent, what);
                    }
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
        View { id, root, variant, values: RootValues::default(), time: 0.0, eye: None }
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
            if row.children.len() < row.what.room() {
                return node;
            }
        }
        self.views[0].root
    }

    /// Whether views stay small enough, were the mirror like this.
    fn fits(&self, mirror: &Mirror) -> bool {
        let roots: Vec<usize> = self.views.iter().map(|view| view.root).collect();
        let asked = mirror.nodes.iter().filter(|node| node.is_there).filter_map(|node| node.asks);
        mirror.most_occurrences(&roots) <= MOST_OCCURRENCES
            && mirror.most_occurrences(&asked.collect::<Vec<_>>()) <= MOST_ASKED
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
        edit: impl FnOnce(&mut Scene, NodeId, NodeId) -> Result<(), EditError>,
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
        match self.dice.below(50) {
            0..=2 => {
                let (what, parent) = (self.dice.what(), self.some_parent());
                let node = self.add(parent, what);
                self.note(format!("add {what:?} {node} to {parent}"));
            }
            3 => self.add_kit(),
            4..=5 => self.share(),
            6..=7 => self.insert(),
            8..=9 => self.detach(),
            10..=11 => self.reorder(),
            12..=14 => self.reparent(),
            15 => self.remove(),
            16 => self.detach_stranger(),
            17..=20 => self.change(),
            21..=22 => self.undo(),
            23..=27 => self.push(),
            28..=30 => self.root_value(),
            31..=32 => self.tick(),
            33 => self.look_from(),
            34..=36 => self.ask(),
            37..=38 => self.change_asked(),
            39..=40 => self.connect(),
            41..=42 => self.change_source(),
            43 => self.disconnect(),
            44 => self.replace_rules(),
            45 => self.reopen_view(),
            46 => {
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
