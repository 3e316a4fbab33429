//! The app in a window of the system: its stored state and its threads.

use super::{App, Jobs, Link, Parts, PressAges, Services, event_loop, first_setup, no_display};
use crate::files::SystemFiles;
use crate::settings::Settings;
use crate::sound::SystemSpeaker;
use crate::view::theme;
use eframe::egui;
use slipline_instrument::bench::Bench;
use slipline_link::Port;
use slipline_link::native::list_ports;
use slipline_link::native::{Handle, SystemOpener, Worker, stop_on_panic};
use slipline_link::simulator::Options;
use slipline_model::export::figures::plate;
use slipline_model::jobs::JobQueue;
use slipline_model::scenes::thumbnails;
use slipline_model::setup::file::{self as setup_file, Opened};
use std::io;
use std::path::PathBuf;

/// The app in a window of the system.
struct Window {
    app: App,
    /// Whether the window was made to fit the screen.
    is_fitted: bool,
    /// Whether settings and setup are stored.
    is_kept: bool,
    /// It ends, and stops the device, with the window.
    _worker: Worker,
}

/// The smallest size of the window, in points: a telephone is as narrow, and a screen of 1280 x 800 pixels at two a point as low,
/// where bars of the system take their part.
const LEAST_SIZE: [f32; 2] = [360.0, 320.0];
/// Keys of the values that are stored between runs.
const KEPT_SETTINGS: &str = "settings";
const KEPT_SETUP: &str = "setup";

impl eframe::App for Window {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.is_fitted = self.is_fitted || fit_to_screen(ctx);
        self.app.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.app.show(ui);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::ground(visuals)
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if !self.is_kept {
            return;
        }
        storage.set_string(KEPT_SETTINGS, self.app.settings.write());
        storage.set_string(KEPT_SETUP, setup_file::write(&self.app.kept_setup()));
    }

    fn persist_egui_memory(&self) -> bool {
        // The state of pages and scroll areas is not stored: a stored state that caused a crash would cause it
        // again.
        false
    }
}

/// What a window opens with, instead of what was used last.
#[derive(Clone, Debug, Default)]
pub struct Opening {
    /// A setup or plate file.
    pub file: Option<PathBuf>,
    /// The port. The window connects to it; a real device is armed by the user only.
    pub port: Option<Port>,
    /// Whether the window is for visitors: full screen, scenes in turn, no menus; nothing of it is kept.
    pub kiosk: bool,
}

/// Opens the window and returns when it is closed. `opened` receives the link and a handle that closes the window
/// from any thread, for the code that ends the program.
///
/// # Errors
/// When there is no display, or the system cannot start a thread.
pub fn run(
    opening: Opening,
    opened: impl FnOnce(Handle, Box<dyn FnMut() + Send>) + 'static,
) -> anyhow::Result<()> {
    let options = eframe::NativeOptions {
        viewport: viewport().with_fullscreen(opening.kiosk),
        // The next window is not as large as the visitors' was.
        persist_window: !opening.kiosk,
        ..Default::default()
    };
    let open = |context: &eframe::CreationContext<'_>| {
        let (window, link) = open(context, opening, opened)?;
        let press_ages = window.app.press_ages();
        Ok((Box::new(window) as Box<dyn eframe::App>, link, press_ages))
    };
    event_loop::run("Slipline", options, open, || ())
        .map_err(|error| anyhow::anyhow!(no_display::explain(&error)))
}

/// Room that the bars of the system take beside the window, in points: a title bar and a task bar.
const BARS: f32 = 80.0;

/// Makes a window smaller that would lie under the bars of the system; returns whether the screen's size is known.
fn fit_to_screen(ctx: &egui::Context) -> bool {
    let (screen, inner, is_filling) = ctx.input(|input| {
        let window = input.viewport();
        let is_filling = window.maximized == Some(true) || window.fullscreen == Some(true);
        (window.monitor_size, window.inner_rect, is_filling)
    });
    let (Some(screen), Some(inner)) = (screen, inner) else { return false };
    let height = (screen.y - BARS).max(LEAST_SIZE[1]);
    if inner.height() > height && !is_filling {
        ctx.send_viewport_cmd(egui::ViewportCommand::InnerSize(egui::vec2(inner.width(), height)));
    }
    true
}

fn viewport() -> egui::ViewportBuilder {
    egui::ViewportBuilder::default()
        .with_title("Slipline")
        .with_app_id("slipline")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size(LEAST_SIZE)
        .with_clamp_size_to_monitor_size(true)
        .with_drag_and_drop(true)
}

/// Closes the window from any thread, as if the user had closed it.
fn closer(ctx: &egui::Context) -> Box<dyn FnMut() + Send> {
    let ctx = ctx.clone();
    Box::new(move || {
        ctx.send_viewport_cmd_to(egui::ViewportId::ROOT, egui::ViewportCommand::Close);
        ctx.request_repaint_of(egui::ViewportId::ROOT);
    })
}

/// A call that has the window look for what is new.
fn wake(ctx: &egui::Context) -> impl Fn() + Clone + Send + 'static {
    let ctx = ctx.clone();
    move || ctx.request_repaint()
}

