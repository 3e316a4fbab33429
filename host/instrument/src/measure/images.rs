//! Images of the tones that fold onto the measured current.
//!
//! DAC and ADC have one clock. The hold of the codes repeats a tone of the frequency f at k fs + f, k any whole number, and samples
//! at fs fold each image back onto f. With x = f/fs the hold has the amplitude sin(pi x)/(pi (x + k)) there, and the current of a
//! capacitance rises with x + k: so every image has the same current as the tone, and what stands between the DAC and the ADC alone
//! makes it smaller. With the response H of amplifier and filter the current is wrong by the share
//! ```text
//! piezo   sum over k != 0 of H(f + k fs)/H(f)              coil   the same with f/(f + k fs) in each term
//! ```
//! whose terms turn with the lag of the ADC's samples. The bound is the sum of their magnitudes. One low-pass of second order and the
//! bandwidth B leaves about 3.3 (B/fs)^2 of a low tone, two of them 2.2 (B/fs)^4.

use super::answers::Warning;
use slipline_plate::Complex64;
use slipline_plate::Plate;
use slipline_plate::calibrate::DriveLoad;
use slipline_plate::limits;
use slipline_plate::quantity::Range;
use std::f64::consts::SQRT_2;

/// Allowed bandwidths of amplifier and filter.
pub const BANDWIDTH: Range = limits::BANDWIDTH;
/// Error of the current that is not worth a word.
const GREEN: f64 = 0.05;
/// Images on each side of the tone that are summed; the rest is below 1/IMAGES of the first.
const IMAGES: u16 = 200;

/// The bandwidths (-3 dB) of what lies between the DAC and the ADC of the current, each of second order; `None` where one is not known
/// or not there.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bandwidths {
    /// Of the amplifier, Hz (10 to 1e8).
    pub amplifier_hz: Option<f64>,
    /// Of a filter before the amplifier or before the input of the current, Hz (10 to 1e8).
    pub filter_hz: Option<f64>,
}

impl Bandwidths {
    /// The same, with the plate file's bandwidth of the amplifier where none is stated.
    #[must_use]
    pub fn of_drive(self, plate: &Plate) -> Self {
        Self { amplifier_hz: self.amplifier_hz.or(plate.spec().amplifier_bandwidth_hz), ..self }
    }

    /// The response at a frequency, for e^(-j omega t).
    pub(crate) fn response(&self, frequency_hz: f64) -> Complex64 {
        let each = [self.amplifier_hz, self.filter_hz].into_iter().flatten();
        each.map(|bandwidth_hz| low_pass(bandwidth_hz, frequency_hz)).product()
    }

    /// The largest error of the current of a load at a tone, as a share of it; `None` where no bandwidth is known, so that nothing
    /// bounds it.
    #[must_use]
    pub fn error(&self, load: &DriveLoad, frequency_hz: f64, rate_hz: f64) -> Option<f64> {
        (*self != Self::default()).then(|| {
            let images = images(load, |hz| self.response(hz), frequency_hz, rate_hz);
            images.map(|image| image.norm()).sum()
        })
    }

    /// What to warn of where the current of a load is measured up to this frequency.
    #[must_use]
    pub fn warning(&self, load: &DriveLoad, highest_hz: f64, rate_hz: f64) -> Option<Warning> {
        match self.error(load, highest_hz, rate_hz) {
            None => matches!(load, DriveLoad::Piezo { .. }).then_some(Warning::UnknownImages),
            Some(share) => (share > GREEN).then_some(Warning::Images { share, frequency_hz: highest_hz }),
        }
    }
}

/// A low-pass of second order without a maximum (Butterworth), for e^(-j omega t).
fn low_pass(bandwidth_hz: f64, frequency_hz: f64) -> Complex64 {
    let x = frequency_hz / bandwidth_hz;
    Complex64::new(1.0 - x * x, -SQRT_2 * x).inv()
}

