//! An outline of what a view shows, for people to read.
//!
//! A paragraph for each component that somebody placed, indented below the one that holds it; what
//! is shared is told at every place. Lines of text that rules made of a component are its own words;
//! of others it is told what they draw. [`dump`](crate::dump) is for whoever writes rules, this is
//! for whoever wants to know what is there.

use std::collections::BTreeMap;

use sapwood_geom::glam::{Affine3, Mat3, Quat, Vec3};
use sapwood_geom::{Aabb, FixedMap, fixed_state};

use super::up_to::UpTo;
use crate::{
    At, Camera, Diagnostic, Facing, Kind, Label, Lens, Light, LightShape, Order, RenderNode,
    Supplied, Supply, grouped, walk,
};

/// Everything below the root as an outline, of at most `max_entries` components and a note where
/// more are left. Those of the kinds `folded` are told together with what they hold, unless they
/// hold several.
pub fn outline(supply: &dyn Supply, folded: &[Kind], max_entries: usize) -> String {
    let (_, root) = supply.root();
    let interest = UpTo::default();
    let mut entries: Vec<Entry> = Vec::new();
    // By the number of the path to a plan, the entry that it is told in.
    let mut told_in: FixedMap<u32, usize> = FixedMap::with_hasher(fixed_state());
    walk(supply, Order::Pre, &interest, &mut |at| {
        if at.site() == root || interest.is_full() {
            return;
        }
        let path = at.path();
        if at.enters_plan() {
            let above = told_in.get(&path.number_above()).copied();
            let plan = at.plan();
            let entry = match above.filter(|_| !plan.authored) {
                Some(entry) => entry,
                None if entries.len() == max_entries => return interest.fill(),
                None => {
                    if let Some(above) = above {
                        entries[above].n_below += 1;
                    }
                    entries.push(Entry::new(plan.kind, above, *at.world()));
                    entries.len() - 1
                }
            };
            told_in.insert(path.number(), entry);
        }
        if let Some(entry) = told_in.get(&path.number()) {
            entries[*entry].meet(at, supply);
        }
    });
    let mut text = written(&entries, folded);
    if interest.is_full() {
        text.push_str("... and more\n");
    }
    text
}

/// A component that somebody placed, with what its rule and the rules below it made.
struct Entry {
    kind: Kind,
    above: Option<usize>,
    /// From where it stands to the root.
    frame: Affine3,
    /// How many entries stand right below it.
    n_below: usize,
    /// How it places, turns or otherwise treats what it holds.
    how: Vec<String>,
    /// What rules say of it.
    words: Vec<String>,
    /// What single nodes draw, where that can be said in a few words.
    facts: Vec<String>,
    parts: BTreeMap<&'static str, u64>,
    n_triangles: u64,
    n_instances: u64,
    n_lines: u64,
    /// Around the meshes and lines that it draws itself, with its own axes.
    around: Aabb,
    errors: Vec<String>,
}

impl Entry {
    fn new(kind: Kind, above: Option<usize>, frame: Affine3) -> Self {
        Self {
            kind,
            above,
            frame,
            n_below: 0,
            how: Vec::new(),
            words: Vec::new(),
            facts: Vec::new(),
            parts: BTreeMap::new(),
            n_triangles: 0,
            n_instances: 0,
            n_lines: 0,
            around: Aabb::EMPTY,
            errors: Vec::new(),
        }
    }

