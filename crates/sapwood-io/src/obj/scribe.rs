//! The scribe: goes through a draw list in order, cuts it into pieces, has a batch of them put
//! into words by all threads, and writes the words in order. Memory is that of a batch.

use std::io::{self, Write};
use std::ops::Range;

use rayon::prelude::*;
use sapwood_geom::glam::Affine3;
use sapwood_geom::{FixedMap, Mesh, Polyline, fixed_state};
use sapwood_graph::{Body, DrawList, DrawRow, LineRow};

use super::materials::Materials;
use super::pieces::{First, MeshPiece, Normals, Piece, Sort};
use super::without_spaces;
use crate::parts;
use crate::sound;

/// Lines that one thread puts into words at a time, more or less.
const CHUNK: usize = 1 << 13;
/// Chunks between two writes.
const BATCH: usize = 16;

/// Why the file could not be written.
pub(super) enum Failure {
    /// What the operating system said.
    Write(io::Error),
    /// Something that the format cannot hold.
    Refused { component: String, reason: String },
}

impl From<io::Error> for Failure {
    fn from(cause: io::Error) -> Self {
        Self::Write(cause)
    }
}

/// Writes everything in `list` that has triangles or is a line; `library` is the name of the file
/// with the materials, if there is one, and `notes` are lines of comment.
pub(super) fn write(
    list: &DrawList,
    materials: &Materials,
    library: Option<&str>,
    notes: &str,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let n_triangles = list.n_vertices_and_triangles().1;
    let mut head =
        format!("# Sapwood {}: metres, y up, {n_triangles} triangles\n", env!("CARGO_PKG_VERSION"));
    head.push_str(notes);
    if let Some(library) = library {
        head.push_str(&format!("mtllib {library}\n"));
    }
    out.write_all(head.as_bytes())?;

    let known = Known::of(list)?;
    let mut scribe = Scribe {
        known: &known,
        materials,
        out,
        next: First { position: 1, uv: 1, normal: 1 },
        first_uv: FixedMap::with_hasher(fixed_state()),
        names: FixedMap::with_hasher(fixed_state()),
        chunks: Vec::new(),
        weight: 0,
        words: Vec::new(),
    };
    for occurrence in &list.occurrences {
        scribe.occurrence(list.body(occurrence), &occurrence.world)?;
    }
    scribe.flush()
}

/// What is found out about every mesh before the first is written.
struct Known<'a>(FixedMap<*const Mesh, Normals<'a>>);

impl<'a> Known<'a> {
    /// Looks at each mesh once.
    fn of(list: &'a DrawList) -> Result<Self, Failure> {
        /// Meshes with more vertices are not looked through for normals that are there twice.
        const SMALL: usize = 64;
        let mut known = FixedMap::with_hasher(fixed_state());
        for body in &list.bodies {
            for row in body.rows.iter().filter(|row| parts::n_copies(row) > 0) {
                let mesh: &Mesh = &row.mesh;
                if known.contains_key(&std::ptr::from_ref(mesh)) {
                    continue;
                }
                sound::check(mesh).map_err(|reason| refused(body, reason))?;
                let normals = if row.instances.is_some() && mesh.n_vertices() <= SMALL {
                    Normals::distinct(mesh)
                } else {
                    Normals::each(mesh)
                };
                known.insert(std::ptr::from_ref(mesh), normals);
            }
        }
        Ok(Self(known))
    }

    fn normals(&self, mesh: &Mesh) -> &Normals<'a> {
        &self.0[&std::ptr::from_ref(mesh)]
    }
}

fn refused(body: &Body, reason: String) -> Failure {
    Failure::Refused { component: body.kind.name().to_owned(), reason }
}

struct Scribe<'a, 'o> {
    known: &'a Known<'a>,
    materials: &'a Materials,
    out: &'o mut dyn Write,
    /// The numbers that come next.
    next: First,
    /// Where the texture coordinates of a mesh begin.
    first_uv: FixedMap<*const Mesh, u64>,
    /// How many objects have a name.
    names: FixedMap<&'static str, u64>,
    /// Pieces that wait for being put into words, each with the body it is about.
    chunks: Vec<Vec<(&'a Body, Piece<'a>)>>,
    /// Lines of the last chunk.
    weight: usize,
    /// Room for the words of each chunk.
    words: Vec<Vec<u8>>,
}

