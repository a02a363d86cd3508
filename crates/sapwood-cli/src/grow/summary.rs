//! What was grown, as a short table: how many of what, how large, how long each step took.

use std::fmt;
use std::time::Duration;

use sapwood::geom::Aabb;
use sapwood::graph::{Everything, Handlers, Kind, Order, WeldReport, grouped};
use sapwood::io::Swayed;
use sapwood::rules::weber_penn::{Leaf, Segment, Stem};
use sapwood::scene::{Scene, ViewError, ViewId};

use crate::picture::Toll;

/// Numbers of parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Census {
    /// Stems with their clones, by level.
    pub(crate) stems: Vec<u64>,
    pub(crate) segments: u64,
    pub(crate) leaves: u64,
}

impl Census {
    /// Counts what a view shows, with at least `n_levels` rows of stems.
    pub(crate) fn of(scene: &mut Scene, view: ViewId, n_levels: u32) -> Result<Self, ViewError> {
        let handlers = Handlers::<Self>::new()
            .on_parts::<Stem>(|census, stems, _| {
                for stem in stems {
                    let level = usize::from(stem.seed.level);
                    if census.stems.len() <= level {
                        census.stems.resize(level + 1, 0);
                    }
                    census.stems[level] += 1;
                }
            })
            .on_parts::<Segment>(|census, segments, _| census.segments += segments.len() as u64)
            .on_parts::<Leaf>(|census, leaves, _| census.leaves += leaves.len() as u64);
        let mut census = Self { stems: vec![0; n_levels as usize], ..Self::default() };
        scene
            .traverse(view, Order::Pre, &Everything, &mut |at| handlers.handle(&mut census, at))?;
        Ok(census)
    }
}

/// A step, how long it took, and the bytes that it wrote.
#[derive(Clone, Debug)]
pub(crate) struct Phase {
    pub(crate) name: String,
    pub(crate) time: Duration,
    pub(crate) bytes: Option<u64>,
}

/// Everything that the table tells; its `Display` is the table.
#[derive(Clone, Debug)]
pub(crate) struct Summary {
    pub(crate) species: String,
    pub(crate) title: String,
    pub(crate) census: Census,
    /// Compiled components by kind; not in the table.
    pub(crate) components: Vec<(Kind, u64)>,
    /// Vertices and triangles; nothing where no surfaces were asked for.
    pub(crate) surfaces: Option<(u64, u64)>,
    /// What welding made, if it was asked for.
    pub(crate) welded: Option<WeldReport>,
    /// What moves in files, if anything was asked to.
    pub(crate) swayed: Option<Swayed>,
    pub(crate) bounds: Aabb,
    pub(crate) phases: Vec<Phase>,
    /// What somebody might not expect of the files.
    pub(crate) notes: Vec<String>,
    /// What pictures took, if there are any.
    pub(crate) picture: Option<Toll>,
}

impl Summary {
    fn counts(&self) -> Vec<(String, String)> {
        let Census { stems, segments, leaves } = &self.census;
        let levels = stems.iter().enumerate();
        let mut rows: Vec<_> =
            levels.map(|(n, stems)| (format!("stems, level {n}"), *stems)).collect();
        rows.push(("segments".to_owned(), *segments));
        if let Some((vertices, triangles)) = self.surfaces {
            rows.push(("leaves".to_owned(), *leaves));
            rows.push(("vertices".to_owned(), vertices));
            rows.push(("triangles".to_owned(), triangles));
        }
        if let Some(welded) = &self.welded {
            rows.push(("welded stems".to_owned(), welded.n_solids as u64));
            rows.push(("welded triangles".to_owned(), welded.n_triangles));
        }
        if let Some(swayed) = &self.swayed {
            rows.push(("joints".to_owned(), swayed.n_joints as u64));
            rows.push(("rigid joints".to_owned(), swayed.n_rigid as u64));
        }
        if let Some(toll) = &self.picture {
            rows.push(("rays".to_owned(), toll.n_rays()));
        }
        rows.into_iter().map(|(name, n)| (name, grouped(n))).collect()
    }

