//! The steps of a calibration, one page each: plate file and caliper widths, first sensor place, its
//! measurement, second sensor place, result; and from there a third place, as a check.

pub(crate) mod name;
mod page;
pub(crate) mod remedy;

pub use name::named_calibrated;
pub use page::WizardPage;
pub use remedy::Remedy;

use crate::calipers::{CALIPERS_TOLERANCE_M, with_calipers};
use crate::jobs::calibrate::CalibrateJob;
use crate::measure::Wanted;
use slipline_plate::calibrate::{Calipers, Measurement, Placing, Priors, SensorPlaces};
use slipline_plate::{Plate, PlateError};
use std::sync::Arc;

/// Sensor places as fractions of the length, for a plate for which none can be proposed; the last one is that of a check.
const PLACES: [f64; 3] = [0.3, 0.6, 0.45];

/// The measured response at one place of the sensor.
#[derive(Debug, Clone)]
pub struct PlaceResponse {
    /// The name of its file or of the run.
    pub name: String,
    /// The measurement.
    pub measurement: Arc<Measurement>,
}

/// A calibration under way.
#[derive(Debug, Clone)]
pub struct CalibrationWizard {
    plate: Arc<Plate>,
    /// The page that is open.
    pub step: WizardPage,
    calipers: Option<Calipers>,
    places_m: [f64; 3],
    mass_note: Option<String>,
    answers: [Option<PlaceResponse>; 3],
}

impl CalibrationWizard {
    /// Starts a calibration of this plate.
    #[must_use]
    pub fn of(plate: &Arc<Plate>) -> Self {
        let (places_m, mass_note) = proposed(plate, Priors::default());
        Self {
            plate: Arc::clone(plate),
            step: WizardPage::Plate,
            calipers: None,
            places_m,
            mass_note,
            answers: [None, None, None],
        }
    }

    /// The plate as its file states it.
    #[must_use]
    pub fn plate(&self) -> &Arc<Plate> {
        &self.plate
    }

    /// The caliper measurements; `None` while the file's dimensions are used.
    #[must_use]
    pub fn calipers(&self) -> Option<Calipers> {
        self.calipers
    }

    /// The caliper measurements that agree with the plate file.
    #[must_use]
    pub fn calipers_of_file(&self) -> Calipers {
        let length_m = self.plate.length_m();
        Calipers {
            half_width_m: self.plate.cut_half_width_m(0.0),
            end_half_width_m: self.plate.cut_half_width_m(length_m),
            length_m,
            tolerance_m: CALIPERS_TOLERANCE_M,
        }
    }

    /// Uses these caliper measurements, or the file's dimensions again.
    ///
    /// # Errors
    /// Which length is out of range or gives an invalid plate. The previous dimensions then stay.
    pub fn take_calipers(&mut self, calipers: Option<Calipers>) -> Result<(), PlateError> {
        let (plate, priors) = with_calipers(&self.plate, calipers)?;
        (self.places_m, self.mass_note) = proposed(&plate, priors);
        self.calipers = calipers;
        Ok(())
    }

    /// Where the sensor has to stand, metres from the driven end, as [`SensorPlaces`] proposes for the plate: the two places, and a third
    /// as a check.
    #[must_use]
    pub fn places_m(&self) -> [f64; 3] {
        self.places_m
    }

    /// Which sensors suit this plate at these places, as sentences.
    #[must_use]
    pub fn sensor_note(&self) -> String {
        let of_masses = self.mass_note.as_deref().unwrap_or(
            "What a sensor that stands on it may weigh is not known: the file states neither a tension nor a thickness.",
        );
        format!(
            "A laser suits every plate. {of_masses} A microphone measures the sound of the whole plate, not of a place."
        )
    }

    /// The measured response at the first (0), second (1) or third (2) place.
    #[must_use]
    pub fn answer(&self, sensor: usize) -> Option<&PlaceResponse> {
        self.answers.get(sensor)?.as_ref()
    }

    /// Stores the response measured at the first (0), second (1) or third (2) place.
    pub(crate) fn take_answer(&mut self, sensor: usize, answer: PlaceResponse) {
        if let Some(place) = self.answers.get_mut(sensor) {
            *place = Some(answer);
        }
    }

    /// Does without the check of a third place.
    pub(crate) fn leave_check_out(&mut self) {
        self.answers[2] = None;
    }

    /// Swaps the two responses.
    pub fn exchange(&mut self) {
        self.answers.swap(0, 1);
    }

    /// The same responses and calipers applied to another plate's file, from the first page on.
    #[must_use]
    pub(crate) fn with_plate(self, plate: &Arc<Plate>) -> Self {
        let mut next = Self { answers: self.answers, ..Self::of(plate) };
        if let Some(calipers) = self.calipers {
            // Calipers that do not suit the other plate are dropped.
            next.take_calipers(Some(calipers)).unwrap_or_default();
        }
        next
    }

    /// Why the next page cannot be opened yet; `None` if it can.
    #[must_use]
    pub fn obstacle(&self) -> Option<&'static str> {
        let sensor = self.step.sensor().filter(|_| self.step != WizardPage::Check)?;
        self.answer(sensor)
            .is_none()
            .then_some("Measure the sensor's answer here, or open a file of it, first.")
    }

    /// The job that computes the result, once both responses exist.
    #[must_use]
    pub fn job(&self, sample_rate_hz: f64) -> Option<CalibrateJob> {
        let [Some(first), Some(second), check] = &self.answers else { return None };
        Some(CalibrateJob {
            plate: Arc::clone(&self.plate),
            calipers: self.calipers,
            sensors: [Arc::clone(&first.measurement), Arc::clone(&second.measurement)],
            check: check.as_ref().map(|check| Arc::clone(&check.measurement)),
            sample_rate_hz,
        })
    }
}

#[cfg(test)]
mod tests;

/// The proposed places of a displacement sensor on a plate, metres.
fn proposed(plate: &Plate, priors: Priors) -> ([f64; 3], Option<String>) {
    let placing = Placing { points: Wanted::of(plate).points, priors, ..Placing::default() };
    match SensorPlaces::of(plate, &placing) {
        Ok(places) => {
            let [near_m, far_m] = places.best.places_m;
            let check_m = places.check().map_or(0.5 * (near_m + far_m), |check| check.place_m);
            ([near_m, far_m, check_m], places.mass_note())
        }
        Err(_) => (PLACES.map(|share| share * plate.length_m()), None),
    }
}
