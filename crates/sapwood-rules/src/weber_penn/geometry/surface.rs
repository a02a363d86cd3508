//! The surface of grown stems: where rings stand, how many sides they have, and how the tubes of
//! clones continue the one they split from. Sweeping rings into triangles is geometry's work.

mod forks;
mod segments;
#[cfg(test)]
mod tests;

use std::borrow::Cow;

use glam::Vec3;
use sapwood_geom::{
    Around, Cap, Forking, Mesh, Ring, Section, Sweep, SweepOptions, SweepStart, Written,
};

use self::forks::Forks;
pub use self::segments::segments;
pub(crate) use self::segments::segments_by_stem;

use super::detail::{Detail, SectionKey};
use super::ring_places::{divide_segments, find_places};
use crate::weber_penn::{Segment, Stem, Stems, TrunkForm};

/// The surface of a batch of stems in tree space, one tube for each stem.
///
/// A clone's tube starts with the very ring where it leaves the stem that it split from, and
/// shares its vertices: there the ring forks ([`Fork`](sapwood_geom::Fork)), and every edge has a
/// triangle on either side. Where that cannot be (the clone turns back, the ring is next to a
/// point) it starts with a ring of its own. Every stem is `charge`d with its number of triangles
/// before any of them is made; the first refusal ends the work and is returned. The radius is the
/// taper's, for trunks times the factors of `form` and around the stem its lobes.
///
/// `bark_width` is the width in metres of one repeat of the bark's texture. A stem takes the whole
/// number of repeats around that comes nearest at its base, and keeps it; a stem too thin for
/// one takes as much as fits, mirrored. No two stems begin at the same place of the texture.
pub fn surface<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    charge: impl FnMut(usize) -> Result<(), E>,
) -> Result<Mesh, E> {
    segmented_surface(stems, form, detail, bark_width, charge, None)
}

/// As [`surface`]; `segments` is told the segment that each vertex belongs to: a ring belongs to
/// the segment that ends with it, as does what is between the two.
///
/// # Errors
/// The first refusal of `charge`.
pub(crate) fn segmented_surface<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    charge: impl FnMut(usize) -> Result<(), E>,
    segments: Option<&mut Vec<u32>>,
) -> Result<Mesh, E> {
    swept(stems, form, detail, bark_width, charge, |_, _| (), segments)
}

/// A stretch of a stem's tube, between two of its rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Band {
    /// The stem, an index into [`Stems::stems`].
    pub stem: u32,
    /// The number behind its last triangle; it begins where the band before ends.
    pub end: u32,
    /// The rings at its ends.
    pub rings: [Ring; 2],
}

/// As [`surface`], with the bands that it consists of, in the order of their triangles.
/// `segments` is told the segment of each vertex as by [`segmented_surface`].
///
/// # Errors
/// The first refusal of `charge`.
pub(crate) fn banded_surface<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    charge: impl FnMut(usize) -> Result<(), E>,
    segments: Option<&mut Vec<u32>>,
) -> Result<(Mesh, Vec<Band>), E> {
    let (mut bands, mut end) = (Vec::new(), 0);
    let laid = |stem: usize, tubes: &Tubes<'_>| {
        let forks = tubes.forks.on_tube();
        let narrow: Vec<_> =
            forks.map(|(row, fork, tube)| (row.ring, fork.n_narrow(tube))).collect();
        for (n, rings) in tubes.sweep.stretches(&tubes.sections[tubes.section].1, &narrow) {
            end += n as u32;
            bands.push(Band { stem: stem as u32, end, rings });
        }
    };
    let mesh = swept(stems, form, detail, bark_width, charge, laid, segments)?;
    Ok((mesh, bands))
}

fn swept<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    mut charge: impl FnMut(usize) -> Result<(), E>,
    mut laid: impl FnMut(usize, &Tubes<'_>),
    mut segments: Option<&mut Vec<u32>>,
) -> Result<Mesh, E> {
    let mut mesh = Mesh::default();
    let mut tubes = Tubes::new(stems, form, detail, bark_width);
    tubes.reserve(&mut mesh);
    for index in 0..stems.stems.len() {
        charge(tubes.lay(index))?;
        laid(index, &tubes);
        tubes.write(&mut mesh, segments.as_deref_mut());
    }
    Ok(mesh)
}

