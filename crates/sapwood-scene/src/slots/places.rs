//! Projections of where a component stands.

use sapwood_geom::glam::Vec3;
use sapwood_geom::{Aabb, Content, Digester, Side, content};

use super::{Placement, Projection, SlotReader, Viewpoint};

/// In which of several bands of distance from the viewpoint a component stands.
///
/// Band 0 reaches from the viewpoint to the first distance, the last one from the last distance
/// to infinity. Without a viewpoint everything stands in band 0.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceBand {
    /// The distances in metres at which one band ends and the next begins, rising.
    pub distances: Vec<f32>,
    /// How far beyond its ends a band still holds what stood in it, as a part of the distance
    /// there: 0.1 keeps a band that ends at 10 m until 11 m.
    pub hysteresis: f32,
    /// The point that is measured to, in the component's frame.
    pub center: Vec3,
}

content!(DistanceBand { distances, hysteresis, center });

impl DistanceBand {
    fn distance(&self, slots: &mut SlotReader<'_>) -> Option<f32> {
        let viewpoint = (*slots.read::<Viewpoint>())?;
        let center = slots.read::<Placement>().transform_point3(self.center);
        Some(center.distance(viewpoint))
    }
}

impl Projection for DistanceBand {
    type Output = usize;
    const NAME: &'static str = "distance_band";
    const REMEMBERS: bool = true;

    fn compute(&self, slots: &mut SlotReader<'_>) -> usize {
        let Some(distance) = self.distance(slots) else { return 0 };
        self.distances.partition_point(|end| *end <= distance)
    }

    fn stands(&self, band: &usize, slots: &mut SlotReader<'_>) -> bool {
        let Some(distance) = self.distance(slots) else { return *band == 0 };
        let begin = band.checked_sub(1).map(|before| self.distances.get(before));
        let has_begun = begin
            .is_none_or(|end| end.is_some_and(|end| distance >= end * (1.0 - self.hysteresis)));
        let end = self.distances.get(*band);
        has_begun && end.is_none_or(|end| distance < end * (1.0 + self.hysteresis))
    }
}

/// In which cell of a grid through the root's origin a component's origin stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The edge of a cell in metres, above 0.
    pub size: f32,
}

content!(Cell { size });

impl Projection for Cell {
    type Output = [i32; 3];
    const NAME: &'static str = "cell";

    fn compute(&self, slots: &mut SlotReader<'_>) -> [i32; 3] {
        let origin = slots.read::<Placement>().translation;
        // Whatever lies beyond what an i32 can number stands in the outermost cell.
        (origin / self.size).floor().to_array().map(|number| number as i32)
    }
}

/// How a box in a component's frame stands towards a box in the root's frame.
///
/// The component's box is judged by the box around it after placement: one that is turned may
/// be said to cross although it does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideOfBox {
    /// The component's box, in its own frame.
    pub own: Aabb,
    /// The region, in the root's frame.
    pub region: Aabb,
}

impl Content for SideOfBox {
    fn write(&self, digester: &mut Digester) {
        for corner in [self.own.min, self.own.max, self.region.min, self.region.max] {
            digester.add(&corner);
        }
    }
}

impl Projection for SideOfBox {
    type Output = Side;
    const NAME: &'static str = "side_of_box";

    fn compute(&self, slots: &mut SlotReader<'_>) -> Side {
        let placed = self.own.transformed(&slots.read::<Placement>());
        if !placed.intersects(&self.region) {
            Side::Outside
        } else if self.region.contains(placed.min) && self.region.contains(placed.max) {
            Side::Inside
        } else {
            Side::Crossing
        }
    }
}
