//! The app on a simulated device in virtual time: no thread, no clock, no display.

use eframe::egui;
use egui_kittest::Harness;
use slipline_link::connection::Connection;
use slipline_link::protocol::version::Minor;
use slipline_link::protocol::{Command, Decoder, Event, Header, Refusal};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Opener, Transport, Waker};
use slipline_link::{LinkError, Port, PortInfo, Request, Snapshot, Ticket};
use slipline_model::export::figures;
use slipline_model::field::sheet;
use slipline_model::field::time_domain;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::check;
use slipline_model::jobs::design;
use slipline_model::jobs::plane::{self, PlaneChecked};
use slipline_model::jobs::table;
use slipline_model::setup::file as setup_file;
use slipline_model::waveform;
use slipline_window::app::{App, Link, Parts, TableJob, TableState, first_setup};
use slipline_window::files::{FileEvent, FileJob, Files, Save};
use slipline_window::settings::{Settings, ThemeChoice};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A simulated device and its cable.
struct PluggablePort {
    device: SimulatedDevice,
    is_plugged: bool,
    /// The answer to every drive, in the device's place.
    refusal: Option<Refusal>,
    from_host: Decoder,
    refused: Vec<u8>,
}

struct PluggableTransport(Arc<Mutex<PluggablePort>>);

