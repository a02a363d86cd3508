//! Trees of which less is drawn the further away they are.
//!
//! Geometry is made once, in an order that thins evenly, and the walk moves its limits by the eye's
//! distance. At a fixed range only what is left there is made.

use std::sync::Arc;

use glam::{Affine3, Vec3};
use sapwood_geom::{Shared, SharedMesh};
use sapwood_graph::{DrawRange, Fading, Falloff, Shown};
use sapwood_scene::{Context, Rule, RuleError, Style, StyleSlot};

use super::super::fading::{SelfFading, evenly_ordered_bands, evenly_ordered_leaves};
use super::super::geometry::{banded_surface, ends_of_leaves};
use super::super::slots::{BarkLookSlot, BarkSlot, FadingSlot};
use super::super::{FadingItem, FadingParams, Leaf, LeafSurface, Stem, StemSurface};
use super::geometry::{
    LeafDress, LeafSurfaceRule, StemSurfaceRule, WrittenLeaves, leaf_dress, material, stem_detail,
    trunk_form,
};
use super::swaying::{Carried, segments_of};

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
        let detail = stem_detail(cx);
        let look = cx.read::<BarkLookSlot>();
        let (bark, _) = material::<BarkSlot, _>(|| look.material(level, &detail), cx)?;
        let form = trunk_form(of, cx);
        // What is compiled for a range is not moved.
        let carried = Carried::of(&of.stems, params.fixed_range.is_none(), cx);
        let mut segments = carried.is_some().then(Vec::new);
        let charge = |triangles| cx.reserve_triangles(triangles as u64);
        let (mesh, bands) =
            banded_surface(&of.stems, &form, &detail, look.width, charge, segments.as_mut())?;
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
        let line_bark = Arc::clone(&bark);
        let Some(range) = params.fixed_range else {
            Carried::sway(carried, segments, cx, |cx, follow| {
                cx.fading(tubes, |cx| {
                    cx.mesh(SharedMesh::new(ordered.mesh), bark);
                    follow(cx);
                    cx.shows(Shown::rows::<Stem>(ends.to_vec(), Arc::clone(&stems)));
                });
            });
            cx.fading(lines, |cx| {
                let each: Vec<u32> = (1..=stems.len() as u32).collect();
                cx.lines_of(Shared::new(ordered.lines), line_bark);
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
            cx.lines_of(Shared::new(drawn.of(&ordered.lines).to_vec()), line_bark);
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
pub(super) struct FadingLeavesRule;

impl Rule for FadingLeavesRule {
    type Component = LeafSurface;
    type Data = SelfFading;
    const NAME: &'static str = "weber_penn.fading_leaves";

    fn init(&self, of: &LeafSurface, cx: &mut Context<'_>) -> Result<SelfFading, RuleError> {
        if *cx.read::<StyleSlot>() != Style::Solid {
            return LeafSurfaceRule.init(of, cx).map(|()| SelfFading);
        }
        let LeafDress { meshes, foliage, rounding, rows } = leaf_dress(of, cx)?;
        let Some(foliage) = foliage else { return Ok(SelfFading) };
        let (mesh, point) = (meshes.whole.clone(), meshes.point.clone());
        let fading = cx.read::<FadingSlot>();
        let n_triangles = mesh.n_triangles() + point.n_triangles();
        cx.reserve_triangles((of.places.len() * n_triangles) as u64)?;
        let transforms = evenly_ordered_leaves(&of.places);
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
        match (fading.fixed_range, rounding) {
            (range, Some(rounding)) => {
                let carried = Carried::of(&of.stems, range.is_none(), cx);
                let segments = carried.is_some().then(|| evenly_ordered_leaves(&segments_of(of)));
                for (fading, mesh) in both {
                    let segments = segments.as_deref();
                    let turns = meshes.turn_with(&foliage);
                    let write = |places: &[Affine3]| {
                        WrittenLeaves::new(&mesh, turns, places, &rounding, segments)
                    };
                    let Some(range) = range else {
                        let ends = ends_of_leaves(&mesh, transforms.len());
                        let fading = Fading { ends: Some(Shared::new(ends)), ..fading };
                        write(&transforms).draw(carried.clone(), &foliage, cx, |cx, draw| {
                            cx.fading(fading, |cx| draw(cx));
                        });
                        continue;
                    };
                    let drawn = fading.drawn(transforms.len() as u32, range);
                    let growth = Affine3::from_scale(Vec3::splat(fading.growth(range)));
                    let left = drawn.of(&transforms).iter().map(|place| *place * growth);
                    let left: Vec<Affine3> = left.collect();
                    if !left.is_empty() {
                        let first = drawn.first;
                        write(&left).starting(first).draw(None, &foliage, cx, |cx, draw| draw(cx));
                    }
                }
            }
            (None, None) => {
                let transforms = Shared::new(transforms);
                let carried = Carried::of(&of.stems, true, cx);
                let segments = carried.is_some().then(|| evenly_ordered_leaves(&segments_of(of)));
                Carried::sway(carried, segments, cx, |cx, follow| {
                    for (fading, mesh) in both {
                        cx.fading(fading, |cx| {
                            cx.instances(mesh, Arc::clone(&foliage), transforms.clone());
                            follow(cx);
                            cx.shows(Shown::each::<Leaf>());
                        });
                    }
                });
            }
            (Some(range), None) => {
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
        cx.parts_later::<Leaf>(of.places.len(), || evenly_ordered_leaves(&rows.make()));
        Ok(SelfFading)
    }
}
