//! What a body has to do with the wind: one rig for all that it draws, and which joints its rows
//! follow.
//!
//! Each plan has a rig of its own, with all the joints that it hangs on; a tree's branches all have
//! the trunk's. Equal joints become one, so that each is turned once.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Digest, FixedMap, Shared, fixed_state};

use super::Body;
use crate::{DrawRange, Joint, Rig};

/// Which joints of its body's rig a row follows.
#[derive(Clone, Debug)]
pub struct Follows {
    /// For each vertex of a single mesh, or for each instance, a number in `joints`.
    pub numbers: Shared<Vec<u32>>,
    /// Joints of the body's rig.
    pub joints: Shared<Vec<u32>>,
}

impl Follows {
    /// The joint that a vertex, or an instance, follows.
    pub fn joint(&self, number: usize) -> u32 {
        self.joints[self.numbers[number] as usize]
    }

    /// What is left where only some instances are drawn.
    pub(super) fn of_instances(&self, range: DrawRange) -> Self {
        let numbers = Shared::new(range.of(&self.numbers).to_vec());
        Self { numbers, joints: self.joints.clone() }
    }

    /// What is left where only some triangles of a mesh are drawn, with the vertices that they
    /// need.
    pub(super) fn of_triangles(&self, indices: &[u32], range: DrawRange) -> Self {
        let mut is_used = vec![false; self.numbers.len()];
        let left = indices.get(3 * range.first as usize..3 * range.end as usize);
        left.unwrap_or_default().iter().for_each(|index| is_used[*index as usize] = true);
        let used = self.numbers.iter().zip(is_used).filter(|(_, is_used)| *is_used);
        let numbers = Shared::new(used.map(|(number, _)| *number).collect());
        Self { numbers, joints: self.joints.clone() }
    }
}

impl Body {
    /// For each joint of the body's rig, how far from it anything is, at rest and in metres, that
    /// follows it or a joint that hangs on it by way of the joints between; nothing where nothing
    /// does. Costs all vertices that sway.
    pub fn reaches(&self) -> Vec<Option<f32>> {
        let Some(rig) = &self.rig else { return Vec::new() };
        let mut reaches = vec![None; rig.joints.len()];
        self.each_follower(rig, |joint, distance, _, _| {
            let reach: &mut Option<f32> = &mut reaches[joint];
            *reach = Some(reach.unwrap_or(0.0).max(distance));
        });
        // Each stands behind what it hangs on.
        for (number, joint) in rig.joints.iter().enumerate().rev() {
            let (Some(reach), Some(parent)) = (reaches[number], joint.parent) else { continue };
            let parent = parent as usize;
            let reach = reach + rig.joints[parent].origin.distance(joint.origin);
            reaches[parent] = Some(reaches[parent].unwrap_or(0.0).max(reach));
        }
        reaches
    }

    /// Hands over everything that follows a joint: the joint's number, how far it reaches from
    /// there, its middle and its radius, for a vertex 0.
    pub(super) fn each_follower(&self, rig: &Rig, mut take: impl FnMut(usize, f32, Vec3, f32)) {
        for row in &self.rows {
            let Some(follows) = &row.follows else { continue };
            let mut take = |number: usize, middle: Vec3, radius: f32| {
                let joint = follows.joint(number) as usize;
                take(joint, rig.joints[joint].origin.distance(middle) + radius, middle, radius);
            };
            match &row.instances {
                None => {
                    for (i, position) in row.mesh.positions.iter().enumerate() {
                        take(i, row.local.transform_point3(*position), 0.0);
                    }
                }
                Some(instances) => {
                    for (i, place) in instances.iter().enumerate() {
                        let sphere = row.mesh.bound().sphere.transformed(&(row.local * *place));
                        take(i, sphere.center, sphere.radius.max(0.0));
                    }
                }
            }
        }
    }
}

/// The rig of a body in the making.
pub(super) struct Rigging {
    rig: Rig,
    swings: FixedMap<Digest, u32>,
    joints: FixedMap<Digest, u32>,
    /// The joints that a plan's rig became, by that and the frame that it stands in.
    known: FixedMap<Digest, Shared<Vec<u32>>>,
}

impl Rigging {
    pub(super) fn new() -> Self {
        Self {
            rig: Rig::default(),
            swings: FixedMap::with_hasher(fixed_state()),
            joints: FixedMap::with_hasher(fixed_state()),
            known: FixedMap::with_hasher(fixed_state()),
        }
    }

