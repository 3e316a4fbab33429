//! A width mode of a plate: its wavenumber along the plate, and where it turns.

use super::air_along::{AirAlong, InAir};
use super::plate::Plate;
use super::strip_table::{self, StripTable};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

/// One width mode of a plate: k^2(x) = a (K^2 (1 + j eta) - (q/s)^2) with the turning half-width s; what edges that bend
/// add to it is [`Plate::edge_bend`]. The first mode between clamped edges follows the strip's exact law instead, of which
/// that is the tangent at the cut-off.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WidthMode<'a> {
    pub(crate) plate: &'a Plate,
    /// q, see [`crate::Model::width_number`].
    pub(crate) number: f64,
    /// a, see [`crate::Model::width_slope`].
    pub(crate) slope: f64,
    /// The exact law of the first mode between clamped edges, with the plate's loss; `None` for all other modes.
    pub(crate) strip: Option<&'a Arc<StripTable>>,
}

impl Plate {
    /// Width mode `mode` of this plate (1 is the first).
    pub(crate) fn width_mode(&self, mode: u32) -> WidthMode<'_> {
        WidthMode {
            plate: self,
            number: self.spec().model.width_number(mode),
            slope: self.spec().model.width_slope(mode),
            strip: self.strip.as_ref().filter(|_| mode <= 1),
        }
    }
}

