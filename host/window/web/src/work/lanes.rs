//! The job workers, as the page's thread sees them: what runs, and what waits.
//!
//! A worker receives no message while its job runs. So a job that is no longer wanted is ended with its worker, which
//! is restarted at once. But a browser lets a worker that is ended compute for a while, beside the new one: so only a
//! job that has already taken as long is ended, and what waits, waits for any other.

use super::{Done, Job, Kind, Results};
use crate::clock::now;
use crate::host::Host;
use eframe::egui;
use slipline_model::jobs::Task;
use slipline_plate::exchange::Exchange;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

/// A running job that is not wanted any more is ended when it is older than this: as long as Chromium lets a worker that is
/// ended go on. With less, each place of a drag left another worker that computed for two seconds.
const PATIENCE: Duration = Duration::from_secs(2);

/// A job that runs in a worker.
struct Running {
    number: u64,
    kind: Kind,
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
pub(super) struct Lane {
    name: &'static str,
    host: Rc<Host>,
    state: RefCell<State>,
}

impl Lane {
    pub(super) fn new(name: &'static str, host: Rc<Host>) -> Rc<Self> {
        Rc::new(Self { name, host, state: RefCell::default() })
    }

    /// Takes a job on; it replaces an older one of its kind that waits.
    pub(super) fn begin(&self, number: u64, job: Job, task: Arc<Task>) {
        let mut state = self.state.borrow_mut();
        state.waiting.retain(|waiting| waiting.job.kind() != job.kind());
        state.waiting.push(Waiting { number, job, task });
        self.go_on(&mut state);
    }

    /// Ends a job that is not wanted any more, and starts the next one. Returns when to look again, where such a job runs on.
    fn go_on(&self, state: &mut State) -> Option<Duration> {
        let unwanted = state.running.as_ref().filter(|running| running.task.is_over());
        let rest = unwanted.map(|running| PATIENCE.saturating_sub(now().saturating_sub(running.since)));
        if rest == Some(Duration::ZERO) {
            self.restart(state);
        }
        state.waiting.retain(|waiting| !waiting.task.is_over());
        while state.running.is_none() && !state.waiting.is_empty() {
            let Waiting { number, job, task } = state.waiting.remove(0);
            match state.exchange.run(|| postcard::to_extend(&(number, &job), Vec::new())) {
                Ok(bytes) => {
                    self.host.post_job(self.name, &bytes);
                    state.running = Some(Running { number, kind: job.kind(), since: now(), task });
                }
                Err(_) => state.ended.push((number, job.kind())),
            }
        }
        rest.filter(|rest| !rest.is_zero())
    }

    /// Starts the worker again; the job that runs has no result.
    fn restart(&self, state: &mut State) {
        self.host.restart_lane(self.name);
        state.exchange = Exchange::default();
        state.ended.extend(state.running.take().map(|running| (running.number, running.kind)));
    }
}

/// One of each worker.
pub(super) struct Lanes<Lane> {
    pub(super) quick: Lane,
    pub(super) long: Lane,
}

/// The job workers, as the page's thread sees them.
pub(crate) struct Workers {
    lanes: Lanes<Rc<Lane>>,
    results: Results,
    ctx: egui::Context,
}

impl Workers {
    pub(super) const fn new(lanes: Lanes<Rc<Lane>>, results: Results, ctx: egui::Context) -> Self {
        Self { lanes, results, ctx }
    }

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
                state.running = None;
                self.results.send(number, done);
            }
            None => lane.restart(&mut state),
        }
        lane.go_on(&mut state);
        drop(state);
        self.attend();
        self.ctx.request_repaint();
    }

    /// The kinds of the jobs that run.
    pub(crate) fn computing(&self) -> Vec<Kind> {
        let lanes = [&self.lanes.quick, &self.lanes.long];
        lanes.iter().filter_map(|lane| Some(lane.state.borrow().running.as_ref()?.kind)).collect()
    }

    /// Takes the share that a worker has done of its job.
    pub(crate) fn progress(&self, name: &str, share: f64) {
        if let Some(running) = &self.lane(name).state.borrow().running {
            running.task.report(share);
            self.ctx.request_repaint();
        }
    }

    /// Ends tasks whose results nobody needs any more; called for each picture.
    pub(crate) fn attend(&self) {
        for lane in [&self.lanes.quick, &self.lanes.long] {
            let mut state = lane.state.borrow_mut();
            if let Some(rest) = lane.go_on(&mut state) {
                self.ctx.request_repaint_after(rest);
            }
            for (number, kind) in state.ended.drain(..) {
                self.results.send_none(number, kind);
            }
        }
    }
}
