//! An instrument, its simulated device in virtual time, and a user without a window.

use crate::pluggable_port::{SteppedLink, SteppedWorker};
use slipline_instrument::bench::Bench;
use slipline_instrument::hold::Standing;
use slipline_instrument::{Attention, DeviceIntent, Instrument, Jobs, Link, MeasureIntent, Output, Page};
use slipline_link::protocol::event::State;
use slipline_link::{Port, Request};
use slipline_model::setup::{BoundaryMode, Setup};
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

impl Session {
    /// A session with [`setup`], connected.
    pub(crate) fn new() -> Self {
        Self::with(|worker| Box::new(SteppedLink(worker)), Jobs::inline())
    }

    /// A session whose instrument has this link to the device, and does its work so.
    pub(crate) fn with(link: impl FnOnce(Rc<RefCell<SteppedWorker>>) -> Box<dyn Link>, jobs: Jobs) -> Self {
        let bench = Bench::default();
        let worker = Rc::new(RefCell::new(SteppedWorker::new(true, Some(bench.inputs()))));
        let mut instrument = Instrument::new(link(Rc::clone(&worker)), jobs, bench, setup());
        instrument.perform_device(DeviceIntent::AutoReconnect(true));
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

    pub(crate) fn turn(&mut self) {
        self.instrument.attend(self.attention);
        self.instrument.take_reports();
        self.instrument.turn();
        for output in self.instrument.take_outputs() {
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

    pub(crate) fn state(&self) -> Option<State> {
        self.instrument.snapshot().status.map(|status| status.state)
    }

    pub(crate) fn line_m(&self) -> f64 {
        self.instrument.line(0).unwrap().place_m
    }

    pub(crate) fn notice(&self) -> String {
        self.instrument
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
        for _ in 0..400 {
            self.pass(100);
            if self.instrument.shown().measure.live.progress.is_none() {
                return;
            }
        }
        panic!("it never ends: {:?}", self.notice());
    }
}
