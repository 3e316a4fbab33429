//! Steps in which the device restarts: the ROM bootloader, and faults on purpose. The link loses it and finds it again.

use super::course::{Course, reading};
use super::limits::step;
use super::report::{Reading, StepResult};
use crate::measure::{MeasureError, Prompt, ended_by};
use slipline_link::protocol::board::{
    BoardReport, FaultEnd, FaultOrder, MuteTrial, OrderedFault, PinLevel, UserButton,
};
use slipline_link::protocol::event::{Identity, ResetCause, State, StoredConfig};
use slipline_link::protocol::profile::ActuatorProfile;
use slipline_link::{LinkState, Outcome, Port, Refusal, Request, Snapshot};
use std::time::Duration;

/// How often, and for how long each time, a device that restarts is waited for: USB needs a second, a person some more.
const LOOKS: u32 = 30;
const LOOK: Duration = Duration::from_secs(1);
/// Time after an order by which the device has failed, seconds: it does so within 0.1 s.
const FAILED_S: f64 = 1.0;
/// Openings of the port, and of a short test.
const REOPENINGS: u32 = 20;
const SHORT_REOPENINGS: u32 = 2;

/// A fault on purpose: how the next hello names its reset, and its quantity.
const FAULTS: [(OrderedFault, ResetCause, &str); 3] = [
    (OrderedFault::Hang, ResetCause::Watchdog, "time to mute in a hang"),
    (OrderedFault::MaskedInterrupts, ResetCause::Watchdog, "time to mute with interrupts masked"),
    (OrderedFault::StackOverflow, ResetCause::HardFault, "time to mute by a stack overflow"),
];

/// What a device is and keeps, whatever made it restart.
struct Kept {
    board: String,
    build: String,
    unit: [u8; 12],
    firmware: (u8, u8, u8),
    has_table: bool,
    profile: Option<ActuatorProfile>,
}

impl Kept {
    fn of(snapshot: &Snapshot) -> Option<Self> {
        let identity: &Identity = snapshot.device.identity.as_ref()?;
        Some(Self {
            board: identity.board.to_string(),
            build: identity.build.to_string(),
            unit: identity.unit,
            firmware: identity.firmware,
            has_table: matches!(identity.stored, StoredConfig::Loaded | StoredConfig::FellBack),
            profile: snapshot.device.profile.as_ref().and_then(|report| report.profile.clone()),
        })
    }

    /// How many of the facts differ afterwards. A table that was stored meanwhile is no loss.
    fn differences(&self, after: &Self) -> u32 {
        let differs = [
            self.board != after.board,
            self.build != after.build,
            self.unit != after.unit,
            self.firmware != after.firmware,
            self.has_table && !after.has_table,
            self.profile != after.profile,
        ];
        differs.into_iter().map(u32::from).sum()
    }
}

/// The outcome of an ordered fault.
enum Trial {
    /// The mute pin is low where the device is armed: nothing was ordered.
    Muted,
    /// The device did not answer any more.
    Gone,
    /// It is back, after another reset than that of the fault.
    Otherwise,
    /// It is back, and reports this.
    Ended(FaultEnd),
}

impl Course {
    /// Closes the port and opens it again, some times: each begins a session, as a cable does that is plugged in.
    pub(super) async fn reopenings(&self) -> Result<Vec<Reading>, MeasureError> {
        let reopenings = if self.is_short() { SHORT_REOPENINGS } else { REOPENINGS };
        let port = self.port()?;
        self.dialogue.bear_loss();
        let mut unanswered = 0;
        for _ in 0..reopenings {
            self.dialogue.done(Request::Disconnect).await?;
            let opened = self.dialogue.ask(Request::Connect(port.clone())).await;
            if !matches!(opened, Outcome::Done { .. }) {
                unanswered += 1;
                if !self.is_back(&port).await {
                    self.lose();
                    break;
                }
            }
        }
        let of = |name, count: u32| reading(step::LINK, name, f64::from(count));
        Ok(vec![of("reopenings", reopenings), of("reopenings without answer", unanswered)])
    }

    /// Sends the device into its ROM bootloader and out again, by a person's reset.
    pub(super) async fn rom_bootloader(&self, button: UserButton) -> Result<StepResult, MeasureError> {
        let name = step::BOOTLOADER;
        if !self.request.asks || self.request.is_short {
            return Ok(StepResult::skipped(name, "Nobody was asked to press the board's reset button."));
        }
        let (before, port) = (self.kept()?, self.port()?);
        let is_pressed = |board: &BoardReport| board.user_button == UserButton::Pressed;
        if before.profile.is_some()
            && (button == UserButton::None || !self.asked(Prompt::HoldButton, is_pressed).await?)
        {
            return Ok(StepResult::skipped(
                name,
                "The board keeps a profile, and its user button was not held: it leaves its program only with a hand on it.",
            ));
        }
        self.dialogue.bear_loss();
        let last = self.dialogue.now();
        let entered = self.dialogue.ask(Request::Bootloader).await;
        let of = |quantity, is_so: bool| reading(name, quantity, f64::from(u8::from(is_so)));
        if matches!(entered, Outcome::Refused(Refusal::NotInBootloader)) {
            return Ok(StepResult::judged(name, vec![of("stays in the program", true)], ""));
        }
        if !matches!(entered, Outcome::Done { .. }) {
            return Err(ended_by(&entered));
        }
        // It leaves its program some time after its answer.
        self.dialogue.ask(Request::Await(LOOK)).await;
        self.dialogue.prompt(Some(Prompt::PressReset));
        let is_back = self.is_back(&port).await;
        self.dialogue.prompt(None);
        // Its samples begin at 0 again.
        let stays = is_back && self.dialogue.now() >= last;
        let mut readings = vec![of("stays in the program", stays), of("not back in time", !is_back)];
        if !is_back {
            self.lose();
            return Ok(StepResult::judged(name, readings, ""));
        }
        readings.push(reading(name, "differences after it", f64::from(before.differences(&self.kept()?))));
        let cause = self.reset_cause();
        Ok(StepResult::judged(
            name,
            readings,
            format!(
                "The device left its program, and came back ({cause:?}) with the same firmware, table and profile. What the ROM itself answers was not read."
            ),
        ))
    }

