//! The range function: which share of a tree's stems and leaves is drawn at a distance, after
//! section 5 of the paper.
//!
//! Four kinds of items, each as polygons and as lines or points. What the paper draws twice nearby,
//! a line inside its tube, is left to whoever draws.

use sapwood_geom::{Content, Digester, content};
use sapwood_graph::{Falloff, Stretch};

/// When the tree is looked at: leaves that have just come out are smaller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Season {
    /// Leaves fade at half the distance, branches later.
    Spring,
    /// As most of the paper's figures are.
    #[default]
    Summer,
    /// As in summer.
    Autumn,
    /// Branches show, and fade later.
    Winter,
}

impl Content for Season {
    fn write(&self, digester: &mut Digester) {
        digester.add(&(*self as u8));
    }
}

/// How a tree fades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadingParams {
    /// The paper's quality, above 0 and near 1: branches fade the later the higher it is.
    pub quality: f32,
    /// When.
    pub season: Season,
    /// Whether the tree keeps its leaves, so that branches are hidden in every season.
    pub is_evergreen: bool,
    /// Whether what is left of the leaves becomes larger, so that they cover as much.
    pub keeps_coverage: bool,
    /// The range that a tree is compiled for, once and for all, instead of following the eye.
    pub fixed_range: Option<f32>,
}

content!(FadingParams { quality, season, is_evergreen, keeps_coverage, fixed_range });

impl Default for FadingParams {
    fn default() -> Self {
        Self {
            quality: 1.0,
            season: Season::Summer,
            is_evergreen: false,
            keeps_coverage: false,
            fixed_range: None,
        }
    }
}

impl FadingParams {
    /// How much larger than they are leaves may be drawn where they keep their coverage.
    pub fn largest_growth(&self) -> f32 {
        if self.keeps_coverage { (FadingItem::Leaves.mass() as f32).sqrt() } else { 1.0 }
    }
}

/// What fades alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FadingItem {
    /// The trunk.
    Level0,
    /// The branches that grow on it.
    Level1,
    /// All other branches.
    Deeper,
    /// The leaves.
    Leaves,
}

impl FadingItem {
    /// The stems of a level.
    pub fn of_level(level: u8) -> Self {
        match level {
            0 => Self::Level0,
            1 => Self::Level1,
            _ => Self::Deeper,
        }
    }

    /// How many items one mass has, of which the same share is left.
    pub fn mass(self) -> u32 {
        match self {
            Self::Level0 | Self::Level1 | Self::Deeper => 16,
            Self::Leaves => 4,
        }
    }

    /// The share that is drawn as polygons.
    pub fn polygons(self, params: &FadingParams) -> Falloff {
        let Factors { s, d } = params.factors();
        let (all, even) = (|until| Stretch::constant(until, 1.0), Stretch::even);
        Falloff(match self {
            Self::Level0 => vec![all(300.0), even(800.0, 1.5, 600.0)],
            Self::Level1 => vec![even(200.0 * s, 1.5, 600.0)],
            Self::Deeper => vec![all(50.0 * s), even(100.0 * s, 2.0, 50.0 * s)],
            Self::Leaves => vec![all(0.25 * d), even(d, 4.0 / 3.0, 0.75 * d)],
        })
    }

    /// The share that is drawn as lines or points.
    pub fn lines(self, params: &FadingParams) -> Falloff {
        let Factors { s, d } = params.factors();
        let all = |until| Stretch::constant(until, 1.0);
        let falling = |until, start, fall, unit, power| Stretch {
            fall,
            power,
            ..Stretch::even(until, start, unit)
        };
        Falloff(match self {
            // Nearby they would show as a seam.
            Self::Level0 => vec![Stretch::constant(100.0, 0.0), all(f32::INFINITY)],
            Self::Level1 => {
                vec![all(200.0 * s), falling(2000.0 * s, 2.2, 1.2, 200.0 * s, 0.3)]
            }
            Self::Deeper => vec![all(100.0 * s), falling(500.0 * s, 2.0, 1.0, 100.0 * s, 0.5)],
            Self::Leaves => {
                let least = 1.0 / self.mass() as f32;
                vec![all(d), Stretch { least, ..Stretch::even(f32::INFINITY, 1.5, 2.0 * d) }]
            }
        })
    }
}

/// The paper's `s` and `d`.
struct Factors {
    s: f32,
    d: f32,
}

