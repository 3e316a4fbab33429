//! What an instrument shows: the setup, the plate, the device, and how work stands.

use super::{DragRecorder, MeasureDraft};
use crate::calibration::CalibrationWizard;
use crate::hold::{Holding, Standing};
use crate::jobs::calibrate::{CalibrationResult, Refused};
use crate::measure::{PlayedSweep, Signal};
use crate::measured_file::ForeignMetadata;
use slipline_link::Snapshot;
use slipline_model::field::felt::Felt;
use slipline_model::field::line::Line;
use slipline_model::field::sheet::{FieldSource, Frame};
use slipline_model::field::steady_field::SteadyField;
use slipline_model::field::time_domain::SimulatedField;
use slipline_model::field::touch::{Touch, Trace};
use slipline_model::jobs::check::{CheckJob, Checked};
use slipline_model::jobs::compare::Compared;
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::plane::{PlaneChecked, PlaneJob};
use slipline_model::jobs::table::TableState;
use slipline_model::jobs::texture::Textured;
use slipline_model::response::Shelf;
use slipline_model::setup::Setup;
use slipline_model::setup::compare::Compare;
use slipline_model::texture::WishDraft;
use slipline_model::wav::Wav;
use slipline_model::waveform::Waveform;
use slipline_plate::calibrate::{CalibrateError, Comparison, Foreign};
use slipline_plate::{DriveTable, Finger};
use std::fmt;
use std::sync::Arc;

/// Everything that an instrument shows.
pub struct Shown<'a> {
    /// The user's setup.
    pub setup: &'a Setup,
    /// The slot of the tone that the boundary panel and the arrow keys change.
    pub selected: u8,
    /// The state of link and device.
    pub snapshot: &'a Snapshot,
    /// Whether the user wants the plate driven.
    pub drive_wanted: bool,
    /// The finger that is chosen.
    pub touch: Touch,
    /// The finger on the plate, if there is one.
    pub finger: Option<Finger>,
    /// What the finger has met in the last seconds.
    pub trace: &'a Trace,
    /// The plate under the setup's tones; with unit height while `full_peak_m` is not known.
    pub predicted: &'a SteadyField,
    /// What is felt of the setup's tones, by a finger that comes; `None` while `full_peak_m` is not known.
    pub felt: Option<&'a Felt>,
    /// The boundary line of each tone, in their order.
    pub lines: &'a [Line],
    /// The places that the line of the selected tone can have, in metres.
    pub limits_m: (f64, f64),
    /// The plate under the tones that the device has acknowledged and sounds.
    pub sounding: Option<&'a SteadyField>,
    /// The peak at level 1 in metres; `None` until the table for the plate is finished.
    pub full_peak_m: Option<f64>,
    /// The same table in physical units; `None` until it is finished.
    pub drive_table: Option<&'a DriveTable>,
    /// The table for the setup's plate.
    pub table: &'a TableState,
    /// The codes that the mirror has replayed.
    pub waveform: &'a Waveform,
    /// The simulated plate once it has settled, and whether it did so under the tones that sound now.
    pub measured: Option<(&'a SimulatedField, bool)>,
    /// The lights, the designer and what the wave is drawn from.
    pub background: &'a Background,
    /// The texture page.
    pub texture: TextureScene<'a>,
    /// The page of measurements.
    pub measure: MeasureScene<'a>,
    /// The level hold.
    pub hold: HoldScene<'a>,
    /// The calibration under way.
    pub calibration: Option<CalibrateScene<'a>>,
    /// The plate and boundary that would be computed in two dimensions.
    pub plane_job: Option<PlaneJob>,
    /// The sheet, if the wave is drawn from it.
    pub sheet: Option<&'a Frame>,
    /// The work that the user waits for.
    pub waiting: Option<Waiting>,
    /// Messages to the user.
    pub notices: Vec<&'a Notice>,
    /// The two setups that are compared.
    pub compare: &'a Compare,
    /// The recorded drag.
    pub recorder: &'a DragRecorder,
    /// The names of the changes that undo and redo would affect.
    pub undo: (Option<&'static str>, Option<&'static str>),
    /// Seconds of slow motion so far; constant while the wave is paused.
    pub wave_time_s: f64,
}

impl Shown<'_> {
    /// The boundary line of the tone in a slot.
    #[must_use]
    pub fn line(&self, slot: u8) -> Option<&Line> {
        self.lines.iter().find(|line| line.slot == slot)
    }

    /// The CRC of the table for the plate on the screen.
    #[must_use]
    pub fn table_crc(&self) -> Option<u32> {
        self.table.made().map(|made| made.device_table.crc())
    }

    /// Whether the device's table differs from the one for the plate on the screen.
    #[must_use]
    pub fn is_table_dirty(&self) -> bool {
        let on_device = self.snapshot.table.active.map(|header| header.crc);
        self.snapshot.is_connected() && self.table_crc().is_some_and(|crc| on_device != Some(crc))
    }

    /// The largest possible sum of all tones, as a share of the DAC's full scale.
    #[must_use]
    pub fn headroom_sum(&self) -> f64 {
        self.table.headroom_sum(self.setup)
    }
}

/// The results of the background work.
#[derive(Default)]
pub struct Background {
    /// The latest lights, with the plate and boundary they belong to.
    pub checked: Option<Checked>,
    /// The latest request for lights.
    pub asked: Option<CheckJob>,
    /// The latest request for the plate in two dimensions; `None` if that was cancelled.
    pub plane_asked: Option<PlaneJob>,
    /// The latest result in two dimensions, with the plate and boundary it belongs to.
    pub plane: Option<PlaneChecked>,
    /// The draft in the designer.
    pub draft: Draft,
    /// The result of the draft.
    pub design: DesignState,
    /// The source from which the wave is drawn.
    pub source: Option<FieldSource>,
}

