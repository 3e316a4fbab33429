//! The peripherals of the simulated device, in memory: the bytes of the link, the DAC, the ADC, the mute pin, the flash.

use super::inputs::Inputs;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Poll;

use slipline_app::BLOCK;
use slipline_app::dds::bank::code::MID_SCALE;
use slipline_app::ports::{
    Button, DacStream, FLASH_WORD, FlashError, FlashPages, FlashSlot, HasMuted, INPUTS, Mute, Overrun,
    SenseStream, System, Trigger, Underrun,
};
use slipline_app::safety::fade::fade;
use slipline_app::store::SLOT_BYTES;
use slipline_protocol::board::{
    Analogue, BoardReport, BrownOut, FaultEnd, MuteFall, MuteResistor, MuteTrial, OrderedFault, PinLevel,
    SampleClock, StopInput, UserButton,
};

/// Erase cycles of each slot, as guaranteed by the data sheets of the boards' chips.
const ENDURANCE: u32 = 10_000;

/// Time after which a board's mute timer takes the pin low by itself, in us.
pub(super) const STAYS_ON_US: u32 = 4000;

/// The slots of flash in memory; erased bytes are `0xff`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryFlash {
    /// The bytes of the table's two slots, and of the profile's.
    pub slots: [Vec<u8>; 4],
}

impl Default for MemoryFlash {
    fn default() -> Self {
        Self { slots: [const { SLOT_BYTES }; 4].map(|bytes| vec![0xff; bytes]) }
    }
}

impl MemoryFlash {
    fn word(&mut self, slot: FlashSlot, offset: usize) -> Result<&mut [u8], FlashError> {
        self.slots[slot as usize].get_mut(offset..offset + FLASH_WORD).ok_or(FlashError)
    }
}

/// A fault of a simulated device's mute pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MuteFault {
    /// The pin is high whatever the program and the timer do.
    StuckHigh,
    /// A break of the program leaves the pin high.
    DeadBreak,
    /// The amplifier is on while the pin is low, and muted while it is high.
    Inverted,
}

/// State of the peripherals.
#[derive(Default)]
pub(super) struct PeripheralState {
    pub(super) to_device: VecDeque<u8>,
    pub(super) from_device: Vec<u8>,
    pub(super) transmit_stalled: bool,
    /// The DAC accepts one more block.
    pub(super) room: bool,
    pub(super) sent: Option<[u16; BLOCK]>,
    /// Whether a block waits while the previous one plays, as in a board's ring; and the waiting block.
    holds: bool,
    waiting: Option<Waiting>,
    /// The trigger output rises with the block sent last.
    pub(super) rises: bool,
    /// The trigger input has risen since the renderer's last check.
    pub(super) has_risen: bool,
    pub(super) is_button_pressed: bool,
    pub(super) is_stop_open: bool,
    is_stop_fitted: Option<bool>,
    pub(super) underrun: bool,
    /// The last code played, and whether the DAC ramps to mid-scale by itself.
    last: u16,
    fading: bool,
    pub(super) muted: bool,
    /// The amplifier's pin has gone low by itself.
    pub(super) has_muted: bool,
    /// That was the stop input, which may be closed again.
    was_stopped: bool,
    /// The inputs sampled by the ADC, if there is one.
    pub(super) inputs: Option<Inputs>,
    pub(super) flash: MemoryFlash,
    pub(super) brown_out_guarded: bool,
    pub(super) read_protection: u8,
    /// The device restarts with the brown-out level that it has written.
    pub(super) restarts: bool,
    pub(super) mute_resistor_missing: bool,
    pub(super) sample_clock: SampleClock,
    pub(super) mute_fault: Option<MuteFault>,
    /// The device is on the bench: the stop input is watched while the pin is low.
    on_bench: bool,
    pub(super) analogue: Analogue,
    pub(super) in_bootloader: bool,
    /// The ordered fault that is under way.
    pub(super) failing: Option<OrderedFault>,
    /// How the ordered fault ended that has ended the last run.
    pub(super) fault_end: Option<FaultEnd>,
}

/// A block that the DAC has accepted and does not play yet.
struct Waiting {
    codes: [u16; BLOCK],
    late: bool,
    /// A revision of it was late: the fade follows it.
    fade_follows: bool,
    rises: bool,
}

/// The peripherals as the device application uses them. Clones refer to the same peripherals.
#[derive(Clone)]
pub(super) struct Peripherals(Arc<Mutex<PeripheralState>>);

