//! OBJ in: the triangles of a file, all in one frame, with the materials that it names.
//!
//! The crate `tobj` reads the text. It tells of no error where it stands, takes lines for faces and
//! believes what indices say; so each line is looked at before, and what is understood is handed
//! on.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::Path;
use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{FixedSet, Mesh, fixed_state};
use sapwood_graph::Material;

use super::read_materials::Library;
use crate::gltf::flat;
use crate::spelling::shortened_to;
use crate::{Error, ErrorKind, Place, ReadLimits};

/// What an OBJ file shows.
pub(crate) struct ObjModel {
    /// All its triangles.
    pub(crate) mesh: Mesh,
    /// What its parts are drawn with, each once; nothing for parts that name no known material.
    pub(crate) materials: Vec<Option<Arc<Material>>>,
}

/// Reads the faces of the OBJ file at `path`, with the materials that they have, from its folder or
/// below. Polygons become fans of triangles; what has no normals has those of flat triangles;
/// lines, points, curves and colours of vertices are left out.
///
/// # Errors
/// When a file cannot be read or is longer than the limits allow, and at the first line that is not
/// as the format has it or goes beyond them.
pub(crate) fn read_obj(path: &Path, limits: &ReadLimits) -> Result<ObjModel, Error> {
    let most = limits.text_bytes.min(limits.bytes);
    let mut bytes = Vec::new();
    let cannot = |cause| Error::read(path, cause);
    let file = File::open(path).map_err(cannot)?;
    let length = file.metadata().map_err(cannot)?.len();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(cannot)?;
    let in_file = |error: Error| error.in_file(&path.display().to_string());
    if bytes.len() as u64 > most {
        // No more than one byte too many was read.
        let bytes = length.max(bytes.len() as u64);
        return Err(in_file(Error::new(ErrorKind::TooLong { bytes, limit: most })));
    }
    let library = Library::beside(path, bytes.len() as u64, limits);
    // Names may be in any encoding; what else is understood is ASCII.
    read(&String::from_utf8_lossy(&bytes), library, limits).map_err(in_file)
}

fn read(text: &str, mut library: Library, limits: &ReadLimits) -> Result<ObjModel, Error> {
    let understood = Understood::of(text, &mut library, limits)?;
    let known = |_: &Path| {
        // Their names are all that is asked for.
        let materials = vec![tobj::Material::default(); library.names().len()];
        let numbers = library.names().map(|(name, number)| (name.to_owned(), number));
        Ok((materials, numbers.collect()))
    };
    let mut lines = Lines { rest: understood.text.as_bytes(), n: 0 };
    let options = tobj::LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let loaded = tobj::load_obj_buf(&mut lines, &options, known);
    let (models, _) = loaded
        .map_err(|error| syntax(lines.n, format!("{error} (accepted: numbers between spaces)")))?;
    let mut all = ObjModel { mesh: Mesh::default(), materials: Vec::new() };
    let mut used = FixedSet::with_hasher(fixed_state());
    for tobj::Model { mesh, .. } in models {
        if !mesh.indices.is_empty() && used.insert(mesh.material_id) {
            all.materials.push(match mesh.material_id {
                Some(number) => library.material(number)?,
                None => None,
            });
        }
        all.mesh.append(&mesh_of(&mesh), &Affine3::IDENTITY);
    }
    Ok(all)
}

/// A mesh with texture coordinates from the upper edge.
fn mesh_of(read: &tobj::Mesh) -> Mesh {
    let vectors =
        |numbers: &[f32]| -> Vec<Vec3> { numbers.chunks_exact(3).map(Vec3::from_slice).collect() };
    let (positions, normals) = (vectors(&read.positions), vectors(&read.normals));
    // Where only some corners have one, there is no telling which.
    let mut uvs = vec![Vec2::ZERO; positions.len()];
    if read.texcoords.len() == 2 * positions.len() {
        let given = read.texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0], 1.0 - uv[1]));
        uvs = given.collect();
    }
    let units: Vec<Vec3> = normals.iter().filter_map(|normal| normal.try_normalize()).collect();
    if units.len() != positions.len() {
        return flat(&positions, &uvs, &read.indices);
    }
    Mesh { positions, normals: units, uvs, indices: read.indices.clone() }
}

