//! The simulated device: the device application itself, with its peripherals in memory and its time counted in blocks.
//!
//! ```text
//! feed(bytes) -> [ Link::run ] -> take()          polled whenever bytes come and between blocks
//! advance(n)  -> [ Renderer::run ] -> SentBlock   one block for each step of time
//! ```
//! It has no thread and no clock: it acts only when it is called, so every run can be repeated exactly.
//! Hardware faults are injected at the peripherals, where they would occur.

use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Wake, Waker};

use super::inputs::{Inputs, SimulatedInputs, Wires};
use super::peripherals::{MemoryFlash, MuteFault, Peripherals, STAYS_ON_US};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use slipline_app::BLOCK;
use slipline_app::dds::bank::code::MID_SCALE;
use slipline_app::listening::capture::Values;
use slipline_app::listening::listener::Listener;
use slipline_app::mailbox::{Mailbox, Pulses};
use slipline_app::planning::chord::Candidate;
use slipline_app::ports::RendererPorts;
use slipline_app::safety::boot::{self, Boot};
use slipline_app::safety::thermal::Heat;
use slipline_app::timing::TICK_BLOCKS;
use slipline_app::{CrashRecord, Device, Link, Renderer, Supervisor, Timing, release};
use slipline_protocol::board::{Analogue, FaultEnd, OrderedFault, SampleClock};
use slipline_protocol::event::ResetCause;
use slipline_protocol::units::SampleIndex;

/// Time between two runs of the supervisor.
const SUPERVISION_MS: u32 = 100;
/// Time without feeding after which the watchdog resets the device.
pub const WATCHDOG_MS: u32 = 300;

type Shared = Arc<Mailbox<CriticalSectionRawMutex>>;
type Task = Pin<Box<dyn Future<Output = ()> + Send>>;

/// Options of a simulated device.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Samples per second, in Hz.
    pub sample_rate_hz: u32,
    /// The index of its first sample.
    pub first_index: SampleIndex,
    /// The thermal state of its coil.
    pub heat: Heat,
    /// The flash's two slots.
    pub flash: MemoryFlash,
    /// The chip's unique id.
    pub unit: [u8; 12],
    /// Whether it reports that its brown-out reset level is set.
    pub brown_out_guarded: bool,
    /// The byte by which its chip codes its level of read protection: 0xaa is none.
    pub read_protection: u8,
    /// Whether its mute pin lacks its resistor, so that its amplifier stays muted.
    pub mute_resistor_missing: bool,
    /// What times its samples.
    pub sample_clock: SampleClock,
    /// What it reports of its supply. Its DAC's output clips beyond the linear share that stands here.
    pub analogue: Analogue,
    /// The wires between its pins.
    pub wires: Wires,
    /// What is broken at its mute pin.
    pub mute_fault: Option<MuteFault>,
    /// Whether a rendered block waits for one block before it plays, as in a board's ring: every command
    /// takes effect a block later, but a stop may begin in the waiting block.
    pub block_waits: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sample_rate_hz: 400_000,
            first_index: 0,
            heat: Heat::Cold,
            flash: MemoryFlash::default(),
            unit: *b"simulated-00",
            brown_out_guarded: true,
            read_protection: 0xaa,
            mute_resistor_missing: false,
            sample_clock: SampleClock::Exact,
            analogue: Analogue { reference_mv: 3300, linear_per_mille: 1000, ..Analogue::default() },
            wires: Wires::default(),
            mute_fault: None,
            block_waits: false,
        }
    }
}

/// One block as it leaves for the DAC.
#[derive(Clone, Copy, Debug)]
pub struct SentBlock<'a> {
    /// The index of the first code.
    pub first: SampleIndex,
    /// The codes.
    pub codes: &'a [u16; BLOCK],
    /// Whether the amplifier is muted during this block.
    pub muted: bool,
    /// Whether a program begins with the first code: a board's trigger output then rises.
    pub begins: bool,
}

