//! The traits by which the application uses a board.
//!
//! The link is `embedded-io-async`'s `Read` and `Write`; all others are here. An implementation knows no command and
//! takes no decision.

use core::ops::Range;
use slipline_dds::bank::{BLOCK, TONES};

pub use slipline_protocol::board::{
    Analogue, BoardReport, BrownOut, ClockReport, FaultEnd, MuteFall, MuteResistor, MuteTrial, OrderedFault,
    PinLevel, SampleClock, StopInput, UsbFrame, UserButton,
};
pub use slipline_protocol::units::SampleIndex;

/// The renderer's ports of a board.
#[derive(Clone, Copy, Debug)]
pub struct RendererPorts<D, M, T, B, C, S> {
    /// A [`DacStream`].
    pub dac: D,
    /// A [`Mute`].
    pub mute: M,
    /// A [`Trigger`].
    pub trigger: T,
    /// A [`Button`].
    pub button: B,
    /// A [`CycleCounter`].
    pub cycles: C,
    /// A [`SenseStream`].
    pub sense: S,
}

/// The DAC's stream of codes.
pub trait DacStream {
    /// Waits until there is room for a block. The block is rendered after that, so that it follows the latest orders.
    async fn room(&mut self);

    /// Takes a block; waits until there is room if there is none.
    ///
    /// # Errors
    /// [`Underrun`] if the block comes too late to be whole. It is not played: in its place, and for as long as it takes,
    /// the DAC goes to mid-scale by itself ([`fade`](crate::safety::fade)). Blocks that come meanwhile take up their time but are
    /// not played either, so the caller falls silent at once.
    async fn write_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun>;

    /// Whether the block that was taken last will be played, and waits for long enough still that other codes can be
    /// computed for it.
    fn is_revisable(&self) -> bool;

    /// Plays other codes in place of the block that was taken last, which [is revisable](DacStream::is_revisable).
    ///
    /// # Errors
    /// [`Underrun`] if they come too late after all. The block is played as it was, and then the DAC goes to mid-scale by
    /// itself, as after a block that was late.
    fn revise_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun>;
}

/// The ADC's stream of 12-bit codes, sampled by the same trigger as the DAC's.
///
/// The ADC converts once at every trigger at which the DAC takes a code, from the DAC's first one on, and its blocks are
/// the DAC's blocks: code `n` of every input belongs to DAC code `n`, whatever happens to either. A block of the DAC that
/// was late is mid-scale at the pin, and is sampled like any other.
pub trait SenseStream {
    /// Number of inputs: 1 is the sensor, 2 the sensor and the drive current's shunt, in this order; 0 none.
    fn inputs(&self) -> usize;

    /// How long after DAC code `n` is at its pin the inputs are held for ADC code `n`, in nanoseconds: a constant of the
    /// board. Negative where the ADC holds before the DAC's output has changed. Delays of filters outside the chip are not
    /// in it.
    fn delay_ns(&self) -> i32;

    /// Tones that the processor has time to measure at once, of one input, together with everything else that a block costs. Of
    /// all inputs at once it measures this number divided by theirs.
    fn lock_ins(&self) -> usize {
        TONES
    }

    /// Takes the oldest block that has been sampled whole, a row of codes for each of these inputs. Rows of inputs that do not
    /// exist stay as they are; the others mean nothing. `None` if there is none yet.
    ///
    /// # Errors
    /// [`Overrun`] if blocks were lost before it: they were sampled and overwritten, or the ADC missed a trigger. The next
    /// call takes the block after them.
    fn take_block(
        &mut self,
        inputs: Range<usize>,
        codes: &mut [[u16; BLOCK]; INPUTS],
    ) -> Option<Result<(), Overrun>>;

    /// Takes the oldest block without its codes, for which nobody listens: as [`take_block`](SenseStream::take_block), but it may
    /// come before the block is whole.
    ///
    /// # Errors
    /// [`Overrun`] as from `take_block`.
    fn skip_block(&mut self) -> Option<Result<(), Overrun>> {
        self.take_block(0..0, &mut [[0; BLOCK]; INPUTS])
    }
}

/// Inputs at most.
pub const INPUTS: usize = 2;

/// Blocks of codes were lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun {
    /// How many, at least 1. They take up their time.
    pub blocks: u32,
}

