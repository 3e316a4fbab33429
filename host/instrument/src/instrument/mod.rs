//! The instrument: setup, history and the link's latest snapshot, the requests to the device, and the work under way.
//!
//! ```text
//! shell --events--> Instrument --Request--> link
//!   ^                 | ^  <--Snapshot-- link
//!   +-- Shown, Output-+ |
//!                      Jobs (a thread each, or at once)
//! ```
//! A shell calls [`Instrument::attend`] and [`Instrument::turn`] for every frame, passes the user's actions
//! on, carries out the [`Output`]s and draws what is [`Shown`].

mod background;
mod brush;
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
mod plate_there;
mod playback;
mod prediction;
mod reading;
mod replay;
mod rig;
mod setup;
mod shell;
mod shown;
mod signal;
mod start;
mod stop_presses;
mod texture;
mod work;

pub use calibrate_intent::CalibrateIntent;
pub use device_intent::DeviceIntent;
pub use measure_intent::{MeasureDraft, MeasureIntent};
pub use replay::DragRecorder;
pub use shell::{Attention, Link, Output, Page};
pub use shown::{
    Asked, AskedContent, AskedTable, Awaited, Background, CalibrateScene, DesignState, HoldScene, LiveScene,
    MeasureScene, Notice, Shown, TextureScene, Waiting,
};
pub use start::SAFE_MODE;
pub use work::Jobs;

use crate::autopilot::Autopilot;
use crate::bench::Bench;
use notices::Notices;
use playback::Playback;
use slipline_link::{Request, Severity, Snapshot, Ticket};
use slipline_model::jobs::table::{TableJob, TableMade, TableState};
use slipline_model::setup::Setup;
use slipline_model::setup::compare::Compare;
use slipline_model::setup::undo::History;
use slipline_plate::Plate;
use std::cell::RefCell;
use std::sync::Arc;
use std::time::Duration;
use stop_presses::StopPresses;

/// A plate and a device in use.
pub struct Instrument {
    link: Box<dyn Link>,
    jobs: Jobs,
    bench: Bench,
    attention: Attention,
    outputs: Vec<Output>,
    /// The time after which [`turn`](Self::turn) must be called again.
    wake: Option<Duration>,
    setup: Setup,
    history: History,
    compare: Compare,
    recorder: DragRecorder,
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
    prediction: prediction::Prediction,
    limits: RefCell<Option<prediction::Limits>>,
    /// Felt edges by slot, in metres, that the lines keep since the latest change that moved one.
    edges_m: Vec<(u8, f64)>,
    finger: finger::OnPlate,
    playback: Playback,
    background: background::Work,
    textures: texture::Textures,
    brush: brush::Brush,
    measures: measurements::Measures,
    measured: plate_there::Measured,
    calibrating: calibrating::Calibrating,
    live: measuring::Live,
    level: level_hold::LevelHold,
    notices: Notices,
}

impl Instrument {
    /// An instrument with this setup, not connected to a device.
    #[must_use]
    pub fn new(link: Box<dyn Link>, jobs: Jobs, bench: Bench, setup: Setup) -> Self {
        let selected = setup.tones.first().map_or(0, |tone| tone.slot);
        let textures = texture::Textures::of(&setup.plate);
        Self {
            link,
            jobs,
            bench,
            attention: Attention::default(),
            outputs: Vec::new(),
            wake: None,
            setup,
            textures,
            brush: brush::Brush::default(),
            history: History::default(),
            compare: Compare::default(),
            recorder: DragRecorder::default(),
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
            prediction: prediction::Prediction::default(),
            limits: RefCell::default(),
            edges_m: Vec::new(),
            finger: finger::OnPlate::default(),
            playback: Playback::default(),
            background: background::Work::default(),
            measures: measurements::Measures::default(),
            measured: plate_there::Measured::default(),
            calibrating: calibrating::Calibrating::default(),
            live: measuring::Live::default(),
            level: level_hold::LevelHold::default(),
            notices: Notices::default(),
        }
    }

