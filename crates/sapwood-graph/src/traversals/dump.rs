//! A stable text dump of a render graph, for golden files and for reading.
//!
//! One line for each plan and each node, indented by depth; numbers rounded to 1e-4. A deferred
//! node has no line but counts as a depth: a plan is indented twice below the one above it. What is
//! shared is written out at every place, so that the text tells what is there and not how it
//! happens to be stored.

use std::fmt::Write as _;

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{FixedMap, fixed_state};

use super::up_to::UpTo;
use crate::{
    At, Facing, Lens, Light, LightShape, Order, RenderNode, SiteId, Supplied, Supply, walk,
};

/// Everything below the root as text, at most `max_lines` lines and a note where more is left.
///
/// Costs each site once and the lines that are written, however often the rest occurs.
pub fn dump(supply: &dyn Supply, max_lines: usize) -> String {
    let mut text = String::new();
    let mut n_lines = 0;
    let (_, root) = supply.root();
    let interest = UpTo::default();
    walk(supply, Order::Pre, &interest, &mut |at| {
        // The root is a place to hold the view's component; it and its one deferred node are
        // not part of the picture.
        if at.site() == root || interest.is_full() {
            return;
        }
        if let Some(line) = line(at) {
            if n_lines == max_lines {
                interest.fill();
                return;
            }
            n_lines += 1;
            for _ in 2..at.depth() {
                text.push_str("  ");
            }
            text.push_str(&line);
            text.push('\n');
        }
    });
    if interest.is_full() {
        let _ = writeln!(text, "... {} lines more", n_all_lines(supply) - n_lines as u64);
    }
    text
}

/// How many lines the whole text would have; saturates.
fn n_all_lines(supply: &dyn Supply) -> u64 {
    let (env, root) = supply.root();
    let mut known: FixedMap<SiteId, u64> = FixedMap::with_hasher(fixed_state());
    let mut stack = vec![(root, false)];
    while let Some((site, is_done)) = stack.pop() {
        if !is_done && known.contains_key(&site) {
            continue;
        }
        let fragment = supply.plan(site).fragment;
        let mut n_lines = 0u64;
        if !is_done {
            stack.push((site, true));
        }
        for index in 0..fragment.len() {
            let RenderNode::Deferred(run) = fragment.node(index) else {
                n_lines = n_lines.saturating_add(1);
                continue;
            };
            for link in run.first..run.first + run.count {
                if let (_, Supplied::Ready(child)) = supply.enter(env, site, link) {
                    match known.get(&child) {
                        Some(below) => n_lines = n_lines.saturating_add(*below),
                        None => stack.push((child, false)),
                    }
                }
            }
        }
        if is_done {
            known.insert(site, n_lines);
        }
    }
    // The root itself has a line for none of its nodes but counts one.
    known.get(&root).map_or(0, |n_lines| n_lines.saturating_sub(1))
}

fn line<S>(at: &At<'_, S>) -> Option<String> {
    let plan = at.plan();
    let mut line = match at.node() {
        RenderNode::Group if at.enters_plan() => {
            let mut line = plan.kind.name().to_owned();
            for (kind, n) in plan.parts.lengths() {
                let _ = write!(line, ", {n} {kind}");
            }
            if let Some(error) = plan.error {
                let _ = write!(line, ", error: {}", error.message);
            }
            line
        }
        RenderNode::Group => "hold".to_owned(),
        RenderNode::Transform(transform) => format!("place {}", rounded(transform)),
        RenderNode::Live(value) => format!("live {}", rounded(&plan.live[value as usize])),
        RenderNode::Facing(Facing::Eye) => "face the eye".to_owned(),
        RenderNode::Facing(Facing::Axis(axis)) => format!("face the eye about ({})", point(*axis)),
        RenderNode::Fading(fading) => format!("fade in masses of {}", fading.mass),
        RenderNode::Aspects(aspects) if aspects.blends => {
            format!("blend {} aspects", aspects.toward.len())
        }
        RenderNode::Aspects(aspects) => format!("show one of {} aspects", aspects.toward.len()),
        RenderNode::Swaying(rig) => format!("sway with {} joints", rig.joints.len()),
        RenderNode::Mesh { mesh, material } => format!(
            "mesh {} vertices {} triangles {}",
            mesh.n_vertices(),
            mesh.n_triangles(),
            material.name
        ),
        RenderNode::Instances { mesh, material, transforms } => format!(
            "instances {} x {} triangles {}",
            transforms.len(),
            mesh.n_triangles(),
            material.name
        ),
        RenderNode::Lines(lines) => format!("lines {}", lines.len()),
        RenderNode::Light(light) => light_line(light),
        RenderNode::Camera(camera) => match camera.lens {
            Lens::Perspective { vertical_angle } => {
                format!("camera {:?} perspective {}", camera.name, number(vertical_angle))
            }
            Lens::Orthographic { height } => {
                format!("camera {:?} orthographic {}", camera.name, number(height))
            }
        },
        RenderNode::Label(label) => format!("label {:?} {}", label.text, number(label.height)),
        RenderNode::Deferred(_) => return None,
    };
    if let Some(bound) = plan.fragment.drawn_bound(at.index()).filter(|bound| !bound.is_empty()) {
        let (min, max) = (point(bound.aabb.min), point(bound.aabb.max));
        let _ = write!(line, " ({min})..({max})");
    }
    Some(line)
}

fn light_line(light: &Light) -> String {
    let shape = match light.shape {
        LightShape::Directional => "directional",
        LightShape::Point { .. } => "point",
        LightShape::Spot { .. } => "spot",
    };
    let color = light.color.map(number).join(" ");
    format!("light {:?} {shape} ({color}) x {}", light.name, number(light.intensity))
}

fn rounded(transform: &Affine3) -> String {
    let m = &transform.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis, transform.translation].map(point);
    format!("[{}]", columns.join(" | "))
}

fn point(v: Vec3) -> String {
    v.to_array().map(number).join(" ")
}

/// A number rounded to 1e-4, without trailing zeros and without a negative zero.
fn number(x: f32) -> String {
    let rounded = (f64::from(x) * 1e4).round() / 1e4;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        assert_eq!(number(-0.000_01), "0");
        assert_eq!(number(1.5), "1.5");
        assert_eq!(number(2.000_04), "2");
        assert_eq!(point(Vec3::new(1.0, -2.25, 0.0)), "1 -2.25 0");
    }
}
