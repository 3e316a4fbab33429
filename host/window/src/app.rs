//! The app: the shell around an [`Instrument`]. It hands on the requests of keys, pointer and views, and owns what only
//! a window has: settings, files, pages, sound, pictures.
//!
//! ```text
//! views --Intent--> App --calls--> Instrument --Request--> link worker --> device
//!   ^                |  <-Output--     |       <-Snapshot-- link worker <-- device
//!   +--- Scene ------+  <-Shown---     +-- Jobs (threads)
//! ```
//! Nothing here blocks: work that takes longer than a frame runs in the link worker, a [`JobQueue`] or [`Files`].

mod demonstration;
#[cfg(not(target_arch = "wasm32"))]
mod eframe_log;
#[cfg(not(target_arch = "wasm32"))]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "the system's clock"))]
mod event_loop;
mod glyphs;
mod input;
mod kiosk;
#[cfg(all(unix, not(target_vendor = "apple"), not(target_arch = "wasm32")))]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "the system's environment and folders"))]
mod libraries;
#[cfg(not(target_arch = "wasm32"))]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "the system's environment"))]
mod no_display;
mod outputs;
#[cfg(not(target_arch = "wasm32"))]
mod pace;
mod paths;
mod perform;
mod press_ages;
mod sound;
#[cfg(not(target_arch = "wasm32"))]
mod window;

#[cfg(not(target_arch = "wasm32"))]
pub use event_loop::run as run_in_event_loop;
pub use press_ages::PressAges;
pub use slipline_instrument::{Jobs, Link};
pub use slipline_model::jobs::table::{TableJob, TableMade, TableState};
#[cfg(not(target_arch = "wasm32"))]
pub use window::{Opening, run};

use crate::files::{FileJob, Files};
use crate::intent::{Dialog, Grab};
use crate::scene::{Notice, Scene, SoundScene};
use crate::settings::{Settings, ThemeChoice};
use crate::sound::Speaker;
use crate::view::{self, ViewState, theme};
use eframe::egui;
use slipline_instrument::bench::Bench;
use slipline_instrument::{DeviceIntent, DragRecorder, Instrument, Shown};
use slipline_link::{Port, PortInfo};
use slipline_model::export::figures::plate::{self, FigureJob};
use slipline_model::export::figures::{DrawError, encode};
use slipline_model::field::steady_field::{SteadyField, magnification};
use slipline_model::jobs::JobQueue;
use slipline_model::scenes::{SCENES, Thumbnail};
use slipline_model::setup::Setup;
use std::f64::consts::SQRT_2;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, LazyLock};

/// The parts that the app works with; tests pass their own.
pub struct Parts {
    /// The link.
    pub link: Box<dyn Link>,
    /// The instrument's work.
    pub jobs: Jobs,
    /// The rig at the simulated device's inputs.
    pub bench: Bench,
    /// What the window uses itself.
    pub services: Services,
}

/// What a window uses and an instrument does not: pictures, sound, files, ports, its address.
pub struct Services {
    /// Draws small pictures of the scenes.
    pub scenes: JobQueue<(), Vec<Thumbnail>>,
    /// Draws figures.
    pub figures: JobQueue<FigureJob, Result<plate::File, DrawError>>,
    /// Plays sound.
    pub speaker: Box<dyn Speaker>,
    /// Files.
    pub files: Box<dyn Files>,
    /// Lists the ports that exist, the simulated device first.
    pub ports: Box<dyn Fn() -> Vec<PortInfo>>,
    /// Has the user choose a board, which [`Services::ports`] lists from then on; `None` where every port is listed unasked.
    pub ask_for_port: Option<Box<dyn FnMut()>>,
    /// The address of the page that the window is on, without a fragment; `None` outside a browser.
    pub address: Option<String>,
    /// How long presses have waited.
    pub press_ages: PressAges,
}

/// Who decides what is on the stage.
#[derive(Clone, Copy, Debug)]
enum Lead {
    /// The user alone.
    User,
    /// The demonstration of the very first start.
    Demonstration(demonstration::Demonstration),
    /// The turn of the scenes that visitors see.
    Scenes(kiosk::Kiosk),
    /// The page around the window: it shows plate and line alone.
    Frame,
}

