//! Steps with a person at the board: user button, stop input, and the flash of the profile, which is written while the button is
//! held. The device is disarmed.

use super::course::{Course, reading};
use super::limits::step;
use super::report::StepResult;
use crate::measure::{MeasureError, Prompt};
use slipline_link::protocol::board::{BoardReport, StopInput, UserButton};
use slipline_link::protocol::profile::{ActuatorProfile, CoilHeat};
use slipline_link::protocol::units::CentiDecibel;
use slipline_link::{Request, Snapshot};

/// Time in which a person does what is asked, seconds.
const PATIENCE_S: f64 = 10.0;
/// Readings of the board after a write until the profile is read back.
const LOOKS: usize = 50;

impl Course {
    /// The board, read again.
    pub(super) async fn board(&self) -> Result<BoardReport, MeasureError> {
        self.dialogue.done(Request::ReadBoard).await?;
        Ok(self.dialogue.seen(|snapshot| snapshot.device.board).flatten().unwrap_or_default())
    }

    /// Asks a person, and returns whether it is done in time.
    pub(super) async fn asked(
        &self,
        prompt: Prompt,
        is_done: impl Fn(&BoardReport) -> bool,
    ) -> Result<bool, MeasureError> {
        self.dialogue.done(Request::Refresh).await?;
        let end = self.dialogue.now() + self.samples(PATIENCE_S);
        self.dialogue.prompt(Some(prompt));
        let mut done = false;
        while !done && self.dialogue.now() < end {
            done = is_done(&self.board().await?);
            self.dialogue.done(Request::Refresh).await?;
        }
        self.dialogue.prompt(None);
        Ok(done)
    }

    /// The user button, and the stop input where the profile says that one is fitted; `at_start` is the board before anything was
    /// asked.
    pub(super) async fn buttons(&self, at_start: &BoardReport) -> Result<StepResult, MeasureError> {
        let name = step::BUTTONS;
        let is_stuck = at_start.user_button == UserButton::Pressed;
        let unasked = reading(name, "pressed unasked", f64::from(u8::from(is_stuck)));
        if is_stuck {
            return Ok(StepResult::judged(name, vec![unasked], ""));
        }
        if at_start.user_button == UserButton::None {
            return Ok(StepResult::skipped(name, "The board reports no user button."));
        }
        if !self.request.asks {
            return Ok(StepResult::skipped(name, "Nobody was asked to press the user button."));
        }
        let failed = |quantity, done: bool| reading(name, quantity, f64::from(u8::from(!done)));
        let pressed =
            self.asked(Prompt::PressButton, |board| board.user_button == UserButton::Pressed).await?;
        let mut readings = vec![unasked, failed("not pressed in time", pressed)];
        if pressed {
            let released =
                self.asked(Prompt::ReleaseButton, |board| board.user_button == UserButton::Released).await?;
            readings.push(failed("not released in time", released));
        }
        if matches!(at_start.stop_input, StopInput::Closed | StopInput::Open) {
            let opened =
                self.asked(Prompt::OpenStopInput, |board| board.stop_input == StopInput::Open).await?;
            readings.push(failed("stop input not opened in time", opened));
            let closed =
                self.asked(Prompt::CloseStopInput, |board| board.stop_input == StopInput::Closed).await?;
            readings.push(failed("stop input not closed in time", closed));
        }
        Ok(StepResult::judged(name, readings, "What a person pressed was seen."))
    }

    /// Writes a profile, reads it back, erases it again and reads that back. Only where the board keeps none.
    pub(super) async fn store(&self, button: UserButton) -> Result<StepResult, MeasureError> {
        let name = step::STORE;
        let kept = self.dialogue.seen(|snapshot| snapshot.device.profile.clone()).flatten();
        let Some(kept) = kept else {
            return Ok(StepResult::skipped(name, "The device keeps no profile of its actuator."));
        };
        if kept.profile.is_some() {
            return Ok(StepResult::skipped(
                name,
                "The board keeps a profile of its actuator, which is not overwritten.",
            ));
        }
        if button == UserButton::Pressed {
            return Ok(StepResult::skipped(name, "The user button reads pressed while nobody presses it."));
        }
        if !self.request.asks || button == UserButton::None {
            return Ok(StepResult::skipped(
                name,
                "Nobody was asked to hold the user button, without which nothing is written.",
            ));
        }
        if !self.asked(Prompt::HoldButton, |board| board.user_button == UserButton::Pressed).await? {
            return Ok(StepResult::skipped(name, "The user button was not held, so nothing was written."));
        }
        let (mut differing, mut longest_s) = (0, 0.0_f64);
        for wanted in [Some(profile()), None] {
            let before = self.time_s();
            self.dialogue.done(Request::WriteProfile(Box::new(wanted.clone()))).await?;
            self.dialogue.done(Request::Refresh).await?;
            longest_s = longest_s.max(self.time_s() - before);
            differing += u32::from(!self.reads_back(wanted.as_ref()).await?);
        }
        self.asked(Prompt::ReleaseButton, |board| board.user_button != UserButton::Pressed).await?;
        let readings = vec![
            reading(name, "profiles that differ", f64::from(differing)),
            reading(name, "longest write", longest_s),
        ];
        Ok(StepResult::judged(
            name,
            readings,
            "A profile was written, read back and erased; not across a reset.",
        ))
    }

    /// The host's time at the latest status, seconds.
    fn time_s(&self) -> f64 {
        self.dialogue.seen(|snapshot| snapshot.drive.status_time.as_secs_f64()).unwrap_or_default()
    }

    /// Whether the device reports this profile soon.
    async fn reads_back(&self, wanted: Option<&ActuatorProfile>) -> Result<bool, MeasureError> {
        let is_wanted = |snapshot: &Snapshot| {
            snapshot.device.profile.as_ref().is_some_and(|report| report.profile.as_ref() == wanted)
        };
        for _ in 0..LOOKS {
            if self.dialogue.seen(is_wanted).unwrap_or_default() {
                return Ok(true);
            }
            self.dialogue.done(Request::Refresh).await?;
        }
        Ok(false)
    }
}

/// The profile that is written: the least that a device allows.
fn profile() -> ActuatorProfile {
    ActuatorProfile {
        name: "self-test".try_into().unwrap_or_default(),
        max_sum_per_mille: 10,
        travel: None,
        heat: CoilHeat { winding_ms: 8000, body_ms: 120_000, full_sine_per_mille: 1000 },
        max_rise: CentiDecibel(0),
        max_drive_ms: 1000,
        has_stop_input: false,
    }
}
