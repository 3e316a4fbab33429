//! A measurement under way: the points so far, beside the plate's model at all frequencies of its plan.

use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_plate::calibrate::{MeasuredPoint, Measurement};
use slipline_plate::order::median;
use slipline_plate::quantity::decibels;
use slipline_plate::{Complex64, Plate};
use std::sync::Arc;

/// A point of fewer times its noise shows no level.
const SEEN: f64 = 3.0;
/// Two frequencies that differ by less than this share are one.
const SAME: f64 = 1e-9;

/// The points so far, and the model's.
pub(super) struct Answers {
    /// The plate, and a measurement at the frequencies of the plan.
    planned: CompareJob,
    /// The model's answers to them, once they are computed.
    model: Option<Compared>,
    measured: Option<Arc<Measurement>>,
}

impl Answers {
    /// Before the first point of a measurement of this plate at the frequencies of `planned`.
    pub(super) fn new(plate: &Arc<Plate>, planned: Measurement) -> Self {
        let planned = CompareJob { plate: Arc::clone(plate), measurement: Arc::new(planned) };
        Self { planned, model: None, measured: None }
    }

    /// What the model is asked for, until it has answered.
    pub(super) fn wanted(&self) -> Option<&CompareJob> {
        self.model.is_none().then_some(&self.planned)
    }

    /// Takes the model's answer to what is [`wanted`](Self::wanted).
    pub(super) fn take_model(&mut self, answer: &Compared) {
        self.model = Some(answer.clone());
    }

    /// Takes all points that are measured.
    pub(super) fn take_measured(&mut self, measured: Option<Arc<Measurement>>) {
        self.measured = measured;
    }

    pub(super) fn scene(&self) -> SoFar<'_> {
        SoFar {
            planned: &self.planned.measurement.points,
            predicted: self
                .model
                .as_ref()
                .and_then(|model| model.as_ref().ok())
                .map_or(&[], |model| &model.predicted),
            measured: self.measured.as_ref().map_or(&[], |measured| &measured.points),
        }
    }
}

/// The points of a measurement under way, beside the plate's model.
#[derive(Clone, Copy, Debug)]
pub struct SoFar<'a> {
    /// A point for each frequency of the plan, rising; of its values only the frequency has a meaning.
    pub planned: &'a [MeasuredPoint],
    /// The model's answer to each of them; empty until it is computed, and where the model has none.
    pub predicted: &'a [Option<Complex64>],
    /// The points that are measured, by rising frequency.
    pub measured: &'a [MeasuredPoint],
}

/// Levels over frequency, each as Hz and dB under the model's highest.
pub struct Levels {
    /// Of the model.
    pub model: Vec<[f64; 2]>,
    /// Of the measured points. The median difference from the model of those above their noise is taken out, because a sensor that
    /// is not calibrated does not measure the level; without one they are under the highest of them.
    pub measured: Vec<[f64; 2]>,
}

impl SoFar<'_> {
    /// The levels of the model and of the points so far.
    #[must_use]
    pub fn levels_db(&self) -> Levels {
        let highest = self.predicted.iter().flatten().map(|at| at.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let level_db = |value: Complex64, of: f64| decibels(value.norm().max(f64::MIN_POSITIVE) / of);
        let answers = self.planned.iter().zip(self.predicted);
        let model: Vec<[f64; 2]> =
            answers.filter_map(|(point, at)| Some([point.frequency_hz, level_db((*at)?, highest)])).collect();
        let measured: Vec<[f64; 2]> =
            self.measured.iter().map(|point| [point.frequency_hz, level_db(point.response, 1.0)]).collect();
        let off_db = |(point, [hertz, db]): (&MeasuredPoint, &[f64; 2])| {
            if point.response.norm() < SEEN * point.noise {
                return None;
            }
            let [at_hz, model_db] = model.get(model.partition_point(|at| at[0] < hertz * (1.0 - SAME)))?;
            (*at_hz < hertz * (1.0 + SAME)).then(|| db - model_db)
        };
        let loudest_db = || measured.iter().map(|at| at[1]).fold(f64::MIN, f64::max);
        let off_db = self.measured.iter().zip(&measured).filter_map(off_db).collect();
        let raised_db = median(off_db).unwrap_or_else(loudest_db);
        Levels { measured: measured.iter().map(|[hertz, db]| [*hertz, db - raised_db]).collect(), model }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_in_the_noise_do_not_move_the_others_off_the_models_curve() {
        let point = |(i, response): (usize, f64)| MeasuredPoint {
            frequency_hz: 100.0 + i as f64,
            response: response.into(),
            noise: 1.0,
            headroom_db: None,
        };
        // Rises by 20 dB from point to point; the sensor's gain is 1000, and seven of ten points are noise.
        let model: Vec<f64> = (-9..=0).map(|i| 10.0_f64.powi(i)).collect();
        let planned: Vec<_> = model.iter().copied().enumerate().map(point).collect();
        let predicted: Vec<_> = model.iter().map(|at| Some(Complex64::from(*at))).collect();
        let responses = model.iter().map(|at| (1e3 * at).max(0.5));
        let measured: Vec<_> = responses.enumerate().map(point).collect();
        let so_far = SoFar { planned: &planned, predicted: &predicted, measured: &measured };
        let levels = so_far.levels_db();
        for (model, measured) in levels.model.iter().zip(&levels.measured).skip(7) {
            assert!((model[1] - measured[1]).abs() < 1e-9, "{model:?} {measured:?}");
        }
    }
}
