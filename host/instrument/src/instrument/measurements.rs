//! The page of measurements: the list, and the comparison of the chosen one with the plate while the page is open.

use super::Instrument;
use super::shown::{Asked, AskedContent, AskedTable, LiveScene, MeasureScene};
use super::{MeasureIntent, Output, Page};
use crate::jobs::recorded::{Recorded, RecordedJob};
use crate::measure::PlayedSweep;
use crate::measured_file::{self, ForeignError, ForeignMetadata, OpenError, Opened, RecordingMetadata};
use slipline_link::Severity;
use slipline_model::content::Content;
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::response::{Entry, Shelf, ShelfFull};
use slipline_plate::calibrate::{File, FileError, Measurement, SNR_DB};
use slipline_plate::text_table::{ColumnRead, Quantity};
use std::path::Path;
use std::sync::Arc;

/// The state of the page.
#[derive(Default)]
pub(crate) struct Measures {
    shelf: Shelf,
    asked: Option<CompareJob>,
    pub(crate) latest: Option<Compared>,
    /// A file by another program whose metadata the user has to complete.
    foreign: Option<Asked>,
    /// Name and description of the latest sweep, for the recordings that follow.
    sweep: Option<(String, Arc<PlayedSweep>)>,
}

/// Why a file by another program was not accepted as a measurement.
#[derive(Debug, thiserror::Error)]
enum NotTaken {
    #[error(transparent)]
    ForeignError(#[from] ForeignError),
    #[error(transparent)]
    Full(#[from] ShelfFull),
}

impl Measures {
    /// The measurement of this number.
    pub(crate) fn entry(&self, number: u64) -> Option<&Entry> {
        self.shelf.entry(number)
    }

    /// Adds a measurement to the list; returns its number.
    pub(crate) fn add(&mut self, name: &str, measurement: Measurement) -> Result<u64, ShelfFull> {
        self.shelf.add(name, measurement)
    }

    /// The measurements that are drawn.
    pub(crate) fn shown(&self) -> impl Iterator<Item = &Arc<Measurement>> {
        self.shelf.entries().iter().filter(|entry| entry.is_shown).map(|entry| &entry.measurement)
    }

    pub(crate) fn scene<'a>(&'a self, live: LiveScene<'a>) -> MeasureScene<'a> {
        let compared = self.latest.as_ref().filter(|latest| Some(&latest.job) == self.asked.as_ref());
        MeasureScene { shelf: &self.shelf, compared, asked: self.foreign.as_ref(), live }
    }
}

impl Instrument {
    /// Compares the chosen measurement with the plate on the screen while the page is open.
    pub(crate) fn update_measures(&mut self) {
        let Some(chosen) = self.measures.shelf.chosen().filter(|_| self.attention.is_measurements_open)
        else {
            return;
        };
        let job =
            CompareJob { plate: Arc::clone(&self.setup.plate), measurement: Arc::clone(&chosen.measurement) };
        if self.measures.asked.as_ref() != Some(&job) {
            self.measures.asked = Some(job.clone());
            self.jobs.comparisons.ask(job);
        }
    }

    /// Carries out a request of the page of measurements.
    pub fn perform_measure(&mut self, intent: MeasureIntent) {
        let shelf = &mut self.measures.shelf;
        match intent {
            MeasureIntent::Choose(number) => shelf.choose(number),
            MeasureIntent::Show(number, is_shown) => shelf.show(number, is_shown),
            MeasureIntent::Remove(number) => shelf.remove(number),
            MeasureIntent::Draft(draft) => self.live.draft = draft,
            MeasureIntent::Begin(answers) => self.begin_measuring(answers),
            MeasureIntent::Secret(is_secret) => self.choose_truth(is_secret),
            MeasureIntent::Tap => self.bench.tap(),
            MeasureIntent::Cancel => self.cancel_measuring(),
            MeasureIntent::OpenFile => self.outputs.push(Output::ChooseMeasurement),
            MeasureIntent::Describe(metadata) => {
                if let Some(asked) = &mut self.measures.foreign {
                    (asked.metadata, asked.refused) = (metadata, None);
                }
            }
            MeasureIntent::Column(at, meaning) => self.choose_column(at, meaning),
            MeasureIntent::Channel(channel) => {
                if let Some(asked) = &mut self.measures.foreign {
                    (asked.channel, asked.refused) = (channel, None);
                }
            }
            MeasureIntent::TakeAsked => self.take_asked(),
            MeasureIntent::LeaveAsked => {
                self.measures.foreign = None;
                self.jobs.recordings.cancel();
            }
            MeasureIntent::Save(number) => {
                let Some(entry) = shelf.entry(number) else { return };
                let stem = Path::new(&entry.name).file_stem().unwrap_or_default().to_string_lossy();
                let (name, text) = (format!("{stem}.csv"), entry.measurement.to_csv());
                self.save(&name, "Measurement", "csv", text.into_bytes());
            }
        }
    }

    /// Reads a measurement's file and opens its page. The user is asked for metadata that a file by another
    /// program lacks.
    pub fn open_measurement(&mut self, name: &str, bytes: Vec<u8>) {
        if let Ok(text) = str::from_utf8(&bytes)
            && self.opened_sweep(name, text)
        {
            return;
        }
        // A recording is not copied.
        let is_text = Content::of(&bytes) == Content::Other;
        let kept: Arc<[u8]> = if is_text { Arc::from(&bytes[..]) } else { Arc::from([]) };
        match Opened::read(bytes, &[]) {
            Ok(Opened::Own(measurement)) => {
                if let Err(error) = self.take_opened(name, measurement) {
                    self.not_opened(name, &error);
                }
            }
            Ok(Opened::Foreign(foreign)) => {
                let metadata = ForeignMetadata::by(&foreign, self.asked_place_m());
                let columns = foreign.columns.clone();
                let table = AskedTable { bytes: kept, columns, foreign: Some(foreign) };
                self.ask(name, AskedContent::Table(table), metadata);
            }
            Err(OpenError::File(FileError::Columns(unclear))) => {
                let column = |name: &String| ColumnRead {
                    name: name.trim_matches('*').to_owned(),
                    quantity: None,
                    unit: None,
                };
                let columns = unclear.columns.iter().map(column).collect();
                let metadata = ForeignMetadata { place_m: self.asked_place_m(), kind: None, snr_db: SNR_DB };
                self.ask(
                    name,
                    AskedContent::Table(AskedTable { bytes: kept, columns, foreign: None }),
                    metadata,
                );
                if let Some(asked) = &mut self.measures.foreign {
                    asked.refused = Some(unclear.to_string());
                }
            }
            Ok(Opened::Recording(wav)) => {
                let metadata = ForeignMetadata { place_m: self.asked_place_m(), kind: None, snr_db: SNR_DB };
                let sweep = self.measures.sweep.clone();
                self.ask(
                    name,
                    AskedContent::Recording { wav: Arc::new(wav), sweep, is_read: false },
                    metadata,
                );
            }
            Err(error) => self.not_opened(name, &error),
        }
    }

    /// The assumed sensor place of a file: in a calibration that of its open page.
    fn asked_place_m(&self) -> f64 {
        self.calibrating.place_m().unwrap_or(self.live.draft.place_m)
    }

    fn ask(&mut self, name: &str, content: AskedContent, metadata: ForeignMetadata) {
        let name = name.to_owned();
        self.jobs.recordings.cancel();
        self.measures.foreign = Some(Asked { name, content, metadata, channel: 1, refused: None });
        if !self.attention.has_page {
            self.outputs.push(Output::Open(Page::Measurements));
        }
    }

    /// Reads a sweep's description, for the waiting recording and later ones; returns whether the text is
    /// one.
    pub fn opened_sweep(&mut self, name: &str, text: &str) -> bool {
        if !PlayedSweep::is_one(text) {
            return false;
        }
        match PlayedSweep::from_toml(text) {
            Ok(played) => {
                let played = Some((name.to_owned(), Arc::new(played)));
                self.measures.sweep.clone_from(&played);
                if let Some(Asked { content: AskedContent::Recording { sweep, .. }, refused, .. }) =
                    &mut self.measures.foreign
                {
                    (*sweep, *refused) = (played, None);
                }
                self.notices.post(format!("Opened {name}: the sweep of the recordings"));
            }
            Err(error) => self.not_opened(name, &error),
        }
        true
    }

    /// Reads the waiting table with another meaning of a column.
    fn choose_column(&mut self, at: usize, meaning: Option<(Quantity, &str)>) {
        let Some(Asked { content: AskedContent::Table(table), metadata, refused, .. }) =
            &mut self.measures.foreign
        else {
            return;
        };
        if let Some((of, _)) = meaning {
            // The column that was it before is left out.
            for column in table.columns.iter_mut().filter(|column| column.quantity == Some(of.word())) {
                (column.quantity, column.unit) = (None, None);
            }
        }
        if let Some(column) = table.columns.get_mut(at) {
            column.quantity = meaning.map(|it| it.0.word());
            column.unit = meaning.map(|it| it.1.to_owned()).filter(|unit| !unit.is_empty());
        }
        let chosen: Vec<_> = table.columns.iter().enumerate().filter_map(|(at, it)| it.chosen(at)).collect();
        (table.foreign, *refused) = match File::read(&table.bytes, &chosen) {
            Ok(File::Foreign(foreign)) => (Some(foreign), None),
            Ok(File::Own(_)) => (None, None),
            Err(error) => (None, Some(error.to_string())),
        };
        metadata.kind = metadata.kind.or(table.foreign.as_ref().and_then(|foreign| foreign.sensor));
    }

    /// Accepts the waiting file with the stated metadata; an error is shown beside them.
    fn take_asked(&mut self) {
        let plate = &self.setup.plate;
        let Some(asked) = &mut self.measures.foreign else { return };
        match &mut asked.content {
            AskedContent::Table(AskedTable { foreign: Some(foreign), .. }) => {
                let measured = measured_file::measurement(plate, foreign, &asked.metadata);
                self.take_asked_measurement(measured);
            }
            AskedContent::Table(AskedTable { foreign: None, .. }) => {
                asked.refused = Some("Choose what its columns are first.".to_owned());
            }
            AskedContent::Recording { wav, sweep: Some((_, sweep)), is_read } => {
                *is_read = true;
                asked.refused = None;
                let ForeignMetadata { place_m, kind, .. } = asked.metadata;
                let metadata = RecordingMetadata { place_m, kind, channel: asked.channel };
                let (plate, wav, sweep) = (Arc::clone(plate), Arc::clone(wav), Arc::clone(sweep));
                self.jobs.recordings.ask(RecordedJob { plate, wav, sweep, metadata });
            }
            AskedContent::Recording { sweep: None, .. } => {
                asked.refused = Some("Open the description of its sweep first.".to_owned());
            }
        }
    }

    /// Handles the result of reading a recording.
    pub(crate) fn take_recorded(&mut self, recorded: Recorded) {
        if let Some(Asked { content: AskedContent::Recording { is_read, .. }, .. }) =
            &mut self.measures.foreign
        {
            *is_read = false;
        }
        let measured = recorded.map(|(measurement, notes)| {
            for note in notes {
                self.note(Severity::Info, note);
            }
            measurement
        });
        self.take_asked_measurement(measured);
    }

    /// Closes the waiting file, or shows beside its metadata why it was refused.
    fn take_asked_measurement(&mut self, measured: Result<Measurement, ForeignError>) {
        let Some(asked) = self.measures.foreign.take() else { return };
        let taken = measured.map_err(NotTaken::from);
        let taken = taken.and_then(|measurement| Ok(self.take_opened(&asked.name, measurement)?));
        if let Err(error) = taken {
            self.measures.foreign = Some(Asked { refused: Some(error.to_string()), ..asked });
        }
    }

    fn take_opened(&mut self, name: &str, measurement: Measurement) -> Result<(), ShelfFull> {
        let number = self.measures.shelf.add(name, measurement)?;
        if !self.answered(number) {
            self.outputs.push(Output::Open(Page::Measurements));
        }
        self.notices.post(format!("Opened {name}"));
        Ok(())
    }
}
