//! The app: takes what the views ask for, changes the setup, asks the link, and keeps what the views show current.
//!
//! ```text
//! views --Intent--> App --Edit--> Setup --DriveRequest--> link worker --> device
//!   ^                |  <--Snapshot-- link worker <-- device
//!   +--- Scene ------+  <--table, lights, design, sheet, files, simulated plate-- threads
//! ```
//! Nothing here waits: what takes longer than a frame is done by the link worker, a [`Workshop`] or [`Files`].

mod background;
mod input;
mod perform;
mod window;

pub use background::{Background, DesignState, Waiting};
pub use window::run;

use crate::designer::{Designed, Draft};
use crate::edit::{self, Edit, History};
use crate::export;
use crate::files::Files;
use crate::link::worker::Worker;
use crate::link::{Port, PortInfo, Request, Snapshot, Ticket};
use crate::live::{self, Live};
use crate::model::{MASTER_MIN_DB, Setup};
use crate::picture::{Picture, steady_tones};
use crate::pilot::{self, Pilot};
use crate::settings::{Settings, ThemeChoice};
use crate::sheet;
pub use crate::table_making::{TableJob, TableMade, TableState};
use crate::trial::{self, Measured};
use crate::validity::{self, Verdict};
use crate::view::intent::{Dialog, Grab};
use crate::view::{self, Scene, ViewState, theme};
use crate::workshop::Workshop;
use eframe::egui;
use slipline_plate::Plate;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// Time between two pictures of the moving wave.
const FRAME: Duration = Duration::from_millis(33);
/// Time between two looks at the meters while the wave stands.
const GLANCE: Duration = Duration::from_millis(500);

/// The link as the app needs it: the worker, or a test's record of what was asked.
pub trait Link {
    /// Asks for something; never blocks.
    fn send(&self, request: Request) -> Ticket;
    /// What is known.
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

/// What the app works with; tests give their own.
pub struct Parts {
    /// The link.
    pub link: Box<dyn Link>,
    /// Where tables are made.
    pub tables: Workshop<TableJob, TableState>,
    /// Where validity lights are made.
    pub checks: Workshop<validity::Job, Verdict>,
    /// Where plates are designed.
    pub designs: Workshop<Draft, Designed>,
    /// Where the 2-D sheet is run.
    pub sheets: Workshop<sheet::Job, sheet::Frame>,
    /// Where the mirror follows the device.
    pub live: Workshop<live::Job, Live>,
    /// Where the simulated plate is run.
    pub trials: Workshop<trial::Job, Measured>,
    /// Files.
    pub files: Box<dyn Files>,
    /// Which ports exist.
    pub ports: Box<dyn Fn() -> Vec<PortInfo>>,
}

/// A message to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// What it says.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
    /// Whether the device refused something: the message goes when it takes something newer.
    pub is_refusal: bool,
}

/// The app.
pub struct App {
    parts: Parts,
    setup: Setup,
    history: History,
    settings: Settings,
    pilot: Pilot,
    selected: u8,
    grab: Option<Grab>,
    /// Rises with every press of pointer or key: a drag is one step of the history.
    gesture: u64,
    snapshot: Arc<Snapshot>,
    ports: Vec<PortInfo>,
    table: TableState,
    /// The plate and rate that the table was asked for.
    table_asked: Option<(Arc<Plate>, u32)>,
    predicted: Picture,
    sounding: Option<(u64, Picture)>,
    /// The plate that the picture of what sounds was solved for.
    heard_on: Option<Arc<Plate>>,
    live: Live,
    measured: Option<Measured>,
    background: Background,
    notice: Option<Notice>,
    dialog: Option<Dialog>,
    view: ViewState,
    wave_time_s: f64,
    screenshots: (Sender<Arc<egui::ColorImage>>, Receiver<Arc<egui::ColorImage>>),
}

impl App {
    /// An app with these parts, this setup and these settings, connecting to the port used last.
    #[must_use]
    pub fn new(ctx: &egui::Context, parts: Parts, setup: Setup, settings: Settings) -> Self {
        theme::install(ctx);
        set_theme(ctx, settings.theme);
        let ports = (parts.ports)();
        let selected = setup.tones.first().map_or(0, |tone| tone.slot);
        let mut app = Self {
            parts,
            setup,
            history: History::default(),
            settings,
            pilot: Pilot::default(),
            selected,
            grab: None,
            gesture: 0,
            snapshot: Arc::default(),
            ports,
            table: TableState::Waiting,
            table_asked: None,
            predicted: Picture::default(),
            sounding: None,
            heard_on: None,
            live: Live::default(),
            measured: None,
            background: Background::default(),
            notice: None,
            dialog: None,
            view: ViewState::default(),
            wave_time_s: 0.0,
            screenshots: channel(),
        };
        app.parts.link.send(Request::AutoReconnect(app.settings.auto_reconnect));
        let port = app.settings.port.as_deref().and_then(|name| name.parse().ok()).unwrap_or(Port::Simulated);
        app.connect(port);
        app.predict();
        app
    }

