//! Forks: how several tubes leave one ring, so that their walls meet edge to edge.
//!
//! Each tube keeps an arc of the ring. Where the other tubes' arcs are it turns inward, along
//! spokes that it shares with its neighbours on either side; the spokes meet in the middle.

use glam::Vec2;

use crate::Section;

/// A ring that several tubes of one section leave.
///
/// Its points are numbered: the places of the ring first, then those inside it. Every edge
/// between neighbouring points bounds the walls of two tubes, or of one and of the tube below.
#[derive(Clone, Debug, PartialEq)]
pub struct Fork {
    sides: u32,
    feet: Vec<Foot>,
    /// Points inside the ring, for radius 1.
    inner: Vec<Vec2>,
}

/// How far apart the points of a fork are at least, for radius 1.
const APART: f32 = 0.05;

/// What one tube stands on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Foot {
    /// The side of the ring where the tube turns inward first.
    pub(super) first: u32,
    /// The points along its inner sides, one more than there are sides; equal neighbours make
    /// one triangle of a side.
    pub(super) points: Vec<u32>,
}

impl Foot {
    fn n_inner(&self) -> u32 {
        self.points.len() as u32 - 1
    }
}

impl Fork {
    /// Parts the ring of `section` among tubes that leave in directions whose share in the
    /// ring's plane is `toward`; nothing where there are fewer than two, or more than half as
    /// many as sides.
    pub fn new(section: &Section, toward: &[Vec2]) -> Option<Self> {
        let (sides, n) = (section.n_sides(), toward.len() as u32);
        if n < 2 || 2 * n > sides {
            return None;
        }
        let order = around(toward);
        let borders = borders(toward, &order, sides);
        // As many edges on every spoke as a quarter of the ring has places: the mean of two
        // places on either side of the spoke would lie beyond the middle. Fewer where points
        // would lie too near to each other, on arcs of very different lengths.
        let most = (sides / 4).max(1);
        (1..=most).rev().find_map(|edges| Self::with_spokes(section, &order, &borders, edges))
    }

    /// The fork with so many edges on every spoke; nothing where a tube has not enough inner
    /// sides for them, or points would be hard to tell apart.
    fn with_spokes(
        section: &Section,
        order: &[usize],
        borders: &[u32],
        edges: u32,
    ) -> Option<Self> {
        let (sides, n) = (section.n_sides(), order.len() as u32);
        let n_inner = |own: u32| sides - own;
        let own = |j: usize| {
            let before = borders[(j + borders.len() - 1) % borders.len()];
            (borders[j] + sides - before) % sides
        };
        if (0..order.len()).any(|j| n_inner(own(j)) < 2 * edges) {
            return None;
        }
        let center = sides + n * (edges - 1);
        let on_spoke = |spoke: u32, from_ring: u32| match from_ring {
            0 => borders[spoke as usize],
            i if i == edges => center,
            i => sides + spoke * (edges - 1) + i - 1,
        };
        let mut feet = vec![Foot { first: 0, points: Vec::new() }; order.len()];
        let mut inner = vec![(Vec2::ZERO, 0u32); (center + 1 - sides) as usize];
        for (j, tube) in order.iter().enumerate() {
            let (first, last) = (j as u32, (j as u32 + n - 1) % n);
            let n_inner = n_inner(own(j));
            let start = borders[j];
            let point = |i: u32| match (i.min(edges), (n_inner - i).min(edges)) {
                (from_first, to_last) if from_first <= to_last => on_spoke(first, from_first),
                (_, to_last) => on_spoke(last, to_last),
            };
            let points: Vec<u32> = (0..=n_inner).map(point).collect();
            for (i, point) in (0..).zip(&points) {
                if let Some(inside) = point.checked_sub(sides) {
                    let (sum, weight) = &mut inner[inside as usize];
                    *sum += section.points[((start + i) % sides) as usize];
                    *weight += 1;
                }
            }
            feet[*tube] = Foot { first: start, points };
        }
        let inner: Vec<Vec2> =
            inner.into_iter().map(|(sum, weight)| sum / weight.max(1) as f32).collect();
        let on_ring = borders.iter().map(|place| section.points[*place as usize]);
        let points: Vec<Vec2> = inner.iter().copied().chain(on_ring).collect();
        let is_apart = |i: usize| points[i + 1..].iter().all(|p| p.distance(points[i]) > APART);
        (0..inner.len()).all(is_apart).then_some(Self { sides, feet, inner })
    }

