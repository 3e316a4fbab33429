//! State of an instrument for display: the setup, the plate, the device, and the progress of work.

use super::outbox::Notice;
use super::{CalibrationSide, DragRecorder, MeasureDraft, SoFar, TourScene};
use crate::calibration::CalibrationWizard;
use crate::concern::{self, Concern, Concerns};
use crate::hold::{Holding, Standing};
use crate::jobs::calibrate::{CalibrationResult, Refused};
use crate::measure::{PlayedSweep, Prompt, Signal};
use crate::measured_file::ForeignMetadata;
use crate::selftest::{SelftestReport, SelftestRequest};
use slipline_link::Snapshot;
use slipline_model::field::felt::Felt;
use slipline_model::field::line::Line;
use slipline_model::field::rings::Rings;
use slipline_model::field::sheet::{FieldSource, Frame};
use slipline_model::field::steady_field::SteadyField;
use slipline_model::field::touch::{Touch, Trace};
use slipline_model::jobs::LatestResult;
use slipline_model::jobs::check::{CheckJob, Checked};
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::measured_places::MeasuredPlace;
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
use slipline_plate::check::Light;
use slipline_plate::text_table::ColumnRead;
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
    /// The selected finger.
    pub touch: Touch,
    /// The finger on the plate, if there is one.
    pub finger: Option<Finger>,
    /// The finger under which the plate moves otherwise, if there is one.
    pub load: Option<Finger>,
    /// The amplitudes under the finger in the last seconds.
    pub trace: &'a Trace,
    /// The plate under the setup's tones; with unit height while `full_peak_m` is not known.
    pub predicted: &'a SteadyField,
    /// What a finger would feel of the setup's tones; `None` while `full_peak_m` is not known.
    pub felt: Option<&'a Felt>,
    /// The boundary line of each tone, in their order.
    pub lines: &'a [Line],
    /// Range of the line of the selected tone, in metres.
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
    /// The response of the simulated plate once it has settled.
    pub measured: Option<Rings<'a>>,
    /// The places at which a real plate was measured.
    pub measured_places: &'a [MeasuredPlace],
    /// The lights, the designer and the source of the wave.
    pub background: &'a Background,
    /// The texture page.
    pub texture: TextureScene<'a>,
    /// The page of measurements.
    pub measure: MeasureScene<'a>,
    /// The page of the self-test.
    pub selftest: SelftestScene<'a>,
    /// The level hold.
    pub hold: HoldScene<'a>,
    /// The calibration under way.
    pub calibration: Option<CalibrateScene<'a>>,
    /// Which plate of the latest calibration is on the screen; `None` for any other.
    pub calibration_side: Option<CalibrationSide>,
    /// The tour, while it is under way.
    pub tour: Option<TourScene>,
    /// The plate and boundary for a computation in two dimensions.
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

    /// The lights of the newest check with what they mean on this device; `None` until there are some.
    #[must_use]
    pub fn concerns(&self) -> Option<Concerns<'_>> {
        let report = self.background.checks.newest()?.report.as_ref().ok()?;
        Some(Concerns::of(report, concern::is_real(self.snapshot)))
    }

    /// What this light means on this device.
    #[must_use]
    pub fn concern(&self, light: &Light) -> Concern {
        Concern::of(light, concern::is_real(self.snapshot))
    }

    /// The CRC of the table for the plate on the screen.
    #[must_use]
    pub fn table_crc(&self) -> Option<u32> {
        self.table.made().map(|made| made.device_table.crc())
    }

    /// Whether the device's table differs from the one for the plate on the screen.
    #[must_use]
    pub fn is_table_dirty(&self) -> bool {
        let on_device = self.snapshot.table.report.active.map(|header| header.crc);
        self.snapshot.is_connected() && self.table_crc().is_some_and(|crc| on_device != Some(crc))
    }

    /// Whether the plate is being measured: the setup does not sound, and its lines stay where they are.
    #[must_use]
    pub const fn is_measured_now(&self) -> bool {
        self.measure.live.progress.is_some()
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
    /// The lights; the newest say to which plate and boundary they belong.
    pub checks: LatestResult<CheckJob, Checked>,
    /// The plate in two dimensions.
    pub planes: LatestResult<PlaneJob, PlaneChecked>,
    /// The draft in the designer.
    pub draft: Draft,
    /// The result of the draft.
    pub design: DesignState,
    /// The source from which the wave is drawn.
    pub source: Option<FieldSource>,
}

/// The texture page: its draft and result.
#[derive(Clone, Copy)]
pub struct TextureScene<'a> {
    /// The wanted texture.
    pub draft: &'a WishDraft,
    /// The latest result.
    pub latest: Option<&'a Textured>,
    /// Whether the result belongs to the draft.
    pub is_current: bool,
    /// Whether the user has cancelled the draft.
    pub is_given_up: bool,
    /// Whether the draft is drawn over the envelope, and the setup's tones are those of the drawing.
    pub is_drawn: bool,
    /// The share of the drawn height that the tones can reach, 0 to 1: the shape is fitted, as high as it was drawn where that is
    /// possible.
    pub reached: f64,
}

