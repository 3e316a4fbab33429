//! How a field varies from plate to plate.

use super::draw::Draw;
use serde::{Deserialize, Serialize};
use slipline_plate::quantity::Range;

/// The law of the factor by which a field is multiplied. A field keeps its sign and a factor of 1 is the nominal plate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// 1 + s z with z standard normal; s is 0 to 1.
    Normal(f64),
    /// e^(s z) with z standard normal; s is 0 to 3.
    LogNormal(f64),
    /// 1 + s u with u uniform from -1 to 1; s is 0 to 1.
    Uniform(f64),
}

impl Law {
    /// Its name in a specification.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normal(_) => "normal",
            Self::LogNormal(_) => "log_normal",
            Self::Uniform(_) => "uniform",
        }
    }

    /// Its width s, and the widths that are allowed.
    pub(super) const fn width(self) -> (f64, Range) {
        match self {
            Self::Normal(width) | Self::Uniform(width) => (width, Range::new(0.0, 1.0, "")),
            Self::LogNormal(width) => (width, Range::new(0.0, 3.0, "")),
        }
    }

    pub(super) fn factor(self, draw: Draw) -> f64 {
        match self {
            Self::Normal(width) => 1.0 + width * draw.normal(),
            Self::LogNormal(width) => (width * draw.normal()).exp(),
            Self::Uniform(width) => 1.0 + width * draw.uniform(),
        }
    }
}
