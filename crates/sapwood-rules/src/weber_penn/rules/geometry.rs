//! What trees look like: surfaces of stems, and leaves as instances.

use std::sync::{Arc, Mutex};

use glam::{Affine3, Mat3};
use sapwood_geom::{FixedMap, Shared, SharedMesh, fixed_state};
use sapwood_graph::Shown;
use sapwood_scene::{Context, MaterialSlot, Rule, RuleError, Style, StyleSlot};

use super::super::slots::{
    BarkSlot, CrownSlot, DetailSlot, FoliageSlot, LeafTargetSlot, LeavesSlot, TrunkFormSlot,
};
use super::super::{
    Leaf, LeafShape, Leaves, Species, Stem, StemSurface, TrunkForm, leaf_mesh, leaves, surface,
};
use super::skeleton::draw_stem_lines;

/// Compiles stems into one mesh of tubes, or what else the style asks for.
pub(super) struct StemSurfaceRule;

impl Rule for StemSurfaceRule {
    type Component = StemSurface;
    type Data = ();
    const NAME: &'static str = "weber_penn.stem_surface";

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let style = *cx.read::<StyleSlot>();
        if style == Style::Skeleton {
            draw_stem_lines(of, cx);
            return Ok(());
        }
        let detail = cx.read::<DetailSlot>();
        let bark = cx.read::<BarkSlot>();
        let is_trunk = of.stems.stems.iter().any(|stem| stem.seed.level == 0);
        let form = if is_trunk {
            cx.read::<TrunkFormSlot>()
        } else {
            // Other stems have no form beyond their taper, and must not depend on the trunk's.
            Arc::new(TrunkForm::new(&Species::default()))
        };
        let mut ends: Vec<u32> = Vec::with_capacity(of.stems.stems.len());
        let charge = |triangles| {
            let end = ends.last().copied().unwrap_or(0);
            ends.push(end.saturating_add(triangles as u32));
            cx.reserve_triangles(triangles as u64)
        };
        let mesh = surface(&of.stems, &form, &detail, charge)?;
        if mesh.is_empty() {
            return Ok(());
        }
        if style == Style::Wire {
            cx.lines(Shared::new(mesh.edges()));
        } else {
            let bark = cx.own_or_forced::<MaterialSlot>(bark);
            cx.mesh(SharedMesh::new(mesh), bark);
            cx.shows(Shown::spans::<Stem>(ends));
        }
        Ok(())
    }
}

/// Compiles leaves into instances of one mesh, or what else the style asks for.
pub(super) struct LeavesRule {
    /// The mesh of each shape that was asked for: a constant, made once and shared by all.
    meshes: Mutex<FixedMap<LeafShape, SharedMesh>>,
}

impl Default for LeavesRule {
    fn default() -> Self {
        Self { meshes: Mutex::new(FixedMap::with_hasher(fixed_state())) }
    }
}

impl LeavesRule {
    fn mesh(&self, shape: LeafShape) -> SharedMesh {
        let mut meshes = self.meshes.lock().unwrap_or_else(|broken| broken.into_inner());
        let mesh = meshes.entry(shape).or_insert_with(|| SharedMesh::new(leaf_mesh(shape)));
        mesh.clone()
    }
}

impl Rule for LeavesRule {
    type Component = Leaves;
    type Data = ();
    const NAME: &'static str = "weber_penn.leaves";

    fn init(&self, on: &Leaves, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let style = *cx.read::<StyleSlot>();
        if style == Style::Skeleton {
            return Ok(());
        }
        let crown = cx.read::<CrownSlot>();
        let params = cx.read::<LeavesSlot>();
        let detail = cx.read::<DetailSlot>();
        let target = cx.read::<LeafTargetSlot>();
        let foliage = cx.read::<FoliageSlot>();
        let mesh = self.mesh(params.shape);
        // A coarse leaf mesh would lose the shape; fewer, larger leaves keep it.
        let params = params.thinned(detail.leaves);
        let n_triangles = mesh.n_triangles() as u64;
        let mut charge = |leaves: usize| {
            cx.reserve_parts(leaves as u64)?;
            cx.reserve_triangles(leaves as u64 * n_triangles)
        };
        let leaves = leaves(&on.stems, &crown, &params, &target, &mut charge)?;
        if leaves.is_empty() {
            return Ok(());
        }
        if style == Style::Wire {
            let edges = mesh.edges();
            let at_each = leaves.iter().map(placed);
            let lines =
                at_each.flat_map(|place| edges.iter().map(move |edge| edge.transformed(&place)));
            cx.lines(Shared::new(lines.collect()));
        } else {
            let foliage = cx.own_or_forced::<MaterialSlot>(foliage);
            let transforms = leaves.iter().map(placed).collect();
            cx.instances(mesh, foliage, Shared::new(transforms));
            cx.shows(Shown::each::<Leaf>());
        }
        cx.parts::<Leaf>(leaves);
        Ok(())
    }
}

/// The transform that puts the unit leaf in its place: as wide, as thick and as long as the
/// leaf is wide, wide and long.
fn placed(leaf: &Leaf) -> Affine3 {
    let axes = leaf.frame.axes;
    let scaled = Mat3::from_cols(
        axes.x_axis * leaf.width,
        axes.y_axis * leaf.width,
        axes.z_axis * leaf.length,
    );
    Affine3::from_mat3_translation(scaled, leaf.frame.origin)
}
