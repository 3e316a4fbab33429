//! The app on a simulated device in virtual time: no thread, no clock, no display.

use crate::fake_files::FakeFiles;
use crate::fake_speaker::FakeSpeaker;
use crate::known_results::{calibrations, checks, tables};
use crate::pluggable_port::{SteppedLink, SteppedWorker};
use eframe::egui;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use slipline_link::simulator::SimulatedInputs;
use slipline_link::{PortInfo, Request, Snapshot};
use slipline_model::export::figures;
use slipline_model::field::sheet;
use slipline_model::field::time_domain;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::plane;
use slipline_model::scenes;
use slipline_model::setup::file as setup_file;
use slipline_model::setup::{BoundaryMode, Setup};
use slipline_plate::plane::PlaneError;
use slipline_window::app::{App, Jobs, Link, Parts, PressAges, Services, TableJob, TableState, first_setup};
use slipline_window::settings::{Settings, ThemeChoice};
use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

/// The app, its device and its files.
pub(crate) struct TestApp {
    /// The window.
    pub(crate) window: Harness<'static, App>,
    /// The files.
    pub(crate) files: FakeFiles,
    /// What is heard.
    pub(crate) speaker: FakeSpeaker,
    /// Number of jobs for the 2-D sheet so far.
    pub(crate) sheet_jobs: Rc<Cell<usize>>,
    /// Whether the simulated plate in time gives no result.
    time_domain_is_held: Rc<Cell<bool>>,
    /// Jobs that the simulated plate in time was asked for.
    pub(crate) time_domain_jobs: Rc<Cell<usize>>,
    /// Why the computation in two dimensions is refused; `None` while it is not.
    pub(crate) plane_refusal: Rc<RefCell<Option<PlaneError>>>,
    worker: Rc<RefCell<SteppedWorker>>,
}

/// The simulated device of a test.
struct Device {
    is_plugged: bool,
    /// What its inputs see.
    inputs: Option<(Box<dyn SimulatedInputs>, Bench)>,
    picture: Picture,
}

/// What is computed of a drive for the picture.
#[derive(PartialEq)]
enum Picture {
    /// Codes, sheet and plate in time.
    Whole,
    /// All but the sheet, a quarter of what a test of a driving device computes: modal lines stand in for it.
    WithoutSheet,
    Nothing,
}

impl Device {
    fn plugged(inputs: Option<(Box<dyn SimulatedInputs>, Bench)>) -> Self {
        Self { is_plugged: true, inputs, picture: Picture::Whole }
    }
}

impl TestApp {
    /// The app on a membrane, connected and driving. Its sheet does not run.
    pub(crate) fn driving() -> Self {
        Self::driving_with(ThemeChoice::Light, usual())
    }

    /// As [`Self::driving`], with its sheet.
    pub(crate) fn driving_with_sheet() -> Self {
        Self::driving_setup(membrane(), ThemeChoice::Light, usual())
    }

    /// As [`Self::driving`], with another theme and window.
    pub(crate) fn driving_with(theme: ThemeChoice, builder: egui_kittest::HarnessBuilder<App>) -> Self {
        Self::without_sheet(membrane(), theme, builder)
    }

    /// The app at its first start in this theme and window, with the scene of a first start. Its sheet does not run.
    pub(crate) fn first_start(theme: ThemeChoice, builder: egui_kittest::HarnessBuilder<App>) -> Self {
        Self::without_sheet(first_setup().unwrap(), theme, builder)
    }

    fn without_sheet(setup: Setup, theme: ThemeChoice, builder: egui_kittest::HarnessBuilder<App>) -> Self {
        let device = Device { picture: Picture::WithoutSheet, ..Device::plugged(None) };
        Self::starting_with(setup, theme, builder, tables(), device).once_driving()
    }

    /// The app with this setup, driving, with its sheet.
    pub(crate) fn driving_setup(
        setup: Setup,
        theme: ThemeChoice,
        builder: egui_kittest::HarnessBuilder<App>,
    ) -> Self {
        Self::starting_with(setup, theme, builder, tables(), Device::plugged(None)).once_driving()
    }

    /// The app on a membrane, driving a device with these inputs.
    pub(crate) fn sensed(inputs: Box<dyn SimulatedInputs>, bench: Bench) -> Self {
        let tables = tables();
        Self::starting_with(
            membrane(),
            ThemeChoice::Light,
            usual(),
            tables,
            Device::plugged(Some((inputs, bench))),
        )
        .once_driving()
    }

