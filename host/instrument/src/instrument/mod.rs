//! The instrument: setup, history and the link's latest snapshot, what the device is asked for, and the work under way.
//!
//! ```text
//! shell --events--> Instrument --Request--> link
//!   ^                 | ^  <--Snapshot-- link
//!   +-- Shown, Output-+ |
//!                      Jobs (a thread each, or at once)
//! ```
//! A shell calls [`Instrument::attend`] and [`Instrument::turn`] for every frame, hands on what the user does, carries out the
//! [`Output`]s and draws what is [`Shown`].

mod background;
mod calibrate_intent;
mod calibrating;
mod device;
mod device_intent;
mod finger;
mod level_hold;
mod measure_intent;
mod measurements;
mod measuring;
mod notices;
mod opened;
mod playback;
mod replay;
mod rig;
mod setup;
mod shown;
mod signal;
mod start;
mod stop_presses;
mod texture;

pub use calibrate_intent::CalibrateIntent;
pub use device_intent::DeviceIntent;
pub use measure_intent::{MeasureDraft, MeasureIntent};
pub use replay::Recorder;
pub use shown::{
    Asked, AskedContent, Background, CalibrateScene, DesignState, HoldScene, LiveScene, MeasureScene, Notice,
    Shown, TextureScene, Waiting,
};
pub use start::SAFE_MODE;

use crate::autopilot::Autopilot;
use crate::bench::Bench;
use crate::jobs::calibrate::{CalibrateDone, CalibrateJob};
use crate::jobs::recorded::{Recorded, RecordedJob};
use crate::jobs::rig::{RigJob, RigPrepared};
use notices::Notices;
use playback::Playback;
use slipline_link::{Request, Severity, Snapshot, Ticket};
use slipline_model::field::felt::Felt;
use slipline_model::field::line::Line;
use slipline_model::field::sheet::{self, SheetJob, SourceChoice};
use slipline_model::field::steady_field::SteadyField;
use slipline_model::field::time_domain::{Measured, TimeDomainJob};
use slipline_model::field::touch::Trace;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::check::{CheckJob, Checked};
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::plane::{PlaneChecked, PlaneJob};
use slipline_model::jobs::table::{TableJob, TableMade, TableState};
use slipline_model::jobs::texture::{TextureJob, Textured};
use slipline_model::setup::compare::Compare;
use slipline_model::setup::undo::History;
use slipline_model::setup::{MAX_TONES, Setup};
use slipline_model::texture::WishDraft;
use slipline_model::waveform::{Waveform, WaveformJob};
use slipline_plate::Plate;
use std::sync::Arc;
use std::time::Duration;
use stop_presses::StopPresses;

/// The link as an instrument needs it: the worker, or a test's stand-in that records the requests.
pub trait Link {
    /// Sends a request; never blocks.
    fn send(&self, request: Request) -> Ticket;
    /// The latest snapshot of link and device.
    fn snapshot(&self) -> Arc<Snapshot>;
}

