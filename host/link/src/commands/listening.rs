//! Measurements and captures: their results are read from the device until the request is done.

use super::queue::CommandQueue;
use super::reading::{CaptureReading, ListenReading};
use super::task::{Job, Task};
use crate::listen::{Captured, Listened};
use crate::recorder::Recorder;
use crate::refusal::Refusal;
use crate::request::Outcome;
use slipline_protocol::limits::{BLOCK, LISTENED_TONES};
use slipline_protocol::listen::{self, Progress};
use slipline_protocol::units::SampleIndex;
use std::sync::Arc;
use std::time::Duration;

/// Time after which a result that is late is requested again.
const PAUSE: Duration = Duration::from_millis(5);
/// Samples from an input block to its report. The device's clock is that of the block that it renders next; a
/// block then waits, plays, is sampled, and is reported in the following turn.
const BEHIND: u64 = 4 * BLOCK as u64;

impl CommandQueue {
    /// The device measures from an index on: the result is requested at the window's end.
    pub(super) fn listens(&mut self, task: &Task, at: SampleIndex, recorder: &mut Recorder, now: Duration) {
        let Job::Listen(request) = task.job else { return };
        // The device has discarded the previous measurement.
        self.drop_tasks(recorder, |job| matches!(job, Job::ListenRead(_)));
        let end = at.saturating_add(BLOCK as u64 * u64::from(request.blocks));
        let listened = Listened::begun(at, request.blocks);
        let reading = ListenReading { request, first_slot: 0, listened };
        self.read_after(end, Task::new(task.ticket, Job::ListenRead(Box::new(reading))), recorder, now);
    }

    /// The device captures from an index on: the values are requested at the capture's end.
    pub(super) fn captures(&mut self, task: &Task, at: SampleIndex, recorder: &mut Recorder, now: Duration) {
        let Job::Capture(request) = task.job else { return };
        self.drop_tasks(recorder, |job| matches!(job, Job::CaptureRead(_)));
        let end = at.saturating_add(u64::from(request.values) << request.log2_codes.min(32));
        let captured = Captured { from: at, log2_codes: request.log2_codes, values: Vec::new() };
        let reading = CaptureReading { request, captured };
        self.read_after(end, Task::new(task.ticket, Job::CaptureRead(Box::new(reading))), recorder, now);
    }

    /// Requests a result when the samples up to an index should be complete, by the clock in the latest
    /// status.
    fn read_after(&mut self, end: SampleIndex, mut task: Task, recorder: &Recorder, now: Duration) {
        let end = end.saturating_add(BEHIND);
        let rate = recorder.view.device.identity.as_ref().map_or(0, |identity| identity.sample_rate_hz);
        let clock = recorder.view.drive.status.map_or(end, |status| status.now);
        let left = end.saturating_sub(clock) as f64 / f64::from(rate.max(1));
        // No measurement lasts for hours; too large a number waits until the session's end drops it.
        let over = Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX);
        task.not_before = recorder.view.drive.status_time.saturating_add(over).max(now);
        self.tasks.push_back(task);
    }

    /// Stores a part of a measurement.
    pub(super) fn listened(
        &mut self,
        mut task: Task,
        report: &listen::Listened,
        recorder: &mut Recorder,
        now: Duration,
    ) {
        let Job::ListenRead(reading) = &mut task.job else {
            return recorder.finish(task.ticket, Outcome::Refused(Refusal::UnexpectedReply));
        };
        match report.progress {
            Progress::Running => {
                task.not_before = now + PAUSE;
                return self.tasks.push_back(task);
            }
            Progress::Broken { at } => {
                return recorder.finish(task.ticket, Outcome::Refused(Refusal::InputLost { at }));
            }
            Progress::Idle => return recorder.finish(task.ticket, Outcome::Superseded),
            Progress::Finished => {}
        }
        reading.listened.take(reading.first_slot, report);
        let next = reading.first_slot.saturating_add(LISTENED_TONES as u8);
        if reading.request.slots.checked_shr(next.into()).is_some_and(|rest| rest != 0) {
            reading.first_slot = next;
            return self.tasks.push_front(task);
        }
        let listened = Arc::new(reading.listened.clone());
        recorder.finish(task.ticket, Outcome::Listened(listened));
    }

    /// Stores values of a capture.
    pub(super) fn captured(
        &mut self,
        mut task: Task,
        report: &listen::Captured,
        recorder: &mut Recorder,
        now: Duration,
    ) {
        let Job::CaptureRead(reading) = &mut task.job else {
            return recorder.finish(task.ticket, Outcome::Refused(Refusal::UnexpectedReply));
        };
        match report.progress {
            Progress::Broken { at } => {
                return recorder.finish(task.ticket, Outcome::Refused(Refusal::InputLost { at }));
            }
            Progress::Idle => return recorder.finish(task.ticket, Outcome::Superseded),
            Progress::Running | Progress::Finished => {}
        }
        let values = &mut reading.captured.values;
        let wanted = usize::from(reading.request.values);
        values.extend(report.values.iter().take(wanted.saturating_sub(values.len())));
        if values.len() >= wanted {
            return recorder.finish(task.ticket, Outcome::Captured(Arc::new(reading.captured.clone())));
        }
        if report.values.is_empty() {
            task.not_before = now + PAUSE;
            self.tasks.push_back(task);
        } else {
            self.tasks.push_front(task);
        }
    }
}