    /// As [`Self::sensed`], without what is computed for the picture of a drive alone.
    pub(crate) fn unseen(inputs: Box<dyn SimulatedInputs>, bench: Bench) -> Self {
        let device = Device { picture: Picture::Nothing, ..Device::plugged(Some((inputs, bench))) };
        Self::starting_with(membrane(), ThemeChoice::Light, usual(), tables(), device).once_driving()
    }

    /// As [`Self::sensed`], before any time has passed.
    pub(crate) fn sensed_from_the_start(inputs: Box<dyn SimulatedInputs>, bench: Bench) -> Self {
        let inputs = Some((inputs, bench));
        Self::starting_with(membrane(), ThemeChoice::Light, usual(), tables(), Device::plugged(inputs))
    }

    fn once_driving(mut self) -> Self {
        for _ in 0..40 {
            self.wait(50);
            if self.is_driving() {
                // Time for the plate to settle and the views to follow.
                self.wait(400);
                return self;
            }
        }
        panic!("the simulated plate does not move: {:?}", self.snapshot().record.log);
    }

    /// The app at its first start, with a job queue for tables that the test supplies.
    pub(crate) fn with_tables(tables: JobQueue<TableJob, TableState>) -> Self {
        Self::starting_with(membrane(), ThemeChoice::Light, usual(), tables, Device::plugged(None))
    }

    /// The app at its first start, with the device's cable pulled.
    pub(crate) fn unplugged() -> Self {
        Self::starting_with(
            membrane(),
            ThemeChoice::Light,
            usual(),
            tables(),
            Device { is_plugged: false, ..Device::plugged(None) },
        )
    }

    fn starting_with(
        setup: Setup,
        theme: ThemeChoice,
        builder: egui_kittest::HarnessBuilder<App>,
        tables: JobQueue<TableJob, TableState>,
        Device { is_plugged, inputs, picture }: Device,
    ) -> Self {
        let (inputs, bench) = inputs.map_or_else(Default::default, |(inputs, bench)| (Some(inputs), bench));
        let worker = Rc::new(RefCell::new(SteppedWorker::new(is_plugged, inputs)));
        let files = FakeFiles::default();
        let link = Box::new(SteppedLink(Rc::clone(&worker)));
        let sheet_jobs = Rc::default();
        let speaker = FakeSpeaker::default();
        let plane_refusal: Rc<RefCell<Option<PlaneError>>> = Rc::default();
        let refusal = Rc::clone(&plane_refusal);
        let mut parts = parts(link, &files, tables, &sheet_jobs);
        parts.services.speaker = Box::new(speaker.clone());
        parts.bench = bench;
        parts.jobs.planes = JobQueue::inline(move |job, task: &_| match refusal.borrow().clone() {
            Some(reason) => Some(Err(reason)),
            None => plane::work(job, task),
        });
        let time_domain_is_held: Rc<Cell<bool>> = Rc::default();
        let time_domain_jobs: Rc<Cell<usize>> = Rc::default();
        let (is_held, jobs) = (Rc::clone(&time_domain_is_held), Rc::clone(&time_domain_jobs));
        parts.jobs.time_domain = JobQueue::inline(move |job, task: &_| {
            jobs.set(jobs.get() + 1);
            if is_held.get() { None } else { time_domain::run(&job, task) }
        });
        if picture != Picture::Whole {
            parts.jobs.sheets = JobQueue::inline(|_, _: &_| None);
        }
        if picture == Picture::Nothing {
            time_domain_is_held.set(true);
            parts.jobs.waveforms = JobQueue::inline(|_, _: &_| None);
        }
        let window = open_window_with(parts, setup, theme, builder);
        Self {
            window,
            files,
            speaker,
            sheet_jobs,
            time_domain_is_held,
            time_domain_jobs,
            plane_refusal,
            worker,
        }
    }

    /// Lets this many milliseconds pass, with a frame of the window every 50 ms.
    pub(crate) fn wait(&mut self, ms: u64) {
        for _ in 0..ms.div_ceil(50) {
            self.worker.borrow_mut().advance(Duration::from_millis(50.min(ms)));
            self.window.step();
        }
    }

    /// Waits, frame by frame, for what another thread does as slowly as the computer pleases.
    pub(crate) fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        for _ in 0..3000 {
            self.wait(50);
            if is_so(self) {
                return;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("never {what}");
    }

    /// Lets this many milliseconds pass; with 0, a frame of the window without time of the device.
    fn then(&mut self, ms: u64) {
        if ms == 0 { self.window.step() } else { self.wait(ms) }
    }

    /// Whether something has this name; at most one may.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.window.query_by_label(name).is_some()
    }

