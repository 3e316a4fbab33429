//! The handlers of panics and faults, and the record that they leave for the next hello.
//!
//! Panic, processor fault, unexpected interrupt and stack overflow all end here, in this order: interrupts off,
//! amplifier muted, DAC to mid-scale (register writes alone), a record of the reason into RAM that no start-up code
//! clears, reset. They log nothing and wait for nothing: a fault handler that waits for a debugger would hang a device
//! that drives a coil.

use core::cell::UnsafeCell;
use core::fmt::Display;
use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use slipline_app::ResetCause;
use slipline_app::ports::OrderedFault;
use slipline_app::safety::boot::Boot;
use slipline_app::safety::crash::CrashRecord;

use crate::{board, dac, guard, mute, pin_watch, store};

/// The record's bytes. After power-on they are random, so they are always checked by their CRC.
#[repr(align(4))]
struct Kept(UnsafeCell<[u8; CrashRecord::BYTES]>);

// SAFETY: written at boot before any interrupt is enabled, by the supervisor in thread mode, and by handlers that
// have switched interrupts off and never return.
unsafe impl Sync for Kept {}

#[unsafe(link_section = ".uninit.crash")]
static KEPT: Kept = Kept(UnsafeCell::new([0; CrashRecord::BYTES]));

fn read() -> Option<CrashRecord> {
    // SAFETY: see `Kept`; any bytes are valid bytes. Volatile, because the content is not the initial value above.
    CrashRecord::decode(&unsafe { KEPT.0.get().read_volatile() })
}

fn write(record: &CrashRecord) {
    // SAFETY: see `Kept`.
    unsafe { KEPT.0.get().write_volatile(record.encode()) };
    // The H743's RAM has error correction over whole words: bytes wait in a buffer for the rest of their word, and a
    // reset loses them. Reading every word and writing it back brings them into the RAM; elsewhere it does nothing.
    let words = KEPT.0.get().cast::<u32>();
    for word in 0..CrashRecord::BYTES.div_ceil(size_of::<u32>()) {
        // SAFETY: see `Kept`, which begins at a word and whose size is a multiple of one: the last word is its own.
        unsafe { words.add(word).write_volatile(words.add(word).read_volatile()) };
    }
}

/// The reset's cause and what the last run recorded, for the application. Called once, at the start.
pub(crate) fn boot() -> Boot {
    let kept = read();
    // A dip of the supply ends in a software reset too; only the record distinguishes the two.
    let dipped = kept.as_ref().is_some_and(|record| record.cause == ResetCause::BrownOut);
    let hardware = match board::take_reset_flags().cause() {
        ResetCause::Software if dipped => ResetCause::BrownOut,
        cause => cause,
    };
    let (boot, keep) = slipline_app::safety::boot::decide(hardware, kept);
    write(&keep);
    boot
}

/// Resets the count of crashes, after a stable run.
pub(crate) fn stable() {
    if let Some(record) = read() {
        write(&record.stable());
    }
}

/// Marks a fault as ordered, which is about to end this run.
pub(crate) fn order(fault: OrderedFault) {
    write(&CrashRecord { ordered: Some(fault), ..read().unwrap_or_default() });
}

/// Switches interrupts off, mutes, and sets the DAC to mid-scale.
pub(crate) fn silence() {
    cortex_m::interrupt::disable();
    mute::off();
    dac::silence();
}

/// Records the cause, the message and the count of crashes in a row so far, and resets the chip.
fn end(cause: ResetCause, message: &dyn Display) -> ! {
    pin_watch::look_after_silence();
    let CrashRecord { resets, ordered, .. } = read().unwrap_or_default();
    write(&CrashRecord { ordered, ..CrashRecord::crashed(cause, resets, message) });
    SCB::sys_reset();
}

/// For a dip of the supply: mutes and resets.
pub(crate) fn reset_for_brown_out() -> ! {
    silence();
    end(ResetCause::BrownOut, &"")
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    silence();
    let message = info.message();
    match info.location() {
        // A text that does not fit is cut at its end, so the place of the panic comes first.
        Some(at) => end(ResetCause::Panic, &format_args!("{}:{} {message}", short(at.file()), at.line())),
        None => end(ResetCause::Panic, &message),
    }
}

/// The last two parts of a path.
fn short(path: &str) -> &str {
    let mut slashes = path.rmatch_indices('/');
    let _before_name = slashes.next();
    slashes.next().and_then(|(at, _)| path.get(at + 1..)).unwrap_or(path)
}

/// Handles every fault of the processor: the other fault handlers are not enabled, so their faults escalate to this
/// one.
///
/// Replaces cortex-m-rt's handler symbol. It first puts the stack pointer back to the top, because the fault may be
/// an exhausted stack (memory/*.x puts the stack at the lower end of its RAM); the handler never returns, so
/// nothing on the old stack is needed but the frame, whose address is handed on.
///
/// # Safety
/// Only the processor calls it.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    core::arch::naked_asm!(
        "mrs r0, msp",
        "ldr r1, =_stack_start",
        "msr msp, r1",
        "b {handler}",
        handler = sym hard_fault,
    )
}

unsafe extern "C" {
    /// Upper end of the stack's memory (memory/*.x).
    static _stack_start: u32;
}

extern "C" fn hard_fault(frame: u32) -> ! {
    silence();
    // SAFETY: the system control block is always there. CFSR says which fault it was, and MMFAR which address a guard has
    // refused (ARMv7-M B3.2.15, B3.2.17).
    let (status, address) = unsafe { ((*SCB::PTR).cfsr.read(), (*SCB::PTR).mmfar.read()) };
    let top = &raw const _stack_start as u32;
    if (guard::stack_bottom()..=top - 32).contains(&frame) && frame.is_multiple_of(4) {
        // SAFETY: the eight words of the exception frame lie inside the stack; word 6 is the return address.
        let pc = unsafe { (frame as *const u32).add(6).read_volatile() };
        let fault = guard::name_of(status, address, pc);
        end(ResetCause::HardFault, &format_args!("{fault} at {pc:#010x}, CFSR {status:#010x}"))
    }
    // The frame was not written, so the program's place is not known.
    end(
        ResetCause::HardFault,
        &format_args!("stack overflow, stack pointer {frame:#010x}, CFSR {status:#010x}"),
    )
}

/// The NMI: the crystal has stopped, or the flash has found a torn word (G474).
///
/// # Safety
/// Only the processor calls it.
#[unsafe(no_mangle)]
unsafe extern "C" fn NonMaskableInt() {
    if board::take_clock_failure() {
        // The break has muted the amplifier already. All clocks are slower now.
        silence();
        end(ResetCause::HardFault, &"the crystal has stopped")
    }
    if let Err(reason) = store::on_nmi() {
        silence();
        end(ResetCause::Panic, &reason)
    }
}

/// Handles an interrupt that has no handler of its own: it would be raised again without end.
///
/// # Safety
/// Only the processor calls it.
#[unsafe(no_mangle)]
unsafe extern "C" fn DefaultHandler() {
    silence();
    // SAFETY: as above. ICSR's lowest nine bits are the active exception; interrupts begin at 16 (ARMv7-M B3.2.4).
    let exception = unsafe { (*SCB::PTR).icsr.read() } & 0x1ff;
    end(ResetCause::HardFault, &format_args!("unexpected exception {exception}"))
}
