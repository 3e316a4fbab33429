//! Work that takes longer than a picture, in workers: one for quick jobs, one for long ones.
//!
//! ```text
//! JobQueue --begin--> Lane --number, job--> JobWorker
//!    ^                 |   <-number, result-
//!    +----- result ----+
//! ```
//! A job in a worker hears no message while it runs. So one that is not wanted any more is ended with its worker, which
//! is started anew at once; and a newer job of a kind waits for the older one, unless that has run for a while.

use crate::clock::now;
use crate::host::Host;
use eframe::egui;
use serde::{Deserialize, Serialize};
use slipline_instrument::Jobs;
use slipline_instrument::jobs::calibrate::{self, CalibrateDone, CalibrateJob};
use slipline_instrument::jobs::rig::{self, RigJob, RigPrepared};
use slipline_model::field::sheet::{self, Frame, SheetJob};
use slipline_model::field::time_domain::{self, SimulatedField, TimeDomainJob};
use slipline_model::jobs::check::{self, CheckJob, Checked};
use slipline_model::jobs::compare::{self, CompareJob, Compared};
use slipline_model::jobs::design::{self, Designed, Draft};
use slipline_model::jobs::measured_places::{self, MeasuredPlaces, MeasuredPlacesJob};
use slipline_model::jobs::plane::{self, PlaneChecked, PlaneJob};
use slipline_model::jobs::table::{self, TableJob, TableState};
use slipline_model::jobs::texture::{self, TextureJob, Textured};
use slipline_model::jobs::{JobQueue, Task};
use slipline_model::waveform::{self, Waveform, WaveformJob};
use slipline_plate::exchange::Exchange;
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::Duration;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// A running job that is older than this is not waited for when a newer one of its kind is asked for.
const PATIENCE: Duration = Duration::from_millis(300);

type Work<Job, Done> = Box<dyn FnMut(Job, &Task) -> Option<Done>>;

/// One line per kind of work: its variant, its queue, the job and its result, its worker, the work, and what puts parts of
/// the job back into the result that came with it: whoever asked tells them from equal ones.
macro_rules! kinds {
    ($($kind:ident $queue:ident: $job:ty => $done:ty, $lane:ident, $work:expr, $put_back:expr;)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Kind {
            $($kind,)*
        }

        /// A job on its way to a worker.
        #[derive(Clone, Serialize, Deserialize)]
        enum Job {
            $($kind($job),)*
        }

        impl Job {
            const fn kind(&self) -> Kind {
                match self {
                    $(Self::$kind(_) => Kind::$kind,)*
                }
            }
        }

        /// A result on its way back; `None` where a job has none.
        #[derive(Serialize, Deserialize)]
        enum Done {
            $($kind(Option<$done>),)*
        }

        impl Done {
            /// Puts the job back into its result.
            fn of(self, job: &Job) -> Self {
                match (self, job) {
                    $((Self::$kind(Some(mut done)), Job::$kind(job)) => {
                        let put_back: fn(&$job, &mut $done) = $put_back;
                        put_back(job, &mut done);
                        Self::$kind(Some(done))
                    })*
                    (done, _) => done,
                }
            }
        }

        /// A job worker's entry: it keeps the state of each kind of work.
        #[wasm_bindgen]
        pub struct JobWorker {
            exchange: Exchange,
            $($queue: Work<$job, $done>,)*
        }

        impl JobWorker {
            fn begin() -> Self {
                Self { exchange: Exchange::default(), $($queue: Box::new($work),)* }
            }

            fn done(&mut self, job: Job) -> Done {
                let task = Task::passing_on(pass_on);
                match job {
                    $(Job::$kind(job) => Done::$kind((self.$queue)(job, &task)),)*
                }
            }
        }

        /// Where results go.
        struct Results {
            $($queue: Sender<(u64, Option<$done>)>,)*
        }

        impl Results {
            /// Passes a result on to its queue, which is gone when the window is.
            fn send(&self, number: u64, done: Done) {
                match done {
                    $(Done::$kind(done) => drop(self.$queue.send((number, done))),)*
                }
            }

            /// A job has no result.
            fn send_none(&self, number: u64, kind: Kind) {
                self.send(number, match kind { $(Kind::$kind => Done::$kind(None),)* });
            }
        }

        /// The workers, and the instrument's work with what they do in them.
        pub(crate) fn workers(host: &Rc<Host>, ctx: &egui::Context) -> (Workers, Jobs) {
            let [quick, long] = ["quick", "long"].map(|name| Lane::new(name, Rc::clone(host)));
            let lanes = Lanes { quick, long };
            $(
                let lane = Rc::clone(&lanes.$lane);
                let ($queue, finished) = JobQueue::elsewhere(move |number, job, task| {
                    lane.begin(number, Job::$kind(job), task);
                });
                let $queue = ($queue, finished);
            )*
            let results = Results { $($queue: $queue.1,)* };
            let jobs = Jobs { $($queue: $queue.0,)* ..Jobs::inline() };
            (Workers { lanes, results, ctx: ctx.clone() }, jobs)
        }
    };
}

