//! Placing: an affine transform as what glTF nodes can hold.
//!
//! A glTF node holds a translation, a rotation and a scale along its own axes, and a matrix only
//! if it is the product of those. A sheared transform is written exactly as two nested nodes:
//! `M = B * R` where the columns of `B` are orthogonal and `R` is a rotation.

use sapwood_geom::glam::{Affine3, DMat3, DQuat, DVec3, Mat3, Vec3};

/// Two columns are orthogonal when their cosine is below this; rounding of single floats stays
/// well under it.
const ORTHOGONAL: f64 = 2e-6;

/// Translation, rotation and scale of a node, each absent where it does nothing.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Placement {
    pub(super) translation: Option<[f32; 3]>,
    pub(super) rotation: Option<[f32; 4]>,
    pub(super) scale: Option<[f32; 3]>,
    /// The rotation of a nested node that carries the mesh; absent unless there is shear.
    pub(super) inner: Option<[f32; 4]>,
}

/// What the nodes for `transform` hold.
pub(super) fn of(transform: &Affine3) -> Placement {
    let matrix = transform.matrix3.as_dmat3();
    let (outer, inner) =
        if is_sheared(&matrix) { straightened(matrix) } else { (matrix, DMat3::IDENTITY) };
    let (rotation, scale) = rotation_and_scale(&outer);
    Placement {
        translation: (transform.translation != Vec3::ZERO)
            .then(|| transform.translation.to_array()),
        rotation: quaternion(&rotation),
        scale: (scale != Vec3::ONE).then(|| scale.to_array()),
        inner: quaternion(&inner),
    }
}

/// The place and the direction of what has no size: -z stays where it is turned to, and y as near
/// to where it was turned to as that allows.
pub(super) fn rigid(transform: &Affine3) -> Affine3 {
    let matrix = &transform.matrix3;
    let z = matrix.z_axis.try_normalize().unwrap_or(Vec3::Z);
    let x = matrix.y_axis.cross(z).try_normalize().unwrap_or_else(|| z.any_orthonormal_vector());
    Affine3 { matrix3: Mat3::from_cols(x, z.cross(x), z), translation: transform.translation }
}

const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

fn is_sheared(matrix: &DMat3) -> bool {
    PAIRS.iter().any(|(i, j)| {
        let (a, b) = (matrix.col(*i), matrix.col(*j));
        a.dot(b).abs() > ORTHOGONAL * a.length() * b.length()
    })
}

/// `(B, R)` with `matrix = B * R`, orthogonal columns in `B` and a rotation `R`.
///
/// Jacobi's one-sided method: columns are turned in pairs until all are orthogonal, which for
/// three columns takes a few sweeps.
fn straightened(matrix: DMat3) -> (DMat3, DMat3) {
    const SWEEPS: usize = 30;
    let (mut columns, mut turns) = (matrix, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        let mut largest = 0.0f64;
        for (i, j) in PAIRS {
            let (a, b) = (columns.col(i), columns.col(j));
            let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
            if ab == 0.0 {
                continue;
            }
            largest = largest.max(ab.abs() / (aa * bb).sqrt());
            let zeta = (bb - aa) / (2.0 * ab);
            let tan = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let cos = 1.0 / (1.0 + tan * tan).sqrt();
            let sin = cos * tan;
            for m in [&mut columns, &mut turns] {
                let (a, b) = (m.col(i), m.col(j));
                *m.col_mut(i) = a * cos - b * sin;
                *m.col_mut(j) = a * sin + b * cos;
            }
        }
        if largest < 1e-15 {
            break;
        }
    }
    (columns, turns.transpose())
}

/// A rotation and scale factors whose product has the columns of `matrix`, which are orthogonal.
fn rotation_and_scale(matrix: &DMat3) -> (DMat3, Vec3) {
    let mut lengths =
        DVec3::new(matrix.x_axis.length(), matrix.y_axis.length(), matrix.z_axis.length());
    let tiny = lengths.max_element() * 1e-12;
    let unit = |i: usize| (lengths[i] > tiny).then(|| matrix.col(i) / lengths[i]);
    // Columns of length zero may point anywhere, as long as all stay orthogonal.
    let [x, y, z] = match [unit(0), unit(1), unit(2)] {
        [Some(x), Some(y), Some(z)] => [x, y, z],
        [None, Some(y), Some(z)] => [y.cross(z), y, z],
        [Some(x), None, Some(z)] => [x, z.cross(x), z],
        [Some(x), Some(y), None] => [x, y, x.cross(y)],
        [Some(x), None, None] => {
            let y = x.any_orthonormal_vector();
            [x, y, x.cross(y)]
        }
        [None, Some(y), None] => {
            let z = y.any_orthonormal_vector();
            [y.cross(z), y, z]
        }
        [None, None, Some(z)] => {
            let x = z.any_orthonormal_vector();
            [x, z.cross(x), z]
        }
        [None, None, None] => [DVec3::X, DVec3::Y, DVec3::Z],
    };
    let mirrors = x.cross(y).dot(z) < 0.0;
    let x = if mirrors { -x } else { x };
    if mirrors {
        lengths.x = -lengths.x;
    }
    // A product of rotations is one only up to rounding; lengths that near to 1 are 1.
    let snap =
        |length: f64| if (length.abs() - 1.0).abs() < 1e-6 { length.signum() } else { length };
    let scale = DVec3::new(snap(lengths.x), snap(lengths.y), snap(lengths.z)).as_vec3();
    (DMat3::from_cols(x, y, z), scale)
}