    /// What the user has set up.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// What is remembered.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The message that stands, if one does.
    #[must_use]
    pub fn notice(&self) -> Option<&Notice> {
        self.notice.as_ref()
    }

    fn connect(&mut self, port: Port) {
        // The port that was asked for is remembered even if it is not there today.
        self.settings.port = Some(port.to_string());
        self.pilot.connecting(&port);
        self.parts.link.send(Request::Connect(port));
    }

    /// Takes in all that happened since the last frame. Paints nothing.
    pub fn logic(&mut self, ctx: &egui::Context) {
        self.look_at_link();
        self.take_results();
        self.keys(ctx);
        self.follow_pointer(ctx);
        self.dropped_files(ctx);
        self.look_after_background(ctx);
        self.advance(ctx);
    }

    fn look_at_link(&mut self) {
        let snapshot = self.parts.link.snapshot();
        let before = std::mem::replace(&mut self.snapshot, snapshot);
        if before.revision == self.snapshot.revision {
            let now = |snapshot: &Snapshot| snapshot.status.map(|status| status.now);
            if self.sounding.is_some() && now(&before) != now(&self.snapshot) {
                self.follow();
            }
            return;
        }
        self.settings.auto_reconnect = self.snapshot.auto_reconnect;
        if let Some((ticket, reason)) = &self.snapshot.last_refusal
            && before.last_refusal.as_ref().map(|(ticket, _)| ticket) != Some(ticket)
        {
            self.notice =
                Some(Notice { text: format!("Refused: {reason}"), is_error: true, is_refusal: true });
        }
        self.ask_for_table();
        self.let_pilot_act(&before);
        self.hear();
    }

