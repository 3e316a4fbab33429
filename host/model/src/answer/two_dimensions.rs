//! Differences between the plate in two dimensions and the one-mode equation, as fields.

use serde::Serialize;
use slipline_plate::plane::Comparison;

/// A comparison whose first field is the one-mode equation's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TwoDimensions {
    /// Peak in two dimensions minus that of one mode, in metres.
    // JSON: Place of the peak less that by the one-mode equation; null where one has none
    pub peak_shift_m: Option<f64>,
    /// Level of the peak in two dimensions over that of one mode, in dB.
    // JSON: Level of the peak in two dimensions over that of the one-mode equation
    pub level_db: Option<f64>,
    /// Nodes before the peak in two dimensions.
    // JSON, count: Nodes before the peak
    pub nodes: usize,
    /// Nodes before the peak of one mode.
    // JSON, count: The same by the one-mode equation
    pub one_mode_nodes: usize,
}

impl TwoDimensions {
    /// The fields of a comparison.
    #[must_use]
    pub const fn of(comparison: &Comparison) -> Self {
        let Comparison { peak_shift_m, level_db, nodes: [one_mode_nodes, nodes] } = *comparison;
        Self { peak_shift_m, level_db, nodes, one_mode_nodes }
    }
}
