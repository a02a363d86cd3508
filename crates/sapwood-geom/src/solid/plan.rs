//! In which order solids are joined: groups of one height after the other, and what is known of
//! how far that has come.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use manifold_rust::cancel::CancelToken;
use rayon::prelude::*;

use super::boolean::{Part, join};
use super::{Member, Solid, Union, UnionError, UnionStep};
use crate::{Digest, Digester};

/// What is to be joined in which order.
pub(super) struct Plan<'a> {
    solids: &'a [Solid],
    groups: &'a [Vec<Member>],
    /// Of each group the number of its first solid.
    firsts: Vec<u32>,
    pub(super) heights: Vec<usize>,
    pub(super) digests: Vec<Digest>,
}

impl<'a> Plan<'a> {
    pub(super) fn new(solids: &'a [Solid], groups: &'a [Vec<Member>]) -> Self {
        let of_solids: Vec<Digest> = solids.par_iter().map(Digest::of).collect();
        let mut plan = Plan {
            solids,
            groups,
            firsts: vec![u32::MAX; groups.len()],
            heights: vec![0; groups.len()],
            digests: Vec::with_capacity(groups.len()),
        };
        let mut ends = vec![0; groups.len()];
        for (number, members) in groups.iter().enumerate() {
            let mut digester = Digester::new();
            // The whole is checked more than what is joined further.
            digester.add(&(number + 1 == groups.len())).add(&members.len());
            let mut next = None;
            for member in members {
                let (first, end) = match member {
                    Member::Solid(solid) => {
                        digester.add(&of_solids[*solid as usize]);
                        (*solid, *solid + 1)
                    }
                    Member::Group(below) => {
                        let below = *below as usize;
                        assert!(below < number, "groups stand before those that hold them");
                        digester.add(&plan.digests[below]);
                        plan.heights[number] = plan.heights[number].max(plan.heights[below] + 1);
                        (plan.firsts[below], ends[below])
                    }
                };
                assert!(next.is_none_or(|next| next == first), "solids come in order");
                plan.firsts[number] = plan.firsts[number].min(first);
                next = Some(end);
            }
            ends[number] = next.unwrap_or(0);
            plan.digests.push(digester.finish());
        }
        let (first, end) = (plan.firsts.last(), ends.last());
        let is_all =
            end == Some(&(solids.len() as u32)) && (solids.is_empty() || first == Some(&0));
        assert!(is_all, "the last group holds all solids");
        plan
    }

    /// Joins groups of one height after the other, those of a height side by side.
    pub(super) fn run(
        &self,
        steps: &[Vec<usize>],
        done: &mut [Option<Arc<Union>>],
        token: &CancelToken,
        stage: &Stage,
    ) -> Result<(), UnionError> {
        for step in steps {
            let joined: Vec<Result<Union, UnionError>> =
                step.par_iter().map(|number| self.join(*number, done, token, stage)).collect();
            for (number, union) in step.iter().zip(joined) {
                done[*number] = Some(Arc::new(union?));
            }
        }
        Ok(())
    }

    fn join(
        &self,
        number: usize,
        done: &[Option<Arc<Union>>],
        token: &CancelToken,
        stage: &Stage,
    ) -> Result<Union, UnionError> {
        let members = &self.groups[number];
        let parts = members.iter().filter_map(|member| match member {
            Member::Solid(solid) => Some(Part::Solid(*solid, &self.solids[*solid as usize])),
            Member::Group(below) => {
                let below = *below as usize;
                Some(Part::Union(self.firsts[below], done[below].as_deref()?))
            }
        });
        let parts: Vec<Part<'_>> = parts.collect();
        let is_whole = number + 1 == self.groups.len();
        join(&parts, self.firsts[number], is_whole, token, stage)
    }
}

/// How far the work has come, for whoever looks on.
#[derive(Default)]
pub(super) struct Stage {
    checked: AtomicUsize,
    joined: AtomicUsize,
}

impl Stage {
    /// Notes that one more part was looked at.
    pub(super) fn checked(&self) {
        self.checked.fetch_add(1, Ordering::Relaxed);
    }

    /// Notes that so many more parts were joined.
    pub(super) fn joined(&self, n: usize) {
        self.joined.fetch_add(n, Ordering::Relaxed);
    }

    pub(super) fn step(&self) -> UnionStep {
        match self.joined.load(Ordering::Relaxed) {
            0 => UnionStep::Checked { parts: self.checked.load(Ordering::Relaxed) },
            parts => UnionStep::Joined { parts },
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3, Vec3};
    use rayon::ThreadPoolBuilder;

    use super::*;
    use crate::shapes::sphere;
    use crate::{Mesh, Purpose, Stream, StreamPath};

    /// Balls in a heap, so many that they are joined in several batches.
    fn heap(n: usize) -> Vec<Solid> {
        let mut stream = Stream::new(StreamPath::new(11), Purpose("heap"));
        let mut ball = || {
            let center = Vec3::from_array([(); 3].map(|()| stream.between(-1.0, 1.0)));
            let scale = Affine3::from_scale(Vec3::splat(stream.between(0.05, 0.2)));
            let mut mesh = Mesh::default();
            mesh.append(&sphere(2), &(Affine3::from_translation(center) * scale));
            Solid::of_mesh(&mesh)
        };
        (0..n).map(|_| ball()).collect()
    }

    #[test]
    fn any_number_of_threads_joins_the_same_to_the_same() {
        let solids = heap(300);
        let four = |first: u32| (first..first + 75).map(Member::Solid).collect();
        let mut groups: Vec<Vec<Member>> = [0, 75, 150, 225].map(four).into();
        groups.push([0, 1].map(Member::Group).into());
        groups.push([4, 2, 3].map(Member::Group).into());
        let steps = [vec![0, 1, 2, 3], vec![4], vec![5]];
        let joined = |n_threads: usize| {
            let pool = ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| {
                let plan = Plan::new(&solids, &groups);
                let mut done = vec![None; groups.len()];
                let (token, stage) = (CancelToken::new(), Stage::default());
                plan.run(&steps, &mut done, &token, &stage).unwrap();
                done.pop().flatten().unwrap()
            })
        };
        let one = joined(1);
        assert!(one.report.is_sound() && one.mended.faults > 0, "{} {:?}", one.report, one.mended);
        for n_threads in [2, 4] {
            let several = joined(n_threads);
            assert!(one.solid == several.solid, "corners or triangles differ on {n_threads}");
            assert!(one.sources == several.sources && one.strayed == several.strayed);
            assert_eq!((one.mended, one.report), (several.mended, several.report));
        }
    }
}
