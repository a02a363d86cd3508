//! Bounds: a box and a sphere around the same points, the tighter one taken at each step.

use glam::{Affine3, Vec3};

use crate::{Content, Digester};

/// An axis-aligned box; empty when `min` exceeds `max` in any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// This box, grown to hold `point`.
    pub fn with_point(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// The middle; meaningless for an empty box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// The eight corners; meaningless for an empty box.
    pub fn corners(&self) -> [Vec3; 8] {
        let ends = [self.min, self.max];
        std::array::from_fn(|corner| {
            let side = |axis: usize| ends[corner >> axis & 1][axis];
            Vec3::new(side(0), side(1), side(2))
        })
    }

    /// Whether the two boxes share a point; an empty box shares none.
    pub fn intersects(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }

    /// Whether `point` lies inside, faces included.
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && self.max.cmpge(point).all()
    }

    /// The box around this box after `transform`.
    pub fn transformed(&self, transform: &Affine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let center = transform.transform_point3(self.center());
        let half = (self.max - self.min) * 0.5;
        let m = &transform.matrix3;
        let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        Self { min: center - reach, max: center + reach }
    }
}

/// A sphere; empty when its radius is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The middle.
    pub center: Vec3,
    /// The radius in metres.
    pub radius: f32,
}

impl Sphere {
    /// The sphere that holds nothing.
    pub const EMPTY: Self = Self { center: Vec3::ZERO, radius: -1.0 };

    /// Whether the sphere holds no point.
    pub fn is_empty(&self) -> bool {
        self.radius < 0.0
    }

    /// A sphere around this sphere after `transform`: the radius grows by the largest stretch.
    pub fn transformed(&self, transform: &Affine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let center = transform.transform_point3(self.center);
        Self { center, radius: self.radius * largest_stretch(transform) }
    }
}

/// An upper limit of how much `transform` lengthens any vector: exact for rotations with scales
/// along the axes, the Frobenius norm where axes are sheared.
fn largest_stretch(transform: &Affine3) -> f32 {
    let m = &transform.matrix3;
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let squares = Vec3::new(x.length_squared(), y.length_squared(), z.length_squared());
    let largest = squares.max_element();
    let slant = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
    let square = if slant <= 1e-6 * largest { largest } else { squares.element_sum() };
    libm::sqrtf(square) * (1.0 + 4.0 * f32::EPSILON)
}

/// A box and a sphere that both hold the same points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The box.
    pub aabb: Aabb,
    /// The sphere.
    pub sphere: Sphere,
}

impl Bound {
    /// The bound of nothing.
    pub const EMPTY: Self = Self { aabb: Aabb::EMPTY, sphere: Sphere::EMPTY };

    /// The bound of `points`: their box, and the smallest sphere about the box's middle.
    pub fn of_points(points: impl IntoIterator<Item = Vec3> + Clone) -> Self {
        let aabb = Aabb::of_points(points.clone());
        if aabb.is_empty() {
            return Self::EMPTY;
        }
        let center = aabb.center();
        let square =
            points.into_iter().map(|point| point.distance_squared(center)).fold(0.0, f32::max);
        Self { aabb, sphere: Sphere { center, radius: outward(libm::sqrtf(square)) } }
    }

    /// The bound of everything inside `aabb`.
    pub fn of_box(aabb: Aabb) -> Self {
        if aabb.is_empty() {
            return Self::EMPTY;
        }
        let center = aabb.center();
        let radius = outward((aabb.max - center).length());
        Self { aabb, sphere: Sphere { center, radius } }
    }

    /// A bound of this bound's points repeated at each of `transforms`.
    pub fn repeated(&self, transforms: &[Affine3]) -> Self {
        let boxes = transforms.iter().map(|transform| self.aabb.transformed(transform));
        Self::of_box(boxes.fold(Aabb::EMPTY, Aabb::union))
    }

    /// Whether the bound holds no point.
    pub fn is_empty(&self) -> bool {
        self.aabb.is_empty()
    }

    /// A bound of both.
    pub fn union(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        let aabb = self.aabb.union(other.aabb);
        // About the common box's middle, so that the order of unions moves the sphere little.
        let center = aabb.center();
        let reach = |sphere: &Sphere| sphere.center.distance(center) + sphere.radius;
        let spheres = outward(reach(&self.sphere).max(reach(&other.sphere)));
        let corners = outward((aabb.max - center).length());
        Self { aabb, sphere: Sphere { center, radius: spheres.min(corners) } }
    }

