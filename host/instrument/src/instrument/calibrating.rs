//! The calibration's pages: known dimensions, responses, the fit in the background, and the calibrated plate.

use super::Instrument;
use super::shown::CalibrateScene;
use super::{CalibrateIntent, Output, Page};
use crate::calibration::{CalibrationWizard, PlaceResponse, WizardPage};
use crate::jobs::calibrate::{CalibrateDone, CalibrateJob, CalibrationResult};
use slipline_model::setup::edit::Edit;
use std::sync::Arc;

/// The state of the pages.
#[derive(Default)]
pub(crate) struct Calibrating {
    /// The calibration under way. It stays while its pages are closed, until it is discarded or used.
    calibration: Option<CalibrationWizard>,
    asked: Option<CalibrateJob>,
    pub(crate) latest: Option<CalibrateDone>,
}

impl Calibrating {
    /// The result of the latest job.
    fn current(&self) -> Option<&CalibrateDone> {
        self.latest.as_ref().filter(|latest| Some(&latest.job) == self.asked.as_ref())
    }

    /// Sensor place of the open page, metres; `None` without a calibration, and on pages without a sensor.
    pub(crate) fn place_m(&self) -> Option<f64> {
        let calibration = self.calibration.as_ref()?;
        Some(calibration.places_m()[calibration.step.sensor()?])
    }

    /// Whether the user places the sensor or measures on the open page.
    pub(crate) fn has_sensor_in_hand(&self) -> bool {
        let step = self.calibration.as_ref().map(|calibration| calibration.step);
        matches!(step, Some(WizardPage::FirstPlace | WizardPage::FirstAnswer | WizardPage::SecondPlace))
    }

    fn found(&self) -> Option<&Arc<CalibrationResult>> {
        self.current()?.result.as_ref().ok()
    }

    pub(crate) fn scene(&self, progress: Option<f32>) -> Option<CalibrateScene<'_>> {
        let result = self.current().map(|done| done.result.as_deref());
        Some(CalibrateScene { calibration: self.calibration.as_ref()?, result, progress })
    }
}

impl Instrument {
    /// Carries out a request of the calibration's pages.
    pub fn perform_calibrate(&mut self, intent: CalibrateIntent) {
        if intent == CalibrateIntent::Open {
            return self.open_calibration();
        }
        let Some(calibration) = &mut self.calibrating.calibration else { return };
        match intent {
            CalibrateIntent::Open => {}
            CalibrateIntent::Cancel => self.end_calibration(),
            CalibrateIntent::Page(step) => {
                calibration.step = step;
                // The sensor stands where the page asks for it.
                if let Some(sensor) = step.sensor() {
                    self.live.draft.place_m = calibration.places_m()[sensor];
                }
            }
            CalibrateIntent::Calipers(calipers) => {
                if let Err(error) = calibration.take_calipers(calipers) {
                    self.fail(slipline_link::capitalized(&error.to_string()));
                }
            }
            CalibrateIntent::OpenAnswer => self.outputs.push(Output::ChooseMeasurement),
            CalibrateIntent::TakeAnswer(sensor, number) => self.take_answer(sensor, number),
            CalibrateIntent::Exchange => calibration.exchange(),
            CalibrateIntent::Use => {
                if let Some(found) = self.calibrating.found().cloned() {
                    self.end_calibration();
                    self.live.rig.is_described_by(&found.plate);
                    self.edit(&Edit::Plate(Arc::clone(&found.plate)));
                    self.notices.post("The calibrated plate is in use. Undo takes it back.".to_owned());
                }
            }
            CalibrateIntent::Save => {
                if let Some(found) = self.calibrating.found() {
                    let text = found.plate.to_toml();
                    self.save("plate.toml", "Plate", "toml", text.into_bytes());
                }
            }
        }
        self.update_calibration();
    }

    /// Opens the pages: the closed calibration, or a new one. One of another plate restarts at its first page.
    fn open_calibration(&mut self) {
        let plate = &self.setup.plate;
        let next = match self.calibrating.calibration.take() {
            Some(begun) if Arc::ptr_eq(begun.plate(), plate) => begun,
            Some(begun) => begun.with_plate(plate),
            None => CalibrationWizard::of(plate),
        };
        self.calibrating.calibration = Some(next);
        self.outputs.push(Output::Open(Page::Calibration));
    }

    fn end_calibration(&mut self) {
        self.jobs.calibrations.cancel();
        self.cancel_measuring();
        self.calibrating = Calibrating::default();
        self.outputs.push(Output::CloseCalibration);
    }

    pub(crate) fn take_answer(&mut self, sensor: usize, number: u64) {
        let Some(entry) = self.measures.entry(number) else { return };
        let answer = PlaceResponse { name: entry.name.clone(), measurement: Arc::clone(&entry.measurement) };
        if let Some(calibration) = &mut self.calibrating.calibration {
            calibration.take_answer(sensor, answer);
        }
    }

    /// Uses an opened measurement as the response that the open page asks for; returns whether it asks for
    /// one.
    pub(crate) fn answered(&mut self, number: u64) -> bool {
        let step = self.calibrating.calibration.as_ref().map(|calibration| calibration.step);
        let sensor = step.filter(|_| self.attention.is_calibration_open).and_then(WizardPage::sensor);
        if let Some(sensor) = sensor {
            self.take_answer(sensor, number);
        }
        sensor.is_some()
    }

    /// Requests the fit while the result's page is open.
    fn update_calibration(&mut self) {
        let rate_hz = self.sample_rate_hz();
        let calibrating = &mut self.calibrating;
        let job = calibrating.calibration.as_ref().filter(|it| it.step == WizardPage::Result);
        let Some(job) = job.and_then(|calibration| calibration.job(rate_hz)) else { return };
        if calibrating.asked.as_ref() != Some(&job) {
            calibrating.asked = Some(job.clone());
            self.jobs.calibrations.ask(job);
        }
    }
}
