//! Drawing less of what is far away: how much, by the distance from whoever looks.
//!
//! What fades is made once, in an order that thins evenly when it is drawn from its beginning up to
//! some place ([`even_order`]). A walk moves that place and nothing else.

use std::ops::Range;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Content, Digester, Shared, content};

use crate::Eye;

/// How a share, 1 for all, falls with the range; no stretches are a share of 0 everywhere.
///
/// A range is a distance in metres in the frame of what fades, as it would be in a picture with
/// [`Eye::REFERENCE_ROWS`] rows of pixels for each degree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Falloff(pub Vec<Stretch>);

/// The share on a stretch of ranges: `start - fall * (range / unit) ^ power`, between `least` and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it ends; the first stretch that ends beyond a range is in force there.
    pub until: f32,
    /// The share at range 0.
    pub start: f32,
    /// By how much it is less at one unit.
    pub fall: f32,
    /// The unit in metres, above 0.
    pub unit: f32,
    /// 1 where it falls evenly.
    pub power: f32,
    /// What it does not fall below.
    pub least: f32,
}

content!(Stretch { until, start, fall, unit, power, least });

impl Content for Falloff {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

impl Stretch {
    /// The same share up to `until`.
    pub fn constant(until: f32, share: f32) -> Self {
        Self { until, start: share, fall: 0.0, unit: 1.0, power: 1.0, least: 0.0 }
    }

    /// A share that falls evenly: `start - range / unit`.
    pub fn even(until: f32, start: f32, unit: f32) -> Self {
        Self { fall: 1.0, unit, ..Self::constant(until, start) }
    }
}

impl Falloff {
    /// Everything, however far away.
    pub fn none() -> Self {
        Self(vec![Stretch::constant(f32::INFINITY, 1.0)])
    }

    /// The share at a range, 0 to 1.
    pub fn share(&self, range: f32) -> f32 {
        let Some(stretch) = self.0.iter().find(|stretch| range < stretch.until) else { return 0.0 };
        let Stretch { start, fall, unit, power, least, .. } = *stretch;
        let units = range / unit;
        let fallen = if power == 1.0 { units } else { libm::powf(units, power) };
        let share = start - fall * fallen;
        // Written so that no number at all is a share of 0.
        if share > least { share.min(1.0) } else { least.clamp(0.0, 1.0) }
    }
}

/// How what is drawn under a node becomes less with the distance.
///
/// An *item* is what is drawn or left out together: a triangle of a mesh, an instance, a line, or
/// several of them that follow each other. Items come in *masses*, each of which loses as many.
#[derive(Clone, Debug, PartialEq)]
pub struct Fading {
    /// The share of the items that are drawn, from the first one on.
    pub shown: Falloff,
    /// The share of the items, from the first one on, that are left out, for something else shows
    /// them there.
    pub replaced: Falloff,
    /// How many items make a mass, at least 1: the array holds the first item of every mass, then
    /// the second ones, as [`even_order`] puts them.
    pub mass: u32,
    /// For each item, the number behind its last triangle, instance or line; nothing where each
    /// is an item of its own.
    pub ends: Option<Shared<Vec<u32>>>,
    /// Whether instances become larger as they become fewer, about their own origins, so that they
    /// cover as much; at most until a mass is one.
    pub keeps_coverage: bool,
}

content!(Fading { shown, replaced, mass, ends, keeps_coverage });

/// Which of the triangles, instances or lines of one row are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DrawRange {
    /// The first.
    pub first: u32,
    /// The one behind the last.
    pub end: u32,
}

impl DrawRange {
    /// Whether nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.first >= self.end
    }

    /// How many are drawn.
    pub fn len(&self) -> u32 {
        self.end.saturating_sub(self.first)
    }

    /// Whether this one is drawn.
    pub fn contains(&self, number: u32) -> bool {
        (self.first..self.end).contains(&number)
    }

    /// What is drawn of `all`.
    pub fn of<'a, T>(&self, all: &'a [T]) -> &'a [T] {
        let end = (self.end as usize).min(all.len());
        &all[(self.first as usize).min(end)..end]
    }

    /// As numbers.
    pub fn numbers(&self) -> Range<u32> {
        self.first..self.end
    }
}