/// The app.
pub struct App {
    instrument: Instrument,
    services: Services,
    settings: Settings,
    grab: Option<Grab>,
    /// Magnification of displacements on the stage, relative to the table's full scale.
    magnification: f64,
    ports: Vec<PortInfo>,
    hearing: sound::Hearing,
    lead: Lead,
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
        let Parts { link, jobs, bench, services } = parts;
        let mut app = Self {
            instrument: Instrument::new(link, jobs, bench, setup),
            ports: (services.ports)(),
            services,
            settings,
            grab: None,
            magnification: 1.0,
            hearing: sound::Hearing::default(),
            lead: Lead::User,
            glyphs: glyphs::Glyphs::default(),
            dialog: None,
            behind: None,
            thumbnails: Vec::new(),
            asked: None,
            view: ViewState::default(),
            screenshots: channel(),
        };
        app.instrument.perform(DeviceIntent::AutoReconnect(app.settings.auto_reconnect));
        if first_setup().is_some_and(|first| first.plate == app.setup().plate) {
            app.rest_finger();
        }
        let port = app.settings.port.as_deref().and_then(|name| name.parse().ok()).unwrap_or(Port::Simulated);
        app.connect(port);
        app
    }

    /// Opens a setup or plate file, or what else the menu opens.
    pub fn open(&mut self, file: PathBuf) {
        self.services.files.begin(FileJob::Open(file));
    }

    /// The ages of the presses that a frame handles, for the shell to set before each.
    #[must_use]
    pub fn press_ages(&self) -> PressAges {
        self.services.press_ages.clone()
    }

    /// The user's setup.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        self.instrument.desk.setup()
    }

    /// The settings that are kept between runs.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the instrument shows.
    #[must_use]
    pub fn shown(&self) -> Shown<'_> {
        self.instrument.shown()
    }

    /// Looks for ports again.
    pub fn look_for_ports(&mut self) {
        self.ports = (self.services.ports)();
    }

    /// Shows a failure.
    pub fn fail(&mut self, text: String) {
        self.instrument.out.fail(text);
    }

    /// The recorded drag.
    #[must_use]
    pub fn recorder(&self) -> &DragRecorder {
        self.instrument.desk.recorder()
    }

    /// The latest message that is shown, if any.
    #[must_use]
    pub fn notice(&self) -> Option<&Notice> {
        self.instrument.out.notices().max_by_key(|notice| notice.number)
    }

    /// Processes everything that happened since the last frame. Paints nothing.
    pub fn logic(&mut self, ctx: &egui::Context) {
        self.attend(ctx);
        let revision = self.instrument.drive.snapshot().revision;
        self.instrument.take_reports();
        if self.instrument.drive.snapshot().revision != revision {
            // The link decides, but only after it has received what the user has just chosen.
            self.settings.auto_reconnect = self.instrument.drive.snapshot().link.auto_reconnect;
        }
        self.take_results();
        self.advance_demonstration(ctx);
        self.keep_to_stage();
        self.turn_scenes(ctx);
        if self.has_new_input(ctx) {
            self.keys(ctx);
            self.follow_pointer(ctx);
            self.dropped_files(ctx);
        }
        self.attend(ctx);
        self.instrument.turn();
        self.carry_out(ctx);
        self.move_on(ctx);
        self.play_sound();
    }

    fn take_results(&mut self) {
        if let Some(drawn) = self.services.scenes.take() {
            self.thumbnails = drawn;
        }
        while let Some(event) = self.services.files.take() {
            self.file_event(event);
        }
        match self.services.figures.take() {
            Some(Ok(plate::File { format, bytes })) => {
                let extension = format.extension();
                self.save(&format!("figure.{extension}"), "Picture", extension, bytes);
            }
            Some(Err(reason)) => self.instrument.out.fail(format!("The figure could not be made: {reason}")),
            None => {}
        }
        if let Ok(image) = self.screenshots.1.try_recv() {
            match screenshot_png(&image) {
                Ok(bytes) => self.save("screenshot.png", "Picture", "png", bytes),
                Err(error) => self.instrument.out.fail(format!("The screenshot could not be made: {error}")),
            }
        }
    }

    /// Shows the window in all of `ui`, then carries out the intents of its views.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        self.look_for_glyphs(ui.ctx());
        self.magnify(ui.ctx());
        let mut view = std::mem::take(&mut self.view);
        let sound = SoundScene {
            choice: self.sound_choice(),
            speaker: self.services.speaker.state(),
            unplayed: self.unplayed(),
        };
        let scene = Scene {
            instrument: self.instrument.shown(),
            grab: self.grab,
            sound,
            settings: &self.settings,
            magnification: self.magnification,
            stage_alone: self.stage_alone(),
            ports: &self.listed_ports(),
            dialog: self.dialog.as_ref(),
            has_address: self.services.address.is_some(),
            asks_for_port: self.services.ask_for_port.is_some(),
            thumbnails: &self.thumbnails,
        };
        let intents = view::show(ui, &scene, &mut view);
        self.view = view;
        self.perform(&ui.ctx().clone(), intents);
        self.view.is_stopped = false;
        self.view.was_typing = ui.ctx().text_edit_focused();
    }
}

impl App {
    /// The ports to choose from: those that were found, and the present one.
    fn listed_ports(&self) -> Vec<PortInfo> {
        let mut ports = self.ports.clone();
        let current = self.instrument.drive.snapshot().link.port.clone();
        if let Some(port) = current.filter(|port| ports.iter().all(|info| info.port != *port)) {
            ports.push(PortInfo { label: port.to_string(), port, is_ours: false, usb_serial: None });
        }
        ports
    }

    /// Chooses the scale of the stage by its content. While something is pressed it stays, unless the content outgrows it.
    /// With the brush there is room to draw twice as high.
    fn magnify(&mut self, ctx: &egui::Context) {
        let shown = self.instrument.shown();
        let needed_m = if self.view.brush.is_taken {
            // By the mean, which is drawn: what all tones could reach together is a bound far over it.
            let mean_m = shown.predicted.rms_m.iter().copied().fold(0.0, f64::max);
            let drawn_m = shown.texture.draft.level_m.filter(|_| shown.texture.is_drawn).unwrap_or(0.0);
            // While it is drawn it stands where the pointer is, beyond what the tones reach.
            let shown_share = if self.view.brush.is_drawing() { 1.0 } else { shown.texture.reached };
            let drawn_m = shown_share * drawn_m;
            2.0 * SQRT_2 * mean_m.max(drawn_m)
        } else {
            shown.sounding.map_or(0.0, SteadyField::highest_m).max(shown.predicted.highest_m())
        };
        let share = shown.full_peak_m.map_or(1.0, |full_peak_m| needed_m / full_peak_m);
        let fitting = if share > 0.0 { magnification(share) } else { 1.0 };
        let is_held = self.grab.is_some() || ctx.input(|input| input.pointer.any_down());
        self.magnification = if is_held { self.magnification.min(fitting) } else { fitting };
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
    static FIRST: LazyLock<Option<Setup>> = LazyLock::new(|| SCENES.first()?.setup());
    FIRST.clone()
}