    /// A bound of the same points after `transform`, each shape tightened by the other.
    pub fn transformed(&self, transform: &Affine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let sphere = self.sphere.transformed(transform);
        let around = Aabb {
            min: sphere.center - Vec3::splat(sphere.radius),
            max: sphere.center + Vec3::splat(sphere.radius),
        };
        let turned = self.aabb.transformed(transform);
        let aabb = Aabb { min: turned.min.max(around.min), max: turned.max.min(around.max) };
        let aabb = if aabb.is_empty() { turned } else { aabb };
        let corners =
            Sphere { center: aabb.center(), radius: outward((aabb.max - aabb.center()).length()) };
        Self { aabb, sphere: if corners.radius < sphere.radius { corners } else { sphere } }
    }
}

/// Bounds of what turns.
impl Bound {
    /// A bound of the same points, turned about the origin in any way.
    pub fn turned_about_origin(&self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let sphere = self.sphere.center.length() + self.sphere.radius;
        let corner = self.aabb.min.abs().max(self.aabb.max.abs()).length();
        let radius = outward(sphere.min(corner));
        let (min, max) = (Vec3::splat(-radius), Vec3::splat(radius));
        Self { aabb: Aabb { min, max }, sphere: Sphere { center: Vec3::ZERO, radius } }
    }

    /// A bound of the same points, turned by any angle about the line through the origin along
    /// `axis`, which has unit length.
    pub fn turned_about_axis(&self, axis: Vec3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let Sphere { center, radius } = self.sphere;
        let along = center.dot(axis);
        // Everything lies in a cylinder about the axis, and in a sphere about its middle.
        let away = (center - axis * along).length() + radius;
        let ends = [axis * (along - radius), axis * (along + radius)];
        let square = |along: f32| libm::sqrtf((1.0 - along * along).max(0.0));
        let reach = Vec3::new(square(axis.x), square(axis.y), square(axis.z)) * outward(away);
        let min = ends[0].min(ends[1]) - reach;
        let max = ends[0].max(ends[1]) + reach;
        let around = Sphere { center: axis * along, radius: outward(away) };
        let slack = Vec3::splat(4.0 * f32::EPSILON * (along.abs() + radius));
        let all = self.turned_about_origin();
        let aabb =
            Aabb { min: (min - slack).max(all.aabb.min), max: (max + slack).min(all.aabb.max) };
        Self { aabb, sphere: if around.radius < all.sphere.radius { around } else { all.sphere } }
    }
}

impl Content for Bound {
    fn write(&self, digester: &mut Digester) {
        self.aabb.min.write(digester);
        self.aabb.max.write(digester);
        self.sphere.center.write(digester);
        self.sphere.radius.write(digester);
    }
}

/// A radius that survives the rounding of the steps that led to it.
fn outward(radius: f32) -> f32 {
    radius * (1.0 + 4.0 * f32::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> [Vec3; 3] {
        [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0)]
    }

    #[test]
    fn empty_is_neutral() {
        let bound = Bound::of_points(corners());
        assert_eq!(bound.union(&Bound::EMPTY), bound);
        assert_eq!(Bound::EMPTY.union(&bound), bound);
        assert!(Bound::of_points([]).is_empty());
        assert!(Bound::EMPTY.transformed(&Affine3::from_translation(Vec3::X)).is_empty());
        assert_eq!(Aabb::EMPTY.size(), Vec3::ZERO);
    }

    #[test]
    fn a_quarter_turn_swaps_the_axes() {
        let turn = Affine3::from_rotation_z(std::f32::consts::FRAC_PI_2);
        let turned = Bound::of_points(corners()).transformed(&turn).aabb;
        assert!((turned.size() - Vec3::new(0.0, 2.0, 1.0)).length() < 1e-5, "{turned:?}");
    }

    #[test]
    fn a_turned_sphere_tightens_the_box() {
        let ball = Bound {
            aabb: Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) },
            sphere: Sphere { center: Vec3::ZERO, radius: 1.0 },
        };
        let turn = Affine3::from_rotation_z(std::f32::consts::FRAC_PI_4);
        let turned = ball.transformed(&turn).aabb;
        assert!(turned.max.x < 1.001, "{turned:?}");
    }

    #[test]
    fn a_sheared_sphere_still_holds_its_points() {
        let mut shear = Affine3::IDENTITY;
        shear.matrix3.y_axis = Vec3::new(3.0, 1.0, 0.0);
        let bound = Bound::of_points([Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0)]);
        let sheared = bound.transformed(&shear);
        for point in [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0)] {
            let point = shear.transform_point3(point);
            assert!(point.distance(sheared.sphere.center) <= sheared.sphere.radius * 1.0001);
            assert!((point - sheared.aabb.min).min_element() > -1e-4);
        }
    }
}