    fn let_pilot_act(&mut self, before: &Snapshot) {
        let made = self.table.made().filter(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
        for act in self.pilot.look(before, &self.snapshot, made, &self.settings) {
            match act {
                pilot::Act::Upload(table) => {
                    self.parts.link.send(Request::Upload(table));
                }
                pilot::Act::Drive => self.send_drive(),
            }
        }
    }

    /// Has the table made for the plate on the screen and the device's rate.
    fn ask_for_table(&mut self) {
        let Some(identity) = &self.snapshot.identity else { return };
        let rate = identity.sample_rate_hz;
        let is_asked = self
            .table_asked
            .as_ref()
            .is_some_and(|(plate, asked)| Arc::ptr_eq(plate, &self.setup.plate) && *asked == rate);
        if is_asked {
            return;
        }
        self.table_asked = Some((Arc::clone(&self.setup.plate), rate));
        self.table = TableState::Making;
        self.parts.tables.ask(TableJob {
            plate: Arc::clone(&self.setup.plate),
            sample_rate_hz: f64::from(rate),
            max_knots: usize::from(identity.max_knots),
        });
    }

    fn take_results(&mut self) {
        if let Some(table) = self.parts.tables.take() {
            let is_current = table.made().is_none_or(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
            if is_current {
                self.background.keep(&table);
                self.table = table;
                self.predict();
                let snapshot = Arc::clone(&self.snapshot);
                self.let_pilot_act(&snapshot);
                self.hear();
            }
        }
        if let Some(live) = self.parts.live.take()
            && (self.settings.animate || self.live.window().is_none())
        {
            self.live = live;
        }
        if let Some(measured) = self.parts.trials.take() {
            self.measured = Some(measured);
        }
        self.take_background();
        while let Some(event) = self.parts.files.take() {
            self.file_event(event);
        }
        if let Ok(image) = self.screenshots.1.try_recv() {
            match export::png(&image) {
                Ok(bytes) => self.save("slipline.png", "Picture", "png", bytes),
                Err(error) => self.fail(format!("The picture could not be made: {error}")),
            }
        }
    }

    fn fail(&mut self, text: String) {
        self.notice = Some(Notice { text, is_error: true, is_refusal: false });
    }

    /// Makes a change, notes it, and tells the device at once if the plate is driven.
    fn edit(&mut self, edit: &Edit) {
        match edit::apply(&self.setup, edit) {
            Ok(next) if next == self.setup => {}
            Ok(mut next) => {
                if matches!(edit, Edit::Add { .. }) {
                    self.make_fit(&mut next);
                }
                self.history.note(&self.setup, edit, self.gesture);
                self.take(next);
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Lowers the master as far as the tones' worst-case sum needs to fit the DAC.
    fn make_fit(&self, setup: &mut Setup) {
        let sum = self.table.headroom_sum(setup);
        if sum > 1.0 {
            // A little more than needed, because the device rounds to hundredths of a decibel.
            setup.master_db = (setup.master_db - 20.0 * sum.log10() - 0.05).max(MASTER_MIN_DB);
        }
    }

    /// Takes another setup, from an edit or from the history.
    fn take(&mut self, next: Setup) {
        let is_new_plate = !Arc::ptr_eq(&self.setup.plate, &next.plate);
        let added = next.tones.iter().find(|tone| self.setup.tone(tone.slot).is_none()).map(|tone| tone.slot);
        self.setup = next;
        if let Some(slot) = added {
            self.selected = slot;
        } else if self.setup.tone(self.selected).is_none() {
            self.selected = self.setup.tones.first().map_or(0, |tone| tone.slot);
        }
        if is_new_plate {
            self.measured = None;
            self.table_asked = None;
            self.ask_for_table();
        } else if self.pilot.may_drive(&self.snapshot) {
            self.send_drive();
        }
        self.predict();
    }

    fn send_drive(&mut self) {
        self.parts.link.send(Request::Drive(edit::drive(&self.setup)));
    }

    fn full_peak_m(&self) -> f64 {
        self.table.made().map_or_else(
            // Until the table is made: what the drive alone would give.
            || self.setup.plate.spec().full_scale_m,
            |made| made.drive_table.peak_at_full_scale_m,
        )
    }

    fn predict(&mut self) {
        let tones = steady_tones(&self.setup, self.full_peak_m());
        self.predicted = Picture::solve(&self.setup.plate, &tones);
    }

    /// Has the mirror follow the device up to now.
    fn follow(&mut self) {
        if let Some(job) = live::Job::of(&self.snapshot) {
            self.parts.live.ask(job);
        }
    }

    /// Solves for what the device has acknowledged, when that has changed, and has it tried on the simulated plate.
    fn hear(&mut self) {
        let heard = pilot::sounding(&self.snapshot);
        // At rest the mirror has nothing to follow; the change to rest itself is followed.
        if heard.is_some() || self.sounding.is_some() {
            self.follow();
        }
        let Some(heard) = heard else {
            self.sounding = None;
            self.heard_on = None;
            return;
        };
        // Another plate with the very same table leaves the device as it is; the picture is another all the same.
        let made = self.table.made().filter(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
        let has_table = made.is_some_and(|made| made.device_table.crc() == heard.table.crc());
        let is_new = self.sounding.as_ref().is_none_or(|(number, _)| *number != heard.number);
        if !is_new && (self.is_heard_on_screen() || !has_table) {
            return;
        }
        self.heard_on = Some(Arc::clone(&self.setup.plate));
        // What was refused before is settled: the device sounds something newer.
        if self.notice.as_ref().is_some_and(|notice| notice.is_refusal) {
            self.notice = None;
        }
        self.sounding = Some((heard.number, Picture::solve(&self.setup.plate, &heard.tones)));
        let Some(identity) = &self.snapshot.identity else { return };
        let job = trial::Job {
            number: heard.number,
            plate: Arc::clone(&self.setup.plate),
            table: heard.table,
            drive: heard.drive,
            dac_bits: identity.dac_bits,
        };
        if identity.simulated {
            self.parts.trials.ask(job.clone());
        }
        self.run_sheet(job);
    }

    /// Whether what sounds was solved for the plate on the screen: not while its table is still to come.
    fn is_heard_on_screen(&self) -> bool {
        self.heard_on.as_ref().is_some_and(|plate| Arc::ptr_eq(plate, &self.setup.plate))
    }

    /// What was measured, if it belongs to what sounds.
    fn current_measured(&self) -> Option<&Measured> {
        let number = self.sounding.as_ref().map(|(number, _)| *number);
        self.measured.as_ref().filter(|measured| Some(measured.number) == number)
    }

    fn stop(&mut self) {
        self.pilot.stopped();
        self.parts.link.send(Request::Stop);
    }

    /// Shows the window and carries out what is asked.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let mut view = std::mem::take(&mut self.view);
        let scene = Scene {
            setup: &self.setup,
            selected: self.selected,
            grab: self.grab,
            snapshot: &self.snapshot,
            drive_wanted: self.pilot.wants_drive(),
            predicted: &self.predicted,
            sounding: self
                .sounding
                .as_ref()
                .filter(|_| self.is_heard_on_screen())
                .map(|(_, picture)| picture),
            full_peak_m: self.full_peak_m(),
            table: &self.table,
            live: &self.live,
            measured: self.current_measured(),
            background: &self.background,
            sheet: self.shown_sheet(),
            waiting: self.background.waiting(&self.parts),
            settings: &self.settings,
            ports: &self.ports,
            notice: self.notice.as_ref(),
            dialog: self.dialog.as_ref(),
            undo: (self.history.undo_name(), self.history.redo_name()),
            wave_time_s: self.wave_time_s,
        };
        let intents = view::show(ui, &scene, &mut view);
        self.view = view;
        self.perform(&ui.ctx().clone(), intents);
    }
}

fn set_theme(ctx: &egui::Context, choice: ThemeChoice) {
    ctx.set_theme(match choice {
        ThemeChoice::Light => egui::ThemePreference::Light,
        ThemeChoice::Dark => egui::ThemePreference::Dark,
        ThemeChoice::System => egui::ThemePreference::System,
    });
}

/// The setup of a first start.
#[must_use]
pub fn first_setup() -> Option<Setup> {
    slipline_plate::presets().first()?.plate().map(|plate| Setup::new(Arc::new(plate)))
}
