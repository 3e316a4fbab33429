//! The two guards: memory below the stack and memory at the null address, which nothing may touch.
//!
//! ```text
//!                        F407                        G474, H743
//! below the stack        0x0FFF8000 to 0x0FFFFFFF    0x1FFF8000 to 0x1FFFFFFF
//! at the null address    0 to 0x00000FFF             0 to 0x07FFFFFF
//! ```
//! The memory protection unit (ARMv7-M B3.5) refuses the access before it is made. It raises a MemManage fault; that fault
//! is not enabled (SHCSR.MEMFAULTENA = 0), so the hard fault's handler in `crash` gets it: mute, record, reset.
//!
//! Without them such an access may do its work unseen. Address 0 is SRAM1 on the F407, where `fast` has mapped it, the
//! flash on the G474, and the ITCM, a RAM, on the H743. Below the stack a bus reports an error only if nothing answers
//! there, and on a Cortex-M7 the error of a store comes late (imprecise).
//!
//! * PRIVDEFENA = 1: all other memory is as it is without the unit. Nothing here runs unprivileged.
//! * HFNMIENA = 0: the handlers of hard fault and NMI, and code under FAULTMASK, run without it, so they can end the
//!   program in any state. The processor reads vectors without it, too.
//! * An exception's frame that would lie in the guard is not written (CFSR.MSTKERR). The hard fault's handler still runs,
//!   and it begins with a new stack.
//! * The DMA does not pass the unit.

use cortex_m::peripheral::MPU;

/// Size of the guard below the stack in bytes: larger than any stack here, so no function's variables reach across it.
const BELOW_STACK: u32 = 32 * 1024;

// MPU_CTRL (ARMv7-M B3.5.5) and MPU_RASR (B3.5.9). No permission is AP = 000; the fields for caches stay 0, for nothing is
// read there.
const ENABLE: u32 = 1 << 0;
const PRIVDEFENA: u32 = 1 << 2;
const EXECUTE_NEVER: u32 = 1 << 28;
/// CFSR: MMFAR holds the address that was refused.
const MMARVALID: u32 = 1 << 7;

unsafe extern "C" {
    /// Lower end of the stack's memory (memory/*.x), a multiple of the guard's size.
    static _stack_end: u32;
    /// The first address above 0 that the program uses (memory/*.x), a power of two.
    static _null_end: u32;
}

/// The lowest address of the stack.
pub(crate) fn stack_bottom() -> u32 {
    &raw const _stack_end as u32
}

fn null_end() -> u32 {
    &raw const _null_end as u32
}

/// Puts the guards up. Call it when the ROM bootloader is not wanted.
pub(crate) fn start() {
    let guards = [(stack_bottom() - BELOW_STACK, BELOW_STACK), (0, null_end())];
    // SAFETY: nothing else uses these registers. The program has neither code nor data in the guards (memory/*.x), and
    // all other memory stays as it was.
    unsafe {
        let mpu = &*MPU::PTR;
        // Off, and every region too, in case the ROM has started the program by a jump.
        mpu.ctrl.write(0);
        for number in 0..mpu._type.read() >> 8 & 0xff {
            mpu.rnr.write(number);
            let (start, attributes) = match guards.get(number as usize) {
                // A region has 2^(SIZE + 1) bytes.
                Some((start, bytes)) => (*start, EXECUTE_NEVER | (bytes.ilog2() - 1) << 1 | ENABLE),
                None => (0, 0),
            };
            mpu.rasr.write(0);
            mpu.rbar.write(start);
            mpu.rasr.write(attributes);
        }
        mpu.ctrl.write(PRIVDEFENA | ENABLE);
    }
    // In force for the next access and the next fetch (ARMv7-M B3.5.4).
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// The name of a fault, by CFSR, MMFAR and the return address, which for a refused fetch is the address itself.
pub(crate) fn name_of(status: u32, address: u32, pc: u32) -> &'static str {
    let touched = if status & MMARVALID != 0 { address } else { pc };
    if touched < null_end() {
        "null pointer"
    } else if (stack_bottom() - BELOW_STACK..stack_bottom()).contains(&touched) {
        "stack overflow"
    } else {
        "fault"
    }
}
