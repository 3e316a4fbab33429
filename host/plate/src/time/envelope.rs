//! Maximum and RMS of the displacement at each place.

use crate::frequency::peak::{self, Peak};
use crate::frequency::respond::{Equation, RespondError, respond};
use crate::spec::plate::Plate;
use num_complex::Complex64;

/// Maximum and RMS displacement at each place since the last reset.
///
/// Fed with the complex (analytic) displacement, whose magnitude is the amplitude at each moment: the maximum does
/// not depend on where in a cycle a sample falls.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    largest_square: Vec<f32>,
    sum_of_squares: Vec<f64>,
    samples: u64,
}

impl Envelope {
    pub(crate) fn new(places: usize) -> Self {
        Self { largest_square: vec![0.0; places], sum_of_squares: vec![0.0; places], samples: 0 }
    }

    pub(crate) fn reset(&mut self) {
        self.largest_square.fill(0.0);
        self.sum_of_squares.fill(0.0);
        self.samples = 0;
    }

    pub(crate) fn add(&mut self, re: &[f32], im: &[f32]) {
        let squares = self.largest_square.iter_mut().zip(&mut self.sum_of_squares);
        for ((largest, sum), (re, im)) in squares.zip(re.iter().zip(im)) {
            let square = re * re + im * im;
            *largest = largest.max(square);
            *sum += f64::from(square);
        }
        self.samples += 1;
    }

    /// How many moments were taken in since the last reset.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Largest displacement at each place, metres; zeros before the first sample.
    pub fn maximum_m(&self) -> Vec<f32> {
        self.largest_square.iter().map(|square| square.sqrt()).collect()
    }

    /// RMS displacement at each place, metres; zeros before the first sample.
    pub fn rms_m(&self) -> Vec<f32> {
        // Half of the squared magnitude is the mean square of the real displacement.
        let samples = self.samples.max(1) as f64;
        self.sum_of_squares.iter().map(|sum| (0.5 * sum / samples).sqrt() as f32).collect()
    }

    /// The turning-point peak of the envelope for a tone that turns at `frequency_hz`'s turning point.
    ///
    /// The amplitude is sqrt(2) times the RMS: for one settled tone, its amplitude. `None` as in
    /// [`crate::Response::peak`]. `plate` must be the plate the envelope was taken on.
    pub fn peak(&self, plate: &Plate, frequency_hz: f64) -> Option<Peak> {
        let turning_point_m = plate.turning_point_m(frequency_hz)?;
        let kappa = plate.kappa_per_m(frequency_hz)?;
        let samples = self.samples.max(1) as f64;
        let square: Vec<f64> = self.sum_of_squares.iter().map(|sum| sum / samples).collect();
        let step_m = plate.length_m() / (square.len() - 1) as f64;
        peak::find_in_squares(&square, step_m, turning_point_m, kappa)
    }
}

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
