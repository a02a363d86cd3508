//! What trees look like: surfaces of stems, and leaves as instances.

use std::convert::Infallible;
use std::sync::Arc;

use glam::{Affine3, Quat, Vec3};
use sapwood_geom::{Content, Digester, Mesh, Shared, SharedMesh, content};
use sapwood_graph::{Material, Offers, Shown, Solids};
use sapwood_images::PaintedMaterial;
use sapwood_scene::{Context, Held, MaterialSlot, Rule, RuleError, Slot, Style, StyleSlot};

use super::super::fading::{leaf_point, point_for};
use super::super::geometry::{
    Rounding, ends_of_leaves, for_vertices, is_closed, rounded_leaves, segmented_surface,
};
use super::super::growth::leaves_at;
use super::super::look::BESIDE_MIDRIB;
use super::super::slots::{
    BarkLookSlot, BarkSlot, CrownSlot, DetailSlot, FoliageSlot, LeafLookSlot, LevelDetailSlot,
    TrunkFormSlot,
};
use super::super::{
    Crown, Detail, Leaf, LeafModel, LeafParams, LeafShape, LeafSurface, LevelDetail, Species, Stem,
    StemSurface, Stems, TrunkForm, closed_stems, leaf_card, leaf_mesh,
};
use super::leaves::LeavesOnLevel;
use super::skeleton::draw_stem_lines;
use super::structure::level;
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
        let detail = stem_detail(cx);
        let look = cx.read::<BarkLookSlot>();
        let bark = if style == Style::Solid {
            let level = of.stems.stems.first().map_or(0, |stem| stem.seed.level);
            let own = || look.material(level, &detail);
            Some(material::<BarkSlot, _>(own, cx)?.0)
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

/// How finely stems are meshed, as the view and the species say.
pub(super) fn stem_detail(cx: &mut Context<'_>) -> Arc<Detail> {
    let detail = cx.read::<DetailSlot>();
    let wished = cx.read::<LevelDetailSlot>();
    if *wished == [LevelDetail::default(); 4] {
        return detail;
    }
    let mut levels = detail.levels;
    for (level, wished) in levels.iter_mut().zip(wished.iter()) {
        // What the view says goes first.
        level.sides = level.sides.or(wished.sides);
        level.segments = level.segments.or(wished.segments);
    }
    Arc::new(Detail { levels, ..Detail::clone(&detail) })
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
pub(super) fn material<S: Slot<Value = Option<Material>, Rate = Held>, O: Into<Own>>(
    own: impl FnOnce() -> O,
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
        None => match own().into() {
            Own::Painted(own) => Ok((Arc::clone(cx.ingredient::<Arc<Material>>(own)?), true)),
            Own::Given(own) => Ok((own, true)),
        },
    }
}

/// A species' own material.
pub(super) enum Own {
    /// One that images are to be painted for.
    Painted(PaintedMaterial),
    /// One that is there already.
    Given(Arc<Material>),
}

impl From<PaintedMaterial> for Own {
    fn from(painted: PaintedMaterial) -> Self {
        Self::Painted(painted)
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
    /// Whether it is a body and no sheet.
    pub(super) is_closed: bool,
}

content!(LeafMeshes { whole, point, is_closed });

impl LeafMeshes {
    /// Whether either side of a leaf may be turned outward: of bodies, and of what has one side
    /// alone, the other would be seen from within.
    pub(super) fn turn_with(&self, foliage: &Material) -> bool {
        !self.is_closed && foliage.double_sided
    }
}

impl Rule for LeafModelRule {
    type Component = LeafModel;
    type Data = LeafMeshes;
    const NAME: &'static str = "weber_penn.leaf_model";

    fn init(&self, leaf: &LeafModel, _: &mut Context<'_>) -> Result<LeafMeshes, RuleError> {
        let &LeafModel { shape, outline, ref mesh, spot, length, width, petiole } = leaf;
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
        if let Some(mesh) = mesh {
            let is_closed = is_closed(mesh);
            let point = sized(&point_for(mesh, is_closed, spot));
            return Ok(LeafMeshes { whole: sized(mesh), point, is_closed });
        }
        let whole = outline.map_or_else(|| leaf_mesh(shape), |outline| leaf_card(shape, outline));
        let (point, is_closed) = (sized(&leaf_point(shape)), shape == LeafShape::Sphere);
        Ok(LeafMeshes { whole: sized(&whole), point, is_closed })
    }
}

/// What leaves are drawn with, as the style asks for it.
pub(super) struct LeafDress<'a> {
    pub(super) meshes: &'a LeafMeshes,
    /// Nothing where edges are drawn.
    pub(super) foliage: Option<Arc<Material>>,
    /// How their normals follow the crown, where they do.
    pub(super) rounding: Option<Rounding>,
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
    let level = of.stems.stems.first().map_or(0, |stem| stem.seed.level);
    let params = cx.project(LeavesOnLevel { level });
    let mut roundness = 0.0;
    let (foliage, worn) = if style == Style::Solid {
        let look = cx.read::<LeafLookSlot>();
        let own = || match &look.own {
            Some(own) => Own::Given(Arc::clone(own)),
            None => look.material(&detail).into(),
        };
        let (foliage, is_own) = material::<FoliageSlot, _>(own, cx)?;
        roundness = look.roundness;
        (Some(foliage), is_own.then_some(look))
    } else {
        (None, None)
    };
    let (length, width, petiole) = (params.length(), params.width(), params.petiole());
    let model = LeafModel {
        shape: params.shape,
        outline: worn.as_ref().and_then(|look| look.outline_of_shape()),
        mesh: params.mesh.clone().or_else(|| worn.as_ref().and_then(|look| look.card.clone())),
        spot: worn.map_or(BESIDE_MIDRIB, |look| look.spot),
        length,
        width,
        petiole,
    };
    let meshes = cx.ingredient::<LeafMeshes>(model)?;
    let rounding = (roundness > 0.0).then(|| rounding(roundness, of, &crown, cx));
    Ok(LeafDress { meshes, foliage, rounding, rows: LeafRows { of: of.clone(), crown, params } })
}

/// How normals of leaves follow the crown that their tree is likely to have.
fn rounding(share: f32, of: &LeafSurface, crown: &Crown, cx: &mut Context<'_>) -> Rounding {
    let scale_tree = of.stems.stems.first().map_or(crown.scale, |stem| stem.seed.scale_tree);
    let levels = [level(cx, 0), level(cx, 1)];
    Rounding::new(share, scale_tree, crown, levels.each_ref().map(|level| &**level))
}

/// Leaves that are written out one by one: their mesh, what they show, and what each of their
/// vertices follows of what each leaf does.
pub(super) struct WrittenLeaves {
    mesh: SharedMesh,
    /// The number behind the last triangle of each.
    ends: Vec<u32>,
    /// The first of their parts.
    first: u32,
    follows: Option<Vec<u32>>,
}

impl WrittenLeaves {
    /// Leaves of these meshes at these places, with their normals rounded.
    pub(super) fn new(
        leaf: &Mesh,
        turns: bool,
        places: &[Affine3],
        rounding: &Rounding,
        segments: Option<&[u32]>,
    ) -> Self {
        Self {
            mesh: SharedMesh::new(rounded_leaves(leaf, turns, places, rounding)),
            ends: ends_of_leaves(leaf, places.len()),
            first: 0,
            follows: segments.map(|segments| for_vertices(leaf, segments)),
        }
    }

    /// The same leaves, known by the rows of the parts from `first` on.
    pub(super) fn starting(self, first: u32) -> Self {
        Self { first, ..self }
    }

    /// Draws them; `around` may put something around the mesh.
    pub(super) fn draw(
        self,
        carried: Option<Carried>,
        foliage: &Arc<Material>,
        cx: &mut Context<'_>,
        around: impl FnOnce(&mut Context<'_>, &mut dyn FnMut(&mut Context<'_>)),
    ) {
        let Self { mesh, ends, first, follows } = self;
        let shown = match first {
            0 => Shown::spans::<Leaf>(ends),
            first => {
                let rows: Vec<u32> = (first..first + ends.len() as u32).collect();
                Shown::rows::<Leaf>(ends, rows)
            }
        };
        Carried::sway(carried, follows, cx, |cx, follow| {
            around(cx, &mut |cx| {
                cx.mesh(mesh.clone(), Arc::clone(foliage));
                follow(cx);
                cx.shows(shown.clone());
            });
        });
    }
}

