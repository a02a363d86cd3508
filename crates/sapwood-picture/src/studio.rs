//! Taking pictures of a scene.

use std::ops::ControlFlow;

use sapwood_geom::glam::Vec3;
use sapwood_geom::{Image, Ray32};
use sapwood_graph::{Interrupted, Provide};

use crate::camera::Gaze;
use crate::rounds::{self, too_much};
use crate::spot::Spot;
use crate::trace::{Chance, Met};
use crate::world::{LineWidth, World};
use crate::{PictureError, PictureOptions, PlacedCamera};

/// Takes pictures of a scene, and keeps what rays have found of it from one to the next.
///
/// What turns to the eye turns to the eye of the view, not to the camera: set the view's slot
/// `Viewer` to [`PlacedCamera::eye`] where there is such a thing.
pub struct Studio<'a> {
    provide: &'a mut dyn Provide,
    world: Option<World>,
}

/// A picture, and what it took.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The pixels, sRGB-encoded.
    pub image: Image,
    /// How many rays were sent.
    pub rays: RayCounts,
    /// How many links were filled because a ray came by.
    pub n_filled: u64,
}

/// How many rays of each sort were sent; those of a pixel that was tried again count again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub primary: u64,
    /// Toward the sun and other lights.
    pub shadow: u64,
    /// Toward the sky.
    pub sky: u64,
    /// Mirrored.
    pub reflected: u64,
}

/// What a ray meets first, in the scene's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Metres from the ray's origin.
    pub distance: f32,
    /// Where it is.
    pub point: Vec3,
    /// Unit normal of the surface, toward where the ray comes from.
    pub normal: Vec3,
    /// Unit normal that it is lit by.
    pub shading_normal: Vec3,
}

/// How far a picture has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Pixels that are finished.
    pub n_done: u64,
    /// Pixels in all.
    pub n_pixels: u64,
    /// How many links were filled because a ray came by.
    pub n_filled: u64,
}

impl<'a> Studio<'a> {
    /// A studio for what `provide` hands out. Compiles nothing yet.
    pub fn new(provide: &'a mut dyn Provide) -> Self {
        Self { provide, world: None }
    }

    /// Takes a picture. `progress` is called now and then, and stops it by breaking.
    ///
    /// Costs the rays; components are compiled where rays come by, or where nothing was foreseen
    /// of their bounds.
    ///
    /// # Errors
    /// When an option is out of range, the camera cannot look, a budget ran out, or it was
    /// stopped, which counts as cancelled.
    pub fn picture(
        &mut self,
        camera: &PlacedCamera,
        options: &PictureOptions,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Picture, PictureError> {
        options.check()?;
        if let Some(fault) = camera.fault() {
            return Err(PictureError::Camera(fault));
        }
        let gaze = Gaze::new(camera, options.size);
        // Lines are as thick as this camera sees them.
        let mut world = self.world(LineWidth::new(&gaze, options.line_width))?;
        let picture = rounds::picture(self.provide, &mut world, &gaze, options, progress);
        // What was interrupted may be gathered by halves.
        self.world = picture.is_ok().then_some(world);
        picture
    }
    /// What a ray of a picture meets first before `reach`, in metres; compiles what it has to on
    /// the way. Lines are as thick as they say here, not as a camera sees them.
    ///
    /// Rounds to `f32`; [`pick`](sapwood_graph::pick) tells more, and more precisely.
    ///
    /// # Errors
    /// When compiling was cancelled or a budget ran out.
    pub fn sight(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
    ) -> Result<Option<Sight>, PictureError> {
        let Some(direction) = direction.try_normalize().filter(|_| origin.is_finite()) else {
            return Ok(None);
        };
        let mut world = self.world(LineWidth::none())?;
        let ray = Ray32::new(origin, direction);
        let options = PictureOptions::default();
        let met = loop {
            match world.nearest(&ray, reach, Chance::of_path(0.5)) {
                Met::Hit(hit) => break Some(hit),
                Met::Nothing => break None,
                Met::Waiting(wait) => world.fill(self.provide, &[wait])?,
                Met::TooMuch => return Err(too_much(self.provide).into()),
            }
        };
        let sight = met.map(|hit| {
            let spot = Spot::new(&world, &options, &ray, &hit, 0.0);
            let Spot { point, normal, shading_normal, .. } = spot;
            Sight { distance: hit.distance, point, normal, shading_normal }
        });
        self.world = Some(world);
        Ok(sight)
    }

    /// What was found so far, or everything that is compiled already.
    fn world(&mut self, line_width: LineWidth) -> Result<World, Interrupted> {
        match self.world.take().filter(|world| world.suits(line_width)) {
            Some(world) => Ok(world),
            None => World::new(self.provide, line_width),
        }
    }
}
