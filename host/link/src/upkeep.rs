//! Texts about a device's [`Maintenance`] and inputs, for the person who maintains it.

use slipline_protocol::board::{Analogue, BoardReport, MuteResistor, SampleClock, StopInput, UserButton};
use slipline_protocol::event::{Maintenance, StoredConfig, Wear};
use slipline_protocol::listen::InputsReport;

/// Number of flash erasures so far, and the number that its data sheet guarantees.
///
/// ```
/// use slipline_link::protocol::event::Maintenance;
/// use slipline_link::upkeep;
///
/// let maintenance = Maintenance { erasures: 3, erasures_promised: 20_000, brown_out_guarded: false };
/// assert_eq!(upkeep::wear(&maintenance), "3 of 20000 times");
/// assert_eq!(upkeep::brown_out_level(&maintenance), "not set");
/// assert!(upkeep::before_arming(&maintenance).is_some());
/// ```
#[must_use]
pub fn wear(maintenance: &Maintenance) -> String {
    erased(maintenance.erasures, maintenance.erasures_promised)
}

fn erased(times: u32, promised: u32) -> String {
    match promised {
        0 => "nothing stored".to_owned(),
        promised => format!("{times} of {promised} times"),
    }
}

/// Number of erasures of the profile's flash so far, the number that its data sheet guarantees, and how many tables may be stored
/// now.
///
/// ```
/// use slipline_link::protocol::event::Wear;
/// use slipline_link::upkeep::profile_wear;
///
/// let wear = Wear { profile_erasures: 1, profile_erasures_promised: 20_000, stores_left: 15 };
/// assert_eq!(profile_wear(&wear), "1 of 20000 times; 15 tables may be stored now");
/// ```
#[must_use]
pub fn profile_wear(wear: &Wear) -> String {
    let erased = erased(wear.profile_erasures, wear.profile_erasures_promised);
    let tables = if wear.stores_left == 1 { "table" } else { "tables" };
    format!("{erased}; {} {tables} may be stored now", wear.stores_left)
}

/// The device's inputs, and the number of blocks lost.
///
/// ```
/// use slipline_link::protocol::listen::InputsReport;
/// use slipline_link::upkeep::inputs;
///
/// let report = InputsReport { inputs: 2, lock_ins: 16, delay_ns: -250, lost_blocks: 3, now: 0 };
/// assert_eq!(inputs(&report), "sensor and shunt, 16 tones at once, -0.25 us after the DAC, 3 blocks lost");
/// ```
#[must_use]
pub fn inputs(report: &InputsReport) -> String {
    let which = match report.inputs {
        0 => return "none".to_owned(),
        1 => "sensor",
        _ => "sensor and shunt",
    };
    let lost = match report.lost_blocks {
        0 => String::new(),
        1 => ", 1 block lost".to_owned(),
        blocks => format!(", {blocks} blocks lost"),
    };
    let delay_us = report.delay_ns as f64 * 1e-3;
    format!("{which}, {} tones at once, {delay_us} us after the DAC{lost}", report.lock_ins)
}

/// `set` or `not set`: the brown-out level.
#[must_use]
pub const fn brown_out_level(maintenance: &Maintenance) -> &'static str {
    if maintenance.brown_out_guarded { "set" } else { "not set" }
}

/// Warning to show before the device is armed, if any.
#[must_use]
pub const fn before_arming(maintenance: &Maintenance) -> Option<&'static str> {
    if maintenance.brown_out_guarded {
        return None;
    }
    Some(
        "The brown-out level of this board is not set: when its supply fails, its processor may go wrong before it \
         is stopped, with a finger on the plate. Set the level once per board, as firmware/BOARDS.md says.",
    )
}

/// What the user of a board must know before the board writes its option bytes.
pub const OPTION_BYTES_RISK: &str = "The board writes its chip's option bytes, once. If its power fails meanwhile, for up to a \
    second, the chip of an STM32F4DISCOVERY, and probably that of a NUCLEO-G474RE, is read-protected afterwards: the way back erases \
    its whole flash, with the image, the table and the profile (firmware/BOARDS.md). Power it so that nobody pulls its cables.";

