//! The app: takes what the views ask for, changes the setup, asks the link, and keeps what the views show current.
//!
//! ```text
//! views --Intent--> App --Edit--> Setup --DriveRequest--> link worker --> device
//!   ^                |  <--Snapshot-- link worker <-- device
//!   +--- Scene ------+  <--table, files, simulated plate-- threads
//! ```
//! Nothing here waits: what takes longer than a frame is done by the link worker, a [`Workshop`] or [`Files`].

use crate::edit::{self, Edit, History};
use crate::export;
use crate::files::{FileEvent, FileJob, Files, Save, SystemFiles};
use crate::link::worker::{Worker, stop_on_panic};
use crate::link::{Port, PortInfo, Request, Snapshot, Ticket, list_ports};
use crate::live::{self, Live};
use crate::model::Setup;
use crate::picture::{Picture, steady_tones, turning_point_for};
use crate::pilot::{self, Pilot};
use crate::settings::{Settings, ThemeChoice};
use crate::setup_file::{self, Opened};
pub use crate::tables::{TableJob, TableMade, TableState};
use crate::trial::{self, Measured};
use crate::view::intent::{Confirm, Dialog, Export, Grab, Intent, Intents};
use crate::view::{self, Scene, ViewState, theme};
use crate::workshop::Workshop;
use eframe::egui::{self, Key, Modifiers};
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
    /// Where the mirror follows the device.
    pub live: Workshop<live::Job, Live>,
    /// Where the simulated plate is run.
    pub trials: Workshop<trial::Job, Option<Measured>>,
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
    live: Live,
    measured: Option<Measured>,
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
        let snapshot = parts.link.snapshot();
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
            snapshot,
            ports,
            table: TableState::Waiting,
            table_asked: None,
            predicted: Picture::default(),
            sounding: None,
            live: Live::default(),
            measured: None,
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
        self.advance(ctx);
    }

    fn look_at_link(&mut self) {
        let snapshot = self.parts.link.snapshot();
        let before = std::mem::replace(&mut self.snapshot, snapshot);
        if before.revision == self.snapshot.revision {
            return;
        }
        self.settings.auto_reconnect = self.snapshot.auto_reconnect;
        if let Some((ticket, reason)) = &self.snapshot.last_refusal
            && before.last_refusal.as_ref().map(|(ticket, _)| ticket) != Some(ticket)
        {
            self.notice = Some(Notice { text: format!("Refused: {reason}"), is_error: true });
        }
        self.ask_for_table();
        self.let_pilot_act(&before);
        self.hear();
    }

    fn let_pilot_act(&mut self, before: &Snapshot) {
        let made = self.table.made().filter(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
        for act in self.pilot.look(before, &self.snapshot, made, &self.settings) {
            match act {
                pilot::Act::Upload(table) => drop(self.parts.link.send(Request::Upload(table))),
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
                self.table = table;
                self.predict();
                let snapshot = Arc::clone(&self.snapshot);
                self.let_pilot_act(&snapshot);
            }
        }
        if let Some(live) = self.parts.live.take()
            && self.settings.animate
        {
            self.live = live;
        }
        if let Some(measured) = self.parts.trials.take() {
            self.measured = measured;
        }
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

    fn file_event(&mut self, event: FileEvent) {
        match event {
            FileEvent::Opened(path, text) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let opened = text.and_then(|text| setup_file::read(&text).map_err(|error| error.to_string()));
                match opened {
                    Ok(Opened::Setup(setup)) => self.edit(&Edit::Replace(setup)),
                    Ok(Opened::Plate(plate)) => self.edit(&Edit::Plate(plate)),
                    Err(reason) => {
                        return self.fail(format!("{name} was not opened, nothing has changed. {reason}"));
                    }
                }
                self.settings.used(&path);
                self.notice = Some(Notice { text: format!("Opened {name}"), is_error: false });
            }
            FileEvent::Saved(path, Ok(())) => {
                if path.extension().is_some_and(|extension| extension == "toml") {
                    self.settings.used(&path);
                }
                self.notice = Some(Notice { text: format!("Saved {}", path.display()), is_error: false });
            }
            FileEvent::Saved(path, Err(reason)) => {
                self.fail(format!("{} was not saved: {reason}", path.display()));
            }
        }
    }

    fn fail(&mut self, text: String) {
        self.notice = Some(Notice { text, is_error: true });
    }

    fn keys(&mut self, ctx: &egui::Context) {
        let is_typing = ctx.text_edit_focused();
        let focused = ctx.memory(egui::Memory::focused);
        let mut asked = Intents::new();
        let presses = ctx.input_mut(|input| {
            let is_press = |event: &&egui::Event| {
                matches!(
                    event,
                    egui::Event::Key { pressed: true, repeat: false, .. }
                        | egui::Event::PointerButton { pressed: true, .. }
                )
            };
            let presses = input.events.iter().filter(is_press).count() as u64;
            // Escape is looked at, not taken: it also closes pages and leaves fields.
            if input.key_pressed(Key::Escape) {
                asked.push(Intent::Stop);
            }
            if !is_typing {
                if input.consume_key(Modifiers::NONE, Key::Space) {
                    asked.push(Intent::Stop);
                }
                if input.consume_key(Modifiers::NONE, Key::P) {
                    self.settings.animate = !self.settings.animate;
                }
            }
            if input.consume_key(Modifiers::COMMAND, Key::Enter) {
                asked.push(Intent::Start);
            }
            let redo = input.consume_key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
                || input.consume_key(Modifiers::COMMAND, Key::Y);
            if redo {
                asked.push(Intent::Redo);
            } else if input.consume_key(Modifiers::COMMAND, Key::Z) {
                asked.push(Intent::Undo);
            }
            if input.consume_key(Modifiers::COMMAND, Key::O) {
                asked.push(Intent::OpenDialog);
            }
            if input.consume_key(Modifiers::COMMAND, Key::S) {
                asked.push(Intent::SaveDialog);
            }
            if input.consume_key(Modifiers::NONE, Key::F1) {
                asked.push(Intent::Dialog(Some(Dialog::Shortcuts)));
            }
            for (index, key) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4].into_iter().enumerate() {
                if input.consume_key(Modifiers::COMMAND, key) {
                    self.view.open_tab(index);
                }
            }
            // A focused slider or field keeps its arrow keys.
            if focused.is_none() || self.view.is_handle(focused) {
                let step_m = view::arrow_step_m(input);
                if step_m != 0.0
                    && let Some(tone) = self.setup.tone(self.selected)
                {
                    let position_m = tone.position_m + step_m;
                    asked.push(Intent::Edit(Edit::Move { slot: self.selected, position_m }));
                }
            }
            presses
        });
        self.gesture += presses;
        self.perform(ctx, asked);
    }

    /// A drag: each move of the pointer is a move of the tone, sent before anything is painted.
    fn follow_pointer(&mut self, ctx: &egui::Context) {
        let Some(grab) = self.grab else { return };
        let (moves, is_down) = ctx.input(|input| {
            let moves: Vec<egui::Pos2> = input
                .events
                .iter()
                .filter_map(|event| if let egui::Event::PointerMoved(to) = event { Some(*to) } else { None })
                .collect();
            (moves, input.pointer.primary_down())
        });
        for to in moves {
            self.drag_to(grab, to);
        }
        if !is_down {
            self.grab = None;
        }
    }

    fn drag_to(&mut self, grab: Grab, pointer: egui::Pos2) {
        let Some(tone) = self.setup.tone(grab.slot) else { return };
        let shown_m = grab.axis.place_from_screen(pointer.x - grab.offset);
        let peak_m = tone.level * self.setup.master() * self.full_peak_m();
        let plate = &self.setup.plate;
        let position_m = turning_point_for(plate, shown_m, peak_m, self.setup.boundary)
            .unwrap_or_else(|| shown_m.clamp(plate.span_m().0, plate.span_m().1));
        self.settings.has_dragged = true;
        self.edit(&Edit::Move { slot: grab.slot, position_m });
    }

    fn dropped_files(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if let Some(file) = dropped.first() {
            self.parts.files.begin(FileJob::Open(file.path().to_owned()));
        }
    }

    /// Moves the wave on and asks for the next picture, but only while something moves.
    fn advance(&mut self, ctx: &egui::Context) {
        let is_visible = ctx.input(|input| {
            let viewport = input.viewport();
            viewport.minimized != Some(true) && viewport.occluded != Some(true)
        });
        if self.sounding.is_none() || !is_visible {
            return;
        }
        if self.settings.animate {
            let step = ctx.input(|input| f64::from(input.stable_dt.min(0.1)));
            self.wave_time_s += step;
            ctx.request_repaint_after(FRAME);
        } else {
            ctx.request_repaint_after(GLANCE);
        }
    }

    /// Makes a change, notes it, and tells the device at once if the plate is driven.
    fn edit(&mut self, edit: &Edit) {
        match edit::apply(&self.setup, edit) {
            Ok(next) if next == self.setup => {}
            Ok(next) => {
                self.history.note(&self.setup, edit, self.gesture);
                self.take(next);
            }
            Err(error) => self.fail(error.to_string()),
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

    /// Solves for what the device has acknowledged, when that has changed, and has it tried on the simulated plate.
    fn hear(&mut self) {
        if let Some(job) = live::Job::of(&self.snapshot) {
            self.parts.live.ask(job);
        }
        let Some(heard) = pilot::sounding(&self.snapshot) else {
            self.sounding = None;
            return;
        };
        if self.sounding.as_ref().is_some_and(|(number, _)| *number == heard.number) {
            return;
        }
        self.sounding = Some((heard.number, Picture::solve(&self.setup.plate, &heard.tones)));
        let is_simulated = self.snapshot.identity.as_ref().is_some_and(|identity| identity.simulated);
        if is_simulated && let Some(identity) = &self.snapshot.identity {
            self.parts.trials.ask(trial::Job {
                number: heard.number,
                plate: Arc::clone(&self.setup.plate),
                table: heard.table,
                drive: heard.drive,
                dac_bits: identity.dac_bits,
            });
        }
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

    fn perform(&mut self, ctx: &egui::Context, intents: Intents) {
        for intent in intents {
            match intent {
                Intent::Edit(edit) => self.edit(&edit),
                Intent::Request(request) => {
                    if let Request::AutoReconnect(looks) = request {
                        self.settings.auto_reconnect = looks;
                    }
                    self.parts.link.send(request);
                }
                Intent::Connect(port) => self.connect(port),
                Intent::Start => {
                    if self.pilot.start(&self.snapshot) {
                        self.send_drive();
                    }
                }
                Intent::Stop => self.stop(),
                Intent::Select(slot) => self.selected = slot,
                Intent::Grab(grab) => {
                    self.grab = Some(grab);
                }
                Intent::Undo => {
                    if let Some(setup) = self.history.undo(&self.setup) {
                        self.take(setup);
                    }
                }
                Intent::Redo => {
                    if let Some(setup) = self.history.redo(&self.setup) {
                        self.take(setup);
                    }
                }
                Intent::New => {
                    if let Some(setup) = first_setup() {
                        self.edit(&Edit::Replace(Box::new(setup)));
                    }
                }
                Intent::OpenDialog => self.parts.files.begin(FileJob::Choose),
                Intent::Open(path) => self.parts.files.begin(FileJob::Open(path)),
                Intent::SaveDialog => {
                    let text = setup_file::write(&self.setup);
                    self.save("setup.toml", "Setup", "toml", text.into_bytes());
                }
                Intent::SavePlateDialog => {
                    let text = self.setup.plate.to_toml();
                    self.save("plate.toml", "Plate", "toml", text.into_bytes());
                }
                Intent::Export(export) => self.export(ctx, export),
                Intent::Upload => {
                    if let Some(made) = self.table.made() {
                        self.parts.link.send(Request::Upload(Arc::clone(&made.device_table)));
                    }
                }
                Intent::Theme(choice) => {
                    self.settings.theme = choice;
                    set_theme(ctx, choice);
                }
                Intent::Dialog(dialog) => self.dialog = dialog,
                Intent::Confirmed(confirm) => {
                    self.dialog = None;
                    self.parts.link.send(match confirm {
                        Confirm::Arm => Request::Arm,
                        Confirm::Store => Request::Store,
                        Confirm::Forget => Request::Forget,
                        Confirm::Bootloader => Request::Bootloader,
                    });
                }
                Intent::DismissNotice => self.notice = None,
                Intent::RefreshPorts => self.ports = (self.parts.ports)(),
                Intent::Animate(animate) => self.settings.animate = animate,
                Intent::Copy(text) => ctx.copy_text(text),
            }
            ctx.request_repaint();
        }
    }

    fn save(&mut self, name: &str, kind: &'static str, extension: &'static str, bytes: Vec<u8>) {
        let save = Save { name: name.to_owned(), kind, extension, bytes: bytes.into() };
        self.parts.files.begin(FileJob::Save(save));
    }

    fn export(&mut self, ctx: &egui::Context, what: Export) {
        match what {
            Export::Picture => {
                let (sender, waker) = (self.screenshots.0.clone(), ctx.clone());
                let taken = egui::ScreenshotCallback::new(move |image| {
                    // Nobody waits for it once the window is closed.
                    let _ = sender.send(image);
                    waker.request_repaint();
                });
                ctx.send_viewport_cmd(egui::ViewportCommand::Screenshot(taken));
            }
            Export::Envelope => {
                let text = export::envelope_csv(&self.predicted, self.current_measured());
                self.save("envelope.csv", "Table", "csv", text.into_bytes());
            }
            Export::Waveform => match export::waveform_csv(&self.live) {
                Some(text) => self.save("waveform.csv", "Table", "csv", text.into_bytes()),
                None => self.fail("Nothing is driven, so there is no waveform to save".to_owned()),
            },
            Export::Sound => match export::wav(&self.live) {
                Ok(Some(bytes)) => self.save("drive.wav", "Sound", "wav", bytes),
                Ok(None) => self.fail("Nothing is driven, so there is no drive to save".to_owned()),
                Err(error) => self.fail(format!("The sound could not be made: {error}")),
            },
            Export::Diagnostics => {
                let text = export::diagnostics(&self.snapshot, &self.setup, &self.table);
                self.save("slipline-diagnostics.txt", "Text", "txt", text.into_bytes());
            }
        }
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
            sounding: self.sounding.as_ref().map(|(_, picture)| picture),
            full_peak_m: self.full_peak_m(),
            table: &self.table,
            live: &self.live,
            measured: self.current_measured(),
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

/// The app in a window of the system.
struct Window(App);

/// Keys of what is kept between runs.
const KEPT_SETTINGS: &str = "settings";
const KEPT_SETUP: &str = "setup";

impl eframe::App for Window {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.0.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEPT_SETTINGS, &self.0.settings);
        storage.set_string(KEPT_SETUP, setup_file::write(&self.0.setup));
    }

    fn persist_egui_memory(&self) -> bool {
        // What a page shows and where it was scrolled to is not worth an old crash coming back.
        false
    }
}

/// Opens the window and stays until it is closed.
///
/// # Errors
/// When there is no display, or the system gives no thread.
pub fn run() -> anyhow::Result<()> {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Slipline")
        .with_app_id("slipline")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([960.0, 620.0])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    eframe::run_native("Slipline", options, Box::new(|context| Ok(Box::new(open(context)?))))
        .map_err(|error| anyhow::anyhow!("the window could not be opened: {error}"))
}

fn open(context: &eframe::CreationContext<'_>) -> anyhow::Result<Window> {
    let ctx = &context.egui_ctx;
    let wake = |ctx: &egui::Context| {
        let ctx = ctx.clone();
        move || ctx.request_repaint()
    };
    let worker = Worker::spawn(wake(ctx))?;
    stop_on_panic(worker.handle());
    let parts = Parts {
        link: Box::new(worker),
        tables: Workshop::threaded("slipline-table", crate::tables::make, wake(ctx))?,
        live: Workshop::threaded("slipline-mirror", live::work(), wake(ctx))?,
        trials: Workshop::threaded("slipline-plate", |job| trial::run(&job), wake(ctx))?,
        files: Box::new(SystemFiles::new(wake(ctx))),
        ports: Box::new(list_ports),
    };
    let settings =
        context.storage.and_then(|storage| eframe::get_value(storage, KEPT_SETTINGS)).unwrap_or_default();
    let kept = context.storage.and_then(|storage| storage.get_string(KEPT_SETUP));
    let setup = match kept.as_deref().map(setup_file::read) {
        Some(Ok(Opened::Setup(setup))) => *setup,
        _ => first_setup().ok_or_else(|| anyhow::anyhow!("the first preset is damaged"))?,
    };
    Ok(Window(App::new(ctx, parts, setup, settings)))
}