    /// The points of the fork on which side number `side` of a tube stands, from its place to
    /// the next; nothing where the tube keeps the ring there.
    pub fn inward(&self, tube: usize, side: u32) -> Option<[u32; 2]> {
        let foot = &self.feet[tube];
        let i = (side + self.sides - foot.first) % self.sides;
        (i < foot.n_inner()).then(|| [i, i + 1].map(|i| foot.points[i as usize]))
    }

    /// How many sides of a tube have one triangle instead of two, next to the fork.
    pub fn n_narrow(&self, tube: usize) -> usize {
        self.feet[tube].points.windows(2).filter(|ends| ends[0] == ends[1]).count()
    }

    pub(super) fn foot(&self, tube: usize) -> &Foot {
        &self.feet[tube]
    }

    /// Where a point lies, for radius 1.
    pub(super) fn point(&self, section: &Section, number: u32) -> Vec2 {
        match number.checked_sub(self.sides) {
            None => section.points[number as usize],
            Some(inside) => self.inner[inside as usize],
        }
    }
}

fn angle(v: Vec2) -> f32 {
    libm::atan2f(v.y, v.x)
}

/// The tubes' numbers, counter-clockwise around the mean of their directions.
fn around(toward: &[Vec2]) -> Vec<usize> {
    let middle = toward.iter().sum::<Vec2>() / toward.len() as f32;
    let mut order: Vec<usize> = (0..toward.len()).collect();
    order.sort_by(|a, b| angle(toward[*a] - middle).total_cmp(&angle(toward[*b] - middle)));
    order
}

