//! What a ray from the camera sees: light on its way back.

use std::f32::consts::{FRAC_1_PI, PI};

use sapwood_geom::Ray32;
use sapwood_geom::glam::Vec3;

use crate::camera::Gaze;
use crate::film::Exposed;
use crate::light::{Beam, cosine_weighted};
use crate::pattern::{Pattern, Use, mixed, unit};
use crate::spot::Spot;
use crate::trace::{Chance, Hit, Met, Passage};
use crate::world::World;
use crate::{Background, Ground, PictureOptions, RayCounts};

/// Surfaces rougher than this mirror nothing sharp.
const MIRROR_UP_TO: f32 = 0.35;

/// How steeply one must look down at the ground to see it without haze.
const HAZE_FROM: f32 = 0.05;

/// What a share of light must come to at least to be followed.
const LEAST: f32 = 0.004;

/// Sees what rays see, and notes what they wait for.
pub(crate) struct Shader<'a> {
    pub(crate) world: &'a World,
    pub(crate) options: &'a PictureOptions,
    pub(crate) gaze: &'a Gaze,
    pub(crate) rays: RayCounts,
    /// Links that rays wait for, as they were met.
    pub(crate) waits: Vec<u32>,
    /// Whether a ray met more than it may.
    pub(crate) is_too_much: bool,
}

/// What a ray meets first.
enum First {
    Nothing,
    Hit(Hit),
    Ground {
        ground: Ground,
        distance: f32,
        /// The share of it that is lost in the haze of the horizon.
        haze: f32,
    },
}

/// One sample of a pixel, on its path after some reflections.
#[derive(Clone, Copy)]
struct Sample<'a> {
    pattern: &'a Pattern,
    index: u32,
    depth: u32,
}

impl Sample<'_> {
    fn pair(&self, purpose: Use) -> [f32; 2] {
        self.pattern.pair(self.index, purpose, self.depth)
    }

    fn chance(&self) -> Chance {
        Chance::of_path(self.pair(Use::Chance)[0])
    }
}

