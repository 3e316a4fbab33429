//! The app: takes what the views ask for, changes the setup, asks the link, and keeps what the views show current.
//!
//! ```text
//! views --Intent--> App --Edit--> Setup --DriveRequest--> link worker --> device
//!   ^                |  <--Snapshot-- link worker <-- device
//!   +--- Scene ------+  <--table, lights, design, sheet, files, simulated plate-- threads
//! ```
//! Nothing here blocks: work that takes longer than a frame runs in the link worker, a [`JobQueue`] or [`Files`].

mod background;
mod calibrate;
mod device;
mod eframe_log;
mod event_loop;
mod finger;
mod glyphs;
mod hold;
mod input;
mod measure;
mod measuring;
mod no_display;
mod notices;
mod pace;
mod paths;
mod perform;
mod playback;
mod replay;
mod rig;
mod setup;
mod signal;
mod sound;
mod start;
mod stop_presses;
mod texture;
mod window;

pub use event_loop::run as run_in_event_loop;
pub use replay::Recorder;
pub use window::run;

use crate::bench::Bench;
use crate::files::{FileJob, Files};
use crate::intent::{Dialog, Grab};
use crate::scene::{Notice, Scene, SoundScene};
use crate::settings::{Settings, ThemeChoice};
use crate::sound::Speaker;
use crate::view::{self, ViewState, theme};
use eframe::egui;
use notices::Notices;
use playback::Playback;
use slipline_instrument::autopilot::Autopilot;
use slipline_instrument::jobs::calibrate::{CalibrateDone, CalibrateJob};
use slipline_instrument::jobs::recorded::{Recorded, RecordedJob};
use slipline_instrument::jobs::rig::{RigJob, RigPrepared};
use slipline_link::native::Worker;
use slipline_link::{Port, PortInfo, Request, Snapshot, Ticket};
use slipline_model::export::figures::plate::{self, FigureJob};
use slipline_model::export::figures::{DrawError, encode};
use slipline_model::field::felt::Felt;
use slipline_model::field::line::Line;
use slipline_model::field::sheet::{self, SheetJob};
use slipline_model::field::steady_field::SteadyField;
use slipline_model::field::time_domain::{Measured, TimeDomainJob};
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::check::{CheckJob, Checked};
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::plane::{PlaneChecked, PlaneJob};
pub use slipline_model::jobs::table::{TableJob, TableMade, TableState};
use slipline_model::jobs::texture::{TextureJob, Textured};
use slipline_model::scenes::{SCENES, Thumbnail};
use slipline_model::setup::compare::Compare;
use slipline_model::setup::undo::History;
use slipline_model::setup::{MAX_TONES, Setup};
use slipline_model::waveform::{Waveform, WaveformJob};
use slipline_plate::Plate;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use stop_presses::StopPresses;

/// The link as the app needs it: the worker, or a test's stand-in that records the requests.
pub trait Link {
    /// Sends a request; never blocks.
    fn send(&self, request: Request) -> Ticket;
    /// The latest snapshot of link and device.
    fn snapshot(&self) -> Arc<Snapshot>;
}