#[cfg(feature = "native")]
impl Link for slipline_link::native::Worker {
    fn send(&self, request: Request) -> Ticket {
        Self::send(self, request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Self::snapshot(self)
    }
}

/// Work that takes longer than a frame. The shell decides where it runs: on threads, in workers, or at once.
pub struct Jobs {
    /// Computes turning-point tables.
    pub tables: JobQueue<TableJob, TableState>,
    /// Computes validity lights.
    pub checks: JobQueue<CheckJob, Checked>,
    /// Computes the plate in two dimensions.
    pub planes: JobQueue<PlaneJob, PlaneChecked>,
    /// Designs plates.
    pub designs: JobQueue<Draft, Designed>,
    /// Makes textures.
    pub textures: JobQueue<TextureJob, Textured>,
    /// Compares measurements with the plate's model.
    pub comparisons: JobQueue<CompareJob, Compared>,
    /// Recordings of the sweep, read.
    pub recordings: JobQueue<RecordedJob, Recorded>,
    /// Fits plates to measurements.
    pub calibrations: JobQueue<CalibrateJob, CalibrateDone>,
    /// Puts the rigs of the simulated device together.
    pub rigs: JobQueue<RigJob, RigPrepared>,
    /// Runs the 2-D sheet.
    pub sheets: JobQueue<SheetJob, sheet::Frame>,
    /// Replays the device's codes with the mirror.
    pub waveforms: JobQueue<WaveformJob, Waveform>,
    /// Runs the simulated plate in the time domain.
    pub time_domain: JobQueue<TimeDomainJob, Measured>,
}

impl Jobs {
    /// All work is done at once, in the call that asks for it.
    #[must_use]
    pub fn inline() -> Self {
        Self {
            tables: JobQueue::inline(slipline_model::jobs::table::make),
            checks: JobQueue::inline(slipline_model::jobs::check::work()),
            planes: JobQueue::inline(slipline_model::jobs::plane::work),
            designs: JobQueue::inline(slipline_model::jobs::design::work),
            textures: JobQueue::inline(slipline_model::jobs::texture::work),
            comparisons: JobQueue::inline(slipline_model::jobs::compare::work),
            recordings: JobQueue::inline(crate::jobs::recorded::work),
            calibrations: JobQueue::inline(crate::jobs::calibrate::work),
            rigs: JobQueue::inline(crate::jobs::rig::work),
            sheets: JobQueue::inline(sheet::work()),
            waveforms: JobQueue::inline(slipline_model::waveform::work()),
            time_domain: JobQueue::inline(|job, task: &_| {
                slipline_model::field::time_domain::run(&job, task)
            }),
        }
    }
}

/// What the shell shows and the user holds, as far as it decides what is done next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Attention {
    /// The user's time, in seconds.
    pub now_s: f64,
    /// Whether a pointer is down: levels and places may still change.
    pub is_pressed: bool,
    /// Whether a line or the finger is dragged.
    pub is_dragging: bool,
    /// Whether the wave moves, or is paused.
    pub is_animated: bool,
    /// Whether a page is in front.
    pub has_page: bool,
    /// Whether that is the calibration.
    pub is_calibration_open: bool,
    /// Whether the page of measurements is open.
    pub is_measurements_open: bool,
    /// Whether the texture page is open.
    pub is_texture_open: bool,
    /// The source from which the wave is to be drawn.
    pub wave: SourceChoice,
    /// Whether a real device gets a new table without being asked.
    pub uploads: bool,
}

/// A page that the shell opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Page {
    /// The calibration.
    Calibration,
    /// The page of measurements.
    Measurements,
    /// The texture page.
    Texture,
    /// The question whether a real amplifier may be unmuted.
    Arm,
}

/// What the shell does for the instrument.
#[derive(Clone, Debug)]
pub enum Output {
    /// Open a page.
    Open(Page),
    /// Close the calibration's pages.
    CloseCalibration,
    /// Have the user choose a file of a measurement.
    ChooseMeasurement,
    /// Have the user save a file.
    Save {
        /// The name that is proposed.
        name: String,
        /// What it is, in a word.
        kind: &'static str,
        /// The ending of its name.
        extension: &'static str,
        /// What is in it.
        bytes: Vec<u8>,
    },
}

/// A plate and a device in use.
pub struct Instrument {
    link: Box<dyn Link>,
    jobs: Jobs,
    bench: Bench,
    attention: Attention,
    outputs: Vec<Output>,
    /// The time after which it wants to be turned again.
    wake: Option<Duration>,
    setup: Setup,
    history: History,
    compare: Compare,
    recorder: Recorder,
    autopilot: Autopilot,
    stop_presses: StopPresses,
    /// The latest request for a connection.
    connect_sent: Option<Ticket>,
    /// The latest drive that was sent, until a refusal of it is handled.
    drive_sent: Option<Ticket>,
    /// The latest drive that was sent.
    latest_drive: Option<Ticket>,
    /// The latest request to clear faults, until its result is known.
    clear_sent: Option<Ticket>,
    /// The slot of the tone that keys and fields change.
    selected: u8,
    /// Incremented with every press of pointer or key, so that a whole drag is one undo step.
    gesture: u64,
    snapshot: Arc<Snapshot>,
    table: TableState,
    /// The plate and rate of the latest table request.
    table_asked: Option<(Arc<Plate>, u32)>,
    /// The field that the setup would produce on its plate.
    predicted: SteadyField,
    /// What is felt of that field without a finger; `None` while its height is not known.
    felt: Option<Felt>,
    /// The boundary line of each tone, in their order.
    lines: Vec<Line>,
    /// The places that the line of the selected tone can have, in metres; `None` until they are asked for.
    limits_m: Option<(u8, (f64, f64))>,
    /// Where the user has put the felt edge of each slot's tone, in metres: it stays there when a level changes.
    wanted_m: [Option<f64>; MAX_TONES],
    finger: finger::OnPlate,
    playback: Playback,
    background: background::Work,
    textures: texture::Textures,
    measures: measurements::Measures,
    calibrating: calibrating::Calibrating,
    live: measuring::Live,
    level: level_hold::LevelHold,
    notices: Notices,
}

