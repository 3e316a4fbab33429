//! What a sensor at a place would miss.

use super::near_limit::NearLimit;
use crate::quantity::show_place;
use std::fmt;

/// Why a sensor at a place does not serve a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaceWarning {
    /// More than one wave travels there.
    TooNear {
        /// The place, metres.
        place_m: f64,
        /// The other waves.
        limit: NearLimit,
        /// The nearest place where one wave is nearly alone, metres.
        nearest_m: f64,
    },
    /// At many frequencies the plate does not move there.
    Silent {
        /// The place, metres.
        place_m: f64,
        /// Share of the frequencies at which the sensor shows nothing but noise (0 to 1).
        share: f64,
    },
}

impl fmt::Display for PlaceWarning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooNear { place_m, limit, nearest_m } => {
                let what = match limit {
                    NearLimit::NearField => "the near field of the driven end".to_owned(),
                    NearLimit::WidthMode(mode) => format!("width mode {mode}"),
                };
                let (place, nearest) = (show_place(place_m), show_place(nearest_m));
                write!(
                    formatter,
                    "a sensor at {place} sees {what} beside the wave: put it at {nearest} or beyond"
                )
            }
            Self::Silent { place_m, share } => {
                let (place, percent) = (show_place(place_m), (100.0 * share).round());
                write!(
                    formatter,
                    "a sensor at {place} cannot see: at {percent} % of the frequencies the plate does not move there"
                )
            }
        }
    }
}
