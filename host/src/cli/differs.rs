//! Differences between the plate in two dimensions and the one-mode equation, for people and for programs.

use serde_json::{Value, json};
use slipline_plate::number_format::with_decimals;
use slipline_plate::plane::Comparison;

/// The JSON fields of a comparison whose first field is the one-mode equation's.
pub(super) fn value(comparison: &Comparison) -> Value {
    json!({
        "peak_shift_m": comparison.peak_shift_m,
        "level_db": comparison.level_db,
        "nodes": comparison.nodes[1],
        "one_mode_nodes": comparison.nodes[0],
    })
}

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
