//! What a view must show, computed from the mirror without any cache: one visit for each
//! occurrence, slots handed down by value.

use std::collections::BTreeMap;

use sapwood::geom::Aabb;
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::Facing;
use sapwood::scene::Style;

use super::frame::Frame;
use super::here::{Here, merge_places, merge_tags, replace};
use super::kinds::*;
use super::mirror::{Mirror, View};
use super::values::{Unanswerable, answer, pushed};
use super::what::{Push, Pushes, Turning, What, label, look_name};

/// The sort of something that is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sort {
    Mesh,
    Lines,
    Light,
    Camera,
    Label,
}

/// Something that is drawn.
#[derive(Clone, Debug)]
pub(super) struct Item {
    /// The links that lead there.
    pub(super) path: Vec<u32>,
    pub(super) sort: Sort,
    pub(super) world: Frame,
    /// The number that tells it from others.
    pub(super) size: f32,
    /// The name of its material.
    pub(super) look: &'static str,
    /// The box around it; none around lights and cameras.
    pub(super) around: Aabb,
    pub(super) is_turned: bool,
    pub(super) is_vague: bool,
    /// Which of its triangles are drawn, as the first and the one behind the last; nothing where
    /// all are, or where that is too close to tell.
    pub(super) part: Option<[u32; 2]>,
}

/// Everything that a view must show.
#[derive(Default)]
pub(super) struct Expected {
    pub(super) items: Vec<Item>,
    pub(super) counts: BTreeMap<&'static str, u64>,
    /// Kinds of what could not be compiled.
    pub(super) errors: Vec<&'static str>,
    /// Paths of authored occurrences, at most one for each visit.
    pub(super) paths: Vec<Vec<u32>>,
}

struct Evaluation<'a> {
    mirror: &'a Mirror,
    view: &'a View,
    /// Every node as its inputs make it.
    effective: Vec<Option<What>>,
    /// What attributes push once their value sub-graphs were asked.
    pushes: BTreeMap<usize, Result<Pushes, Unanswerable>>,
    /// Only what lies on the way there and below it.
    under: &'a [u32],
    found: Expected,
}

/// Everything below the links `under`; an empty path stands for everything.
pub(super) fn expected(mirror: &Mirror, view: &View, under: &[u32]) -> Expected {
    let (effective, pushes) = (mirror.effective(), BTreeMap::new());
    let found = Expected::default();
    let mut all = Evaluation { mirror, view, effective, pushes, under, found };
    let mut stack = vec![(view.root, Here::above(view).child(0, 0))];
    while let Some((node, here)) = stack.pop() {
        let first = stack.len();
        all.node(node, here, &mut stack);
        stack[first..].reverse();
    }
    all.found.errors.sort_unstable();
    all.found
}

