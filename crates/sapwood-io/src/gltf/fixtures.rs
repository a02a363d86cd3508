//! Lights, cameras and lines of text: what is put somewhere and is no mesh.

use gltf_json as json;
use json::Index;
use json::extensions::{root, scene};
use json::extras::RawValue;
use json::validation::Checked::Valid;
use sapwood_graph::{Anchor, Body, Camera, Label, Lens, Light, LightShape};
use scene::khr_lights_punctual as punctual;

use super::document::{named, unwritable};
use crate::Error;

const LIGHTS: &str = "KHR_lights_punctual";

/// What a body has besides meshes, row by row.
pub(super) struct Fixtures {
    pub(super) lights: Vec<Index<punctual::Light>>,
    pub(super) cameras: Vec<Index<json::Camera>>,
}

impl Fixtures {
    /// Declares the lights and cameras of a body, and looks at its texts.
    pub(super) fn of(
        body: &Body,
        root: &mut json::Root,
        lights: &mut Vec<punctual::Light>,
    ) -> Result<Self, Error> {
        let refused = |what: &str, name: &str, fault: String| {
            unwritable(body, format!("{what} '{name}' has {fault}"))
        };
        let mut fixtures = Self { lights: Vec::new(), cameras: Vec::new() };
        for row in &body.lights {
            if let Some(fault) = row.light.fault() {
                return Err(refused("light", &row.light.name, fault));
            }
            fixtures.lights.push(Index::new(lights.len() as u32));
            lights.push(light(&row.light));
        }
        for row in &body.cameras {
            if let Some(fault) = row.camera.fault() {
                return Err(refused("camera", &row.camera.name, fault));
            }
            fixtures.cameras.push(root.push(camera(&row.camera)));
        }
        for row in &body.labels {
            if let Some(fault) = row.label.fault() {
                return Err(refused("text", &row.label.text, fault));
            }
        }
        Ok(fixtures)
    }
}

fn light(light: &Light) -> punctual::Light {
    let (type_, range, spot) = match light.shape {
        LightShape::Directional => (punctual::Type::Directional, None, None),
        LightShape::Point { range } => (punctual::Type::Point, range, None),
        LightShape::Spot { range, inner, outer } => {
            let spot = punctual::Spot { inner_cone_angle: inner, outer_cone_angle: outer };
            (punctual::Type::Spot, range, Some(spot))
        }
    };
    punctual::Light {
        color: light.color,
        extensions: None,
        extras: None,
        intensity: light.intensity,
        name: named(&light.name),
        range,
        spot,
        type_: Valid(type_),
    }
}

/// A camera of glTF, for pictures as wide as they are high where that matters.
fn camera(camera: &Camera) -> json::Camera {
    let (near, far) = (camera.near, camera.far);
    let (type_, perspective, orthographic) = match camera.lens {
        Lens::Perspective { vertical_angle } => {
            let perspective = json::camera::Perspective {
                aspect_ratio: None,
                yfov: vertical_angle,
                zfar: far,
                znear: near,
                extensions: None,
                extras: None,
            };
            (json::camera::Type::Perspective, Some(perspective), None)
        }
        Lens::Orthographic { height } => {
            let orthographic = json::camera::Orthographic {
                xmag: 0.5 * height,
                ymag: 0.5 * height,
                zfar: far.unwrap_or(f32::MAX),
                znear: near,
                extensions: None,
                extras: None,
            };
            (json::camera::Type::Orthographic, None, Some(orthographic))
        }
    };
    json::Camera {
        name: named(&camera.name),
        orthographic,
        perspective,
        type_: Valid(type_),
        extensions: None,
        extras: None,
    }
}

pub(super) fn light_node(light: &Light, index: Index<punctual::Light>) -> json::Node {
    let khr_lights_punctual = Some(punctual::KhrLightsPunctual { light: index });
    json::Node {
        name: named(&light.name),
        extensions: Some(scene::Node { khr_lights_punctual, ..Default::default() }),
        ..Default::default()
    }
}

pub(super) fn camera_node(camera: &Camera, index: Index<json::Camera>) -> json::Node {
    json::Node { name: named(&camera.name), camera: Some(index), ..Default::default() }
}

/// A node that has only a place; whoever knows texts finds one in its `extras`.
pub(super) fn label_node(label: &Label) -> json::Node {
    let anchor = match label.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let text = json::serialize::to_string(&label.text).expect("a text is JSON");
    let [red, green, blue, alpha] = label.color;
    let extras = format!(
        "{{\"text\":{text},\"height\":{},\"anchor\":\"{anchor}\",\"color\":[{red},{green},{blue},{alpha}]}}",
        label.height
    );
    json::Node {
        name: named(&label.text),
        extras: Some(RawValue::from_string(extras).expect("finite numbers and a text are JSON")),
        ..Default::default()
    }
}

/// Puts the lights where the extension has them.
pub(super) fn declare_lights(document: &mut json::Root, lights: Vec<punctual::Light>) {
    document.extensions_used.push(LIGHTS.to_owned());
    let khr_lights_punctual = Some(root::KhrLightsPunctual { lights });
    document.extensions = Some(root::Root { khr_lights_punctual, ..Default::default() });
}
