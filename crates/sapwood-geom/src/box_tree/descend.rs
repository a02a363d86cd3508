//! Going down a tree of boxes from the top, with something known of each box.

use smallvec::SmallVec;

use super::BoxTree;
use super::wide::{Child, WIDTH};
use crate::Aabb;

impl BoxTree {
    /// What is in each box of the tree, from the bottom up: `gather` makes it of the numbers of
    /// things or of what was made for the boxes below, whichever there is; of neither for places
    /// in the tree that stay empty. Nothing where there are few things, for these have no boxes.
    pub(crate) fn summaries<T: Clone>(
        &self,
        empty: T,
        mut gather: impl FnMut(&[u32], &[T]) -> T,
    ) -> Vec<T> {
        let mut all = vec![empty; WIDTH * self.nodes.len()];
        // Nodes stand behind those above them.
        for (number, node) in self.nodes.iter().enumerate().rev() {
            for lane in 0..WIDTH {
                all[WIDTH * number + lane] = match node.child(lane) {
                    Child::Nothing => continue,
                    Child::Items(places) => gather(&self.items[places], &[]),
                    Child::Node(below) => gather(&[], &all[WIDTH * below as usize..][..WIDTH]),
                };
            }
        }
        all
    }

    /// Calls `each` for the number of every thing in boxes that `go` wants to go into. `go` is
    /// told the place of a box among the [summaries](Self::summaries), and the box, which is a
    /// little larger than what is in it. Where there are few things `go` is not asked.
    pub(crate) fn descend(
        &self,
        mut go: impl FnMut(usize, &Aabb) -> bool,
        mut each: impl FnMut(u32),
    ) {
        if self.nodes.is_empty() {
            self.items.iter().for_each(|item| each(*item));
            return;
        }
        let mut stack: SmallVec<[u32; 64]> = SmallVec::new();
        stack.push(0);
        while let Some(number) = stack.pop() {
            let node = &self.nodes[number as usize];
            for lane in 0..WIDTH {
                let child = node.child(lane);
                if matches!(child, Child::Nothing)
                    || !go(WIDTH * number as usize + lane, &node.aabb(lane))
                {
                    continue;
                }
                match child {
                    Child::Nothing => {}
                    Child::Items(places) => self.items[places].iter().for_each(|item| each(*item)),
                    Child::Node(below) => stack.push(below),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn summaries_cover_all_and_lead_to_what_is_sought() {
        let cube = |x: f32| Aabb { min: Vec3::splat(x), max: Vec3::splat(x + 0.5) };
        for n in [3, 1000] {
            let tree = BoxTree::new((0..n).map(|i| cube(i as f32)));
            let sums = tree.summaries(0, |items, below| {
                items.iter().copied().chain(below.iter().copied()).sum()
            });
            let top: u32 = sums.iter().take(WIDTH).sum();
            assert_eq!(top, if sums.is_empty() { 0 } else { n * (n - 1) / 2 });
            let (mut found, mut n_looked_at) = (Vec::new(), 0);
            let sought = cube(n as f32 - 2.0);
            let go = |_, aabb: &Aabb| {
                n_looked_at += 1;
                aabb.intersects(&sought)
            };
            tree.descend(go, |item| found.push(item));
            assert!(found.contains(&(n - 2)) && found.len() <= 8, "{found:?}");
            assert!(n_looked_at < 60, "{n_looked_at}");
        }
    }
}
