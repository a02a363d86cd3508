//! What was grown, as one JSON object. The keys are a promise to scripts: they stay.

use std::collections::BTreeMap;

use sapwood::geom::Aabb;
use serde::Serialize;

use super::billboard::Light;
use super::summary::{Phase, Summary};
use crate::arguments::{Detail, GrowArguments, Individual};
use crate::picture::TollDocument;

/// The object; the README tells what its keys mean.
#[derive(Debug, Serialize)]
struct Document<'a> {
    species: &'a str,
    seed: Option<u64>,
    at: Option<[f32; 3]>,
    detail: &'static str,
    quality: f32,
    prune: Vec<String>,
    prune_ratio: Option<f32>,
    range: Option<f32>,
    billboard: Option<&'static str>,
    wind: Option<Windy>,
    components: BTreeMap<&'static str, u64>,
    stems: &'a [u64],
    segments: u64,
    leaves: Option<u64>,
    vertices: Option<u64>,
    triangles: Option<u64>,
    weld: Option<Welded>,
    bounds: Option<Bounds>,
    seconds: BTreeMap<&'a str, f64>,
    outputs: Vec<Written<'a>>,
    picture: Option<TollDocument>,
}

#[derive(Debug, Serialize)]
struct Windy {
    speed: f32,
    gust: f32,
    joints: Option<usize>,
    rigid_joints: Option<usize>,
}

#[derive(Debug, Serialize)]
struct Welded {
    stems: usize,
    triangles: u64,
    components: usize,
    volume: f64,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

#[derive(Debug, Serialize)]
struct Written<'a> {
    path: &'a str,
    bytes: u64,
    seconds: f64,
}

/// The object, on one line.
pub(super) fn json(summary: &Summary, arguments: &GrowArguments) -> String {
    let Summary { species, census, surfaces, welded, bounds, phases, components, picture, .. } =
        summary;
    let swayed = summary.swayed;
    let (seed, at) = match arguments.individual.individual() {
        Individual::Seed(seed) => (Some(seed), None),
        Individual::At(place) => (None, Some(place)),
    };
    let seconds = |phase: &Phase| phase.time.as_secs_f64();
    let (outputs, steps): (Vec<_>, Vec<_>) = phases.iter().partition(|phase| phase.bytes.is_some());
    let document = Document {
        species,
        seed,
        at,
        detail: match arguments.tree.detail {
            Detail::Full => "full",
            Detail::Draft => "draft",
            Detail::Segments => "segments",
            Detail::Skeleton => "skeleton",
        },
        quality: arguments.tree.quality,
        prune: arguments.tree.prune.iter().map(ToString::to_string).collect(),
        prune_ratio: arguments.tree.prune_ratio,
        range: arguments.range,
        billboard: arguments.billboard.map(Light::name),
        wind: arguments.wind.wind.map(|wind| Windy {
            speed: wind.speed,
            gust: wind.gust,
            joints: swayed.map(|swayed| swayed.n_joints),
            rigid_joints: swayed.map(|swayed| swayed.n_rigid),
        }),
        components: components.iter().map(|(kind, n)| (kind.name(), *n)).collect(),
        stems: &census.stems,
        segments: census.segments,
        leaves: surfaces.map(|_| census.leaves),
        vertices: surfaces.map(|(vertices, _)| vertices),
        triangles: surfaces.map(|(_, triangles)| triangles),
        weld: welded.as_ref().map(|welded| Welded {
            stems: welded.n_solids,
            triangles: welded.n_triangles,
            components: welded.checked.components,
            volume: welded.checked.volume,
        }),
        bounds: (!bounds.is_empty()).then(|| bounds_of(bounds)),
        seconds: steps.iter().map(|phase| (phase.name.as_str(), seconds(phase))).collect(),
        outputs: outputs
            .iter()
            .map(|phase| Written {
                path: &phase.name,
                bytes: phase.bytes.unwrap_or(0),
                seconds: seconds(phase),
            })
            .collect(),
        picture: picture.as_ref().map(TollDocument::from),
    };
    serde_json::to_string(&document).expect("texts and finite numbers are JSON")
}

fn bounds_of(bounds: &Aabb) -> Bounds {
    Bounds { min: bounds.min.to_array(), max: bounds.max.to_array() }
}
