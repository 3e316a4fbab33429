//! Plan of a sweep: its band, its duration, its captures.
//!
//! ```text
//! captures |<------ 4096 values ------>|<------ 4096 values ------>|      one of them each time that the sweep is played
//! sweep    |<------------ T ----------------->|<-- ring and gate ->|
//! ```
//! A capture has 4096 values of 2^k codes each. k is the largest one that keeps the sweep's highest frequency
//! below 0.49 of the values' rate. The sweep and the plate's ring time must fit into the captures. The device
//! has memory for one capture; if there are more, the same sweep is played again, code by code, and the next
//! stretch is captured.

use super::super::error::MeasureError;
use super::super::plan::Wanted;
use super::chirp::{self, Chirp};
use slipline_link::DeviceTable;
use slipline_link::protocol::limits::MAX_GLIDE_MS;
use slipline_plate::Plate;

/// Values of a capture.
pub(super) const VALUES: u16 = 4096;
/// Largest number of codes per value, as a binary logarithm.
const LOG2_CODES_MAX: u8 = 10;
/// Highest frequency of the sweep over the rate of the values: below a half, so that no alias falls into the
/// band.
const OF_VALUES: f64 = 0.49;
/// Smallest share of a capture that the sweep occupies.
const LEAST_SHARE: f64 = 0.5;
/// Largest number of captures of one measurement.
const CAPTURES_MAX: f64 = 64.0;
/// The longest sweep, seconds: the device's longest glide.
pub(super) const LONGEST_S: f64 = MAX_GLIDE_MS as f64 * 1e-3;

/// Plan of a sweep and its captures.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// The sweep.
    pub chirp: Chirp,
    /// The binary logarithm of the codes of a captured value.
    pub log2_codes: u8,
    /// Number of captures.
    pub captures: u16,
    /// Shortest glide for the actuator's travel, seconds.
    pub(super) glide_s: f64,
}

impl SweepPlan {
    /// The plan for a plate, its table, and a device's sample rate.
    ///
    /// # Errors
    /// [`MeasureError::OutOfRange`], and [`MeasureError::Rings`] if the plate's ring time requires more than
    /// 64 captures.
    pub fn new(
        plate: &Plate,
        table: &DeviceTable,
        wanted: &Wanted,
        rate_hz: f64,
    ) -> Result<Self, MeasureError> {
        let chirp = Chirp::over(plate, wanted, rate_hz)?;
        let fits = |log2: &u8| chirp.ends_hz.1 <= OF_VALUES * rate_hz / f64::from(1_u32 << log2);
        let log2_codes = (0..=LOG2_CODES_MAX).rev().find(fits).unwrap_or(0);
        let capture_s = f64::from(u32::from(VALUES) << log2_codes) / rate_hz;
        let glide_s = chirp::glide_s(table);
        let shortest_s = chirp.shortest_s(glide_s).max(LEAST_SHARE * capture_s);
        let tail_s = chirp.tail_s();
        let captures = ((shortest_s + tail_s) / capture_s).ceil();
        if captures > CAPTURES_MAX || shortest_s > LONGEST_S {
            return Err(MeasureError::Rings { seconds: chirp.ring_s });
        }
        let sweep_s = (captures * capture_s - tail_s).min(LONGEST_S);
        Ok(Self { chirp: chirp.lasting(sweep_s), log2_codes, captures: captures as u16, glide_s })
    }

    /// Samples of a capture.
    #[must_use]
    pub(crate) fn capture_samples(&self) -> u64 {
        u64::from(VALUES) << self.log2_codes
    }

    /// The rate of the captured values, Hz.
    #[must_use]
    pub(crate) fn value_rate_hz(&self) -> f64 {
        self.chirp.rate_hz / f64::from(1_u32 << self.log2_codes)
    }

    /// Samples that the device needs: silence for the noise, and each sweep up to the end of its capture.
    #[must_use]
    pub fn samples(&self) -> u64 {
        let captures = u64::from(self.captures);
        self.capture_samples() * (1 + captures * (captures + 1) / 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_model::field::simulation::table_for;
    use slipline_plate::preset;

    const RATE_HZ: f64 = 400e3;

    fn plan(name: &str, change: impl Fn(&mut Wanted)) -> Result<SweepPlan, MeasureError> {
        let plate = preset(name).unwrap();
        let (_, table) = table_for(&plate, RATE_HZ as u32).unwrap();
        let mut wanted = Wanted::of(&plate);
        change(&mut wanted);
        SweepPlan::new(&plate, &table, &wanted, RATE_HZ)
    }

    #[test]
    fn a_sweep_and_its_ring_fill_the_captures_and_stay_below_half_of_the_values_rate() {
        for (name, captures, most_s) in [("membrane", 1, 10.5), ("al-bending", 4, 0.46), ("al-sh", 7, 1.2)] {
            let plan = plan(name, |_| ()).unwrap();
            println!("{name}: {plan:?}, {} s", plan.samples() as f64 / RATE_HZ);
            let whole = u64::from(plan.captures) * plan.capture_samples();
            let tail = whole - plan.chirp.samples;
            assert!(tail as f64 / RATE_HZ >= 1.25 * plan.chirp.ring_s, "{name}");
            assert!(
                plan.chirp.ends_hz.1 < 0.491 * plan.value_rate_hz()
                    && plan.chirp.ends_hz.0 > 0.4 * plan.chirp.wanted.low_hz
            );
            assert!(plan.captures <= captures && plan.samples() as f64 / RATE_HZ < most_s, "{name}");
            // A block changes the frequency by half of the device's limit.
            let ends = [plan.chirp.samples as f64 - 128.0, plan.chirp.samples as f64];
            let change = plan.chirp.frequency_hz(ends[1]) - plan.chirp.frequency_hz(ends[0]);
            assert!(change < 0.51 * RATE_HZ / 1024.0, "{name}: {change} Hz");
        }
    }

    #[test]
    fn a_band_that_one_capture_does_not_cover_takes_more_of_them() {
        let wide = plan("membrane", |wanted| wanted.high_hz = 3e3).unwrap();
        assert!(wide.captures > 1, "{wide:?}");
        assert!(wide.captures as u64 * wide.capture_samples() >= wide.chirp.samples);
    }

    #[test]
    fn what_cannot_be_swept_names_its_field_and_range() {
        let refused = |change: fn(&mut Wanted)| plan("membrane", change).unwrap_err().to_string();
        let message = refused(|wanted| wanted.high_hz = 170e3);
        assert!(message.starts_with("to = 170 kHz: must be 83.14 Hz to 160 kHz"), "{message}");
        let message = refused(|wanted| wanted.low_hz = f64::NAN);
        assert!(message.starts_with("from = no number"), "{message}");
        let message = refused(|wanted| wanted.high_hz = 100e3);
        assert!(message.starts_with("the plate rings for"), "{message}");
    }
}
