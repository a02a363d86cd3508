//! Lights, cameras and labels: components that are what they draw.

use sapwood_graph::{Camera, Label, Light};

use crate::{Component, Context, Rule, RuleError};

impl Component for Light {}
impl Component for Camera {}
impl Component for Label {}

pub(super) struct LightRule;

impl Rule for LightRule {
    type Component = Light;
    type Data = ();
    const NAME: &'static str = "light";

    fn init(&self, light: &Light, cx: &mut Context<'_>) -> Result<(), RuleError> {
        fail_on(light.fault())?;
        cx.light(light.clone());
        Ok(())
    }
}

pub(super) struct CameraRule;

impl Rule for CameraRule {
    type Component = Camera;
    type Data = ();
    const NAME: &'static str = "camera";

    fn init(&self, camera: &Camera, cx: &mut Context<'_>) -> Result<(), RuleError> {
        fail_on(camera.fault())?;
        cx.camera(camera.clone());
        Ok(())
    }
}

pub(super) struct LabelRule;

impl Rule for LabelRule {
    type Component = Label;
    type Data = ();
    const NAME: &'static str = "label";

    fn init(&self, label: &Label, cx: &mut Context<'_>) -> Result<(), RuleError> {
        fail_on(label.fault())?;
        cx.label(label.clone());
        Ok(())
    }
}

fn fail_on(fault: Option<String>) -> Result<(), RuleError> {
    fault.map_or(Ok(()), |fault| Err(RuleError::Failed(fault)))
}
