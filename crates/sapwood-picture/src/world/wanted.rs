//! The interest in what waits, and in what nothing was foreseen of.

use sapwood_geom::{FixedMap, fixed_state};
use sapwood_graph::{Approach, Interest};

/// The interest in certain links, and in everything below them that has no foreseen bound.
pub(super) struct Wanted {
    /// The way to a link, by the way to the one above it and its number.
    ways: FixedMap<(u32, u32), u32>,
    /// Whether a way ends where something is wanted.
    is_end: Vec<bool>,
}

/// The way to the root.
const ROOT: u32 = 0;

/// Where a traversal is.
#[derive(Clone, Copy)]
pub(super) enum Place {
    /// On one of the ways.
    Way(u32),
    /// Below the end of one.
    Below,
}

impl Wanted {
    /// The interest in everything that has no foreseen bound.
    pub(super) fn all_unforeseen() -> Self {
        Self::new(&[Vec::new()])
    }

    /// The interest in the ends of these paths of links from the root.
    pub(super) fn new(paths: &[Vec<u32>]) -> Self {
        let mut wanted = Self { ways: FixedMap::with_hasher(fixed_state()), is_end: vec![false] };
        for path in paths {
            let mut way = ROOT;
            for link in path {
                let next = wanted.is_end.len() as u32;
                way = *wanted.ways.entry((way, *link)).or_insert(next);
                if way == next {
                    wanted.is_end.push(false);
                }
            }
            wanted.is_end[way as usize] = true;
        }
        wanted
    }

    fn place(&self, way: u32) -> Place {
        if self.is_end[way as usize] { Place::Below } else { Place::Way(way) }
    }
}

impl Interest for Wanted {
    type State = Place;

    fn start(&self) -> Place {
        self.place(ROOT)
    }

    fn enter(&self, place: &Place, child: &Approach<'_>) -> Option<Place> {
        match place {
            Place::Way(way) => Some(self.place(*self.ways.get(&(*way, child.link))?)),
            Place::Below => child.bound.is_none().then_some(Place::Below),
        }
    }
}