kinds! {
    Table tables: TableJob => TableState, quick, table::make, |_, _| ();
    Check checks: CheckJob => Checked, quick, check::work(), |_, _| ();
    Waveform waveforms: WaveformJob => Waveform, quick, waveform::work(), |_, _| ();
    TimeDomain time_domain: TimeDomainJob => SimulatedField, quick,
        |job, task: &Task| time_domain::run(&job, task), |_, _| ();
    Comparison comparisons: CompareJob => Compared, quick, compare::work, |job, done| done.job = job.clone();
    Places measured_places: MeasuredPlacesJob => MeasuredPlaces, quick, measured_places::work,
        |job, done| done.job = job.clone();
    Rig rigs: RigJob => RigPrepared, long, rig::work, |job, done| done.job = job.clone();
    Sheet sheets: SheetJob => Frame, long, sheet::work(), |_, _| ();
    Plane planes: PlaneJob => PlaneChecked, long, plane::work, |_, _| ();
    Design designs: Draft => Designed, long, design::work, |_, _| ();
    Texture textures: TextureJob => Textured, long, texture::work, |job, done| done.wish = job.wish.clone();
    Calibration calibrations: CalibrateJob => CalibrateDone, long, calibrate::work, |job, done| done.job = job.clone();
}

#[wasm_bindgen]
extern "C" {
    /// Sends a message from this worker.
    #[wasm_bindgen(js_name = postMessage)]
    fn post_message(message: &JsValue);
}

/// Time between two shares that are passed on.
const GLANCE: Duration = Duration::from_millis(50);

/// Passes the share of the running job on to the page's thread, as a number.
fn pass_on(share: f64) {
    thread_local! {
        static LATEST: Cell<Duration> = const { Cell::new(Duration::ZERO) };
    }
    let now = now();
    if now.saturating_sub(LATEST.get()) >= GLANCE {
        LATEST.set(now);
        post_message(&share.into());
    }
}

#[wasm_bindgen]
impl JobWorker {
    /// A worker with nothing to do.
    #[wasm_bindgen(constructor)]
    #[expect(clippy::new_without_default, reason = "it is a constructor of the script's")]
    #[must_use]
    pub fn new() -> Self {
        Self::begin()
    }

    /// Does a job and returns its result, both as bytes; nothing for bytes that are no job of this build.
    pub fn run(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        let (number, job) = self.exchange.run(|| postcard::from_bytes::<(u64, Job)>(bytes)).ok()?;
        let done = self.done(job);
        self.exchange.run(|| postcard::to_extend(&(number, done), Vec::new())).ok()
    }
}

/// A job that runs in a worker.
struct Running {
    number: u64,
    job: Job,
    since: Duration,
    task: Arc<Task>,
}

/// A job that waits for its worker.
struct Waiting {
    number: u64,
    job: Job,
    task: Arc<Task>,
}

#[derive(Default)]
struct State {
    exchange: Exchange,
    running: Option<Running>,
    waiting: Vec<Waiting>,
    /// Jobs that have ended without a result.
    ended: Vec<(u64, Kind)>,
}

/// One worker, and the jobs that wait for it.
struct Lane {
    name: &'static str,
    host: Rc<Host>,
    state: RefCell<State>,
}

