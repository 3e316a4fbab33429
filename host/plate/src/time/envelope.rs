//! Maximum and RMS of the displacement at each position.

use crate::definition::plate::Plate;
use crate::frequency::peak::{self, Peak};

/// Maximum and RMS displacement at each position since the last reset.
///
/// Computed from the complex (analytic) displacement, whose magnitude is the instantaneous amplitude. So the maximum
/// does not depend on the phase at which the field is sampled.
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

    /// Number of fields recorded since the last reset.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Largest displacement at each position, metres; zeros before the first sample.
    pub fn maximum_m(&self) -> Vec<f32> {
        self.largest_square.iter().map(|square| square.sqrt()).collect()
    }

    /// RMS displacement at each position, metres; zeros before the first sample.
    pub fn rms_m(&self) -> Vec<f32> {
        // Half of the squared magnitude is the mean square of the real displacement.
        let samples = self.samples.max(1) as f64;
        self.sum_of_squares.iter().map(|sum| (0.5 * sum / samples).sqrt() as f32).collect()
    }

    /// The peak of the envelope before the turning point of `frequency_hz` on `plate`, which must be the plate of the
    /// envelope.
    ///
    /// The peak's amplitude is sqrt(2) times the RMS, metres: for one settled tone, its amplitude. `None` if the
    /// frequency does not enter or there is no peak, as in [`crate::Response::peak`].
    pub fn peak(&self, plate: &Plate, frequency_hz: f64) -> Option<Peak> {
        let turning_point_m = plate.turning_point_m(frequency_hz)?;
        let kappa = plate.kappa_per_m(frequency_hz)?;
        let samples = self.samples.max(1) as f64;
        let square: Vec<f64> = self.sum_of_squares.iter().map(|sum| sum / samples).collect();
        let step_m = plate.length_m() / (square.len() - 1) as f64;
        peak::find_in_squares(&square, step_m, turning_point_m, kappa)
    }
}
