//! The settled envelope of several tones, predicted from the amplitude of each.

use super::equation::Equation;
use super::error::RespondError;
use super::finger::Finger;
use super::respond::{POINTS_MAX, POINTS_MIN, check_frequency, respond_touched};
use crate::definition::plate::Plate;
use crate::definition::sample_rate::{SAMPLE_RATE_MAX_HZ, hold_droop};
use crate::quantity::{OutOfRange, Range};
use num_complex::Complex64;

/// One tone of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToneDrive {
    /// Frequency, Hz; in [`super::respond_range`].
    pub frequency_hz: f64,
    /// DAC amplitude, 0 to 1 of full scale: the level times the table's gain.
    pub amplitude: f64,
    /// Phase, radians.
    pub phase_rad: f64,
}

/// The settled envelope of several tones together.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedEnvelope {
    /// Positions, metres: uniform from 0 to the plate's length.
    pub position_m: Vec<f64>,
    /// RMS displacement at each position, metres: the root of the sum of the tones' mean squares, exact if all
    /// frequencies differ.
    pub rms_m: Vec<f64>,
    /// Upper bound of the displacement at each position, metres: the sum of the tones' amplitudes.
    pub bound_m: Vec<f64>,
    /// Complex displacement of each tone at each position, metres; the displacement is Re(this e^(-j omega t)).
    pub tones: Vec<Vec<Complex64>>,
}

/// The settled envelope of `tones` on `plate`, optionally with a finger on it, driven by a DAC of `sample_rate_hz`,
/// at `points` uniform positions (8 to 200 001).
///
/// Each tone is multiplied by the hold's droop sinc(f/fs), by [`Plate::drive_response`] and by the full-scale
/// displacement. `sample_rate_hz` may be up to 1e8 and must be at least twice the frequency of every tone.
///
/// # Errors
/// [`RespondError::OutOfRange`] if `points` or `sample_rate_hz` is out of range, and the error of [`super::respond()`]
/// for the first tone that has one.
pub fn predict_envelope(
    plate: &Plate,
    finger: Option<&Finger>,
    tones: &[ToneDrive],
    sample_rate_hz: f64,
    points: usize,
) -> Result<PredictedEnvelope, RespondError> {
    // Checked before memory of that size is allocated.
    OutOfRange::check_count("points", points, POINTS_MIN..=POINTS_MAX)?;
    for tone in tones {
        check_frequency(plate, tone.frequency_hz)?;
    }
    let highest_hz = tones.iter().map(|tone| tone.frequency_hz).fold(0.5, f64::max);
    let rates = Range::new(2.0 * highest_hz, SAMPLE_RATE_MAX_HZ, "Hz");
    OutOfRange::check("sample rate", sample_rate_hz, rates)?;
    let mut rms = vec![0.0; points];
    let mut bound = vec![0.0; points];
    let mut fields = Vec::with_capacity(tones.len());
    for tone in tones {
        let response = respond_touched(plate, finger, tone.frequency_hz, points, Equation::Corrected)?;
        let droop = hold_droop(tone.frequency_hz, sample_rate_hz);
        let drive = plate.drive_response(tone.frequency_hz);
        let scale =
            drive * Complex64::cis(-tone.phase_rad) * tone.amplitude * droop * plate.spec().full_scale_m;
        let field: Vec<Complex64> = response.amplitude.iter().map(|f| f * scale).collect();
        for ((rms, bound), f) in rms.iter_mut().zip(&mut bound).zip(&field) {
            *rms += 0.5 * f.norm_sqr();
            *bound += f.norm();
        }
        fields.push(field);
    }
    rms.iter_mut().for_each(|square| *square = square.sqrt());
    let step = plate.length_m() / (points - 1) as f64;
    Ok(PredictedEnvelope {
        position_m: (0..points).map(|i| i as f64 * step).collect(),
        rms_m: rms,
        bound_m: bound,
        tones: fields,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::presets::preset;

    #[test]
    fn points_and_sample_rates_out_of_range_are_refused_before_anything_is_allocated() {
        let plate = preset("membrane").expect("a preset");
        let tones = [ToneDrive { frequency_hz: 150.0, amplitude: 1.0, phase_rad: 0.0 }];
        let refused = |tones: &[ToneDrive], rate: f64, points: usize| {
            predict_envelope(&plate, None, tones, rate, points).expect_err("out of range").to_string()
        };
        for points in [0, 7, usize::MAX] {
            let error = refused(&tones, 400e3, points);
            assert!(error.starts_with("points = ") && error.contains("8 to 200001"), "{error}");
            assert_eq!(refused(&[], 400e3, points), error);
        }
        for rate in [f64::NAN, -1.0, 0.0, 299.0, f64::INFINITY] {
            let error = refused(&tones, rate, 64);
            assert!(error.starts_with("sample rate = ") && error.contains("300 to 1e8 Hz"), "{error}");
        }
    }
}