/// The page of measurements.
#[derive(Clone, Copy)]
pub struct MeasureScene<'a> {
    /// The measurements.
    pub shelf: &'a Shelf,
    /// The difference between the chosen one and the model of the plate on the screen, or why it cannot be computed;
    /// `None` until it is.
    pub compared: Option<Result<&'a Comparison, &'a CalibrateError>>,
    /// A file by another program that lacks metadata.
    pub asked: Option<&'a Asked>,
    /// The measurement with the device.
    pub live: LiveScene<'a>,
}

/// A file by another program whose metadata the user completes.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The name of the file.
    pub name: String,
    /// Its content.
    pub content: AskedContent,
    /// The metadata stated so far.
    pub metadata: ForeignMetadata,
    /// The sensor's channel in a recording, from 1.
    pub channel: usize,
    /// Why it was refused with the metadata stated last.
    pub refused: Option<String>,
}

/// Frequencies and responses of a waiting file.
#[derive(Clone, Debug)]
pub struct AskedTable {
    /// The bytes of the file.
    pub bytes: Arc<[u8]>,
    /// Its columns, and what each was read as.
    pub columns: Vec<ColumnRead>,
    /// What was read; `None` while the columns are not clear.
    pub foreign: Option<Foreign>,
}

/// Content of a waiting file.
#[derive(Clone, Debug)]
pub enum AskedContent {
    /// Frequencies and responses.
    Table(AskedTable),
    /// A recording of the sweep.
    Recording {
        /// The sound.
        wav: Arc<Wav>,
        /// Name and content of the sweep's description; `None` while none is open.
        sweep: Option<(String, Arc<PlayedSweep>)>,
        /// Whether it is being read.
        is_read: bool,
    },
}

/// The measurement with the device.
#[derive(Clone, Copy)]
pub struct LiveScene<'a> {
    /// The settings of the measurement.
    pub draft: &'a MeasureDraft,
    /// How far a measurement is, while one is under way.
    pub progress: Option<Progress>,
    /// The points measured so far, while the response at a sensor is measured.
    pub so_far: Option<SoFar<'a>>,
    /// Whether the check of the drive is under way.
    pub is_checking: bool,
    /// Whether the rig of the simulated device states its drive circuit.
    pub is_drive_known: bool,
    /// Why the last measurement failed, until the next one begins.
    pub failed: Option<&'a str>,
    /// The present signal of the sensor, while a page shows it.
    pub signal: Option<Signal>,
    /// Whether the simulated device uses an unknown plate.
    pub is_secret: bool,
    /// Whether the unknown plate was measured.
    pub is_secret_measured: bool,
}

/// How far a measurement is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The share that is done, 0..=1.
    pub share: f32,
    /// The time that it still takes, in seconds; `None` while the simulated plate is prepared for it, and
    /// for a comparison of codes.
    pub left_s: Option<f64>,
}

impl fmt::Display for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.0} %", 100.0 * self.share)?;
        self.left_s.map_or(Ok(()), |left_s| write!(f, ", {:.0} s left", left_s.ceil()))
    }
}

impl<'a> MeasureScene<'a> {
    /// The difference between the chosen measurement and the plate's model, if it is computed.
    #[must_use]
    pub fn comparison(&self) -> Option<&'a Comparison> {
        self.compared?.ok()
    }
}

/// The page of the board's self-test.
#[derive(Clone, Copy)]
pub struct SelftestScene<'a> {
    /// What it is to do.
    pub request: SelftestRequest,
    /// How far it is, while it is under way.
    pub progress: Option<Progress>,
    /// What a person at the board is asked to do.
    pub prompt: Option<Prompt>,
    /// The report of the latest one.
    pub report: Option<&'a SelftestReport>,
    /// Why the latest one gave no report.
    pub failed: Option<&'a str>,
}

/// The level hold.
#[derive(Clone, Copy)]
pub struct HoldScene<'a> {
    /// The hold itself.
    pub holding: &'a Holding,
    /// Its state.
    pub standing: Standing<'a>,
    /// Whether the device's inputs are wired to this program's simulated plate.
    pub has_rig: bool,
    /// Whether it begins once the simulated device has its sensor.
    pub is_put_up: bool,
    /// Largest rise of a held tone above its drive level, in dB.
    pub max_rise_db: f64,
    /// Sensor place of the simulated device, in metres from the driven end.
    pub place_m: f64,
}

/// The calibration under way.
#[derive(Clone, Copy)]
pub struct CalibrateScene<'a> {
    /// Known dimensions and responses, and the open page.
    pub calibration: &'a CalibrationWizard,
    /// The calibrated plate, or why the calibration was refused; `None` until that is known.
    pub result: Option<Result<&'a CalibrationResult, &'a Refused>>,
    /// The share of the fit that is done, 0..=1, while it is under way.
    pub progress: Option<f32>,
}

/// The state of the designer.
#[derive(Clone, Debug, Default)]
pub enum DesignState {
    /// It has not been opened.
    #[default]
    Closed,
    /// The design is under way.
    Making,
    /// A plate, or why none was found.
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
