//! Levels of detail.

use sapwood_geom::content;
use sapwood_geom::glam::Vec3;
use sapwood_graph::Named;

use crate::{Children, Component, Context, DistanceBand, Rule, RuleError};

/// Shows one of its children by the distance from the view's [`Viewpoint`](crate::Viewpoint):
/// the first one nearest by. Levels that are not shown are not compiled.
///
/// Child `i` is shown up to `distances[i]`, the one behind the last distance beyond it; where
/// there is no such child, nothing is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LevelOfDetail {
    /// The distances in metres at which one level gives way to the next, rising.
    pub distances: Vec<f32>,
    /// How far beyond its ends a level stays, as a part of the distance there, below 1.
    pub hysteresis: f32,
    /// The point that is measured to, in the component's frame.
    pub center: Vec3,
}

content!(LevelOfDetail { distances, hysteresis, center });

impl LevelOfDetail {
    /// Levels that give way to the next at these distances, measured to the origin, without
    /// hysteresis.
    pub fn new(distances: impl Into<Vec<f32>>) -> Self {
        Self { distances: distances.into(), ..Self::default() }
    }

    fn fault(&self) -> Option<String> {
        let Self { distances, hysteresis, center } = self;
        if !distances.iter().all(|distance| *distance >= 0.0) || !distances.is_sorted() {
            return Some(format!("distances {distances:?} must rise from 0"));
        }
        if !(0.0..1.0).contains(hysteresis) {
            return Some(format!("hysteresis {hysteresis} must be at least 0 and below 1"));
        }
        (!center.is_finite()).then(|| format!("center {center} must be finite"))
    }
}

impl Named for LevelOfDetail {
    const NAME: &'static str = "level_of_detail";
}

impl Component for LevelOfDetail {
    const CHILDREN: Children = Children::Many;
}

pub(super) struct LevelOfDetailRule;

impl Rule for LevelOfDetailRule {
    type Component = LevelOfDetail;
    type Data = ();
    const NAME: &'static str = "level_of_detail";

    fn init(&self, levels: &LevelOfDetail, cx: &mut Context<'_>) -> Result<(), RuleError> {
        if let Some(fault) = levels.fault() {
            return Err(RuleError::Failed(fault));
        }
        let LevelOfDetail { distances, hysteresis, center } = levels.clone();
        let band = cx.project(DistanceBand { distances, hysteresis, center });
        cx.child(band);
        Ok(())
    }
}
