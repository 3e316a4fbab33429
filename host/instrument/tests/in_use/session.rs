//! An instrument, its simulated device in virtual time, and a user without a window.

use crate::pluggable_port::{SteppedLink, SteppedWorker};
use slipline_instrument::bench::Bench;
use slipline_instrument::calibration::WizardPage;
use slipline_instrument::hold::Standing;
use slipline_instrument::{
    Attention, CalibrateIntent, DeviceIntent, Instrument, Jobs, Link, MeasureIntent, Output, Page,
};
use slipline_link::protocol::event::State;
use slipline_link::simulator::SimulatedInputs;
use slipline_link::{Port, Request, Sounding};
use slipline_model::jobs::JobQueue;
use slipline_model::setup::edit::Edit;
use slipline_model::setup::{BoundaryMode, Setup};
use slipline_plate::Plate;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// Time between two turns of the instrument.
const TURN: Duration = Duration::from_millis(50);

/// An instrument, its device, and a user without a window.
pub(crate) struct Session {
    pub(crate) instrument: Instrument,
    pub(crate) worker: Rc<RefCell<SteppedWorker>>,
    pub(crate) attention: Attention,
    pub(crate) saved: Vec<String>,
}

/// A membrane whose line holds the turning point, as at the start of the window's tests.
pub(crate) fn setup() -> Setup {
    let plate = slipline_plate::preset("membrane").unwrap();
    Setup { boundary: BoundaryMode::TurningPoint, ..Setup::new(plate.into()) }
}

/// Nothing is computed for a picture of the drive: neither codes nor sheet nor plate in time.
fn unseen() -> Jobs {
    Jobs {
        sheets: JobQueue::inline(|_, _: &_| None),
        waveforms: JobQueue::inline(|_, _: &_| None),
        time_domain: JobQueue::inline(|_, _: &_| None),
        ..Jobs::inline()
    }
}

/// The membrane of [`setup`], with this share of its wave speed.
pub(crate) fn membrane(share: f64) -> Plate {
    slipline_plate::preset("membrane").unwrap().with_wave_speed(share).unwrap()
}

/// The places of the first tone in these drives, in millimetres.
pub(crate) fn drives(requests: &[Request]) -> Vec<f64> {
    let place = |request: &Request| {
        let Request::Play(Sounding::Drive(drive)) = request else { return None };
        Some(drive.tones[0].boundary_m * 1e3)
    };
    requests.iter().filter_map(place).collect()
}

impl Session {
    /// A session with [`setup`], connected.
    pub(crate) fn new() -> Self {
        Self::with(|worker| Box::new(SteppedLink(worker)), Jobs::inline())
    }

    /// A session whose instrument has this link to the device, and does its work so.
    pub(crate) fn with(link: impl FnOnce(Rc<RefCell<SteppedWorker>>) -> Box<dyn Link>, jobs: Jobs) -> Self {
        let bench = Bench::default();
        let inputs = Some(bench.inputs());
        Self::on(setup(), inputs, bench, link, jobs)
    }

    /// [`setup`], driven by a device without inputs. Nothing is computed for a picture of the drive.
    pub(crate) fn driving() -> Self {
        Self::driving_setup(setup())
    }

    /// As [`Self::driving`], with this setup.
    pub(crate) fn driving_setup(setup: Setup) -> Self {
        Self::driving_on(setup, None, Bench::default())
    }

    /// As [`Self::driving`], by a device with these inputs.
    pub(crate) fn sensed(inputs: impl SimulatedInputs + 'static) -> Self {
        Self::driving_on(setup(), Some(Box::new(inputs)), Bench::default())
    }

    /// As [`Self::driving`], by a device whose inputs are wired to the simulated plate; returns its bench, too.
    pub(crate) fn at_bench() -> (Self, Bench) {
        let bench = Bench::default();
        (Self::driving_on(setup(), Some(bench.inputs()), bench.clone()), bench)
    }

    /// As [`Self::at_bench`], with lines that hold felt edges.
    pub(crate) fn felt_at_bench() -> Self {
        let bench = Bench::default();
        let setup = Setup { boundary: BoundaryMode::FeltEdge, ..setup() };
        Self::driving_on(setup, Some(bench.inputs()), bench)
    }

