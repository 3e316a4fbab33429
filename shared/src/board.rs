//! What a device has found on its board, how it tries its own mute pin, and the level of its brown-out reset: the bodies of
//! [`Event::Board`](crate::Event::Board), [`Event::Analogue`](crate::Event::Analogue), [`Event::MutePin`](crate::Event::MutePin),
//! [`Event::Clock`](crate::Event::Clock), [`Event::BrownOut`](crate::Event::BrownOut) and
//! [`Event::FaultTrial`](crate::Event::FaultTrial).

use crate::schema::{body, choices};
use crate::units::SampleIndex;

choices! {
    /// The resistor that holds the mute pin low while the chip does not drive it.
    #[derive(Default)]
    pub enum MuteResistor {
        /// There is no such pin, or the device does not look.
        #[default]
        0 since 0 NotLooked,
        /// It was present at the start.
        1 since 0 Present,
        /// It was absent at the start: the amplifier stays muted until a reset finds it.
        2 since 0 Missing,
    }
}

choices! {
    /// The board's user button. Pressed while the device is armed it is an emergency stop.
    #[derive(Default)]
    pub enum UserButton {
        /// There is none.
        #[default]
        0 since 0 None,
        /// It is not pressed.
        1 since 0 Released,
        /// It is pressed.
        2 since 0 Pressed,
    }
}

choices! {
    /// The stop input: a contact to ground that is closed while the amplifier may be on. Opened, or with a cut wire, it mutes in hardware.
    #[derive(Default)]
    pub enum StopInput {
        /// There is none, or no profile says whether one is fitted.
        #[default]
        0 since 0 Unused,
        /// It is closed.
        1 since 0 Closed,
        /// It is open: the amplifier is off, and the device cannot be armed.
        2 since 0 Open,
        /// Something is wired to its pin, although the profile says that none is fitted.
        3 since 0 NotInProfile,
    }
}

choices! {
    /// What times the device's samples.
    #[derive(Default)]
    pub enum SampleClock {
        /// The board's crystal, or what feeds the chip in its place.
        #[default]
        0 since 0 Exact,
        /// That was absent at the start. The chip's internal oscillator, some per cent off, lets the device answer; it cannot be armed
        /// until a reset finds the clock.
        1 since 0 Internal,
    }
}

body! {
    /// The body of [`Event::Board`](crate::Event::Board).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct BoardReport {
        /// The clock in which `max_cycles` of the status counts; 0 where the device has no cycle counter.
        pub core_hz: u32 ["Hz"],
        /// Whether the mute pin has its resistor.
        pub mute_resistor: MuteResistor [""],
        /// The user button at this moment.
        pub user_button: UserButton [""],
        /// The stop input at this moment.
        pub stop_input: StopInput [""],
        /// There is a trigger input: drives may wait for it.
        pub trigger_input: bool [""],
        /// What times its samples.
        pub sample_clock: SampleClock [""],
    }
}

body! {
    /// The body of [`Event::Analogue`](crate::Event::Analogue): what the start has found of the supply, and how far the DAC's output is
    /// linear. Apart from the errors of the RAM it does not change until the next reset.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Analogue {
        /// The reference voltage VREF+ of DAC and ADC, by the chip's internal reference and its factory calibration; 0 where the
        /// device has not measured it.
        pub reference_mv: u16 ["mV"],
        /// The share of the DAC's half swing within which its output is linear: beyond it the output buffer saturates at the supply's
        /// ends. The codes reach farther than that.
        pub linear_per_mille: u16 ["1/1000 of the half swing", 1, 1000],
        /// The level of the brown-out reset, as the chip's reference manual counts it from the lowest threshold; `None` where the chip
        /// has none.
        pub brown_out_level: Option<u8> [""],
        /// The chip's device id (DBGMCU_IDCODE, DEV_ID); 0 where there is none.
        pub chip: u16 [""],
        /// Its silicon revision (REV_ID).
        pub revision: u16 [""],
        /// What the error correction of its RAM has found since the start, as bits: 1, a single error, corrected; 2, a double error; 4, a
        /// double error at a store of less than a word. RAM that was never written may have any. `None` where the chip has none.
        pub ram_errors: Option<u8> [""],
    }
}

choices! {
    /// How the device is to take its mute pin low, in order to measure how long it takes.
    #[derive(Default)]
    pub enum MuteTrial {
        /// Not at all: it only reads the pin.
        #[default]
        0 since 0 Read,
        /// No block restarts the mute timer any more, as if the program hung. The timer takes the pin low by itself.
        1 since 0 Lapse,
        /// The program triggers the timer's break.
        2 since 0 Break,
    }
}