    /// Makes the device fail, in each way, with its mute pin high.
    pub(super) async fn faults_on_purpose(&self) -> Result<StepResult, MeasureError> {
        let name = step::FAULTS;
        if self.request.is_short {
            return Ok(StepResult::skipped(name, "The device is not made to fail in a short test."));
        }
        let port = self.port()?;
        let (mut times, mut otherwise, mut lost) = (Vec::new(), 0, 0);
        for (fault, cause, quantity) in FAULTS {
            match self.failed_by(fault, cause, &port).await? {
                Trial::Muted => {
                    return Ok(StepResult::skipped(
                        name,
                        "The pin stays low where the device is armed: see the step mute.",
                    ));
                }
                Trial::Gone => {
                    lost += 1;
                    self.lose();
                    break;
                }
                Trial::Otherwise => otherwise += 1,
                Trial::Ended(end) => {
                    times.push(reading(name, quantity, f64::from(end.muted_after_us) / 1000.0));
                }
            }
        }
        let is_safe_mode = self.state() == Some(State::SafeMode);
        let mut readings = vec![
            reading(name, "faults that end otherwise", f64::from(otherwise)),
            reading(name, "faults without return", f64::from(lost)),
            reading(name, "safe mode after them", f64::from(u8::from(is_safe_mode))),
        ];
        readings.extend(times);
        Ok(StepResult::judged(
            name,
            readings,
            "Each fault has muted in time, and was reported at the next hello.",
        ))
    }

    /// Orders this fault, with the mute pin high, and waits until the device is back.
    async fn failed_by(
        &self,
        fault: OrderedFault,
        cause: ResetCause,
        port: &Port,
    ) -> Result<Trial, MeasureError> {
        self.idle().await?;
        let ready = self.dialogue.arm(true).await?;
        self.dialogue.past(ready).await?;
        self.dialogue.done(Request::MutePin(MuteTrial::Read)).await?;
        let level = self.dialogue.seen(|snapshot| snapshot.device.mute_pin.map(|pin| pin.level)).flatten();
        if level != Some(PinLevel::High) {
            self.dialogue.disarm().await?;
            return Ok(Trial::Muted);
        }
        self.dialogue.done(Request::FaultToken).await?;
        let trial = |snapshot: &Snapshot| snapshot.device.fault_trial;
        let token = self.dialogue.seen(trial).flatten().unwrap_or_default().token;
        self.dialogue.bear_loss();
        let at = self.dialogue.done(Request::FaultOrder(FaultOrder { fault, token })).await?;
        let end = at + self.samples(FAILED_S);
        while matches!(self.dialogue.ask(Request::Refresh).await, Outcome::Done { .. }) {
            // A device that has restarted within a look answers a new session.
            if self.dialogue.now() > end || self.dialogue.now() < at {
                break;
            }
        }
        if !self.is_back(port).await {
            return Ok(Trial::Gone);
        }
        self.dialogue.done(Request::FaultToken).await?;
        let last = self.dialogue.seen(trial).flatten().unwrap_or_default().last;
        let ended = last.filter(|end| end.fault == fault && self.reset_cause() == Some(cause));
        // Its fault is latched, as that of any such reset.
        self.dialogue.done(Request::ClearFaults).await?;
        self.dialogue.disarm().await?;
        Ok(ended.map_or(Trial::Otherwise, Trial::Ended))
    }

    /// Waits until the device answers at its port.
    async fn is_back(&self, port: &Port) -> bool {
        self.dialogue.ask(Request::AutoReconnect(true)).await;
        let mut is_back = false;
        for _ in 0..LOOKS {
            let state = self.dialogue.seen(|snapshot| snapshot.link.state.clone());
            if matches!(state, None | Some(LinkState::Disconnected)) {
                self.dialogue.ask(Request::Connect(port.clone())).await;
            }
            is_back = matches!(self.dialogue.ask(Request::Await(LOOK)).await, Outcome::Done { .. });
            if is_back {
                break;
            }
        }
        self.dialogue.ask(Request::AutoReconnect(self.dialogue.seeks().unwrap_or_default())).await;
        is_back && self.dialogue.done(Request::Refresh).await.is_ok()
    }

    /// The device has not come back: nothing else can be shown.
    fn lose(&self) {
        self.dialogue.give_up();
        *self.obstacle.borrow_mut() = Some("Not shown: the device did not answer any more.".to_owned());
    }

    fn port(&self) -> Result<Port, MeasureError> {
        self.dialogue.port().ok_or(MeasureError::Lost)
    }

    fn kept(&self) -> Result<Kept, MeasureError> {
        self.dialogue.seen(Kept::of).flatten().ok_or(MeasureError::Lost)
    }

    fn reset_cause(&self) -> Option<ResetCause> {
        self.dialogue
            .seen(|snapshot| snapshot.device.identity.as_ref().map(|identity| identity.reset))
            .flatten()
    }

    fn state(&self) -> Option<State> {
        self.dialogue.seen(|snapshot| snapshot.drive.status.map(|status| status.state)).flatten()
    }
}