    /// This setup, driven by a device whose inputs are wired to the simulated plate, which runs in time; no codes and no sheet
    /// are computed for a picture.
    pub(crate) fn simulated(setup: Setup) -> Self {
        let bench = Bench::default();
        let jobs = Jobs {
            sheets: JobQueue::inline(|_, _: &_| None),
            waveforms: JobQueue::inline(|_, _: &_| None),
            ..Jobs::inline()
        };
        let inputs = Some(bench.inputs());
        let mut session = Self::on(setup, inputs, bench, |worker| Box::new(SteppedLink(worker)), jobs);
        session.until("it drives", Self::is_driving);
        session.pass(400);
        session
    }

    /// Presses Drive, and waits until the simulated plate has followed.
    pub(crate) fn drive_on(&mut self) {
        self.instrument.start();
        self.until("it drives", Self::is_driving);
        self.until("the simulated plate follows", |session| {
            session.instrument.shown().measured.is_some_and(|rings| rings.is_current)
        });
    }

    fn driving_on(setup: Setup, inputs: Option<Box<dyn SimulatedInputs>>, bench: Bench) -> Self {
        let mut session = Self::on(setup, inputs, bench, |worker| Box::new(SteppedLink(worker)), unseen());
        session.until("it drives", Self::is_driving);
        session.pass(400);
        session
    }

    fn on(
        setup: Setup,
        inputs: Option<Box<dyn SimulatedInputs>>,
        bench: Bench,
        link: impl FnOnce(Rc<RefCell<SteppedWorker>>) -> Box<dyn Link>,
        jobs: Jobs,
    ) -> Self {
        let worker = Rc::new(RefCell::new(SteppedWorker::new(true, inputs)));
        let mut instrument = Instrument::new(link(Rc::clone(&worker)), jobs, bench, setup);
        instrument.perform(DeviceIntent::AutoReconnect(true));
        instrument.connect(Port::Simulated);
        let attention = Attention { is_animated: true, is_measurements_open: true, ..Attention::default() };
        Self { instrument, worker, attention, saved: Vec::new() }
    }

    /// Advances time, with a turn of the instrument every [`TURN`].
    pub(crate) fn pass(&mut self, ms: u64) {
        for _ in 0..ms.div_ceil(TURN.as_millis() as u64) {
            self.worker.borrow_mut().advance(TURN);
            self.attention.now_s += TURN.as_secs_f64();
            self.turn();
        }
    }

