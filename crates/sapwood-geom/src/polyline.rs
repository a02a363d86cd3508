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
}

impl Content for Polyline {
    fn write(&self, digester: &mut Digester) {
        self.points.write(digester);
        self.radii.write(digester);
    }
}
