//! The settled envelope of several tones, predicted from the amplitude of each.

use super::equation::Equation;
use super::error::RespondError;
use super::respond::respond;
use crate::spec::plate::Plate;
use num_complex::Complex64;

/// One tone of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToneDrive {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// DAC amplitude as a part of full scale (level times the table's gain).
    pub amplitude: f64,
    /// Phase, radians.
    pub phase_rad: f64,
}

/// The settled envelope of several tones together.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedEnvelope {
    /// Positions, metres: uniform from 0 to the plate's length.
    pub position_m: Vec<f64>,
    /// RMS displacement, metres: exact for tones of different frequencies.
    pub rms_m: Vec<f64>,
    /// Largest displacement when all tones meet in phase, metres.
    pub bound_m: Vec<f64>,
    /// Complex displacement of each tone, metres, as the phasor of e^(-j omega t).
    pub tones: Vec<Vec<Complex64>>,
}

/// The settled envelope of `tones` on `plate` behind a DAC of `sample_rate_hz`, on `points` places.
///
/// # Errors
/// [`RespondError`] for the first tone that does not enter or is out of range.
pub fn predict_envelope(
    plate: &Plate,
    tones: &[ToneDrive],
    sample_rate_hz: f64,
    points: usize,
) -> Result<PredictedEnvelope, RespondError> {
    let mut rms = vec![0.0; points];
    let mut bound = vec![0.0; points];
    let mut fields = Vec::with_capacity(tones.len());
    for tone in tones {
        let response = respond(plate, tone.frequency_hz, points, Equation::Corrected)?;
        let turn = std::f64::consts::PI * tone.frequency_hz / sample_rate_hz;
        let droop = if turn > 0.0 { turn.sin() / turn } else { 1.0 };
        let actuator = plate.spec().actuator.map_or(Complex64::ONE, |it| it.response(tone.frequency_hz));
        let scale =
            actuator * Complex64::cis(-tone.phase_rad) * tone.amplitude * droop * plate.spec().full_scale_m;
        let field: Vec<Complex64> = response.amplitude.iter().map(|f| f * scale).collect();
        for ((rms, bound), f) in rms.iter_mut().zip(&mut bound).zip(&field) {
            *rms += 0.5 * f.norm_sqr();
            *bound += f.norm();
        }
        fields.push(field);
    }
    rms.iter_mut().for_each(|square| *square = square.sqrt());
    let step = plate.length_m() / (points.max(2) - 1) as f64;
    Ok(PredictedEnvelope {
        position_m: (0..points).map(|i| i as f64 * step).collect(),
        rms_m: rms,
        bound_m: bound,
        tones: fields,
    })
}
