//! The dialogue of a procedure with a device: one request, and its outcome before the next one.

use super::codes::Codes;
use super::error::MeasureError;
use super::prompt::Prompt;
use super::setback::ended_by;
use slipline_link::protocol::event::State as DeviceState;
use slipline_link::protocol::limits::LEASE_MS;
use slipline_link::{DeviceTable, Outcome, Port, Request, Snapshot};
use slipline_plate::calibrate::Measurement;
use std::cell::{RefCell, RefMut};
use std::future::poll_fn;
use std::rc::Rc;
use std::sync::Arc;
use std::task::Poll;
use std::time::Duration;

/// Status requests to the device, at most, until the codes that it has played are known.
const LOOKS: u32 = 400;
/// The longest lease: a procedure on the bench ends by itself.
const LEASE: Duration = Duration::from_millis(LEASE_MS.1 as u64);

/// One procedure's dialogue with a device. Clones share it.
#[derive(Clone, Default)]
pub struct Dialogue(Rc<RefCell<State>>);

#[derive(Default)]
pub(super) struct State {
    pub(super) asked: Option<Request>,
    pub(super) outcome: Option<Outcome>,
    /// A request whose outcome is awaited while others are sent; and that outcome.
    pub(super) begun: Option<Request>,
    pub(super) ended: Option<Outcome>,
    /// The device's sample index in its last status.
    now: u64,
    /// The share of full scale within which its DAC's output is linear; `None` before the first snapshot.
    linear_share: Option<f64>,
    codes: Option<Codes>,
    /// The plate's own table, while the device may hold another.
    pub(super) own_table: Option<Arc<DeviceTable>>,
    progress: Progress,
    /// The points that a measurement has so far.
    pub(super) so_far: Option<Arc<Measurement>>,
    pub(super) is_checking: bool,
    /// Whether the last request was a stop and has been carried out.
    pub(super) is_silent: bool,
    /// The procedure has armed the device by itself: it is disarmed at the end.
    pub(super) is_armed: bool,
    /// Faults of the device do not end the procedure, which looks at them itself.
    pub(super) bears_faults: bool,
    /// The procedure makes the device restart, so a lost device does not end it; whether the link looked for one before.
    seeks: Option<bool>,
    /// What a person is asked to do.
    pub(super) prompt: Option<Prompt>,
    /// The link's latest snapshot, of a procedure that looks at it, and the slowest answer in one of them.
    seen: Option<Snapshot>,
    slowest: Duration,
}

/// Progress of a procedure, in samples.
#[derive(Clone, Copy)]
struct Progress {
    done: u64,
    all: u64,
    /// First sample and number of samples of the present step.
    running: Option<(u64, u64)>,
    /// The part of the whole, from share to share, each 0 to 1.
    part: (f64, f64),
}

impl Default for Progress {
    fn default() -> Self {
        Self { done: 0, all: 1, running: None, part: (0.0, 1.0) }
    }
}

impl Dialogue {
    /// Sends a request and returns its outcome.
    pub(crate) async fn ask(&self, request: Request) -> Outcome {
        {
            let mut state = self.0.borrow_mut();
            (state.asked, state.is_silent) = (Some(request), false);
        }
        poll_fn(|_| self.0.borrow_mut().outcome.take().map_or(Poll::Pending, Poll::Ready)).await
    }

    /// Sends a request and returns the sample index at which its effect begins. Any outcome except done is an
    /// error.
    pub(crate) async fn done(&self, request: Request) -> Result<u64, MeasureError> {
        let outcome = self.ask(request).await;
        if let Outcome::Done { at } = outcome { Ok(at) } else { Err(ended_by(&outcome)) }
    }

    /// Sends a request whose outcome is awaited by [`ended`](Self::ended), while other requests are sent.
    pub(crate) fn begin(&self, request: Request) {
        self.0.borrow_mut().begun = Some(request);
    }

    /// The outcome of the request that was begun last; `None` if there is none by the time the device has passed this sample.
    pub(crate) async fn ended(&self, sample: u64) -> Result<Option<Outcome>, MeasureError> {
        loop {
            let ended = self.0.borrow_mut().ended.take();
            if ended.is_some() || self.now() > sample {
                return Ok(ended);
            }
            self.done(Request::Refresh).await?;
        }
    }

    /// Stops the drive.
    pub(crate) async fn stop(&self) -> Result<(), MeasureError> {
        self.done(Request::Stop).await?;
        self.0.borrow_mut().is_silent = true;
        Ok(())
    }

    /// Arms the device on the bench, where its amplifier stays muted, or with `unmutes` as for a drive; disarms it before. It is
    /// disarmed at the end, also after an error.
    pub(crate) async fn arm(&self, unmutes: bool) -> Result<u64, MeasureError> {
        self.disarm().await?;
        self.0.borrow_mut().is_armed = true;
        self.done(if unmutes { Request::ArmFor(LEASE) } else { Request::Bench(LEASE) }).await
    }

    /// Disarms the device, and waits until it is silent and muted.
    pub(crate) async fn disarm(&self) -> Result<(), MeasureError> {
        self.done(Request::Disarm).await?;
        self.0.borrow_mut().is_armed = false;
        let is_stopping = |snapshot: &Snapshot| {
            snapshot.drive.status.is_some_and(|status| {
                !matches!(status.state, DeviceState::Idle | DeviceState::Fault | DeviceState::SafeMode)
            })
        };
        for _ in 0..LOOKS {
            self.done(Request::Refresh).await?;
            if !self.seen(is_stopping).unwrap_or_default() {
                break;
            }
        }
        Ok(())
    }

