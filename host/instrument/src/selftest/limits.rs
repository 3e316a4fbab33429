//! The limits of a self-test's numbers, each with what to look at where it is exceeded. Numbers without a limit are reported only.

use super::verdict::Verdict;

/// The steps, in the order of the report.
pub mod step {
    /// Samples against the host's clock.
    pub const CLOCKS: &str = "clocks";
    /// Reference voltage and brown-out level.
    pub const SUPPLY: &str = "supply";
    /// The mute pin.
    pub const MUTE: &str = "mute";
    /// The time in which the mute pin goes low.
    pub const MUTE_TIME: &str = "mute time";
    /// Codes of the DAC against those of the sensor's input, by a wire.
    pub const DAC_TO_ADC: &str = "DAC to ADC";
    /// Lag of the sensor's input behind the DAC, by a wire.
    pub const DELAY: &str = "delay";
    /// Noise and distortion, by a wire.
    pub const NOISE: &str = "noise";
    /// Time of the blocks while the link is busy.
    pub const LOAD: &str = "load";
    /// Digests of codes against the mirror's.
    pub const CODES: &str = "codes";
    /// Trigger output to trigger input, by a wire.
    pub const TRIGGER: &str = "trigger";
    /// Time to the device's answers.
    pub const LINK: &str = "link";
    /// The flash of the profile.
    pub const STORE: &str = "store";
    /// The DMA stopped for a moment.
    pub const STALL: &str = "stall";
    /// User button and stop input, by a person.
    pub const BUTTONS: &str = "buttons";
    /// The ROM bootloader.
    pub const BOOTLOADER: &str = "bootloader";
    /// Faults on purpose.
    pub const FAULTS: &str = "faults";
    /// The amplifier, muted and on.
    pub const AMPLIFIER: &str = "amplifier";
    /// What no version looks at yet.
    pub const OTHERS: &str = "others";
    /// All of them.
    pub const ALL: [&str; 18] = [
        CLOCKS, SUPPLY, MUTE, MUTE_TIME, DAC_TO_ADC, DELAY, NOISE, LOAD, CODES, TRIGGER, LINK, STORE, STALL,
        BUTTONS, BOOTLOADER, FAULTS, AMPLIFIER, OTHERS,
    ];
}

/// The limit of one number of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The step.
    pub step: &'static str,
    /// The quantity.
    pub quantity: &'static str,
    /// The lowest allowed number.
    pub at_least: Option<f64>,
    /// The highest allowed number.
    pub at_most: Option<f64>,
    /// The verdict beyond it.
    pub beyond: Verdict,
    /// What to look at then.
    pub remedy: &'static str,
}

impl Limit {
    /// Whether a number is within the limit.
    #[must_use]
    pub fn allows(&self, value: f64) -> bool {
        value >= self.at_least.unwrap_or(f64::NEG_INFINITY) && value <= self.at_most.unwrap_or(f64::INFINITY)
    }
}

const fn red(
    step: &'static str,
    quantity: &'static str,
    (at_least, at_most): (Option<f64>, Option<f64>),
    remedy: &'static str,
) -> Limit {
    Limit { step, quantity, at_least, at_most, beyond: Verdict::Red, remedy }
}

const fn amber(
    step: &'static str,
    quantity: &'static str,
    limits: (Option<f64>, Option<f64>),
    remedy: &'static str,
) -> Limit {
    Limit { beyond: Verdict::Amber, ..red(step, quantity, limits, remedy) }
}

const fn between(low: f64, high: f64) -> (Option<f64>, Option<f64>) {
    (Some(low), Some(high))
}

const NONE: (Option<f64>, Option<f64>) = between(0.0, 0.0);

const OTHER_CLOCK: &str = "The board's clock is not the one that the image expects.";
const WIRE: &str =
    "Look at the wire from the DAC's pin to the sensor's, at ground, and at what else hangs on both.";
const LAG: &str = "The input samples at another time than the device states: look at the filter on the wire.";
const UNSAFE: &str = "The timer that mutes does not do what it must: do not connect an amplifier.";
const NOTHING: &str = "Nothing was tested: run the self-test again.";
const QUIETER: &str = "Look at the reference's capacitor, at ground, and at the supply.";

/// From here on a tone stands out, dB: over the noise, and over what passes while the amplifier is muted.
pub(super) const SHOWN_DB: f64 = 20.0;

