//! What growth and drawing read of leaves, made from a species.

use glam::Vec3;
use sapwood_geom::{SharedMesh, content};

use super::params::grouping;
use super::{CrownShape, LeafShape, LeafTarget, LeavesSpec, OwnLeafImage, Species};

/// How far built-in shapes reach: half their width is the most by which they are off the midrib,
/// and what stands for them from afar may be 1.2 times their width off that.
const REACH: Vec3 = Vec3::new(1.2, 0.5, 1.0);

/// How far leaves of a species reach before they are made long and wide.
fn reach(leaves: &LeavesSpec) -> Vec3 {
    let mesh = leaves.mesh.as_ref().map_or(Vec3::ZERO, |own| own.mesh.reach());
    let image = leaves.image.as_ref().map(|own| &own.image);
    let image = image.filter(|image| leaves.mesh.is_none() && image.is_cut_out());
    let card = image.map_or(0.0, OwnLeafImage::proportion);
    // A card covers as much as a triangle of twice its half width.
    REACH.max(mesh).max(card * Vec3::X)
}

/// The leaves: their own parameters, and the angles of the level after the last stems.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafParams {
    /// Leaves on a stem of the last level; negative: a fan at the stem's tip.
    pub count: i32,
    /// Leaves on a stem of levels 0 to 3 where that is not the last; deeper levels take those of 3.
    pub on_levels: [i32; 4],
    /// LeafShape.
    pub shape: LeafShape,
    /// A mesh of somebody's own instead of the shape, one long.
    pub mesh: Option<SharedMesh>,
    /// How far a leaf one long and one wide reaches from where it begins, across, up and along.
    pub reach: Vec3,
    /// LeafScale in metres.
    pub scale: f32,
    /// LeafScaleX, width per length.
    pub scale_x: f32,
    /// LeafBend, a fraction.
    pub bend: f32,
    /// LeafStemLen, a fraction of the leaf's length.
    pub stem_len: f32,
    /// LeafDistrib.
    pub distrib: CrownShape,
    /// LeafQuality, above 0; does nothing to fans.
    pub quality: f32,
    /// How strongly leaves turn toward a direction or a point.
    pub attraction: f32,
    /// What leaves turn toward, in the world; growth takes the target in tree space.
    pub target: LeafTarget,
    /// nDownAngle of the leaf level.
    pub down_angle: f32,
    /// nDownAngleV of the leaf level.
    pub down_angle_v: f32,
    /// nRotate of the leaf level; the opening angle of a fan.
    pub rotate: f32,
    /// nRotateV of the leaf level.
    pub rotate_v: f32,
    /// tree-gen's branch_dist of the leaf level, in its dialect only.
    pub grouping: Option<f32>,
}

content!(LeafParams {
    count,
    on_levels,
    shape,
    mesh,
    reach,
    scale,
    scale_x,
    bend,
    stem_len,
    distrib,
    quality,
    attraction,
    target,
    down_angle,
    down_angle_v,
    rotate,
    rotate_v,
    grouping,
});

impl LeafParams {
    /// The leaves of a species.
    pub fn new(species: &Species) -> Self {
        let (leaves, level) = (&species.leaves, &species.level[species.leaf_level()]);
        Self {
            count: leaves.count,
            on_levels: species.level.each_ref().map(|level| level.leaves),
            shape: leaves.shape,
            mesh: leaves.mesh.as_ref().map(|own| own.mesh.unit().clone()),
            reach: reach(leaves),
            scale: leaves.scale,
            scale_x: leaves.scale_x,
            bend: leaves.bend,
            stem_len: leaves.stem_len,
            distrib: leaves.distrib,
            quality: leaves.quality,
            attraction: leaves.attraction,
            target: leaves.target,
            down_angle: level.down_angle.to_radians(),
            down_angle_v: level.down_angle_v.to_radians(),
            rotate: level.rotate.to_radians(),
            rotate_v: level.rotate_v.to_radians(),
            grouping: grouping(species, species.leaf_level()),
        }
    }