/// The device application in memory, in virtual time.
///
/// ```
/// use slipline_link::protocol::command::Hello;
/// use slipline_link::protocol::version::{Minor, Version};
/// use slipline_link::protocol::{Command, Decoder, Event};
/// use slipline_link::simulator::{Options, SimulatedDevice};
///
/// let mut device = SimulatedDevice::new(Options::default());
/// let hello = Command::Hello(Hello { version: Version::OURS, nonce: *b"demo" });
/// if let Ok(frame) = hello.frame_for(Minor::FIRST, 0, 1) {
///     device.feed(&frame);
/// }
/// let mut bytes = Vec::new();
/// device.take(&mut bytes);
/// let mut decoder = Decoder::new();
/// let answers: Vec<Event> = bytes
///     .iter()
///     .filter_map(|&byte| decoder.push(byte, |frame| Event::decode(frame.header.id, frame.body).ok()))
///     .flatten()
///     .collect();
/// assert!(matches!(&answers[..], [Event::Hello(identity)] if identity.simulated));
///
/// // Ten blocks of 128 codes: nothing is driven, so they are mid-scale.
/// device.advance(10, |block| assert!(block.codes.iter().all(|&code| code == 2048)));
/// assert_eq!(device.now(), 1280);
/// ```
pub struct SimulatedDevice {
    options: Options,
    peripherals: Peripherals,
    mailbox: Shared,
    link: Task,
    renderer: Task,
    link_frozen: bool,
    /// The ordered fault that is under way, and when it began.
    failing: Option<(OrderedFault, SampleIndex)>,
    woken: Arc<Woken>,
    waker: Waker,
    kept: CrashRecord,
    supervisor: Supervisor,
    /// The index of the next code to leave for the DAC.
    now: SampleIndex,
    fed_at: SampleIndex,
    asked_at: SampleIndex,
}

