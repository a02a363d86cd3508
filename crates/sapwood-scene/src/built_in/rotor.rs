//! Rotors: turning what is below them as time goes by.

use sapwood_geom::content;
use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_graph::Named;

use crate::{Children, Component, Context, Rule, RuleError, Time, VisitContext};

/// An attribute that turns its child about an axis through its origin, steadily. Time runs
/// nobody's `init`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotor {
    /// The axis; need not have unit length.
    pub axis: Vec3,
    /// Radians per second, counter-clockwise seen from where the axis points to.
    pub velocity: f32,
    /// The angle in radians at time 0.
    pub phase: f32,
}

content!(Rotor { axis, velocity, phase });

impl Rotor {
    /// A rotor that starts at angle 0.
    pub fn new(axis: Vec3, velocity: f32) -> Self {
        Self { axis, velocity, phase: 0.0 }
    }
}

impl Named for Rotor {
    const NAME: &'static str = "rotor";
}

impl Component for Rotor {
    const CHILDREN: Children = Children::One;
}

pub(super) struct RotorRule;

impl Rule for RotorRule {
    type Component = Rotor;
    type Data = Rotor;
    const NAME: &'static str = "rotor";

    fn init(&self, rotor: &Rotor, cx: &mut Context<'_>) -> Result<Rotor, RuleError> {
        let Rotor { axis, velocity, phase } = *rotor;
        if !(velocity.is_finite() && phase.is_finite()) {
            let message = format!("velocity {velocity} and phase {phase} must be finite");
            return Err(RuleError::Failed(message));
        }
        let Some(axis) = axis.try_normalize() else {
            return Err(RuleError::Failed(format!("axis {axis} has no direction")));
        };
        cx.live(Context::children);
        Ok(Rotor { axis, ..*rotor })
    }

    fn visit(&self, rotor: &Rotor, cx: &VisitContext<'_>, live: &mut [Affine3]) {
        // In 64 bits, and within one turn: a clock may have run for months.
        let angle = f64::from(rotor.phase) + f64::from(rotor.velocity) * *cx.read::<Time>();
        let angle = angle.rem_euclid(std::f64::consts::TAU);
        let angle = if angle.is_finite() { angle as f32 } else { 0.0 };
        live[0] = Affine3::from_axis_angle(rotor.axis, angle);
    }
}
