//! The gains of the loop, from the plate's time constant and the windows' period.
//!
//! **Plant.** The logarithm of a tone's amplitude follows that of its drive with the time constant `tau` of the plate,
//! `2 / (eta omega)`, and with a delay of 1.5 periods `T` at most:
//! ```text
//! mean over the window                                    T/2
//! planning, and the blocks before the DAC                 T/4 at most, since T is at least 10 ms
//! the glide, half a period long                           T/4
//! each correction stands for a period                     T/2
//! P(s) = exp(-3/2 s T) / (1 + s tau)
//! ```
//! **Law.** The controller's zero cancels the plate's pole:
//! ```text
//! C(s) = w (1 + s tau) / s        L(s) = C P = w exp(-3/2 s T) / s        w = 1 / max(5/2 T, tau)
//! proportional = w tau = min(tau / (5/2 T), 1)        integral, per period = w T = min(2/5, T / tau)
//! ```
//! **Margins.** The crossover is at `w`, at most `0.4 / T`:
//! ```text
//! phase margin = pi/2 - 3/2 w T >= pi/2 - 0.6 = 55.6 degrees        gain margin = (pi/2) / (3/2 w T) >= 2.61 (8.3 dB)
//! ```
//! With a loop twice as strong 21 degrees are left. Where `tau` is long against `T` the margins are larger.

use super::octaves::Octaves;
use super::setting::LoopSetting;

/// Fractional bits that the controller has below those of [`Octaves`].
pub(super) const FINE: u32 = 24;

/// [`Octaves`] with 40 fractional bits, so that the slowest integrator still moves.
pub(super) const fn fine(octaves: Octaves) -> i64 {
    (octaves.0 as i64) << FINE
}

/// The gains and limits of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Law {
    /// Correction per error, [`FINE`] fractional bits, at most 1.
    pub(super) proportional: i64,
    /// Correction per error and period, [`FINE`] fractional bits, at most 2/5.
    pub(super) integral: i64,
    /// The highest correction.
    pub(super) max_rise: i64,
    /// The largest change of a correction per period.
    pub(super) slew: i64,
    /// Windows that a tone may be too weak before it is lost: the time that the plate needs to answer.
    pub(super) patience: u32,
    /// Windows after which a tone has been at its largest rise for longer than it may.
    pub(super) at_rise: u32,
}

impl Law {
    /// Answers nothing.
    pub(super) const NONE: Self =
        Self { proportional: 0, integral: 0, max_rise: 0, slew: 0, patience: 0, at_rise: 0 };

    /// The gains by a setting whose period is not 0.
    pub(super) fn new(setting: &LoopSetting) -> Self {
        let LoopSetting { max_rise, slew, at_rise, .. } = *setting;
        let (tau, period) = (i64::from(setting.tau), i64::from(setting.period).max(1));
        // In half periods: 5 periods or 2 tau. At most 2^34.4, and tau << 25 at most 2^57.
        let slowest = (5 * period).max(2 * tau);
        let share = |time: i64| (time << (FINE + 1)).checked_div(slowest).unwrap_or(0);
        let windows = u32::try_from(tau.checked_div(period).unwrap_or(0)).unwrap_or(u32::MAX);
        Self {
            proportional: share(tau),
            integral: share(period),
            max_rise: fine(max_rise),
            slew: fine(slew),
            patience: windows.saturating_add(3),
            // From the first of these windows to the last.
            at_rise: at_rise.div_ceil(setting.period.max(1)).saturating_add(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};

    fn law(tau: u32, period: u32) -> Law {
        Law::new(&LoopSetting { period, tau, max_rise: Octaves::ONE, at_rise: 4_000_000, slew: Octaves::ONE })
    }

    /// `|L|` and its phase at an angular frequency, in one over the period: from the integers of the law and the plant.
    fn open_loop(law: &Law, ratio: f64, w: f64) -> (f64, f64) {
        let one = f64::from(1 << FINE);
        let (proportional, integral) = (law.proportional as f64 / one, law.integral as f64 / one);
        let amount = proportional.hypot(integral / w) / 1.0_f64.hypot(w * ratio);
        let phase = -(integral / w).atan2(proportional) - (w * ratio).atan() - 1.5 * w;
        (amount, phase)
    }

    #[test]
    fn the_phase_margin_is_55_degrees_and_the_gain_margin_8_decibels_for_every_time_constant() {
        const PERIOD: u32 = 40_000;
        for thousandths in (0..100).chain((100..40_000).step_by(97)) {
            let law = law(PERIOD / 1000 * thousandths, PERIOD);
            let ratio = f64::from(thousandths) / 1000.0;
            // Both fall with the frequency: the first place where one is reached, in steps of 0.1 %.
            let mut w = 1e-3;
            let (mut margin, mut gain_margin) = (None, None);
            while gain_margin.is_none() {
                let (amount, phase) = open_loop(&law, ratio, w);
                if amount <= 1.0 && margin.is_none() {
                    margin = Some((phase + PI).to_degrees());
                }
                if phase <= -PI {
                    gain_margin = Some(20.0 * (1.0 / amount).log10());
                }
                w *= 1.001;
            }
            let (margin, gain_margin) = (margin.unwrap(), gain_margin.unwrap());
            assert!(margin >= 55.5 && gain_margin >= 8.3, "{ratio}: {margin} degrees, {gain_margin} dB");
        }
        assert!((FRAC_PI_2 - 0.6).to_degrees() > 55.6);
    }

    #[test]
    fn the_longest_and_shortest_times_make_gains() {
        let longest = law(u32::MAX, 4000);
        assert_eq!((longest.proportional, longest.patience), (1 << FINE, u32::MAX / 4000 + 3));
        assert!(longest.integral > 0);
        let shortest = law(0, u32::MAX);
        assert_eq!((shortest.proportional, shortest.integral, shortest.patience), (0, (2 << FINE) / 5, 3));
        assert_eq!([longest.at_rise, shortest.at_rise], [1001, 2]);
    }
}