impl SimulatedDevice {
    /// A device after power-on, before the first sample.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self::power_on(options, None)
    }

    /// The same with inputs.
    #[must_use]
    pub fn with_inputs(options: Options, inputs: Box<dyn SimulatedInputs>) -> Self {
        Self::power_on(options, Some(inputs))
    }

    fn power_on(options: Options, inputs: Option<Box<dyn SimulatedInputs>>) -> Self {
        let (decided, kept) = boot::decide(ResetCause::PowerOn, None);
        let boot = Boot { heat: options.heat, ..decided };
        Self::start(options, boot, kept, inputs)
    }

    fn start(
        options: Options,
        boot: Boot,
        kept: CrashRecord,
        inputs: Option<Box<dyn SimulatedInputs>>,
    ) -> Self {
        let (guarded, holds) = (options.brown_out_guarded, options.block_waits);
        let inputs = Inputs::of(inputs, options.wires);
        let peripherals = Peripherals::new(options.flash.clone(), guarded, holds, inputs);
        {
            let mut state = peripherals.lock();
            state.mute_resistor_missing = options.mute_resistor_missing;
            state.sample_clock = options.sample_clock;
            state.mute_fault = options.mute_fault;
            state.read_protection = options.read_protection;
            state.analogue = options.analogue;
            state.mute();
        }
        let mailbox = Shared::default();
        let device = Device {
            board: "simulated",
            build: concat!("slipline ", env!("CARGO_PKG_VERSION")),
            firmware: release::VERSION,
            unit: options.unit,
            simulated: true,
            sample_rate_hz: options.sample_rate_hz,
        };
        let mut renderer = Renderer::starting_at(Timing::at(options.sample_rate_hz), options.first_index);
        let now = renderer.index();
        let (link_mailbox, link_peripherals) = (mailbox.clone(), peripherals.clone());
        let (renderer_mailbox, renderer_peripherals) = (mailbox.clone(), peripherals.clone());
        let link_values = Arc::new(Values::new());
        let listener_values = link_values.clone();
        let woken = Arc::new(Woken::default());
        let mut device = Self {
            options,
            peripherals,
            mailbox,
            link: Box::pin(async move {
                let (flash, system) = (link_peripherals.clone(), link_peripherals.clone());
                let mut candidate = Candidate::new();
                let mut link = Link::new(device, boot, flash, system, &mut candidate, &link_values);
                link.run(&link_mailbox, link_peripherals.clone(), link_peripherals).await;
            }),
            renderer: Box::pin(async move {
                let mut listener = Listener::starting_at(renderer.index(), &listener_values);
                let ports = RendererPorts {
                    dac: renderer_peripherals.clone(),
                    mute: renderer_peripherals.clone(),
                    trigger: renderer_peripherals.clone(),
                    button: renderer_peripherals.clone(),
                    cycles: (),
                    sense: renderer_peripherals,
                };
                renderer.run(&renderer_mailbox, ports, &mut listener).await;
            }),
            link_frozen: false,
            failing: None,
            waker: woken.clone().into(),
            woken,
            kept,
            supervisor: Supervisor::new(),
            now,
            fed_at: now,
            asked_at: now,
        };
        // The renderer sets the index before the link reads it.
        device.peripherals.lock().room = device.options.block_waits;
        poll(&mut device.renderer, &device.waker);
        poll(&mut device.link, &device.waker);
        device
    }

    /// Resets the device: the flash, the option bytes and the record of crashes are kept, the remaining state restarts, and
    /// the index starts from 0.
    pub fn restart(&mut self, cause: ResetCause) {
        let brown_out_guarded = self.peripherals.lock().brown_out_guarded;
        let flash = self.flash();
        let options = Options { flash, brown_out_guarded, first_index: 0, ..self.options.clone() };
        let kept = if cause == ResetCause::PowerOn { None } else { Some(self.kept.clone()) };
        let (boot, kept) = boot::decide(cause, kept);
        let inputs = self.peripherals.lock().inputs.take().and_then(Inputs::into_source);
        *self = Self::start(options, boot, kept, inputs);
    }

    /// Makes the firmware panic: its handler stores a record and resets.
    pub fn panic(&mut self, message: &str) {
        self.kept = CrashRecord::crashed(ResetCause::Panic, self.kept.resets, &message);
        self.restart(ResetCause::Software);
    }

    /// Passes bytes to the device and runs its link.
    pub fn feed(&mut self, bytes: &[u8]) {
        self.peripherals.lock().to_device.extend(bytes);
        self.poll_link();
    }

    /// Appends the device's replies to `bytes`.
    pub fn take(&mut self, bytes: &mut Vec<u8>) {
        bytes.append(&mut self.peripherals.lock().from_device);
    }

    /// Renders `blocks` blocks; `sink` receives each as it leaves for the DAC.
    pub fn advance(&mut self, blocks: u64, mut sink: impl FnMut(SentBlock<'_>)) {
        for _ in 0..blocks {
            {
                let mut state = self.peripherals.lock();
                state.begin_block();
                state.room = true;
            }
            if !self.masks_interrupts() {
                poll(&mut self.renderer, &self.waker);
            }
            // The pin keeps the state set for this block until the next one is rendered.
            let muted = self.is_muted();
            let (sent, begins) = {
                let mut state = self.peripherals.lock();
                let sent = state.sent.take();
                let share = i32::from(self.options.analogue.linear_per_mille);
                if let (Some(codes), Some(inputs)) = (&sent, &mut state.inputs) {
                    // The renderer receives the input block after its end: at its next turn.
                    if share < 1000 {
                        inputs.sample(&codes.map(|code| at_pin(code, share)), muted);
                    } else {
                        inputs.sample(codes, muted);
                    }
                }
                state.has_risen |= state.rises && self.options.wires.trigger;
                (sent, std::mem::take(&mut state.rises))
            };
            if let Some(codes) = sent {
                sink(SentBlock { first: self.now, codes: &codes, muted, begins });
            }
            self.now = self.now.saturating_add(BLOCK as u64);
            self.poll_link();
            self.supervise();
            self.fail();
            if self.peripherals.lock().restarts {
                self.restart(ResetCause::Software);
            }
        }
    }

    /// Whether an ordered fault keeps the interrupts masked.
    const fn masks_interrupts(&self) -> bool {
        matches!(self.failing, Some((OrderedFault::MaskedInterrupts, _)))
    }

    /// What an ordered fault makes of the device: its end by the watchdog, or by the processor's fault.
    fn fail(&mut self) {
        let ordered = self.peripherals.lock().failing;
        let Some((fault, since)) = self.failing.or(ordered.map(|fault| (fault, self.now))) else { return };
        self.failing = Some((fault, since));
        let failed_us = ((self.now - since) * 1_000_000 / u64::from(self.options.sample_rate_hz)) as u32;
        let is_lapsed = fault == OrderedFault::MaskedInterrupts && failed_us >= STAYS_ON_US;
        if is_lapsed || fault == OrderedFault::StackOverflow {
            self.peripherals.lock().mute();
        }
        if fault != OrderedFault::StackOverflow && !self.is_watchdog_starved() {
            return;
        }
        let is_low = self.peripherals.lock().muted;
        let has_lapsed = fault == OrderedFault::MaskedInterrupts && is_low;
        let muted_after_us = if has_lapsed { STAYS_ON_US } else { failed_us };
        let cause = boot::reset_by(fault);
        let (cause, record) = if matches!(cause, ResetCause::HardFault | ResetCause::Panic) {
            (ResetCause::Software, CrashRecord::crashed(cause, self.kept.resets, &"stack overflow"))
        } else {
            (cause, self.kept.clone())
        };
        self.kept = CrashRecord { ordered: Some(fault), ..record };
        self.restart(cause);
        self.peripherals.lock().fault_end = Some(FaultEnd { fault, muted_after_us, by_reset: !is_low });
    }

    fn poll_link(&mut self) {
        if self.link_frozen || self.failing.is_some() {
            return;
        }
        // After a stop the link lets the renderer run.
        loop {
            self.woken.0.store(false, Ordering::Relaxed);
            poll(&mut self.link, &self.waker);
            if !self.woken.0.load(Ordering::Relaxed) {
                return;
            }
            poll(&mut self.renderer, &self.waker);
        }
    }

    fn supervise(&mut self) {
        let timing = Timing::at(self.options.sample_rate_hz);
        if self.now - self.asked_at < timing.samples(SUPERVISION_MS) {
            return;
        }
        self.asked_at = self.now;
        if self.supervisor.may_feed(self.pulses()) {
            self.fed_at = self.now;
        }
    }

    /// The index of the next code to leave for the DAC.
    #[must_use]
    pub const fn now(&self) -> SampleIndex {
        self.now
    }

    /// Samples per second, in Hz.
    #[must_use]
    pub const fn sample_rate_hz(&self) -> u32 {
        self.options.sample_rate_hz
    }

    /// Whether the amplifier is muted.
    #[must_use]
    pub fn is_muted(&self) -> bool {
        self.peripherals.lock().is_amplifier_muted()
    }

    /// Whether the device has restarted into its bootloader.
    #[must_use]
    pub fn is_in_bootloader(&self) -> bool {
        self.peripherals.lock().in_bootloader
    }

    /// Whether the watchdog would have reset the device by now.
    ///
    /// A device that is simulated at a low sample rate counts its ticks in long blocks; its limit is four
    /// ticks.
    #[must_use]
    pub fn is_watchdog_starved(&self) -> bool {
        let period = Timing::at(self.options.sample_rate_hz).samples(WATCHDOG_MS);
        self.now - self.fed_at > period.max(4 * TICK_BLOCKS * BLOCK as u64)
    }

    /// The tasks' signs of life.
    #[must_use]
    pub fn pulses(&self) -> Pulses {
        self.mailbox.pulses()
    }

    /// The content of the flash.
    #[must_use]
    pub fn flash(&self) -> MemoryFlash {
        self.peripherals.lock().flash.clone()
    }

    /// Whether a drive waits for the trigger input.
    #[must_use]
    pub fn waits_for_trigger(&self) -> bool {
        self.mailbox.view().waits()
    }

    /// Raises the trigger input briefly.
    pub fn raise_trigger(&mut self) {
        self.peripherals.lock().has_risen = true;
    }

    /// Presses the user button, or lets it go.
    pub fn press_button(&mut self, is_pressed: bool) {
        self.peripherals.lock().is_button_pressed = is_pressed;
    }

    /// Opens or closes the stop input. This has no effect unless the profile states that a stop input is fitted.
    pub fn open_stop_input(&mut self, is_open: bool) {
        let mut state = self.peripherals.lock();
        state.is_stop_open = is_open;
        state.break_if_open();
    }

    /// Makes the next block late.
    pub fn inject_underrun(&mut self) {
        self.peripherals.lock().underrun = true;
    }

    /// Drops the next `blocks` blocks of the inputs, as if the device had not read them in time.
    pub fn inject_overrun(&mut self, blocks: u32) {
        if let Some(inputs) = &mut self.peripherals.lock().inputs {
            inputs.lose(blocks);
        }
    }

    /// Lets the amplifier's pin go low by itself, as it does some milliseconds after the last block that was
    /// in time.
    pub fn inject_mute(&mut self) {
        let mut state = self.peripherals.lock();
        state.has_muted = !state.muted;
        state.muted = true;
    }

    /// Sets whether the host has stopped reading, so that the device's bytes are not taken.
    pub fn stall_transmit(&mut self, stalled: bool) {
        self.peripherals.lock().transmit_stalled = stalled;
        self.poll_link();
    }

    /// Sets whether the thread side (the link) hangs; the interrupt side (the renderer) continues.
    pub fn freeze_link(&mut self, frozen: bool) {
        self.link_frozen = frozen;
        self.poll_link();
    }
}

/// A code as the DAC's output shows it: linear within this share of the half swing, in per mille, and saturated beyond.
fn at_pin(code: u16, share: i32) -> u16 {
    let (mid, half) = (i32::from(MID_SCALE), i32::from(MID_SCALE) * share / 1000);
    // Between 0 and 4096.
    (mid + (i32::from(code) - mid).clamp(-half, half)) as u16
}

fn poll(task: &mut Task, waker: &Waker) {
    // Apart from a task that wakes itself, only the next call wakes it.
    let _ = task.as_mut().poll(&mut Context::from_waker(waker));
}

/// Records that a task was woken: a task that has woken itself continues.
#[derive(Default)]
struct Woken(AtomicBool);

impl Wake for Woken {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Relaxed);
    }
}