    /// Whether the name of something contains this; that of one at most may.
    pub(crate) fn has_part(&self, part: &str) -> bool {
        self.window.query_by_label_contains(part).is_some()
    }

    /// Whether the name of anything contains this.
    pub(crate) fn shows(&self, part: &str) -> bool {
        self.window.query_all_by_label_contains(part).next().is_some()
    }

    /// Whether the button with this name can be pressed.
    pub(crate) fn is_enabled(&self, name: &str) -> bool {
        let button = self.window.get_by_role_and_label(egui::accesskit::Role::Button, name);
        !button.accesskit_node().is_disabled()
    }

    /// Clicks the control with this name, and waits.
    pub(crate) fn click(&mut self, name: &str, ms: u64) {
        self.window.get_by_label(name).click();
        self.then(ms);
    }

    /// Clicks the control whose name contains this, and waits.
    pub(crate) fn click_part(&mut self, part: &str, ms: u64) {
        self.window.get_by_label_contains(part).click();
        self.then(ms);
    }

    /// Clicks the button with this name, and waits.
    pub(crate) fn click_button(&mut self, name: &str, ms: u64) {
        self.window.get_by_role_and_label(egui::accesskit::Role::Button, name).click();
        self.then(ms);
    }

    /// Presses a key, and waits.
    pub(crate) fn key(&mut self, key: egui::Key, ms: u64) {
        self.window.key_press(key);
        self.then(ms);
    }

    /// Presses a key with others held, and waits.
    pub(crate) fn keys(&mut self, held: egui::Modifiers, key: egui::Key, ms: u64) {
        self.window.key_press_modifiers(held, key);
        self.then(ms);
    }

    /// Presses the pointer's button here, and waits.
    pub(crate) fn grab(&mut self, at: egui::Pos2, ms: u64) {
        self.window.drag_at(at);
        self.then(ms);
    }

    /// Moves the pointer here, and waits.
    pub(crate) fn hover(&mut self, at: egui::Pos2, ms: u64) {
        self.window.hover_at(at);
        self.then(ms);
    }

    /// Releases the pointer's button here, and waits.
    pub(crate) fn release(&mut self, at: egui::Pos2, ms: u64) {
        self.window.drop_at(at);
        self.then(ms);
    }

    /// Drags from one place to another, in three frames.
    pub(crate) fn drag(&mut self, from: egui::Pos2, to: egui::Pos2) {
        self.grab(from, 0);
        self.hover(to, 0);
        self.release(to, 0);
    }

    /// Gives the window another size, and waits.
    pub(crate) fn resize(&mut self, size: egui::Vec2, ms: u64) {
        self.window.set_size(size);
        self.then(ms);
    }

    /// Turns the wheel by this many points with the pointer here; positive moves content down.
    pub(crate) fn turn_wheel(&mut self, at: egui::Pos2, points: f32) {
        self.window.hover_at(at);
        self.window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, points),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: egui::Modifiers::NONE,
        });
        // The motion is smoothed over some frames.
        self.wait(1500);
    }

    /// The simulated plate in time gives no result from now on, or gives one again.
    pub(crate) fn hold_time_domain(&mut self, is_held: bool) {
        self.time_domain_is_held.set(is_held);
    }

    /// Opens the file that the dialog gives: its path, and its text or why it cannot be read.
    pub(crate) fn open(&mut self, path: &str, text: Result<String, String>) {
        *self.files.contents.borrow_mut() = vec![(PathBuf::from(path), text)];
        self.window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
        self.wait(100);
    }

    /// The window hangs for this many milliseconds: its event loop does not turn.
    pub(crate) fn hang(&mut self, ms: u64) {
        self.worker.borrow_mut().is_hung = true;
        self.pass(ms);
        self.worker.borrow_mut().is_hung = false;
    }

    /// Lets this many milliseconds pass without a frame of the window.
    pub(crate) fn pass(&mut self, ms: u64) {
        self.worker.borrow_mut().advance(Duration::from_millis(ms));
    }

    /// Lets this many milliseconds pass while nothing of the window can be seen. As eframe does then, it has the app look for
    /// what is new every 50 ms and paint nothing; `hide` says why.
    pub(crate) fn wait_hidden(&mut self, ms: u64, hide: fn(&mut egui::ViewportInfo)) {
        let mut input = self.window.input().clone();
        input.viewports.values_mut().for_each(hide);
        let ctx = self.window.ctx.clone();
        for _ in 0..ms.div_ceil(50) {
            self.pass(50);
            drop(ctx.run_logic(&input, |ctx| self.window.state_mut().logic(ctx)));
        }
    }

    /// The snapshot of link and device.
    pub(crate) fn snapshot(&self) -> Snapshot {
        self.worker.borrow().connection.view().clone()
    }

    /// A digest of all codes that the device has sent.
    pub(crate) fn digest(&self) -> u64 {
        self.worker.borrow().digest()
    }

    /// Everything the app has asked of the link since the last call.
    pub(crate) fn take_sent(&self) -> Vec<Request> {
        std::mem::take(&mut self.worker.borrow_mut().sent)
    }

    /// Whether tones sound.
    pub(crate) fn is_driving(&self) -> bool {
        self.snapshot()
            .drive
            .status
            .is_some_and(|status| status.state == slipline_link::protocol::event::State::Driving)
    }

    /// Disarms the device without the window, as a device does by itself when its host has stalled.
    pub(crate) fn disarm(&mut self) {
        SteppedLink(Rc::clone(&self.worker)).send(Request::Disarm);
    }

    /// Pulls the cable, or puts it in again; the device restarts.
    pub(crate) fn plug(&mut self, is_plugged: bool) {
        self.worker.borrow().plug(is_plugged);
    }

    /// The setup as its file would be.
    pub(crate) fn setup_text(&self) -> String {
        setup_file::write(self.window.state().setup())
    }
}

