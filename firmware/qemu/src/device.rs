//! The application on two interrupt executors, with UART0 as link, UART1 as DAC and TIMER0 as sample clock.

use core::convert::Infallible;
use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use core::task::Poll;

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::{entry, exception};
use embassy_executor::InterruptExecutor;
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{ErrorType, Read, Write};
use slipline_app::BLOCK;
use slipline_app::listening::capture::Values;
use slipline_app::listening::listener::Listener;
use slipline_app::planning::chord::Candidate;
use slipline_app::ports::{DacStream, HasMuted, Mute, NoFlash, RendererPorts, System, Underrun};
use slipline_app::{Boot, Device, Link, Mailbox, Renderer, Timing, release};

use crate::cmsdk::{TIMER0_INTERRUPT, UART0, UART0_RECEIVE, UART1, UART1_RECEIVE, clear_timer, start_timer};

/// As on the boards.
const SAMPLE_RATE_HZ: u32 = 400_000;
/// The clock of the board's timer.
const BOARD_HZ: u32 = 25_000_000;
/// 8000, exactly.
const TICKS_PER_BLOCK: u32 = BOARD_HZ / (SAMPLE_RATE_HZ / BLOCK as u32);

static MAILBOX: Mailbox<CriticalSectionRawMutex> = Mailbox::new();
/// The captured values.
static CAPTURED: Values = Values::new();

/// Interrupts of this board that no peripheral uses; the executors run in them, at their priorities.
const RENDERER_INTERRUPT: i16 = 30;
const LINK_INTERRUPT: i16 = 31;

/// An interrupt.
#[derive(Clone, Copy)]
struct Vector(i16);

// SAFETY: made from this board's interrupt numbers only, which are below the processor's number of interrupts (32 on this board);
// each stands for one vector.
unsafe impl InterruptNumber for Vector {
    fn number(self) -> u16 {
        self.0.unsigned_abs()
    }
}

static RENDERER: InterruptExecutor = InterruptExecutor::new();
static LINK: InterruptExecutor = InterruptExecutor::new();

/// Priorities. This processor has eight levels, in the upper three bits; the lower number is served first.
const CLOCK_PRIORITY: u8 = 1 << 5;
const RENDERER_PRIORITY: u8 = 2 << 5;
const RECEIVE_PRIORITY: u8 = 3 << 5;
const LINK_PRIORITY: u8 = 4 << 5;

#[entry]
fn main() -> ! {
    UART0.start();
    UART1.start();
    // SAFETY: no interrupt is enabled yet; nothing else holds the core's peripherals.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    for (interrupt, priority) in [
        (TIMER0_INTERRUPT, CLOCK_PRIORITY),
        (UART0_RECEIVE, RECEIVE_PRIORITY),
        (UART1_RECEIVE, RECEIVE_PRIORITY),
        (RENDERER_INTERRUPT, RENDERER_PRIORITY),
        (LINK_INTERRUPT, LINK_PRIORITY),
    ] {
        // SAFETY: priorities are set before the interrupts are enabled.
        unsafe { core.NVIC.set_priority(Vector(interrupt), priority) };
    }
    let render = RENDERER.start(Vector(RENDERER_INTERRUPT));
    let link = LINK.start(Vector(LINK_INTERRUPT));
    for interrupt in [TIMER0_INTERRUPT, UART0_RECEIVE, UART1_RECEIVE] {
        // SAFETY: the handlers use statics only.
        unsafe { NVIC::unmask(Vector(interrupt)) };
    }
    if let (Ok(renderer), Ok(talk)) = (run_renderer(), run_link()) {
        render.spawn(renderer);
        link.spawn(talk);
    }
    start_timer(TICKS_PER_BLOCK);
    // Nothing runs in thread mode: the emulator's clock advances while the processor sleeps.
    loop {
        cortex_m::asm::wfi();
    }
}

/// Handles every interrupt: cortex-m-rt fills the vectors of a board that it does not know with this handler.
#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    match interrupt {
        TIMER0_INTERRUPT => {
            clear_timer();
            BLOCKS_DUE.fetch_add(1, Relaxed);
            CLOCK.wake();
        }
        UART0_RECEIVE => {
            while !INBOX.is_full() {
                let Some(byte) = UART0.receive() else { return };
                // There is room: only this handler writes.
                let _written = INBOX.try_write(&[byte]);
            }
            // The reader switches the interrupt on again.
            UART0.listen(false);
        }
        UART1_RECEIVE => {
            while let Some(blocks) = UART1.receive() {
                SHOWN_BLOCKS.fetch_add(u32::from(blocks), Relaxed);
            }
        }
        // SAFETY: called from the executor's own interrupt, which `start` has enabled.
        RENDERER_INTERRUPT => unsafe { RENDERER.on_interrupt() },
        // SAFETY: as above.
        LINK_INTERRUPT => unsafe { LINK.on_interrupt() },
        other => panic!("unexpected interrupt {other}"),
    }
}

