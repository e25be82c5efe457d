//! The keys of `[task.limits]` and `[task.weights]` that are about the way.

use toml::Spanned;

use super::path_limits::PathLimits;
use super::tables::{LimitsTable, WeightsTable};
use crate::input::{Document, InputError, NonNegative, Positive};
use crate::robot::Robot;

/// What tables ask for on the way.
pub(super) struct Way<'a> {
    pub(super) limits: &'a LimitsTable,
    pub(super) weights: &'a WeightsTable,
    pub(super) robot: &'a Robot,
    pub(super) document: &'a Document,
}

impl Way<'_> {
    pub(super) fn build(&self) -> Result<PathLimits, InputError> {
        let Self { limits, weights, robot, document } = *self;
        let radians = |value: &Spanned<Positive>| value.get_ref().0.to_radians();
        let torque = limits.torque_n_m.as_ref().map(|values| {
            let listed = values.get_ref().listed(robot, values.span(), document)?;
            let torque = |value: Option<Positive>| value.map_or(f64::INFINITY, |torque| torque.0);
            Ok(listed.into_iter().map(torque).collect())
        });
        let weight = |value: &Option<Spanned<NonNegative>>| {
            value.as_ref().map_or(0.0, |weight| weight.get_ref().0)
        };
        let mut base_cones = Vec::new();
        if let Some(cones) = &limits.base_cone {
            for cone in cones.get_ref().list() {
                let built = cone.build();
                base_cones.push(built.map_err(|message| {
                    document.error_at(cones.span(), format!("`base_cone`: {message}"), None)
                })?);
            }
        }
        Ok(PathLimits {
            base_turn: limits.base_turn_deg.as_ref().map(radians),
            turn_from: limits.base_turn_from.unwrap_or_default(),
            base_cones,
            base_rate: limits.base_rate_deg_s.as_ref().map(radians),
            tool_speed: limits.tool_speed_m_s.as_ref().map(|speed| speed.get_ref().0),
            torque: torque.transpose()?,
            clearance: None,
            turn_weights: [weight(&weights.largest_turn), weight(&weights.mean_turn)],
        })
    }
}