    pub(super) fn finish(self) -> Arc<Rig> {
        Arc::new(self.rig)
    }

    /// What a row follows that follows joints of a plan's rig, whose frame `local` leads from to
    /// the body's.
    pub(super) fn follows(
        &mut self,
        numbers: &Shared<Vec<u32>>,
        rig: &Shared<Rig>,
        local: &Affine3,
    ) -> Follows {
        let key = Digest::of(&(rig.digest(), *local));
        let joints = match self.known.get(&key) {
            Some(joints) => joints.clone(),
            None => {
                let joints = Shared::new(self.add(rig, local));
                self.known.insert(key, joints.clone());
                joints
            }
        };
        Follows { numbers: numbers.clone(), joints }
    }

    fn add(&mut self, rig: &Rig, local: &Affine3) -> Vec<u32> {
        self.rig.strongest = self.rig.strongest.max(rig.strongest);
        let mut numbers: Vec<u32> = Vec::with_capacity(rig.joints.len());
        for joint in &rig.joints {
            let parent = joint.parent.and_then(|parent| numbers.get(parent as usize).copied());
            let swing = rig.swings.get(joint.swing as usize).map_or(0, |swing| {
                let swings = &mut self.rig.swings;
                *self.swings.entry(Digest::of(swing)).or_insert_with(|| {
                    swings.push(*swing);
                    swings.len() as u32 - 1
                })
            });
            let joint = Joint { parent, swing, ..joint.transformed(local) };
            let joints = &mut self.rig.joints;
            numbers.push(*self.joints.entry(Digest::of(&joint)).or_insert_with(|| {
                joints.push(joint);
                joints.len() as u32 - 1
            }));
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Swing;

    fn joint(parent: Option<u32>, origin: Vec3, swing: u32) -> Joint {
        Joint { parent, origin, x: Vec3::X, y: Vec3::Y, swing, amplitude: 0.1, level: 0 }
    }

    fn rig(tips: &[Vec3]) -> Shared<Rig> {
        let swing = |rate| Swing { rates: [rate; 2], offsets: [0.0; 2] };
        let mut rig = Rig { swings: vec![swing(1.0)], ..Rig::default() };
        rig.joints.push(joint(None, Vec3::ZERO, 0));
        for tip in tips {
            rig.swings.push(swing(tip.length()));
            rig.joints.push(joint(Some(0), *tip, rig.swings.len() as u32 - 1));
        }
        Shared::new(rig)
    }

    #[test]
    fn equal_joints_of_several_rigs_are_one() {
        let mut rigging = Rigging::new();
        let numbers = Shared::new(vec![0, 1, 1]);
        let first = rigging.follows(&numbers, &rig(&[Vec3::Z]), &Affine3::IDENTITY);
        let again = rigging.follows(&numbers, &rig(&[Vec3::Z]), &Affine3::IDENTITY);
        let other = rigging.follows(&numbers, &rig(&[Vec3::X, Vec3::Z]), &Affine3::IDENTITY);
        assert_eq!((&*first.joints, &*again.joints), (&vec![0, 1], &vec![0, 1]));
        assert_eq!((&*other.joints, other.joint(2)), (&vec![0, 2, 1], 2));
        let aside = Affine3::from_translation(Vec3::Y);
        let moved = rigging.follows(&numbers, &rig(&[Vec3::Z]), &aside);
        assert_eq!(&*moved.joints, &vec![3, 4]);
        let rig = rigging.finish();
        assert_eq!((rig.joints.len(), rig.swings.len(), rig.fault()), (5, 1, None));
        assert_eq!(rig.joints[4].origin, Vec3::Y + Vec3::Z);
    }

    #[test]
    fn what_is_left_of_a_mesh_keeps_its_joints() {
        let joints = Shared::new(vec![7, 8, 9]);
        let all = Follows { numbers: Shared::new(vec![0, 1, 2, 0, 1]), joints };
        let left = all.of_triangles(&[0, 1, 2, 3, 1, 4], DrawRange { first: 1, end: 2 });
        assert_eq!((0..3).map(|i| left.joint(i)).collect::<Vec<_>>(), [8, 7, 8]);
        let left = all.of_instances(DrawRange { first: 2, end: 4 });
        assert_eq!((0..2).map(|i| left.joint(i)).collect::<Vec<_>>(), [9, 7]);
    }
}
