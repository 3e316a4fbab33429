//! The start-up, and the tasks.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use cortex_m::peripheral::{DWT, SCB};
use embassy_executor::{Executor, InterruptExecutor};
use embassy_stm32::gpio::{Flex, Output, Pull};
use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Instant, Timer};
use slipline_app::listening::capture::Values;
use slipline_app::listening::listener::Listener;
use slipline_app::planning::chord::Candidate;
use slipline_app::ports::{
    Analogue, BoardReport, BrownOut, ClockReport, CycleCounter, FaultEnd, FlashError, MuteFall, MuteResistor,
    MuteTrial, OrderedFault, PinLevel, RendererPorts, SampleClock, SampleIndex, StopInput, System,
};
use slipline_app::safety::boot::{Boot, STABLE_AFTER_MS};
use slipline_app::{Device, Link, Mailbox, Renderer, Supervisor, Timing, release};
use static_cell::StaticCell;

use crate::board;
use crate::button::{self, UserButton};
use crate::dac::{self, Dac};
use crate::lamp::Lamp;
use crate::mute::{self, MutePin};
use crate::sense::Inputs;
use crate::store::Store;
use crate::trigger::TriggerPins;
#[cfg(feature = "link-uart")]
use crate::uart_link::{FromHost, ToHost, next_frame, start as start_link};
#[cfg(feature = "link-usb")]
use crate::usb_link::{FromHost, ToHost, next_frame, start as start_link};
use crate::{
    bootloader, crash, fast, fault_trial, guard, pin_lock, pin_watch, priority, store, supply, watchdog,
};

type SharedMailbox = Mailbox<CriticalSectionRawMutex>;

// The large states are set up by the start: initial values would take their room in the flash, though nearly all of it is zero. The
// mailbox is set up in its place, and each other one by a function of its own (`set_up`): one more of them on the stack is less than
// the link takes later.
/// The state that thread and interrupt share. Where the memory map puts it.
// SAFETY: what lies there is zeroed before the mailbox is set up (`fast::load`), or before the program begins.
#[unsafe(link_section = ".bss.mailbox")]
static MAILBOX: Place<SharedMailbox> = Place::new();

/// The memory in which chords are proven. Where the memory map puts it.
// SAFETY: as the mailbox's.
#[unsafe(link_section = ".bss.candidate")]
static CANDIDATE: Place<Candidate> = Place::new();

static RENDERER: Place<Renderer> = Place::new();
static LISTENER: Place<Listener<'static>> = Place::new();

/// The memory of a state. Tasks find it at its address: to hand them a reference would cost every block of the renderer time.
struct Place<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: a state is written by `main` before any task runs. From then on the mailbox is shared, and each other state is one task's.
unsafe impl<T: Send> Sync for Place<T> {}

impl<T> Place<T> {
    const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }
}

/// The mailbox, for the tasks.
fn mailbox() -> &'static SharedMailbox {
    // SAFETY: `main` has set it up, and nobody has it mutably from then on.
    unsafe { (*MAILBOX.0.get()).assume_init_ref() }
}

/// The captured values. Where the memory map puts it; it is not cleared at the start, because no value is read that has not
/// been written.
// SAFETY: any 32 bits are a value.
#[unsafe(link_section = ".uninit.captured")]
static CAPTURED: Values = Values::new();

/// Runs the renderer. UART5 is unused on all three boards: the executor uses its interrupt vector, with its priority.
static RENDERER_EXECUTOR: InterruptExecutor = InterruptExecutor::new();