impl Link for Worker {
    fn send(&self, request: Request) -> Ticket {
        Self::send(self, request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Self::snapshot(self)
    }
}

/// The parts that the app works with; tests pass their own.
pub struct Parts {
    /// The link.
    pub link: Box<dyn Link>,
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
    /// What the simulated device's inputs are wired to.
    pub bench: Bench,
    /// Runs the 2-D sheet.
    pub sheets: JobQueue<SheetJob, sheet::Frame>,
    /// Replays the device's codes with the mirror.
    pub waveforms: JobQueue<WaveformJob, Waveform>,
    /// Runs the simulated plate in the time domain.
    pub time_domain: JobQueue<TimeDomainJob, Measured>,
    /// Draws small pictures of the scenes.
    pub scenes: JobQueue<(), Vec<Thumbnail>>,
    /// Draws figures.
    pub figures: JobQueue<FigureJob, Result<plate::File, String>>,
    /// Plays sound.
    pub speaker: Box<dyn Speaker>,
    /// Files.
    pub files: Box<dyn Files>,
    /// Lists the ports that exist, the simulated device first.
    pub ports: Box<dyn Fn() -> Vec<PortInfo>>,
}

/// The app.
pub struct App {
    parts: Parts,
    setup: Setup,
    history: History,
    compare: Compare,
    recorder: Recorder,
    settings: Settings,
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
    grab: Option<Grab>,
    /// Incremented with every press of pointer or key, so that a whole drag is one undo step.
    gesture: u64,
    /// When egui took the latest input that was processed.
    input_time_s: Option<f64>,
    snapshot: Arc<Snapshot>,
    ports: Vec<PortInfo>,
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
    hearing: sound::Hearing,
    playback: Playback,
    background: background::Work,
    textures: texture::Textures,
    measures: measure::Measures,
    calibrating: calibrate::Calibrating,
    live: measuring::Live,
    level: hold::LevelHold,
    notices: Notices,
    glyphs: glyphs::Glyphs,
    dialog: Option<Dialog>,
    /// The page that comes back when the one for typing a path is closed.
    behind: Option<Dialog>,
    /// The pictures of the scenes; empty until their page was opened.
    thumbnails: Vec<Thumbnail>,
    /// The file job that waits until the user types a path.
    asked: Option<FileJob>,
    view: ViewState,
    screenshots: (Sender<Arc<egui::ColorImage>>, Receiver<Arc<egui::ColorImage>>),
}

impl App {
    /// An app with these parts, setup and settings. It connects to the port that was used last.
    #[must_use]
    pub fn new(ctx: &egui::Context, parts: Parts, setup: Setup, settings: Settings) -> Self {
        theme::install(ctx);
        set_theme(ctx, settings.theme);
        let ports = (parts.ports)();
        let selected = setup.tones.first().map_or(0, |tone| tone.slot);
        let textures = texture::Textures::of(&setup.plate);
        let mut app = Self {
            parts,
            setup,
            textures,
            history: History::default(),
            compare: Compare::default(),
            recorder: Recorder::default(),
            settings,
            autopilot: Autopilot::default(),
            stop_presses: StopPresses::default(),
            connect_sent: None,
            drive_sent: None,
            latest_drive: None,
            clear_sent: None,
            selected,
            grab: None,
            gesture: 0,
            input_time_s: None,
            snapshot: Arc::default(),
            ports,
            table: TableState::Waiting,
            table_asked: None,
            predicted: SteadyField::default(),
            felt: None,
            lines: Vec::new(),
            limits_m: None,
            wanted_m: [None; MAX_TONES],
            finger: finger::OnPlate::default(),
            hearing: sound::Hearing::default(),
            playback: Playback::default(),
            background: background::Work::default(),
            measures: measure::Measures::default(),
            calibrating: calibrate::Calibrating::default(),
            live: measuring::Live::default(),
            level: hold::LevelHold::default(),
            notices: Notices::default(),
            glyphs: glyphs::Glyphs::default(),
            dialog: None,
            behind: None,
            thumbnails: Vec::new(),
            asked: None,
            view: ViewState::default(),
            screenshots: channel(),
        };
        app.parts.link.send(Request::AutoReconnect(app.settings.auto_reconnect));
        let port = app.settings.port.as_deref().and_then(|name| name.parse().ok()).unwrap_or(Port::Simulated);
        app.connect(port);
        app.predict();
        app.remember_lines();
        app
    }

    /// The user's setup.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The settings that are kept between runs.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The recorded drag.
    #[must_use]
    pub fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    /// The latest message that is shown, if any.
    #[must_use]
    pub fn notice(&self) -> Option<&Notice> {
        self.notices.iter().max_by_key(|notice| notice.number)
    }