impl<'a> Scribe<'a, '_> {
    fn occurrence(&mut self, body: &'a Body, world: &Affine3) -> Result<(), Failure> {
        let parts = parts::parts(body);
        if parts.is_empty() && body.lines.is_empty() {
            return Ok(());
        }
        let name = body.kind.name();
        let count = self.names.entry(name).or_insert(0);
        *count += 1;
        let object = match *count {
            1 => format!("o {}\n", without_spaces(name)),
            n => format!("o {}.{n}\n", without_spaces(name)),
        };
        self.add(body, 1, Piece::Text(object))?;
        for part in &parts {
            let material = format!("usemtl {}\n", self.materials.name(part.material));
            self.add(body, 1, Piece::Text(material))?;
            for row in &part.rows {
                self.row(body, row, *world * row.local)?;
            }
        }
        for row in &body.lines {
            self.lines(body, row, *world * row.local)?;
        }
        Ok(())
    }

    fn row(&mut self, body: &'a Body, row: &'a DrawRow, place: Affine3) -> Result<(), Failure> {
        let known: &'a Known<'a> = self.known;
        let mesh: &'a Mesh = &row.mesh;
        let normals = known.normals(mesh);
        let n_copies = parts::n_copies(row);
        let instances = row.instances.as_ref().map(|instances| instances.as_slice());
        let (n_vertices, n_normals) = (mesh.n_vertices(), normals.distinct.len());
        let (mut first, mut has_uvs) = (self.next, true);
        first.uv = *self.first_uv.entry(std::ptr::from_ref(mesh)).or_insert_with(|| {
            has_uvs = false;
            first.uv
        });
        let mut cut = |sort, n_items, n_copies| {
            cut(n_items, n_copies, |copies, items| {
                let weight = copies.len() * items.len();
                let piece =
                    MeshPiece { sort, mesh, normals, place, instances, copies, items, first };
                self.add(body, weight, Piece::Mesh(piece))
            })
        };
        cut(Sort::Positions, n_vertices, n_copies)?;
        if !has_uvs {
            cut(Sort::Uvs, n_vertices, 1)?;
        }
        cut(Sort::Normals, n_normals, n_copies)?;
        cut(Sort::Triangles, mesh.n_triangles(), n_copies)?;
        self.next.position += (n_vertices * n_copies) as u64;
        self.next.uv += if has_uvs { 0 } else { n_vertices as u64 };
        self.next.normal += (n_normals * n_copies) as u64;
        Ok(())
    }

    fn lines(&mut self, body: &'a Body, row: &'a LineRow, place: Affine3) -> Result<(), Failure> {
        let mut rest: &'a [Polyline] = &row.lines;
        while !rest.is_empty() {
            let (mut n_lines, mut n_points) = (0, 0);
            while n_lines < rest.len() && n_points < CHUNK {
                n_points += rest[n_lines].points.len();
                n_lines += 1;
            }
            let (lines, later) = rest.split_at(n_lines);
            let piece = Piece::Lines { lines, place, first: self.next.position };
            self.add(body, n_points + n_lines, piece)?;
            self.next.position += n_points as u64;
            rest = later;
        }
        Ok(())
    }

    fn add(&mut self, body: &'a Body, weight: usize, piece: Piece<'a>) -> Result<(), Failure> {
        if self.chunks.is_empty() || self.weight >= CHUNK {
            if self.chunks.len() == BATCH {
                self.flush()?;
            }
            self.chunks.push(Vec::new());
            self.weight = 0;
        }
        if let Some(chunk) = self.chunks.last_mut() {
            chunk.push((body, piece));
        }
        self.weight += weight;
        Ok(())
    }

    /// Puts what waits into words and writes them.
    fn flush(&mut self) -> Result<(), Failure> {
        self.words.resize_with(self.chunks.len().max(self.words.len()), Vec::new);
        let outcomes = self.chunks.par_iter().zip(&mut self.words).map(|(chunk, words)| {
            words.clear();
            chunk.iter().try_for_each(|(body, piece)| {
                piece.write(words).map_err(|reason| refused(body, reason))
            })
        });
        let outcomes: Vec<Result<(), Failure>> = outcomes.collect();
        for (outcome, words) in outcomes.into_iter().zip(&self.words) {
            outcome?;
            self.out.write_all(words)?;
        }
        self.chunks.clear();
        Ok(())
    }
}

/// Cuts `n_copies` of `n_items` lines each into pieces of at most a chunk.
fn cut(
    n_items: usize,
    n_copies: usize,
    mut take: impl FnMut(Range<usize>, Range<usize>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    if n_items == 0 {
        return Ok(());
    }
    let at_once = (CHUNK / n_items).max(1);
    for copy in (0..n_copies).step_by(at_once) {
        let copies = copy..(copy + at_once).min(n_copies);
        for item in (0..n_items).step_by(CHUNK) {
            take(copies.clone(), item..(item + CHUNK).min(n_items))?;
        }
    }
    Ok(())
}