/// All limits.
pub const LIMITS: &[Limit] = &[
    red(step::CLOCKS, "rate error", between(-300.0, 300.0), OTHER_CLOCK),
    red(step::CLOCKS, "rate error in a short time", between(-3000.0, 3000.0), OTHER_CLOCK),
    red(step::CLOCKS, "cycle error", between(-30.0, 30.0), OTHER_CLOCK),
    red(step::CLOCKS, "error by USB frames", between(-500.0, 500.0), OTHER_CLOCK),
    amber(
        step::CLOCKS,
        "error by USB frames",
        between(-100.0, 100.0),
        "The board's clock is less exact than a crystal: frequencies are off by the same share.",
    ),
    red(
        step::SUPPLY,
        "VREF+",
        between(2.9, 3.4),
        "Look at the board's supply and at the jumper of its reference.",
    ),
    amber(
        step::SUPPLY,
        "brown-out level unset",
        NONE,
        "Set it before an amplifier is connected: see BOARDS.md.",
    ),
    red(step::MUTE, "resistor missing", NONE, "Fit the resistor from the mute pin to ground."),
    red(
        step::MUTE,
        "pin high while muted",
        NONE,
        "Something holds the mute pin high: no amplifier may be connected.",
    ),
    red(step::MUTE_TIME, "timer leaves it high", NONE, UNSAFE),
    red(step::MUTE_TIME, "time to low", between(3.8, 4.2), UNSAFE),
    red(step::MUTE_TIME, "break leaves it high", NONE, UNSAFE),
    red(step::MUTE_TIME, "time to low by a break", between(0.0, 0.2), UNSAFE),
    red(step::DAC_TO_ADC, "slope", between(0.985, 1.015), WIRE),
    red(step::DAC_TO_ADC, "offset", between(-30.0, 30.0), WIRE),
    red(step::DAC_TO_ADC, "nonlinearity", between(0.0, 8.0), WIRE),
    red(step::DELAY, "lag at 5 kHz", between(-0.1, 1.5), LAG),
    red(step::DELAY, "lag at 20 kHz", between(-0.1, 1.5), LAG),
    red(step::DELAY, "lag at 40 kHz", between(-0.1, 1.5), LAG),
    red(step::DELAY, "lag at 80 kHz", between(-0.1, 1.5), LAG),
    red(step::NOISE, "noise at mid-scale", between(0.0, 1.5), QUIETER),
    red(step::NOISE, "SINAD at 1 kHz", (Some(60.0), None), QUIETER),
    red(step::NOISE, "SINAD at 10 kHz", (Some(60.0), None), QUIETER),
    red(
        step::NOISE,
        "change by a busy link at 1 kHz",
        between(-1.0, 1.0),
        "The link couples into the converters: look at ground.",
    ),
    red(
        step::NOISE,
        "change by a busy link at 10 kHz",
        between(-1.0, 1.0),
        "The link couples into the converters: look at ground.",
    ),
    red(
        step::LOAD,
        "worst block",
        between(0.0, 90.0),
        "The processor has too little time: is its clock the image's?",
    ),
    red(step::LOAD, "lost blocks", NONE, "The inputs were not read in time."),
    red(step::LOAD, "underruns", NONE, "Blocks came too late for the DAC."),
    red(
        step::CODES,
        "windows that differ",
        NONE,
        "The image computes other codes than this program: flash it again.",
    ),
    red(step::CODES, "windows", (Some(1.0), None), NOTHING),
    red(step::CODES, "compared time", (Some(0.01), None), NOTHING),
    red(step::LOAD, "drives in that time", (Some(1.0), None), NOTHING),
    red(
        step::TRIGGER,
        "trigger delay",
        between(129.0, 260.0),
        "Look at the wire from the trigger output to the trigger input.",
    ),
    red(
        step::LINK,
        "longest answer",
        between(0.0, 1.0),
        "Look at the cable and at other programs on the port.",
    ),
    amber(step::LINK, "damaged frames", NONE, "Frames arrived damaged and were repeated: look at the cable."),
    red(
        step::LINK,
        "reopenings without answer",
        NONE,
        "The device does not answer each time its port is opened: look at the cable and the computer's driver.",
    ),
    red(step::STORE, "profiles that differ", NONE, "The flash does not keep what was written."),
    red(
        step::STORE,
        "longest write",
        between(0.0, 5.0),
        "The flash takes longer than its data sheet promises.",
    ),
    red(step::STALL, "stall unnoticed", NONE, "The device has not noticed that its DAC stood still."),
    red(
        step::STALL,
        "trigger delay after a stall",
        between(129.0, 260.0),
        "After a stall of the DMA the trigger output does not rise with the codes (BOARDS.md): use no trigger on this board.",
    ),
    red(
        step::BUTTONS,
        "pressed unasked",
        NONE,
        "The user button reads pressed while nobody presses it: is it stuck?",
    ),
    red(step::BUTTONS, "not pressed in time", NONE, "The user button was not seen: look at its pin."),
    red(step::BUTTONS, "not released in time", NONE, "The user button stays pressed: is it stuck?"),
    red(
        step::BUTTONS,
        "stop input not opened in time",
        NONE,
        "The stop input was not seen to open: look at its wires.",
    ),
    red(
        step::BUTTONS,
        "stop input not closed in time",
        NONE,
        "The stop input was not seen to close: look at its wires.",
    ),
    red(
        step::BOOTLOADER,
        "stays in the program",
        NONE,
        "The chip has started the program again in place of its bootloader: flash the board by a probe, or by its pin BOOT0.",
    ),
    red(
        step::BOOTLOADER,
        "not back in time",
        NONE,
        "The device did not answer after its reset: press reset again.",
    ),
    red(
        step::BOOTLOADER,
        "differences after it",
        NONE,
        "Another firmware, table or profile has answered after the bootloader: flash the board again, and store both again.",
    ),
    red(step::FAULTS, "faults that end otherwise", NONE, UNSAFE),
    red(step::FAULTS, "faults without return", NONE, UNSAFE),
    red(
        step::FAULTS,
        "safe mode after them",
        NONE,
        "Ordered faults must not count: look at the firmware's version.",
    ),
    red(step::FAULTS, "time to mute in a hang", between(0.0, 570.0), UNSAFE),
    red(step::FAULTS, "time to mute with interrupts masked", between(0.0, 4.5), UNSAFE),
    red(step::FAULTS, "time to mute by a stack overflow", between(0.0, 0.1), UNSAFE),
    red(
        step::AMPLIFIER,
        "tone over noise",
        (Some(SHOWN_DB), None),
        "Neither muted nor unmuted does a tone arrive at an input: is the amplifier on, and a sensor or a shunt connected?",
    ),
    red(
        step::AMPLIFIER,
        "rise by unmuting",
        (Some(SHOWN_DB), None),
        "The amplifier is on while the device mutes it: switch it off, and look at the polarity of its enable.",
    ),
];

