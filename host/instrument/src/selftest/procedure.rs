//! The order of the steps.

use super::course::Course;
use super::limits::step;
use super::report::{SelftestReport, StepResult};
use super::request::SelftestRequest;
use super::verdict::Verdict;
use crate::measure::{Dialogue, Evaluation, MeasureError, Procedure, evaluated};
use slipline_link::protocol::board::{BoardReport, PinLevel, UserButton};
use slipline_link::{Request, Snapshot};

/// The self-test of a connected device, which it disarms at its begin and leaves disarmed.
///
/// The mute pin stays low except in the steps that time it and that make the device fail on purpose, and there only with
/// [`is_amplifier_unplugged`](SelftestRequest::is_amplifier_unplugged); and in the step with the amplifier, only with
/// [`is_amplifier_on`](SelftestRequest::is_amplifier_on).
pub struct Selftesting {
    request: SelftestRequest,
}

impl Selftesting {
    /// A self-test.
    #[must_use]
    pub const fn new(request: SelftestRequest) -> Self {
        Self { request }
    }
}

const NO_SENSOR_WIRE: &str = "Not wired: connect the DAC's pin with the sensor's pin (dac=sensor).";
const NO_TRIGGER_WIRE: &str =
    "Not wired: connect the trigger output with the trigger input (trigger=trigger-in).";
const NO_AMPLIFIER: &str = "The amplifier is tested by itself, once all else has passed (--amplifier).";
const PLUGGED: &str = "It takes the mute pin high: unplug the amplifier first (--amplifier-unplugged).";

impl Procedure for Selftesting {
    type Found = SelftestReport;
    const BEARS_FAULTS: bool = true;

    async fn carry_out(self, dialogue: Dialogue) -> Result<Evaluation<SelftestReport>, MeasureError> {
        dialogue.done(Request::Refresh).await?;
        // The answer to this request is the first that counts.
        dialogue.forget_slowest();
        dialogue.done(Request::Refresh).await?;
        let course = Course::new(dialogue.clone(), self.request)?;
        let faults = course.faults();
        if !faults.is_empty() {
            return Err(MeasureError::StandingFault(faults.to_string()));
        }
        course.carry_out().await.map(evaluated)
    }
}

impl Course {
    /// Marks the progress, by steps.
    fn mark(&self, done: usize) {
        self.dialogue.mark(done as u64, step::ALL.len() as u64, None);
    }

    async fn carry_out(self) -> Result<SelftestReport, MeasureError> {
        // A device that does not come back from the last steps is reported, too.
        let begun = self.dialogue.seen(|snapshot| report(snapshot, self.request)).flatten();
        let begun = begun.ok_or(MeasureError::Lost)?;
        self.dialogue.disarm().await?;
        let (steps, codes_crc) = if self.request.is_amplifier_on {
            (self.with_amplifier().await?, None)
        } else {
            self.without_amplifier().await?
        };
        self.mark(step::ALL.len());
        Ok(SelftestReport { codes_crc, steps, ..begun })
    }

    /// The steps without an amplifier, and the CRC of the compared codes.
    async fn without_amplifier(&self) -> Result<(Vec<StepResult>, Option<String>), MeasureError> {
        let course = self;
        let dialogue = &course.dialogue;
        let since = course.moment().await?;
        let link_before = course.link_record();
        let board = course.board_or_none().await?;
        if board.user_button == UserButton::Pressed {
            let why = "The user button reads pressed, so the device cannot be armed.";
            *course.obstacle.borrow_mut() = Some(why.to_owned());
        }
        let supply = course.supply();
        let mut levels = vec![course.mute_level_or_none().await?];
        course.mark(3);
        if course.obstacle.borrow().is_none() {
            match course.begin().await {
                Ok(()) => levels.push(course.mute_level().await?),
                Err(MeasureError::TooOld) => {
                    let why = "The device's firmware knows no bench, on which its amplifier stays muted.";
                    *course.obstacle.borrow_mut() = Some(why.to_owned());
                }
                Err(error) => return Err(error),
            }
        }
        let [dac_to_adc, delay, noise] = course.by_sensor_wire().await?;
        course.mark(7);
        let load = course.driven(step::LOAD, course.load()).await?;
        course.mark(8);
        let mut codes_crc = None;
        let codes = course
            .driven(step::CODES, async {
                let compared = course.codes().await?;
                codes_crc = Some(compared.crc);
                Ok(compared.result)
            })
            .await?;
        course.mark(9);
        let trigger = course.by_trigger_wire(&board).await?;
        course.mark(10);
        if course.obstacle.borrow().is_none() {
            levels.push(course.mute_level().await?);
        }
        dialogue.disarm().await?;
        levels.push(course.mute_level_or_none().await?);
        let mute = course.mute(&levels);
        let mute_time = if course.request.is_amplifier_unplugged {
            course.driven(step::MUTE_TIME, course.mute_time()).await?
        } else {
            StepResult::skipped(step::MUTE_TIME, PLUGGED)
        };
        // Before the flash is written, which takes up to five seconds.
        let mut link = course.link(&link_before);
        course.mark(11);
        let store = course.step(step::STORE, course.store(board.user_button)).await?;
        let buttons = course.step(step::BUTTONS, course.buttons(&board)).await?;
        course.mark(13);
        let clocks = course.step(step::CLOCKS, course.clocks(since)).await?;
        // The samples stand still in it, so it would spoil the clocks.
        let stall = course.by_stall(&trigger).await?;
        course.mark(14);
        // From here on the link is lost and found again, and nothing before it depends on that.
        link.extend(course.reopenings().await?);
        let link = StepResult::judged(
            step::LINK,
            link,
            "The device answers in time, and each time that its port is closed and opened again; the USB bus itself was not reset.",
        );
        let bootloader =
            course.restarting(step::BOOTLOADER, course.rom_bootloader(board.user_button)).await?;
        course.mark(15);
        let faults = if course.request.is_amplifier_unplugged {
            course.restarting(step::FAULTS, course.faults_on_purpose()).await?
        } else {
            StepResult::skipped(step::FAULTS, PLUGGED)
        };
        let steps = vec![
            clocks,
            supply,
            mute,
            mute_time,
            dac_to_adc,
            delay,
            noise,
            load,
            codes,
            trigger,
            link,
            store,
            stall,
            buttons,
            bootloader,
            faults,
            StepResult::skipped(step::AMPLIFIER, NO_AMPLIFIER),
            StepResult::skipped(
                step::OTHERS,
                "This version does not look at what the ROM answers, at resets of the USB bus, or at the lamp.",
            ),
        ];
        Ok((steps, codes_crc))
    }