    fn metres(&self) -> Vec<[String; 4]> {
        let row =
            |name: &str, [x, y, z]: [f32; 3]| [name.to_owned(), metres(x), metres(y), metres(z)];
        let mut rows = vec![["metres", "x", "y", "z"].map(str::to_owned)];
        rows.push(row("size", self.bounds.size().to_array()));
        if !self.bounds.is_empty() {
            rows.push(row("min", self.bounds.min.to_array()));
            rows.push(row("max", self.bounds.max.to_array()));
        }
        rows
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.title)?;
        let counts = self.counts();
        let names = counts.iter().map(|(name, _)| name).chain(self.phases.iter().map(|p| &p.name));
        let first = names.map(|name| name.chars().count()).max().unwrap_or(0);
        let second = counts.iter().map(|(_, n)| n.len()).max().unwrap_or(0).max(9);
        for (name, n) in counts {
            writeln!(f, "{name:first$}  {n:>second$}")?;
        }
        writeln!(f)?;
        for [name, x, y, z] in self.metres() {
            writeln!(f, "{name:first$}  {x:>second$}  {y:>second$}  {z:>second$}")?;
        }
        writeln!(f)?;
        for Phase { name, time, bytes } in &self.phases {
            let time = format!("{:.1} ms", time.as_secs_f64() * 1e3);
            write!(f, "{name:first$}  {time:>second$}")?;
            match bytes {
                None => writeln!(f)?,
                Some(bytes) => writeln!(f, "  {:>second$}", size(*bytes))?,
            }
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "\n{note}"))
    }
}

/// Centimetres are enough, and nothing is -0.
fn metres(x: f32) -> String {
    let text = format!("{x:.2}");
    if text == "-0.00" { "0.00".to_owned() } else { text }
}

/// A file's size in the unit that suits it.
pub(crate) fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use sapwood::geom::glam::Vec3;

    use super::*;

    fn summary() -> Summary {
        let phase = |name: &str, us, bytes| Phase {
            name: name.to_owned(),
            time: Duration::from_micros(us),
            bytes,
        };
        Summary {
            species: "Quaking Aspen".to_owned(),
            title: "Quaking Aspen, seed 0".to_owned(),
            census: Census { stems: vec![1, 50, 1200], segments: 3600, leaves: 22_500 },
            components: Vec::new(),
            surfaces: Some((1_234_567, 89)),
            welded: None,
            swayed: None,
            bounds: Aabb { min: Vec3::new(-1.5, -0.001, 0.0), max: Vec3::new(2.0, 13.25, 1.0) },
            phases: vec![
                phase("read", 120, None),
                phase("quaking_aspen.glb", 25_000, Some(12_345_678)),
            ],
            notes: Vec::new(),
            picture: None,
        }
    }

    #[test]
    fn the_table_is_aligned() {
        let expected = "\
Quaking Aspen, seed 0

stems, level 0             1
stems, level 1            50
stems, level 2         1,200
segments               3,600
leaves                22,500
vertices           1,234,567
triangles                 89

metres                     x          y          z
size                    3.50      13.25       1.00
min                    -1.50       0.00       0.00
max                     2.00      13.25       1.00

read                  0.1 ms
quaking_aspen.glb    25.0 ms    12.3 MB
";
        assert_eq!(summary().to_string(), expected);
    }

    #[test]
    fn nothing_at_all_is_no_trouble() {
        let nothing = Summary {
            census: Census::default(),
            surfaces: None,
            bounds: Aabb::EMPTY,
            phases: Vec::new(),
            ..summary()
        };
        let text = nothing.to_string();
        assert!(text.contains("segments          0\n"), "{text}");
        assert!(!text.contains("min") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn numbers_are_easy_to_read() {
        assert_eq!([0, 999, 1500, 2_340_000].map(size), ["0 B", "999 B", "1.5 kB", "2.3 MB"]);
    }
}