/// The ring at the end of a segment, for a clone to start with.
#[derive(Clone, Copy)]
struct Joint {
    ring: Ring,
    start: SweepStart,
    /// The first of the ring's vertices, once they are written.
    vertices: Option<u32>,
}

/// The tubes of a batch, one after the other.
pub(super) struct Tubes<'a> {
    stems: &'a Stems,
    form: &'a TrunkForm,
    detail: &'a Detail,
    bark_width: f32,
    sections: Vec<(SectionKey, Cow<'static, Section>)>,
    /// The stem whose tube was laid last, and its section.
    index: usize,
    section: usize,
    sweep: Sweep,
    rings: Vec<Ring>,
    /// For each ring the segment that it belongs to.
    of_rings: Vec<u32>,
    /// How the tube last laid starts and ends.
    options: SweepOptions,
    /// For each segment of the current stem the number of the ring at its end, if there is one.
    ends: Vec<Option<usize>>,
    /// Places `z` where the current stem needs rings besides the segment ends, ascending.
    between: Vec<f32>,
    /// A joint for each segment of the batch; empty where no stem is a clone.
    joints: Vec<Option<Joint>>,
    forks: Forks,
    /// First vertices of the rings that fork on the tube last written.
    vertices: Vec<u32>,
}

impl<'a> Tubes<'a> {
    pub(super) fn new(
        stems: &'a Stems,
        form: &'a TrunkForm,
        detail: &'a Detail,
        bark_width: f32,
    ) -> Self {
        let has_clones = stems.stems.iter().any(|stem| stem.clone_of.is_some());
        let n_joints = if has_clones { stems.segments.len() } else { 0 };
        // The foot, the ends of all segments, and some more on a trunk.
        let n_rings = stems.stems.iter().map(|stem| stem.n_segments as usize + 2).max();
        let n_rings = n_rings.unwrap_or(0).min(1024);
        Self {
            stems,
            form,
            detail,
            bark_width: bark_width.max(1e-6),
            sections: Vec::new(),
            index: 0,
            section: 0,
            sweep: Sweep::with_room(n_rings),
            rings: Vec::with_capacity(n_rings),
            of_rings: Vec::with_capacity(n_rings),
            ends: Vec::with_capacity(n_rings),
            options: SweepOptions::default(),
            between: Vec::new(),
            joints: vec![None; n_joints],
            forks: if has_clones { Forks::of(stems) } else { Forks::default() },
            vertices: Vec::new(),
        }
    }

    /// Makes room for stems that have rings at their segment ends only; within limits, for
    /// nothing has been charged yet.
    fn reserve(&self, mesh: &mut Mesh) {
        let (mut n_vertices, mut n_indices, mut widest) = (0, 0, 0);
        for stem in &self.stems.stems {
            let key = self.detail.section(stem.seed.level, stem.seed.radius, self.form);
            let (segments, sides) = (stem.n_segments as usize, key.sides as usize);
            // One more ring for the disc at the tip.
            n_vertices += (segments + 2) * (sides + 1);
            n_indices += (2 * segments + 1) * sides * 3;
            widest = widest.max(sides);
        }
        // What a sweep makes room for before it writes one tube.
        let n_vertices = (n_vertices + 2 * (widest + 1)).min(1 << 20);
        mesh.positions.reserve(n_vertices);
        mesh.normals.reserve(n_vertices);
        mesh.uvs.reserve(n_vertices);
        mesh.indices.reserve(n_indices.min(1 << 22));
    }

