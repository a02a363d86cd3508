//! Stems as the thesis drew them first: every segment a piece of tube by itself, square to its
//! own axis, with gaps and overlaps where the stem bends. Every vertex tells what it is, so that
//! the pieces can be welded to the surface that [`surface`](super::surface()) sweeps at once.

use sapwood_geom::{Pieces, Rim, Section, Sweep, Swept, VertexIdentity};

use super::{Detail, Tubes};
use crate::weber_penn::{Stems, TrunkForm};

/// Creases: walls share their normals, whatever segment they belong to.
const WALLS: u32 = 0;
const DISC: u32 = 1;
/// From here on one for each side of a point, doubled, for a tube may end in a point and open
/// from it; then one for each tube that stands on a fork.
const SIDES: u32 = 2;

/// The segments of a batch of stems in tree space, each a piece with two ends.
///
/// Charged, and shaped, as by [`surface`](super::surface()). A vertex's joint is the ring of the
/// stem that it lies on, and that of the stem it split from where a clone begins; its place is
/// the place around, or the point of the fork.
pub fn segments<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    charge: impl FnMut(usize) -> Result<(), E>,
) -> Result<Pieces, E> {
    Ok(segments_by_stem(stems, form, detail, bark_width, charge)?.0)
}

/// As [`segments`], with the number behind the last triangle of each stem.
///
/// # Errors
/// The first refusal of `charge`.
pub(crate) fn segments_by_stem<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    mut charge: impl FnMut(usize) -> Result<(), E>,
) -> Result<(Pieces, Vec<u32>), E> {
    let mut tubes = Tubes::new(stems, form, detail, bark_width);
    let mut cutting = Cutting {
        pieces: Pieces::default(),
        piece: Sweep::default(),
        n_joints: 0,
        ends: vec![None; tubes.joints.len()],
    };
    let mut ends = Vec::with_capacity(stems.stems.len());
    for index in 0..stems.stems.len() {
        let n = tubes.lay(index) + tubes.n_narrow();
        charge(n)?;
        if n > 0 {
            cutting.cut(&tubes, index);
        }
        ends.push(cutting.pieces.mesh.n_triangles() as u32);
    }
    Ok((cutting.pieces, ends))
}

struct Cutting {
    pieces: Pieces,
    /// The piece at hand.
    piece: Sweep,
    n_joints: u32,
    /// For each segment the joint at its end; empty where no stem is a clone.
    ends: Vec<Option<u32>>,
}

/// The piece that is to be added.
struct Piece<'a> {
    section: &'a Section,
    /// The tube's first joint, and the piece's first ring on the tube.
    joint: u32,
    from: usize,
    /// The joint of another stem that the piece begins at.
    foot: Option<u32>,
}

impl Cutting {
    /// Cuts the tube last laid at the ends of its segments.
    fn cut(&mut self, tubes: &Tubes<'_>, index: usize) {
        let stem = &tubes.stems.stems[index];
        let section = &tubes.sections[tubes.section].1;
        let sweep = &tubes.sweep;
        let joint = self.n_joints;
        self.n_joints += sweep.n_kept() as u32;
        if !self.ends.is_empty() {
            for (segment, ring) in stem.segment_range().zip(&tubes.ends) {
                let kept = ring.and_then(|ring| sweep.kept(ring));
                self.ends[segment] = kept.map(|kept| joint + kept as u32);
            }
        }
        let stands_on = tubes.forks.foot_of(tubes.stems, index);
        let mut from = 0;
        for end in tubes.ends.iter().flatten() {
            let Some(to) = sweep.kept(*end).filter(|to| *to > from) else { continue };
            let n = sweep.piece(section, from..=to, &mut self.piece);
            let fork =
                tubes.forks.on_tube().find(|(ring, _, _)| sweep.kept(ring.ring) == Some(from));
            let foot = stands_on.filter(|_| from == 0).and_then(|segment| self.ends[segment]);
            if n > 0 {
                let first = self.add(&Piece { section, joint, from, foot });
                if let Some((_, fork, tube)) = fork {
                    let sides = section.n_sides();
                    let crease = SIDES + 2 * sides + tube as u32;
                    self.turn_inward(first, sides, crease, |side| fork.inward(tube, side));
                }
            }
            from = to;
        }
    }

    /// Adds the piece, and tells where its vertices and indices begin, below what caps it.
    fn add(&mut self, of: &Piece<'_>) -> [usize; 2] {
        let Piece { section, joint, from, foot } = *of;
        let Pieces { mesh, identities, rims } = &mut self.pieces;
        let first_rim = rims.len() as u32;
        for (i, plane) in (0..).zip(self.piece.planes()) {
            let own = joint + from as u32 + i;
            let (joint, weight) = match foot {
                Some(joint) if i == 0 => (joint, 0.0),
                _ => (own, plane.weight),
            };
            rims.push(Rim { joint, center: plane.center, normal: plane.tangent, weight });
        }
        let sides = section.n_sides();
        let swept = self.piece.swept(section);
        let n_disc = swept.iter().take_while(|swept| matches!(swept, Swept::Disc { .. })).count();
        let first = [identities.len() + n_disc, mesh.indices.len() + 3 * n_disc.saturating_sub(1)];
        identities.extend(swept.into_iter().map(|swept| {
            let (ring, place, crease, seam) = match swept {
                Swept::Wall { ring, place } => (ring, place % sides, WALLS, place / sides),
                Swept::Point { ring, side, opens } => {
                    (ring, 0, SIDES + 2 * side + u32::from(opens), 0)
                }
                // No place of the ring has this number, nor any point of a fork: what has a disc
                // does not fork.
                Swept::Disc { ring, place } => (ring, place.unwrap_or(sides), DISC, 0),
            };
            VertexIdentity { rim: first_rim + ring, place, crease, seam }
        }));
        self.piece.write(section, mesh);
        first
    }

    /// Makes vertices at the foot of the piece last added points of a fork, for the sides that
    /// turn inward there.
    fn turn_inward(
        &mut self,
        [vertex, index]: [usize; 2],
        sides: u32,
        crease: u32,
        inward: impl Fn(u32) -> Option<[u32; 2]>,
    ) {
        let Pieces { mesh, identities, .. } = &mut self.pieces;
        let per_side = if self.piece.is_point(1) { 3 } else { 6 };
        for place in 0..=sides {
            let before = place.checked_sub(1).map(|side| (side, inward(side).map(|ends| ends[1])));
            let after = (place < sides).then(|| (place, inward(place).map(|ends| ends[0])));
            let both = [before, after];
            let points: Vec<u32> = both.iter().flatten().filter_map(|(_, point)| *point).collect();
            let Some(point) = points.first() else { continue };
            let number = vertex + place as usize;
            let identity = VertexIdentity { place: *point, crease, ..identities[number] };
            if points.len() == both.iter().flatten().count() {
                identities[number] = identity;
                continue;
            }
            // The ring goes on to one side and the wall turns inward on the other.
            let copy = mesh.positions.len() as u32;
            mesh.positions.push(mesh.positions[number]);
            mesh.normals.push(mesh.normals[number]);
            mesh.uvs.push(mesh.uvs[number]);
            identities.push(identity);
            for (side, _) in both.iter().flatten().filter(|(_, point)| point.is_some()) {
                let first = index + per_side * *side as usize;
                for corner in &mut mesh.indices[first..first + per_side] {
                    if *corner == number as u32 {
                        *corner = copy;
                    }
                }
            }
        }
    }
}