/// The size of most windows, in a light theme.
fn usual() -> egui_kittest::HarnessBuilder<App> {
    egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(egui::Theme::Light)
}

/// The app's window of this size over a link, after its first frames.
pub(crate) fn opened(link: impl Link + 'static, size: [f32; 2]) -> Harness<'static, App> {
    let builder = egui_kittest::HarnessBuilder::default().with_size(size);
    let mut window = open_window(Box::new(link), &FakeFiles::default(), ThemeChoice::Light, builder);
    window.run_steps(5);
    window
}

/// Clicks the control with this name in a window without a device, and shows what follows.
pub(crate) fn click(window: &mut Harness<'static, App>, name: &str) {
    window.get_by_label(name).click();
    window.run_steps(5);
}

/// The app's window over a link.
pub(crate) fn open_window(
    link: Box<dyn Link>,
    files: &FakeFiles,
    theme: ThemeChoice,
    builder: egui_kittest::HarnessBuilder<App>,
) -> Harness<'static, App> {
    let parts = parts(link, files, tables(), &Rc::default());
    open_window_with(parts, membrane(), theme, builder)
}

fn parts(
    link: Box<dyn Link>,
    files: &FakeFiles,
    tables: JobQueue<TableJob, TableState>,
    sheet_jobs: &Rc<Cell<usize>>,
) -> Parts {
    let (count, mut run_sheet) = (Rc::clone(sheet_jobs), sheet::work());
    let jobs = Jobs {
        tables,
        checks: checks(),
        calibrations: calibrations(),
        sheets: JobQueue::inline(move |job, task: &_| {
            count.set(count.get() + 1);
            run_sheet(job, task)
        }),
        ..Jobs::inline()
    };
    let services = Services {
        scenes: JobQueue::inline(|(), task: &_| scenes::thumbnails(task)),
        figures: JobQueue::inline(|job, task: &_| figures::plate::work(&job, task)),
        speaker: Box::new(FakeSpeaker::default()),
        files: Box::new(files.clone()),
        ports: Box::new(|| vec![PortInfo::simulated()]),
        ask_for_port: None,
        address: None,
        press_ages: PressAges::default(),
    };
    Parts { link, jobs, bench: Bench::default(), services }
}

/// One tone in the middle of the membrane, whose line holds the turning point: what most tests use, because its table is
/// made soon and its places are those of the device.
pub(crate) fn membrane() -> Setup {
    let plate = slipline_plate::preset("membrane").unwrap();
    Setup { boundary: BoundaryMode::TurningPoint, ..Setup::new(plate.into()) }
}

fn open_window_with(
    parts: Parts,
    setup: Setup,
    theme: ThemeChoice,
    builder: egui_kittest::HarnessBuilder<App>,
) -> Harness<'static, App> {
    let settings = Settings { theme, ..Settings::default() };
    let app = App::new(&egui::Context::default(), parts, setup, settings);
    builder.with_step_dt(1.0 / 60.0).build_ui_state(
        |ui: &mut egui::Ui, app: &mut App| {
            slipline_window::view::theme::install(ui.ctx());
            app.logic(&ui.ctx().clone());
            app.show(ui);
        },
        app,
    )
}