/// What vertices, texture coordinates and normals are called.
const WHAT: [&str; 3] = ["positions", "texture coordinates", "normals"];

/// The lines of a file that are understood, each at its place; the others are empty.
struct Understood {
    text: String,
    /// How many positions, texture coordinates and normals there are so far.
    n: [u64; 3],
    n_triangles: u64,
    /// Whether the place is named where all materials are.
    has_library: bool,
}

impl Understood {
    fn of(text: &str, library: &mut Library, limits: &ReadLimits) -> Result<Self, Error> {
        let room = String::with_capacity(text.len());
        let mut understood = Self { text: room, n: [0; 3], n_triangles: 0, has_library: false };
        for (number, n_lines, line) in whole_lines(text) {
            understood.line(number, &line, library, limits)?;
            understood.text.extend(std::iter::repeat_n('\n', n_lines));
        }
        Ok(understood)
    }

    fn line(
        &mut self,
        number: usize,
        line: &str,
        library: &mut Library,
        limits: &ReadLimits,
    ) -> Result<(), Error> {
        let mut words = line.split_whitespace().take_while(|word| !begins_comment(word));
        let over = |found, what, limit| {
            let at = "the file".to_owned();
            Err(at_line(number, ErrorKind::OverLimit { at, found, what, limit }))
        };
        match words.next() {
            Some(first @ ("v" | "vt" | "vn")) => {
                let which = ["v", "vt", "vn"].iter().position(|name| *name == first).unwrap_or(0);
                self.n[which] += 1;
                if self.n[which] > limits.vertices {
                    return over(self.n[which], WHAT[which], limits.vertices);
                }
                // A weight or a colour may stand behind the coordinates.
                self.text.push_str(first);
                words.take(3).for_each(|word| self.text.extend([" ", word]));
            }
            Some("f") => {
                let mut n_corners = 0;
                self.text.push('f');
                for corner in words {
                    self.look_at_corner(number, corner)?;
                    self.text.extend([" ", corner]);
                    n_corners += 1;
                }
                if n_corners < 3 {
                    let found = format!("a face of {n_corners} corners (accepted: 3 or more)");
                    return Err(syntax(number, found));
                }
                self.n_triangles += n_corners - 2;
                if self.n_triangles > limits.triangles {
                    return over(self.n_triangles, "triangles", limits.triangles);
                }
            }
            Some("mtllib") => {
                let found = library.read(behind("mtllib", line), words, number);
                found.map_err(|error| error.at(Place { line: number, column: 1 }))?;
                // All materials are there from the first name on.
                if !self.has_library {
                    self.text.push_str("mtllib m");
                    self.has_library = true;
                }
            }
            Some("usemtl") => {
                let mut name = behind("usemtl", line);
                if !library.knows(name) {
                    name = without_comment(name);
                }
                if !name.is_empty() {
                    self.text.extend(["usemtl ", name]);
                }
            }
            Some("o" | "g") => self.text.push('o'),
            _ => {}
        }
        Ok(())
    }

    /// Refuses what is no corner of a face among what is there so far.
    fn look_at_corner(&self, line: usize, corner: &str) -> Result<(), Error> {
        let wrong = |why: String| {
            let corner = shortened_to(40, corner);
            Err(syntax(line, format!("the corner '{corner}' {why}")))
        };
        for (which, part) in corner.split('/').enumerate() {
            let Some(what) = WHAT.get(which) else {
                return wrong("has more than three numbers (accepted: 1, 1/2, 1//3, 1/2/3)".into());
            };
            if part.is_empty() && which > 0 {
                continue;
            }
            let n = self.n[which];
            match part.parse::<i64>() {
                Ok(number) if number != 0 && number.unsigned_abs() <= n => {}
                Ok(_) => {
                    return wrong(format!(
                        "is none of the {n} {what} above (accepted: 1 to {n}, -1 to -{n})"
                    ));
                }
                Err(_) => {
                    return wrong("is no number (accepted: 1, 1/2, 1//3, 1/2/3)".into());
                }
            }
        }
        Ok(())
    }
}