/// No inputs.
impl SenseStream for () {
    fn inputs(&self) -> usize {
        0
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn take_block(&mut self, _: Range<usize>, _: &mut [[u16; BLOCK]; INPUTS]) -> Option<Result<(), Overrun>> {
        None
    }
}

/// A block came too late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Underrun;

/// The amplifier's mute pin. The pin's own resistor mutes while the program does not run.
///
/// An amplifier that is on mutes itself some milliseconds after the last [`Mute::stay_on`], whatever the program does.
pub trait Mute {
    /// Mutes or unmutes. Called before every block.
    fn set_muted(&mut self, muted: bool);

    /// Called in place of [`Mute::set_muted`] before every block on the bench ([`Command::Bench`](slipline_protocol::Command::Bench)):
    /// mutes, and watches the stop input from the first call of a row on.
    fn bench(&mut self) {
        self.set_muted(true);
    }

    /// The amplifier, which is on, stays on for another while. Called after every block that was taken in time, on the bench, too,
    /// where it stays off.
    ///
    /// # Errors
    /// [`HasMuted`] if it is off already. It stays off until it is muted and unmuted again. On the bench only if the stop input was
    /// open.
    fn stay_on(&mut self) -> Result<(), HasMuted>;

    /// Whether it was the stop input that has muted it: it was open since it was unmuted, if only for a moment. Asked when
    /// [`Mute::stay_on`] has failed.
    fn was_stopped(&mut self) -> bool {
        false
    }
}

/// The amplifier has muted itself, or something but the renderer has muted it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HasMuted;

/// The trigger: an output that marks the begin of a program for other instruments, and an input by which they begin one.
pub trait Trigger {
    /// The pin rises, by hardware, a constant number of samples before the first code of the block that the DAC has just
    /// taken. Called right after [`DacStream::write_block`], only for a block in which a program begins.
    fn rise(&mut self);

    /// Whether the input has risen since the last call: hardware keeps the rise until it is asked for. Called before each
    /// block while a program waits for it ([`System::has_trigger_input`]), and once when one begins to.
    fn has_risen(&mut self) -> bool;
}

/// No trigger.
impl Trigger for () {
    fn rise(&mut self) {}

    fn has_risen(&mut self) -> bool {
        false
    }
}

/// The board's user button, which stops the drive.
pub trait Button {
    /// Whether it is pressed now. Called before each block.
    fn is_pressed(&mut self) -> bool;
}

/// No button.
impl Button for () {
    fn is_pressed(&mut self) -> bool {
        false
    }
}

/// A free-running processor cycle counter, for the worst block's cost.
pub trait CycleCounter {
    /// Cycles, wrapping.
    fn cycles(&mut self) -> u32;
}

/// No counter: every block costs nothing.
impl CycleCounter for () {
    fn cycles(&mut self) -> u32 {
        0
    }
}

/// The unit flash is written and read in, in bytes: a multiple of every supported chip's word (4, 8 and 32).
pub const FLASH_WORD: usize = 32;

/// One of the two places that a table's record is kept in, or of the two for the actuator's profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashSlot {
    /// The first.
    A,
    /// The second.
    B,
    /// The profile's first.
    ProfileA,
    /// The profile's second.
    ProfileB,
}

impl FlashSlot {
    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
            Self::ProfileA => Self::ProfileB,
            Self::ProfileB => Self::ProfileA,
        }
    }
}

/// The flash did not do it, or a word read back is torn (an ECC error).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashError;

/// Slots of flash that can be erased one by one: two for the table, and two for the profile or none.
///
/// Erasing may stall the processor for seconds: the application calls it only when the amplifier is muted.
pub trait FlashPages {
    /// Bytes in a slot; 0 where there is none.
    fn slot_len(&self, slot: FlashSlot) -> usize;

    /// Erasures of each slot that the chip's data sheet promises; 0 without a store.
    fn endurance(&self) -> u32;

    /// Erases a slot.
    ///
    /// # Errors
    /// [`FlashError`] if the chip reports one.
    fn erase(&mut self, slot: FlashSlot) -> Result<(), FlashError>;