impl WidthMode<'_> {
    /// K^2 at `x` over that at the driven end: h0/h.
    pub(crate) fn local(&self, x: f64) -> f64 {
        self.plate.grading.as_ref().map_or(1.0, |grading| (-grading.log(x).value).exp())
    }

    /// a K^2 at the driven end without loss, 1/m^2.
    pub(crate) fn axial_squared(&self, frequency_hz: f64) -> f64 {
        self.slope * self.plate.wavenumber_squared(frequency_hz)
    }

    /// a (q/s)^2, 1/m^2: the part of k^2 that the width takes away.
    pub(crate) fn width_term(&self, x: f64) -> f64 {
        self.slope * (self.number * self.plate.turning.reciprocal_at(x)).powi(2)
    }

    /// The mode at a frequency, for evaluation at many places.
    pub(crate) fn at_frequency(&self, frequency_hz: f64) -> ModeWave<'_> {
        let law = if self.strip.is_some() {
            Law::Strip { log_wavenumber: self.plate.wavenumber_squared(frequency_hz).ln() }
        } else if let Some(air) = self.air(frequency_hz) {
            Law::Air(air)
        } else {
            Law::Uniform { axial: self.axial_squared(frequency_hz) }
        };
        ModeWave { mode: *self, law }
    }

    /// Local k^2 without loss, 1/m^2; negative beyond the turning point.
    pub(crate) fn wavenumber_squared(&self, x: f64, frequency_hz: f64) -> f64 {
        self.at_frequency(frequency_hz).wavenumber_squared(x)
    }

    /// The air along a membrane, at a frequency; `None` where K is the same all along.
    pub(crate) fn air(&self, frequency_hz: f64) -> Option<AirAlong> {
        let is_first = self.number == self.plate.spec().model.width_number(1);
        is_first.then(|| self.plate.free_wave().along(TAU * frequency_hz)).flatten()
    }

    /// As [`WidthMode::air`], or the same K all along.
    pub(crate) fn air_or_uniform(&self, frequency_hz: f64) -> AirAlong {
        self.air(frequency_hz)
            .unwrap_or_else(|| AirAlong::uniform(self.plate.wavenumber_squared(frequency_hz)))
    }

    /// Local k^2 with loss, 1/m^2.
    pub(crate) fn lossy_wavenumber_squared(&self, x: f64, frequency_hz: f64) -> Complex64 {
        if let Some(strip) = self.strip {
            let (log_t, log_square) = self.strip_place(x, frequency_hz);
            return strip.wavenumber_squared(log_t) * (-log_square).exp();
        }
        let across = self.width_term(x);
        if let Some(air) = self.air(frequency_hz) {
            let InAir { wavenumber_squared, loss_share, .. } = air.at(across);
            let loss = self.plate.stiffness_loss_at(frequency_hz) * loss_share;
            return wavenumber_squared * Complex64::new(1.0, loss) - across;
        }
        self.axial_squared(frequency_hz) * self.local(x) * self.plate.lossy(frequency_hz) - across
    }

    /// Integral over the width at `x` of the square of the mode that is 1 on the centre line, in half-widths: Omega ds/dt
    /// of the clamped strip, 1 for other edges.
    pub(crate) fn mode_square(&self, x: f64, frequency_hz: f64) -> f64 {
        if self.strip.is_none() {
            return 1.0;
        }
        let (log_t, _) = self.strip_place(x, frequency_hz);
        let law = strip_table::lossless();
        law.rise(log_t).re * (-log_t).exp() / law.spread(log_t).re.powi(2)
    }

    /// ln (s K)^2 and ln s^2, in metres, at `x`.
    fn strip_place(&self, x: f64, frequency_hz: f64) -> (f64, f64) {
        let log_square = self.log_square(x);
        (log_square + self.plate.wavenumber_squared(frequency_hz).ln(), log_square)
    }

    /// ln s^2 at `x`, s in metres.
    pub(crate) fn log_square(&self, x: f64) -> f64 {
        -2.0 * self.plate.turning.reciprocal_at(x).ln()
    }

    /// Frequency whose wave turns at `x`, Hz.
    pub(crate) fn cut_off_hz(&self, x: f64) -> f64 {
        let turning = (self.number * self.plate.turning.reciprocal_at(x)).powi(2) / self.local(x);
        self.plate.free_wave().angular_frequency(turning) / TAU
    }

    /// The turning point of the continued taper, metres; negative when the wave cannot enter.
    pub(crate) fn turning_point_m(&self, frequency_hz: f64) -> f64 {
        self.place_of(self.plate.wavenumber_squared(frequency_hz).sqrt())
    }

    /// Where a wave turns that has the wavenumber K, 1/m, at the driven end, metres.
    pub(crate) fn place_of(&self, wavenumber: f64) -> f64 {
        self.plate.turning_law().place_of((self.number / wavenumber).ln())
    }

    /// -d(k^2)/dx at `x` where K does not change along the plate, 1/m^3.
    pub(crate) fn fall(&self, x: f64) -> f64 {
        -2.0 * self.width_term(x) * self.plate.turning_at(x).1
    }

    /// Phase of the wave from the driven end to `x`, or to the turning point if that is nearer, radians.
    pub(crate) fn phase_to(&self, x: f64, frequency_hz: f64) -> f64 {
        let end = x.min(self.turning_point_m(frequency_hz));
        if end <= 0.0 {
            return 0.0;
        }
        // k falls to zero as a square root at the turning point, which makes the midpoint rule inaccurate. The
        // substitution x = end (1 - u^2) makes the integrand smooth.
        let (wave, steps) = (self.at_frequency(frequency_hz), 400);
        let total: f64 = (0..steps)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / f64::from(steps);
                let place = end * (1.0 - u * u);
                2.0 * u * wave.wavenumber_squared(place).max(0.0).sqrt()
            })
            .sum();
        total * end / f64::from(steps)
    }
}

/// A width mode at one frequency: everything about it that does not depend on the place is computed once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ModeWave<'a> {
    mode: WidthMode<'a>,
    law: Law,
}

/// K along the plate.
#[derive(Debug, Clone, Copy)]
enum Law {
    /// The law of the clamped strip, with ln K^2.
    Strip { log_wavenumber: f64 },
    /// The law of a membrane in air.
    Air(AirAlong),
    /// a K^2 at the driven end, over which the thickness alone decides.
    Uniform { axial: f64 },
}

