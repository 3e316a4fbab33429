//! Differences between the plate in two dimensions and the one-mode equation, for people.

use slipline_plate::plane::Comparison;
use slipline_plate::quantity::number_format::with_decimals;

/// Shift and level of the peak in two dimensions.
pub(super) fn peak(comparison: &Comparison) -> String {
    match comparison.peak_shift_m.zip(comparison.level_db) {
        None => "one of the two has none".to_owned(),
        Some((shift_m, level_db)) => format!(
            "{} mm and {} dB from that of the one-mode equation",
            with_sign(shift_m * 1e3, 2),
            with_sign(level_db, 2)
        ),
    }
}

/// A difference with its sign.
fn with_sign(value: f64, decimals: usize) -> String {
    let sign = if value < 0.0 { "-" } else { "+" };
    format!("{sign}{}", with_decimals(value.abs(), decimals))
}