impl Fading {
    /// The range, in the frame that `world` leads to the root from, of an eye in the root's frame;
    /// 0 where there is none to tell: a flat frame, no eye. What is scaled up fades later.
    pub fn range(world: &Affine3, eye: Option<&Eye>) -> f32 {
        let Some(eye) = eye else { return 0.0 };
        if world.matrix3.determinant() == 0.0 {
            return 0.0;
        }
        let distance = world.inverse().transform_point3(eye.position).length();
        let range = distance * (Eye::REFERENCE_ROWS / eye.rows_per_degree);
        if range.is_finite() { range } else { 0.0 }
    }

    /// What is drawn at a range of `n` triangles, instances or lines.
    pub fn drawn(&self, n: u32, range: f32) -> DrawRange {
        let n_items = self.ends.as_ref().map_or(n, |ends| ends.len() as u32);
        let behind = |share: f32| {
            let items = n_drawn(n_items, self.mass, share);
            match &self.ends {
                None => items,
                Some(ends) => {
                    let last = items.checked_sub(1).and_then(|last| ends.get(last as usize));
                    last.map_or(0, |end| (*end).min(n))
                }
            }
        };
        let end = behind(self.shown.share(range));
        DrawRange { first: behind(self.replaced.share(range)).min(end), end }
    }

    /// How much larger each instance is drawn at a range.
    pub fn growth(&self, range: f32) -> f32 {
        let share = self.shown.share(range);
        if self.keeps_coverage && share > 0.0 && share < 1.0 {
            (1.0 / share.sqrt()).min(self.largest_growth())
        } else {
            1.0
        }
    }

    /// How much larger instances may ever be drawn.
    pub fn largest_growth(&self) -> f32 {
        if self.keeps_coverage { (self.mass.max(1) as f32).sqrt() } else { 1.0 }
    }

    /// What is wrong, in words, over `n` triangles, instances or lines.
    pub fn fault(&self, n: usize) -> Option<String> {
        if self.mass == 0 {
            return Some("fades in masses of nothing".to_owned());
        }
        let stretches = self.shown.0.iter().chain(&self.replaced.0);
        for Stretch { until, start, fall, unit, power, least } in stretches {
            let numbers = [start, fall, unit, power, least];
            if !numbers.iter().all(|x| x.is_finite()) || until.is_nan() || *unit <= 0.0 {
                return Some("fades by what is no number, or by units of no length".to_owned());
            }
        }
        let ends = self.ends.as_deref()?;
        let is_ordered = ends.is_sorted() && ends.last().is_none_or(|end| *end as usize <= n);
        (!is_ordered).then(|| format!("fades by items that are not in order up to {n}"))
    }
}

/// How many of `n` items are drawn at a share: as many of each mass, and one more of the first
/// masses.
pub fn n_drawn(n: u32, mass: u32, share: f32) -> u32 {
    let mass = mass.max(1);
    let number = f64::from(share.clamp(0.0, 1.0)) * f64::from(mass);
    let of_each = number.floor() as u32;
    // The last mass may lack items at its end.
    let at_place = |place: u32| n.saturating_sub(place).div_ceil(mass);
    let change = f64::from(n.div_ceil(mass)) * (number - number.floor());
    let change = (change.floor() as u32).min(if of_each < mass { at_place(of_each) } else { 0 });
    // No mass has an item beyond the last.
    (0..of_each.min(n)).map(at_place).sum::<u32>() + change
}

