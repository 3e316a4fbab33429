//! The text of a setup file, field by field.

use crate::setup::BoundaryMode;
use serde::{Deserialize, Serialize};
use slipline_plate::check::sensation::FrictionCurve;
use slipline_plate::feeling::Feeling;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SetupText {
    pub(super) slipline_setup: i64,
    #[serde(default)]
    pub(super) master_db: f64,
    #[serde(default = "default_glide")]
    pub(super) glide_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) chord_gain_db: Option<f64>,
    #[serde(default)]
    pub(super) boundary: BoundaryText,
    #[serde(default)]
    pub(super) feeling: FeelingText,
    pub(super) tones: Vec<ToneText>,
    pub(super) plate: toml::Table,
}

fn default_glide() -> f64 {
    0.02
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoundaryText {
    pub(super) holds: String,
}

impl Default for BoundaryText {
    fn default() -> Self {
        Self { holds: BoundaryMode::default().word().to_owned() }
    }
}

/// The fields of a feeling, with the names of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeelingText {
    threshold: f64,
    /// JSON: Amplitude that lowers the friction noticeably
    friction_scale_m: f64,
    /// JSON, 1: Friction that is left at large amplitudes, over the friction at rest
    friction_residual: f64,
    /// JSON, 1: Exponent of the law of friction
    friction_exponent: f64,
    least_friction_change: f64,
    contact_m: f64,
}

impl Default for FeelingText {
    fn default() -> Self {
        Self::from(Feeling::default())
    }
}

impl From<Feeling> for FeelingText {
    fn from(feeling: Feeling) -> Self {
        let Feeling { threshold, friction, least_friction_change, contact_m } = feeling;
        Self {
            threshold,
            friction_scale_m: friction.scale_m,
            friction_residual: friction.residual,
            friction_exponent: friction.exponent,
            least_friction_change,
            contact_m,
        }
    }
}

impl From<FeelingText> for Feeling {
    fn from(text: FeelingText) -> Self {
        Self {
            threshold: text.threshold,
            friction: FrictionCurve {
                scale_m: text.friction_scale_m,
                residual: text.friction_residual,
                exponent: text.friction_exponent,
            },
            least_friction_change: text.least_friction_change,
            contact_m: text.contact_m,
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ToneText {
    pub(super) slot: i64,
    pub(super) position_m: f64,
    pub(super) level: f64,
    #[serde(default)]
    pub(super) phase_turns: f64,
}