    /// Takes in a node of one of its plans.
    fn meet(&mut self, at: &At<'_, ()>, supply: &dyn Supply) {
        let plan = at.plan();
        if at.enters_plan() {
            for (kind, n) in plan.parts.lengths() {
                *self.parts.entry(kind.name()).or_default() += n as u64;
            }
            self.errors.extend(plan.error.map(told));
        }
        match at.node() {
            RenderNode::Group
            | RenderNode::Fading(_)
            | RenderNode::Aspects(_)
            | RenderNode::Swaying(_) => {}
            // How emitted components lie to each other is nobody's business.
            RenderNode::Transform(place) if plan.authored => self.how.extend(placing(place)),
            RenderNode::Transform(_) => {}
            RenderNode::Live(_) => self.how.push("moving".to_owned()),
            RenderNode::Facing(Facing::Eye) => self.how.push("facing the eye".to_owned()),
            RenderNode::Facing(Facing::Axis(axis)) => {
                self.how.push(format!("facing the eye about ({})", point(*axis)));
            }
            RenderNode::Mesh { mesh, .. } => self.n_triangles += mesh.n_triangles() as u64,
            RenderNode::Instances { mesh, transforms, .. } => {
                self.n_triangles += mesh.n_triangles() as u64 * transforms.len() as u64;
                self.n_instances += transforms.len() as u64;
            }
            RenderNode::Lines(lines) => self.n_lines += lines.len() as u64,
            RenderNode::Light(light) => self.facts.push(of_light(light)),
            RenderNode::Camera(camera) => self.facts.push(of_camera(camera)),
            RenderNode::Label(label) if plan.kind == Kind::of::<Label>() => {
                self.facts.push(format!("{:?}, letters {} high", label.text, metres(label.height)));
            }
            RenderNode::Label(label) => self.words.push(label.text.clone()),
            RenderNode::Deferred(run) => {
                let (env, _) = supply.root();
                for link in run.first..run.first + run.count {
                    if let (_, Supplied::Failed(why)) = supply.enter(env, at.site(), link) {
                        self.errors.push(told(why));
                    }
                }
            }
        }
        let is_solid = matches!(
            at.node(),
            RenderNode::Mesh { .. } | RenderNode::Instances { .. } | RenderNode::Lines(_)
        );
        if let (true, Some(bound)) = (is_solid, plan.fragment.drawn_bound(at.index())) {
            let here = self.frame.inverse() * *at.world();
            let around = if here.is_finite() { bound.transformed(&here) } else { bound };
            self.around = self.around.union(around.aabb);
        }
    }

    /// Whether it has a line of its own.
    fn is_folded(&self, folded: &[Kind]) -> bool {
        let says_nothing = self.words.is_empty() && self.facts.is_empty() && self.errors.is_empty();
        let draws_nothing = self.n_triangles == 0 && self.n_lines == 0 && self.parts.is_empty();
        folded.contains(&self.kind) && self.n_below == 1 && says_nothing && draws_nothing
    }

    /// Its first line, after `how` from those that were folded into it; then the others.
    fn lines(&self, how: &[String]) -> Vec<String> {
        let mut title = self.kind.name().to_owned();
        let mut first: Vec<&str> = Vec::new();
        first.extend(self.words.first().map(String::as_str));
        first.extend(how.iter().map(String::as_str));
        first.extend(self.facts.iter().map(String::as_str));
        let drawn = self.drawn();
        // Whoever speaks for itself need not be looked at.
        if self.words.is_empty() {
            first.extend(self.how.iter().chain(&drawn).map(String::as_str));
        }
        if !first.is_empty() {
            title = format!("{title}: {}", first.join(", "));
        }
        let mut lines = vec![title];
        lines.extend(self.words.iter().skip(1).map(|line| format!("  {line}")));
        lines.extend(self.errors.iter().map(|why| format!("  cannot be shown: {why}")));
        lines
    }

    /// What it draws, in figures.
    fn drawn(&self) -> Vec<String> {
        let mut drawn: Vec<String> = Vec::new();
        drawn.extend(self.parts.iter().map(|(kind, n)| format!("{} {kind}", grouped(*n))));
        let counted = |n: u64, one: &str, many: &str| {
            (n > 0).then(|| format!("{} {}", grouped(n), if n == 1 { one } else { many }))
        };
        drawn.extend(counted(self.n_instances, "instance", "instances"));
        drawn.extend(counted(self.n_triangles, "triangle", "triangles"));
        drawn.extend(counted(self.n_lines, "line", "lines"));
        if !self.around.is_empty() && !drawn.is_empty() {
            let [x, y, z] = self.around.size().to_array().map(number);
            drawn.push(format!("{x} x {y} x {z} m"));
        }
        drawn
    }
}

/// The entries as text.
fn written(entries: &[Entry], folded: &[Kind]) -> String {
    let mut text = String::new();
    // For each entry its depth, and what was folded into those below it.
    let mut told: Vec<(usize, Vec<String>)> = Vec::with_capacity(entries.len());
    for entry in entries {
        let (depth, how) = match entry.above {
            None => (0, Vec::new()),
            Some(above) if entries[above].is_folded(folded) => {
                let (depth, how) = &told[above];
                (*depth, [how.as_slice(), &entries[above].how].concat())
            }
            Some(above) => (told[above].0 + 1, Vec::new()),
        };
        if !entry.is_folded(folded) {
            for line in entry.lines(&how) {
                text.extend(std::iter::repeat_n("  ", depth));
                text.push_str(&line);
                text.push('\n');
            }
        }
        told.push((depth, how));
    }
    text
}

fn told(why: &Diagnostic) -> String {
    why.message.clone()
}

