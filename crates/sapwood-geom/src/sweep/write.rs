//! Writing a tube that was laid: vertices ring by ring, and the triangles between them.

use glam::Vec2;

use super::forked::Inward;
use super::{Around, Cap, Fork, Laid, Sweep};
use crate::{Mesh, Section};

/// What vertices of a tube are, as they are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// All up to this number of vertices in the mesh lie on a ring, by its number among those
    /// [kept](Sweep::kept).
    Ring {
        /// The ring.
        kept: usize,
        /// How many vertices the mesh has with those on the ring.
        n_vertices: usize,
    },
    /// One more, at the place of a vertex that was written before.
    Copy {
        /// The number of that vertex in the mesh.
        of: u32,
    },
}

/// A ring of a tube that others leave as well.
#[derive(Clone, Copy, Debug)]
pub struct Forking<'a> {
    /// The number of the ring.
    pub ring: usize,
    /// How it is parted.
    pub fork: &'a Fork,
    /// Which of the fork's tubes this one is above the ring.
    pub tube: usize,
    /// The first of the vertices that the ring has in the mesh already: the tube begins there.
    /// They must have been written for the same ring, with the same section.
    pub vertices: Option<u32>,
}

impl Sweep {
    /// Adds the tube last laid to `mesh`, with the section it was laid for.
    ///
    /// # Panics
    /// Where the vertices together exceed what a 32-bit index can number.
    pub fn write(&self, section: &Section, mesh: &mut Mesh) {
        self.write_forking(section, &[], mesh, &mut Vec::new());
    }