#[embassy_executor::task]
async fn run_renderer() {
    let mut renderer = Renderer::new(Timing::at(SAMPLE_RATE_HZ));
    let mut listener = Listener::starting_at(0, &CAPTURED);
    let dac = ShownDac { first: 0 };
    let ports = RendererPorts { dac, mute: NoAmplifier, trigger: (), button: (), cycles: (), sense: () };
    renderer.run(&MAILBOX, ports, &mut listener).await;
}

#[embassy_executor::task]
async fn run_link() {
    let device = Device {
        board: "mps2-an386 (emulated)",
        build: env!("CARGO_PKG_VERSION"),
        firmware: release::VERSION,
        unit: *b"emulated-001",
        simulated: true,
        sample_rate_hz: SAMPLE_RATE_HZ,
    };
    let mut candidate = Candidate::new();
    let mut link = Link::new(device, Boot::cold(), NoFlash, NoBootloader, &mut candidate, &CAPTURED);
    link.run(&MAILBOX, UartRead, UartWrite).await;
}

/// Blocks that the sample clock has asked for and that have not been written.
static BLOCKS_DUE: AtomicU32 = AtomicU32::new(0);
static CLOCK: AtomicWaker = AtomicWaker::new();
/// Blocks still to be sent to UART1. The value of each byte received there is added. Codes are sent on demand only,
/// because every byte costs the emulator a system call.
static SHOWN_BLOCKS: AtomicU32 = AtomicU32::new(0);

/// A DAC that takes one block per interrupt of the timer. On demand it sends the block to UART1: the index of the first
/// code in eight bytes, then the codes in two bytes each, all little-endian.
struct ShownDac {
    first: u64,
}

impl DacStream for ShownDac {
    async fn room(&mut self) {
        poll_fn(|context| {
            CLOCK.register(context.waker());
            if BLOCKS_DUE.load(Relaxed) > 0 { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
    }

    async fn write_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        self.room().await;
        // This DAC reports no underrun: it loses no sample while the host computer does not run the emulator.
        BLOCKS_DUE.fetch_sub(1, Relaxed);
        if SHOWN_BLOCKS.load(Relaxed) > 0 {
            SHOWN_BLOCKS.fetch_sub(1, Relaxed);
            UART1.send(&self.first.to_le_bytes());
            for code in codes {
                UART1.send(&code.to_le_bytes());
            }
        }
        self.first += BLOCK as u64;
        Ok(())
    }

    /// A block is shown at once.
    fn is_revisable(&self) -> bool {
        false
    }

    fn revise_block(&mut self, _: &[u16; BLOCK]) -> Result<(), Underrun> {
        Err(Underrun)
    }
}

/// This board has no amplifier to mute.
struct NoAmplifier;

impl Mute for NoAmplifier {
    fn set_muted(&mut self, _: bool) {}

    fn stay_on(&mut self) -> Result<(), HasMuted> {
        Ok(())
    }
}

/// This board has no ROM bootloader and no brown-out level.
struct NoBootloader;

impl System for NoBootloader {
    fn has_bootloader(&self) -> bool {
        false
    }

    fn has_trigger_input(&self) -> bool {
        false
    }

    fn is_brown_out_guarded(&self) -> bool {
        true
    }

    fn enter_bootloader(&mut self) {}
}

/// Bytes received on UART0 that the link has not read.
static INBOX: Pipe<CriticalSectionRawMutex, 256> = Pipe::new();

struct UartRead;

impl ErrorType for UartRead {
    type Error = Infallible;
}

impl Read for UartRead {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let count = INBOX.read(buffer).await;
        UART0.listen(true);
        // A byte that came while the interrupt was off has raised none, and no other comes before it is taken.
        NVIC::pend(Vector(UART0_RECEIVE));
        Ok(count)
    }
}

struct UartWrite;

impl ErrorType for UartWrite {
    type Error = Infallible;
}

impl Write for UartWrite {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        // If the host does not read, the link drops the reply after its time limit.
        let sent = loop {
            match bytes.iter().take_while(|&&byte| UART0.try_send(byte)).count() {
                0 if !bytes.is_empty() => yield_now().await,
                sent => break sent,
            }
        };
        Ok(sent)
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Sends the message to UART1 as text, which no test takes for codes, and stops.
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    struct Show;
    impl core::fmt::Write for Show {
        fn write_str(&mut self, text: &str) -> core::fmt::Result {
            UART1.send(text.as_bytes());
            Ok(())
        }
    }
    cortex_m::interrupt::disable();
    let _shown = core::fmt::write(&mut Show, format_args!("{info}"));
    loop {
        cortex_m::asm::wfi();
    }
}
