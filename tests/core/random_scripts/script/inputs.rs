//! Edits of what components get from others: value sub-graphs, connections and kits.

use sapwood::scene::{Handle, Kit, KitTemplate, NodeId, Transform};

use super::Script;
use crate::core::kinds::Plain;
use crate::core::random_scripts::kinds::Knob;
use crate::core::random_scripts::mirror::{Refusal, Wire};
use crate::core::random_scripts::what::What;
use crate::core::random_scripts::wires::{self, Drive};

impl Script {
    /// Nodes for which something holds.
    fn nodes_that(&self, holds: impl Fn(&What) -> bool) -> Vec<usize> {
        let all = self.mirror.all();
        all.into_iter().filter(|node| holds(&self.mirror.nodes[*node].what)).collect()
    }

    /// Makes a node ask the value sub-graph below another, or none.
    pub(super) fn ask(&mut self) {
        let askers = match self.dice.below(10) {
            0 => self.mirror.all(),
            1..=4 => self.nodes_that(What::may_ask),
            _ => self.nodes_that(|what| match what {
                What::Attribute(pushes) => pushes.asks(),
                what => what.may_ask(),
            }),
        };
        if askers.is_empty() {
            return;
        }
        let node = self.dice.pick(&askers);
        let top = (!self.dice.chance(15)).then(|| self.some_top());
        self.note(format!("{node} asks {top:?}"));
        let refusal = top.filter(|top| self.mirror.reaches(*top, node)).map(|_| Refusal::Cycle);
        let mut mirror = self.mirror.clone();
        mirror.nodes[node].asks = top;
        if refusal.is_none() {
            if !self.fits(&mirror) {
                return;
            }
            self.mirror = mirror;
        }
        let (id, top) = (self.mirror.id(node), top.map(|top| self.mirror.id(top)));
        let result = self.scene.set_value_graph(id, top);
        assert_eq!(Refusal::of(&result), refusal);
        let expected = self.mirror.nodes[node].asks.map(|top| self.mirror.id(top));
        assert_eq!(self.scene.value_graph(id), expected);
    }

    /// A node to begin a value sub-graph with: now and then one that answers nothing.
    fn some_top(&mut self) -> usize {
        let all = match self.dice.below(8) {
            0 => self.mirror.all(),
            1 => self.nodes_that(|what| what.room() == usize::MAX),
            _ => self.nodes_that(What::may_ask),
        };
        if all.is_empty() { self.some() } else { self.dice.pick(&all) }
    }

    /// Changes something in a value sub-graph that is asked.
    pub(super) fn change_asked(&mut self) {
        let tops = self.mirror.all().into_iter().filter_map(|node| self.mirror.nodes[node].asks);
        let tops: Vec<usize> = tops.collect();
        if tops.is_empty() {
            return;
        }
        let mut node = self.dice.pick(&tops);
        while self.dice.chance(50) {
            match self.mirror.nodes[node].children.len() {
                0 => break,
                n => node = self.mirror.nodes[node].children[self.dice.below(n)].0,
            }
        }
        self.change_node(node);
    }

    /// Connects two nodes, rather to what drives or is driven already.
    pub(super) fn connect(&mut self) {
        let mut sources = self.nodes_that(|what| wires::number(what).is_some());
        let mut targets = self.nodes_that(|what| !wires::inputs(what).is_empty());
        for wire in &self.mirror.wires {
            sources.extend([wire.source, wire.target].repeat(8));
            targets.extend([wire.source, wire.target].repeat(8));
        }
        sources.retain(|node| wires::number(&self.mirror.nodes[*node].what).is_some());
        targets.retain(|node| !wires::inputs(&self.mirror.nodes[*node].what).is_empty());
        if sources.is_empty() || targets.is_empty() {
            return;
        }
        let (source, target) = (self.dice.pick(&sources), self.dice.pick(&targets));
        let input = self.dice.pick(wires::inputs(&self.mirror.nodes[target].what));
        let panics_at = self.dice.chance(15).then(|| self.dice.below(5) as u32);
        let drive = Drive { input, add: self.dice.below(10) as u32, panics_at };
        self.wire(source, target, drive);
    }