impl Lane {
    fn new(name: &'static str, host: Rc<Host>) -> Rc<Self> {
        Rc::new(Self { name, host, state: RefCell::default() })
    }

    /// Takes a job on; it replaces an older one of its kind that waits.
    fn begin(&self, number: u64, job: Job, task: Arc<Task>) {
        let mut state = self.state.borrow_mut();
        state.waiting.retain(|waiting| waiting.job.kind() != job.kind());
        state.waiting.push(Waiting { number, job, task });
        self.go_on(&mut state);
    }

    /// Ends a job that is not wanted any more, and starts the next one.
    fn go_on(&self, state: &mut State) {
        if let Some(running) = state.running.as_ref().filter(|running| running.task.is_over()) {
            let has_newer = state.waiting.iter().any(|waiting| waiting.job.kind() == running.job.kind());
            if !has_newer || now().saturating_sub(running.since) > PATIENCE {
                self.restart(state);
            }
        }
        state.waiting.retain(|waiting| !waiting.task.is_over());
        while state.running.is_none() && !state.waiting.is_empty() {
            let Waiting { number, job, task } = state.waiting.remove(0);
            match state.exchange.run(|| postcard::to_extend(&(number, &job), Vec::new())) {
                Ok(bytes) => {
                    self.host.post_job(self.name, &bytes);
                    state.running = Some(Running { number, job, since: now(), task });
                }
                Err(_) => state.ended.push((number, job.kind())),
            }
        }
    }

    /// Starts the worker anew; the job that runs has no result.
    fn restart(&self, state: &mut State) {
        self.host.restart_lane(self.name);
        state.exchange = Exchange::default();
        state.ended.extend(state.running.take().map(|running| (running.number, running.job.kind())));
    }
}

struct Lanes {
    quick: Rc<Lane>,
    long: Rc<Lane>,
}

/// The job workers, as the page's thread sees them.
pub(crate) struct Workers {
    lanes: Lanes,
    results: Results,
    ctx: egui::Context,
}

impl Workers {
    fn lane(&self, name: &str) -> &Rc<Lane> {
        if name == self.lanes.quick.name { &self.lanes.quick } else { &self.lanes.long }
    }

    /// Takes a worker's result; no bytes: the worker has failed, and was replaced.
    pub(crate) fn take(&self, name: &str, bytes: Option<Vec<u8>>) {
        let lane = self.lane(name);
        let mut state = lane.state.borrow_mut();
        let done =
            bytes.and_then(|bytes| state.exchange.run(|| postcard::from_bytes::<(u64, Done)>(&bytes)).ok());
        match done {
            Some((number, done)) => {
                let running = state.running.take().filter(|running| running.number == number);
                let done = match &running {
                    Some(Running { job, .. }) => done.of(job),
                    None => done,
                };
                self.results.send(number, done);
            }
            None => lane.restart(&mut state),
        }
        lane.go_on(&mut state);
        drop(state);
        self.attend();
        self.ctx.request_repaint();
    }

    /// The kinds of the jobs that run, as a list of JSON.
    pub(crate) fn computing(&self) -> String {
        let lanes = [&self.lanes.quick, &self.lanes.long];
        let running =
            lanes.map(|lane| lane.state.borrow().running.as_ref().map(|running| running.job.kind()));
        let names: Vec<String> = running.iter().flatten().map(|kind| format!("\"{kind:?}\"")).collect();
        format!("[{}]", names.join(","))
    }

    /// Takes the share that a worker has done of its job.
    pub(crate) fn progress(&self, name: &str, share: f64) {
        if let Some(running) = &self.lane(name).state.borrow().running {
            running.task.report(share);
            self.ctx.request_repaint();
        }
    }

    /// Ends what is not wanted any more; for each picture.
    pub(crate) fn attend(&self) {
        for lane in [&self.lanes.quick, &self.lanes.long] {
            let mut state = lane.state.borrow_mut();
            lane.go_on(&mut state);
            for (number, kind) in state.ended.drain(..) {
                self.results.send_none(number, kind);
            }
        }
    }
}
