//! The turning point of a frequency, the width of its edge, and the frequency for a given boundary.
//!
//! Near the turning point x0 the amplitude is an Airy function, Ai(kappa (x - x0)) with kappa^3 = -d(k^2)/dx at x0
//! (2 d K^2 for the exponential taper). Its peak lies 1.018793/kappa before x0 and it falls to a tenth of the peak
//! 1.7098/kappa beyond it.

use crate::definition::plate::Plate;
use crate::definition::turning_width::TurningWidth;
use crate::special::airy;

impl Plate {
    /// The same plate with another turning width. The span stays where it is, so its frequencies change.
    #[must_use]
    pub fn with_turning_width(&self, turning_width: TurningWidth) -> Self {
        let mut plate = self.clone();
        plate.set_turning_width(turning_width);
        plate
    }

    /// Half-width that decides which wave turns at `x` metres from the driven end, metres; at most
    /// [`Plate::half_width_m`].
    pub fn turning_half_width_m(&self, x: f64) -> f64 {
        self.turning.at(x).value.exp()
    }

    /// The turning point of `frequency_hz`, metres; `None` if the wave cannot enter.
    ///
    /// The taper is continued beyond the plate's end, so a value above [`Plate::length_m`] means that the wave
    /// reaches the end of the plate.
    pub fn turning_point_m(&self, frequency_hz: f64) -> Option<f64> {
        self.ghost_boundary_m(frequency_hz, 1)
    }

    /// The turning point of width mode `mode` (1 is the wanted one; 0 counts as 1), metres; `None` if that mode
    /// cannot enter.
    ///
    /// A drive on the centre line also excites the modes 3, 5, ..; an off-centre drive also the modes 2, 3, ..
    pub fn ghost_boundary_m(&self, frequency_hz: f64, mode: u32) -> Option<f64> {
        let place = self.width_mode(mode).turning_point_m(frequency_hz);
        (place.is_finite() && place > 0.0).then_some(place)
    }

    /// How well a calibration knows where a wave turns whose boundary is at `x` metres: half of the 95 % interval, metres.
    /// `None` for an uncalibrated plate.
    ///
    /// A calibration states the error of the wave speed that would move the boundary by as much: with K s = q, dV/V = s'/s dx.
    pub fn boundary_tolerance_m(&self, x: f64) -> Option<f64> {
        self.spec().calibration.as_ref()?;
        Some(self.spec().wave_speed_tolerance / self.turning_at(x).1.abs())
    }

    /// kappa of the Airy form at the turning point, 1/m; `None` if the wave cannot enter.
    pub fn kappa_per_m(&self, frequency_hz: f64) -> Option<f64> {
        let mode = self.width_mode(1);
        let share = || mode.air(frequency_hz).map_or(1.0, |air| air.fall_share());
        self.turning_point_m(frequency_hz).map(|x0| (mode.fall(x0) * share()).cbrt())
    }

    /// Distance from the peak to the position with a tenth of its amplitude, metres: 2.729/kappa. `None` if the wave
    /// cannot enter.
    pub fn edge_width_m(&self, frequency_hz: f64) -> Option<f64> {
        self.kappa_per_m(frequency_hz).map(|kappa| airy::EDGE_WIDTH / kappa)
    }

    /// Position of the peak in the Airy form, metres: x0 - 1.018793/kappa. Negative if the peak would lie before the
    /// driven end; `None` if the wave cannot enter.
    pub fn airy_peak_m(&self, frequency_hz: f64) -> Option<f64> {
        let x0 = self.turning_point_m(frequency_hz)?;
        Some(x0 - airy::PEAK_OFFSET / self.kappa_per_m(frequency_hz)?)
    }
}