/// The lines of a text, each with its number and how many it takes: where one ends in a backslash,
/// the next goes on with it.
fn whole_lines(text: &str) -> impl Iterator<Item = (usize, usize, Cow<'_, str>)> {
    let (mut lines, mut n) = (text.lines(), 0);
    std::iter::from_fn(move || {
        let first = lines.next()?;
        n += 1;
        let number = n;
        let Some(begun) = continued(first) else { return Some((number, 1, Cow::Borrowed(first))) };
        let mut whole = begun.to_owned();
        for next in lines.by_ref() {
            n += 1;
            let begun = continued(next);
            whole.extend([" ", begun.unwrap_or(next)]);
            if begun.is_none() {
                break;
            }
        }
        Some((number, n - number + 1, Cow::Owned(whole)))
    })
}

/// What a line begins that the next goes on with. Comments end with their line.
fn continued(line: &str) -> Option<&str> {
    let begun = line.trim_end().strip_suffix('\\')?;
    (!begun.split_whitespace().any(begins_comment)).then_some(begun)
}

fn begins_comment(word: &str) -> bool {
    word.starts_with('#')
}

/// What stands behind the first word of a line.
fn behind<'a>(first: &str, line: &'a str) -> &'a str {
    let line = line.trim();
    line.strip_prefix(first).unwrap_or(line).trim_start()
}

/// A name without the comment behind it.
fn without_comment(name: &str) -> &str {
    let mut marks = name.match_indices('#').map(|(at, _)| name.split_at(at).0);
    let comment = marks.find(|before| before.is_empty() || before.ends_with(char::is_whitespace));
    comment.unwrap_or(name).trim_end()
}

fn at_line(line: usize, kind: ErrorKind) -> Error {
    Error::new(kind).at(Place { line, column: 1 })
}

fn syntax(line: usize, message: String) -> Error {
    at_line(line, ErrorKind::Syntax { format: "OBJ", message })
}