/// Compiles leaves into instances of one mesh, or what else the style asks for.
pub(super) struct LeafSurfaceRule;

impl Rule for LeafSurfaceRule {
    type Component = LeafSurface;
    type Data = ();
    const NAME: &'static str = "weber_penn.leaf_surface";

    fn init(&self, of: &LeafSurface, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let LeafDress { meshes, foliage, rounding, rows } = leaf_dress(of, cx)?;
        let mesh = meshes.whole.clone();
        cx.reserve_triangles((of.places.len() * mesh.n_triangles()) as u64)?;
        match (foliage, rounding) {
            (Some(foliage), Some(rounding)) => {
                let carried = Carried::of(&of.stems, true, cx);
                let segments = carried.is_some().then(|| segments_of(of));
                let (turns, segments) = (meshes.turn_with(&foliage), segments.as_deref());
                let written = WrittenLeaves::new(&mesh, turns, &of.places, &rounding, segments);
                written.draw(carried, &foliage, cx, |cx, draw| draw(cx));
            }
            (Some(foliage), None) => {
                let carried = Carried::of(&of.stems, true, cx);
                let segments = carried.is_some().then(|| segments_of(of));
                Carried::sway(carried, segments, cx, |cx, follow| {
                    cx.instances(mesh, foliage, of.places.clone());
                    follow(cx);
                    cx.shows(Shown::each::<Leaf>());
                });
            }
            (None, _) => {
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
