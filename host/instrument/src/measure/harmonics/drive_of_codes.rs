//! From windows of a sensor to harmonics of the drive.
//!
//! A window's answer of the tone k is b e^(js) at the input for the codes a sin(p_k), with p_k = k p_1. Let the answer at n f be A
//! while the fundamental of the amplitude a sounds and the upper tone has the least amplitude e, and A' while the upper tone has the
//! amplitude a'. Then the drive's harmonic is that of codes d sin(p_n + s) with
//! ```text
//! d e^(js) = a' A/A' - e
//! ```
//! A plate file states the drive behind the actuator, so [`Plate::harmonic_of_sines`] multiplies this by the response of hold and
//! actuator at n f over that at f.

use super::super::answers::Window;
use super::super::error::MeasureError;
use slipline_plate::quantity::decibels;
use slipline_plate::{Harmonics, Plate, ResponseCurve};

/// An answer of the plate below this multiple of its noise does not divide.
const CLEAR: f64 = 30.0;

/// The windows of one fundamental.
pub(super) struct Received {
    /// With the fundamental loud.
    pub(super) loud: Window,
    /// With its multiples loud.
    pub(super) upper: Window,
    /// The factor on the level by which the fundamental stayed within the actuator's travel.
    pub(super) scale: f64,
}

/// The measured harmonics of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredHarmonics {
    /// For the plate file.
    pub harmonics: Harmonics,
    /// The largest standard deviation of a harmonic over its fundamental, by the noise of the input: second and third.
    pub noise: [f64; 2],
    /// Number of frequencies at which the sensor does not receive the plate's own answer clearly: at twice and three times the
    /// frequency.
    pub unclear: [usize; 2],
}

impl MeasuredHarmonics {
    pub(super) fn of(
        plate: &Plate,
        rate_hz: f64,
        level: f64,
        quiet: &Window,
        received: &[Received],
    ) -> Result<Self, MeasureError> {
        let mut curves = Harmonics::ORDERS.map(|_| Vec::new());
        let (mut noise, mut unclear) = ([0.0_f64; 2], [0; 2]);
        for it in received {
            let fundamental = it.loud.tones[0];
            for (number, order) in Harmonics::ORDERS.into_iter().enumerate() {
                let slot = number + 1;
                let (tone, least) = (it.upper.tones[slot], it.loud.tones[slot].amplitude);
                let (answer, own) = (it.loud.answers[slot], it.upper.answers[slot]);
                let deviation = it.upper.deviation(quiet, tone.frequency_hz);
                if own.norm() < CLEAR * deviation {
                    unclear[number] += 1;
                    continue;
                }
                let codes = (answer / own * tone.amplitude - least) / fundamental.amplitude;
                // As it would be at the stated level.
                let codes = codes * it.scale.powi(1 - i32::from(order));
                let is_noise = deviation / own.norm() * tone.amplitude / fundamental.amplitude;
                noise[number] = noise[number].max(is_noise);
                let ratio = plate.harmonic_of_sines(order, fundamental.frequency_hz, rate_hz, codes);
                let level_db = decibels(ratio.norm()).clamp(-200.0, 0.0);
                curves[number].push([fundamental.frequency_hz, level_db, -ratio.arg().to_degrees()]);
            }
        }
        let curve = |points: Vec<[f64; 3]>| (points.len() >= 2).then_some(ResponseCurve { points });
        let [second, third] = curves.map(curve);
        if second.is_none() && third.is_none() {
            return Err(MeasureError::NoHarmonics);
        }
        Ok(Self { harmonics: Harmonics { level, second, third }, noise, unclear })
    }
}