/// The order of `n` items that thins evenly in masses of `mass`: the first item of every mass, then
/// the second ones, and so on. So what [`n_drawn`] counts always comes first.
pub fn even_order(n: u32, mass: u32) -> impl Iterator<Item = u32> {
    let mass = mass.max(1);
    (0..mass.min(n)).flat_map(move |place| (place..n).step_by(mass as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sapwood_geom::glam::Vec3;

    fn fading(shown: Falloff) -> Fading {
        Fading { shown, replaced: Falloff::default(), mass: 4, ends: None, keeps_coverage: false }
    }

    /// The loops as the paper has them.
    fn drawn_by_loops(n: u32, mass: u32, share: f32) -> Vec<u32> {
        let number = f64::from(share) * f64::from(mass);
        let k = number as u32;
        let masses = n.div_ceil(mass);
        let change = (f64::from(masses) * (number - f64::from(k))) as u32;
        let mut drawn = Vec::new();
        for m in 0..masses {
            let more = if m < change { k + 1 } else { k };
            drawn.extend((0..more).map(|i| m * mass + i).filter(|item| *item < n));
        }
        drawn
    }

    #[test]
    fn what_is_drawn_comes_first_in_the_even_order() {
        for n in [0, 1, 3, 4, 5, 16, 17, 100, 1001] {
            for mass in [1, 4, 16] {
                let order: Vec<u32> = even_order(n, mass).collect();
                let mut all = order.clone();
                all.sort_unstable();
                assert_eq!(all, (0..n).collect::<Vec<_>>());
                for i in 0..=40 {
                    let share = i as f32 / 40.0;
                    let mut first = order[..n_drawn(n, mass, share) as usize].to_vec();
                    first.sort_unstable();
                    assert_eq!(first, drawn_by_loops(n, mass, share), "{n} {mass} {share}");
                }
            }
        }
    }

    #[test]
    fn a_mass_larger_than_there_are_items_takes_no_longer() {
        assert_eq!(n_drawn(3, u32::MAX, 1.0), 3);
        assert_eq!(even_order(3, u32::MAX).collect::<Vec<_>>(), [0, 1, 2]);
    }

    #[test]
    fn shares_fall_by_their_stretches() {
        let falloff = Falloff(vec![
            Stretch::constant(10.0, 1.0),
            Stretch::even(30.0, 1.5, 20.0),
            Stretch { power: 0.5, least: 0.25, ..Stretch::even(f32::INFINITY, 1.0, 120.0) },
        ]);
        let shares = [0.0, 9.0, 10.0, 20.0, 30.0, 120.0].map(|range| falloff.share(range));
        assert_eq!(shares, [1.0, 1.0, 1.0, 0.5, 0.5, 0.25]);
        assert_eq!([f32::NAN, 1e9].map(|range| Falloff::default().share(range)), [0.0, 0.0]);
    }

    #[test]
    fn items_of_several_triangles_are_drawn_whole() {
        let mut fading = fading(Falloff(vec![Stretch::even(f32::INFINITY, 1.0, 10.0)]));
        fading.ends = Some(Shared::new(vec![10, 12, 14, 16]));
        let ends = [0.0, 2.4, 2.6, 5.0, 9.0].map(|range| fading.drawn(16, range).end);
        assert_eq!(ends, [16, 14, 12, 12, 0]);
        fading.replaced = Falloff(vec![Stretch::constant(3.0, 0.25)]);
        assert_eq!(fading.drawn(16, 2.0), DrawRange { first: 10, end: 14 });
        assert_eq!(fading.drawn(16, 9.0), DrawRange { first: 0, end: 0 });
        assert_eq!(fading.fault(16), None);
        assert!(fading.fault(15).is_some());
    }

    #[test]
    fn the_range_is_the_distance_as_it_looks() {
        let eye = Eye { rows_per_degree: 2.0 * Eye::REFERENCE_ROWS, ..Eye::new(Vec3::X * 30.0) };
        let at = Affine3::from_translation(Vec3::X * 10.0);
        assert_eq!(Fading::range(&at, Some(&eye)), 10.0);
        let large = at * Affine3::from_scale(Vec3::splat(4.0));
        assert_eq!(Fading::range(&large, Some(&eye)), 2.5);
        assert_eq!(Fading::range(&at, None), 0.0);
    }

    #[test]
    fn instances_cover_as_much_while_a_mass_has_one() {
        let falloff = Falloff(vec![Stretch::even(f32::INFINITY, 1.0, 10.0)]);
        let fading = Fading { keeps_coverage: true, ..fading(falloff) };
        let growths = [0.0, 7.5, 9.9, 11.0].map(|range| fading.growth(range));
        assert_eq!(growths, [1.0, 2.0, 2.0, 1.0]);
    }
}