/// The unit quaternion of `rotation`, or nothing where it turns nothing.
fn quaternion(rotation: &DMat3) -> Option<[f32; 4]> {
    let quaternion = DQuat::from_mat3(rotation).normalize();
    let quaternion = if quaternion.w < 0.0 { -quaternion } else { quaternion };
    let turn = DVec3::new(quaternion.x, quaternion.y, quaternion.z);
    (turn.length() > 1e-7).then(|| quaternion.as_quat().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sapwood_geom::glam::Quat;

    /// The matrix that a reader of the nodes arrives at.
    fn read(placement: &Placement) -> Affine3 {
        let turn = |rotation: Option<[f32; 4]>| rotation.map_or(Quat::IDENTITY, Quat::from_array);
        let outer = Affine3::from_scale_rotation_translation(
            placement.scale.map_or(Vec3::ONE, Vec3::from_array),
            turn(placement.rotation),
            placement.translation.map_or(Vec3::ZERO, Vec3::from_array),
        );
        outer * Affine3::from_quat(turn(placement.inner))
    }

    fn check(transform: Affine3, nested: bool) {
        let placement = of(&transform);
        assert_eq!(placement.inner.is_some(), nested, "{placement:?}");
        let back = read(&placement);
        let size = transform.matrix3.x_axis.length().max(1.0);
        assert!(back.abs_diff_eq(transform, 1e-5 * size), "{transform:?}\n{back:?}");
    }

    #[test]
    fn the_identity_is_left_out() {
        assert_eq!(of(&Affine3::IDENTITY), Placement::default());
        let moved = of(&Affine3::from_translation(Vec3::X));
        assert_eq!(moved, Placement { translation: Some([1.0, 0.0, 0.0]), ..Default::default() });
    }

    #[test]
    fn straight_transforms_are_one_node() {
        let turn = Quat::from_euler(sapwood_geom::glam::EulerRot::XYZ, 0.3, -1.2, 2.5);
        let at = Vec3::new(10.0, -3.0, 0.5);
        for scale in [Vec3::ONE, Vec3::new(2.0, 0.1, 3.0), Vec3::new(1.0, -1.0, 1.0), -Vec3::ONE] {
            check(Affine3::from_scale_rotation_translation(scale, turn, at), false);
        }
        check(Affine3::from_rotation_x(-std::f32::consts::FRAC_PI_2), false);
    }

    #[test]
    fn sheared_and_flattened_transforms_are_two_nodes_at_most() {
        let turn = Affine3::from_rotation_z(0.7);
        check(Affine3::from_scale(Vec3::new(3.0, 1.0, 1.0)) * turn, true);
        check(Affine3::from_scale(Vec3::new(-3.0, 1.0, 1.0)) * turn, true);
        check(Affine3::from_scale(Vec3::new(0.0, 1.0, 1.0)), false);
        check(Affine3::from_scale(Vec3::ZERO), false);
        check(Affine3::from_scale(Vec3::new(0.0, 1.0, 2.0)) * turn, true);
        let mut all_alike = Affine3::IDENTITY;
        all_alike.matrix3 = Mat3::from_cols(Vec3::ONE, Vec3::ONE, Vec3::ONE);
        check(all_alike, true);
    }

    #[test]
    fn what_has_no_size_keeps_its_direction() {
        let turn = Affine3::from_rotation_x(0.4) * Affine3::from_rotation_y(2.0);
        let stretched = Affine3::from_scale(Vec3::new(-3.0, 0.5, 2.0));
        let world = Affine3::from_translation(Vec3::X) * turn * stretched;
        let rigid = rigid(&world);
        let placement = of(&rigid);
        assert_eq!((placement.scale, placement.inner), (None, None));
        let ahead = rigid.transform_vector3(Vec3::NEG_Z);
        assert!(ahead.distance(turn.transform_vector3(Vec3::NEG_Z)) < 1e-6);
        assert!(rigid.transform_vector3(Vec3::Y).distance(turn.transform_vector3(Vec3::Y)) < 1e-6);
        assert!(super::rigid(&Affine3::from_scale(Vec3::ZERO)).is_finite());
    }
}
