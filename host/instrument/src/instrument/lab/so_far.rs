//! The course of a measurement: the points measured so far, beside the plate's model at all frequencies of its plan.

use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_plate::calibrate::{Comparison, MeasuredPoint, Measurement};
use slipline_plate::quantity::decibels;
use slipline_plate::{Complex64, Plate};
use std::sync::Arc;

/// Two frequencies that differ by less than this share are one.
const SAME: f64 = 1e-9;

/// The answers so far, and the model's.
pub(super) struct Answers {
    /// The plate, and a measurement at the frequencies of the plan.
    planned: CompareJob,
    /// The model's answers to them; `None` until they are computed, and where there are none.
    model: Option<Comparison>,
    is_computed: bool,
    heard: Option<Arc<Measurement>>,
}

impl Answers {
    /// The course of a measurement of this plate at the frequencies of `planned`.
    pub(super) fn new(plate: &Arc<Plate>, planned: Measurement) -> Self {
        let planned = CompareJob { plate: Arc::clone(plate), measurement: Arc::new(planned) };
        Self { planned, model: None, is_computed: false, heard: None }
    }

    /// The job for the model, until its answer is taken.
    pub(super) fn wanted(&self) -> Option<&CompareJob> {
        (!self.is_computed).then_some(&self.planned)
    }

    /// Takes the model's answer to what is [`wanted`](Self::wanted).
    pub(super) fn take(&mut self, answer: &Compared) {
        (self.model, self.is_computed) = (answer.clone().ok(), true);
    }

    /// Takes the points measured so far.
    pub(super) fn hear(&mut self, heard: Option<Arc<Measurement>>) {
        self.heard = heard;
    }

    pub(super) fn scene(&self) -> SoFar<'_> {
        SoFar {
            planned: &self.planned.measurement.points,
            predicted: self.model.as_ref().map_or(&[], |model| &model.predicted),
            heard: self.heard.as_ref().map_or(&[], |heard| &heard.points),
        }
    }
}

/// The points of a measurement under way, beside the plate's model.
#[derive(Clone, Copy, Debug)]
pub struct SoFar<'a> {
    /// A point for each frequency of the plan, rising; of its values only the frequency has a meaning.
    pub planned: &'a [MeasuredPoint],
    /// The model's answer to each of them; empty until it is computed.
    pub predicted: &'a [Option<Complex64>],
    /// The points measured so far, by rising frequency.
    pub heard: &'a [MeasuredPoint],
}

impl SoFar<'_> {
    /// The model's level over frequency, dB under its highest: Hz and dB.
    #[must_use]
    pub fn model_db(&self) -> Vec<[f64; 2]> {
        let highest = self.predicted.iter().flatten().map(|at| at.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let answers = self.planned.iter().zip(self.predicted);
        let heard = answers.filter_map(|(point, at)| Some((point.frequency_hz, at.as_ref()?.norm())));
        heard.map(|(hertz, level)| [hertz, decibels(level.max(f64::MIN_POSITIVE) / highest)]).collect()
    }

    /// The measured levels over frequency: Hz and dB. The median of their differences from the model is taken out, because
    /// a sensor that is not calibrated does not measure the level; without a model they are dB under the highest.
    #[must_use]
    pub fn heard_db(&self) -> Vec<[f64; 2]> {
        let model = self.model_db();
        let level = |point: &MeasuredPoint| decibels(point.response.norm().max(f64::MIN_POSITIVE));
        let off = |point: &MeasuredPoint| {
            let is_there = |at: &&[f64; 2]| (at[0] / point.frequency_hz - 1.0).abs() < SAME;
            Some(level(point) - model.iter().find(is_there)?[1])
        };
        let mut off: Vec<f64> = self.heard.iter().filter_map(off).collect();
        off.sort_by(f64::total_cmp);
        let highest = || self.heard.iter().map(level).fold(f64::MIN, f64::max);
        let raised = off.get(off.len() / 2).copied().unwrap_or_else(highest);
        self.heard.iter().map(|point| [point.frequency_hz, level(point) - raised]).collect()
    }
}
