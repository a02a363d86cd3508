//! Impostors: images of a scene from many directions, on boards that stand for it from afar.
//!
//! Each direction has a cell of one image, taken by parallel rays from afar, and a board square to
//! it that is as large as the cell shows and stands where it was taken. Where a cell is covered by
//! halves, as by leaves that are smaller than its pixels, it is cut at such a coverage that
//! the board covers as much as what it stands for (after I. Castano: "Computing Alpha Mipmaps",
//! 2010), and its colours are corrected for what the cut leaves out.

mod atlas;
mod extent;
mod options;

use std::ops::ControlFlow;
use std::sync::Arc;

use sapwood_geom::glam::{Vec2, Vec3};
use sapwood_geom::{Digest, Digester, FixedMap, Mesh, Shared, SharedMesh, fixed_state};
use sapwood_graph::{
    Alpha, Aspects, DrawList, Everything, Impostor, Material, MaterialImages, Provide, discover,
    draw_list,
};

use crate::{PictureError, Progress, Studio};

use atlas::Atlas;
use extent::{Frame, Points};
pub use options::{ImpostorLight, ImpostorOptions};

/// The coverage from which on a board is there.
const LEAST_COVERAGE: f32 = 0.5;

/// Makes impostors and keeps them: what was made once is made again only when what it stands for
/// has changed, back and forth between edits too.
///
/// Those that were asked for last are kept, as many as together take no more than a
/// [budget](Self::with_budget).
#[derive(Debug)]
pub struct Impostors {
    options: ImpostorOptions,
    budget: u64,
    kept: FixedMap<Digest, Kept>,
    /// How often impostors were asked for.
    n_asked: u64,
}

#[derive(Debug)]
struct Kept {
    impostor: Arc<Impostor>,
    bytes: u64,
    /// When it was asked for last.
    asked: u64,
}

impl Impostors {
    /// The bytes that impostors may take where nobody says otherwise: those of some two hundred
    /// trees.
    pub const DEFAULT_BUDGET: u64 = 1 << 28;

    /// None so far.
    pub fn new(options: ImpostorOptions) -> Self {
        let kept = FixedMap::with_hasher(fixed_state());
        Self { options, budget: Self::DEFAULT_BUDGET, kept, n_asked: 0 }
    }

    /// The same with another limit to the bytes of the images and boards that are kept. Where they
    /// come to more, those are dropped that nobody has asked for for the longest, down to the one
    /// that was asked for last, which is kept whatever it takes. What is dropped stays with whoever
    /// holds it; asked for again, it is made again.
    #[must_use]
    pub fn with_budget(mut self, bytes: u64) -> Self {
        self.budget = bytes;
        self.keep_to_budget();
        self
    }