    /// Processes everything that happened since the last frame. Paints nothing.
    pub fn logic(&mut self, ctx: &egui::Context) {
        self.update_snapshot();
        self.take_results();
        if self.has_new_input(ctx) {
            self.keys(ctx);
            self.follow_pointer(ctx);
            self.dropped_files(ctx);
        }
        self.replay(ctx);
        self.update_hold(ctx);
        self.update_measuring(ctx);
        self.update_background(ctx);
        self.advance(ctx);
    }

    fn take_results(&mut self) {
        self.take_table();
        self.take_playback();
        self.take_background();
        if let Some(drawn) = self.parts.scenes.take() {
            self.thumbnails = drawn;
        }
        while let Some(event) = self.parts.files.take() {
            self.file_event(event);
        }
        match self.parts.figures.take() {
            Some(Ok(plate::File { format, bytes })) => {
                let extension = format.extension();
                self.save(&format!("figure.{extension}"), "Picture", extension, bytes);
            }
            Some(Err(reason)) => self.fail(format!("The figure could not be made: {reason}")),
            None => {}
        }
        if let Ok(image) = self.screenshots.1.try_recv() {
            match screenshot_png(&image) {
                Ok(bytes) => self.save("screenshot.png", "Picture", "png", bytes),
                Err(error) => self.fail(format!("The screenshot could not be made: {error}")),
            }
        }
    }

    fn fail(&mut self, text: String) {
        self.notices.fail(text);
    }

    /// Shows the window in all of `ui`, then carries out the intents of its views.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        self.look_for_glyphs(ui.ctx());
        let limits_m = self.limits_m();
        let mut view = std::mem::take(&mut self.view);
        let scene = Scene {
            setup: &self.setup,
            selected: self.selected,
            grab: self.grab,
            snapshot: &self.snapshot,
            touch: self.finger.touch,
            finger: self.finger(),
            trace: &self.finger.trace,
            sound: SoundScene {
                choice: self.sound_choice(),
                speaker: self.parts.speaker.state(),
                unplayed: self.unplayed(),
            },
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
            measure: self.measures.scene(
                self.live.scene(self.snapshot.status.map_or(0, |status| status.now), self.is_at_bench()),
            ),
            hold: self.hold_scene(),
            calibration: self.calibrating.scene(self.parts.calibrations.progress()),
            plane_job: self.plane_job(),
            sheet: self.shown_sheet(),
            waiting: self.background.waiting(&self.parts),
            settings: &self.settings,
            ports: &self.ports,
            notices: self.notices.iter().collect(),
            dialog: self.dialog.as_ref(),
            thumbnails: &self.thumbnails,
            compare: &self.compare,
            recorder: &self.recorder,
            undo: (self.history.undo_name(), self.history.redo_name()),
            wave_time_s: self.playback.wave_time_s,
        };
        let intents = view::show(ui, &scene, &mut view);
        self.view = view;
        self.perform(&ui.ctx().clone(), intents);
    }
}

fn screenshot_png(image: &egui::ColorImage) -> Result<Vec<u8>, DrawError> {
    let [width, height] = image.size.map(|pixels| pixels as u32);
    let rgba: Vec<[u8; 4]> = image.pixels.iter().map(egui::Color32::to_srgba_unmultiplied).collect();
    encode((width, height), &rgba, None)
}

fn set_theme(ctx: &egui::Context, choice: ThemeChoice) {
    ctx.set_theme(match choice {
        ThemeChoice::Light => egui::ThemePreference::Light,
        ThemeChoice::Dark => egui::ThemePreference::Dark,
        ThemeChoice::System => egui::ThemePreference::System,
    });
}

/// The setup of a first start: the first scene. `None` when its preset is damaged.
#[must_use]
pub fn first_setup() -> Option<Setup> {
    SCENES.first()?.setup()
}