    /// Lays the tube of a stem and returns its number of triangles.
    pub(super) fn lay(&mut self, index: usize) -> usize {
        let stem = &self.stems.stems[index];
        let seed = &stem.seed;
        self.index = index;
        let key = self.key_of(stem);
        self.section = self.section_of(key);
        let joint = self.joint_of(index);
        self.place_rings(index, stem, key.sides, joint);
        let repeats = std::f32::consts::TAU * seed.radius / self.bark_width;
        let around = if repeats < FEWEST_REPEATS {
            Around::Mirrored { width: self.bark_width }
        } else {
            Around::Repeats(repeats.round().clamp(1.0, 4096.0) as u32)
        };
        let (u, v) = place_on_bark(seed.frame.origin);
        let own_start = SweepStart { u, v, ..SweepStart::toward(seed.frame.axes.x_axis) };
        let is_trunk = seed.level == 0 && stem.clone_of.is_none();
        self.options = SweepOptions {
            start: joint.map_or(own_start, |joint| joint.start),
            around,
            base: if is_trunk && self.detail.closed_foot { Cap::Flat } else { Cap::Open },
            tip: Cap::Flat,
        };
        let n = self.sweep.lay(&self.sections[self.section].1, &self.rings, &self.options);
        if !self.joints.is_empty() {
            self.keep_joints(stem);
            self.find_forks(index);
        }
        n - self.n_narrow()
    }

    /// Triangles that the tube last laid lacks because it forks.
    fn n_narrow(&self) -> usize {
        self.forks.on_tube().map(|(_, fork, tube)| fork.n_narrow(tube)).sum()
    }

    /// What the tube last laid is made of: its section, its rings and the rest.
    pub(super) fn laid(&self) -> (&Section, &[Ring], &SweepOptions) {
        (&self.sections[self.section].1, &self.rings, &self.options)
    }

    /// Adds the tube last laid, and the segment of each of its vertices.
    fn write(&mut self, mesh: &mut Mesh, segments: Option<&mut Vec<u32>>) {
        let section = &self.sections[self.section].1;
        self.vertices.clear();
        let forking: Vec<Forking<'_>> = self
            .forks
            .on_tube()
            .map(|(row, fork, tube)| {
                let vertices = if row.is_foot {
                    self.joints[row.segment].and_then(|j| j.vertices)
                } else {
                    None
                };
                Forking { ring: row.ring, fork, tube, vertices }
            })
            .collect();
        match segments {
            None => self.sweep.write_forking(section, &forking, mesh, &mut self.vertices),
            Some(segments) => {
                let of_kept = |kept: usize| {
                    let mut ring = self.of_rings.iter().enumerate();
                    let ring = ring.position(|(ring, _)| self.sweep.kept(ring) == Some(kept));
                    ring.map_or(0, |ring| self.of_rings[ring])
                };
                let mut note = |written| match written {
                    Written::Ring { kept, n_vertices } => {
                        segments.resize(n_vertices, of_kept(kept));
                    }
                    Written::Copy { of } => segments.push(segments[of as usize]),
                };
                self.sweep.write_noting(section, &forking, mesh, &mut self.vertices, &mut note);
            }
        }
        for ((row, _, _), vertices) in self.forks.on_tube().zip(&self.vertices) {
            if let Some(joint) = &mut self.joints[row.segment] {
                joint.vertices = Some(*vertices);
            }
        }
    }

    fn key_of(&self, stem: &Stem) -> SectionKey {
        let mut key = self.detail.section(stem.seed.level, stem.seed.radius, self.form);
        if !self.joints.is_empty() {
            // Nothing with three sides can fork.
            key.sides = key.sides.max(4);
        }
        key
    }

    fn section_of(&mut self, key: SectionKey) -> usize {
        if let Some(place) = self.sections.iter().position(|(known, _)| *known == key) {
            return place;
        }
        let section = if key.lobed {
            Cow::Owned(Section::lobed(key.sides, self.form.lobes, self.form.lobe_depth))
        } else {
            Section::known_round(key.sides)
        };
        self.sections.push((key, section));
        self.sections.len() - 1
    }

    /// The ring that a clone shares with the stem it split from, if it does.
    fn joint_of(&self, index: usize) -> Option<Joint> {
        let segment = self.forks.foot_of(self.stems, index)?;
        *self.joints.get(segment)?
    }