    fn wire(&mut self, source: usize, target: usize, drive: Drive) {
        self.note(format!("connect {source} to {target}: {drive:?}"));
        let refusal = self.mirror.drives(target, source).then_some(Refusal::Cycle);
        let end = |node: usize| (self.mirror.id(node), &self.mirror.nodes[node].what);
        let result = wires::connect(&mut self.scene, end(source), end(target), drive);
        assert_eq!(Refusal::of(&result), refusal);
        if refusal.is_none() {
            self.note_wire(source, target, drive);
        }
        self.check_inputs(target);
    }

    fn note_wire(&mut self, source: usize, target: usize, drive: Drive) {
        let new = Wire { source, target, drive };
        let wires = &mut self.mirror.wires;
        let is_same = |wire: &&mut Wire| wire.target == target && wire.drive.input == drive.input;
        match wires.iter_mut().find(is_same) {
            // Who takes over an input takes over its turn.
            Some(wire) => *wire = new,
            None => wires.push(new),
        }
    }

    fn check_inputs(&self, target: usize) {
        let found: Vec<_> = self.scene.inputs(self.mirror.id(target)).collect();
        let wires = self.mirror.wires.iter().filter(|wire| wire.target == target);
        let input = |wire: &Wire| (self.mirror.id(wire.source), wire.drive.input);
        assert_eq!(found, wires.map(input).collect::<Vec<_>>());
    }

    /// Changes something that drives something else.
    pub(super) fn change_source(&mut self) {
        if self.mirror.wires.is_empty() {
            return self.connect();
        }
        let place = self.dice.below(self.mirror.wires.len());
        let Wire { source, target, .. } = self.mirror.wires[place];
        let node = if self.dice.chance(75) { source } else { target };
        self.change_node(node);
    }

    pub(super) fn disconnect(&mut self) {
        if self.mirror.wires.is_empty() {
            return;
        }
        let place = self.dice.below(self.mirror.wires.len());
        let Wire { target, drive, .. } = self.mirror.wires.remove(place);
        self.note(format!("disconnect {} of {target}", drive.input));
        let id = self.mirror.id(target);
        assert_eq!(self.scene.disconnect(id, drive.input), Ok(true));
        assert_eq!(self.scene.disconnect(id, drive.input), Ok(false));
        self.check_inputs(target);
    }

    /// Adds a kit of two parts that are driven, below something that holds it.
    pub(super) fn add_kit(&mut self) {
        let template = KitTemplate::<Knob>::new()
            .part("move", Transform::translation(0.0, 1.0, 0.0))
            .part_under("move", "body", Plain { size: 1.0 })
            .expose("move", "x", |knob, part: &mut Transform| {
                part.0.translation.x = (knob.number % 7) as f32 - 3.0;
            })
            .expose("body", "size", |knob, part: &mut Plain| {
                part.size = 1.0 + (knob.number % 8) as f32 / 2.0;
            });
        let number = self.dice.tag();
        let kit: Handle<Kit<Knob>> = self.scene.add_kit(&template, Knob { number }).unwrap();
        let part = |name| -> NodeId { self.scene.get(kit).unwrap().part(name).unwrap() };
        let ids = [part("move"), part("body")];
        let moved = What::Transform(Transform::translation(0.0, 1.0, 0.0).0);
        let kit = self.mirror.add_placed(kit.id(), What::Kit(number));
        let moved = self.mirror.add_placed(ids[0], moved);
        let body = self.mirror.add_placed(ids[1], What::Plain(1.0));
        self.mirror.link(kit, 0, moved);
        self.mirror.link(moved, 0, body);
        for (part, input) in [(moved, "x"), (body, "size")] {
            self.note_wire(kit, part, Drive { input, add: 0, panics_at: None });
        }
        let parent = self.some_parent();
        self.note(format!("add kit {kit} of {number} to {parent}"));
        let len = self.mirror.nodes[parent].children.len();
        let _ = self.link(parent, len, kit, |scene, parent, child| scene.append(parent, child));
    }
}
