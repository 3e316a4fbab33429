//! Comparison of a measurement with the plate file's prediction: tests whether the file describes the plate.

use super::acceptance::CHI2_PER_N_MAX;
use super::gain::DECIBELS;
use super::pairs::{MODEL_ERROR, tail_error};
use super::response::prediction::predicted_beside_largest;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement};
use crate::definition::Plate;
use crate::order::median;
use num_complex::Complex64;

/// Median magnitude of a normal deviate over its standard deviation.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

/// Differences of a measurement from the prediction of a plate file.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Comparison {
    /// The prediction at each point, [`Comparison::level_db`] included; `None` where no wave enters the plate.
    pub predicted: Vec<Option<Complex64>>,
    /// The measured magnitude over the predicted one at each point, dB; `None` where nothing is predicted.
    pub off_db: Vec<Option<f64>>,
    /// Median of the measured over the predicted magnitudes, dB, by which the prediction was raised: an uncalibrated
    /// sensor does not measure the level. 0 for a calibrated one.
    pub level_db: f64,
    /// Number of points at which both are known.
    pub count: usize,
    /// Median of the differences' magnitudes, dB.
    pub usual_db: f64,
    /// Median expected from the noise and from the error of the one-mode equation, dB.
    pub allowed_db: f64,
    /// Sum of the squared differences of the magnitudes, each over its variance, divided by their number. The
    /// variance is that of the noise and of a model error of 1.5 %, and between clamped edges 0.3 % of the largest amplitude.
    pub chi2_per_n: f64,
}

impl Comparison {
    /// Whether the differences exceed noise and model error: then a calibration would be refused.
    pub fn is_other_plate(&self) -> bool {
        self.count > 0 && self.chi2_per_n > CHI2_PER_N_MAX
    }

    /// Compares a measurement with the prediction of `plate`'s file, by magnitude: phases have the unknown delays of
    /// amplifier and sensor.
    ///
    /// # Errors
    /// As [`predicted`](crate::calibrate::predicted).
    pub fn of(plate: &Plate, sensor: &Measurement) -> Result<Self, CalibrateError> {
        let both = predicted_beside_largest(plate, sensor)?.into_iter().map(Option::unzip);
        let (mut predicted, largest): (Vec<Option<Complex64>>, Vec<Option<f64>>) = both.unzip();
        let tail_error = tail_error(&plate.spec().model);
        let off = |(answer, at): (&MeasuredPoint, &Option<Complex64>)| {
            at.map(|at| DECIBELS * (answer.response.norm().max(f64::MIN_POSITIVE) / at.norm()).ln())
        };
        let mut off_db: Vec<Option<f64>> = sensor.points.iter().zip(&predicted).map(off).collect();
        let level_db = match sensor.unit_per_response {
            Some(_) => 0.0,
            None => median(off_db.iter().flatten().copied().collect()).unwrap_or(0.0),
        };
        let scale = (level_db / DECIBELS).exp();
        predicted.iter_mut().flatten().for_each(|at| *at *= scale);
        off_db.iter_mut().flatten().for_each(|off| *off -= level_db);

        let (mut count, mut chi2, mut allowed) = (0, 0.0, Vec::new());
        for ((point, at), largest) in sensor.points.iter().zip(&predicted).zip(largest) {
            let Some((at, largest)) = at.map(Complex64::norm).zip(largest) else { continue };
            let measured = point.response.norm();
            // The model error is a share of the wave, not of its magnitude at a node, where measured and predicted
            // are both small.
            let deviation =
                point.noise.hypot(MODEL_ERROR * measured.max(at)).hypot(tail_error * scale * largest);
            chi2 += ((measured - at) / deviation).powi(2);
            allowed.push(DECIBELS * MEDIAN_OF_NORMAL * deviation / measured.max(at));
            count += 1;
        }
        let usual = off_db.iter().flatten().map(|off| off.abs()).collect();
        Ok(Self {
            predicted,
            off_db,
            level_db,
            count,
            usual_db: median(usual).unwrap_or(0.0),
            allowed_db: median(allowed).unwrap_or(0.0),
            chi2_per_n: chi2 / count.max(1) as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::measurement::sensor::SensorKind;
    use crate::calibrate::predicted;
    use crate::definition::preset;

    /// Responses of an acceleration sensor at 32 mm on `truth`, with 7.3 times the stated gain and 1 % of noise.
    fn measured(truth: &Plate, unit_per_response: Option<f64>) -> Measurement {
        let point = |i: u32| MeasuredPoint {
            frequency_hz: 90.0 + 2.0 * f64::from(i),
            response: Complex64::ONE,
            noise: 1.0,
            headroom_db: None,
        };
        let asked = Measurement::at(0.032, SensorKind::Acceleration, (0..50).map(point).collect());
        let mut sensor = Measurement { unit_per_response, ..asked };
        let clean = predicted(truth, &sensor).expect("on the plate");
        let loudest = clean.iter().flatten().map(|at| at.norm()).fold(0.0, f64::max);
        for (i, (point, at)) in sensor.points.iter_mut().zip(clean).enumerate() {
            point.noise = 0.01 * 7.3 * loudest;
            let noise = Complex64::cis(2.4 * i as f64 * i as f64) * point.noise;
            point.response = 7.3 * at.expect("enters") + noise;
        }
        sensor
    }

    #[test]
    fn the_same_plate_agrees_and_one_that_is_four_per_cent_faster_does_not() {
        let plate = preset("membrane").expect("a preset");
        let same = Comparison::of(&plate, &measured(&plate, None)).expect("compared");
        assert!(!same.is_other_plate() && same.count == 50, "{same:?}");
        assert!((same.level_db - 20.0 * 7.3_f64.log10()).abs() < 0.2, "{}", same.level_db);
        assert!(same.usual_db < 2.0 * same.allowed_db && same.chi2_per_n < 2.0, "{same:?}");
        for share in [0.96, 1.04] {
            let other = plate.with_wave_speed(share).expect("valid");
            let other = Comparison::of(&plate, &measured(&other, None)).expect("compared");
            assert!(other.is_other_plate() && other.usual_db > 3.0 * other.allowed_db, "{share}: {other:?}");
        }
        // A calibrated sensor measures the level as well.
        let loud = Comparison::of(&plate, &measured(&plate, Some(1.0))).expect("compared");
        assert!(loud.level_db == 0.0 && loud.is_other_plate(), "{loud:?}");
    }

    #[test]
    fn a_measurement_of_which_no_wave_enters_the_plate_is_not_said_to_differ() {
        let plate = preset("membrane").expect("a preset");
        let mut sensor = measured(&plate, None);
        sensor.points.iter_mut().for_each(|point| point.frequency_hz *= 0.05);
        let compared = Comparison::of(&plate, &sensor).expect("compared");
        assert!(compared.count == 0 && !compared.is_other_plate(), "{compared:?}");
    }
}