impl Instrument {
    /// An instrument with this setup; it is connected to nothing.
    #[must_use]
    pub fn new(link: Box<dyn Link>, jobs: Jobs, bench: Bench, setup: Setup) -> Self {
        let selected = setup.tones.first().map_or(0, |tone| tone.slot);
        let textures = texture::Textures::of(&setup.plate);
        let mut instrument = Self {
            link,
            jobs,
            bench,
            attention: Attention::default(),
            outputs: Vec::new(),
            wake: None,
            setup,
            textures,
            history: History::default(),
            compare: Compare::default(),
            recorder: Recorder::default(),
            autopilot: Autopilot::default(),
            stop_presses: StopPresses::default(),
            connect_sent: None,
            drive_sent: None,
            latest_drive: None,
            clear_sent: None,
            selected,
            gesture: 0,
            snapshot: Arc::default(),
            table: TableState::Waiting,
            table_asked: None,
            predicted: SteadyField::default(),
            felt: None,
            lines: Vec::new(),
            limits_m: None,
            wanted_m: [None; MAX_TONES],
            finger: finger::OnPlate::default(),
            playback: Playback::default(),
            background: background::Work::default(),
            measures: measurements::Measures::default(),
            calibrating: calibrating::Calibrating::default(),
            live: measuring::Live::default(),
            level: level_hold::LevelHold::default(),
            notices: Notices::default(),
        };
        instrument.predict();
        instrument.remember_lines();
        instrument
    }

    /// Takes what the shell shows and the user holds now.
    pub fn attend(&mut self, attention: Attention) {
        self.attention = attention;
    }

    /// Takes what link and jobs have reported since the last call.
    pub fn take_reports(&mut self) {
        self.update_snapshot();
        self.take_table();
        self.take_playback();
        self.take_background();
    }

    /// Goes on with what is under way: a replay, the level hold, a measurement, work for the screen.
    pub fn turn(&mut self) {
        self.replay();
        self.update_hold();
        self.update_measuring();
        self.update_background();
        self.measure(self.attention.now_s);
        if self.playback.sounding.is_none() {
            self.end_trace();
        }
    }