/// The warning that the amplifier stays muted, if it does: the device has found no resistor at its mute pin, or no clock.
///
/// ```
/// use slipline_link::protocol::board::{BoardReport, MuteResistor, SampleClock};
/// use slipline_link::upkeep::muted_for_good;
///
/// let clockless = BoardReport { sample_clock: SampleClock::Internal, ..BoardReport::default() };
/// assert!(muted_for_good(&clockless).is_some_and(|warning| warning.starts_with("Muted, and never armed: no clock.")));
/// let bare = BoardReport { mute_resistor: MuteResistor::Missing, ..BoardReport::default() };
/// assert!(muted_for_good(&bare).is_some_and(|warning| warning.starts_with("Muted: no resistor at the mute pin.")));
/// assert_eq!(muted_for_good(&BoardReport::default()), None);
/// ```
#[must_use]
pub const fn muted_for_good(board: &BoardReport) -> Option<&'static str> {
    if matches!(board.sample_clock, SampleClock::Internal) {
        return Some(
            "Muted, and never armed: no clock. The ST-LINK's clock, which times the samples, was absent at the start: connect the \
             ST-LINK's socket, too, and restart the device (firmware/BOARDS.md).",
        );
    }
    match board.mute_resistor {
        MuteResistor::NotLooked | MuteResistor::Present => None,
        MuteResistor::Missing => Some(
            "Muted: no resistor at the mute pin. Everything else works; the amplifier stays off until the device is \
             restarted with the resistor in its place (firmware/BOARDS.md).",
        ),
    }
}

/// The reference voltage VREF+, in words; `None` where the device has not measured it.
///
/// ```
/// use slipline_link::protocol::board::Analogue;
/// use slipline_link::upkeep::{linear_output, reference};
///
/// let analogue = Analogue { reference_mv: 3297, linear_per_mille: 880, ..Analogue::default() };
/// assert_eq!(reference(&analogue).as_deref(), Some("3.30 V"));
/// assert_eq!(linear_output(&analogue), "up to 88 % of full scale");
/// ```
#[must_use]
pub fn reference(analogue: &Analogue) -> Option<String> {
    (analogue.reference_mv > 0).then(|| format!("{:.2} V", f64::from(analogue.reference_mv) / 1e3))
}

/// The share of full scale within which the DAC's output is linear, in words.
#[must_use]
pub fn linear_output(analogue: &Analogue) -> String {
    format!("up to {} % of full scale", f64::from(analogue.linear_per_mille) / 10.0)
}

/// The caution that a drive's sum of tones is beyond the linear share of the DAC's output, both as shares of full scale.
///
/// ```
/// use slipline_link::upkeep::beyond_linear;
///
/// let caution = beyond_linear(0.95, 0.88);
/// assert!(caution.starts_with("The tones add up to 95 % of full scale, and the DAC's output is linear up to 88 %"));
/// ```
#[must_use]
pub fn beyond_linear(sum: f64, share: f64) -> String {
    format!(
        "The tones add up to {:.0} % of full scale, and the DAC's output is linear up to {:.0} %: their peaks may be flattened, \
         which adds tones that no one asked for. Lower the master level by {:.1} dB.",
        100.0 * sum,
        100.0 * share,
        20.0 * (sum / share).log10()
    )
}

/// The reference voltage within which DAC and ADC work as the boards' page says, in mV.
pub const REFERENCE_MV: (u16, u16) = (2900, 3400);

/// The warning that the reference voltage of DAC and ADC is wrong, if the device has measured it and it is.
///
/// ```
/// use slipline_link::protocol::board::Analogue;
/// use slipline_link::upkeep::wrong_reference;
///
/// let at = |reference_mv| wrong_reference(&Analogue { reference_mv, ..Analogue::default() });
/// assert_eq!((at(0), at(2900), at(3400)), (None, None, None));
/// assert!(at(2700).unwrap().starts_with("The reference voltage VREF+ is 2.70 V"));
/// ```
#[must_use]
pub fn wrong_reference(analogue: &Analogue) -> Option<String> {
    let (lowest, highest) = REFERENCE_MV;
    let is_wrong = analogue.reference_mv > 0 && !(lowest..=highest).contains(&analogue.reference_mv);
    is_wrong.then(|| {
        let [is, from, to] = [analogue.reference_mv, lowest, highest].map(|mv| f64::from(mv) / 1000.0);
        format!(
            "The reference voltage VREF+ is {is:.2} V, not between {from} and {to} V. Every level and every measured code \
             is wrong by the same factor: check the board's supply (firmware/BOARDS.md)."
        )
    })
}