#[embassy_stm32::interrupt]
fn UART5() {
    // SAFETY: called from the executor's own interrupt only, which is enabled by `start`.
    unsafe { RENDERER_EXECUTOR.on_interrupt() }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    // The order matters. Until `board::take` the mute pin floats and its resistor mutes the amplifier; then the program
    // holds the pin low, and from `MutePin::start` on the mute timer does. The DAC is at mid-scale before the application
    // starts, which alone unmutes.
    bootloader::enter_if_requested();
    bootloader::undo_rom_state();
    guard::start();
    let peripherals = embassy_stm32::init(board::config());
    // By which `take` waits.
    start_cycle_counter();
    let board = board::take(peripherals);
    let has_mute_resistor = board.unmute.has_resistor;
    let mute = MutePin::start(board.mute_timer, board.unmute);
    let button = UserButton::start(board.button);
    board::guard_clock();
    board::set_debug_freezes();
    board::tune_flash();
    fast::load();
    let boot = crash::boot();
    // After the record has been read, which the power-on leaves undefined.
    board::watch_ram();
    supply::watch();
    // SAFETY: no task runs yet.
    Mailbox::new_in(unsafe { &mut *MAILBOX.0.get() });
    set_up(&RENDERER, || Renderer::new(const { Timing::at(board::SAMPLE_RATE_HZ) }));
    set_up(&LISTENER, || Listener::starting_at(0, &CAPTURED));
    set_up(&CANDIDATE, Candidate::new);

    board::DMA_INTERRUPT.set_priority(priority::DAC);
    interrupt::TIM6_DAC.set_priority(priority::DAC);
    interrupt::TIM5.set_priority(priority::TIME);
    // SAFETY: embassy has enabled all DMA interrupts already; the underrun's handler needs nothing that is set up
    // later.
    unsafe { interrupt::TIM6_DAC.enable() };
    // Counts from the first code on.
    let trigger = TriggerPins::start(board.trigger_timer, board.trigger, board.trigger_input);
    let reference_mv = Inputs::reference_mv();
    let inputs = Inputs::start(dac::fetched, board.sensors, board.sense_pins);
    let dac = Dac::start(board.dac, board.sample_timer, board.dac_stream, board.dac_pin);

    pin_lock::lock(embassy_stm32::pac::GPIOA, dac::PIN);
    watchdog::start();

    interrupt::UART5.set_priority(priority::RENDERER);
    let above = RENDERER_EXECUTOR.start(interrupt::UART5);
    let ports = Ports { dac, mute, trigger, button, cycles: Cycles, sense: inputs };
    if let Ok(task) = render(ports) {
        above.spawn(task);
    }

    let lamp = if boot.safe_mode {
        Some(Lamp::SafeMode)
    } else if !board::has_clock() {
        Some(Lamp::NoClock)
    } else if !has_mute_resistor {
        Some(Lamp::NoMuteResistor)
    } else if store::is_brown_out_guarded() {
        None
    } else {
        Some(Lamp::NoBrownOutLevel)
    };
    let store = Store::new(board.flash);

    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        if let Ok(task) = supervise(board.lamp, lamp) {
            spawner.spawn(task);
        }
        let (read, write) = start_link(spawner, board.link);
        let facts = Facts {
            has_mute_resistor,
            reference_mv,
            stop_input: FoundStopInput::Unused(board.stop_input),
            fault_end: boot.ordered.map(pin_watch::end_of),
        };
        if let Ok(task) = talk(read, write, boot, store, facts) {
            spawner.spawn(task);
        }
    })
}

/// Sets a state up before any task runs. Not inlined: the stack has room for one state at a time.
#[inline(never)]
fn set_up<T>(place: &'static Place<T>, state: impl FnOnce() -> T) {
    // SAFETY: no task runs yet.
    unsafe { &mut *place.0.get() }.write(state());
}

/// Starts DWT's free-running cycle counter (ARMv7-M, DWT_CYCCNT). It needs the trace unit, and a Cortex-M7 ignores
/// writes to that unit until its lock is opened (DWT_LAR); a debug probe opens it by itself.
fn start_cycle_counter() {
    // SAFETY: nothing else uses the debug peripherals; interrupts that read the counter are not enabled yet.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.DCB.enable_trace();
    DWT::unlock();
    core.DWT.enable_cycle_counter();
}

/// The renderer's ports on this board.
type Ports = RendererPorts<Dac, MutePin, TriggerPins, UserButton, Cycles, Inputs>;

/// Runs the renderer at interrupt priority; never ends.
#[embassy_executor::task]
async fn render(ports: Ports) {
    // SAFETY: `main` has set both up, and this is the only task that uses them; it runs once.
    let (renderer, listener) =
        unsafe { ((*RENDERER.0.get()).assume_init_mut(), (*LISTENER.0.get()).assume_init_mut()) };
    renderer.run(mailbox(), ports, listener).await;
}

#[embassy_executor::task]
async fn talk(read: FromHost, write: ToHost, boot: Boot, store: Store, facts: Facts) {
    // SAFETY: `main` has set it up, and this is the only task that uses it; it runs once.
    let candidate = unsafe { (*CANDIDATE.0.get()).assume_init_mut() };
    let mut link = Link::new(identity(), boot, store, facts, candidate, &CAPTURED);
    link.run(mailbox(), read, write).await;
}

/// This device's identity in the hello.
fn identity() -> Device {
    Device {
        board: board::NAME,
        build: env!("SLIPLINE_BUILD"),
        firmware: release::VERSION,
        unit: embassy_stm32::uid::uid(),
        simulated: false,
        sample_rate_hz: board::SAMPLE_RATE_HZ,
    }
}

/// Feeds the watchdog while thread side and interrupt side run, and mutes when one of them did not; shows the lamp's
/// pattern, and resets the count of crashes after a stable run.
#[embassy_executor::task]
async fn supervise(mut light: Output<'static>, standing: Option<Lamp>) {
    let mut supervisor = Supervisor::new();
    let mut is_stable = false;
    for step in 0u32.. {
        // Not a ticker: after an erasure of the flash it would make up for its turns at once, and the tasks would not have
        // run between them.
        Timer::after_millis(watchdog::SUPERVISION_MS.into()).await;
        if supervisor.may_feed(mailbox().pulses()) {
            watchdog::feed();
        } else {
            mute::off();
        }
        let lamp = standing.unwrap_or(if mute::is_on() { Lamp::Sounding } else { Lamp::Muted });
        light.set_level(lamp.is_lit(step).into());
        if !is_stable && Instant::now() >= Instant::from_millis(u64::from(STABLE_AFTER_MS)) {
            is_stable = true;
            crash::stable();
        }
    }
}