/// What a transform does, in words; nothing where it does nothing.
fn placing(place: &Affine3) -> Option<String> {
    let (scale, turn, at) = place.to_scale_rotation_translation();
    let mut words = Vec::new();
    if at != Vec3::ZERO {
        words.push(format!("at ({})", point(at)));
    }
    if place.matrix3 == Mat3::ZERO {
        // Which has no turn.
        words.push("scaled by 0".to_owned());
        return Some(words.join(", "));
    }
    let again = Affine3::from_scale_rotation_translation(scale, turn, at);
    let slack = 1e-4 * (1.0 + place.matrix3.x_axis.abs().max_element());
    if !again.matrix3.abs_diff_eq(place.matrix3, slack) {
        words.push("skewed".to_owned());
        return Some(words.join(", "));
    }
    words.extend(turning(turn));
    let [x, y, z] = scale.to_array();
    if (scale - Vec3::ONE).abs().max_element() > 1e-4 {
        let is_even = (x - y).abs().max((y - z).abs()) <= 1e-4 * x.abs();
        let times = if is_even { number(x) } else { format!("({})", point(scale)) };
        words.push(format!("scaled by {times}"));
    }
    (!words.is_empty()).then(|| words.join(", "))
}

fn turning(turn: Quat) -> Option<String> {
    let (axis, angle) = turn.to_axis_angle();
    // The same turn the short way round.
    let (axis, angle) = if angle > std::f32::consts::PI {
        (-axis, std::f32::consts::TAU - angle)
    } else {
        (axis, angle)
    };
    let degrees = number(angle.to_degrees());
    if degrees == "0" {
        return None;
    }
    let names = [(Vec3::X, "x"), (Vec3::Y, "y"), (Vec3::Z, "z")];
    let named = names.into_iter().find(|(known, _)| axis.dot(*known).abs() > 0.999_999);
    Some(match named {
        Some((known, name)) if axis.dot(known) > 0.0 => {
            format!("turned by {degrees} degrees about {name}")
        }
        Some((_, name)) => format!("turned by -{degrees} degrees about {name}"),
        None => format!("turned by {degrees} degrees about ({})", point(axis)),
    })
}

fn of_light(light: &Light) -> String {
    let (shape, unit) = match light.shape {
        LightShape::Directional => ("from afar", "lux"),
        LightShape::Point { .. } => ("in all directions", "candela"),
        LightShape::Spot { .. } => ("into a cone", "candela"),
    };
    named(&light.name, format!("{shape}, {} {unit}", number(light.intensity)))
}

fn of_camera(camera: &Camera) -> String {
    let lens = match camera.lens {
        Lens::Perspective { vertical_angle } => {
            format!("{} degrees high", number(vertical_angle.to_degrees()))
        }
        Lens::Orthographic { height } => format!("{} high", metres(height)),
    };
    named(&camera.name, lens)
}

fn named(name: &str, rest: String) -> String {
    if name.is_empty() { rest } else { format!("{name:?}, {rest}") }
}

fn point(v: Vec3) -> String {
    v.to_array().map(number).join(", ")
}

fn metres(length: f32) -> String {
    format!("{} m", number(length))
}

/// A number rounded to 1e-2, smaller ones to three digits; without trailing zeros and without a
/// negative zero.
fn number(x: f32) -> String {
    let steps = if x.abs() < 0.1 { 1e4 } else { 1e2 };
    let rounded = (f64::from(x) * steps).round() / steps;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_in_words() {
        let check = |place: Affine3, expected: Option<&str>| {
            assert_eq!(placing(&place).as_deref(), expected, "{place:?}");
        };
        check(Affine3::IDENTITY, None);
        check(Affine3::from_translation(Vec3::new(4.0, 0.0, -2.5)), Some("at (4, 0, -2.5)"));
        let quarter = Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2);
        let all = Affine3::from_scale_rotation_translation(Vec3::splat(2.0), quarter, Vec3::X);
        check(all, Some("at (1, 0, 0), turned by -90 degrees about y, scaled by 2"));
        check(Affine3::from_scale(Vec3::new(1.0, 3.0, 1.0)), Some("scaled by (1, 3, 1)"));
        let skewed = Mat3::from_cols(Vec3::X, Vec3::new(0.5, 1.0, 0.0), Vec3::Z);
        check(Affine3::from_mat3(skewed), Some("skewed"));
        check(Affine3::from_scale(Vec3::ZERO), Some("scaled by 0"));
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.0, -0.001, 0.0123, 1.0, 12.345].map(number),
            ["0", "-0.001", "0.0123", "1", "12.35"]
        );
    }
}
