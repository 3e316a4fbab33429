//! The page of measurements: the list, and the comparison of the chosen one with the plate while the page is open.

use super::plate_lists::PlateLists;
use super::{Lab, MeasureIntent, Reach};
use crate::instrument::outbox::Outbox;
use crate::instrument::shell::{Attention, Output, Page};
use crate::instrument::shown::{Asked, AskedContent, AskedTable, LiveScene, MeasureScene};
use crate::instrument::work::Jobs;
use crate::jobs::recorded::{Recorded, RecordedJob};
use crate::measure::PlayedSweep;
use crate::measured_file::{self, ForeignError, ForeignMetadata, OpenError, Opened, RecordingMetadata};
use slipline_link::Severity;
use slipline_model::content::Content;
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::jobs::{JobQueue, LatestResult};
use slipline_model::response::{Entry, ShelfFull};
use slipline_plate::Plate;
use slipline_plate::calibrate::{File, FileError, Measurement, SNR_DB};
use slipline_plate::text_table::{Quantity, UnclearColumn};
use std::mem::take;
use std::path::Path;
use std::sync::Arc;

/// The state of the page.
pub(super) struct Measurements {
    pub(super) lists: PlateLists,
    /// A file by another program whose metadata the user has to complete.
    foreign: Option<Asked>,
    /// Name and description of the latest sweep, for the recordings that follow.
    sweep: Option<(String, Arc<PlayedSweep>)>,
    comparisons: LatestResult<CompareJob, Compared>,
    recordings: JobQueue<RecordedJob, Recorded>,
}