impl Evaluation<'_> {
    fn is_wanted(&self, here: &Here) -> bool {
        here.links.iter().zip(self.under).all(|(a, b)| a == b)
    }

    /// One occurrence of an authored component; its children go onto the stack.
    fn node(&mut self, number: usize, here: Here, stack: &mut Vec<(usize, Here)>) {
        if !self.is_wanted(&here) {
            return;
        }
        self.found.paths.push(here.links.clone());
        let mirror = self.mirror;
        let node = &mirror.nodes[number];
        let kind = kind_name(&node.what);
        self.count(kind);
        let mut children = |inside: Here, first: u32| {
            for (link, (child, key)) in (first..).zip(&node.children) {
                stack.push((*child, inside.child(link, *key)));
            }
        };
        let Some(what) = self.effective[number] else { return self.found.errors.push(kind) };
        match what {
            What::Group | What::Kit(_) => children(here, 0),
            What::Transform(transform) => match self.whole_transform(number, transform) {
                Some(whole) => children(here.placed(&whole), 0),
                None => self.found.errors.push(kind),
            },
            What::Attribute(pushes) => match self.asked_pushes(number, pushes) {
                Ok(pushes) => children(here.pushed(&pushes), 0),
                Err(Unanswerable) => self.found.errors.push(kind),
            },
            What::Switch(on) => match self.asked_switch(number) {
                Ok(asked) if asked.unwrap_or(on) => children(here, 0),
                Ok(_) => {}
                Err(Unanswerable) => self.found.errors.push(kind),
            },
            What::Selector(shown) => match self.asked_choice(number) {
                Ok(asked) => one_child(&node.children, asked.unwrap_or(shown), &here, stack),
                Err(Unanswerable) => self.found.errors.push(kind),
            },
            What::Levels(distances) => {
                let level = level(&distances, &here);
                one_child(&node.children, Some(level), &here, stack);
            }
            What::Rotor(turning) => match self.rotor(turning) {
                Some(turn) => {
                    let world = here.world.after(&turn);
                    children(Here { world, is_turned: true, ..here }, 0);
                }
                None => self.found.errors.push(kind),
            },
            What::Billboard(facing) => match facing {
                Facing::Axis(axis) if axis == Vec3::ZERO => self.found.errors.push(kind),
                Facing::Axis(_) | Facing::Eye => {
                    let (world, is_sure) = here.world.faced(facing, self.view.eye.as_ref());
                    let is_vague = here.is_vague || !is_sure;
                    children(Here { world, is_turned: true, is_vague, ..here }, 0);
                }
            },
            What::Porch(tag) => {
                self.sized(&here.child(0, 0));
                let last = node.children.len() as u32 + 1;
                self.placed(&here.child(last, u64::from(last)));
                children(here.tagged(tag), 1);
            }
            What::Spinner(speed) => {
                let spun = Frame::of(&spun(speed, self.view.time as f32));
                children(Here { world: here.world.after(&spun), ..here }, 0);
            }
            leaf => self.leaf(&leaf, &here),
        }
    }

    /// One occurrence of an authored component that holds nothing, and is counted already.
    fn leaf(&mut self, what: &What, here: &Here) {
        match *what {
            What::Plain(size) => self.draw(here, size * self.view.variant.plain_factor as f32),
            What::Placed => self.draw_placed(here),
            What::Sized => self.draw(here, here.size.value),
            What::Tagged if self.view.variant.has_tagged => {
                self.draw(here, tagged_size(here.tag.value));
            }
            What::Tagged => self.unserved("tagged"),
            What::Keyed => self.draw(here, keyed_size(here.path.value)),
            What::Gridded => self.draw(here, gridded_size(cell_of(&here.place.value))),
            What::Sided => {
                let is_vague = here.is_vague || !here.place.value.is_finite();
                self.draw(
                    &Here { is_vague, ..here.clone() },
                    sided_size(side_of(&here.place.value)),
                );
            }
            What::Chooser => self.draw(
                here,
                match here.tag.value % 3 {
                    0 => here.size.value,
                    1 => placed_size(&here.place.value),
                    _ => 3.0,
                },
            ),
            What::Limited { size, by } => {
                self.draw(here, size);
                let part = self.part(here, by);
                self.found.items.last_mut().expect("one was drawn").part = part;
            }
            What::Nest(depth) => self.inside_nest(here, depth),
            What::Fragile(value) => match fragile_fate(value, here.size.value) {
                Fate::Draws => self.draw(here, here.size.value + 0.25),
                Fate::Fails | Fate::Panics => self.found.errors.push("fragile"),
            },
            What::Woven(depth) => match self.yarn(here, depth) {
                None if depth.is_multiple_of(2) => self.found.errors.push("woven"),
                size => {
                    self.draw(here, size.unwrap_or(0.25));
                    self.emitted(&What::Yarn(depth), &here.child(0, 0));
                }
            },
            What::Yarn(_) if self.view.variant.yarn_factor.is_none() => self.unserved("yarn"),
            What::Yarn(depth) => match self.yarn(here, depth) {
                Some(size) => self.draw(here, size),
                None => self.found.errors.push("yarn"),
            },
            What::Held { size, look } => match here.style.value {
                Style::Solid => {
                    let look = look_name(here.look.own_or_forced(look));
                    self.item(here, Sort::Mesh, size, look, triangle_box(size));
                }
                Style::Wire | Style::Skeleton => {
                    self.item(here, Sort::Lines, size, "", triangle_box(size));
                }
            },
            What::Light(intensity) if intensity >= 0.0 => {
                self.item(here, Sort::Light, intensity, "", Aabb::EMPTY);
            }
            What::Light(_) => self.found.errors.push("light"),
            What::Camera(near) if near > 0.0 => {
                self.item(here, Sort::Camera, near, "", Aabb::EMPTY);
            }
            What::Camera(_) => self.found.errors.push("camera"),
            What::Label(height) if height > 0.0 => {
                self.item(here, Sort::Label, height, "", label(height).bound().aabb);
            }
            What::Label(_) => self.found.errors.push("label"),
            ref other => panic!("{other:?} is no leaf"),
        }
    }

    /// Without a rule there is no plan to count.
    fn unserved(&mut self, kind: &'static str) {
        *self.found.counts.entry(kind).or_default() -= 1;
        self.found.counts.retain(|_, n| *n > 0);
        self.found.errors.push(kind);
    }

    /// The size of yarn; nothing where there is none.
    fn yarn(&self, here: &Here, depth: u32) -> Option<f32> {
        let factor = self.view.variant.yarn_factor?;
        let Some(less) = depth.checked_sub(1) else {
            return match yarn_source(here.tag.value) {
                Source::Size => Some(here.size.value),
                Source::Placement => Some(placed_size(&here.place.value)),
                Source::Path => Some(keyed_size(here.path.value)),
                Source::Cell => Some(gridded_size(cell_of(&here.place.value))),
                Source::Failure | Source::Panic => None,
            };
        };
        Some(yarn_step(self.yarn(here, less)?, factor))
    }

    fn count(&mut self, kind: &'static str) {
        *self.found.counts.entry(kind).or_default() += 1;
    }

    fn draw(&mut self, here: &Here, size: f32) {
        self.item(here, Sort::Mesh, size, "m", triangle_box(size));
    }

    fn item(&mut self, here: &Here, sort: Sort, size: f32, look: &'static str, own: Aabb) {
        let around = if own.is_empty() { own } else { here.world.around(&own) };
        let (world, path) = (here.world, here.links.clone());
        let Here { is_turned, is_vague, .. } = *here;
        let part = None;
        self.found.items.push(Item {
            path,
            sort,
            world,
            size,
            look,
            around,
            is_turned,
            is_vague,
            part,
        });
    }

    /// Which of two triangles are drawn.
    fn part(&self, here: &Here, by: LimitedBy) -> Option<[u32; 2]> {
        let Some(eye) = &self.view.eye else { return Some([0, 2]) };
        let there = here.world.point_back(eye.position);
        if !there.iter().all(|x| x.is_finite()) {
            return Some([0, 2]);
        }
        let [x, y, z] = there;
        let (over, part) = match by {
            LimitedBy::Distance => {
                let over = (x * x + y * y + z * z).sqrt() - f64::from(REACH);
                (over, if over < 0.0 { [0, 2] } else { [0, 1] })
            }
            LimitedBy::Side => (x, if x < 0.0 { [1, 2] } else { [0, 1] }),
        };
        (over.abs() > 0.05).then_some(part)
    }

    fn draw_placed(&mut self, here: &Here) {
        let flat = self.view.variant.placed_is_flat;
        self.draw(here, if flat { 0.75 } else { placed_size(&here.place.value) });
    }

    /// An emitted component.
    fn emitted(&mut self, what: &What, here: &Here) {
        if self.is_wanted(here) {
            self.count(kind_name(what));
            self.leaf(what, here);
        }
    }

    fn placed(&mut self, here: &Here) {
        self.emitted(&What::Placed, here);
    }

    fn sized(&mut self, here: &Here) {
        self.emitted(&What::Sized, here);
    }

    fn inside_nest(&mut self, here: &Here, depth: u32) {
        let Some(less) = depth.checked_sub(1) else { return self.draw(here, 0.5) };
        self.placed(&here.child(0, 0));
        let moved = here.placed(&nest_step());
        self.emitted(&What::Nest(less), &moved.child(1, 1));
        self.emitted(&What::Keyed, &moved.child(2, 2));
        self.sized(&here.sized(depth as f32).child(3, 3));
        self.emitted(&What::Tagged, &here.tagged(depth).child(4, 4));
    }

    /// What a transform moves by, with what its value sub-graph answers.
    fn whole_transform(&self, node: usize, own: Affine3) -> Option<Affine3> {
        let offer = |what: &What| match what {
            What::Transform(transform) => Some(*transform),
            other => pushed(other, |pushes| pushes.place),
        };
        let asked = answer(self.mirror, &self.effective, node, offer, merge_places);
        let whole = asked.ok()?.map_or(own, |asked| own * asked);
        whole.is_finite().then_some(whole)
    }

    fn asked_switch(&self, node: usize) -> Result<Option<bool>, Unanswerable> {
        let offer = |what: &What| match what {
            What::Switch(on) => Some(*on),
            _ => None,
        };
        answer(self.mirror, &self.effective, node, offer, replace)
    }

    fn asked_choice(&self, node: usize) -> Result<Option<Option<usize>>, Unanswerable> {
        let offer = |what: &What| match what {
            What::Selector(shown) => Some(*shown),
            _ => None,
        };
        answer(self.mirror, &self.effective, node, offer, replace)
    }

    /// What an attribute pushes, its value sub-graph asked once.
    fn asked_pushes(&mut self, node: usize, own: Pushes) -> Result<Pushes, Unanswerable> {
        if let Some(known) = self.pushes.get(&node) {
            return *known;
        }
        let asked = self.ask_pushes(node, own);
        self.pushes.insert(node, asked);
        asked
    }

    fn ask_pushes(&self, node: usize, own: Pushes) -> Result<Pushes, Unanswerable> {
        macro_rules! ask {
            ($slot:ident, $offer:expr, $combine:expr) => {
                match own.$slot {
                    Some(Push { mode, held: None }) => {
                        answer(self.mirror, &self.effective, node, $offer, $combine)?
                            .map(|held| Push { mode, held: Some(held) })
                    }
                    push => push,
                }
            };
            ($slot:ident, $combine:expr) => {
                ask!($slot, |what| pushed(what, |pushes| pushes.$slot), $combine)
            };
        }
        let place = |what: &What| match what {
            What::Transform(transform) => Some(*transform),
            other => pushed(other, |pushes| pushes.place),
        };
        Ok(Pushes {
            size: ask!(size, replace),
            tag: ask!(tag, merge_tags),
            path: ask!(path, replace),
            place: ask!(place, place, merge_places),
            style: ask!(style, replace),
            look: ask!(look, replace),
        })
    }

    /// The turn of a rotor; nothing where it has no axis or no speed.
    fn rotor(&self, turning: Turning) -> Option<Frame> {
        let Turning { axis, velocity, phase } = turning;
        let angle = f64::from(phase) + f64::from(velocity) * self.view.time;
        let is_sound = velocity.is_finite() && axis != Vec3::ZERO;
        is_sound.then(|| Frame::turning(axis.to_array().map(f64::from), angle))
    }
}