choices! {
    /// The level of a pin, as its input register reads it.
    #[derive(Default)]
    pub enum PinLevel {
        /// There is no such pin.
        #[default]
        0 since 0 NoPin,
        /// Low: the amplifier is muted.
        1 since 0 Low,
        /// High: the amplifier is on.
        2 since 0 High,
    }
}

body! {
    /// The body of [`Command::MutePin`](crate::Command::MutePin).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct MuteStep {
        /// How the pin is to go low.
        pub trial: MuteTrial [""],
    }
}

body! {
    /// When the pin went low in a trial, by the processor's cycle counter.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct MuteFall {
        /// The time until the pin was first read low: from the last block that restarted the timer, or from the break.
        pub low_after_us: u32 ["us"],
        /// The pin was still high this long before that: an interrupt may have delayed the reading. Repeat the trial if it is too long.
        pub within_us: u32 ["us"],
    }
}

body! {
    /// The body of [`Event::MutePin`](crate::Event::MutePin).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct MutePin {
        /// The pin at this moment; in a trial, before it.
        pub level: PinLevel [""],
        /// The device is on the bench (`Bench`): its mute pin stays low.
        pub is_on_bench: bool [""],
        /// When the pin went low; `None` if nothing was tried, or the pin stayed high for 20 ms.
        pub fall: Option<MuteFall> [""],
    }
}

body! {
    /// The body of [`Command::BrownOut`](crate::Command::BrownOut).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct BrownOutOrder {
        /// Whether the level that the board needs is to be written, if the present one is lower; else it is only read.
        pub is_written: bool [""],
    }
}

body! {
    /// The body of [`Event::BrownOut`](crate::Event::BrownOut). Levels are counted as the chip's reference manual counts them, from the
    /// lowest threshold.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct BrownOut {
        /// The level in the chip's register. One that has just been written is in force after the restart only.
        pub level: u8 [""],
        /// The lowest level that guards this board.
        pub needed: u8 [""],
        /// The chip's register of option bytes that holds the level. After a write the host reads it again once the device has
        /// restarted: it must be the same.
        pub options: u32 [""],
        /// The chip's level of read protection, as that register codes it: 170 (0xAA) is none, 204 (0xCC) is level 2, everything else
        /// level 1.
        pub read_protection: u8 [""],
        /// The level has been written, and the device restarts.
        pub restarts: bool [""],
    }
}

choices! {
    /// A fault that a device makes on purpose.
    #[derive(Default)]
    pub enum OrderedFault {
        /// The thread hangs, while interrupts go on: the watchdog resets the chip.
        #[default]
        0 since 0 Hang,
        /// Interrupts stay masked: the mute timer mutes, then the watchdog resets the chip.
        1 since 0 MaskedInterrupts,
        /// The stack overflows: the processor's fault mutes and resets.
        2 since 0 StackOverflow,
    }
}

body! {
    /// The body of [`Command::FaultOrder`](crate::Command::FaultOrder).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct FaultOrder {
        /// The fault.
        pub fault: OrderedFault [""],
        /// The token of [`FaultTrial`].
        pub token: u32 [""],
    }
}

body! {
    /// How an ordered fault ended, by the processor's cycle counter.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct FaultEnd {
        /// The fault.
        pub fault: OrderedFault [""],
        /// The time from its begin until the mute pin was first read low; where the reset came first, until it was last read high.
        pub muted_after_us: u32 ["us"],
        /// The pin was high until the reset, which mutes by the pin's resistor.
        pub by_reset: bool [""],
    }
}

body! {
    /// The body of [`Event::FaultTrial`](crate::Event::FaultTrial).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct FaultTrial {
        /// Valid once, for 5 s and in this session.
        pub token: u32 [""],
        /// The ordered fault that ended the last run; `None` if the last run ended otherwise.
        pub last: Option<FaultEnd> [""],
    }
}

body! {
    /// A frame of the USB, which the host begins every millisecond.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct UsbFrame {
        /// Its number; counts to 2047 and begins at 0 again.
        pub number: u16 ["", 0, 2047],
        /// The cycle counter when it began.
        pub cycles: u32 ["cycles"],
    }
}

body! {
    /// The body of [`Event::Clock`](crate::Event::Clock): the same moments by the clocks that the device knows. Two of them, some seconds
    /// apart, compare the clocks.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct ClockReport {
        /// The index of the first block that is not rendered yet.
        pub at: SampleIndex ["samples"],
        /// The processor's cycle counter at the end of the renderer's turn that moved this index on; wraps. 0 where there is no
        /// counter.
        pub cycles: u32 ["cycles"],
        /// The frame of the USB that began next; `None` without USB, or while the USB sleeps.
        pub usb: Option<UsbFrame> [""],
    }
}