    /// From now on the procedure closes the port or makes the device restart: a loss ends nothing, and no code is replayed any more.
    pub(crate) fn bear_loss(&self) {
        let seeks = self.seen(|snapshot| snapshot.link.auto_reconnect).unwrap_or_default();
        let mut state = self.0.borrow_mut();
        state.seeks.get_or_insert(seeks);
        state.codes = None;
    }

    /// Whether the link looked for a lost device before the procedure made the device restart; `None` where it has not.
    pub(crate) fn seeks(&self) -> Option<bool> {
        self.0.borrow().seeks
    }

    /// The port of the device, also of a lost one.
    pub(crate) fn port(&self) -> Option<Port> {
        self.seen(|snapshot| snapshot.link.port.clone()).flatten()
    }

    /// The device has not come back: it gets no table back.
    pub(crate) fn give_up(&self) {
        let mut state = self.0.borrow_mut();
        (state.own_table, state.is_armed) = (None, false);
    }

    /// Forgets the slowest answer so far.
    pub(crate) fn forget_slowest(&self) {
        self.0.borrow_mut().slowest = Duration::ZERO;
    }

    /// Asks a person, or no more.
    pub(crate) fn prompt(&self, prompt: Option<Prompt>) {
        self.0.borrow_mut().prompt = prompt;
    }

    /// What this reads in the link's latest snapshot; `None` in a procedure that does not bear faults.
    pub(crate) fn seen<T>(&self, read: impl FnOnce(&Snapshot) -> T) -> Option<T> {
        self.0.borrow().seen.as_ref().map(read)
    }

    /// The slowest answer that was seen since [`forget_slowest`](Self::forget_slowest).
    pub(crate) fn slowest(&self) -> Duration {
        self.0.borrow().slowest
    }

    /// Uploads another table, which is replaced by the device's own at the end; returns the sample index from
    /// which it is in force.
    pub(crate) async fn lend(
        &self,
        table: &Arc<DeviceTable>,
        own: &Arc<DeviceTable>,
    ) -> Result<u64, MeasureError> {
        self.0.borrow_mut().own_table = Some(Arc::clone(own));
        self.done(Request::Upload(Arc::clone(table))).await
    }

    /// Waits until the device has passed a sample.
    pub(crate) async fn past(&self, sample: u64) -> Result<(), MeasureError> {
        while self.now() <= sample {
            self.done(Request::Refresh).await?;
        }
        Ok(())
    }

    /// The codes that the device plays from a sample on; waits until they are known.
    pub(crate) async fn codes(&self, from: u64, count: u64) -> Result<Vec<u16>, MeasureError> {
        let mut looks = 0;
        loop {
            if let Some(codes) = self.0.borrow().codes.as_ref().and_then(|codes| codes.played(from, count)) {
                return Ok(codes);
            }
            looks += u32::from(self.now() > from + count);
            if looks > LOOKS {
                return Err(MeasureError::Unknown);
            }
            self.done(Request::Refresh).await?;
        }
    }

    /// The device's sample index in its last status.
    pub(crate) fn now(&self) -> u64 {
        self.0.borrow().now
    }

    /// The factor on a level of full scale by which tones stay within the part in which the output of the device's DAC is linear.
    pub(crate) fn linear_scale(&self, level: f64) -> f64 {
        (self.0.borrow().linear_share.unwrap_or(1.0) / level).min(1.0)
    }

    /// Starts a replay of the device's codes; the latest `samples` codes are kept.
    pub(crate) fn replay(&self, samples: u64) {
        self.0.borrow_mut().codes = Some(Codes::new(samples));
    }

    /// Sets the progress: `done` of `all` samples; `running` has the first sample and the number of samples
    /// of the present step.
    pub(crate) fn mark(&self, done: u64, all: u64, running: Option<(u64, u64)>) {
        let progress = &mut self.0.borrow_mut().progress;
        *progress = Progress { done, all, running, ..*progress };
    }

    /// Publishes the points measured so far.
    pub(super) fn heard(&self, so_far: Measurement) {
        self.0.borrow_mut().so_far = Some(Arc::new(so_far));
    }

    /// Declares that the next step is this part of the whole, from share to share, and whether it checks the
    /// drive.
    pub(super) fn part(&self, from: f64, to: f64, is_checking: bool) {
        let mut state = self.0.borrow_mut();
        state.progress = Progress { part: (from, to), ..Progress::default() };
        state.is_checking = is_checking;
    }

    /// Its state, for the side of the device.
    pub(super) fn state(&self) -> RefMut<'_, State> {
        self.0.borrow_mut()
    }

    pub(super) fn follow(&self, snapshot: &Snapshot) {
        let mut state = self.0.borrow_mut();
        if let Some(codes) = &mut state.codes {
            codes.follow(snapshot);
        }
        state.linear_share = Some(snapshot.linear_share());
        state.now = snapshot.drive.status.map_or(state.now, |status| status.now);
        if state.bears_faults {
            state.slowest = state.slowest.max(snapshot.link.round_trip.last);
            state.seen = Some(snapshot.clone());
        }
    }

    /// The share that is done, 0 to 1, when the device is at sample `now`.
    pub(super) fn progress(&self, now: u64) -> f64 {
        let Progress { done, all, running, part: (from, to) } = self.0.borrow().progress;
        let running = running.map_or(0, |(begin, count)| now.saturating_sub(begin).min(count));
        from + (to - from) * ((done + running) as f64 / all.max(1) as f64).min(1.0)
    }
}
