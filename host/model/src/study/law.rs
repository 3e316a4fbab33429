//! How a field varies from plate to plate.

use super::draw::Draw;
use serde::{Deserialize, Serialize};
use slipline_plate::quantity::Range;

/// The law of a field: of the factor by which it is multiplied, which keeps its sign, or of what is added to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// 1 + s z with z standard normal; s is 0 to 1.
    Normal(f64),
    /// e^(s z) with z standard normal; s is 0 to 3.
    LogNormal(f64),
    /// 1 + s u with u uniform from -1 to 1; s is 0 to 1.
    Uniform(f64),
    /// s z is added, with z standard normal; s is 0 to 1 in the unit of the field, which may be 0.
    Offset(f64),
}

impl Law {
    /// Its name in a specification.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normal(_) => "normal",
            Self::LogNormal(_) => "log_normal",
            Self::Uniform(_) => "uniform",
            Self::Offset(_) => "offset",
        }
    }

    /// Its width s, and the widths that are allowed.
    pub(super) const fn width(self) -> (f64, Range) {
        match self {
            Self::Normal(width) | Self::Uniform(width) | Self::Offset(width) => {
                (width, Range::new(0.0, 1.0, ""))
            }
            Self::LogNormal(width) => (width, Range::new(0.0, 3.0, "")),
        }
    }

    /// Whether the field is multiplied: one that is 0 on the nominal plate stays 0.
    pub(super) const fn is_factor(self) -> bool {
        !matches!(self, Self::Offset(_))
    }

    /// The field whose number on the nominal plate is `nominal`.
    pub(super) fn drawn(self, nominal: f64, draw: Draw) -> f64 {
        match self {
            Self::Normal(width) => nominal * (1.0 + width * draw.normal()),
            Self::LogNormal(width) => nominal * (width * draw.normal()).exp(),
            Self::Uniform(width) => nominal * (1.0 + width * draw.uniform()),
            Self::Offset(width) => nominal + width * draw.normal(),
        }
    }
}