    /// Stores the state of the shell: what it shows, and what the user holds.
    pub fn attend(&mut self, attention: Attention) {
        self.attention = attention;
    }

    /// Handles the reports of link and jobs since the last call.
    pub fn take_reports(&mut self) {
        self.update_snapshot();
        self.take_table();
        self.take_playback();
        self.take_background();
    }

    /// Advances what is under way: a replay, the level hold, a measurement, work for the screen.
    pub fn turn(&mut self) {
        self.replay();
        self.update_hold();
        self.update_measuring();
        self.rest_bench();
        self.update_background();
        self.send_drawing();
        self.update_places();
        self.pause_unwatched();
        self.measure(self.attention.now_s);
        if self.playback.sounding.is_none() {
            self.end_trace();
        }
        // Every message is in the log, too.
        for (severity, text) in self.notices.take_unlogged() {
            self.note(severity, text);
        }
    }

    /// Actions for the shell, in order.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.outputs)
    }

    /// The time after which [`turn`](Self::turn) must be called again, if any.
    pub fn take_wake(&mut self) -> Option<Duration> {
        self.wake.take()
    }

    fn wake_after(&mut self, after: Duration) {
        self.wake = Some(self.wake.map_or(after, |wake| wake.min(after)));
    }

    /// A press of pointer or key has begun another gesture; changes from now on are another undo step.
    pub fn begin_gestures(&mut self, count: u64) {
        self.gesture += count;
    }

    /// Selects the tone that keys and fields change.
    pub fn select(&mut self, slot: u8) {
        self.selected = slot;
    }

    /// Switches to the other of the two compared setups.
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

    /// Repeats the change that was undone last.
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

    /// Removes the message with this number.
    pub fn dismiss_notice(&mut self, number: u64) {
        self.notices.dismiss(number);
    }

    /// Sets whether the replay repeats from its start.
    pub fn loop_replay(&mut self, is_looped: bool) {
        self.recorder.is_looped = is_looped;
    }

    /// Shows a failure.
    pub fn fail(&mut self, text: String) {
        self.notices.fail(text);
    }

    /// Shows a success.
    pub fn post(&mut self, text: String) {
        self.notices.post(text);
    }

    /// Shows a success or a failure that the log has in other words: the log is sent to others, and holds no folders.
    pub fn report(&mut self, severity: Severity, shown: String, logged: String) {
        self.notices.report(severity, shown, logged);
    }

    /// Writes a line to the log.
    pub fn note(&self, severity: Severity, text: String) {
        self.link.send(Request::Note(severity, text));
    }

    fn save(&mut self, name: &str, kind: &'static str, extension: &'static str, bytes: Vec<u8>) {
        self.outputs.push(Output::Save { name: name.to_owned(), kind, extension, bytes });
    }

    /// Everything that a shell shows.
    pub fn shown(&self) -> Shown<'_> {
        let prediction::Predicted { field, felt, lines } = self.predicted();
        let now = self.snapshot.status.map_or(0, |status| status.now);
        Shown {
            setup: &self.setup,
            selected: self.selected,
            snapshot: &self.snapshot,
            touch: self.finger.touch,
            finger: self.finger(),
            load: self.load(),
            trace: &self.finger.trace,
            drive_wanted: self.autopilot.wants_drive(),
            predicted: field,
            felt: felt.as_ref(),
            lines,
            limits_m: self.limits_m(),
            sounding: self.sounding_on_screen(),
            full_peak_m: self.full_peak_m(),
            drive_table: self.drive_table(),
            table: &self.table,
            waveform: &self.playback.waveform,
            measured: self.shown_measured(),
            measured_places: self.measured.current().map_or(&[], |found| &found.places),
            background: &self.background.shown,
            texture: self.textures.scene(self.brush.is_drawn()),
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

#[cfg(test)]
mod tests;