/// What is damaged in the device's flash, and the cure; `profile` is the result of reading the actuator's profile, if the device
/// keeps one. What was never written and is not blank looks like damage, too.
///
/// ```
/// use slipline_link::protocol::event::StoredConfig;
/// use slipline_link::upkeep::damaged_store;
///
/// assert!(damaged_store(Some(StoredConfig::Damaged)).contains("hold the board's user button"));
/// assert!(damaged_store(Some(StoredConfig::Loaded)).contains("keep a table again"));
/// ```
#[must_use]
pub const fn damaged_store(profile: Option<StoredConfig>) -> &'static str {
    if matches!(profile, Some(StoredConfig::Damaged)) {
        "the actuator's profile is damaged, or its place was never written but was filled when the board was flashed; to arm, hold \
         the board's user button and write the profile, or erase it if the board never had one"
    } else {
        "the kept table is damaged; clear the fault and keep a table again"
    }
}

/// The user button, in words; `None` where there is none.
#[must_use]
pub const fn user_button(board: &BoardReport) -> Option<&'static str> {
    match board.user_button {
        UserButton::None => None,
        UserButton::Released => Some("released"),
        UserButton::Pressed => Some("pressed: the device cannot be armed"),
    }
}

/// The stop input, in words; `None` where no profile says that one is fitted.
#[must_use]
pub const fn stop_input(board: &BoardReport) -> Option<&'static str> {
    match board.stop_input {
        StopInput::Unused => None,
        StopInput::Closed => Some("closed"),
        StopInput::Open => Some("open: the device cannot be armed"),
        StopInput::NotInProfile => Some("wired, but not fitted by the actuator's profile: it does nothing"),
    }
}

/// The warning to show before a board without a profile of its actuator is armed.
pub const NO_PROFILE: &str = "This board keeps no profile of its actuator: only the driving program limits travel, heat and time, \
    if it does so at all. `slipline profile write` keeps one on the board, as firmware/BOARDS.md says.";

/// The share of a block's time above which [`hardly_in_time`] warns: interrupts that may come together take most of the rest.
pub(crate) const BUSY: f64 = 0.9;

/// The warning that the device's longest block took nearly all of a block's time, if it did; `share` is
/// [`Snapshot::worst_block`](crate::Snapshot::worst_block).
///
/// ```
/// use slipline_link::upkeep::hardly_in_time;
///
/// assert_eq!(hardly_in_time(0.9), None);
/// let warning = hardly_in_time(0.934).unwrap();
/// assert!(warning.starts_with("The longest block took 93 % of a block's time."));
/// ```
#[must_use]
pub fn hardly_in_time(share: f64) -> Option<String> {
    (share > BUSY).then(|| {
        format!(
            "The longest block took {:.0} % of a block's time. One that takes all of it ends the drive with the fault \
             Underrun: measure fewer tones at once, or capture less.",
            share * 100.0
        )
    })
}

/// The warning that the flash is worn, if it is: it may lose its content.
#[must_use]
pub fn worn(maintenance: &Maintenance) -> Option<String> {
    let Maintenance { erasures, erasures_promised, .. } = *maintenance;
    (erasures_promised > 0 && erasures > erasures_promised).then(|| {
        format!(
            "The device's flash has been erased {erasures} times; its data sheet promises {erasures_promised}. \
             It may lose the table that it keeps."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flash_counts_as_worn_above_what_its_data_sheet_promises_and_not_before() {
        let maintenance =
            |erasures| Maintenance { erasures, erasures_promised: 20_000, brown_out_guarded: true };
        assert_eq!((worn(&maintenance(0)), worn(&maintenance(20_000))), (None, None));
        let warning = worn(&maintenance(20_001)).unwrap();
        assert!(warning.contains("20001 times") && warning.contains("promises 20000"), "{warning}");
        let keeps_nothing = Maintenance { erasures_promised: 0, ..maintenance(1) };
        assert_eq!((worn(&keeps_nothing), wear(&keeps_nothing)), (None, "nothing stored".to_owned()));
    }

    #[test]
    fn only_a_board_without_a_brown_out_level_asks_before_it_is_armed() {
        let maintenance = |brown_out_guarded| Maintenance { brown_out_guarded, ..Maintenance::default() };
        assert_eq!(before_arming(&maintenance(true)), None);
        assert!(before_arming(&maintenance(false)).unwrap().contains("brown-out level"));
    }
}
