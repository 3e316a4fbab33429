//! The page of measurements: the list, and the comparison of the chosen one with the plate while the page is open.

use super::App;
use crate::intent::MeasureIntent;
use crate::scene::{LiveScene, MeasureScene};
use slipline_link::Severity;
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::response::{Entry, Shelf};
use slipline_plate::calibrate::Measurement;
use std::path::Path;
use std::sync::Arc;

/// The state of the page.
#[derive(Default)]
pub(super) struct Measures {
    shelf: Shelf,
    asked: Option<CompareJob>,
    latest: Option<Compared>,
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
        MeasureScene { shelf: &self.shelf, compared, live }
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
            MeasureIntent::Save(number) => {
                let Some(entry) = shelf.entry(number) else { return };
                let stem = Path::new(&entry.name).file_stem().unwrap_or_default().to_string_lossy();
                let (name, text) = (format!("{stem}.csv"), entry.measurement.to_csv());
                self.save(&name, "Measurement", "csv", text.into_bytes());
            }
        }
    }

    /// Takes the text of a measurement's file, and opens its page.
    pub(super) fn open_measurement(&mut self, name: &str, text: &str) {
        let read = Measurement::from_csv(text).map_err(|error| error.to_string());
        match read.and_then(|measurement| self.measures.shelf.add(name, measurement)) {
            Ok(number) => {
                if !self.answered(number) {
                    self.view.open_measure();
                }
                self.note(Severity::Info, format!("Opened {name}."));
                self.notices.tell(format!("Opened {name}"));
            }
            Err(reason) => self.not_opened(name, &reason),
        }
    }
}
