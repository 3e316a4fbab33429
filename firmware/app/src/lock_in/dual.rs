//! The dual product: two numbers of 16 bits in each word, multiplied pair by pair and added up.

/// The dual product, for one kind of processor.
pub(super) trait Dual {
    /// `sum` plus the product of the lower halves plus that of the upper halves, modulo 2^32.
    fn add(sum: i32, a: i32, b: i32) -> i32;
}

/// In Rust. It defines the result, and runs on hosts.
pub(super) struct Portable;

impl Dual for Portable {
    #[inline(always)]
    fn add(sum: i32, a: i32, b: i32) -> i32 {
        sum.wrapping_add(lower(a) * lower(b)).wrapping_add((a >> 16) * (b >> 16))
    }
}

/// The signed lower half of a packed word.
const fn lower(packed: i32) -> i32 {
    (packed << 16) >> 16
}

/// One instruction of a Cortex-M4 with its DSP extension. The compiler makes five of the portable form.
#[cfg(all(target_arch = "arm", target_os = "none"))]
pub(super) struct CortexM4;

#[cfg(all(target_arch = "arm", target_os = "none"))]
impl Dual for CortexM4 {
    #[inline(always)]
    #[expect(unsafe_code, reason = "assembly; listed in firmware/UNSAFE.md")]
    fn add(mut sum: i32, a: i32, b: i32) -> i32 {
        // SAFETY: one instruction that reads three registers and writes one; it touches no memory.
        unsafe {
            core::arch::asm!(
                "smlad {sum}, {a}, {b}, {sum}",
                sum = inout(reg) sum,
                a = in(reg) a,
                b = in(reg) b,
                options(pure, nomem, nostack),
            );
        }
        sum
    }
}

/// That of the processor that the crate is compiled for.
#[cfg(all(target_arch = "arm", target_os = "none"))]
pub(super) use self::CortexM4 as Native;
#[cfg(not(all(target_arch = "arm", target_os = "none")))]
pub(super) use self::Portable as Native;
