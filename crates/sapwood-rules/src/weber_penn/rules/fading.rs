//! Trees of which less is drawn the further away they are.
//!
//! Geometry is made once, in an order that thins evenly, and the walk moves its limits by the eye's
//! distance. At a fixed range only what is left there is made.

use std::sync::Arc;

use glam::{Affine3, Vec3};
use sapwood_geom::{Shared, SharedMesh};
use sapwood_graph::{DrawRange, Fading, Falloff, Shown};
use sapwood_scene::{Context, Rule, RuleError, Style, StyleSlot};

use super::super::fading::{SelfFading, evenly_ordered_bands, evenly_ordered_leaves, leaf_point};
use super::super::geometry::banded_surface;
use super::super::slots::{
    BarkLookSlot, BarkSlot, CrownSlot, DetailSlot, FadingSlot, FoliageSlot, LeafLookSlot,
    LeafTargetSlot, LeavesSlot,
};
use super::super::{FadingItem, FadingParams, Leaf, Leaves, Stem, StemSurface, leaves};
use super::geometry::{LeavesRule, StemSurfaceRule, material, placed, trunk_form};

/// Compiles stems into tubes that give way to lines.
pub(super) struct FadingSurfaceRule;

impl Rule for FadingSurfaceRule {
    type Component = StemSurface;
    type Data = SelfFading;
    const NAME: &'static str = "weber_penn.fading_surface";

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<SelfFading, RuleError> {
        if *cx.read::<StyleSlot>() != Style::Solid {
            return StemSurfaceRule.init(of, cx).map(|_| SelfFading);
        }
        let params = cx.read::<FadingSlot>();
        let level = of.stems.stems.first().map_or(0, |stem| stem.seed.level);
        let item = FadingItem::of_level(level);
        let (polygons, lines) = (item.polygons(&params), item.lines(&params));
        if is_gone(&params, [&polygons, &lines]) {
            return Ok(SelfFading);
        }
        let detail = cx.read::<DetailSlot>();
        let look = cx.read::<BarkLookSlot>();
        let (bark, _) = material::<BarkSlot>(|| look.material(level, &detail), cx)?;
        let form = trunk_form(of, cx);
        let charge = |triangles| cx.reserve_triangles(triangles as u64);
        let (mesh, bands) = banded_surface(&of.stems, &form, &detail, look.width, charge)?;
        if mesh.is_empty() {
            return Ok(SelfFading);
        }
        let ordered = evenly_ordered_bands(mesh, &bands, item);
        let (ends, mass) = (Shared::new(ordered.ends), item.mass());
        let fading =
            |shown, replaced, ends| Fading { shown, replaced, mass, ends, keeps_coverage: false };
        let tubes = fading(polygons.clone(), Falloff::default(), Some(ends.clone()));
        // A line inside its tube could only be seen where the tube is thinner than a line is drawn.
        let lines = fading(lines, polygons, None);
        let stems: Arc<[u32]> = ordered.stems.into();
        let Some(range) = params.fixed_range else {
            cx.fading(tubes, |cx| {
                cx.mesh(SharedMesh::new(ordered.mesh), bark);
                cx.shows(Shown::rows::<Stem>(ends.to_vec(), Arc::clone(&stems)));
            });
            cx.fading(lines, |cx| {
                let each: Vec<u32> = (1..=stems.len() as u32).collect();
                cx.lines(Shared::new(ordered.lines));
                cx.shows(Shown::rows::<Stem>(each, Arc::clone(&stems)));
            });
            return Ok(SelfFading);
        };
        let drawn = tubes.drawn(ordered.mesh.n_triangles() as u32, range);
        if !drawn.is_empty() {
            let n_bands = ends.partition_point(|end| *end <= drawn.end);
            cx.mesh(SharedMesh::new(ordered.mesh.part(drawn.numbers())), bark);
            cx.shows(Shown::rows::<Stem>(ends[..n_bands].to_vec(), stems[..n_bands].to_vec()));
        }
        let drawn = lines.drawn(stems.len() as u32, range);
        if !drawn.is_empty() {
            let each: Vec<u32> = (1..=drawn.len()).collect();
            cx.lines(Shared::new(drawn.of(&ordered.lines).to_vec()));
            cx.shows(Shown::rows::<Stem>(each, drawn.of(&stems).to_vec()));
        }
        Ok(SelfFading)
    }
}