impl Peripherals {
    /// The state after power-on, with the content of this flash.
    pub(super) fn new(
        flash: MemoryFlash,
        brown_out_guarded: bool,
        holds: bool,
        inputs: Option<Inputs>,
    ) -> Self {
        Self(Arc::new(Mutex::new(PeripheralState {
            holds,
            last: MID_SCALE,
            muted: true,
            inputs,
            flash,
            brown_out_guarded,
            ..PeripheralState::default()
        })))
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, PeripheralState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl embedded_io_async::ErrorType for Peripherals {
    type Error = std::convert::Infallible;
}

impl embedded_io_async::Read for Peripherals {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        poll_fn(|_| {
            let queue = &mut self.lock().to_device;
            if queue.is_empty() {
                return Poll::Pending;
            }
            let count = buffer.len().min(queue.len());
            for (to, from) in buffer.iter_mut().zip(queue.drain(..count)) {
                *to = from;
            }
            Poll::Ready(Ok(count))
        })
        .await
    }
}

impl embedded_io_async::Write for Peripherals {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        poll_fn(|_| {
            let mut state = self.lock();
            if state.transmit_stalled {
                return Poll::Pending;
            }
            state.from_device.extend_from_slice(bytes);
            Poll::Ready(Ok(bytes.len()))
        })
        .await
    }

    async fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

impl DacStream for Peripherals {
    async fn room(&mut self) {
        poll_fn(|_| if self.lock().room { Poll::Ready(()) } else { Poll::Pending }).await;
    }

    async fn write_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        self.room().await;
        let mut state = self.lock();
        state.room = false;
        let late = std::mem::take(&mut state.underrun);
        state.waiting = Some(Waiting { codes: *codes, late, fade_follows: false, rises: false });
        if !state.holds {
            state.begin_block();
        }
        if late { Err(Underrun) } else { Ok(()) }
    }

    fn is_revisable(&self) -> bool {
        let state = self.lock();
        !state.fades() && state.waiting.as_ref().is_some_and(|waiting| !waiting.late)
    }

    fn revise_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        let mut state = self.lock();
        let late = std::mem::take(&mut state.underrun);
        let Some(waiting) = &mut state.waiting else { return Err(Underrun) };
        waiting.fade_follows = late;
        if late {
            return Err(Underrun);
        }
        waiting.codes = *codes;
        Ok(())
    }
}

impl PeripheralState {
    /// The DAC begins to play the waiting block.
    pub(super) fn begin_block(&mut self) {
        if let Some(Waiting { codes, late, fade_follows, rises }) = self.waiting.take() {
            self.play(&codes, late);
            self.fading |= fade_follows;
            self.rises = rises;
        }
    }

    /// Whether a stop input is fitted and open.
    fn is_stopped(&self) -> bool {
        self.is_stop_fitted == Some(true) && self.is_stop_open
    }

    /// The open stop input mutes an amplifier that is on; on the bench it would.
    pub(super) fn break_if_open(&mut self) {
        if self.is_stopped() {
            let is_watched = !self.muted || self.on_bench;
            self.was_stopped |= is_watched;
            self.has_muted |= is_watched;
            self.mute();
        }
    }

    /// Takes the mute pin low, if it works.
    pub(super) fn mute(&mut self) {
        self.muted = self.mute_fault != Some(MuteFault::StuckHigh);
    }

    /// Whether the amplifier is muted: where the pin is low, unless it takes that for on.
    pub(super) fn is_amplifier_muted(&self) -> bool {
        self.muted != (self.mute_fault == Some(MuteFault::Inverted))
    }

    /// Whether the DAC ramps to mid-scale by itself and plays no block.
    fn fades(&self) -> bool {
        self.fading && self.last != MID_SCALE
    }

    /// Plays a block; if it is late, or earlier blocks were and the ramp to mid-scale is not over, plays the
    /// fade.
    fn play(&mut self, codes: &[u16; BLOCK], late: bool) {
        self.fading = late || self.fades();
        let mut played = *codes;
        if self.fading {
            for (code, faded) in played.iter_mut().zip(fade(self.last)) {
                *code = faded;
            }
        }
        self.last = *played.last().unwrap_or(&MID_SCALE);
        self.sent = Some(played);
    }
}

impl SenseStream for Peripherals {
    fn inputs(&self) -> usize {
        self.lock().inputs.as_ref().map_or(0, Inputs::inputs)
    }

    fn delay_ns(&self) -> i32 {
        self.lock().inputs.as_ref().map_or(0, Inputs::delay_ns)
    }

    fn take_block(
        &mut self,
        _: Range<usize>,
        codes: &mut [[u16; BLOCK]; INPUTS],
    ) -> Option<Result<(), Overrun>> {
        let taken = self.lock().inputs.as_mut()?.take()?;
        Some(taken.map(|block| *codes = block))
    }
}

impl Mute for Peripherals {
    fn set_muted(&mut self, muted: bool) {
        let mut state = self.lock();
        state.has_muted &= !muted;
        state.was_stopped &= !muted;
        state.on_bench = false;
        state.muted = false;
        if muted || state.has_muted || state.mute_resistor_missing {
            state.mute();
        }
        state.break_if_open();
    }

    fn bench(&mut self) {
        let mut state = self.lock();
        if !state.on_bench {
            (state.on_bench, state.has_muted, state.was_stopped) = (true, false, false);
        }
        state.mute();
        state.break_if_open();
    }