impl ModeWave<'_> {
    /// Local k^2 without loss, 1/m^2; negative beyond the turning point.
    pub(crate) fn wavenumber_squared(&self, x: f64) -> f64 {
        match self.law {
            Law::Strip { log_wavenumber } => {
                let log_square = self.mode.log_square(x);
                let s = strip_table::lossless().wavenumber_squared(log_square + log_wavenumber);
                s.re * (-log_square).exp()
            }
            Law::Air(air) => {
                let across = self.mode.width_term(x);
                air.at(across).wavenumber_squared - across
            }
            Law::Uniform { axial } => axial * self.mode.local(x) - self.mode.width_term(x),
        }
    }

    /// d(k^2)/d ln(K^2) at `x` without loss, 1/m^2: a K^2 there except between clamped edges.
    pub(crate) fn wavenumber_rise(&self, x: f64) -> f64 {
        match self.law {
            Law::Strip { log_wavenumber } => {
                let log_square = self.mode.log_square(x);
                strip_table::lossless().rise(log_square + log_wavenumber).re * (-log_square).exp()
            }
            Law::Air(air) => self.mode.slope * air.turning * self.mode.local(x),
            Law::Uniform { axial } => axial * self.mode.local(x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::model::Model;
    use crate::definition::presets::preset;

    fn clamped() -> Plate {
        let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
        spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
        (spec.span_start_m, spec.span_end_m) = (0.1, 0.24);
        Plate::new(spec).expect("a valid plate")
    }

    #[test]
    fn between_clamped_edges_the_wavenumber_matches_the_strips_exact_law() {
        let plate = clamped();
        let width_mode = plate.width_mode(1);
        let frequency_hz = plate.frequency_for_boundary_hz(0.24);
        let turning_m = plate.turning_point_m(frequency_hz).expect("enters");
        let place = |ratio: f64| turning_m - ratio.ln() / 4.62;
        for (ratio, share) in [(1.05, 0.9559), (1.41, 0.8389), (2.0, 0.7880)] {
            let x = place(ratio);
            let near = width_mode.axial_squared(frequency_hz) - width_mode.width_term(x);
            let found = (width_mode.wavenumber_squared(x, frequency_hz) / near).sqrt();
            assert!((found - share).abs() < 2e-4, "{ratio}: {found}");
            // K^2 is proportional to the frequency in a thin plate.
            let step = 1e-5;
            let at = |factor: f64| width_mode.wavenumber_squared(x, frequency_hz * factor);
            let rise = (at(1.0 + step) - at(1.0 - step)) / (2.0 * step);
            assert!(
                (width_mode.at_frequency(frequency_hz).wavenumber_rise(x) / rise - 1.0).abs() < 1e-6,
                "{ratio}"
            );
            let lossy = width_mode.lossy_wavenumber_squared(x, frequency_hz);
            assert!((lossy.im / (rise * plate.wave_loss()) - 1.0).abs() < 1e-5, "{ratio}: {lossy}");
        }
        for (ratio, square) in [(1.0, 0.792_96), (2.0, 0.866_7)] {
            let found = width_mode.mode_square(place(ratio), frequency_hz);
            assert!((found - square).abs() < 1e-3, "{ratio}: {found}");
        }
        // The turning point and kappa are those of the cut-off, where both laws agree.
        let slope = (width_mode.wavenumber_squared(turning_m - 1e-5, frequency_hz)
            - width_mode.wavenumber_squared(turning_m + 1e-5, frequency_hz))
            / 2e-5;
        assert!((width_mode.fall(turning_m) / slope - 1.0).abs() < 1e-3, "{slope}");
    }

    #[test]
    fn plates_of_one_loss_share_the_law() {
        let plate = clamped();
        let faster = plate.with_wave_speed(1.01).expect("in range");
        let (own, shared) = (plate.strip.expect("clamped"), faster.strip.expect("clamped"));
        assert!(Arc::ptr_eq(&own, &shared));
    }
}
