//! ln of a half-width and its derivatives, and the arc across a half-width.

/// ln W and its first two derivatives at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LogWidth {
    /// ln W, W in metres.
    pub(crate) value: f64,
    /// W'/W, 1/m.
    pub(crate) slope: f64,
    /// (ln W)'', 1/m^2.
    pub(crate) curvature: f64,
}

impl LogWidth {
    /// W''/W, 1/m^2.
    pub(crate) fn bend(self) -> f64 {
        self.curvature + self.slope * self.slope
    }

    /// (sqrt W)''/sqrt W, 1/m^2. With g = sqrt(W) f the amplitude equation is g'' + (k^2 - this) g = 0.
    pub(crate) fn root_curvature(self) -> f64 {
        0.5 * self.curvature + 0.25 * self.slope * self.slope
    }
}

/// ln of the turning half-width (metres) and its derivative, 1/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LogTurningWidth {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

/// atan(s)/s: half the arc over the half-width where the edges have the slope `s`.
pub(crate) fn arc_to_width(s: f64) -> f64 {
    if s.abs() < 1e-4 { 1.0 - s * s / 3.0 } else { s.atan() / s }
}