/// For each tube in `order` the place of the ring where its arc ends and the next one's begins.
/// Every arc has a side at least, and no arc more than all but two.
fn borders(toward: &[Vec2], order: &[usize], sides: u32) -> Vec<u32> {
    use std::f32::consts::TAU;
    let n = order.len() as u32;
    let middle = toward.iter().sum::<Vec2>() / n as f32;
    let angles: Vec<f32> = order.iter().map(|tube| angle(toward[*tube] - middle)).collect();
    let mut borders: Vec<u32> = Vec::with_capacity(order.len());
    let first = angles.first().copied().unwrap_or(0.0);
    for (j, own) in angles.iter().enumerate() {
        let next = angles.get(j + 1).copied().unwrap_or(first + TAU);
        let place = (0.5 * (own + next) + TAU) * (sides as f32 / TAU);
        let place = place.round().max(0.0) as u32;
        let place = match (borders.first(), borders.last()) {
            (Some(first), Some(last)) => {
                // One side for each arc that is still to come, and two that are not this one's.
                let most = first + sides - (n - j as u32);
                place.max(last + 1).min(most).min(last + sides - 2)
            }
            _ => place,
        };
        borders.push(place);
    }
    // The first arc lies between the last border and the first; two sides at least are others'.
    if let (Some(first), Some(last)) = (borders.first().copied(), borders.last_mut()) {
        if *last < first + 2 {
            *last = first + 2;
        }
        *last = (*last).min(first + sides - 1);
    }
    borders.into_iter().map(|place| place % sides).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn spread(n: u32, offset: f32) -> Vec<Vec2> {
        let angle = |i| offset + std::f32::consts::TAU * i as f32 / n as f32;
        (0..n).map(|i| Vec2::new(libm::cosf(angle(i)), libm::sinf(angle(i)))).collect()
    }

    /// Every edge of the fork has a tube on either side, or one and the ring below.
    fn check(section: &Section, toward: &[Vec2]) {
        let sides = section.n_sides();
        let Some(fork) = Fork::new(section, toward) else { panic!("{sides} sides, {toward:?}") };
        let mut edges = BTreeMap::<(u32, u32), i32>::new();
        let mut add = |a: u32, b: u32| {
            if a != b {
                *edges.entry((a, b)).or_default() += 1;
            }
        };
        for side in 0..sides {
            add((side + 1) % sides, side);
        }
        for tube in 0..toward.len() {
            let mut n_kept = 0;
            for side in 0..sides {
                match fork.inward(tube, side) {
                    Some([a, b]) => add(a, b),
                    None => {
                        n_kept += 1;
                        add(side, (side + 1) % sides);
                    }
                }
            }
            assert!(n_kept >= 1 && n_kept <= sides - 2, "{n_kept} of {sides}, {toward:?}");
        }
        for ((a, b), n) in &edges {
            assert_eq!((*n, edges.get(&(*b, *a))), (1, Some(&1)), "{a} {b}: {toward:?}");
        }
        for (i, a) in fork.inner.iter().enumerate() {
            assert!(a.length() < 1.3, "{a}");
            assert!(fork.inner[..i].iter().all(|b| b.distance(*a) > APART), "{:?}", fork.inner);
        }
    }

    #[test]
    fn tubes_meet_edge_to_edge() {
        for sides in 4..24 {
            let section = Section::round(sides);
            for n in 2..=(sides / 2).min(5) {
                for offset in 0..40 {
                    check(&section, &spread(n, 0.17 * offset as f32));
                }
            }
            // Unevenly, one within the others, and all alike.
            check(&section, &[Vec2::ZERO, Vec2::new(0.3, 0.1)]);
            check(&section, &[Vec2::X, Vec2::X]);
            if sides >= 8 {
                check(&section, &[Vec2::ZERO, Vec2::X, Vec2::NEG_X, Vec2::Y]);
                check(&section, &[Vec2::X, Vec2::new(1.0, 0.01), Vec2::new(1.0, 0.02)]);
                check(&section, &[Vec2::ZERO; 4]);
            }
        }
    }

    #[test]
    fn any_directions_can_be_parted() {
        let mut stream = crate::Stream::new(crate::StreamPath::new(3), crate::Purpose("fork"));
        for i in 0..20_000 {
            let sides = 4 + i % 20;
            let lobed = Section::lobed(4 * (i % 5 + 1), i % 5 + 1, 0.3);
            let section = if i % 3 == 0 { lobed } else { Section::round(sides) };
            let n = 2 + i % (section.n_sides() / 2 - 1).min(5);
            let mut next = || stream.between(-1.0, 1.0);
            let toward: Vec<Vec2> = (0..n).map(|_| Vec2::new(next(), next())).collect();
            check(&section, &toward);
        }
    }

    #[test]
    fn what_cannot_be_parted_is_not() {
        assert_eq!(Fork::new(&Section::round(3), &spread(2, 0.0)), None);
        assert_eq!(Fork::new(&Section::round(12), &spread(1, 0.0)), None);
        assert_eq!(Fork::new(&Section::round(8), &spread(5, 0.0)), None);
    }

    #[test]
    fn two_halves_share_a_straight_edge() {
        let fork = Fork::new(&Section::round(8), &[Vec2::X, Vec2::NEG_X]).unwrap();
        assert_eq!(fork.inner.len(), 3);
        assert!(fork.inner.iter().all(|point| point.x.abs() < 1e-6), "{:?}", fork.inner);
        assert!((fork.inner[0].y.abs() - 0.5f32.sqrt()).abs() < 1e-6);
    }
}
