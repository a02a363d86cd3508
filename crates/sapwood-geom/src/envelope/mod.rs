//! Envelopes: solids that limit growth, and that cut what has grown.
//!
//! Whoever grows or cuts asks two questions: is this point inside, and does everything within a
//! sphere or a box lie on one side? The second one is answered with certainty or not at all.

mod closed_mesh;
mod profile;
mod region;
mod rim;
mod side;
#[cfg(test)]
mod tests;
mod triangle;
mod winding;

use glam::{Affine3, DAffine3, DVec3, Vec3};

pub use closed_mesh::{ClosedMesh, NotClosed};
pub use profile::Profile;
use region::Region;
pub use side::Side;

use crate::{Aabb, Bound, Content, Digester, Shared, Sphere};

/// What growth is held inside of: a solid that may reach to infinity.
///
/// Cheap to clone; equal where the content is. Surfaces belong to the inside, up to rounding. A
/// point with a coordinate that is no finite number is inside of nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope(Shared<Form>);

#[derive(Debug)]
enum Form {
    Sphere(Sphere),
    Aabb(Aabb),
    HalfSpace { normal: Vec3, offset: f32 },
    Revolution(Profile),
    Mesh(ClosedMesh),
    Union(Vec<Envelope>),
    Complement(Envelope),
    Placed { transform: Affine3, inverse: DAffine3, envelope: Envelope },
}

/// Solids.
impl Envelope {
    /// Everything inside a sphere; nothing where that is empty.
    pub fn sphere(sphere: Sphere) -> Self {
        Self::of(Form::Sphere(sphere))
    }

    /// Everything inside a box with faces along the axes; nothing where that is empty.
    pub fn aabb(aabb: Aabb) -> Self {
        Self::of(Form::Aabb(aabb))
    }

    /// All points whose dot product with `normal` is at most `offset`: `normal` points outwards.
    /// Where it has unit length, `offset` is the distance in metres of the border from the origin.
    pub fn half_space(normal: Vec3, offset: f32) -> Self {
        Self::of(Form::HalfSpace { normal, offset })
    }

    /// A solid of revolution about the z axis.
    pub fn revolution(profile: Profile) -> Self {
        Self::of(Form::Revolution(profile))
    }

    /// What a mesh encloses.
    pub fn mesh(mesh: ClosedMesh) -> Self {
        Self::of(Form::Mesh(mesh))
    }

    /// What is inside at least one of these; nothing where there is none.
    pub fn union(envelopes: impl IntoIterator<Item = Self>) -> Self {
        let mut all = Vec::new();
        for envelope in envelopes {
            // Unions of unions, as they come of adding one by one, are not nested.
            match &*envelope.0 {
                Form::Union(members) => all.extend_from_slice(members),
                _ => all.push(envelope),
            }
        }
        Self::of(Form::Union(all))
    }

    /// What is inside all of these; everything where there is none.
    pub fn intersection(envelopes: impl IntoIterator<Item = Self>) -> Self {
        Self::union(envelopes.into_iter().map(Self::complement)).complement()
    }

    /// What is not inside of this one.
    pub fn complement(self) -> Self {
        match &*self.0 {
            Form::Complement(envelope) => envelope.clone(),
            _ => Self::of(Form::Complement(self)),
        }
    }

    /// The envelope after `transform`, which leads out of its frame. A transform that flattens, or
    /// that is not finite, leaves nothing inside.
    pub fn placed(transform: Affine3, envelope: Self) -> Self {
        let exact = DAffine3::from_cols_array(&transform.to_cols_array().map(f64::from));
        let inverse = exact.inverse();
        let is_regular = transform.is_finite() && exact.matrix3.determinant() != 0.0;
        if !(is_regular && inverse.is_finite()) {
            return Self::nothing();
        }
        Self::of(Form::Placed { transform, inverse, envelope })
    }

    /// Nothing is inside.
    pub fn nothing() -> Self {
        Self::union([])
    }

    /// Every point is inside.
    pub fn everything() -> Self {
        Self::nothing().complement()
    }

    fn of(form: Form) -> Self {
        Self(Shared::new(form))
    }
}

/// Questions.
impl Envelope {
    /// Whether `point` lies inside.
    pub fn contains(&self, point: Vec3) -> bool {
        point.is_finite() && self.holds(point.as_dvec3())
    }

    /// How everything in a sphere stands towards the envelope. `Inside` and `Outside` are certain;
    /// what cannot be told cheaply is said to cross, and so is an empty sphere.
    pub fn side_of(&self, sphere: &Sphere) -> Side {
        let is_sound = sphere.center.is_finite() && sphere.radius.is_finite();
        if sphere.is_empty() || !is_sound {
            return Side::Crossing;
        }
        self.side(&Region::of_sphere(sphere))
    }

    /// How everything in a box stands towards the envelope; as certain as
    /// [`side_of`](Self::side_of).
    pub fn side_of_box(&self, aabb: &Aabb) -> Side {
        if aabb.is_empty() || !(aabb.min.is_finite() && aabb.max.is_finite()) {
            return Side::Crossing;
        }
        self.side(&Region::of_box(aabb))
    }

    /// How everything in a bound, which is both a box and a sphere, stands towards the envelope.
    pub fn side_of_bound(&self, bound: &Bound) -> Side {
        match self.side_of(&bound.sphere) {
            Side::Crossing => self.side_of_box(&bound.aabb),
            certain => certain,
        }
    }

