//! Work that takes longer than a picture, in workers: one for quick jobs, one for long ones.
//!
//! ```text
//! JobQueue --begin--> Lane --number, job--> JobWorker
//!    ^                 |   <-number, result-
//!    +----- result ----+
//! ```

mod lanes;

pub(crate) use lanes::Workers;

use crate::clock::now;
use crate::host::Host;
use eframe::egui;
use lanes::{Lane, Lanes};
use serde::{Deserialize, Serialize};
use slipline_instrument::Jobs;
use slipline_model::jobs::{self, JobQueue, Task};
use slipline_plate::exchange::Exchange;
use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

type Work<Job, Done> = Box<dyn FnMut(Job, &Task) -> Option<Done>>;

/// The page's part of each kind of work in a worker: see [`for_each_job`](slipline_instrument::for_each_job).
macro_rules! kinds {
    ($(
        #[doc = $meaning:literal]
        $kind:ident $queue:ident: $job:ty => $done:ty, $thread:literal, $lane:ident, $work:expr;
    )*) => {
        /// A kind of work.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
        pub(crate) enum Kind {
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

        /// A job worker's entry: it keeps the state of each kind of work.
        #[wasm_bindgen]
        pub struct JobWorker {
            exchange: Exchange,
            $($queue: Work<$job, $done>,)*
        }

        impl Default for JobWorker {
            fn default() -> Self {
                Self { exchange: Exchange::default(), $($queue: Box::new($work),)* }
            }
        }

        impl JobWorker {
            fn done(&mut self, job: Job) -> Done {
                let task = Task::passing_on(pass_on);
                match job {
                    $(Job::$kind(job) => Done::$kind((self.$queue)(job, &task)),)*
                }
            }
        }

        /// Where results go.
        struct Results {
            $($queue: jobs::Results<$done>,)*
        }

        impl Results {
            /// Passes a result on to its queue, which is gone when the window is.
            fn send(&self, number: u64, done: Done) {
                let _ = match done {
                    $(Done::$kind(done) => self.$queue.send(number, done),)*
                };
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
            (Workers::new(lanes, results, ctx.clone()), jobs)
        }

        /// For tests: the instrument's work, done at once by the entry of a worker.
        #[cfg(feature = "tests")]
        pub(crate) fn jobs_at_once() -> Jobs {
            let [quick, long] = [(); 2].map(|()| Rc::new(std::cell::RefCell::new(AtOnce::default())));
            let lanes = Lanes { quick, long };
            $(
                let worker = Rc::clone(&lanes.$lane);
                let $queue = JobQueue::inline(move |job, _: &Task| {
                    match worker.borrow_mut().done(Job::$kind(job)) {
                        Some(Done::$kind(done)) => done,
                        _ => None,
                    }
                });
            )*
            Jobs { $($queue,)* ..Jobs::inline() }
        }
    };
}

slipline_instrument::for_each_job!(kinds);

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
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Does a job and returns its result, both as bytes; nothing for bytes that are no job of this build.
    pub fn run(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        let (number, job) = self.exchange.run(|| postcard::from_bytes::<(u64, Job)>(bytes)).ok()?;
        let done = self.done(job);
        self.exchange.run(|| postcard::to_extend(&(number, done), Vec::new())).ok()
    }
}

/// The entry of a worker in the same thread, and the plates that were sent to it.
#[cfg(feature = "tests")]
#[derive(Default)]
struct AtOnce {
    exchange: Exchange,
    worker: JobWorker,
}

#[cfg(feature = "tests")]
impl AtOnce {
    fn done(&mut self, job: Job) -> Option<Done> {
        let sent = self.exchange.run(|| postcard::to_extend(&(0_u64, &job), Vec::new())).ok()?;
        let sent_back = self.worker.run(&sent)?;
        let answer = self.exchange.run(|| postcard::from_bytes::<(u64, Done)>(&sent_back));
        answer.ok().map(|(_, done)| done)
    }
}