/// The limits of a number, the widest first; none of one that is only reported.
pub fn of(step: &str, quantity: &str) -> impl Iterator<Item = &'static Limit> {
    LIMITS.iter().filter(move |limit| limit.step == step && limit.quantity == quantity)
}

/// Numbers with limits that a step may have been carried out without: what a board does not report, or a short test or an answer
/// before leaves out.
const PERHAPS: [(&str, &str); 13] = [
    (step::CLOCKS, "rate error"),
    (step::CLOCKS, "rate error in a short time"),
    (step::CLOCKS, "cycle error"),
    (step::CLOCKS, "error by USB frames"),
    (step::SUPPLY, "brown-out level unset"),
    (step::MUTE, "resistor missing"),
    (step::MUTE, "pin high while muted"),
    (step::LOAD, "worst block"),
    (step::LINK, "reopenings without answer"),
    (step::BUTTONS, "not pressed in time"),
    (step::BUTTONS, "not released in time"),
    (step::BUTTONS, "stop input not opened in time"),
    (step::BUTTONS, "stop input not closed in time"),
];

/// The quantities with limits that a step always has where it is green or amber.
pub fn required(step: &str) -> impl Iterator<Item = &'static str> {
    let always = |limit: &&Limit| !PERHAPS.contains(&(limit.step, limit.quantity));
    LIMITS.iter().filter(move |limit| limit.step == step).filter(always).map(|limit| limit.quantity)
}

/// Whether a step has this name.
#[must_use]
pub fn is_step(name: &str) -> bool {
    step::ALL.contains(&name)
}