/// Looks at the sample index until it moves on, at most: each takes 10 cycles of the core or more, and a block 128 000 at most.
const INDEX_LOOKS: u32 = 20_000;

/// The core's cycle counter.
struct Cycles;

impl CycleCounter for Cycles {
    fn cycles(&mut self) -> u32 {
        DWT::cycle_count()
    }
}

/// What the start has found, the chip's ROM bootloader, and what its option bytes say.
struct Facts {
    has_mute_resistor: bool,
    reference_mv: u16,
    stop_input: FoundStopInput,
    /// How the ordered fault ended that has ended the last run.
    fault_end: Option<FaultEnd>,
}

/// The stop input's pin, and what the actuator's profile has made of it.
enum FoundStopInput {
    /// No profile is in force: the pin stays as the reset leaves it.
    Unused(Flex<'static>),
    /// None is fitted: an input that is pulled up.
    NotFitted(Flex<'static>),
    /// The mute timer's break.
    Fitted,
}

impl System for Facts {
    fn has_bootloader(&self) -> bool {
        true
    }

    fn has_trigger_input(&self) -> bool {
        true
    }

    fn is_brown_out_guarded(&self) -> bool {
        store::is_brown_out_guarded()
    }

    fn board(&self) -> BoardReport {
        let has_resistor = self.has_mute_resistor;
        BoardReport {
            core_hz: board::CORE_HZ,
            mute_resistor: if has_resistor { MuteResistor::Present } else { MuteResistor::Missing },
            user_button: button::state(),
            stop_input: match &self.stop_input {
                FoundStopInput::Unused(_) => StopInput::Unused,
                FoundStopInput::NotFitted(pin) if pin.is_low() => StopInput::NotInProfile,
                FoundStopInput::NotFitted(_) => StopInput::Unused,
                FoundStopInput::Fitted if mute::is_stop_input_high() => StopInput::Open,
                FoundStopInput::Fitted => StopInput::Closed,
            },
            trigger_input: self.has_trigger_input(),
            sample_clock: if board::has_clock() { SampleClock::Exact } else { SampleClock::Internal },
        }
    }

    fn analogue(&self) -> Analogue {
        let (chip, revision) = board::chip();
        Analogue {
            reference_mv: self.reference_mv,
            linear_per_mille: board::LINEAR_PER_MILLE,
            brown_out_level: Some(store::brown_out_level()),
            chip,
            revision,
            ram_errors: board::ram_errors(),
        }
    }

    fn mute_level(&self) -> PinLevel {
        mute::level()
    }

    fn try_mute(&mut self, trial: MuteTrial) -> Option<MuteFall> {
        mute::attempt(trial)
    }

    fn stall(&mut self) -> bool {
        dac::stall();
        true
    }

    fn clock(&self, now: &dyn Fn() -> SampleIndex) -> ClockReport {
        let before = now();
        // The renderer moves the index on, and the thread sees that when the renderer's turn is over.
        let at = (0..INDEX_LOOKS).map(|_| now()).find(|at| *at != before).unwrap_or(before);
        let cycles = DWT::cycle_count();
        ClockReport { at, cycles, usb: next_frame() }
    }

    fn fit_stop_input(&mut self, is_fitted: Option<bool>) {
        let found = core::mem::replace(&mut self.stop_input, FoundStopInput::Fitted);
        self.stop_input = match (found, is_fitted) {
            (found, None) => found,
            (FoundStopInput::Fitted, Some(_)) => FoundStopInput::Fitted,
            (FoundStopInput::Unused(mut pin) | FoundStopInput::NotFitted(mut pin), Some(false)) => {
                pin.set_as_input(Pull::Up);
                FoundStopInput::NotFitted(pin)
            }
            (FoundStopInput::Unused(pin) | FoundStopInput::NotFitted(pin), Some(true)) => {
                mute::fit_stop_input(pin);
                FoundStopInput::Fitted
            }
        };
    }

    fn brown_out(&self) -> Option<BrownOut> {
        Some(store::brown_out())
    }

    fn raise_brown_out_level(&mut self) -> Result<(), FlashError> {
        store::raise_brown_out_level()
    }

    fn restart(&mut self) {
        crash::silence();
        store::load_options();
        SCB::sys_reset();
    }

    fn fail(&mut self, fault: OrderedFault) {
        fault_trial::fail(fault);
    }

    fn fault_end(&self) -> Option<FaultEnd> {
        self.fault_end
    }

    fn enter_bootloader(&mut self) {
        bootloader::reset_into()
    }
}