    /// The steps by the wire from the DAC's pin to the sensor's. Lag and noise say nothing while the codes do not arrive.
    async fn by_sensor_wire(&self) -> Result<[StepResult; 3], MeasureError> {
        let names = [step::DAC_TO_ADC, step::DELAY, step::NOISE];
        if self.inputs.inputs == 0 && self.request.has_sensor_wire {
            return Ok(names.map(|name| StepResult::skipped(name, "The device has no inputs.")));
        }
        if !self.request.has_sensor_wire {
            return Ok(names.map(|name| StepResult::skipped(name, NO_SENSOR_WIRE)));
        }
        let dac_to_adc = self.driven(step::DAC_TO_ADC, self.dac_to_adc()).await?;
        if dac_to_adc.verdict > Verdict::Amber {
            let why = "Not shown: the DAC's codes do not arrive at the sensor's input.";
            let [_, delay, noise] = names;
            return Ok([dac_to_adc, StepResult::skipped(delay, why), StepResult::skipped(noise, why)]);
        }
        let delay = self.driven(step::DELAY, self.delay()).await?;
        let noise = self.driven(step::NOISE, self.noise()).await?;
        Ok([dac_to_adc, delay, noise])
    }

    async fn by_trigger_wire(&self, board: &BoardReport) -> Result<StepResult, MeasureError> {
        let name = step::TRIGGER;
        if !self.request.has_trigger_wire {
            return Ok(StepResult::skipped(name, NO_TRIGGER_WIRE));
        }
        if !board.trigger_input {
            return Ok(StepResult::skipped(name, "The device has no trigger input."));
        }
        self.driven(name, self.trigger()).await
    }

    /// A stall of the DMA, where the trigger is known to work without one.
    async fn by_stall(&self, trigger: &StepResult) -> Result<StepResult, MeasureError> {
        let name = step::STALL;
        match trigger.verdict {
            Verdict::Green | Verdict::Amber => self.driven(name, self.stall()).await,
            Verdict::Skipped => Ok(StepResult::skipped(name, trigger.sentence.clone())),
            Verdict::Red => {
                Ok(StepResult::skipped(name, "Not shown: the trigger does not work without a stall."))
            }
        }
    }

    /// The board; nothing of it with a firmware that does not report it.
    pub(super) async fn board_or_none(&self) -> Result<BoardReport, MeasureError> {
        match self.board().await {
            Err(MeasureError::TooOld) => Ok(BoardReport::default()),
            read => read,
        }
    }

    pub(super) async fn mute_level_or_none(&self) -> Result<PinLevel, MeasureError> {
        match self.mute_level().await {
            Err(MeasureError::TooOld) => Ok(PinLevel::NoPin),
            read => read,
        }
    }
}

/// The report of the connected device, without its steps; `None` without one.
fn report(snapshot: &Snapshot, request: SelftestRequest) -> Option<SelftestReport> {
    let identity = snapshot.device.identity.as_ref()?;
    let (major, minor, patch) = identity.firmware;
    Some(SelftestReport {
        board: identity.board.to_string(),
        unit: snapshot.unit()?,
        firmware: format!("{major}.{minor}.{patch}"),
        build: identity.build.to_string(),
        simulated: identity.simulated,
        wires: request.wires().map(|wire| wire.name().to_owned()).collect(),
        short: request.is_short,
        codes_crc: None,
        image_sha256: None,
        steps: Vec::new(),
    })
}