    /// The impostor of everything that `provide` hands out, in the root's frame; compiles all of
    /// it. `progress` is called now and then while pictures are taken, and stops it by breaking.
    ///
    /// It shows what the view draws as it is, so a view whose eye is far away gives an impostor of
    /// what is left there: make impostors of views that have no eye.
    ///
    /// One that is there is found by a digest over the draw list, and costs what that costs.
    ///
    /// # Errors
    /// When nothing is drawn, an option is out of its range, or compiling was cancelled or
    /// exhausted a budget.
    pub fn of(
        &mut self,
        provide: &mut dyn Provide,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Arc<Impostor>, PictureError> {
        self.options.check()?;
        self.options.picture_options([8, self.options.rows]).check()?;
        discover(provide, &Everything)?;
        let list = draw_list(&*provide, usize::MAX).expect("rows are not limited");
        let digest = digest(&list, self.options.light);
        self.n_asked += 1;
        if let Some(kept) = self.kept.get_mut(&digest) {
            kept.asked = self.n_asked;
            return Ok(Arc::clone(&kept.impostor));
        }
        let impostor = Arc::new(made(provide, &list, &self.options, progress)?);
        let kept = Kept {
            impostor: Arc::clone(&impostor),
            bytes: n_bytes(&impostor),
            asked: self.n_asked,
        };
        self.kept.insert(digest, kept);
        self.keep_to_budget();
        Ok(impostor)
    }

    /// How many impostors are kept.
    pub fn n_kept(&self) -> usize {
        self.kept.len()
    }

    /// The bytes of their images and boards.
    pub fn n_bytes(&self) -> u64 {
        self.kept.values().map(|kept| kept.bytes).sum()
    }

    /// Forgets all impostors that nobody else holds.
    pub fn forget_unused(&mut self) {
        self.kept.retain(|_, kept| Arc::strong_count(&kept.impostor) > 1);
    }

    fn keep_to_budget(&mut self) {
        let mut bytes = self.n_bytes();
        while bytes > self.budget && self.kept.len() > 1 {
            let least = self.kept.iter().min_by_key(|(_, kept)| kept.asked);
            let Some(oldest) = least.map(|(digest, _)| *digest) else { return };
            bytes -= self.kept.remove(&oldest).map_or(0, |kept| kept.bytes);
        }
    }
}

/// The bytes of an impostor's image and boards.
fn n_bytes(impostor: &Impostor) -> u64 {
    // Both images are one.
    let image = impostor.material.images.base_color.as_ref();
    let image = image.map_or(0, |image| size_of_val(image.pixels.as_slice()));
    let mesh = &impostor.mesh;
    let vertices = mesh.positions.len() * (2 * size_of::<Vec3>() + size_of::<Vec2>());
    (image + vertices + size_of_val(mesh.indices.as_slice())) as u64
}

/// What a list draws, and the lights in it where they count.
fn digest(list: &DrawList, light: ImpostorLight) -> Digest {
    let mut digester = Digester::new();
    for (world, row) in list.placed_rows() {
        digester.add(&world).add(&row.mesh).add(&row.material).add(&row.instances);
        digester.add(&row.range.map(|range| (range.first, range.end)));
        digester.add(&row.cross_fade.map(|fade| (fade.first, fade.end)));
    }
    for (world, row) in list.placed_lines() {
        digester.add(&world).add(&row.lines).add(&row.material);
        digester.add(&row.range.map(|range| (range.first, range.end)));
    }
    for (world, light) in list.placed_lights().filter(|_| light.is_baked()) {
        digester.add(&world).add(light);
    }
    digester.finish()
}

/// Takes all pictures.
fn made(
    provide: &mut dyn Provide,
    list: &DrawList,
    options: &ImpostorOptions,
    progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Impostor, PictureError> {
    let toward = options.directions();
    let points = Points::of(list);
    let cell = points.cell(&toward, options.rows)?;
    let mut atlas = Atlas::new(cell, toward.len() as u32)?;
    let picture_options = options.picture_options(cell);
    let n_cells = toward.len() as u64;
    let mut studio = Studio::new(provide);
    let mut mesh = Mesh::default();
    for (number, toward) in (0..).zip(&toward) {
        let frame = points.frame(*toward, cell)?;
        let mut all = |one: &Progress| {
            let n_done = u64::from(number) * one.n_pixels + one.n_done;
            progress(&Progress { n_done, n_pixels: n_cells * one.n_pixels, ..*one })
        };
        let picture = studio.picture(&frame.camera, &picture_options, &mut all)?;
        atlas.put(number, &picture.image);
        add_board(&mut mesh, &frame, *toward, atlas.place(number));
    }
    let image = Shared::new(atlas.finish());
    let mut material = options.light.material();
    material.images = MaterialImages {
        emissive: options.light.is_baked().then(|| image.clone()),
        base_color: Some(image),
        ..MaterialImages::default()
    };
    let aspects = Aspects {
        toward: Shared::new(toward),
        center: points.center(),
        without_eye: ImpostorOptions::CROSSED,
        blends: true,
    };
    Ok(Impostor { mesh: SharedMesh::new(mesh), material: Arc::new(material), aspects })
}

impl ImpostorLight {
    /// What its boards are made of, but for the image.
    fn material(&self) -> Material {
        let alpha = Alpha::Mask(LEAST_COVERAGE);
        let matte = Material { alpha, ..Material::matte("impostor", 1.0, 1.0, 1.0) };
        match self {
            Self::Even => matte,
            // Black metal throws back nothing of the light that falls on it.
            Self::Baked { .. } => Material {
                base_color: [0.0, 0.0, 0.0, 1.0],
                metallic: 1.0,
                emissive: [1.0; 3],
                ..matte
            },
        }
    }
}

/// Adds a board: two triangles, seen from their front with the part of the image from the first
/// to the second texture coordinate on them.
fn add_board(mesh: &mut Mesh, frame: &Frame, toward: Vec3, [first, end]: [Vec2; 2]) {
    let start = mesh.positions.len() as u32;
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        mesh.positions.push(frame.corner(x, y));
        mesh.normals.push(toward);
        mesh.uvs.push(first + (end - first) * Vec2::new(x, 1.0 - y));
    }
    mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| start + corner));
}
