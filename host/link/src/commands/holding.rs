//! The level hold: its state is read from the device periodically while it is on.

use super::queue::CommandQueue;
use super::task::{Job, Task};
use crate::journal::Change;
use crate::log::Severity;
use crate::recorder::Recorder;
use crate::request::Outcome;
use slipline_protocol::hold::{Held, HoldProgress, HoldSetting};
use slipline_protocol::units::SampleIndex;
use std::time::Duration;

/// Time between two requests for the hold's state.
const PERIOD: Duration = Duration::from_millis(100);

impl CommandQueue {
    /// The device has accepted a hold, or the end of one.
    pub(super) fn holds(
        &mut self,
        setting: &HoldSetting,
        at: SampleIndex,
        recorder: &mut Recorder,
        now: Duration,
    ) {
        self.drop_tasks(recorder, |job| matches!(job, Job::HoldRead));
        if setting.tones.is_empty() {
            recorder.hold(None);
            return;
        }
        recorder.acknowledge(at, Change::Hold);
        // The hold uses the lock-ins from now on.
        self.drop_tasks(recorder, |job| matches!(job, Job::ListenRead(_)));
        self.read_hold(now);
    }

    /// Stores the reported state of the hold; requests it again as long as the hold is on.
    pub(super) fn held(&mut self, task: &Task, reply: Held, recorder: &mut Recorder, now: Duration) {
        let at = reply.begin;
        match reply.progress {
            HoldProgress::On => self.read_hold(now + PERIOD),
            HoldProgress::Lost => {
                recorder.log(
                    Severity::Warning,
                    "The level hold has lost all tones: they sound at the drive's levels.",
                );
            }
            HoldProgress::Off | HoldProgress::Ended => {}
        }
        recorder.hold(Some(reply));
        recorder.finish(task.ticket, Outcome::Done { at });
    }

    fn read_hold(&mut self, not_before: Duration) {
        self.tasks.push_back(Task { not_before, ..Task::new(None, Job::HoldRead) });
    }
}