    /// Lets time pass until this is so.
    pub(crate) fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        for _ in 0..80 {
            if is_so(self) {
                return;
            }
            self.pass(50);
        }
        panic!("never: {what}: {:?}", self.instrument.drive.snapshot().record.log);
    }

    /// The shell hangs for this time: nothing turns the instrument, and the link gets no signs of life.
    pub(crate) fn hang(&mut self, ms: u64) {
        self.worker.borrow_mut().is_hung = true;
        self.worker.borrow_mut().advance(Duration::from_millis(ms));
        self.worker.borrow_mut().is_hung = false;
    }

    /// Pulls the cable, or plugs it in; then time passes.
    pub(crate) fn plug(&mut self, is_plugged: bool, ms: u64) {
        self.worker.borrow().plug(is_plugged);
        self.pass(ms);
    }

    pub(crate) fn turn(&mut self) {
        self.instrument.attend(self.attention);
        self.instrument.take_reports();
        self.instrument.turn();
        for output in self.instrument.out.take_outputs() {
            match output {
                Output::Open(page) => {
                    self.attention.has_page = true;
                    self.attention.is_calibration_open = page == Page::Calibration;
                }
                Output::CloseCalibration => {
                    (self.attention.has_page, self.attention.is_calibration_open) = (false, false);
                }
                Output::Save { name, .. } => self.saved.push(name),
                Output::ChooseMeasurement => {}
            }
        }
        self.instrument.attend(self.attention);
    }

    /// The kinds of requests since the last call, without notes, in order; equal neighbours once.
    pub(crate) fn sent(&self) -> Vec<String> {
        let sent = std::mem::take(&mut self.worker.borrow_mut().sent);
        let words = sent.iter().filter(|request| !matches!(request, Request::Note(..)));
        let mut kinds: Vec<String> = words
            .map(|request| {
                let shown = format!("{request:?}");
                let kind = shown.strip_prefix("Play(").unwrap_or(&shown);
                kind.split(['(', ' ']).next().unwrap_or_default().to_owned()
            })
            .collect();
        kinds.dedup();
        kinds
    }

    /// The requests since the last call.
    pub(crate) fn take_requests(&self) -> Vec<Request> {
        std::mem::take(&mut self.worker.borrow_mut().sent)
    }

    /// Whether tones sound.
    pub(crate) fn is_driving(&self) -> bool {
        self.state() == Some(State::Driving)
    }

    /// Whether a line of the log contains this.
    pub(crate) fn is_logged(&self, part: &str) -> bool {
        self.instrument.drive.snapshot().record.log.iter().any(|entry| entry.text.contains(part))
    }

    /// Whether the plate is being measured.
    pub(crate) fn is_measuring(&self) -> bool {
        self.instrument.shown().measure.live.progress.is_some()
    }

    /// Moves the line of the first tone to this place in millimetres, as another gesture.
    pub(crate) fn move_to(&mut self, mm: f64) {
        self.instrument.desk.begin_gestures(1);
        self.instrument.drag_line(0, &[mm * 1e-3]);
        self.turn();
    }

    /// Makes a change, as another gesture.
    pub(crate) fn edit(&mut self, edit: &Edit) {
        self.instrument.desk.begin_gestures(1);
        self.instrument.edit(edit);
        self.turn();
    }

    /// Puts another plate in the setup.
    pub(crate) fn change_plate(&mut self, plate: Plate) {
        self.edit(&Edit::Plate(plate.into()));
    }

    pub(crate) fn state(&self) -> Option<State> {
        self.instrument.drive.snapshot().drive.status.map(|status| status.state)
    }

    /// The place of the first tone's line, in millimetres.
    pub(crate) fn line_mm(&self) -> f64 {
        self.line_m() * 1e3
    }

    pub(crate) fn line_m(&self) -> f64 {
        self.instrument.line(0).unwrap().place_m
    }

    pub(crate) fn notice(&self) -> String {
        self.instrument
            .out
            .notices()
            .max_by_key(|notice| notice.number)
            .map_or_else(String::new, |it| it.text.clone())
    }

    /// Drives, then holds the level.
    pub(crate) fn hold_level(&mut self) {
        self.instrument.start();
        self.pass(1000);
        self.instrument.switch_hold(true);
        self.pass(3000);
        let standing = self.instrument.shown().hold.standing;
        assert!(matches!(standing, Standing::Holding(_)), "{}", self.notice());
    }

    /// Measures, and waits for the end.
    pub(crate) fn measure(&mut self, answers: Option<usize>) {
        self.instrument.perform_measure(MeasureIntent::Begin(answers));
        self.end_of_measuring();
    }

    /// Waits until nothing is measured any more.
    pub(crate) fn end_of_measuring(&mut self) {
        for _ in 0..400 {
            self.pass(100);
            if !self.is_measuring() {
                return;
            }
        }
        panic!("it never ends: {:?}", self.notice());
    }

    /// Opens this page of the calibration.
    pub(crate) fn open_wizard(&mut self, page: WizardPage) {
        self.instrument.perform_calibrate(CalibrateIntent::Page(page));
        self.turn();
    }

    /// Calibrates by a measurement at each of both places, and uses the plate.
    pub(crate) fn calibrate_by_measuring(&mut self) {
        self.instrument.perform_calibrate(CalibrateIntent::Open);
        self.turn();
        for (page, answers) in [(WizardPage::FirstAnswer, 0), (WizardPage::SecondPlace, 1)] {
            self.open_wizard(page);
            self.measure(Some(answers));
        }
        self.instrument.perform_calibrate(CalibrateIntent::Page(WizardPage::Result));
        self.pass(100);
        self.instrument.perform_calibrate(CalibrateIntent::Use);
        self.pass(1500);
    }
}
