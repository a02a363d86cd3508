//! Where light comes from.

use std::f32::consts::TAU;

use sapwood_geom::glam::Vec3;
use sapwood_graph::LightShape;

use crate::world::PlacedLight;
use crate::{Sky, Sun};

/// Light that falls on a point from one direction.
pub(crate) struct Beam {
    /// Where it comes from, with unit length.
    pub(crate) toward: Vec3,
    /// How far away its source is.
    pub(crate) reach: f32,
    /// Its colour on a surface square to it.
    pub(crate) color: Vec3,
}

impl Sky {
    /// A sky that looks alike in all directions; things keep its light from each other as the
    /// default's.
    pub fn even(color: [f32; 3]) -> Self {
        Self { zenith: color, horizon: color, nadir: color, ..Self::default() }
    }

    /// What is seen of the sky in a direction of unit length.
    pub(crate) fn color(&self, direction: Vec3) -> Vec3 {
        let horizon = Vec3::from(self.horizon);
        if direction.y >= 0.0 {
            horizon.lerp(Vec3::from(self.zenith), libm::sqrtf(direction.y))
        } else {
            horizon.lerp(Vec3::from(self.nadir), (-4.0 * direction.y).min(1.0))
        }
    }
}

impl Sun {
    /// Light from a point of the sun, which two numbers in [0, 1) choose.
    pub(crate) fn beam(&self, chosen: [f32; 2]) -> Beam {
        let axis = self.toward.normalize();
        let away = self.radius * libm::sqrtf(chosen[0]);
        let (across, up) = axis.any_orthonormal_pair();
        let (sine, cosine) = libm::sincosf(TAU * chosen[1]);
        let toward = axis + (across * cosine + up * sine) * libm::tanf(away);
        Beam { toward: toward.normalize(), reach: f32::INFINITY, color: Vec3::from(self.color) }
    }
}

impl PlacedLight {
    /// The light that falls on a point where nothing is in its way; nothing outside its range
    /// or cone. Falls off as glTF's lights do.
    pub(crate) fn beam(&self, point: Vec3) -> Option<Beam> {
        let light = &self.light;
        let color = Vec3::from(light.color) * light.intensity;
        let (range, cone) = match light.shape {
            LightShape::Directional => {
                return Some(Beam { toward: -self.axis(), reach: f32::INFINITY, color });
            }
            LightShape::Point { range } => (range, None),
            LightShape::Spot { range, inner, outer } => (range, Some((inner, outer))),
        };
        let way = self.origin() - point;
        let distance = way.length();
        let toward = way.try_normalize()?;
        let within = range.map_or(1.0, |range| {
            let share = distance / range;
            (1.0 - share * share * share * share).clamp(0.0, 1.0)
        });
        let inside = cone.map_or(1.0, |(inner, outer)| {
            let (inner, outer) = (libm::cosf(inner), libm::cosf(outer));
            let share = ((-toward).dot(self.axis()) - outer) / (inner - outer).max(1e-3);
            let share = share.clamp(0.0, 1.0);
            share * share
        });
        let color = color * (within * inside / (distance * distance));
        let is_lit = color.is_finite() && color.max_element() > 0.0;
        is_lit.then_some(Beam { toward, reach: distance, color })
    }
}

/// A direction on the side of `normal`, the likelier the steeper, chosen by two numbers in
/// [0, 1).
pub(crate) fn cosine_weighted(normal: Vec3, chosen: [f32; 2]) -> Vec3 {
    let away = libm::sqrtf(chosen[0]);
    let (across, up) = normal.any_orthonormal_pair();
    let (sine, cosine) = libm::sincosf(TAU * chosen[1]);
    let height = libm::sqrtf((1.0 - chosen[0]).max(0.0));
    (across * (away * cosine) + up * (away * sine) + normal * height).normalize_or(normal)
}

#[cfg(test)]
mod tests {
    use sapwood_geom::glam::Affine3;
    use sapwood_graph::Light;

    use super::*;

    fn lit(shape: LightShape, point: Vec3) -> f32 {
        let light = Light { name: String::new(), color: [1.0; 3], intensity: 8.0, shape };
        let world = Affine3::from_translation(Vec3::Z * 2.0);
        PlacedLight { light, world }.beam(point).map_or(0.0, |beam| beam.color.x)
    }

    #[test]
    fn lights_fall_off() {
        assert_eq!(lit(LightShape::Directional, Vec3::X), 8.0);
        assert_eq!(lit(LightShape::Point { range: None }, Vec3::ZERO), 2.0);
        assert_eq!(lit(LightShape::Point { range: Some(2.0) }, Vec3::ZERO), 0.0);
        let spot = LightShape::Spot { range: None, inner: 0.1, outer: 0.2 };
        assert_eq!(lit(spot, Vec3::ZERO), 2.0);
        assert_eq!(lit(spot, Vec3::X), 0.0);
        // Behind it.
        assert_eq!(lit(spot, Vec3::Z * 4.0), 0.0);
    }

    #[test]
    fn the_sun_is_as_wide_as_it_is_said_to_be() {
        let sun = Sun { toward: Vec3::Y * 3.0, radius: 0.1, ..Sun::default() };
        let mut widest = 0.0f32;
        for i in 0..64 {
            let beam = sun.beam([i as f32 / 64.0, 0.3]);
            widest = widest.max(beam.toward.angle_between(Vec3::Y));
        }
        assert!((0.098..0.1001).contains(&widest), "{widest}");
    }

    #[test]
    fn directions_of_the_sky_are_weighted_by_their_steepness() {
        let n = 32;
        let mean = (0..n * n)
            .map(|i| [(i / n) as f32 + 0.5, (i % n) as f32 + 0.5].map(|x| x / n as f32))
            .map(|chosen| cosine_weighted(Vec3::NEG_X, chosen).dot(Vec3::NEG_X))
            .sum::<f32>();
        assert!((mean / (n * n) as f32 - 2.0 / 3.0).abs() < 1e-3);
    }
}