impl Here {
    /// Below everything that an attribute pushes.
    fn pushed(&self, pushes: &Pushes) -> Self {
        macro_rules! push {
            ($slot:ident, $merge:expr) => {
                match pushes.$slot {
                    Some(Push { mode, held: Some(held) }) => self.$slot.pushed(mode, held, $merge),
                    _ => self.$slot,
                }
            };
        }
        Self {
            size: push!(size, replace),
            tag: push!(tag, merge_tags),
            path: push!(path, replace),
            place: push!(place, merge_places),
            style: push!(style, replace),
            look: push!(look, replace),
            ..self.clone()
        }
    }
}

fn one_child(
    children: &[(usize, u64)],
    shown: Option<usize>,
    here: &Here,
    stack: &mut Vec<(usize, Here)>,
) {
    if let Some((child, key)) = shown.and_then(|shown| children.get(shown)) {
        stack.push((*child, here.child(0, *key)));
    }
}

/// Which level is shown: the distance is reckoned as the engine does, for it may lie anywhere.
fn level(distances: &[f32], here: &Here) -> usize {
    let Some(viewpoint) = here.viewpoint.value else { return 0 };
    let distance = here.place.value.transform_point3(Vec3::ZERO).distance(viewpoint);
    distances.iter().filter(|end| **end <= distance).count()
}

fn triangle_box(size: f32) -> Aabb {
    Aabb::of_points([Vec3::ZERO, Vec3::X * size, Vec3::Y * size])
}

fn kind_name(what: &What) -> &'static str {
    match what {
        What::Group => "group",
        What::Transform(_) => "transform",
        What::Attribute(_) => "attribute",
        What::Switch(_) => "switch",
        What::Selector(_) => "selector",
        What::Levels(_) => "level_of_detail",
        What::Rotor(_) => "rotor",
        What::Billboard(_) => "billboard",
        What::Kit(_) => "knob",
        What::Held { .. } => "held_geometry",
        What::Light(_) => "light",
        What::Camera(_) => "camera",
        What::Label(_) => "label",
        What::Porch(_) => "porch",
        What::Spinner(_) => "spinner",
        What::Plain(_) => "plain",
        What::Placed => "placed",
        What::Sized => "sized",
        What::Tagged => "tagged",
        What::Keyed => "keyed",
        What::Gridded => "gridded",
        What::Sided => "sided",
        What::Limited { .. } => "limited",
        What::Chooser => "chooser",
        What::Nest(_) => "nest",
        What::Fragile(_) => "fragile",
        What::Woven(_) => "woven",
        What::Yarn(_) => "yarn",
    }
}
