//! What a view must show, computed from the mirror without any cache: one visit for each
//! occurrence, slots handed down by value.

use std::collections::BTreeMap;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Aabb, StreamPath};

use super::kinds::*;
use super::mirror::{Mirror, View, What};

/// A triangle that is drawn: where, and how large.
pub(super) type Row = ([f32; 12], f32);

pub(super) fn row(world: &Affine3, size: f32) -> Row {
    // Adding zero makes one zero of the two.
    (world.to_cols_array().map(|x| x + 0.0), size)
}

/// Everything that a view must show.
#[derive(Default)]
pub(super) struct Expected {
    pub(super) rows: Vec<Row>,
    /// The box of each row.
    pub(super) boxes: Vec<Aabb>,
    pub(super) counts: BTreeMap<&'static str, u64>,
    /// Kinds of what could not be compiled.
    pub(super) errors: Vec<&'static str>,
    /// Paths of authored occurrences, at most one for each visit.
    pub(super) paths: Vec<Vec<u32>>,
}

/// What is handed down.
#[derive(Clone)]
struct Here {
    /// With what spins.
    world: Affine3,
    /// Without what spins.
    place: Affine3,
    size: f32,
    tag: u32,
    path: StreamPath,
    links: Vec<u32>,
}

impl Here {
    fn placed(&self, by: &Affine3) -> Self {
        Self { world: self.world * *by, place: self.place * *by, ..self.clone() }
    }

    fn tagged(&self, pushed: u32) -> Self {
        Self { tag: (self.tag * 3 + pushed) % 101, ..self.clone() }
    }

    /// Through one link to the child with this key.
    fn child(&self, link: u32, key: u64) -> Self {
        let mut child = Self { path: self.path.child(key), ..self.clone() };
        child.links.push(link);
        child
    }
}

struct Evaluation<'a> {
    mirror: &'a Mirror,
    variant: Variant,
    time: f32,
    /// Only what lies on the way there and below it.
    under: &'a [u32],
    found: Expected,
}

/// Everything below the links `under`; an empty path stands for everything.
pub(super) fn expected(mirror: &Mirror, view: &View, under: &[u32]) -> Expected {
    let found = Expected::default();
    let mut all = Evaluation { mirror, variant: view.variant, time: view.time, under, found };
    let identity = Affine3::IDENTITY;
    let path = StreamPath::new(view.seed);
    let (size, tag, links) = (view.size, view.tag, Vec::new());
    let start = Here { world: identity, place: identity, size, tag, path, links };
    let mut stack = vec![(view.root, start.child(0, 0))];
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
    fn node(&mut self, node: usize, here: Here, stack: &mut Vec<(usize, Here)>) {
        if !self.is_wanted(&here) {
            return;
        }
        self.found.paths.push(here.links.clone());
        let node = &self.mirror.nodes[node];
        let mut children = |inside: Here, first: u32| {
            for (link, (child, key)) in (first..).zip(&node.children) {
                stack.push((*child, inside.child(link, *key)));
            }
        };
        match node.what {
            What::Group => {
                self.count("group");
                children(here, 0);
            }
            What::Transform(transform) => {
                self.count("transform");
                if transform.is_finite() {
                    children(here.placed(&transform), 0);
                } else {
                    self.found.errors.push("transform");
                }
            }
            What::Attribute { size, tag, seed } => {
                self.count("attribute");
                let mut inside = tag.map_or(here.clone(), |tag| here.tagged(tag));
                inside.size = size.unwrap_or(here.size);
                inside.path = seed.map_or(here.path, StreamPath::new);
                children(inside, 0);
            }
            What::Switch(on) => {
                self.count("switch");
                if on {
                    children(here, 0);
                }
            }
            What::Porch(tag) => {
                self.count("porch");
                self.sized(&here.child(0, 0));
                let last = node.children.len() as u32 + 1;
                self.placed(&here.child(last, u64::from(last)));
                children(here.tagged(tag), 1);
            }
            What::Spinner(speed) => {
                self.count("spinner");
                let world = here.world * spun(speed, self.time);
                children(Here { world, ..here }, 0);
            }
            What::Plain(size) => {
                self.count("plain");
                self.draw(&here, size * self.variant.plain_factor as f32);
            }
            What::Placed => self.placed(&here),
            What::Sized => self.sized(&here),
            What::Tagged => self.tagged(&here),
            What::Keyed => self.keyed(&here),
            What::Gridded => {
                self.count("gridded");
                self.draw(&here, gridded_size(cell_of(&here.place)));
            }
            What::Chooser => {
                self.count("chooser");
                let size = match here.tag % 3 {
                    0 => here.size,
                    1 => placed_size(&here.place),
                    _ => 3.0,
                };
                self.draw(&here, size);
            }
            What::Nest(depth) => self.nest(&here, depth),
            What::Fragile(value) => {
                self.count("fragile");
                match fragile_fate(value, here.size) {
                    Fate::Draws => self.draw(&here, here.size + 0.25),
                    Fate::Fails | Fate::Panics => self.found.errors.push("fragile"),
                }
            }
        }
    }

    fn count(&mut self, kind: &'static str) {
        *self.found.counts.entry(kind).or_default() += 1;
    }

    fn draw(&mut self, here: &Here, size: f32) {
        let corners = [Vec3::ZERO, Vec3::X * size, Vec3::Y * size];
        let corners = corners.map(|corner| here.world.transform_point3(corner));
        self.found.rows.push(row(&here.world, size));
        self.found.boxes.push(Aabb::of_points(corners));
    }

    fn placed(&mut self, here: &Here) {
        if self.is_wanted(here) {
            self.count("placed");
            let flat = self.variant.placed_is_flat;
            self.draw(here, if flat { 0.75 } else { placed_size(&here.place) });
        }
    }

    fn sized(&mut self, here: &Here) {
        if self.is_wanted(here) {
            self.count("sized");
            self.draw(here, here.size);
        }
    }

    fn tagged(&mut self, here: &Here) {
        if !self.is_wanted(here) {
            return;
        }
        if self.variant.has_tagged {
            self.count("tagged");
            self.draw(here, tagged_size(here.tag));
        } else {
            self.found.errors.push("tagged");
        }
    }

    fn keyed(&mut self, here: &Here) {
        if self.is_wanted(here) {
            self.count("keyed");
            self.draw(here, keyed_size(here.path));
        }
    }

    fn nest(&mut self, here: &Here, depth: u32) {
        if !self.is_wanted(here) {
            return;
        }
        self.count("nest");
        let Some(less) = depth.checked_sub(1) else { return self.draw(here, 0.5) };
        self.placed(&here.child(0, 0));
        let moved = here.placed(&nest_step());
        self.nest(&moved.child(1, 1), less);
        self.keyed(&moved.child(2, 2));
        self.sized(&Here { size: depth as f32, ..here.child(3, 3) });
        self.tagged(&here.tagged(depth).child(4, 4));
    }
}