/// The images that fold onto a tone, each over the tone, with samples at the steps of the codes.
pub(crate) fn images(
    load: &DriveLoad,
    response: impl Fn(f64) -> Complex64,
    frequency_hz: f64,
    rate_hz: f64,
) -> impl Iterator<Item = Complex64> {
    let of_tone = response(frequency_hz);
    let rises = matches!(load, DriveLoad::Piezo { .. });
    let beside = (1..=IMAGES).flat_map(|k| [f64::from(k), -f64::from(k)]);
    beside.map(move |k| {
        let image_hz = frequency_hz + k * rate_hz;
        let share = if rises { 1.0 } else { frequency_hz / image_hz };
        share * response(image_hz) / of_tone
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    const RATE_HZ: f64 = 400e3;
    const PIEZO: DriveLoad = DriveLoad::Piezo { capacitance_f: 1e-9 };

    /// The current of a capacitance of 1 F behind a low-pass that codes cos(omega n) step: the derivative of the voltage at the
    /// steps, by the differential equation in steps far shorter than a sample, over that of the tone alone.
    fn in_time(bandwidth_hz: f64, frequency_hz: f64) -> Complex64 {
        const FINE: u32 = 256;
        let (omega, dt) = (TAU * bandwidth_hz, 1.0 / (RATE_HZ * f64::from(FINE)));
        let acceleration = |u: f64, v: f64, slope: f64| omega * (omega * (u - v) - SQRT_2 * slope);
        let (mut v, mut slope) = (0.0, 0.0);
        let (settle, count) = (4000, 4000);
        let mut sum = Complex64::ZERO;
        for n in 0..settle + count {
            let phase = TAU * frequency_hz * f64::from(n) / RATE_HZ;
            if n >= settle {
                sum += slope * Complex64::cis(phase);
            }
            for _ in 0..FINE {
                // Runge and Kutta, second order.
                let (v1, s1) = (v + 0.5 * dt * slope, slope + 0.5 * dt * acceleration(phase.cos(), v, slope));
                (v, slope) = (v + dt * s1, slope + dt * acceleration(phase.cos(), v1, s1));
            }
        }
        let found = sum * 2.0 / f64::from(count);
        let x = PI * frequency_hz / RATE_HZ;
        let hold = x.sin() / x * Complex64::cis(x);
        found / (Complex64::new(0.0, -TAU * frequency_hz) * hold * low_pass(bandwidth_hz, frequency_hz))
    }

    #[test]
    fn the_sum_of_the_images_equals_the_samples_of_the_differential_equation() {
        for (bandwidth_hz, frequency_hz) in [(100e3, 40e3), (150e3, 10e3), (45e3, 20e3)] {
            let folded: Complex64 =
                images(&PIEZO, |hz| low_pass(bandwidth_hz, hz), frequency_hz, RATE_HZ).sum();
            let is = in_time(bandwidth_hz, frequency_hz);
            assert!((is - 1.0 - folded).norm() < 0.004, "{bandwidth_hz} {frequency_hz}: {is} {folded}");
            assert!(folded.re < -0.03, "as a smaller capacitance: {folded}");
        }
    }

    #[test]
    fn one_low_pass_leaves_a_fifth_and_two_a_hundredth() {
        let error = |amplifier_hz, filter_hz, hz: f64| {
            Bandwidths { amplifier_hz, filter_hz }.error(&PIEZO, hz, RATE_HZ)
        };
        assert_eq!(error(None, None, 1e3), None);
        for bandwidth_hz in [100e3, 150e3] {
            let bound = error(Some(bandwidth_hz), None, 1e3).unwrap();
            let law = PI * PI / 3.0 * (bandwidth_hz / RATE_HZ).powi(2);
            assert!((bound / law - 1.0).abs() < 0.15, "{bound} {law}");
        }
        let both = error(Some(100e3), Some(100e3), 10e3).unwrap();
        assert!(both < 0.012, "{both}");
        let coil = DriveLoad::Coil { resistance_ohm: 4.0 };
        let of_coil = Bandwidths { amplifier_hz: Some(150e3), filter_hz: None }.error(&coil, 1e3, RATE_HZ);
        assert!(of_coil.unwrap() < 1e-3, "{of_coil:?}");
    }

    #[test]
    fn a_piezo_without_a_bandwidth_is_cautioned_and_so_is_more_than_five_percent() {
        let of =
            |amplifier_hz, filter_hz| Bandwidths { amplifier_hz, filter_hz }.warning(&PIEZO, 40e3, RATE_HZ);
        assert_eq!(of(None, None), Some(Warning::UnknownImages));
        assert!(matches!(of(Some(100e3), None), Some(Warning::Images { share, .. }) if share > 0.15));
        assert_eq!(of(Some(120e3), Some(120e3)), None);
        let coil = DriveLoad::Coil { resistance_ohm: 4.0 };
        assert_eq!(Bandwidths::default().warning(&coil, 1e3, RATE_HZ), None);
    }
}
