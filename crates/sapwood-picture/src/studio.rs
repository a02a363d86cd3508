//! Taking pictures of a scene.

use std::ops::ControlFlow;

use sapwood_geom::Image;
use sapwood_graph::Provide;

use crate::camera::Gaze;
use crate::rounds;
use crate::world::World;
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

/// How many rays of each sort were sent.
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
        let kept = self.world.take().filter(|world| world.suits(&gaze, options));
        let mut world = match kept {
            Some(world) => world,
            None => World::new(self.provide, &gaze, options)?,
        };
        let picture = rounds::picture(self.provide, &mut world, &gaze, options, progress);
        self.world = Some(world);
        picture
    }
}
