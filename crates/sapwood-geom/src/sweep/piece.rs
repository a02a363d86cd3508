//! Pieces of a tube: stretches of it that stand by themselves, each with end rings square to its
//! own axis, and what their vertices are in the tube.

use std::ops::RangeInclusive;

use glam::Vec3;

use super::{Cap, Sweep, carry, sharpen};
use crate::Section;

/// The plane in which a ring of a tube lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingPlane {
    /// The middle of the ring.
    pub center: Vec3,
    /// The plane's unit normal, onward.
    pub tangent: Vec3,
    /// What the plane weighs against that of the piece on the other side, where a piece ends:
    /// one over the length of the stretch there, since the shorter one weighs more.
    pub weight: f32,
}

/// What a vertex of a tube is; rings are numbered as they were kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swept {
    /// A place of a ring, from 0 to the number of sides, where the texture ends.
    Wall {
        /// The ring.
        ring: u32,
        /// The place.
        place: u32,
    },
    /// A point, one vertex for each side.
    Point {
        /// The ring.
        ring: u32,
        /// The side.
        side: u32,
        /// Whether the tube opens from the point, rather than ends there.
        opens: bool,
    },
    /// A place on the rim of a disc, or its middle.
    Disc {
        /// The ring that the disc shuts.
        ring: u32,
        /// The place; none in the middle.
        place: Option<u32>,
    },
}

impl Sweep {
    /// How many rings of those last laid were kept: none coincides with the one before it.
    pub fn n_kept(&self) -> usize {
        self.laid.len()
    }

    /// Which of the kept rings stands for ring number `ring` of those last laid.
    pub fn kept(&self, ring: usize) -> Option<usize> {
        self.rows.get(ring).map(|row| *row as usize)
    }

    /// Whether a kept ring is drawn as a point.
    pub fn is_point(&self, kept: usize) -> bool {
        self.laid.get(kept).is_some_and(|laid| laid.is_point)
    }

    /// Makes `piece` the part of the tube from one kept ring to another, laid and ready to be
    /// written: its first and last ring stand square to the stretches that it begins and ends
    /// with. It has the tube's caps where it has its ends. Returns its number of triangles.
    ///
    /// # Panics
    /// When a ring is out of range.
    pub fn piece(
        &self,
        section: &Section,
        kept: RangeInclusive<usize>,
        piece: &mut Sweep,
    ) -> usize {
        let (begins, ends) = (*kept.start() == 0, *kept.end() + 1 == self.laid.len());
        piece.laid.clear();
        piece.laid.extend_from_slice(&self.laid[kept]);
        piece.rows.clear();
        piece.rows.extend(0..piece.laid.len() as u32);
        (piece.around, piece.u) = (self.around, self.u);
        piece.base = if begins { self.base } else { Cap::Open };
        piece.tip = if ends { self.tip } else { Cap::Open };
        if let [.., before, last] = &mut piece.laid[..] {
            last.x = sharpen(carry(last.x, last.tangent, before.onward), before.onward);
            (last.tangent, last.slope) = (before.onward, before.slope);
        }
        if let Some(first) = piece.laid.first_mut() {
            first.x = sharpen(carry(first.x, first.tangent, first.onward), first.onward);
            first.tangent = first.onward;
        }
        piece.n_triangles(section.n_sides() as usize)
    }

    /// The planes of the kept rings.
    pub fn planes(&self) -> impl Iterator<Item = RingPlane> + '_ {
        let last = self.laid.len().saturating_sub(1);
        self.laid.iter().enumerate().map(move |(row, laid)| {
            let stretch = if row == last { row.saturating_sub(1) } else { row };
            let weight = 1.0 / self.laid[stretch].length.max(1e-9);
            RingPlane { center: laid.center, tangent: laid.tangent, weight }
        })
    }

    /// What the vertices are, in the order in which [`write`](Self::write) adds them.
    pub fn swept(&self, section: &Section) -> Vec<Swept> {
        let sides = section.n_sides();
        let mut swept = Vec::new();
        if self.n_triangles(sides as usize) == 0 {
            return swept;
        }
        let disc = |ring: u32, swept: &mut Vec<Swept>| {
            swept.push(Swept::Disc { ring, place: None });
            swept.extend((0..sides).map(|place| Swept::Disc { ring, place: Some(place) }));
        };
        let fan = |ring: u32, opens: bool, swept: &mut Vec<Swept>| {
            swept.extend((0..sides).map(|side| Swept::Point { ring, side, opens }));
        };
        if self.base != Cap::Open && !self.laid[0].is_point {
            disc(0, &mut swept);
        }
        let mut was_point = None;
        for (ring, laid) in (0..).zip(&self.laid) {
            match (was_point, laid.is_point) {
                (None, true) | (Some(true), true) => {}
                (Some(false), true) => fan(ring, false, &mut swept),
                (before, false) => {
                    if before == Some(true) {
                        fan(ring - 1, true, &mut swept);
                    }
                    swept.extend((0..=sides).map(|place| Swept::Wall { ring, place }));
                }
            }
            was_point = Some(laid.is_point);
        }
        let last = self.laid.len() as u32 - 1;
        if self.tip != Cap::Open && !self.is_point(last as usize) {
            disc(last, &mut swept);
        }
        swept
    }
}