/// A text that is handed out line by line, and tells how many were.
struct Lines<'a> {
    rest: &'a [u8],
    n: usize,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(buffer)?;
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let end = self.rest.iter().position(|byte| *byte == b'\n');
        Ok(&self.rest[..end.map_or(self.rest.len(), |end| end + 1)])
    }

    fn consume(&mut self, amount: usize) {
        let (done, rest) = self.rest.split_at(amount);
        self.n += usize::from(done.ends_with(b"\n"));
        self.rest = rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The model, or what is wrong with it.
    fn model(text: &str) -> Result<ObjModel, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("leaf.obj");
        std::fs::write(&path, text).unwrap();
        let limits = ReadLimits { triangles: 4, vertices: 8, ..ReadLimits::default() };
        let told =
            |error: Error| error.to_string().replace(&format!("{}/", folder.path().display()), "");
        read_obj(&path, &limits).map_err(told)
    }

    const SQUARE: &str = "# a leaf\no leaf\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1 1.0\n";

    #[test]
    fn polygons_become_triangles_however_they_are_written() {
        let of = |rest: &str| model(&format!("{SQUARE}{rest}")).unwrap().mesh;
        let plain = of("f 1 2 3 4\n");
        assert_eq!((plain.n_triangles(), plain.n_vertices()), (2, 6));
        assert_eq!(plain.fault(), None);
        assert!(plain.normals.iter().all(|normal| *normal == Vec3::NEG_Y), "flat");
        let whole =
            of("vt 0 0\nvt 1 1\nvn 0 2 0\nl 1 2 3\np 1\nf -4/1/1 -3/1/1 -2/2/-1 -1/2/1\r\n");
        assert_eq!((whole.n_triangles(), whole.n_vertices()), (2, 4));
        assert_eq!(whole.normals, [Vec3::Y; 4]);
        // The upper edge of the image is its first row.
        assert_eq!(whole.uvs, [Vec2::Y, Vec2::Y, Vec2::X, Vec2::X]);
        assert_eq!(of("g one\nf 1 2 3\ng two\nf 1 3 4").n_triangles(), 2);
        assert!(of("").is_empty());
    }

    #[test]
    fn comments_and_continued_lines_are_understood() {
        let of = |rest: &str| model(&format!("{SQUARE}{rest}")).unwrap().mesh;
        let plain = of("f 1 2 3 4\n");
        for rest in [
            "f 1 2 3 4 # tip\n",
            "f 1 2 3 4 #5 6\\\n",
            "f 1 2 \\\n3 4\n",
            "f\\ \r\n1 2 3\\\r\n\\\r\n4\r\n# models\\leaf\\\r\n",
            "# models\\\nf 1 2 3 4 \\",
            "g a \\\nb # c\nusemtl # none\nf 1 2 3 4",
        ] {
            assert_eq!(of(rest), plain, "{rest}");
        }
    }

    #[test]
    fn materials_are_made_as_faces_use_them() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
        std::fs::create_dir(folder.path().join("textures")).unwrap();
        let image = sapwood_geom::Image::from_fn(2, 2, |_, _| [1, 2, 3, 255]);
        crate::write_png(folder.path().join("textures/leaf%201.png"), &image).unwrap();
        let bark = "newmtl bark\nmap_Kd bark.png\nnewmtl red\nKd 1 0 0\n";
        write("a.mtl", bark).unwrap();
        write("b%20b.mtl", "newmtl leaf\nmap_Kd -clamp on textures\\leaf%201.png\n").unwrap();
        write("c c.mtl", "newmtl leaf #2\nKd 0 1 0\n").unwrap();
        let read = |rest: &str| {
            write("leaf.obj", &format!("{SQUARE}{rest}")).unwrap();
            // Room for one image of four pixels.
            let limits = ReadLimits { pixels: 4, ..ReadLimits::default() };
            let model = read_obj(&folder.path().join("leaf.obj"), &limits);
            let names = |model: ObjModel| -> Vec<String> {
                let name = |material: Option<Arc<Material>>| {
                    material.map_or("none".to_owned(), |material| {
                        let has_image = material.images.base_color.is_some();
                        format!("{}{}", material.name, if has_image { " painted" } else { "" })
                    })
                };
                model.materials.into_iter().map(name).collect()
            };
            model.map(names).map_err(|error| error.to_string())
        };
        let (leaf, two) = ("usemtl leaf\nf 1 2 3\n", "mtllib a.mtl b%20b.mtl\n");
        let painted = ["leaf painted".to_owned()];
        // The bark's image is not there, and no face has it, even where it is named last.
        assert_eq!(read(&format!("{two}{leaf}")).unwrap(), painted);
        assert_eq!(read(&format!("{two}{leaf}usemtl bark\n")).unwrap(), painted);
        assert_eq!(read(&format!("{two}usemtl leaf # tip\nf 1 2 3")).unwrap(), painted);
        // Each once, and its image counted once.
        let again = format!("{two}{leaf}usemtl red\nf 1 2 3\n{leaf}usemtl none\nf 1 3 4\n");
        assert_eq!(read(&again).unwrap(), ["leaf painted", "red", "none"]);
        let spaces = "mtllib c c.mtl\nmtllib b%20b.mtl\nusemtl leaf #2\nf 1 2 3\n";
        assert_eq!(read(spaces).unwrap(), ["leaf #2"]);
        assert_eq!(read(&format!("{spaces}{leaf}")).unwrap(), ["leaf #2", "leaf painted"]);
        for (rest, expected) in [
            (format!("\n{two}usemtl bark\nf 1 2 3\n"), "leaf.obj:8:1: map_Kd: \"bark.png\" cannot"),
            ("mtllib a.mtl no.mtl".to_owned(), "leaf.obj:7:1: mtllib: \"no.mtl\" cannot be read"),
            ("mtllib data:,newmtl".to_owned(), "has characters that no path should have"),
        ] {
            let told = read(&rest).unwrap_err();
            assert!(told.contains(expected), "{rest}: {told}");
        }
    }

    #[test]
    fn errors_tell_the_line() {
        let told = |rest: &str| model(&format!("{SQUARE}{rest}")).err().unwrap_or_default();
        for (rest, expected) in [
            ("f 1 2\n", "leaf.obj:7:1: not valid OBJ: a face of 2 corners (accepted: 3 or more)"),
            (
                "\nf 1 2 5\n",
                "leaf.obj:8:1: not valid OBJ: the corner '5' is none of the 4 positions",
            ),
            ("f 1 2 0\n", "leaf.obj:7:1: not valid OBJ: the corner '0' is none of the 4"),
            ("f 1 2 -5\n", "'-5' is none of the 4 positions above"),
            ("f 1/1 2 3\n", "'1/1' is none of the 0 texture coordinates above"),
            ("f 1 2 x\n", "leaf.obj:7:1: not valid OBJ: the corner 'x' is no number"),
            ("f 1/2/3/4 2 3\n", "leaf.obj:7:1: not valid OBJ: the corner '1/2/3/4'"),
            ("f 1 2 9223372036854775808\n", "is no number"),
            ("f 1 2 -9223372036854775808\n", "is none of the 4"),
            ("v 1 2\n", "leaf.obj:7:1: not valid OBJ: position parse error"),
            ("\n\nvt x 1\nf 1 2 3", "leaf.obj:9:1: not valid OBJ: texcoord parse error"),
            ("f 1 2 3 4 1 2 3 4\n", "leaf.obj:7:1: the file: 6 triangles; at most 4 are read"),
            ("v 1 1 1\n".repeat(5).as_str(), "leaf.obj:11:1: the file: 9 positions; at most 8"),
            ("vt 1 1\n".repeat(9).as_str(), "15:1: the file: 9 texture coordinates; at most 8"),
            ("vn 1 1 1\n".repeat(9).as_str(), "15:1: the file: 9 normals; at most 8 are read"),
            ("f 1 2 \\\n3\nf 1 2 \\\n 9", "leaf.obj:9:1: not valid OBJ: the corner '9' is none"),
            ("f 1 \\\n\\\n3\n", "leaf.obj:7:1: not valid OBJ: a face of 2 corners"),
            ("f 1 2 3 \\\n4\nv 1 x 2\n", "leaf.obj:9:1: not valid OBJ: position parse error"),
            ("mtllib\n", "leaf.obj:7:1: mtllib: \"\" is no path"),
            ("mtllib no such.mtl # tip\n", "leaf.obj:7:1: mtllib: \"no such.mtl # tip\" cannot"),
            ("mtllib none.mtl # tip\n", "leaf.obj:7:1: mtllib: \"none.mtl\" cannot be read"),
            ("mtllib none.mtl\n", "leaf.obj:7:1: mtllib: \"none.mtl\" cannot be read"),
            (
                "mtllib ../leaf.obj\n",
                "leaf.obj:7:1: mtllib: \"../leaf.obj\" leads out of the folder",
            ),
        ] {
            assert!(told(rest).contains(expected), "{rest}: {}", told(rest));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.obj");
        std::fs::write(&path, SQUARE).unwrap();
        let limits = ReadLimits { text_bytes: 9, ..ReadLimits::default() };
        let error = read_obj(&path, &limits).err().unwrap().to_string();
        let expected = format!("is {} bytes long; at most 9 are read", SQUARE.len());
        assert!(error.ends_with(&expected), "{error}");
        let missing = read_obj(Path::new("no-such.obj"), &ReadLimits::default()).err();
        assert!(missing.is_some_and(|error| error.to_string().contains("no-such.obj")));
    }

    #[test]
    fn no_text_makes_the_reader_panic() {
        // Words that the format has, in any order.
        let words = ["v", "vt", "vn", "f", "o", "g", "usemtl", "l", "\\", "1", "-1", "0", "1e39"];
        let mut state = 7u64;
        let mut any = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % n
        };
        let mut n_read = 0;
        for _ in 0..2000 {
            let line = |any: &mut dyn FnMut(usize) -> usize| {
                (0..any(6)).map(|_| words[any(words.len())]).collect::<Vec<_>>().join(" ")
            };
            let lines: Vec<_> = (0..any(6)).map(|_| line(&mut any)).collect();
            n_read += usize::from(model(&format!("{SQUARE}{}", lines.join("\n"))).is_ok());
        }
        assert!((100..1900).contains(&n_read), "{n_read}");
    }
}