    fn stay_on(&mut self) -> Result<(), HasMuted> {
        if self.lock().has_muted { Err(HasMuted) } else { Ok(()) }
    }

    fn was_stopped(&mut self) -> bool {
        self.lock().was_stopped
    }
}

impl Trigger for Peripherals {
    fn rise(&mut self) {
        let mut state = self.lock();
        match &mut state.waiting {
            Some(waiting) => waiting.rises = true,
            None => state.rises = true,
        }
    }

    fn has_risen(&mut self) -> bool {
        std::mem::take(&mut self.lock().has_risen)
    }
}

impl Button for Peripherals {
    fn is_pressed(&mut self) -> bool {
        self.lock().is_button_pressed
    }
}

impl FlashPages for Peripherals {
    fn slot_len(&self, slot: FlashSlot) -> usize {
        self.lock().flash.slots[slot as usize].len()
    }

    fn endurance(&self) -> u32 {
        ENDURANCE
    }

    fn erase(&mut self, slot: FlashSlot) -> Result<(), FlashError> {
        self.lock().flash.slots[slot as usize].fill(0xff);
        Ok(())
    }

    fn write(&mut self, slot: FlashSlot, offset: usize, word: &[u8; FLASH_WORD]) -> Result<(), FlashError> {
        // Programming can only clear bits.
        for (to, from) in self.lock().flash.word(slot, offset)?.iter_mut().zip(word) {
            *to &= from;
        }
        Ok(())
    }

    fn read(
        &mut self,
        slot: FlashSlot,
        offset: usize,
        word: &mut [u8; FLASH_WORD],
    ) -> Result<(), FlashError> {
        word.copy_from_slice(self.lock().flash.word(slot, offset)?);
        Ok(())
    }
}

impl System for Peripherals {
    fn has_bootloader(&self) -> bool {
        true
    }

    fn has_trigger_input(&self) -> bool {
        true
    }

    fn is_brown_out_guarded(&self) -> bool {
        self.lock().brown_out_guarded
    }

    fn board(&self) -> BoardReport {
        let state = self.lock();
        let (missing, pressed) = (state.mute_resistor_missing, state.is_button_pressed);
        BoardReport {
            // The renderer's time is not counted.
            core_hz: 0,
            mute_resistor: if missing { MuteResistor::Missing } else { MuteResistor::Present },
            user_button: if pressed { UserButton::Pressed } else { UserButton::Released },
            stop_input: match (state.is_stop_fitted, state.is_stop_open) {
                (Some(true), true) => StopInput::Open,
                (Some(true), false) => StopInput::Closed,
                (Some(false) | None, _) => StopInput::Unused,
            },
            trigger_input: self.has_trigger_input(),
            sample_clock: state.sample_clock,
        }
    }

    fn analogue(&self) -> Analogue {
        self.lock().analogue
    }

    fn mute_level(&self) -> PinLevel {
        if self.lock().muted { PinLevel::Low } else { PinLevel::High }
    }

    fn try_mute(&mut self, trial: MuteTrial) -> Option<MuteFall> {
        let mut state = self.lock();
        let low_after_us = match (trial, state.mute_fault) {
            (MuteTrial::Read, _) | (_, Some(MuteFault::StuckHigh)) => return None,
            (MuteTrial::Break, Some(MuteFault::DeadBreak)) => return None,
            (MuteTrial::Lapse, _) => STAYS_ON_US,
            (MuteTrial::Break, _) => 0,
        };
        state.mute();
        Some(MuteFall { low_after_us, within_us: 0 })
    }

    /// The next block is late.
    fn stall(&mut self) -> bool {
        self.lock().underrun = true;
        true
    }

    fn fit_stop_input(&mut self, is_fitted: Option<bool>) {
        let mut state = self.lock();
        state.is_stop_fitted = is_fitted;
        state.break_if_open();
    }

    /// As on an F407, whose level 2 guards its board (FLASH_OPTCR: BOR_LEV in bits 2 and 3 counts down, RDP is the second byte).
    fn brown_out(&self) -> Option<BrownOut> {
        let state = self.lock();
        let (needed, read_protection) = (2, state.read_protection);
        let level = if state.brown_out_guarded { needed } else { 0 };
        let options = 0x0fff_00e0 | u32::from(read_protection) << 8 | u32::from(3 - level) << 2;
        Some(BrownOut { level, needed, options, read_protection, restarts: false })
    }

    fn raise_brown_out_level(&mut self) -> Result<(), FlashError> {
        self.lock().brown_out_guarded = true;
        Ok(())
    }

    fn restart(&mut self) {
        self.lock().restarts = true;
    }

    fn fail(&mut self, fault: OrderedFault) {
        self.lock().failing = Some(fault);
    }

    fn fault_end(&self) -> Option<FaultEnd> {
        self.lock().fault_end
    }

    fn enter_bootloader(&mut self) {
        self.lock().in_bootloader = true;
    }
}