impl FadingParams {
    fn factors(&self) -> Factors {
        let is_hidden = self.is_evergreen || matches!(self.season, Season::Summer | Season::Autumn);
        // Units must have a length.
        let quality = self.quality.clamp(0.01, 100.0);
        Factors {
            s: if is_hidden { 0.5 * quality } else { quality },
            d: if self.season == Season::Spring { 100.0 } else { 200.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sapwood_graph::n_drawn;

    const RANGES: [f32; 7] = [5.0, 30.0, 60.0, 120.0, 240.0, 600.0, 1200.0];

    /// The paper's table for its aspen in summer: triangles, or lines or points, at each range.
    /// Where the formulas give something else, that stands behind, as whole items.
    struct Row {
        item: FadingItem,
        as_polygons: bool,
        /// Triangles, lines or points of one item.
        each: u32,
        printed: [u32; 7],
        /// Cells (by range) in which print and formula differ, with what the formula gives.
        differing: &'static [(f32, u32)],
    }

    #[rustfmt::skip]
    const TABLE: [Row; 8] = [
        Row { item: FadingItem::Level0, as_polygons: true, each: 40,
            printed: [1440, 1440, 1440, 1440, 1440, 760, 0], differing: &[(600.0, 720)] },
        Row { item: FadingItem::Level0, as_polygons: false, each: 1,
            printed: [0, 0, 0, 36, 36, 36, 36], differing: &[] },
        Row { item: FadingItem::Level1, as_polygons: true, each: 4,
            printed: [960, 960, 960, 0, 0, 0, 0], differing: &[] },
        Row { item: FadingItem::Level1, as_polygons: false, each: 1,
            printed: [240, 240, 240, 223, 153, 35, 0], differing: &[(120.0, 224)] },
        Row { item: FadingItem::Deeper, as_polygons: true, each: 3,
            printed: [17736, 14580, 0, 0, 0, 0, 0], differing: &[(30.0, 14189)] },
        Row { item: FadingItem::Deeper, as_polygons: false, each: 1,
            printed: [5912, 5912, 5363, 2648, 0, 0, 0],
            differing: &[(60.0, 5348), (120.0, 2665)] },
        Row { item: FadingItem::Leaves, as_polygons: true, each: 4,
            printed: [53248, 53248, 49800, 28200, 0, 0, 0],
            differing: &[(60.0, 49698), (120.0, 28399)] },
        Row { item: FadingItem::Leaves, as_polygons: false, each: 1,
            printed: [13312, 13312, 13312, 13312, 11944, 1664, 1664],
            differing: &[(240.0, 11981), (600.0, 3328), (1200.0, 3328)] },
    ];

    #[test]
    fn the_papers_table_is_met_within_an_item_of_each_mass() {
        let params = FadingParams::default();
        for Row { item, as_polygons, each, printed, differing } in TABLE {
            let falloff = if as_polygons { item.polygons(&params) } else { item.lines(&params) };
            // The whole of it is drawn somewhere in the row.
            let n_items = printed.iter().max().unwrap() / each;
            let n_masses = n_items.div_ceil(item.mass());
            for (range, printed) in RANGES.into_iter().zip(printed) {
                let cell = format!("{item:?} polygons {as_polygons} at {range} m");
                let share = falloff.share(range);
                let items = n_drawn(n_items, item.mass(), share);
                assert!((items * each).abs_diff(printed) <= n_masses * each, "{cell}: {items}");
                let differs = differing.iter().find(|(there, _)| *there == range);
                let formula = differs.map_or(printed, |(_, formula)| *formula);
                let by_formula = f64::from(share) * f64::from(n_items * each);
                assert!((by_formula - f64::from(formula)).abs() < 1.0, "{cell}: {by_formula}");
                // The last mass may be smaller than the others.
                let n = f64::from(items * each);
                assert!((n - by_formula).abs() < f64::from(4 * each), "{cell}: {n} {by_formula}");
            }
        }
    }

    #[test]
    fn lines_of_the_trunk_begin_where_the_paper_has_them() {
        let lines = FadingItem::Level0.lines(&FadingParams::default());
        assert_eq!([99.0, 100.0, 1e6].map(|range| lines.share(range)), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn branches_show_longer_without_leaves() {
        let at = |params: FadingParams| FadingItem::Deeper.polygons(&params).share(60.0);
        let winter = FadingParams { season: Season::Winter, ..FadingParams::default() };
        let pine = FadingParams { is_evergreen: true, ..winter };
        assert_eq!((at(FadingParams::default()), at(pine)), (0.0, 0.0));
        assert!((at(winter) - 0.8).abs() < 1e-6);
        let spring = FadingParams { season: Season::Spring, ..winter };
        assert_eq!(FadingItem::Leaves.polygons(&spring).share(100.0), 0.0);
        assert!(FadingItem::Leaves.polygons(&winter).share(100.0) > 0.5);
    }
}