    /// What the shell is to do now, in order.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.outputs)
    }

    /// The time after which it wants to be turned again, if there is one.
    pub fn take_wake(&mut self) -> Option<Duration> {
        self.wake.take()
    }

    fn wake_after(&mut self, after: Duration) {
        self.wake = Some(self.wake.map_or(after, |wake| wake.min(after)));
    }

    /// A press of pointer or key has begun another gesture: what follows is another step of undo.
    pub fn begin_gestures(&mut self, count: u64) {
        self.gesture += count;
    }

    /// Selects the tone that keys and fields change.
    pub fn select(&mut self, slot: u8) {
        self.selected = slot;
    }

    /// Shows the other of the two setups that are compared.
    pub fn switch_setups(&mut self) {
        let edit = self.compare.switch(&self.setup);
        self.edit(&edit);
    }

    /// Undoes the latest change.
    pub fn undo(&mut self) {
        let name = self.history.undo_name();
        let setup = self.history.undo(&self.setup);
        self.step_back_or_forth(name, setup);
    }

    /// Makes the change again that was undone.
    pub fn redo(&mut self) {
        let name = self.history.redo_name();
        let setup = self.history.redo(&self.setup);
        self.step_back_or_forth(name, setup);
    }

    /// Computes the table whose computation was cancelled.
    pub fn make_table(&mut self) {
        self.table_asked = None;
        self.ask_for_table();
    }

    /// Sends the table for the setup's plate, once it is finished.
    pub fn upload(&mut self) {
        if let Some(made) = self.table.made() {
            self.link.send(Request::Upload(Arc::clone(&made.device_table)));
        }
    }

    /// The setup.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The state of link and device.
    #[must_use]
    pub fn snapshot(&self) -> &Arc<Snapshot> {
        &self.snapshot
    }

    /// The slot of the tone that keys and fields change.
    #[must_use]
    pub fn selected(&self) -> u8 {
        self.selected
    }

    /// The table for the setup's plate.
    #[must_use]
    pub fn table(&self) -> &TableState {
        &self.table
    }

    /// The recorded drag.
    #[must_use]
    pub fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    /// What the finger has met in the last seconds.
    #[must_use]
    pub fn trace(&self) -> &Trace {
        &self.finger.trace
    }

    /// Where the finger is or was last, in metres from the driven end.
    #[must_use]
    pub fn finger_place_m(&self) -> f64 {
        self.finger.place_m
    }

    /// The lights, the designer and what the wave is drawn from.
    #[must_use]
    pub fn background(&self) -> &Background {
        &self.background.shown
    }

    /// The field that the setup would produce on its plate.
    #[must_use]
    pub fn predicted(&self) -> &SteadyField {
        &self.predicted
    }

    /// Whether a drive sounds.
    #[must_use]
    pub fn is_sounding(&self) -> bool {
        self.playback.sounding.is_some()
    }

    /// The codes that the device sends.
    #[must_use]
    pub fn waveform(&self) -> &Waveform {
        &self.playback.waveform
    }

    /// Whether something is sent of which the codes are not known.
    #[must_use]
    pub fn is_waveform_unknown(&self) -> bool {
        self.playback.is_unknown()
    }

    /// Seconds of slow motion so far.
    #[must_use]
    pub fn wave_time_s(&self) -> f64 {
        self.playback.wave_time_s
    }

    /// The messages, the latest last.
    pub fn notices(&self) -> impl Iterator<Item = &Notice> {
        self.notices.iter()
    }

    /// Removes the message with this number.
    pub fn dismiss_notice(&mut self, number: u64) {
        self.notices.dismiss(number);
    }

    /// Removes the messages of successes: the user has gone on.
    pub fn successes_seen(&mut self) {
        self.notices.seen();
    }

    /// Whether the replay begins again at its end.
    pub fn loop_replay(&mut self, is_looped: bool) {
        self.recorder.is_looped = is_looped;
    }

    /// Has the texture page made of this draft.
    pub fn draft_texture(&mut self, draft: WishDraft) {
        self.textures.draft(draft);
    }

    /// Shows a failure.
    pub fn fail(&mut self, text: String) {
        self.notices.fail(text);
    }

    /// Shows a success.
    pub fn tell(&mut self, text: String) {
        self.notices.tell(text);
    }

    /// Writes a line to the log.
    pub fn note(&self, severity: Severity, text: String) {
        self.link.send(Request::Note(severity, text));
    }

    fn save(&mut self, name: &str, kind: &'static str, extension: &'static str, bytes: Vec<u8>) {
        self.outputs.push(Output::Save { name: name.to_owned(), kind, extension, bytes });
    }

    /// What it shows.
    pub fn shown(&mut self) -> Shown<'_> {
        let limits_m = self.limits_m();
        let now = self.snapshot.status.map_or(0, |status| status.now);
        Shown {
            setup: &self.setup,
            selected: self.selected,
            snapshot: &self.snapshot,
            touch: self.finger.touch,
            finger: self.finger(),
            trace: &self.finger.trace,
            drive_wanted: self.autopilot.wants_drive(),
            predicted: &self.predicted,
            felt: self.felt.as_ref(),
            lines: &self.lines,
            limits_m,
            sounding: self.sounding_on_screen(),
            full_peak_m: self.full_peak_m(),
            drive_table: self.drive_table(),
            table: &self.table,
            waveform: &self.playback.waveform,
            measured: self.shown_measured(),
            background: &self.background.shown,
            texture: self.textures.scene(),
            measure: self.measures.scene(self.live.scene(now, self.is_at_bench())),
            hold: self.hold_scene(),
            calibration: self.calibrating.scene(self.jobs.calibrations.progress()),
            plane_job: self.plane_job(),
            sheet: self.shown_sheet(),
            waiting: self.background.waiting(&self.jobs),
            notices: self.notices.iter().collect(),
            compare: &self.compare,
            recorder: &self.recorder,
            undo: (self.history.undo_name(), self.history.redo_name()),
            wave_time_s: self.playback.wave_time_s,
        }
    }
}