impl Transport for PluggableTransport {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut port = self.0.lock().unwrap();
        if !port.is_plugged {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let mut bytes = Vec::new();
        port.device.take(&mut bytes);
        bytes.append(&mut port.refused);
        if bytes.is_empty() {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        assert!(bytes.len() <= buffer.len(), "the answers of a millisecond fit a read");
        buffer[..bytes.len()].copy_from_slice(&bytes);
        Ok(bytes.len())
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut port = self.0.lock().unwrap();
        if !port.is_plugged {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let Some(refusal) = port.refusal else {
            port.device.feed(bytes);
            return Ok(bytes.len());
        };
        for &byte in bytes {
            let command = port
                .from_host
                .push(byte, |frame| (frame.header, Command::decode(frame.header.id, frame.body).unwrap()));
            let Some((header, command)) = command else { continue };
            let Header { session, sequence, .. } = header;
            if let Command::Drive(_) = command {
                let answer = Event::Refused(refusal).frame_for(Minor::FIRST, session, sequence).unwrap();
                port.refused.extend_from_slice(&answer);
            } else {
                port.device.feed(&command.frame_for(Minor::FIRST, session, sequence).unwrap());
            }
        }
        Ok(bytes.len())
    }
}

struct PluggableOpener(Arc<Mutex<PluggablePort>>);

impl Opener for PluggableOpener {
    type Transport = PluggableTransport;

    fn list(&mut self) -> Vec<PortInfo> {
        if self.0.lock().unwrap().is_plugged { vec![PortInfo::simulated()] } else { Vec::new() }
    }

    fn open(&mut self, port: &Port, _waker: &Waker) -> Result<PluggableTransport, LinkError> {
        if self.0.lock().unwrap().is_plugged {
            Ok(PluggableTransport(Arc::clone(&self.0)))
        } else {
            Err(LinkError::NoSuchPort(port.clone()))
        }
    }
}

/// In place of the link worker: the connection, stepped by the test in virtual time.
struct SteppedWorker {
    connection: Connection<PluggableOpener>,
    port: Arc<Mutex<PluggablePort>>,
    now: Duration,
    tickets: u64,
    sent: Vec<Request>,
    /// The window's event loop does not turn: nobody answers the link's questions.
    is_hung: bool,
}

impl SteppedWorker {
    fn advance(&mut self, time: Duration) {
        const STEP: Duration = Duration::from_millis(1);
        let end = self.now + time;
        while self.now < end {
            self.now += STEP;
            // 400 kS/s in blocks of 128 are 3.125 blocks a millisecond.
            let blocks = |time: Duration| time.as_millis() as u64 * 25 / 8;
            let due = blocks(self.now) - blocks(self.now - STEP);
            self.port.lock().unwrap().device.advance(due, |_| {});
            self.connection.step(self.now);
            if self.connection.take_sign_wanted() && !self.is_hung {
                self.connection.sign_of_life(self.now);
            }
        }
    }
}

struct SteppedLink(Rc<RefCell<SteppedWorker>>);

impl Link for SteppedLink {
    fn send(&self, request: Request) -> Ticket {
        let mut worker = self.0.borrow_mut();
        worker.tickets += 1;
        let (ticket, now) = (Ticket(worker.tickets), worker.now);
        worker.sent.push(request.clone());
        worker.connection.request(ticket, request, now);
        worker.connection.step(now);
        ticket
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let mut worker = self.0.borrow_mut();
        // As the real worker does: this call numbers the changes.
        worker.connection.take_changes();
        Arc::new(worker.connection.view().clone())
    }
}

/// A list that the test and the app both hold.
type Shared<T> = Rc<RefCell<Vec<T>>>;

/// Fake file access: the test sets the contents and reads what was saved.
#[derive(Clone, Default)]
pub(crate) struct FakeFiles {
    /// The result of opening each path.
    pub(crate) contents: Shared<(PathBuf, Result<String, String>)>,
    /// What was saved.
    pub(crate) saved: Shared<(String, Vec<u8>)>,
    /// Whether the system has no dialogs for files.
    pub(crate) has_no_dialogs: Rc<Cell<bool>>,
    /// Whether the dialog for files stays open.
    pub(crate) stays_open: Rc<Cell<bool>>,
    events: Rc<RefCell<VecDeque<FileEvent>>>,
}

impl FakeFiles {
    fn write(&self, path: PathBuf, save: Save) -> FileEvent {
        self.saved.borrow_mut().push((save.name, save.bytes.to_vec()));
        FileEvent::Saved(path, Ok(()))
    }
}

impl Files for FakeFiles {
    fn begin(&mut self, job: FileJob) {
        let asks = matches!(job, FileJob::Choose | FileJob::Save(_) | FileJob::SaveFolder(_));
        if asks && self.stays_open.get() {
            return;
        }
        let event = match job {
            job if asks && self.has_no_dialogs.get() => FileEvent::NoDialog(job),
            FileJob::Choose => {
                let (path, text) = self.contents.borrow()[0].clone();
                FileEvent::Opened(path, text)
            }
            FileJob::Open(path) => {
                let contents = self.contents.borrow();
                let text = contents.iter().find(|(other, _)| *other == path).map(|(_, text)| text.clone());
                FileEvent::Opened(path, text.unwrap_or_else(|| Err("no such file".to_owned())))
            }
            FileJob::Save(save) => self.write(PathBuf::from(&save.name), save),
            FileJob::SaveAs { path, save, may_replace } => {
                let is_there = self.contents.borrow().iter().any(|(other, _)| *other == path);
                if is_there && !may_replace {
                    FileEvent::Exists(path, save)
                } else {
                    self.contents.borrow_mut().push((path.clone(), Ok(String::new())));
                    self.write(path, save)
                }
            }
            FileJob::SaveFolder(files) | FileJob::SaveInto(_, files) => {
                let files = files.into_iter().map(|(name, text)| (name, text.into_bytes()));
                self.saved.borrow_mut().extend(files);
                FileEvent::Saved(PathBuf::from("folder"), Ok(()))
            }
        };
        self.events.borrow_mut().push_back(event);
    }

    fn take(&mut self) -> Option<FileEvent> {
        self.events.borrow_mut().pop_front()
    }
}

/// The app, its device and its files.
pub(crate) struct TestApp {
    /// The window.
    pub(crate) window: Harness<'static, App>,
    /// The files.
    pub(crate) files: FakeFiles,
    /// Number of jobs for the 2-D sheet so far.
    pub(crate) sheet_jobs: Rc<Cell<usize>>,
    /// Why the computation in two dimensions is refused; `None` while it is not.
    pub(crate) plane_refusal: Rc<RefCell<Option<String>>>,
    worker: Rc<RefCell<SteppedWorker>>,
}

impl TestApp {
    /// The app at its first start, connected and driving.
    pub(crate) fn driving() -> Self {
        Self::driving_with(
            ThemeChoice::Light,
            egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(egui::Theme::Light),
        )
    }

    /// As [`Self::driving`], with another theme and window.
    pub(crate) fn driving_with(theme: ThemeChoice, builder: egui_kittest::HarnessBuilder<App>) -> Self {
        let mut app = Self::starting(theme, builder);
        for _ in 0..40 {
            app.wait(50);
            if app.is_driving() {
                // Time for the plate to settle and the views to follow.
                app.wait(400);
                return app;
            }
        }
        panic!("the simulated plate does not move: {:?}", app.snapshot().log);
    }

    /// The app at its first start, with a job queue for tables that the test supplies.
    pub(crate) fn with_tables(tables: JobQueue<TableJob, TableState>) -> Self {
        let builder =
            egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(egui::Theme::Light);
        Self::starting_with(ThemeChoice::Light, builder, tables, true)
    }

    /// The app at its first start, with the device's cable pulled.
    pub(crate) fn unplugged() -> Self {
        let builder =
            egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(egui::Theme::Light);
        Self::starting_with(ThemeChoice::Light, builder, JobQueue::inline(table::make), false)
    }

    fn starting(theme: ThemeChoice, builder: egui_kittest::HarnessBuilder<App>) -> Self {
        Self::starting_with(theme, builder, JobQueue::inline(table::make), true)
    }

    fn starting_with(
        theme: ThemeChoice,
        builder: egui_kittest::HarnessBuilder<App>,
        tables: JobQueue<TableJob, TableState>,
        is_plugged: bool,
    ) -> Self {
        let device = SimulatedDevice::new(Options::default());
        let port = Arc::new(Mutex::new(PluggablePort {
            device,
            is_plugged,
            refusal: None,
            from_host: Decoder::new(),
            refused: Vec::new(),
        }));
        let mut nonce = 0u32;
        let nonces = Box::new(move || {
            nonce += 1;
            nonce.to_le_bytes()
        });
        let mut connection = Connection::new(PluggableOpener(Arc::clone(&port)), Waker::new(|| {}), nonces);
        connection.keep_frames();
        connection.watch_driver();
        let worker = SteppedWorker {
            connection,
            port,
            now: Duration::ZERO,
            tickets: 0,
            sent: Vec::new(),
            is_hung: false,
        };
        let worker = Rc::new(RefCell::new(worker));
        let files = FakeFiles::default();
        let link = Box::new(SteppedLink(Rc::clone(&worker)));
        let sheet_jobs = Rc::default();
        let plane_refusal: Rc<RefCell<Option<String>>> = Rc::default();
        let refusal = Rc::clone(&plane_refusal);
        let mut parts = parts(link, &files, tables, &sheet_jobs);
        parts.planes = JobQueue::inline(move |job, task: &_| match refusal.borrow().clone() {
            Some(reason) => Some(PlaneChecked { job, result: Err(reason) }),
            None => plane::work(job, task),
        });
        let window = open_window_with(parts, theme, builder);
        Self { window, files, sheet_jobs, plane_refusal, worker }
    }

    /// Lets this many milliseconds pass, with a frame of the window every 50 ms.
    pub(crate) fn wait(&mut self, ms: u64) {
        for _ in 0..ms.div_ceil(50) {
            self.worker.borrow_mut().advance(Duration::from_millis(50.min(ms)));
            self.window.step();
        }
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

    /// The snapshot of link and device.
    pub(crate) fn snapshot(&self) -> Snapshot {
        self.worker.borrow().connection.view().clone()
    }

    /// Everything the app has asked of the link since the last call.
    pub(crate) fn take_sent(&self) -> Vec<Request> {
        std::mem::take(&mut self.worker.borrow_mut().sent)
    }

    /// Whether tones sound.
    pub(crate) fn is_driving(&self) -> bool {
        self.snapshot()
            .status
            .is_some_and(|status| status.state == slipline_link::protocol::event::State::Driving)
    }

    /// Disarms the device without the window, as a device does by itself when its host has stalled.
    pub(crate) fn disarm(&mut self) {
        SteppedLink(Rc::clone(&self.worker)).send(Request::Disarm);
    }

    /// Pulls the cable, or puts it in again; the device restarts.
    pub(crate) fn plug(&mut self, is_plugged: bool) {
        let worker = self.worker.borrow();
        let mut port = worker.port.lock().unwrap();
        port.is_plugged = is_plugged;
        if is_plugged {
            port.device.restart(slipline_link::protocol::event::ResetCause::PowerOn);
        }
    }

    /// Has every drive refused from now on, or taken again.
    pub(crate) fn refuse_drives(&mut self, refusal: Option<Refusal>) {
        self.worker.borrow().port.lock().unwrap().refusal = refusal;
    }

    /// The setup as its file would be.
    pub(crate) fn setup_text(&self) -> String {
        setup_file::write(self.window.state().setup())
    }
}

/// A link with fixed snapshots that records the requests.
#[derive(Clone)]
pub(crate) struct FixedLink {
    /// The first snapshot.
    pub(crate) snapshot: Arc<Snapshot>,
    /// The snapshot that replaces it later.
    later: Rc<RefCell<Option<Arc<Snapshot>>>>,
    /// The requests.
    pub(crate) sent: Shared<Request>,
}

impl FixedLink {
    /// A link with this snapshot.
    pub(crate) fn of(snapshot: Snapshot) -> Self {
        Self { snapshot: Arc::new(snapshot), later: Rc::default(), sent: Rc::default() }
    }

    /// Replaces the snapshot from now on.
    pub(crate) fn become_known(&self, mut snapshot: Snapshot) {
        snapshot.revision = self.snapshot().revision + 1;
        *self.later.borrow_mut() = Some(Arc::new(snapshot));
    }
}

impl Link for FixedLink {
    fn send(&self, request: Request) -> Ticket {
        self.sent.borrow_mut().push(request);
        Ticket(self.sent.borrow().len() as u64)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let later = self.later.borrow().clone();
        later.unwrap_or_else(|| Arc::clone(&self.snapshot))
    }
}

/// The app's window over a link.
pub(crate) fn open_window(
    link: Box<dyn Link>,
    files: &FakeFiles,
    theme: ThemeChoice,
    builder: egui_kittest::HarnessBuilder<App>,
) -> Harness<'static, App> {
    let parts = parts(link, files, JobQueue::inline(table::make), &Rc::default());
    open_window_with(parts, theme, builder)
}

fn parts(
    link: Box<dyn Link>,
    files: &FakeFiles,
    tables: JobQueue<TableJob, TableState>,
    sheet_jobs: &Rc<Cell<usize>>,
) -> Parts {
    let (count, mut run_sheet) = (Rc::clone(sheet_jobs), sheet::work());
    Parts {
        link,
        tables,
        checks: JobQueue::inline(check::work()),
        planes: JobQueue::inline(plane::work),
        designs: JobQueue::inline(design::work),
        sheets: JobQueue::inline(move |job, task: &_| {
            count.set(count.get() + 1);
            run_sheet(job, task)
        }),
        waveforms: JobQueue::inline(waveform::work()),
        time_domain: JobQueue::inline(|job, task: &_| time_domain::run(&job, task)),
        figures: JobQueue::inline(|job, task: &_| figures::plate::work(&job, task)),
        files: Box::new(files.clone()),
        ports: Box::new(|| vec![PortInfo::simulated()]),
    }
}

fn open_window_with(
    parts: Parts,
    theme: ThemeChoice,
    builder: egui_kittest::HarnessBuilder<App>,
) -> Harness<'static, App> {
    let settings = Settings { theme, ..Settings::default() };
    let app = App::new(&egui::Context::default(), parts, first_setup().unwrap(), settings);
    builder.with_step_dt(1.0 / 60.0).build_ui_state(
        |ui: &mut egui::Ui, app: &mut App| {
            slipline_window::view::theme::install(ui.ctx());
            app.logic(&ui.ctx().clone());
            app.show(ui);
        },
        app,
    )
}
