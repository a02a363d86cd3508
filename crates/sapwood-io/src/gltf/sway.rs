//! What sways, as glTF plays it: a skin over joints, and an animation that turns them.
//!
//! Stems and leaves of a body are one skinned mesh: every leaf could be a node of its own, but a
//! tree has tens of thousands, of which viewers draw each by itself, while a leaf's vertices cost a
//! joint number each. Joints that carry things too little, or that there are too many of, are left
//! out, and what follows them rides on what they hang on.

use std::f32::consts::TAU;

use sapwood_geom::glam::{Quat, Vec3};
use sapwood_graph::{Body, Follows, Joint, Rig, Swing, Wind};

/// How a file moves what sways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwayAnimation {
    /// The wind.
    pub wind: Wind,
    /// After how many seconds it begins again, above 0; everything sways a whole number of times in
    /// that, so that nothing jumps.
    pub seconds: f32,
    /// How many keyframes there are for each second, above 0; between them viewers turn joints
    /// evenly.
    pub keys_per_second: f32,
    /// How many joints may move for each body; those that carry things furthest do.
    pub max_joints: usize,
    /// Joints that carry nothing as far as this, in metres, do not move.
    pub smallest: f32,
}

impl SwayAnimation {
    /// The most joints that move by default: with the one that holds them 256, which fit a byte.
    pub const MAX_JOINTS: usize = 255;

    /// An animation in a wind that begins again after so many seconds, with 12 keyframes for each.
    pub fn new(wind: Wind, seconds: f32) -> Self {
        let max_joints = Self::MAX_JOINTS;
        Self { wind, seconds, keys_per_second: 12.0, max_joints, smallest: 0.002 }
    }

    /// The times of the keyframes, from 0 to the end.
    pub(super) fn times(&self) -> Vec<f32> {
        let n = (self.seconds * self.keys_per_second).round().clamp(2.0, 1e6) as u32;
        (0..=n).map(|i| self.seconds * (i as f32 / n as f32)).collect()
    }

    /// A swing whose sines are back where they began at the end, with at least six keyframes for
    /// each turn.
    fn looping(&self, swing: &Swing) -> Swing {
        let fastest = self.keys_per_second * TAU / 6.0;
        let rates = swing.rates.map(|rate| rate.clamp(-fastest, fastest));
        Swing { rates, ..*swing }.looping(self.seconds)
    }
}

/// How many joints of a file move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Swayed {
    /// Joints that move.
    pub n_joints: usize,
    /// Joints that were left out, because they carry things too little or because there were too
    /// many: what follows them is rigid.
    pub n_rigid: usize,
}

/// The joints that a body has in a file. Number 0 holds them all and does not move.
pub(super) struct Skeleton<'a> {
    pub(super) joints: Vec<SkeletonJoint<'a>>,
    /// For each joint of the rig the number of that which stands for it.
    numbers: Vec<u16>,
    pub(super) swayed: Swayed,
}

/// A joint that moves.
pub(super) struct SkeletonJoint<'a> {
    joint: &'a Joint,
    swing: Swing,
    shares: [f32; 2],
    /// The number of the joint that it hangs on.
    pub(super) parent: usize,
    /// From there, in the body's frame, which all joints are parallel to at rest.
    pub(super) offset: Vec3,
    pub(super) origin: Vec3,
}

impl<'a> Skeleton<'a> {
    /// The joints of a body, if it sways in that wind.
    pub(super) fn of(body: &'a Body, animation: &SwayAnimation) -> Option<Self> {
        let rig: &Rig = body.rig.as_ref()?;
        let shares = animation.wind.shares(rig.strongest);
        let reaches = body.reaches();
        let mut moving: Vec<(f32, usize)> = Vec::new();
        for (number, (joint, reach)) in rig.joints.iter().zip(reaches).enumerate() {
            let carried = joint.largest_turn(shares.iter().sum()) * reach.unwrap_or(0.0);
            if carried > 0.0 {
                moving.push((carried, number));
            }
        }
        let n_moving = moving.len();
        moving.retain(|(carried, _)| *carried >= animation.smallest);
        moving.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        moving.truncate(animation.max_joints.min(usize::from(u16::MAX) - 1));
        let mut is_chosen = vec![false; rig.joints.len()];
        moving.iter().for_each(|(_, number)| is_chosen[*number] = true);
        let swayed = Swayed { n_joints: moving.len(), n_rigid: n_moving - moving.len() };
        if moving.is_empty() {
            return None;
        }
        let mut joints: Vec<SkeletonJoint<'_>> = Vec::with_capacity(moving.len());
        let mut numbers: Vec<u16> = Vec::with_capacity(rig.joints.len());
        for (joint, is_chosen) in rig.joints.iter().zip(is_chosen) {
            let parent = joint.parent.map_or(0, |parent| numbers[parent as usize]);
            if !is_chosen {
                numbers.push(parent);
                continue;
            }
            let parent = usize::from(parent);
            let above = parent.checked_sub(1).map_or(Vec3::ZERO, |above| joints[above].origin);
            let (origin, offset) = (joint.origin, joint.origin - above);
            let swing = animation.looping(&rig.swings[joint.swing as usize]);
            joints.push(SkeletonJoint { joint, swing, shares, parent, offset, origin });
            numbers.push(joints.len() as u16);
        }
        Some(Self { joints, numbers, swayed })
    }

