//! Trees as they stand on a map: the disc and the outline of the crown, the trunk, the name and the
//! height; everything flat on the ground, north (-z) up.

use std::sync::Arc;

use glam::{Affine3, Mat3, Vec2, Vec3};
use sapwood_geom::{Circle, Mesh, Polyline, Shared, SharedMesh, sin_cos};
use sapwood_graph::{Alpha, Anchor, Label, Material};
use sapwood_scene::{Context, Rule, RuleError};

use super::super::TreeSurvey;
use super::super::slots::{BarkLookSlot, LeafLookSlot, SpeciesNameSlot};
use super::super::survey::{Figures, SurveyedCrown};
use super::survey::surveyed;
use super::text::metres;

/// Corners of what stands for a circle.
const CORNERS: u32 = 72;
/// The radius of a dot that can be seen, relative to that of the crown.
const THINNEST: f32 = 0.015;
/// What lies upon other things lies this much higher, in metres, so that rays and viewers agree on
/// which is seen.
const STEP: f32 = 0.01;

/// Draws a tree from above.
pub(super) struct TreeMapRule;

impl Rule for TreeMapRule {
    type Component = TreeSurvey;
    type Data = ();
    const NAME: &'static str = "weber_penn.tree_map";

    fn init(&self, tree: &TreeSurvey, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let (figures, linear) = surveyed(tree, cx)?;
        if figures.feet.is_empty() {
            return Ok(());
        }
        let name = cx.read::<SpeciesNameSlot>();
        let bark = cx.read::<BarkLookSlot>();
        // A crown without leaves has the colour of its twigs.
        let color = if figures.n_leaves > 0 { cx.read::<LeafLookSlot>().color } else { bark.color };
        let n_corners = figures.crown.outline.len() as u64 + u64::from(CORNERS);
        cx.reserve_triangles(n_corners + u64::from(CORNERS) * figures.feet.len() as u64)?;
        cx.transform(Affine3::from_mat3(linear.inverse()), |cx| {
            cx.transform(Affine3::from_translation(Vec3::Y * figures.ground), |cx| {
                draw_crown(&figures.crown, color, cx);
                draw_trunks(&figures, bark.deep_color, cx);
                write_labels(&figures, &name, cx);
            });
        });
        Ok(())
    }
}

fn draw_crown(crown: &SurveyedCrown, [red, green, blue]: [f32; 3], cx: &mut Context<'_>) {
    let Circle { center, radius } = crown.disc;
    if crown.outline.len() < 3 || radius == 0.0 {
        return;
    }
    let tinted = |name: &str, coverage| {
        // Paler than leaves are, for paper is bright.
        let [red, green, blue] = [red, green, blue].map(|channel| channel.sqrt());
        let paint = Material::matte(name, red, green, blue);
        let base_color = [red, green, blue, coverage];
        Arc::new(Material { base_color, alpha: Alpha::Blend, double_sided: true, ..paint })
    };
    let border: Vec<Vec2> = circle(center, radius, CORNERS).collect();
    cx.mesh(SharedMesh::new(flat(&border, 0.0)), tinted("crown_disc", 0.3));
    // The outline comes clockwise as seen from above.
    let outline: Vec<Vec2> = crown.outline.iter().rev().copied().collect();
    cx.mesh(SharedMesh::new(flat(&outline, STEP)), tinted("crown", 0.5));
    let closed = border.iter().chain(border.first());
    let points: Vec<Vec3> = closed.map(|point| Vec3::new(point.x, STEP, point.y)).collect();
    cx.lines(Shared::new(vec![Polyline { radii: vec![0.0; points.len()], points }]));
}

/// A dot for each trunk, as thick as the trunk is, or as can be seen.
fn draw_trunks(figures: &Figures, [red, green, blue]: [f32; 3], cx: &mut Context<'_>) {
    let mut dots = Mesh::default();
    for (foot, radius) in &figures.feet {
        let radius = radius.max(THINNEST * figures.crown.disc.radius);
        let border: Vec<Vec2> = circle(Vec2::new(foot.x, foot.z), radius, CORNERS / 3).collect();
        dots.append(&flat(&border, 2.0 * STEP), &Affine3::IDENTITY);
    }
    let wood = Material::matte("trunk", red, green, blue);
    cx.mesh(SharedMesh::new(dots), Arc::new(Material { double_sided: true, ..wood }));
}

/// The name and the height, below the middle of the crown.
fn write_labels(figures: &Figures, name: &str, cx: &mut Context<'_>) {
    let Circle { center, radius } = figures.crown.disc;
    let height = (0.12 * radius).clamp(0.05, 1.0);
    let thickest = figures.feet.iter().fold(0.0, |most: f32, (_, radius)| most.max(*radius));
    let height_text = format!("{} high", metres(figures.height));
    let lines = [name, &height_text].into_iter().filter(|line| !line.is_empty());
    for (number, line) in lines.enumerate() {
        let down = thickest + (1.5 + 1.4 * number as f32) * height;
        let at = Vec3::new(center.x, 3.0 * STEP, center.y + down);
        // From the plane of the text, which is read from its z, to the ground.
        let flat = Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y);
        cx.transform(Affine3::from_mat3_translation(flat, at), |cx| {
            cx.label(Label { anchor: Anchor::Middle, ..Label::new(line, height) });
        });
    }
}

/// Points on a circle, counter-clockwise as seen from above: from x toward -z.
fn circle(center: Vec2, radius: f32, n: u32) -> impl Iterator<Item = Vec2> {
    (0..n).map(move |i| {
        let (sin, cos) = sin_cos(std::f32::consts::TAU * i as f32 / n as f32);
        center + radius * Vec2::new(cos, -sin)
    })
}

/// A convex polygon on the ground, at a height, from its corners counter-clockwise as seen from above.
fn flat(corners: &[Vec2], height: f32) -> Mesh {
    let positions = corners.iter().map(|corner| Vec3::new(corner.x, height, corner.y)).collect();
    let fan = (1..corners.len().saturating_sub(1) as u32).flat_map(|i| [0, i, i + 1]);
    Mesh {
        positions,
        normals: vec![Vec3::Y; corners.len()],
        uvs: vec![Vec2::ZERO; corners.len()],
        indices: fan.collect(),
    }
}
