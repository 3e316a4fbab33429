//! The calibration's pages: known dimensions, responses, the fit in the background, and the calibrated plate.

use super::{CalibrateIntent, Lab, Reach};
use crate::calibration::{CalibrationWizard, PlaceResponse, WizardPage};
use crate::instrument::shell::{Output, Page};
use crate::instrument::shown::CalibrateScene;
use crate::instrument::work::Jobs;
use crate::jobs::calibrate::{CalibrateDone, CalibrateJob, CalibrationResult};
use slipline_model::jobs::LatestResult;
use slipline_plate::Plate;
use std::mem::take;
use std::sync::Arc;

/// The state of the pages.
#[derive(Default)]
pub(super) struct Calibrating {
    /// The calibration under way. It stays while its pages are closed, until it is discarded or used.
    wizard: Option<CalibrationWizard>,
    fit: LatestResult<CalibrateJob, CalibrateDone>,
}

impl Calibrating {
    pub(super) fn new(jobs: &mut Jobs) -> Self {
        Self { wizard: None, fit: LatestResult::of(take(&mut jobs.calibrations)) }
    }

    /// Stores a result of the fit.
    pub(super) fn take_result(&mut self) {
        self.fit.take();
    }

    /// Sensor place of the open page, metres; `None` without a calibration, and on pages without a sensor.
    pub(super) fn place_m(&self) -> Option<f64> {
        let calibration = self.wizard.as_ref()?;
        Some(calibration.places_m()[calibration.step.sensor()?])
    }

    /// Whether the user places the sensor or measures on the open page.
    pub(super) fn has_sensor_in_hand(&self) -> bool {
        let step = self.wizard.as_ref().map(|calibration| calibration.step);
        step.is_some_and(|step| step == WizardPage::FirstPlace || step.sensor().is_some())
    }

    fn found(&self) -> Option<&Arc<CalibrationResult>> {
        self.fit.current()?.as_ref().ok()
    }

    pub(super) fn scene(&self) -> Option<CalibrateScene<'_>> {
        let (result, progress) = (self.fit.current().map(Result::as_deref), self.fit.progress());
        Some(CalibrateScene { calibration: self.wizard.as_ref()?, result, progress })
    }

    /// Requests the fit while the result's page is open.
    fn ask(&mut self, rate_hz: f64) {
        let job = self.wizard.as_ref().filter(|it| it.step == WizardPage::Result);
        if let Some(job) = job.and_then(|calibration| calibration.job(rate_hz)) {
            self.fit.ask(job);
        }
    }
}

impl Lab {
    /// Carries out a request of the calibration's pages; returns the plate that is to be used.
    pub(crate) fn perform_calibrate(
        &mut self,
        intent: CalibrateIntent,
        reach: &mut Reach<'_>,
    ) -> Option<Arc<Plate>> {
        if intent == CalibrateIntent::Open {
            self.open_calibration(reach);
            return None;
        }
        let calibration = self.calibration.wizard.as_mut()?;
        match intent {
            CalibrateIntent::Open => {}
            CalibrateIntent::Cancel => self.end_calibration(reach),
            CalibrateIntent::Page(step) => {
                calibration.step = step;
                // The sensor stands where the page asks for it.
                if let Some(sensor) = step.sensor() {
                    self.live.draft.place_m = calibration.places_m()[sensor];
                }
            }
            CalibrateIntent::Calipers(calipers) => {
                if let Err(error) = calibration.take_calipers(calipers) {
                    reach.out.fail(slipline_link::capitalized(&error.to_string()));
                }
            }
            CalibrateIntent::OpenAnswer => reach.out.push(Output::ChooseMeasurement),
            CalibrateIntent::TakeAnswer(sensor, number) => self.take_answer(sensor, number),
            CalibrateIntent::LeaveCheckOut => calibration.leave_check_out(),
            CalibrateIntent::Exchange => calibration.exchange(),
            CalibrateIntent::Use => {
                let plate = Arc::clone(&self.calibration.found()?.plate);
                self.end_calibration(reach);
                self.rig.is_described_by(&plate);
                self.measurements.lists.is_described_by(&plate);
                return Some(plate);
            }
            CalibrateIntent::Save => {
                if let Some(found) = self.calibration.found() {
                    reach.out.save("plate.toml", "Plate", "toml", found.plate.to_toml());
                }
            }
        }
        self.calibration.ask(reach.drive.sample_rate_hz());
        None
    }

    /// Opens the pages: the closed calibration, or a new one. One of another plate restarts at its first page.
    fn open_calibration(&mut self, reach: &mut Reach<'_>) {
        let plate = reach.desk.plate();
        let next = match self.calibration.wizard.take() {
            Some(begun) if Arc::ptr_eq(begun.plate(), plate) => begun,
            Some(begun) => begun.with_plate(plate),
            None => CalibrationWizard::of(plate),
        };
        self.calibration.wizard = Some(next);
        reach.out.open(Page::Calibration);
    }

    fn end_calibration(&mut self, reach: &mut Reach<'_>) {
        self.calibration.fit.forget();
        self.calibration.wizard = None;
        self.cancel_measuring();
        reach.out.push(Output::CloseCalibration);
    }

    pub(super) fn take_answer(&mut self, sensor: usize, number: u64) {
        let Some(entry) = self.measurements.entry(number) else { return };
        let answer = PlaceResponse { name: entry.name.clone(), measurement: Arc::clone(&entry.measurement) };
        if let Some(calibration) = &mut self.calibration.wizard {
            calibration.take_answer(sensor, answer);
        }
    }

    /// Uses an opened measurement as the response that the open page asks for; returns whether it asks for
    /// one.
    pub(super) fn answered(&mut self, number: u64, is_calibration_open: bool) -> bool {
        let step = self.calibration.wizard.as_ref().map(|calibration| calibration.step);
        let sensor = step.filter(|_| is_calibration_open).and_then(WizardPage::sensor);
        if let Some(sensor) = sensor {
            self.take_answer(sensor, number);
        }
        sensor.is_some()
    }
}
