//! What trees look like: surfaces of stems, and leaves as instances.

use std::convert::Infallible;
use std::sync::Arc;

use glam::{Affine3, Quat, Vec3};
use sapwood_geom::{Content, Digester, Mesh, Shared, SharedMesh, content};
use sapwood_graph::{Material, Offers, Shown, Solids};
use sapwood_images::PaintedMaterial;
use sapwood_scene::{Context, Held, MaterialSlot, Rule, RuleError, Slot, Style, StyleSlot};

use super::super::fading::leaf_point;
use super::super::geometry::segmented_surface;
use super::super::growth::leaves_at;
use super::super::slots::{
    BarkLookSlot, BarkSlot, CrownSlot, DetailSlot, FoliageSlot, LeafLookSlot, LeavesSlot,
    TrunkFormSlot,
};
use super::super::{
    Crown, Detail, Leaf, LeafModel, LeafParams, LeafSurface, Species, Stem, StemSurface, Stems,
    TrunkForm, closed_stems, leaf_card, leaf_mesh,
};
use super::skeleton::draw_stem_lines;
use super::swaying::{Carried, segments_of};

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
        let carried = Carried::of(&of.stems, bark.is_some(), cx);
        let mut segments = carried.is_some().then(Vec::new);
        let charge = |triangles| {
            let end = ends.last().copied().unwrap_or(0);
            ends.push(end.saturating_add(triangles as u32));
            cx.reserve_triangles(triangles as u64)
        };
        let mesh =
            segmented_surface(&of.stems, &form, &detail, look.width, charge, segments.as_mut())?;
        if mesh.is_empty() {
            return Ok(None);
        }
        match bark {
            Some(bark) => Carried::sway(carried, segments, cx, |cx, follow| {
                cx.mesh(SharedMesh::new(mesh), bark);
                follow(cx);
                cx.shows(Shown::spans::<Stem>(ends));
            }),
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

/// The least width of a leaf's mesh, as a share of its length.
const NARROWEST: f32 = 1e-4;

/// Compiles a leaf into its meshes, for whoever draws many of it.
pub(super) struct LeafModelRule;

/// The meshes of one leaf, from where its petiole begins: z along the leaf, y its upper normal.
pub(super) struct LeafMeshes {
    /// Its shape, or the card that an image's outline is cut out of.
    pub(super) whole: SharedMesh,
    /// What stands for it from afar.
    pub(super) point: SharedMesh,
}

content!(LeafMeshes { whole, point });

impl Rule for LeafModelRule {
    type Component = LeafModel;
    type Data = LeafMeshes;
    const NAME: &'static str = "weber_penn.leaf_model";

    fn init(&self, leaf: &LeafModel, _: &mut Context<'_>) -> Result<LeafMeshes, RuleError> {
        let &LeafModel { shape, outline, length, width, petiole } = leaf;
        // Narrower, it would have no triangles that are any.
        let width = width.max(NARROWEST * length);
        // As thick as it is wide.
        let size = Affine3::from_scale_rotation_translation(
            Vec3::new(width, width, length),
            Quat::IDENTITY,
            petiole * Vec3::Z,
        );
        let sized = |unit: &Mesh| {
            let mut mesh = Mesh::default();
            mesh.append(unit, &size);
            SharedMesh::new(mesh)
        };
        let whole = outline.map_or_else(|| leaf_mesh(shape), |outline| leaf_card(shape, outline));
        Ok(LeafMeshes { whole: sized(&whole), point: sized(&leaf_point(shape)) })
    }
}

/// What leaves are drawn with, as the style asks for it.
pub(super) struct LeafDress<'a> {
    pub(super) meshes: &'a LeafMeshes,
    /// Nothing where edges are drawn.
    pub(super) foliage: Option<Arc<Material>>,
    /// Each leaf as a part, when somebody asks.
    pub(super) rows: LeafRows,
}

/// What each leaf is known by as a part.
pub(super) struct LeafRows {
    of: LeafSurface,
    crown: Arc<Crown>,
    params: LeafParams,
}

impl LeafRows {
    pub(super) fn make(self) -> Vec<Leaf> {
        let Self { of, crown, params } = self;
        leaves_at(&of.places, &of.on, &of.stems, &crown, &params)
    }
}

/// Finds out what leaves are drawn with.
pub(super) fn leaf_dress<'a>(
    of: &LeafSurface,
    cx: &mut Context<'a>,
) -> Result<LeafDress<'a>, RuleError> {
    let style = *cx.read::<StyleSlot>();
    let crown = cx.read::<CrownSlot>();
    let detail = cx.read::<DetailSlot>();
    let params = cx.read::<LeavesSlot>().thinned(detail.leaves);
    let (foliage, outline) = if style == Style::Solid {
        let look = cx.read::<LeafLookSlot>();
        let (foliage, is_own) = material::<FoliageSlot>(|| look.material(&detail), cx)?;
        (Some(foliage), is_own.then_some(look.outline))
    } else {
        (None, None)
    };
    let (length, width, petiole) = (params.length(), params.width(), params.petiole());
    let model = LeafModel { shape: params.shape, outline, length, width, petiole };
    let meshes = cx.ingredient::<LeafMeshes>(model)?;
    Ok(LeafDress { meshes, foliage, rows: LeafRows { of: of.clone(), crown, params } })
}

/// Compiles leaves into instances of one mesh, or what else the style asks for.
pub(super) struct LeafSurfaceRule;

impl Rule for LeafSurfaceRule {
    type Component = LeafSurface;
    type Data = ();
    const NAME: &'static str = "weber_penn.leaf_surface";

    fn init(&self, of: &LeafSurface, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let LeafDress { meshes, foliage, rows } = leaf_dress(of, cx)?;
        let mesh = meshes.whole.clone();
        cx.reserve_triangles((of.places.len() * mesh.n_triangles()) as u64)?;
        match foliage {
            Some(foliage) => {
                let carried = Carried::of(&of.stems, true, cx);
                let segments = carried.is_some().then(|| segments_of(of));
                Carried::sway(carried, segments, cx, |cx, follow| {
                    cx.instances(mesh, foliage, of.places.clone());
                    follow(cx);
                    cx.shows(Shown::each::<Leaf>());
                });
            }
            None => {
                let edges = mesh.edges();
                let lines = of
                    .places
                    .iter()
                    .flat_map(|place| edges.iter().map(move |edge| edge.transformed(place)));
                cx.lines(Shared::new(lines.collect()));
            }
        }
        cx.parts_later::<Leaf>(of.places.len(), || rows.make());
        Ok(())
    }
}
