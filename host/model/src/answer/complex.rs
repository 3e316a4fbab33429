//! A complex number of an answer.

use serde::Serialize;
use slipline_plate::Complex64;

/// A complex number: `{"re": ..., "im": ...}`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Complex {
    /// Real part.
    // JSON, unit of its list: Real part
    pub re: f64,
    /// Imaginary part.
    // JSON, unit of its list: Imaginary part
    pub im: f64,
}

impl Complex {
    pub(super) fn of_each(values: &[Complex64]) -> Vec<Self> {
        values.iter().map(|value| Self { re: value.re, im: value.im }).collect()
    }
}