impl Parts {
    /// The parts that the window works with: each job has a thread of its own.
    ///
    /// # Errors
    /// When the system cannot start a thread.
    pub fn threaded(ctx: &egui::Context, link: Box<dyn Link>) -> io::Result<Self> {
        let jobs = Jobs::threaded(wake(ctx))?;
        let services = Services {
            scenes: JobQueue::threaded("slipline-scenes", |(), task: &_| thumbnails(task), wake(ctx))?,
            figures: JobQueue::threaded(
                "slipline-figure",
                |job, task: &_| plate::work(&job, task),
                wake(ctx),
            )?,
            speaker: Box::new(SystemSpeaker::new(wake(ctx))?),
            files: Box::new(SystemFiles::new(wake(ctx))),
            ports: Box::new(list_ports),
            ask_for_port: None,
            address: None,
            press_ages: PressAges::default(),
        };
        Ok(Self { link, jobs, bench: Bench::default(), services })
    }
}

fn open(
    context: &eframe::CreationContext<'_>,
    opening: Opening,
    opened: impl FnOnce(Handle, Box<dyn FnMut() + Send>),
) -> anyhow::Result<(Window, Handle)> {
    let ctx = &context.egui_ctx;
    let bench = Bench::default();
    let wired = bench.clone();
    let worker =
        Worker::spawn_with(SystemOpener::wired(Options::default(), move || wired.inputs()), wake(ctx))?;
    let handle = worker.handle();
    stop_on_panic(handle.clone());
    opened(handle.clone(), closer(ctx));
    let parts = Parts { bench, ..Parts::threaded(ctx, Box::new(handle.clone()))? };
    let kept = |key: &str| context.storage.and_then(|storage| storage.get_string(key));
    let mut settings = kept(KEPT_SETTINGS).as_deref().map(Settings::read).unwrap_or_default();
    let is_first_start = kept(KEPT_SETTINGS).is_none() && opening.port.is_none() && opening.file.is_none();
    // What visitors see begins on the simulated device.
    if let Some(port) = opening.port.or(opening.kiosk.then_some(Port::Simulated)) {
        settings.port = Some(port.to_string());
    }
    let setup = match kept(KEPT_SETUP).as_deref().map(setup_file::read) {
        Some(Ok(Opened::Setup(setup))) => *setup,
        _ => first_setup().ok_or_else(|| anyhow::anyhow!("the first preset is damaged"))?,
    };
    let mut app = App::new(ctx, parts, setup, settings);
    if opening.kiosk {
        // eframe gives the window the size that it had last, also where the options say otherwise.
        ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(true));
        app.open_to_visitors();
    } else if is_first_start {
        app.demonstrate();
    }
    if let Some(file) = opening.file {
        app.open(file);
    }
    Ok((Window { app, is_fitted: opening.kiosk, is_kept: !opening.kiosk, _worker: worker }, handle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{ViewportCommand, ViewportId};

    #[test]
    fn the_smallest_window_fits_a_low_screen_with_the_bars_of_the_system_and_a_telephone() {
        // A title bar and a task bar take up to 40 points each.
        let least = viewport().min_inner_size;
        assert!(least.is_some_and(|size| size.x <= 360.0 && size.y <= 400.0 - 2.0 * 40.0), "{least:?}");
    }

    /// The commands to the window after one more frame.
    fn commands(ctx: &egui::Context) -> Vec<ViewportCommand> {
        let mut output = ctx.run_ui(egui::RawInput::default(), |_| {});
        // There is no renderer to take them.
        output.textures_delta.clear();
        output.viewport_output[&ViewportId::ROOT].commands.clone()
    }

    #[test]
    fn a_window_as_high_as_the_screen_makes_room_for_the_bars_of_the_system() {
        let resized = |screen: [f32; 2], inner: [f32; 2], maximized: bool| {
            let ctx = egui::Context::default();
            let mut input = egui::RawInput::default();
            let window = input.viewports.entry(ViewportId::ROOT).or_default();
            window.monitor_size = Some(screen.into());
            window.inner_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, inner.into()));
            window.maximized = Some(maximized);
            let mut output = ctx.run_ui(input, |ui| assert!(fit_to_screen(ui.ctx())));
            output.textures_delta.clear();
            let commands = output.viewport_output[&ViewportId::ROOT].commands.clone().into_iter();
            commands.filter(|command| matches!(command, ViewportCommand::InnerSize(_))).collect::<Vec<_>>()
        };
        let sized = |size: [f32; 2]| vec![ViewportCommand::InnerSize(size.into())];
        assert_eq!(resized([1280.0, 800.0], [1280.0, 800.0], false), sized([1280.0, 720.0]));
        assert_eq!(resized([640.0, 480.0], [640.0, 480.0], false), sized([640.0, 400.0]));
        // 1280 x 800 pixels at two a point.
        assert_eq!(resized([640.0, 400.0], [640.0, 400.0], false), sized([640.0, 320.0]));
        assert_eq!(resized([1920.0, 1080.0], [1280.0, 800.0], false), []);
        assert_eq!(resized([1280.0, 800.0], [1280.0, 800.0], true), []);
    }

    #[test]
    fn another_thread_can_close_the_window() {
        let ctx = egui::Context::default();
        assert!(!commands(&ctx).contains(&ViewportCommand::Close));
        let close = closer(&ctx);
        std::thread::spawn(close).join().unwrap();
        assert!(commands(&ctx).contains(&ViewportCommand::Close));
    }
}