    /// A bound of everything inside; nothing where it reaches to infinity, or may.
    pub fn bound(&self) -> Option<Bound> {
        match &*self.0 {
            Form::Sphere(sphere) => {
                let radius = Vec3::splat(sphere.radius);
                let aabb = Aabb { min: sphere.center - radius, max: sphere.center + radius };
                Some(if aabb.is_empty() { Bound::EMPTY } else { Bound { aabb, sphere: *sphere } })
            }
            Form::Aabb(aabb) => Some(Bound::of_box(*aabb)),
            Form::HalfSpace { .. } => None,
            Form::Revolution(profile) => Some(Bound::of_box(profile.aabb())),
            Form::Mesh(mesh) => Some(*mesh.bound()),
            Form::Union(all) => {
                all.iter().try_fold(Bound::EMPTY, |sum, one| Some(sum.union(&one.bound()?)))
            }
            Form::Complement(envelope) => envelope.bound_outside(),
            Form::Placed { transform, envelope, .. } => {
                envelope.bound().map(|bound| bound.transformed(transform))
            }
        }
    }

    /// A bound of everything that is not inside.
    fn bound_outside(&self) -> Option<Bound> {
        match &*self.0 {
            Form::Complement(envelope) => envelope.bound(),
            Form::Union(all) => {
                // What is outside of all is outside of each.
                let boxes = all.iter().filter_map(|one| Some(one.bound_outside()?.aabb));
                let common =
                    boxes.reduce(|a, b| Aabb { min: a.min.max(b.min), max: a.max.min(b.max) });
                common.map(Bound::of_box)
            }
            Form::Placed { transform, envelope, .. } => {
                envelope.bound_outside().map(|bound| bound.transformed(transform))
            }
            Form::Sphere(_)
            | Form::Aabb(_)
            | Form::HalfSpace { .. }
            | Form::Revolution(_)
            | Form::Mesh(_) => None,
        }
    }

    fn holds(&self, point: DVec3) -> bool {
        match &*self.0 {
            Form::Sphere(sphere) => {
                let radius = f64::from(sphere.radius);
                sphere.center.as_dvec3().distance(point) <= radius
            }
            Form::Aabb(aabb) => {
                aabb.min.as_dvec3().cmple(point).all() && aabb.max.as_dvec3().cmpge(point).all()
            }
            Form::HalfSpace { normal, offset } => {
                normal.as_dvec3().dot(point) <= f64::from(*offset)
            }
            Form::Revolution(profile) => profile.contains(point),
            Form::Mesh(mesh) => mesh.contains(point),
            Form::Union(all) => all.iter().any(|one| one.holds(point)),
            Form::Complement(envelope) => !envelope.holds(point),
            Form::Placed { inverse, envelope, .. } => {
                envelope.holds(inverse.transform_point3(point))
            }
        }
    }

    fn side(&self, region: &Region) -> Side {
        match &*self.0 {
            Form::Sphere(sphere) => {
                let [near, far] = region.distances(sphere.center.as_dvec3());
                between(near, far, f64::from(sphere.radius))
            }
            Form::Aabb(aabb) => {
                let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
                let [low, high] = region.corners();
                if !region.meets(min, max) || aabb.is_empty() {
                    Side::Outside
                } else if min.cmple(low).all() && max.cmpge(high).all() {
                    Side::Inside
                } else {
                    Side::Crossing
                }
            }
            Form::HalfSpace { normal, offset } => {
                let [low, high] = region.along(normal.as_dvec3());
                between(low, high, f64::from(*offset))
            }
            Form::Revolution(profile) => profile.side_of(region),
            Form::Mesh(mesh) => mesh.side_of(region),
            Form::Union(all) => {
                let mut side = Side::Outside;
                for one in all {
                    match one.side(region) {
                        Side::Inside => return Side::Inside,
                        Side::Crossing => side = Side::Crossing,
                        Side::Outside => {}
                    }
                }
                side
            }
            Form::Complement(envelope) => envelope.side(region).flipped(),
            Form::Placed { inverse, envelope, .. } => envelope.side(&region.transformed(inverse)),
        }
    }
}

/// On which side of a limit everything from `least` to `most` lies; up to the limit is inside.
fn between(least: f64, most: f64, limit: f64) -> Side {
    if most <= limit {
        Side::Inside
    } else if least > limit {
        Side::Outside
    } else {
        Side::Crossing
    }
}

impl Content for Envelope {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

impl Content for Form {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Sphere(Sphere { center, radius }) => digester.add(&0u8).add(center).add(radius),
            Self::Aabb(Aabb { min, max }) => digester.add(&1u8).add(min).add(max),
            Self::HalfSpace { normal, offset } => digester.add(&2u8).add(normal).add(offset),
            Self::Revolution(profile) => digester.add(&3u8).add(profile),
            Self::Mesh(mesh) => digester.add(&4u8).add(mesh),
            Self::Union(all) => digester.add(&5u8).add(all),
            Self::Complement(envelope) => digester.add(&6u8).add(envelope),
            Self::Placed { transform, inverse: _, envelope } => {
                digester.add(&7u8).add(transform).add(envelope)
            }
        };
    }
}
