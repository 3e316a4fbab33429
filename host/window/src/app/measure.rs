//! The page of measurements: the list, and the comparison of the chosen one with the plate while the page is open.

use super::App;
use crate::files::FileJob;
use crate::intent::MeasureIntent;
use crate::scene::{Asked, LiveScene, MeasureScene};
use slipline_link::Severity;
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::measured_file::{self, Told};
use slipline_model::response::{Entry, Shelf};
use slipline_plate::calibrate::{File, Measurement};
use std::path::Path;
use std::sync::Arc;

/// The state of the page.
#[derive(Default)]
pub(super) struct Measures {
    shelf: Shelf,
    asked: Option<CompareJob>,
    latest: Option<Compared>,
    /// A file by another program that waits for what it does not tell.
    foreign: Option<Asked>,
}

impl Measures {
    /// The measurement of this number.
    pub(super) fn entry(&self, number: u64) -> Option<&Entry> {
        self.shelf.entry(number)
    }

    pub(super) fn take(&mut self, compared: Compared) {
        self.latest = Some(compared);
    }

    /// Adds a measurement to the list; its number.
    pub(super) fn add(&mut self, name: &str, measurement: Measurement) -> Result<u64, String> {
        self.shelf.add(name, measurement)
    }

    pub(super) fn scene<'a>(&'a self, live: LiveScene<'a>) -> MeasureScene<'a> {
        let compared = self.latest.as_ref().filter(|latest| Some(&latest.job) == self.asked.as_ref());
        MeasureScene { shelf: &self.shelf, compared, asked: self.foreign.as_ref(), live }
    }
}

impl App {
    /// Compares the chosen measurement with the plate on the screen while the page is open.
    pub(super) fn update_measures(&mut self) {
        let Some(chosen) = self.measures.shelf.chosen().filter(|_| self.view.is_measuring()) else { return };
        let job =
            CompareJob { plate: Arc::clone(&self.setup.plate), measurement: Arc::clone(&chosen.measurement) };
        if self.measures.asked.as_ref() != Some(&job) {
            self.measures.asked = Some(job.clone());
            self.parts.comparisons.ask(job);
        }
    }

    pub(super) fn perform_measure(&mut self, intent: MeasureIntent) {
        let shelf = &mut self.measures.shelf;
        match intent {
            MeasureIntent::Choose(number) => shelf.choose(number),
            MeasureIntent::Show(number, is_shown) => shelf.show(number, is_shown),
            MeasureIntent::Remove(number) => shelf.remove(number),
            MeasureIntent::Draft(draft) => self.live.draft(draft),
            MeasureIntent::Begin(answers) => self.begin_measuring(answers),
            MeasureIntent::Secret(is_secret) => self.choose_truth(is_secret),
            MeasureIntent::Cancel => self.cancel_measuring(),
            MeasureIntent::OpenFile => self.parts.files.begin(FileJob::ChooseMeasurement),
            MeasureIntent::Tell(told) => {
                if let Some(asked) = &mut self.measures.foreign {
                    (asked.told, asked.refused) = (told, None);
                }
            }
            MeasureIntent::TakeAsked => self.take_asked(),
            MeasureIntent::LeaveAsked => self.measures.foreign = None,
            MeasureIntent::Save(number) => {
                let Some(entry) = shelf.entry(number) else { return };
                let stem = Path::new(&entry.name).file_stem().unwrap_or_default().to_string_lossy();
                let (name, text) = (format!("{stem}.csv"), entry.measurement.to_csv());
                self.save(&name, "Measurement", "csv", text.into_bytes());
            }
        }
    }

    /// Takes a measurement's file, and opens its page. By another program, it is asked what the file does not tell.
    pub(super) fn open_measurement(&mut self, name: &str, bytes: &[u8]) {
        match File::read(bytes) {
            Ok(File::Own(measurement)) => {
                if let Err(reason) = self.take_opened(name, measurement) {
                    self.not_opened(name, &reason);
                }
            }
            Ok(File::Foreign(foreign)) => {
                // In the calibration the sensor is where its pages have it put.
                let place_m = self.calibrating.place_m().unwrap_or(self.live.place_m());
                let told = Told::by(&foreign, place_m);
                self.measures.foreign = Some(Asked { name: name.to_owned(), foreign, told, refused: None });
                if self.dialog.is_none() {
                    self.view.open_measure();
                }
            }
            Err(error) => self.not_opened(name, &error.to_string()),
        }
    }

    /// Takes the file that waits, as it was told; what is wrong is said where it was told.
    fn take_asked(&mut self) {
        let Some(asked) = self.measures.foreign.take() else { return };
        let measured = measured_file::measurement(&self.setup.plate, &asked.foreign, &asked.told);
        let taken = measured.map_err(|error| error.to_string());
        if let Err(reason) = taken.and_then(|measurement| self.take_opened(&asked.name, measurement)) {
            self.measures.foreign = Some(Asked { refused: Some(reason), ..asked });
        }
    }

    fn take_opened(&mut self, name: &str, measurement: Measurement) -> Result<(), String> {
        let number = self.measures.shelf.add(name, measurement)?;
        if !self.answered(number) {
            self.view.open_measure();
        }
        self.note(Severity::Info, format!("Opened {name}."));
        self.notices.tell(format!("Opened {name}"));
        Ok(())
    }
}