    fn keep_joints(&mut self, stem: &Stem) {
        for (segment, ring) in stem.segment_range().zip(&self.ends) {
            self.joints[segment] = ring.and_then(|ring| {
                let start = self.sweep.start_at(ring)?;
                Some(Joint { ring: self.rings[ring], start, vertices: None })
            });
        }
    }

    fn place_rings(&mut self, index: usize, stem: &Stem, sides: u32, joint: Option<Joint>) {
        self.between.clear();
        find_places(stem, self.form, self.detail, sides, &mut self.between);
        divide_segments(stem, self.detail, &mut self.between);
        self.rings.clear();
        self.of_rings.clear();
        self.ends.clear();
        let segments = self.stems.segments_of(index);
        let factor = |z: f32| if stem.seed.level == 0 { self.form.factor(z) } else { 1.0 };
        let mut places = self.between.iter().copied().peekable();
        let mut bend_before = 0.0;
        for (i, segment) in segments.iter().enumerate() {
            if i == 0 {
                let radius = segment.radius_foot * factor(segment.z_foot);
                let foot = Ring { center: segment.frame.origin, radius };
                self.rings.push(joint.map_or(foot, |joint| joint.ring));
                let before = joint.and_then(|_| self.stems.segment_before(stem));
                self.of_rings.push(before.map_or(stem.first_segment, |before| before as u32));
            }
            let number = stem.first_segment + i as u32;
            if places.peek().is_some() {
                let bend = segments.get(i + 1).map_or(0.0, |next| bend(segment, next));
                let mut near = [bend_before, bend].map(|bend| room(bend, stem, segment));
                let is_forked = match i {
                    0 => joint.is_some(),
                    i => self.forks.any_leave(stem.first_segment as usize + i - 1),
                };
                if is_forked {
                    // Half a ring widens to a whole one there.
                    near[0] = near[0].max(segment.radius_foot / stem.seed.length.max(1e-6));
                }
                while let Some(z) = places.next_if(|z| *z < segment.z_end) {
                    let from_foot = z - segment.z_foot;
                    if from_foot > near[0] && segment.z_end - z > near[1] {
                        let center = self.stems.center_in(index, segment, z * stem.seed.length);
                        self.rings.push(Ring { center, radius: stem.radius_at(z) * factor(z) });
                        self.of_rings.push(number);
                    }
                }
                bend_before = bend;
            }
            let has_ring = match self.detail.n_pieces(stem, stem.start + i as u32) {
                None => self.detail.has_ring(stem.seed.level, i, segments.len()),
                // Where clones leave, the ring must be there to fork.
                Some(0) => self.forks.any_leave(number as usize) || i + 1 == segments.len(),
                Some(_) => true,
            };
            if !has_ring {
                self.ends.push(None);
                continue;
            }
            let radius = segment.radius_end * factor(segment.z_end);
            self.ends.push(Some(self.rings.len()));
            self.rings.push(Ring { center: segment.end(), radius });
            self.of_rings.push(number);
        }
    }
}

/// A whole repeat of the bark around a stem may be squeezed to this share of its width.
const FEWEST_REPEATS: f32 = 0.7;

/// Where on the bark's texture a stem begins that grows at `origin`: anywhere, but always there.
fn place_on_bark(origin: Vec3) -> (f32, f32) {
    let share = |x: f32| x - x.floor();
    let around = origin.dot(Vec3::new(13.7, 17.9, 7.3));
    (share(around), share(origin.dot(Vec3::new(5.3, -11.1, 19.7))))
}

/// The sine of the angle between two segments.
fn bend(segment: &Segment, next: &Segment) -> f32 {
    segment.frame.axes.z_axis.cross(next.frame.axes.z_axis).length()
}

/// How near to a segment's end, in units of `z`, no other ring may stand: the ring at the end
/// leans by half the bend and must not reach it.
fn room(bend: f32, stem: &Stem, segment: &Segment) -> f32 {
    let radius = segment.radius_foot.max(segment.radius_end);
    (0.02 + 0.6 * bend) * radius / stem.seed.length.max(1e-6)
}