    /// Writes a word to an erased place; `offset` is a multiple of [`FLASH_WORD`].
    ///
    /// # Errors
    /// [`FlashError`] if the chip reports one or the place lies outside the slot.
    fn write(&mut self, slot: FlashSlot, offset: usize, word: &[u8; FLASH_WORD]) -> Result<(), FlashError>;

    /// Reads a word; `offset` is a multiple of [`FLASH_WORD`].
    ///
    /// # Errors
    /// [`FlashError`] if the word is torn or lies outside the slot.
    fn read(&mut self, slot: FlashSlot, offset: usize, word: &mut [u8; FLASH_WORD])
    -> Result<(), FlashError>;
}

/// A board without a store.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFlash;

impl FlashPages for NoFlash {
    fn slot_len(&self, _: FlashSlot) -> usize {
        0
    }

    fn endurance(&self) -> u32 {
        0
    }

    fn erase(&mut self, _: FlashSlot) -> Result<(), FlashError> {
        Err(FlashError)
    }

    fn write(&mut self, _: FlashSlot, _: usize, _: &[u8; FLASH_WORD]) -> Result<(), FlashError> {
        Err(FlashError)
    }

    fn read(&mut self, _: FlashSlot, _: usize, _: &mut [u8; FLASH_WORD]) -> Result<(), FlashError> {
        Err(FlashError)
    }
}

/// The board's control of itself.
pub trait System {
    /// Whether there is a ROM bootloader to enter.
    fn has_bootloader(&self) -> bool;

    /// Whether the board has a trigger input ([`Trigger::has_risen`]).
    fn has_trigger_input(&self) -> bool;

    /// Whether the brown-out reset level is set as the board needs it; true where there is no such level.
    fn is_brown_out_guarded(&self) -> bool;

    /// What the device has found on its board, and its button at this moment.
    fn board(&self) -> BoardReport {
        BoardReport::default()
    }

    /// What the start has found of the analogue supply, and the linear share of the DAC's output.
    fn analogue(&self) -> Analogue {
        Analogue { linear_per_mille: 1000, ..Analogue::default() }
    }

    /// The level of the mute pin, by its input register.
    fn mute_level(&self) -> PinLevel {
        PinLevel::NoPin
    }

    /// Takes the mute pin, which is high, low in this way, and waits until it is low, for 20 ms at most; `None` if it is not by then.
    /// Until the next [`Mute::set_muted`] that mutes, [`Mute::stay_on`] finds nothing wrong.
    fn try_mute(&mut self, _trial: MuteTrial) -> Option<MuteFall> {
        None
    }

    /// Stops the DAC's DMA for a millisecond; false where the device cannot. Called on the bench.
    fn stall(&mut self) -> bool {
        false
    }

    /// The device's clocks at one moment; `now` is the present index. It may wait for the next block.
    fn clock(&self, now: &dyn Fn() -> SampleIndex) -> ClockReport {
        ClockReport { at: now(), ..ClockReport::default() }
    }

    /// The actuator's profile says whether a stop input is fitted, or there is none. One that was fitted stays so until a reset.
    fn fit_stop_input(&mut self, _is_fitted: Option<bool>) {}

    /// The level of the brown-out reset, without a restart; `None` where the chip has none.
    fn brown_out(&self) -> Option<BrownOut> {
        None
    }

    /// Writes the level that the board needs into the chip's option bytes, and nothing else. It may stall the processor for seconds.
    /// Called when disarmed and muted, without read protection.
    ///
    /// # Errors
    /// [`FlashError`] if the chip reports one, or the option bytes read back wrong.
    fn raise_brown_out_level(&mut self) -> Result<(), FlashError> {
        Err(FlashError)
    }

    /// Restarts the device, with its new option bytes. Called when disarmed and silent, after the reply has gone out.
    fn restart(&mut self) {}

    /// Makes the device fail in this way, after it has marked the fault as ordered in the record that the next start reads
    /// ([`CrashRecord`](crate::CrashRecord)), and watches the mute pin meanwhile. The fault resets it. Called when the mute pin is high
    /// and nothing sounds.
    fn fail(&mut self, _fault: OrderedFault) {}

    /// The ordered fault that ended the last run, if one did.
    fn fault_end(&self) -> Option<FaultEnd> {
        None
    }

    /// Leaves the application for the ROM bootloader. Called when disarmed and silent, after the reply has gone out.
    fn enter_bootloader(&mut self);
}