impl Shader<'_> {
    /// What is seen through a pixel, all samples together; nothing where rays wait.
    pub(crate) fn pixel(&mut self, pixel: [u32; 2]) -> Option<Exposed> {
        let n = self.options.samples;
        let pattern = Pattern::new(self.options.seed, pixel, n);
        let mut sum = Some(Exposed::default());
        // What other samples wait for is found in one go.
        for index in 0..n {
            let sample = Sample { pattern: &pattern, index, depth: 0 };
            let seen = self.seen(pixel, sample);
            sum = sum.zip(seen).map(|(sum, seen)| Exposed {
                light: sum.light + seen.light,
                coverage: sum.coverage + seen.coverage,
            });
        }
        sum
    }

    /// What one sample sees.
    fn seen(&mut self, pixel: [u32; 2], mut sample: Sample<'_>) -> Option<Exposed> {
        let [dx, dy] = sample.pair(Use::Pixel);
        let (mut ray, mut reach) = self.gaze.ray(pixel[0] as f32 + dx, pixel[1] as f32 + dy);
        let (mut light, mut share) = (Vec3::ZERO, Vec3::ONE);
        let mut way = 0.0;
        self.rays.primary += 1;
        loop {
            let (distance, spot, haze) = match self.first(&ray, reach, sample)? {
                First::Nothing => {
                    let (beyond, coverage) = self.beyond(ray.direction, sample.depth);
                    return Some(Exposed { light: light + share * beyond, coverage });
                }
                First::Ground { ground, distance, haze } => {
                    (distance, Spot::of_ground(&ground, &ray, distance), haze)
                }
                First::Hit(hit) => {
                    let width = self.gaze.width.at(way + hit.distance);
                    let spot = Spot::new(self.world, self.options, &ray, &hit, width);
                    (hit.distance, spot, 0.0)
                }
            };
            way += distance;
            let lit = self.lit(&spot, -ray.direction, sample)?;
            let seen = lit.lerp(self.options.sky.color(ray.direction), haze);
            light += share * seen;
            share *= mirrored(&spot, -ray.direction) * (1.0 - haze);
            if sample.depth == self.options.most_reflections || share.max_element() < LEAST {
                return Some(Exposed { light, coverage: 1.0 });
            }
            let direction = ray.direction.reflect(spot.shading_normal).normalize();
            if direction.dot(spot.normal) <= 0.0 {
                return Some(Exposed { light, coverage: 1.0 });
            }
            ray = spot.ray(direction);
            reach = f32::INFINITY;
            sample.depth += 1;
            self.rays.reflected += 1;
        }
    }

    /// What a ray meets first, the ground included; nothing where the ray waits.
    fn first(&mut self, ray: &Ray32, reach: f32, sample: Sample<'_>) -> Option<First> {
        let ground = self.options.ground.zip(self.to_ground(ray)).and_then(|(ground, distance)| {
            let is_met = distance < reach;
            let haze = (1.0 + ray.direction.y / HAZE_FROM).clamp(0.0, 1.0);
            is_met.then_some((First::Ground { ground, distance, haze }, distance))
        });
        let before = ground.as_ref().map_or(reach, |(_, distance)| *distance);
        match self.world.nearest(ray, before, sample.chance()) {
            Met::Hit(hit) => Some(First::Hit(hit)),
            Met::Nothing => Some(ground.map_or(First::Nothing, |(ground, _)| ground)),
            Met::Waiting(wait) => {
                self.waits.push(wait);
                None
            }
            Met::TooMuch => {
                self.is_too_much = true;
                None
            }
        }
    }

    /// How far it is along a ray to the ground, from above.
    fn to_ground(&self, ray: &Ray32) -> Option<f32> {
        let distance = (self.options.ground?.height - ray.origin.y) / ray.direction.y;
        (distance > 0.0 && ray.direction.y < 0.0).then_some(distance)
    }

    /// What is seen where nothing is, and whether that covers anything.
    fn beyond(&self, direction: Vec3, depth: u32) -> (Vec3, f32) {
        match self.options.background {
            _ if depth > 0 => (self.options.sky.color(direction), 1.0),
            Background::Sky => (self.options.sky.color(direction), 1.0),
            Background::Color(color) => (Vec3::from(color), 1.0),
            Background::Transparent => (Vec3::ZERO, 0.0),
        }
    }

    /// The light that a spot sends to `viewer`, mirrored light left aside; nothing where rays
    /// wait.
    fn lit(&mut self, spot: &Spot, viewer: Vec3, sample: Sample<'_>) -> Option<Vec3> {
        let matter = &spot.matter;
        let mut light = matter.emissive;
        let mut waits = false;
        let sun = self.options.sun.map(|sun| sun.beam(sample.pair(Use::Sun)));
        let world = self.world;
        let lights = if self.options.lights { &world.lights[..] } else { &[] };
        let lights = lights.iter().filter_map(|light| light.beam(spot.point));
        for (number, beam) in sun.into_iter().chain(lights).enumerate() {
            let share = reflected(spot, viewer, &beam);
            if share.max_element() <= 0.0 {
                continue;
            }
            self.rays.shadow += 1;
            let own = unit(mixed(sample.pair(Use::Chance)[0].to_bits(), number as u32));
            let ray = spot.ray(beam.toward);
            if self.to_ground(&ray).is_some_and(|distance| distance < beam.reach) {
                continue;
            }
            match self.passage(&ray, beam.reach, sample.chance().with(own)) {
                Some(is_clear) => light += if is_clear { share * beam.color } else { Vec3::ZERO },
                None => waits = true,
            }
        }
        let sky = self.sky_light(spot, viewer, sample);
        if waits { None } else { Some(light + sky?) }
    }

    /// The light that a spot gets from one direction of the sky and sends to `viewer`.
    fn sky_light(&mut self, spot: &Spot, viewer: Vec3, sample: Sample<'_>) -> Option<Vec3> {
        let (matter, sky) = (&spot.matter, &self.options.sky);
        let through = sample.pair(Use::Chance)[1] < matter.translucency;
        let side = if through { -spot.shading_normal } else { spot.shading_normal };
        let direction = cosine_weighted(side, sample.pair(Use::Sky));
        // Of the ground comes what falls on it from above.
        let color = match self.options.ground.filter(|_| direction.y < 0.0) {
            Some(ground) => Vec3::from(ground.color) * sky.color(Vec3::Y),
            None => sky.color(direction),
        };
        let mut seen = Vec3::ONE;
        if sky.occlusion_distance > 0.0 {
            self.rays.sky += 1;
            let ray = spot.ray(direction);
            if !self.passage(&ray, sky.occlusion_distance, sample.chance())? {
                seen = matter.color * sky.bounce;
            }
        }
        let diffuse = matter.color * (1.0 - matter.metallic);
        // What is too rough to mirror anything sharp still shines a little.
        let glossy =
            (1.0 - matter.roughness) * f32::from(u8::from(matter.roughness > MIRROR_UP_TO));
        let mirrored = viewer.reflect(spot.shading_normal) * -1.0;
        let gloss = fresnel(spot, viewer) * glossy * sky.color(mirrored);
        Some((diffuse * color + gloss) * seen)
    }

    /// Whether a ray passes; nothing where it waits.
    fn passage(&mut self, ray: &Ray32, reach: f32, chance: Chance) -> Option<bool> {
        match self.world.passage(ray, reach, chance) {
            Passage::Clear => Some(true),
            Passage::Stopped => Some(false),
            Passage::Waiting(wait) => {
                self.waits.push(wait);
                None
            }
            Passage::TooMuch => {
                self.is_too_much = true;
                None
            }
        }
    }
}

