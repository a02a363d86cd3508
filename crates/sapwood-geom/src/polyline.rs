//! Polylines with radii: what a stem looks like without its surface.

use glam::{Affine3, Vec3};

use crate::{Bound, Content, Digester};

/// A line through points, with a radius at each of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// Points in metres, from base to tip.
    pub points: Vec<Vec3>,
    /// The radius in metres at each point.
    pub radii: Vec<f32>,
}

impl Polyline {
    /// The bound of the points; radii do not count, for a line has no thickness.
    pub fn bound(&self) -> Bound {
        Bound::of_points(self.points.iter().copied())
    }

    /// The line after `transform`; radii stay as they are.
    pub fn transformed(&self, transform: &Affine3) -> Self {
        let points = self.points.iter().map(|point| transform.transform_point3(*point));
        Self { points: points.collect(), radii: self.radii.clone() }
    }

    /// What is wrong with the line, in words, or nothing: a radius for each point, all finite,
    /// no radius below zero.
    pub fn fault(&self) -> Option<String> {
        let (n, n_radii) = (self.points.len(), self.radii.len());
        if n != n_radii {
            return Some(format!("{n} points with {n_radii} radii"));
        }
        let mut points = self.points.iter().zip(&self.radii).enumerate();
        points.find_map(|(i, (point, radius))| {
            let is_sound = point.is_finite() && radius.is_finite() && *radius >= 0.0;
            (!is_sound).then(|| format!("point {i}: {point} with radius {radius}"))
        })
    }
}

impl Content for Polyline {
    fn write(&self, digester: &mut Digester) {
        self.points.write(digester);
        self.radii.write(digester);
    }
}
