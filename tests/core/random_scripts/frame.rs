//! The reference's own arithmetic of places: affine maps in 64 bits.

use sapwood::geom::Aabb;
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::{Eye, Facing};

type V = [f64; 3];

/// An affine map: the images of the three axes, and of the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    axes: [V; 3],
    origin: V,
}

impl Frame {
    pub(super) const IDENTITY: Self =
        Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] };

    pub(super) fn of(map: &Affine3) -> Self {
        let wide = |v: Vec3| v.to_array().map(f64::from);
        let m = &map.matrix3;
        Self {
            axes: [wide(m.x_axis), wide(m.y_axis), wide(m.z_axis)],
            origin: wide(map.translation),
        }
    }

    fn vector(&self, v: V) -> V {
        let [x, y, z] = self.axes;
        std::array::from_fn(|i| x[i] * v[0] + y[i] * v[1] + z[i] * v[2])
    }

    fn point(&self, p: V) -> V {
        add(self.vector(p), self.origin)
    }

    /// First `inner`, then this.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self { axes: inner.axes.map(|axis| self.vector(axis)), origin: self.point(inner.origin) }
    }

    /// Which vector this map takes to `v`, by Cramer's rule.
    fn vector_back(&self, v: V) -> V {
        let [x, y, z] = self.axes;
        let all = dot(x, cross(y, z));
        [dot(v, cross(y, z)) / all, dot(x, cross(v, z)) / all, dot(x, cross(y, v)) / all]
    }

    /// Which point this map takes to `p`.
    pub(super) fn point_back(&self, p: Vec3) -> V {
        self.vector_back(sub(p.to_array().map(f64::from), self.origin))
    }

    /// The box around the image of a box.
    pub(super) fn around(&self, own: &Aabb) -> Aabb {
        let corners = (0..8).map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { own.min } else { own.max };
            let corner = [pick(0).x, pick(1).y, pick(2).z].map(f64::from);
            Vec3::from_array(self.point(corner).map(|x| x as f32))
        });
        Aabb::of_points(corners)
    }

    /// Turning by an angle about an axis (Rodrigues).
    pub(super) fn turning(axis: V, angle: f64) -> Self {
        let axis = unit(axis);
        let turned = |v: V| {
            let along = scaled(axis, dot(axis, v) * (1.0 - angle.cos()));
            add(add(scaled(v, angle.cos()), scaled(cross(axis, v), angle.sin())), along)
        };
        Self { axes: Self::IDENTITY.axes.map(turned), origin: [0.0; 3] }
    }

    /// The frame turned to the eye, and whether the direction to turn to is well determined.
    pub(super) fn faced(&self, facing: Facing, eye: Option<&Eye>) -> (Self, bool) {
        let Some(eye) = eye else { return (*self, true) };
        let wide = |v: Vec3| v.to_array().map(f64::from);
        let there = self.vector_back(sub(wide(eye.position), self.origin));
        match facing {
            Facing::Eye => {
                let z = unit(there);
                let up = unit(self.vector_back(wide(eye.up)));
                let x = cross(up, z);
                let is_sure = length(there) > 1.0 && length(x) > 0.1;
                let x = unit(x);
                let turn = Self { axes: [x, cross(z, x), z], origin: [0.0; 3] };
                (self.after(&turn), is_sure)
            }
            Facing::Axis(axis) => {
                let axis = unit(wide(axis));
                let ahead = sub(there, scaled(axis, dot(there, axis)));
                let is_sure = length(ahead) > 1.0;
                let z = unit(ahead);
                let from = unit(sub([0.0, 0.0, 1.0], scaled(axis, axis[2])));
                let angle = dot(axis, cross(from, z)).atan2(dot(from, z));
                (self.after(&Self::turning(axis, angle)), is_sure)
            }
        }
    }

    /// How far apart an engine's map is, in its worst number, relative to the largest.
    pub(super) fn distance(&self, map: &Affine3) -> f64 {
        let other = Self::of(map);
        let numbers = |frame: &Self| {
            let [x, y, z] = frame.axes;
            [x, y, z, frame.origin].concat()
        };
        let (own, other) = (numbers(self), numbers(&other));
        let largest = own.iter().fold(1.0, |all: f64, x| all.max(x.abs()));
        let apart = own.iter().zip(&other).map(|(a, b)| (a - b).abs());
        // A difference that is no number is one.
        apart.fold(0.0, |all: f64, x| if x <= all { all } else { x }) / largest
    }
}

fn add(a: V, b: V) -> V {
    std::array::from_fn(|i| a[i] + b[i])
}

fn sub(a: V, b: V) -> V {
    std::array::from_fn(|i| a[i] - b[i])
}

fn scaled(a: V, by: f64) -> V {
    a.map(|x| x * by)
}

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: V) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: V) -> V {
    scaled(a, 1.0 / length(a))
}