    /// As [`write`](Self::write), with walls that part at some rings, which must not be points
    /// nor the last; they ascend. Adds to `vertices` for each of them its first vertex in the
    /// mesh. There are fewer triangles than were told of, by [`Fork::n_narrow`] for each.
    ///
    /// # Panics
    /// As [`write`](Self::write).
    pub fn write_forking(
        &self,
        section: &Section,
        forking: &[Forking<'_>],
        mesh: &mut Mesh,
        vertices: &mut Vec<u32>,
    ) {
        self.write_noting(section, forking, mesh, vertices, &mut |_| {});
    }

    /// As [`write_forking`](Self::write_forking); `note` is told what the vertices are, in their
    /// order. Discs lie on the first and the last ring.
    ///
    /// # Panics
    /// As [`write`](Self::write).
    pub fn write_noting(
        &self,
        section: &Section,
        forking: &[Forking<'_>],
        mesh: &mut Mesh,
        vertices: &mut Vec<u32>,
        note: &mut impl FnMut(Written),
    ) {
        let sides = section.n_sides() as usize;
        if self.n_triangles(sides) == 0 {
            return;
        }
        self.reserve(sides, mesh);
        let (first_index, has_forks) = (mesh.indices.len(), !forking.is_empty());
        let (first, last) = (self.laid[0], self.laid[self.laid.len() - 1]);
        if self.base != Cap::Open && !first.is_point {
            self.write_disc(section, &first, -1.0, mesh);
            note(Written::Ring { kept: 0, n_vertices: mesh.positions.len() });
        }
        let mut forking = forking.iter().peekable();
        let mut before: Option<&Laid> = None;
        let mut inward: Option<Inward<'_>> = None;
        for (row, laid) in (0..).zip(&self.laid) {
            let start = mesh.positions.len() as u32;
            match (inward.take(), before) {
                (Some(inward), Some(before)) => {
                    if laid.is_point {
                        self.write_point(section, before.slope, laid, mesh);
                    } else {
                        self.write_vertices(section, laid, before.slope + laid.slope, mesh);
                    }
                    inward.write_walls(start, laid.is_point, mesh);
                }
                _ if before.is_none() && forking.peek().is_some_and(|f| f.starts(row, self)) => {}
                (_, before) => self.write_ring(section, before, laid, mesh),
            }
            if let Some(parted) = forking.next_if(|f| self.rows.get(f.ring) == Some(&row)) {
                // Those of a point that the tube opens from may come before the ring's.
                let own = || mesh.positions.len() as u32 - (section.n_sides() + 1);
                let ring = parted.vertices.unwrap_or_else(own);
                vertices.push(ring);
                inward = Some(self.turn_inward(section, laid, parted, ring, mesh));
            }
            before = Some(laid);
            note(Written::Ring { kept: row as usize, n_vertices: mesh.positions.len() });
        }
        if self.tip != Cap::Open && !last.is_point {
            self.write_disc(section, &last, 1.0, mesh);
            note(Written::Ring { kept: self.laid.len() - 1, n_vertices: mesh.positions.len() });
        }
        if has_forks {
            // Walls may lean far from a ring that they share with others.
            mesh.keep_own_normals(first_index, |of| note(Written::Copy { of }));
        }
    }

    fn reserve(&self, sides: usize, mesh: &mut Mesh) {
        let n_vertices = (self.laid.len() + 2) * (sides + 1);
        u32::try_from(mesh.positions.len() + 2 * n_vertices)
            .expect("a mesh has fewer than 2^32 vertices");
        mesh.positions.reserve(n_vertices);
        mesh.normals.reserve(n_vertices);
        mesh.uvs.reserve(n_vertices);
        mesh.indices.reserve(3 * self.n_triangles(sides));
    }

    /// Writes a ring's vertices and the triangles to the ring before it.
    fn write_ring(&self, section: &Section, before: Option<&Laid>, laid: &Laid, mesh: &mut Mesh) {
        let sides = section.n_sides();
        let next = mesh.positions.len() as u32;
        match (before, laid.is_point) {
            (None, true) => {}
            (None, false) => self.write_vertices(section, laid, laid.slope, mesh),
            (Some(before), true) if before.is_point => {}
            (Some(before), true) => {
                self.write_point(section, before.slope, laid, mesh);
                let ring = next - (sides + 1);
                let fan = (0..sides).flat_map(|k| [ring + k, ring + k + 1, next + k]);
                mesh.indices.extend(fan);
            }
            (Some(before), false) if before.is_point => {
                self.write_point(section, before.slope, before, mesh);
                self.write_vertices(section, laid, before.slope + laid.slope, mesh);
                let ring = next + sides;
                let fan = (0..sides).flat_map(|k| [next + k, ring + k + 1, ring + k]);
                mesh.indices.extend(fan);
            }
            (Some(before), false) => {
                self.write_vertices(section, laid, before.slope + laid.slope, mesh);
                let ring = next - (sides + 1);
                mesh.indices.extend(section.strip.iter().map(|index| index + ring));
            }
        }
    }

    /// Writes `sides + 1` vertices of a ring whose profile has the normal `slope`.
    fn write_vertices(&self, section: &Section, laid: &Laid, slope: Vec2, mesh: &mut Mesh) {
        let slope = slope.normalize_or(Vec2::X);
        let Laid { center, radius, tangent, x, v, .. } = *laid;
        let y = tangent.cross(x);
        let (px, py) = (x * radius, y * radius);
        mesh.positions.extend(section.points.iter().map(|p| center + px * p.x + py * p.y));
        let along = tangent * slope.y;
        if section.lobed {
            let (nx, ny) = (x * slope.x, y * slope.x);
            let outward = section.normals.iter().zip(&section.factors_squared);
            mesh.normals.extend(
                outward.map(|(n, factor)| {
                    (nx * n.x + ny * n.y + along * *factor).normalize_or(tangent)
                }),
            );
        } else {
            let (nx, ny) = (x * slope.x, y * slope.x);
            mesh.normals.extend(section.normals.iter().map(|n| nx * n.x + ny * n.y + along));
        }
        let widths = self.around.widths(radius);
        match self.around {
            Around::Repeats(_) => {
                mesh.uvs.extend(section.around.iter().map(|u| Vec2::new(self.u + u * widths, v)));
            }
            Around::Mirrored { .. } => {
                let sides = section.n_sides();
                let u = |share: &f32| self.u + mirrored(*share, sides, widths);
                mesh.uvs.extend(section.around.iter().map(|share| Vec2::new(u(share), v)));
            }
        }
    }

    /// The texture coordinates of a place of a ring.
    pub(super) fn uv_at(&self, section: &Section, laid: &Laid, place: u32) -> Vec2 {
        let widths = self.around.widths(laid.radius);
        let share = section.around[place as usize];
        let u = match self.around {
            Around::Repeats(_) => share * widths,
            Around::Mirrored { .. } => mirrored(share, section.n_sides(), widths),
        };
        Vec2::new(self.u + u, laid.v)
    }

    /// Writes one vertex for each side at a point, so that every triangle has its own normal and
    /// the texture is not wrung there.
    fn write_point(&self, section: &Section, slope: Vec2, laid: &Laid, mesh: &mut Mesh) {
        let sides = section.n_sides() as usize;
        let y = laid.tangent.cross(laid.x);
        let (nx, ny, along) = (laid.x * slope.x, y * slope.x, laid.tangent * slope.y);
        mesh.positions.extend(std::iter::repeat_n(laid.center, sides));
        mesh.normals.extend(section.middles.iter().map(|n| nx * n.x + ny * n.y + along));
        let u = |k: usize| match self.around {
            Around::Repeats(n) => (k as f32 + 0.5) * (n.max(1) as f32 / sides as f32),
            // There is no way around a point.
            Around::Mirrored { .. } => 0.0,
        };
        mesh.uvs.extend((0..sides).map(|k| Vec2::new(self.u + u(k), laid.v)));
    }

    /// Writes a flat disc that faces along the tangent times `way`.
    fn write_disc(&self, section: &Section, laid: &Laid, way: f32, mesh: &mut Mesh) {
        let sides = section.n_sides();
        let first = mesh.positions.len() as u32;
        let y = laid.tangent.cross(laid.x);
        let (px, py) = (laid.x * laid.radius, y * laid.radius);
        // As many texels to the metre as on the ring's rim.
        let scale = self.around.widths(laid.radius) / std::f32::consts::TAU;
        mesh.positions.push(laid.center);
        mesh.uvs.push(Vec2::splat(0.5));
        for p in &section.points[..sides as usize] {
            mesh.positions.push(laid.center + px * p.x + py * p.y);
            mesh.uvs.push(Vec2::new(0.5 + scale * p.x, 0.5 - scale * way * p.y));
        }
        mesh.normals.extend(std::iter::repeat_n(laid.tangent * way, sides as usize + 1));
        for k in 0..sides {
            let (a, b) = (first + 1 + k, first + 1 + (k + 1) % sides);
            mesh.indices.extend(if way > 0.0 { [first, a, b] } else { [first, b, a] });
        }
    }
}

/// There and back between vertices, so that no side has one `u` throughout.
fn mirrored(share: f32, sides: u32, widths: f32) -> f32 {
    let far = (sides / 2) as f32 / sides as f32;
    let (there, back) = (0.5 * widths / far, 0.5 * widths / (1.0 - far));
    (share * there).min((1.0 - share) * back)
}