/// Whether nothing is left at the range that is fixed, if one is.
fn is_gone(params: &FadingParams, falloffs: [&Falloff; 2]) -> bool {
    let share = |range| falloffs.iter().map(move |falloff| falloff.share(range));
    params.fixed_range.is_some_and(|range| share(range).all(|share| share == 0.0))
}

/// Compiles leaves into instances of a polygon that give way to instances of a triangle.
#[derive(Default)]
pub(super) struct FadingLeavesRule(LeavesRule);

impl Rule for FadingLeavesRule {
    type Component = Leaves;
    type Data = SelfFading;
    const NAME: &'static str = "weber_penn.fading_leaves";

    fn init(&self, on: &Leaves, cx: &mut Context<'_>) -> Result<SelfFading, RuleError> {
        if *cx.read::<StyleSlot>() != Style::Solid {
            return self.0.init(on, cx).map(|()| SelfFading);
        }
        let crown = cx.read::<CrownSlot>();
        let params = cx.read::<LeavesSlot>();
        let detail = cx.read::<DetailSlot>();
        let target = cx.read::<LeafTargetSlot>();
        let fading = cx.read::<FadingSlot>();
        let look = cx.read::<LeafLookSlot>();
        let (foliage, is_own) = material::<FoliageSlot>(|| look.material(&detail), cx)?;
        let mesh = self.0.mesh(params.shape, is_own.then_some(look.outline));
        let point = SharedMesh::new(leaf_point(params.shape));
        let params = params.thinned(detail.leaves);
        let n_triangles = mesh.n_triangles() as u64 + 1;
        let mut charge = |leaves: usize| {
            cx.reserve_parts(leaves as u64)?;
            cx.reserve_triangles(leaves as u64 * n_triangles)
        };
        let leaves = leaves(&on.stems, &crown, &params, &target, &mut charge)?;
        if leaves.is_empty() {
            return Ok(SelfFading);
        }
        let leaves = evenly_ordered_leaves(&leaves);
        let transforms: Vec<_> = leaves.iter().map(placed).collect();
        let item = FadingItem::Leaves;
        let (polygons, points) = (item.polygons(&fading), item.lines(&fading));
        let whole = Fading {
            shown: polygons.clone(),
            replaced: Falloff::default(),
            mass: item.mass(),
            ends: None,
            keeps_coverage: false,
        };
        let keeps_coverage = fading.keeps_coverage;
        let points = Fading { shown: points, replaced: polygons, keeps_coverage, ..whole.clone() };
        let both = [(whole, mesh), (points, point)];
        match fading.fixed_range {
            None => {
                let transforms = Shared::new(transforms);
                for (fading, mesh) in both {
                    cx.fading(fading, |cx| {
                        cx.instances(mesh, Arc::clone(&foliage), transforms.clone());
                        cx.shows(Shown::each::<Leaf>());
                    });
                }
            }
            Some(range) => {
                for (fading, mesh) in both {
                    let drawn = fading.drawn(transforms.len() as u32, range);
                    if drawn.is_empty() {
                        continue;
                    }
                    let DrawRange { first, end } = drawn;
                    let growth = Affine3::from_scale(Vec3::splat(fading.growth(range)));
                    let left = drawn.of(&transforms).iter().map(|place| *place * growth);
                    cx.instances(mesh, Arc::clone(&foliage), Shared::new(left.collect()));
                    let each: Vec<u32> = (1..=drawn.len()).collect();
                    let rows: Vec<u32> = (first..end).collect();
                    cx.shows(Shown::rows::<Leaf>(each, rows));
                }
            }
        }
        cx.parts::<Leaf>(leaves);
        Ok(SelfFading)
    }
}