    /// Number of joints, the one that holds them included.
    pub(super) fn len(&self) -> usize {
        self.joints.len() + 1
    }

    /// Bytes that the number of a joint takes.
    pub(super) fn number_size(&self) -> usize {
        if self.len() <= 256 { 1 } else { 2 }
    }

    /// The joint that a vertex or an instance of a row has in the file.
    pub(super) fn number(&self, follows: Option<&Follows>, i: usize) -> u16 {
        follows.map_or(0, |follows| self.numbers[follows.joint(i) as usize])
    }

    /// Bytes in the buffer beside those of vertices: what undoes each joint's place, and how each
    /// turns.
    pub(super) fn byte_length(&self, n_times: usize) -> u64 {
        (64 * self.len() + 16 * self.joints.len() * n_times) as u64
    }
}

impl SkeletonJoint<'_> {
    /// How the joint is turned at these times, of which the last is like the first.
    pub(super) fn turns(&self, times: &[f32]) -> Vec<[f32; 4]> {
        let turn = |time: f32| {
            let [x, y] = self.swing.at(self.shares, f64::from(time));
            let [x, y] = [x, y].map(|angle| angle * self.joint.amplitude);
            let turn =
                Quat::from_axis_angle(self.joint.x, x) * Quat::from_axis_angle(self.joint.y, y);
            let turn = turn.normalize();
            (if turn.w < 0.0 { -turn } else { turn }).to_array()
        };
        let mut turns: Vec<_> = times.iter().map(|time| turn(*time)).collect();
        if let (Some(first), Some(last)) = (turns.first().copied(), turns.last_mut()) {
            *last = first;
        }
        turns
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use sapwood_geom::glam::{Affine3, Mat4, Vec2};
    use sapwood_geom::{Mesh, Shared, SharedMesh};
    use sapwood_graph::{DrawList, DrawRow, Kind, Levels, Material, Named, Occurrence};

    use super::*;
    use crate::swaying_glb_bytes;

    struct Reed;

    impl Named for Reed {
        const NAME: &'static str = "reed";
    }

    fn strip(n: usize) -> Mesh {
        let at = |i: usize| Vec3::new(0.1 * (i % 2) as f32, (i / 2) as f32, 0.0);
        let sides = |i: u32| [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3];
        Mesh {
            positions: (0..2 * n).map(at).collect(),
            normals: vec![Vec3::Z; 2 * n],
            uvs: vec![Vec2::ZERO; 2 * n],
            indices: (0..n as u32 - 1).flat_map(sides).collect(),
        }
    }

    fn rig() -> Rig {
        let joint = |parent, y: f32, swing| Joint {
            parent,
            origin: Vec3::Y * y,
            x: Vec3::X,
            y: Vec3::Z,
            swing,
            amplitude: if y > 0.0 { 0.2 } else { 0.0 },
            level: 0,
        };
        let swing = |rate: f32| Swing { rates: [rate, 0.7 * rate], offsets: [1.0, 25.0] };
        let joints = vec![joint(None, 0.0, 0), joint(Some(0), 1.0, 0), joint(Some(1), 2.0, 1)];
        Rig { swings: vec![swing(1.3), swing(3.1)], joints, strongest: 20.0 }
    }

    /// A reed of two rows, three vertices wide, and a leaf of it three times; twice in a place that
    /// is turned.
    fn reeds() -> DrawList {
        let material = Arc::new(Material::matte("reed", 0.3, 0.5, 0.2));
        let joints = Shared::new(vec![0, 1, 2]);
        let follows =
            |numbers| Some(Follows { numbers: Shared::new(numbers), joints: joints.clone() });
        let row = |mesh, instances: Option<Vec<Affine3>>, follows| DrawRow {
            instances: instances.map(Shared::new),
            follows,
            ..DrawRow::new(Affine3::IDENTITY, SharedMesh::new(mesh), Arc::clone(&material))
        };
        let places = [0.5, 1.5, 2.5].map(|y| Affine3::from_translation(Vec3::new(0.5, y, 0.0)));
        let mut body = Body::new(Kind::of::<Reed>());
        body.rig = Some(Arc::new(rig()));
        body.rows = vec![
            row(strip(4), None, follows(vec![0, 0, 0, 0, 1, 1, 2, 2])),
            row(strip(2), Some(places.to_vec()), follows(vec![0, 1, 2])),
            row(strip(2), None, None),
        ];
        let turned = Affine3::from_rotation_y(0.7) * Affine3::from_translation(Vec3::X * 3.0);
        let worlds = [Affine3::IDENTITY, turned];
        let occurrences = worlds.map(|world| Occurrence { body: 0, world });
        DrawList { bodies: vec![body], occurrences: occurrences.to_vec() }
    }

    /// What a viewer shows at each keyframe: all skinned vertices.
    fn played(bytes: &[u8]) -> Vec<Vec<Vec3>> {
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(bytes).unwrap();
        let blob = blob.unwrap();
        let data = |_: gltf::Buffer<'_>| Some(&blob[..]);
        let animation = document.animations().next().unwrap();
        let turns: Vec<(usize, Vec<[f32; 4]>)> = animation
            .channels()
            .map(|channel| {
                let outputs = channel.reader(data).read_outputs().unwrap();
                let gltf::animation::util::ReadOutputs::Rotations(turns) = outputs else {
                    panic!("joints turn")
                };
                (channel.target().node().index(), turns.into_f32().collect())
            })
            .collect();
        let n_keys = turns[0].1.len();
        let at = |key: usize| {
            let mut worlds = vec![Mat4::IDENTITY; document.nodes().count()];
            let scene = document.scenes().next().unwrap();
            let mut stack: Vec<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
            while let Some((node, above)) = stack.pop() {
                let (translation, mut rotation, scale) = node.transform().decomposed();
                if let Some((_, turns)) = turns.iter().find(|(index, _)| *index == node.index()) {
                    rotation = turns[key];
                }
                let local = Mat4::from_scale_rotation_translation(
                    scale.into(),
                    Quat::from_array(rotation),
                    translation.into(),
                );
                worlds[node.index()] = above * local;
                stack.extend(node.children().map(|child| (child, above * local)));
            }
            let mut places = Vec::new();
            for node in document.nodes().filter(|node| node.skin().is_some()) {
                let skin = node.skin().unwrap();
                let undo = skin.reader(data).read_inverse_bind_matrices().unwrap();
                let moves: Vec<Mat4> = skin
                    .joints()
                    .zip(undo)
                    .map(|(joint, undo)| worlds[joint.index()] * Mat4::from_cols_array_2d(&undo))
                    .collect();
                for primitive in node.mesh().unwrap().primitives() {
                    let reader = primitive.reader(data);
                    let joints = reader.read_joints(0).unwrap().into_u16();
                    let weights = reader.read_weights(0).unwrap().into_f32();
                    assert!(weights.eq([[1.0, 0.0, 0.0, 0.0]].iter().copied().cycle().take(24)));
                    let points = reader.read_positions().unwrap().zip(joints);
                    places.extend(points.map(|(point, joints)| {
                        moves[usize::from(joints[0])].transform_point3(Vec3::from(point))
                    }));
                }
            }
            places
        };
        (0..n_keys).map(at).collect()
    }

    #[test]
    fn a_solid_that_sways_keeps_its_joints() {
        let mut list = reeds();
        let body = &mut list.bodies[0];
        body.is_solid = true;
        // A tetrahedron that is flat at rest.
        let indices = vec![0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
        body.rows[1].mesh = SharedMesh::new(Mesh { indices, ..strip(2) });
        body.rows[1].instances.take();
        body.rows[1].follows.as_mut().unwrap().numbers = Shared::new(vec![0, 0, 1, 2]);
        body.rows = vec![body.rows.swap_remove(1)];
        let of = |bytes: &[u8]| {
            let document = gltf::Gltf::from_slice(bytes).unwrap().document;
            let mesh = document.meshes().next().unwrap();
            let swaying =
                mesh.primitives().all(|part| part.get(&gltf::Semantic::Joints(0)).is_some());
            let is_solid =
                document.extensions_used().any(|used| used == super::super::manifold::NAME);
            (is_solid, swaying, document.skins().count() > 0)
        };
        assert_eq!(of(&crate::glb_bytes(&list).unwrap()), (true, false, false));
        let animation = SwayAnimation::new(Wind::new(6.0, 3.0), 4.0);
        let (bytes, _) = swaying_glb_bytes(&list, &animation).unwrap();
        assert_eq!(of(&bytes), (false, true, true));
    }

    #[test]
    fn a_file_plays_what_the_rig_does_and_begins_again_where_it_ends() {
        let list = reeds();
        let animation = SwayAnimation::new(Wind::new(6.0, 3.0), 4.0);
        let (bytes, swayed) = swaying_glb_bytes(&list, &animation).unwrap();
        assert_eq!(swayed, Swayed { n_joints: 2, n_rigid: 0 });
        let played = played(&bytes);
        assert_eq!((played.len(), played[0].len()), (49, 2 * 24));
        assert_eq!(played.first(), played.last());

        let mut rig = rig();
        for swing in &mut rig.swings {
            *swing = swing.looping(4.0);
        }
        let mut farthest = 0.0f32;
        for (time, played) in animation.times().into_iter().zip(&played) {
            let mut pose = Vec::new();
            rig.pose(animation.wind, f64::from(time), Levels::ALL, &mut pose);
            let mut expected = Vec::new();
            for (world, row) in list.placed_rows() {
                let once = vec![Affine3::IDENTITY];
                let places = row.instances.as_deref().unwrap_or(&once);
                for (instance, place) in places.iter().enumerate() {
                    for (vertex, position) in row.mesh.positions.iter().enumerate() {
                        let number = if row.instances.is_some() { instance } else { vertex };
                        let joint = row.follows.as_ref().map(|follows| follows.joint(number));
                        let moved = joint.map_or(Affine3::IDENTITY, |j| pose[j as usize]);
                        expected.push((world * moved * *place).transform_point3(*position));
                    }
                }
            }
            for (played, expected) in played.iter().zip(expected) {
                assert!(played.distance(expected) < 1e-5, "{time} s: {played} {expected}");
            }
            let start = &played;
            farthest = farthest.max(start[7].distance(list.bodies[0].rows[0].mesh.positions[7]));
        }
        assert!(farthest > 0.05, "{farthest}");
    }

    #[test]
    fn joints_that_carry_little_are_left_out_and_what_follows_them_is_rigid() {
        let list = reeds();
        let all = SwayAnimation::new(Wind::new(6.0, 3.0), 4.0);
        let of = |animation| Skeleton::of(&list.bodies[0], &animation).unwrap();
        let one = of(SwayAnimation { max_joints: 1, ..all });
        assert_eq!(one.swayed, Swayed { n_joints: 1, n_rigid: 1 });
        // Of the two, which turn alike, the lower carries things further.
        assert_eq!((one.numbers.clone(), one.joints[0].offset), (vec![0, 1, 1], Vec3::Y));
        let large = of(SwayAnimation { smallest: 0.1, ..all });
        assert!(large.swayed.n_joints < 2 || large.swayed.n_rigid == 0);
        assert!(Skeleton::of(&list.bodies[0], &SwayAnimation { smallest: 9.0, ..all }).is_none());
        let still = SwayAnimation { wind: Wind::default(), ..all };
        let (bytes, swayed) = swaying_glb_bytes(&list, &still).unwrap();
        assert_eq!((swayed, bytes), (Swayed::default(), crate::glb_bytes(&list).unwrap()));
    }

    #[test]
    fn fast_joints_have_keyframes_enough() {
        let animation =
            SwayAnimation { keys_per_second: 4.0, ..SwayAnimation::new(Wind::default(), 6.0) };
        let swing = Swing { rates: [100.0, 0.01], offsets: [0.0; 2] };
        let turns = animation.looping(&swing).rates.map(|rate| rate * 6.0 / TAU);
        assert!((turns[0] - 4.0).abs() < 1e-4 && (turns[1] - 1.0).abs() < 1e-4, "{turns:?}");
        assert_eq!(animation.times().len(), 25);
    }
}
