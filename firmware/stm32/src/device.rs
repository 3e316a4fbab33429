//! Start-up in order, and the tasks.

use cortex_m::peripheral::DWT;
use embassy_executor::{Executor, InterruptExecutor};
use embassy_stm32::gpio::Output;
use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Duration, Instant, Ticker};
use slipline_app::boot::{Boot, STABLE_AFTER_MS};
use slipline_app::ports::{CycleCounter, Mute, System};
use slipline_app::{Device, Link, Mailbox, Renderer, Supervisor, Timing};
use static_cell::{ConstStaticCell, StaticCell};

use crate::board;
use crate::dac::Dac;
use crate::lamp::Lamp;
use crate::store::Store;
#[cfg(feature = "link-uart")]
use crate::uart_link::{FromHost, ToHost, start as start_link};
#[cfg(feature = "link-usb")]
use crate::usb_link::{FromHost, ToHost, start as start_link};
use crate::{bootloader, crash, priority, supply};

/// The state that thread and interrupt share.
static MAILBOX: Mailbox<CriticalSectionRawMutex> = Mailbox::new();

/// Runs the renderer. UART5 is unused on all three boards: its vector only lends the executor a priority.
static RENDERER_EXECUTOR: InterruptExecutor = InterruptExecutor::new();

#[embassy_stm32::interrupt]
fn UART5() {
    // SAFETY: called from the executor's own interrupt only, which is enabled by `start`.
    unsafe { RENDERER_EXECUTOR.on_interrupt() }
}

/// The supervisor looks every step of the lamp's pattern.
const SUPERVISION_MS: u64 = 100;

#[cortex_m_rt::entry]
fn main() -> ! {
    // The order matters. Until `board::take` the mute pin floats and its resistor mutes the amplifier; from there on the
    // program holds it low; the DAC is at mid-scale before the application exists that could ask to unmute.
    bootloader::enter_if_requested();
    bootloader::undo_rom_state();
    let peripherals = embassy_stm32::init(board::config());
    let board = board::take(peripherals);
    board::tune_flash();
    let boot = crash::boot();
    supply::watch();
    start_cycle_counter();

    board::DMA_INTERRUPT.set_priority(priority::DAC);
    interrupt::TIM6_DAC.set_priority(priority::DAC);
    interrupt::TIM5.set_priority(priority::TIME);
    // SAFETY: embassy has enabled all DMA interrupts already; the underrun's handler needs nothing that is set up later.
    unsafe { interrupt::TIM6_DAC.enable() };
    let dac = Dac::start(board.dac, board.dac_timer, board.dac_stream, board.dac_pin);

    let mut watchdog = IndependentWatchdog::new(board.watchdog, board::WATCHDOG_US);
    watchdog.unleash();

    interrupt::UART5.set_priority(priority::RENDERER);
    let above = RENDERER_EXECUTOR.start(interrupt::UART5);
    if let Ok(task) = render(dac, AmplifierMute(board.unmute)) {
        above.spawn(task);
    }

    let lamp = if boot.safe_mode {
        Some(Lamp::SafeMode)
    } else if board::is_brown_out_guarded() {
        None
    } else {
        Some(Lamp::NoBrownOutLevel)
    };
    let store = Store::new(board.flash);

    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        if let Ok(task) = supervise(watchdog, board.lamp, lamp) {
            spawner.spawn(task);
        }
        let (read, write) = start_link(spawner, board.link);
        if let Ok(task) = talk(read, write, boot, store) {
            spawner.spawn(task);
        }
    })
}

/// DWT's cycle counter, free running (ARMv7-M, DWT_CYCCNT); the trace unit must be on for it, and a Cortex-M7 ignores
/// what is written to the unit until its lock is opened (DWT_LAR), as a debug probe does by itself.
fn start_cycle_counter() {
    // SAFETY: nothing else uses the debug peripherals; interrupts that read the counter are not enabled yet.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.DCB.enable_trace();
    DWT::unlock();
    core.DWT.enable_cycle_counter();
}

/// The renderer, at interrupt priority, for ever.
#[embassy_executor::task]
async fn render(dac: Dac, mute: AmplifierMute) {
    // Made by the compiler: made here it would be 10 KiB on the stack for a moment, more than anything else ever needs.
    static RENDERER: ConstStaticCell<Renderer> =
        ConstStaticCell::new(Renderer::new(Timing::at(board::SAMPLE_RATE_HZ)));
    RENDERER.take().run(&MAILBOX, dac, mute, Cycles).await;
}

#[embassy_executor::task]
async fn talk(read: FromHost, write: ToHost, boot: Boot, store: Store) {
    let mut link = Link::new(identity(), boot, store, Rom);
    link.run(&MAILBOX, read, write).await;
}

/// What the application says of this device.
fn identity() -> Device {
    const fn number(text: &str) -> u8 {
        let mut value = 0;
        let mut bytes = text.as_bytes();
        while let [digit, rest @ ..] = bytes {
            value = value * 10 + (*digit - b'0');
            bytes = rest;
        }
        value
    }
    Device {
        board: board::NAME,
        build: env!("SLIPLINE_BUILD"),
        firmware: const {
            (
                number(env!("CARGO_PKG_VERSION_MAJOR")),
                number(env!("CARGO_PKG_VERSION_MINOR")),
                number(env!("CARGO_PKG_VERSION_PATCH")),
            )
        },
        unit: embassy_stm32::uid::uid(),
        simulated: false,
        sample_rate_hz: board::SAMPLE_RATE_HZ,
    }
}

/// Feeds the watchdog while both sides run, shows the lamp, and forgets earlier crashes after a stable run.
#[embassy_executor::task]
async fn supervise(
    mut watchdog: IndependentWatchdog<'static, board::Watchdog>,
    mut light: Output<'static>,
    standing: Option<Lamp>,
) {
    let mut supervisor = Supervisor::new();
    let mut every = Ticker::every(Duration::from_millis(SUPERVISION_MS));
    let mut is_stable = false;
    for step in 0u32.. {
        every.next().await;
        if supervisor.may_feed(MAILBOX.pulses()) {
            watchdog.pet();
        }
        let lamp = standing.unwrap_or(if AmplifierMute::is_muted() { Lamp::Muted } else { Lamp::Sounding });
        light.set_level(lamp.is_lit(step).into());
        if !is_stable && Instant::now() >= Instant::from_millis(u64::from(STABLE_AFTER_MS)) {
            is_stable = true;
            crash::stable();
        }
    }
}

/// The amplifier's enable input.
struct AmplifierMute(Output<'static>);

/// What the pin was last set to, for the lamp.
static IS_MUTED: core::sync::atomic::AtomicBool = core::sync::atomic::AtomicBool::new(true);

impl AmplifierMute {
    fn is_muted() -> bool {
        IS_MUTED.load(core::sync::atomic::Ordering::Relaxed)
    }
}

impl Mute for AmplifierMute {
    fn set_muted(&mut self, muted: bool) {
        self.0.set_level((!muted).into());
        IS_MUTED.store(muted, core::sync::atomic::Ordering::Relaxed);
    }
}

/// The core's own counter.
struct Cycles;

impl CycleCounter for Cycles {
    fn cycles(&mut self) -> u32 {
        DWT::cycle_count()
    }
}

/// The chip's ROM bootloader.
struct Rom;

impl System for Rom {
    fn has_bootloader(&self) -> bool {
        true
    }

    fn enter_bootloader(&mut self) {
        bootloader::reset_into()
    }
}