    /// The leaves on stems of a level, of which there are so many levels.
    pub fn on_level(&self, level: u8, levels: u32) -> Self {
        let count = if u32::from(level) + 1 < levels {
            self.on_levels[usize::from(level).min(3)]
        } else {
            self.count
        };
        Self { count, ..self.clone() }
    }

    /// The most leaves that a stem of any level has, or a fan of them.
    pub(crate) fn any_count(&self) -> u32 {
        let counts = self.on_levels.iter().chain([&self.count]);
        counts.map(|count| count.unsigned_abs()).max().unwrap_or(0)
    }

    /// A share of the leaves, of the same area together. Fans keep their leaves: there are few,
    /// and they are set one by one.
    pub fn thinned(&self, share: f32) -> Self {
        let share = if self.count < 0 { 1.0 } else { share.clamp(1e-6, 1.0) };
        Self { quality: self.quality * share, ..self.clone() }
    }

    /// These with leaves as long as the longest of any level once a share is left of those that are
    /// no fans: as those of a fan where there is nothing else.
    pub(crate) fn longest_thinned(&self, share: f32) -> Self {
        let counts = || self.on_levels.iter().chain([&self.count]).copied();
        let count = match counts().any(|count| count > 0) {
            true => self.count.max(0),
            false => counts().min().unwrap_or(0),
        };
        Self { count, ..self.clone() }.thinned(share)
    }

    /// These with all that growth does not ask for set to what they say of no species: two that
    /// are equal then have leaves in the same places.
    pub fn of_growth(&self) -> Self {
        let (shape, scale, scale_x, stem_len) = (LeafShape::Oval, 1.0, 1.0, 0.0);
        let (mesh, reach, on_levels) = (None, REACH, [0; 4]);
        let quality = if self.count < 0 { 1.0 } else { self.quality };
        Self { on_levels, shape, mesh, reach, scale, scale_x, stem_len, quality, ..self.clone() }
    }

    /// The length of the petiole in metres.
    pub fn petiole(&self) -> f32 {
        self.stem_len * self.length()
    }

    /// The length of a leaf in metres; thinning by quality keeps the total area. Leaves of a fan
    /// are not thinned, and so they are no larger.
    pub fn length(&self) -> f32 {
        if self.count < 0 { self.scale } else { self.scale / self.quality.sqrt() }
    }

    /// The width of a leaf in metres.
    pub fn width(&self) -> f32 {
        self.scale_x * self.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quality_enlarges_no_fan_whatever_else_grows() {
        for (last, below) in [(-7, 20), (20, -7), (-7, -7)] {
            let mut species = Species::default();
            (species.leaves.count, species.level[1].leaves) = (last, below);
            species.leaves.quality = 0.25;
            let leaves = LeafParams::new(&species);
            for (level, count) in [(1, below), (species.levels as u8 - 1, last)] {
                let on = leaves.on_level(level, species.levels);
                let expected = if count < 0 { 1.0 } else { 2.0 } * species.leaves.scale;
                assert_eq!((on.count, on.length()), (count, expected), "{last} {below}");
                // Where fans grow follows from other things.
                let whole = LeafParams { quality: 1.0, ..on.clone() };
                assert_eq!(on.of_growth() == whole.of_growth(), count < 0);
            }
        }
    }

    #[test]
    fn no_leaf_is_longer_than_the_longest_whatever_is_a_fan() {
        for (last, below) in [(-7, 20), (20, -7), (-7, -7), (20, 20), (-7, 0), (0, -7)] {
            let mut species = Species::default();
            species.leaves.count = last;
            species.level[1].leaves = below;
            let leaves = LeafParams::new(&species);
            let longest = leaves.longest_thinned(0.25).length();
            let of_level = |level| leaves.on_level(level, species.levels).thinned(0.25);
            let lengths = (0..species.levels as u8).map(of_level).filter(|on| on.count != 0);
            let most = lengths.map(|on| on.length()).fold(0.0, f32::max);
            assert_eq!(longest, most, "{last} {below}");
        }
    }
}