impl Background {
    /// Whether the lights are those of the plate and boundary on the screen.
    #[must_use]
    pub fn is_checked(&self) -> bool {
        self.checked.as_ref().map(|checked| &checked.job) == self.asked.as_ref()
    }
}

/// The texture page: what is wanted, and what was made of it.
#[derive(Clone, Copy)]
pub struct TextureScene<'a> {
    /// What is wanted.
    pub draft: &'a WishDraft,
    /// The latest result.
    pub latest: Option<&'a Textured>,
    /// Whether that is of the draft.
    pub is_current: bool,
    /// Whether the user has given the draft up.
    pub is_given_up: bool,
}

/// The page of measurements.
#[derive(Clone, Copy)]
pub struct MeasureScene<'a> {
    /// The measurements.
    pub shelf: &'a Shelf,
    /// The chosen one beside the model of the plate on the screen; `None` until that is computed.
    pub compared: Option<&'a Compared>,
    /// A file by another program that waits for what it does not tell.
    pub asked: Option<&'a Asked>,
    /// The measurement with the device.
    pub live: LiveScene<'a>,
}

/// A file by another program that waits for what it does not tell.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The name of the file.
    pub name: String,
    /// What is in it.
    pub content: AskedContent,
    /// What the user has stated so far.
    pub metadata: ForeignMetadata,
    /// The sensor's channel in a recording, from 1.
    pub channel: usize,
    /// Why it was no measurement as it was stated last.
    pub refused: Option<String>,
}

/// What is in a file that waits.
#[derive(Clone, Debug)]
pub enum AskedContent {
    /// Frequencies and responses.
    Table(Foreign),
    /// A recording of the sweep.
    Recording {
        /// The sound.
        wav: Arc<Wav>,
        /// The name of the sweep's description, and what is in it; `None` while nobody has opened one.
        sweep: Option<(String, Arc<PlayedSweep>)>,
        /// Whether it is being read.
        is_read: bool,
    },
}

/// The measurement with the device.
#[derive(Clone, Copy)]
pub struct LiveScene<'a> {
    /// What is to be measured.
    pub draft: &'a MeasureDraft,
    /// The share that is done, 0..=1, while one is under way.
    pub progress: Option<f32>,
    /// Whether it is still being checked that the drive is on.
    pub is_checking: bool,
    /// Whether the rig of the simulated device states what the drive is.
    pub is_drive_known: bool,
    /// Why the last one was none, until the next one begins.
    pub failed: Option<&'a str>,
    /// What the sensor shows now, while a page wants to know.
    pub signal: Option<Signal>,
    /// Whether the simulated device stands on a plate that nobody knows.
    pub is_secret: bool,
}

impl<'a> MeasureScene<'a> {
    /// How the chosen measurement differs from the plate's model, or why that cannot be said; `None` until it is computed.
    #[must_use]
    pub fn result(&self) -> Option<Result<&'a Comparison, &'a CalibrateError>> {
        let chosen = self.shelf.chosen()?;
        let compared = self.compared.filter(|it| Arc::ptr_eq(&it.job.measurement, &chosen.measurement))?;
        Some(compared.result.as_ref())
    }

    /// How the chosen measurement differs from the plate's model, where that is known.
    #[must_use]
    pub fn comparison(&self) -> Option<&'a Comparison> {
        self.result()?.ok()
    }
}

/// The level hold.
#[derive(Clone, Copy)]
pub struct HoldScene<'a> {
    /// The hold itself.
    pub holding: &'a Holding,
    /// How it stands.
    pub standing: Standing<'a>,
    /// Whether the device's inputs are wired to this program's simulated plate.
    pub has_rig: bool,
    /// Whether it begins once the simulated device has its sensor.
    pub is_put_up: bool,
    /// How far above its drive's level a held tone may rise, in dB.
    pub max_rise_db: f64,
    /// Where the simulated device's sensor stands, in metres from the driven end.
    pub place_m: f64,
}

/// The calibration under way.
#[derive(Clone, Copy)]
pub struct CalibrateScene<'a> {
    /// What is known so far, and the open page.
    pub calibration: &'a CalibrationWizard,
    /// The calibrated plate, or why there is none; `None` until that is known.
    pub result: Option<Result<&'a CalibrationResult, &'a Refused>>,
    /// The share of the fit that is done, 0..=1, while it is under way.
    pub progress: Option<f32>,
}

/// The state of the designer.
#[derive(Clone, Debug, Default)]
pub enum DesignState {
    /// It was not opened yet.
    #[default]
    Closed,
    /// It is being designed.
    Making,
    /// A plate, or the reason why there is none.
    Ready(Arc<Designed>),
    /// It was cancelled.
    Cancelled,
}

/// Work that the user waits for and can cancel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Awaited {
    /// A turning-point table.
    Table,
    /// A plate being designed.
    Design,
    /// A texture.
    Texture,
    /// The plate in two dimensions.
    Plane,
    /// The 2-D sheet.
    Sheet,
    /// The validity lights.
    Check,
}

impl fmt::Display for Awaited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Table => "table",
            Self::Design => "design",
            Self::Texture => "texture",
            Self::Plane => "two dimensions",
            Self::Sheet => "sheet",
            Self::Check => "check",
        })
    }
}

/// Work in progress, as a progress bar shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waiting {
    /// The work.
    pub what: Awaited,
    /// The share that is done, 0..=1.
    pub share: f32,
}

/// A message to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its text.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
    /// Incremented with every message, so that a repeated text counts as a new message.
    pub number: u64,
    /// How long it is shown, in seconds; `None` means as long as it is true.
    pub lasts_s: Option<f64>,
}
