//! Taking the pictures that were ordered, of a view that is compiled as far as rays need it.

use std::time::{Duration, Instant};

use sapwood::geom::Image;
use sapwood::picture::{Picture, RayCounts, Studio};
use sapwood::scene::{Scene, StyleSlot, ViewId, Viewer};
use serde::Serialize;

use super::order::{Extent, Order};
use crate::failure::Failure;
use crate::watch::Watch;

/// What taking pictures took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Toll {
    pub(crate) size: [u32; 2],
    pub(crate) samples: u32,
    pub(crate) n_pictures: u32,
    pub(crate) rays: RayCounts,
    pub(crate) time: Duration,
}

impl Toll {
    /// Rays of all sorts.
    pub(crate) fn n_rays(&self) -> u64 {
        let RayCounts { primary, shadow, sky, reflected } = self.rays;
        primary + shadow + sky + reflected
    }

    /// Both together, of one order.
    pub(crate) fn and(self, other: &Self) -> Self {
        let RayCounts { primary, shadow, sky, reflected } = self.rays;
        let rays = RayCounts {
            primary: primary + other.rays.primary,
            shadow: shadow + other.rays.shadow,
            sky: sky + other.rays.sky,
            reflected: reflected + other.rays.reflected,
        };
        let n_pictures = self.n_pictures + other.n_pictures;
        Self { n_pictures, rays, time: self.time + other.time, ..*other }
    }
}

/// What pictures took, for scripts. The keys are a promise: they stay.
#[derive(Debug, Serialize)]
pub(crate) struct TollDocument {
    width: u32,
    height: u32,
    samples: u32,
    count: u32,
    rays: RaysDocument,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct RaysDocument {
    primary: u64,
    shadow: u64,
    sky: u64,
    reflected: u64,
}

impl From<&Toll> for TollDocument {
    fn from(toll: &Toll) -> Self {
        let RayCounts { primary, shadow, sky, reflected } = toll.rays;
        let [width, height] = toll.size;
        Self {
            width,
            height,
            samples: toll.samples,
            count: toll.n_pictures,
            rays: RaysDocument { primary, shadow, sky, reflected },
            seconds: toll.time.as_secs_f64(),
        }
    }
}

/// Makes a view show everything in the style that was ordered.
pub(crate) fn style(scene: &mut Scene, view: ViewId, order: &Order) -> Result<(), Failure> {
    match order.style {
        Some(style) => Ok(scene.force_held::<StyleSlot>(view, style)?),
        None => Ok(()),
    }
}

/// Whoever watches pictures being taken, and how many there are.
pub(crate) struct Track<'a> {
    pub(crate) watch: &'a Watch,
    /// How many were taken before.
    pub(crate) n_before: u32,
    /// How many there are in all.
    pub(crate) n_pictures: u32,
}

/// Takes the pictures of `view` that were ordered, each with its number, and hands them to `keep`
/// one after the other.
pub(crate) fn take(
    scene: &mut Scene,
    view: ViewId,
    order: &Order,
    extent: &Extent,
    track: &Track<'_>,
    mut keep: impl FnMut(u32, Image) -> Result<(), Failure>,
) -> Result<Toll, Failure> {
    let Track { watch, n_before, n_pictures } = *track;
    let options = order.options(extent.foot);
    let mut toll = Toll { size: options.size, samples: options.samples, ..Toll::default() };
    watch.follow(scene.cancel_token(view)?);
    for (number, camera) in (0..).zip(order.cameras(extent)?) {
        // Things may turn to the eye, so each camera has a studio of its own.
        scene.set_moving::<Viewer>(view, Some(camera.eye()))?;
        let start = Instant::now();
        tracing::info!(picture = n_before + number, "drawing");
        let mut supply = scene.supply(view)?;
        let Picture { image, rays, .. } =
            Studio::new(&mut supply).picture(&camera, &options, &mut |progress| {
                let n_done = u64::from(n_before + number) * progress.n_pixels + progress.n_done;
                watch.drawn(n_done, u64::from(n_pictures) * progress.n_pixels)
            })?;
        let one = Toll { n_pictures: 1, rays, time: start.elapsed(), ..toll };
        toll = toll.and(&one);
        keep(number, image)?;
    }
    Ok(toll)
}
