//! Lights and cameras.

use sapwood_graph::{Camera, Lens, Light, LightShape};

use super::document::{Document, List, invalid};
use super::schema;
use crate::Error;

/// The lights with these numbers.
pub(super) fn lights(document: &Document<'_>, used: &[usize]) -> Result<Vec<Light>, Error> {
    used.iter().map(|index| light(document, *index)).collect()
}

/// The cameras with these numbers.
pub(super) fn cameras(document: &Document<'_>, used: &[usize]) -> Result<Vec<Camera>, Error> {
    used.iter().map(|index| camera(document, *index)).collect()
}

fn light(document: &Document<'_>, index: usize) -> Result<Light, Error> {
    let at = List::Lights.entry(index);
    let raw: schema::Light<'_> = document.get(List::Lights, index, &at)?;
    let shape = match &*raw.kind.0 {
        "directional" => LightShape::Directional,
        "point" => LightShape::Point { range: raw.range },
        "spot" => {
            let spot = raw.spot.unwrap_or_default();
            LightShape::Spot {
                range: raw.range,
                inner: spot.inner_cone_angle.unwrap_or(0.0),
                outer: spot.outer_cone_angle.unwrap_or(std::f32::consts::FRAC_PI_4),
            }
        }
        _ => {
            let accepted = "\"directional\", \"point\" or \"spot\"";
            return Err(invalid(format_args!("{at}.type"), raw.kind.quoted(), accepted));
        }
    };
    let light = Light {
        name: raw.name.map(|name| name.0.into_owned()).unwrap_or_default(),
        color: raw.color.unwrap_or([1.0; 3]),
        intensity: raw.intensity.unwrap_or(1.0),
        shape,
    };
    match light.fault() {
        Some(fault) => Err(invalid(at, fault, "")),
        None => Ok(light),
    }
}

fn camera(document: &Document<'_>, index: usize) -> Result<Camera, Error> {
    let at = List::Cameras.entry(index);
    let raw: schema::Camera<'_> = document.get(List::Cameras, index, &at)?;
    let (lens, near, far) = match (&*raw.kind.0, raw.perspective, raw.orthographic) {
        ("perspective", Some(perspective), _) => {
            let lens = Lens::Perspective { vertical_angle: perspective.yfov };
            (lens, perspective.znear, perspective.zfar)
        }
        ("orthographic", _, Some(orthographic)) => {
            let lens = Lens::Orthographic { height: 2.0 * orthographic.ymag };
            // The standard lets the near distance be 0; ours must be above.
            let near = match orthographic.znear == 0.0 {
                true => f32::MIN_POSITIVE,
                false => orthographic.znear,
            };
            (lens, near, Some(orthographic.zfar))
        }
        ("perspective" | "orthographic", ..) => {
            return Err(invalid(at, format!("no {} values", raw.kind.0), "those of its type"));
        }
        _ => {
            let accepted = "\"perspective\" or \"orthographic\"";
            return Err(invalid(format_args!("{at}.type"), raw.kind.quoted(), accepted));
        }
    };
    let name = raw.name.map(|name| name.0.into_owned()).unwrap_or_default();
    let camera = Camera { name, lens, near, far };
    match camera.fault() {
        Some(fault) => Err(invalid(at, fault, "")),
        None => Ok(camera),
    }
}