/// The share of a beam that a spot sends to `viewer`, if nothing is in the beam's way.
fn reflected(spot: &Spot, viewer: Vec3, beam: &Beam) -> Vec3 {
    let matter = &spot.matter;
    let slope = spot.shading_normal.dot(beam.toward);
    let diffuse = matter.color * ((1.0 - matter.metallic) * FRAC_1_PI);
    if slope <= 0.0 {
        return diffuse * (matter.translucency * -slope);
    }
    let scattered = diffuse * (1.0 - matter.translucency);
    (scattered + highlight(spot, viewer, beam.toward)) * slope
}

/// The highlight of a rough surface: microfacets after Trowbridge and Reitz, masked after Smith,
/// as glTF's specification has them.
fn highlight(spot: &Spot, viewer: Vec3, toward: Vec3) -> Vec3 {
    let normal = spot.shading_normal;
    let (to_light, to_viewer) = (normal.dot(toward), normal.dot(viewer));
    let Some(half) = (toward + viewer).try_normalize() else { return Vec3::ZERO };
    if to_light <= 0.0 || to_viewer <= 0.0 {
        return Vec3::ZERO;
    }
    let roughness = spot.matter.roughness.clamp(0.04, 1.0);
    let square = roughness * roughness * roughness * roughness;
    let to_half = normal.dot(half).clamp(0.0, 1.0);
    let bump = to_half * to_half * (square - 1.0) + 1.0;
    let spread = square / (PI * bump * bump);
    let masked =
        |slope: f32, other: f32| other * libm::sqrtf(slope * slope * (1.0 - square) + square);
    let visible = 0.5 / (masked(to_light, to_viewer) + masked(to_viewer, to_light)).max(1e-6);
    schlick(spot, viewer.dot(half)) * (spread * visible)
}

/// How much is mirrored at a slope (C. Schlick: "An Inexpensive BRDF Model for Physically-based
/// Rendering", 1994).
fn schlick(spot: &Spot, slope: f32) -> Vec3 {
    let matter = &spot.matter;
    let straight = Vec3::splat(0.04).lerp(matter.color, matter.metallic);
    let flat = 1.0 - slope.clamp(0.0, 1.0);
    straight + (Vec3::ONE - straight) * (flat * flat * flat * flat * flat)
}

fn fresnel(spot: &Spot, viewer: Vec3) -> Vec3 {
    schlick(spot, spot.shading_normal.dot(viewer))
}

/// The share of light that a spot mirrors sharply to `viewer`.
fn mirrored(spot: &Spot, viewer: Vec3) -> Vec3 {
    let roughness = spot.matter.roughness;
    if roughness > MIRROR_UP_TO {
        return Vec3::ZERO;
    }
    fresnel(spot, viewer) * (1.0 - roughness / MIRROR_UP_TO)
}