/// Why a file by another program was not accepted as a measurement.
#[derive(Debug, thiserror::Error)]
enum NotTaken {
    #[error(transparent)]
    ForeignError(#[from] ForeignError),
    #[error(transparent)]
    Full(#[from] ShelfFull),
}

impl Measurements {
    /// No measurement of this plate; it takes its queues from `jobs`.
    pub(super) fn new(plate: &Plate, jobs: &mut Jobs) -> Self {
        Self {
            lists: PlateLists::new(plate),
            foreign: None,
            sweep: None,
            comparisons: LatestResult::of(take(&mut jobs.comparisons)),
            recordings: take(&mut jobs.recordings),
        }
    }

    /// The measurement of this number.
    pub(super) fn entry(&self, number: u64) -> Option<&Entry> {
        self.lists.shelf().entry(number)
    }

    /// Adds a measurement to the list; returns its number.
    pub(super) fn add(&mut self, name: &str, measurement: Measurement) -> Result<u64, ShelfFull> {
        self.lists.shelf_mut().add(name, measurement)
    }

    /// The measurements that are drawn.
    pub(super) fn drawn(&self) -> impl Iterator<Item = &Arc<Measurement>> {
        self.lists.shelf().entries().iter().filter(|entry| entry.is_shown).map(|entry| &entry.measurement)
    }

    pub(super) fn scene<'a>(&'a self, live: LiveScene<'a>) -> MeasureScene<'a> {
        let asked = self.comparisons.asked().zip(self.lists.shelf().chosen());
        let is_of_chosen = asked.is_some_and(|(job, it)| Arc::ptr_eq(&job.measurement, &it.measurement));
        let compared = self.comparisons.current().filter(|_| is_of_chosen).map(Result::as_ref);
        MeasureScene { shelf: self.lists.shelf(), compared, asked: self.foreign.as_ref(), live }
    }

    /// Stores a comparison; returns a recording that has been read.
    pub(super) fn take_results(&mut self) -> Option<Recorded> {
        self.comparisons.take();
        self.recordings.take()
    }

    /// Compares the chosen measurement with the plate on the screen while the page is open.
    pub(super) fn compare(&mut self, plate: &Arc<Plate>, attention: &Attention) {
        let Some(chosen) = self.lists.shelf().chosen().filter(|_| attention.is_measurements_open) else {
            return;
        };
        let (plate, measurement) = (Arc::clone(plate), Arc::clone(&chosen.measurement));
        self.comparisons.ask(CompareJob { plate, measurement });
    }

    /// Asks for the model's answers to a measurement that is under way.
    pub(super) fn ask_model(&mut self, planned: &CompareJob) {
        self.comparisons.ask(planned.clone());
    }

    /// The model's answers to it, if it was asked last and is computed.
    pub(super) fn model(&self, planned: &CompareJob) -> Option<&Compared> {
        self.comparisons.current().filter(|_| self.comparisons.asked() == Some(planned))
    }

    /// Asks the user for the metadata of a file.
    fn ask(&mut self, name: &str, content: AskedContent, metadata: ForeignMetadata, refused: Option<String>) {
        let name = name.to_owned();
        self.recordings.cancel();
        self.foreign = Some(Asked { name, content, metadata, channel: 1, refused });
    }

    /// Reads the waiting table with another meaning of a column.
    fn choose_column(&mut self, at: usize, meaning: Option<(Quantity, &str)>) {
        let Some(Asked { content: AskedContent::Table(table), metadata, refused, .. }) = &mut self.foreign
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

    /// Reads the waiting file with the stated metadata; a recording is read in the background.
    fn read_asked(&mut self, plate: &Arc<Plate>) -> Option<Result<Measurement, ForeignError>> {
        let asked = self.foreign.as_mut()?;
        match &mut asked.content {
            AskedContent::Table(AskedTable { foreign: Some(foreign), .. }) => {
                return Some(measured_file::measurement(plate, foreign, &asked.metadata));
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
                self.recordings.ask(RecordedJob { plate, wav, sweep, metadata });
            }
            AskedContent::Recording { sweep: None, .. } => {
                asked.refused = Some("Open the description of its sweep first.".to_owned());
            }
        }
        None
    }
}

impl Lab {
    /// Carries out a request of the page of measurements.
    pub(crate) fn perform_measure(&mut self, intent: MeasureIntent, reach: &mut Reach<'_>) {
        let shelf = self.measurements.lists.shelf_mut();
        match intent {
            MeasureIntent::Choose(number) => shelf.choose(number),
            MeasureIntent::Show(number, is_shown) => shelf.show(number, is_shown),
            MeasureIntent::Remove(number) => shelf.remove(number),
            MeasureIntent::Draft(draft) => self.live.draft = draft,
            MeasureIntent::Begin(answers) => self.begin_measuring(answers, reach),
            MeasureIntent::Secret(is_secret) => {
                self.rig.choose(is_secret, reach.desk.plate(), reach.out);
                self.measurements.lists.turn_to(reach.desk.plate(), self.rig.draw());
            }
            MeasureIntent::Tap => self.rig.tap(),
            MeasureIntent::Harmonics => self.begin_harmonics(reach),
            MeasureIntent::Verify => self.begin_verification(reach),
            MeasureIntent::SelftestDraft(request) => self.board_test.request = request,
            MeasureIntent::Selftest => self.begin_selftest(reach),
            MeasureIntent::Cancel => self.cancel_measuring(),
            MeasureIntent::OpenFile => reach.out.push(Output::ChooseMeasurement),
            MeasureIntent::Describe(metadata) => {
                if let Some(asked) = &mut self.measurements.foreign {
                    (asked.metadata, asked.refused) = (metadata, None);
                }
            }
            MeasureIntent::Column(at, meaning) => self.measurements.choose_column(at, meaning),
            MeasureIntent::Channel(channel) => {
                if let Some(asked) = &mut self.measurements.foreign {
                    (asked.channel, asked.refused) = (channel, None);
                }
            }
            MeasureIntent::TakeAsked => {
                if let Some(measured) = self.measurements.read_asked(reach.desk.plate()) {
                    self.take_asked(measured, reach);
                }
            }
            MeasureIntent::LeaveAsked => {
                self.measurements.foreign = None;
                self.measurements.recordings.cancel();
            }
            MeasureIntent::Save(number) => {
                let Some(entry) = shelf.entry(number) else { return };
                let stem = Path::new(&entry.name).file_stem().unwrap_or_default().to_string_lossy();
                let (name, text) = (format!("{stem}.csv"), entry.measurement.to_csv());
                reach.out.save(&name, "Measurement", "csv", text);
            }
        }
    }

    /// Reads a sweep's description, for the waiting recording and later ones; returns whether the text is
    /// one.
    pub(crate) fn opened_sweep(&mut self, name: &str, text: &str, out: &mut Outbox) -> bool {
        if !PlayedSweep::is_one(text) {
            return false;
        }
        match PlayedSweep::from_toml(text) {
            Ok(played) => {
                let played = Some((name.to_owned(), Arc::new(played)));
                self.measurements.sweep.clone_from(&played);
                if let Some(Asked { content: AskedContent::Recording { sweep, .. }, refused, .. }) =
                    &mut self.measurements.foreign
                {
                    (*sweep, *refused) = (played, None);
                }
                out.post(format!("Opened {name}: the sweep of the recordings"));
            }
            Err(error) => out.not_opened(name, &error),
        }
        true
    }

    /// Reads a measurement's file and opens its page. The user is asked for metadata that a file by another
    /// program lacks.
    pub(crate) fn open_measurement(&mut self, name: &str, bytes: Vec<u8>, reach: &mut Reach<'_>) {
        if let Ok(text) = str::from_utf8(&bytes)
            && self.opened_sweep(name, text, reach.out)
        {
            return;
        }
        // The assumed sensor place of a file: in a calibration that of its open page.
        let place_m = self.calibration.place_m().unwrap_or(self.live.draft.place_m);
        // A table is read again with the user's answers; a recording is not, so its bytes are not copied.
        let is_text = Content::of(&bytes) == Content::Other;
        let kept: Arc<[u8]> = if is_text { Arc::from(&bytes[..]) } else { Arc::from([]) };
        let unknown = ForeignMetadata { place_m, kind: None, snr_db: SNR_DB };
        let mut refused = None;
        let (content, metadata) = match Opened::read(bytes, &[]) {
            Ok(Opened::Own(measurement)) => {
                if let Err(error) = self.take_opened(name, measurement, reach) {
                    reach.out.not_opened(name, &error);
                }
                return;
            }
            Ok(Opened::Foreign(foreign)) => {
                let metadata = ForeignMetadata::by(&foreign, place_m);
                let columns = foreign.columns.clone();
                (AskedContent::Table(AskedTable { bytes: kept, columns, foreign: Some(foreign) }), metadata)
            }
            Err(OpenError::File(FileError::Columns(unclear))) => {
                let columns = unclear.columns.iter().map(UnclearColumn::left_out).collect();
                refused = Some(unclear.to_string());
                (AskedContent::Table(AskedTable { bytes: kept, columns, foreign: None }), unknown)
            }
            Ok(Opened::Recording(wav)) => {
                let sweep = self.measurements.sweep.clone();
                let content = AskedContent::Recording { wav: Arc::new(wav), sweep, is_read: false };
                (content, unknown)
            }
            Err(error) => return reach.out.not_opened(name, &error),
        };
        self.measurements.ask(name, content, metadata, refused);
        if !reach.attention.has_page {
            reach.out.open(Page::Measurements);
        }
    }

    /// Handles the result of reading a recording.
    pub(super) fn take_recorded(&mut self, recorded: Recorded, reach: &mut Reach<'_>) {
        if let Some(Asked { content: AskedContent::Recording { is_read, .. }, .. }) =
            &mut self.measurements.foreign
        {
            *is_read = false;
        }
        let measured = recorded.map(|(measurement, notes)| {
            for note in notes {
                reach.drive.note(Severity::Info, note);
            }
            measurement
        });
        self.take_asked(measured, reach);
    }

    /// Closes the waiting file, or shows beside its metadata why it was refused.
    fn take_asked(&mut self, measured: Result<Measurement, ForeignError>, reach: &mut Reach<'_>) {
        let Some(asked) = self.measurements.foreign.take() else { return };
        let taken = measured.map_err(NotTaken::from);
        let taken = taken.and_then(|measurement| Ok(self.take_opened(&asked.name, measurement, reach)?));
        if let Err(error) = taken {
            self.measurements.foreign = Some(Asked { refused: Some(error.to_string()), ..asked });
        }
    }

    fn take_opened(
        &mut self,
        name: &str,
        measurement: Measurement,
        reach: &mut Reach<'_>,
    ) -> Result<(), ShelfFull> {
        let number = self.measurements.add(name, measurement)?;
        if !self.answered(number, reach.attention.is_calibration_open) {
            reach.out.open(Page::Measurements);
        }
        reach.out.post(format!("Opened {name}"));
        Ok(())
    }
}
