//! What trees look like: surfaces of stems, and leaves as instances.

use std::convert::Infallible;
use std::sync::{Arc, Mutex};

use glam::{Affine3, Mat3};
use sapwood_geom::{Content, Digester, FixedMap, Mesh, Shared, SharedMesh, fixed_state};
use sapwood_graph::{Material, Offers, Shown, Solids};
use sapwood_images::{LeafOutline, PaintedMaterial};
use sapwood_scene::{Context, Held, MaterialSlot, Rule, RuleError, Slot, Style, StyleSlot};

use super::super::slots::{
    BarkLookSlot, BarkSlot, CrownSlot, DetailSlot, FoliageSlot, LeafLookSlot, LeafTargetSlot,
    LeavesSlot, TrunkFormSlot,
};
use super::super::{
    Detail, Leaf, LeafShape, Leaves, Species, Stem, StemSurface, Stems, TrunkForm, closed_stems,
    leaf_card, leaf_mesh, leaves, surface,
};
use super::skeleton::draw_stem_lines;

/// Compiles stems into one mesh of tubes, or what else the style asks for.
pub(super) struct StemSurfaceRule;

/// What a surface was made of, for whoever wants its stems as solids.
pub(super) struct Tubed {
    stems: Shared<Stems>,
    form: Arc<TrunkForm>,
    detail: Arc<Detail>,
    bark_width: f32,
}

impl Content for Tubed {
    fn write(&self, digester: &mut Digester) {
        let Self { stems, form, detail, bark_width } = self;
        digester.add(stems).add(&**form).add(&**detail).add(bark_width);
    }
}

impl Solids for Tubed {
    fn solids(&self) -> Vec<Mesh> {
        let Self { stems, form, detail, bark_width } = self;
        let free = |_| Ok::<(), Infallible>(());
        let Ok(solids) = closed_stems(stems, form, detail, *bark_width, free);
        solids
    }
}

impl Rule for StemSurfaceRule {
    type Component = StemSurface;
    /// Nothing where no surface was made.
    type Data = Option<Tubed>;
    const NAME: &'static str = "weber_penn.stem_surface";

    fn interfaces(offers: &mut Offers<Self::Data>) {
        offers.offer::<dyn Solids>(|tubed| match tubed {
            Some(tubed) => tubed,
            None => &Nothing,
        });
    }

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<Self::Data, RuleError> {
        let style = *cx.read::<StyleSlot>();
        if style == Style::Skeleton {
            draw_stem_lines(of, cx);
            return Ok(None);
        }
        let detail = cx.read::<DetailSlot>();
        let look = cx.read::<BarkLookSlot>();
        let bark = if style == Style::Solid {
            let level = of.stems.stems.first().map_or(0, |stem| stem.seed.level);
            let own = || look.material(level, &detail);
            Some(material::<BarkSlot>(own, cx)?.0)
        } else {
            None
        };
        let form = trunk_form(of, cx);
        let mut ends: Vec<u32> = Vec::with_capacity(of.stems.stems.len());
        let charge = |triangles| {
            let end = ends.last().copied().unwrap_or(0);
            ends.push(end.saturating_add(triangles as u32));
            cx.reserve_triangles(triangles as u64)
        };
        let mesh = surface(&of.stems, &form, &detail, look.width, charge)?;
        if mesh.is_empty() {
            return Ok(None);
        }
        match bark {
            Some(bark) => {
                cx.mesh(SharedMesh::new(mesh), bark);
                cx.shows(Shown::spans::<Stem>(ends));
            }
            None => cx.lines(Shared::new(mesh.edges())),
        }
        Ok(Some(Tubed { stems: of.stems.clone(), form, detail, bark_width: look.width }))
    }
}

/// No solids.
struct Nothing;

impl Solids for Nothing {
    fn solids(&self) -> Vec<Mesh> {
        Vec::new()
    }
}

/// The form of the trunks among the stems.
pub(super) fn trunk_form(of: &StemSurface, cx: &mut Context<'_>) -> Arc<TrunkForm> {
    let is_trunk = of.stems.stems.iter().any(|stem| stem.seed.level == 0);
    if is_trunk {
        cx.read::<TrunkFormSlot>()
    } else {
        // Other stems have no form beyond their taper, and must not depend on the trunk's.
        Arc::new(TrunkForm::new(&Species::default()))
    }
}

/// The material to draw with, and whether it is the species' own: one that is forced wins, then
/// one that somebody has set in the slot, then that which `own` is painted to.
pub(super) fn material<S: Slot<Value = Option<Material>, Rate = Held>>(
    own: impl FnOnce() -> PaintedMaterial,
    cx: &mut Context<'_>,
) -> Result<(Arc<Material>, bool), RuleError> {
    let set = cx.read::<S>();
    let nobodys = Arc::new(Material::matte("", 0.0, 0.0, 0.0));
    let forced = cx.own_or_forced::<MaterialSlot>(Arc::clone(&nobodys));
    if !Arc::ptr_eq(&forced, &nobodys) {
        return Ok((forced, false));
    }
    match &*set {
        Some(set) => Ok((Arc::new(set.clone()), false)),
        None => Ok((Arc::clone(cx.ingredient::<Arc<Material>>(own())?), true)),
    }
}

/// Compiles leaves into instances of one mesh, or what else the style asks for.
pub(super) struct LeavesRule {
    /// The mesh of each shape, and of each outline on it, that was asked for: constants, made once
    /// and shared by all.
    meshes: Mutex<FixedMap<(LeafShape, Option<LeafOutline>), SharedMesh>>,
}

impl Default for LeavesRule {
    fn default() -> Self {
        Self { meshes: Mutex::new(FixedMap::with_hasher(fixed_state())) }
    }
}

impl LeavesRule {
    pub(super) fn mesh(&self, shape: LeafShape, outline: Option<LeafOutline>) -> SharedMesh {
        let mut meshes = self.meshes.lock().unwrap_or_else(|broken| broken.into_inner());
        let new =
            || SharedMesh::new(outline.map_or_else(|| leaf_mesh(shape), |o| leaf_card(shape, o)));
        meshes.entry((shape, outline)).or_insert_with(new).clone()
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
        let (foliage, outline) = if style == Style::Solid {
            let look = cx.read::<LeafLookSlot>();
            let (foliage, is_own) = material::<FoliageSlot>(|| look.material(&detail), cx)?;
            (Some(foliage), is_own.then_some(look.outline))
        } else {
            (None, None)
        };
        let mesh = self.mesh(params.shape, outline);
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
        match foliage {
            Some(foliage) => {
                let transforms = leaves.iter().map(placed).collect();
                cx.instances(mesh, foliage, Shared::new(transforms));
                cx.shows(Shown::each::<Leaf>());
            }
            None => {
                let edges = mesh.edges();
                let at_each = leaves.iter().map(placed);
                let lines = at_each
                    .flat_map(|place| edges.iter().map(move |edge| edge.transformed(&place)));
                cx.lines(Shared::new(lines.collect()));
            }
        }
        cx.parts::<Leaf>(leaves);
        Ok(())
    }
}

/// The transform that puts the unit leaf in its place: as wide, as thick and as long as the
/// leaf is wide, wide and long.
pub(super) fn placed(leaf: &Leaf) -> Affine3 {
    let axes = leaf.frame.axes;
    let scaled = Mat3::from_cols(
        axes.x_axis * leaf.width,
        axes.y_axis * leaf.width,
        axes.z_axis * leaf.length,
    );
    Affine3::from_mat3_translation(scaled, leaf.frame.origin)
}
