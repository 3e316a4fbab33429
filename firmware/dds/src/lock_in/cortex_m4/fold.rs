//! The fold of a block of codes.

use core::arch::naked_asm;

use super::super::fold::{CODE, FOUR_MID, Folds};
use crate::bank::BLOCK;

/// The totals of a block's codes.
#[derive(Default)]
#[repr(C)]
pub(super) struct Totals {
    /// The lowest of the codes of even number and of those of odd number, in either order.
    pub(super) lowest: [u16; 2],
    pub(super) highest: [u16; 2],
    /// The codes less mid-scale, summed up.
    pub(super) sum: i32,
}

/// The lowest in r5 and the highest in r6, with two more codes; uses lr.
macro_rules! span {
    ($codes:literal) => {
        concat!(
            "usub16 lr, ", $codes, ", r5\nsel r5, r5, ", $codes, "\n",
            "usub16 lr, ", $codes, ", r6\nsel r6, ", $codes, ", r6\n",
        )
    };
}

/// Two samples of each half of a pair of sub-blocks: the word `$above` the centres, and that `$below` them; to `$to`.
macro_rules! fold_words {
    ($above:literal, $below:literal, $to:literal) => {
        concat!(
            "ldr r9, [r0, #", $above, "]\nldr r10, [r0, #", $below, "]\n",
            "ldr r11, [r1, #", $above, "]\nldr r12, [r1, #", $below, "]\n",
            // What lies below comes in reverse order.
            "and r9, r9, r4\nand r10, r4, r10, ror #16\nand r11, r11, r4\nand r12, r4, r12, ror #16\n",
            span!("r9"), span!("r10"), span!("r11"), span!("r12"),
            "sadd16 lr, r9, r10\nssub16 r9, r9, r10\n",
            "sadd16 r10, r11, r12\nssub16 r11, r11, r12\n",
            "sadd16 r12, lr, r10\nssub16 lr, lr, r10\n",
            "ssub16 r12, r12, r8\n",
            "sadd16 r10, r9, r11\nssub16 r9, r9, r11\n",
            "smlad r7, r12, r8, r7\n",
            "str r12, [r2, #", $to, "]\nstr lr, [r2, #16 + ", $to, "]\n",
            "str r10, [r3, #", $to, "]\nstr r9, [r3, #16 + ", $to, "]\n",
        )
    };
}

/// About 670 cycles. r0 the later sub-block, r1 the earlier one, r2 the even folds, r3 the odd ones, r4 the mask, r8 four
/// times mid-scale, r7 the sum times that: 128 * 2048 * 8192 is 2^31, and only -2^31 can be reached.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn fold(codes: &[u16; BLOCK], folds: &mut Folds, totals: &mut Totals) {
    naked_asm!(
        ".fpu fpv4-sp-d16", // naked functions do not inherit the target's features
        "push {{r4-r11, lr}}",
        "vmov s0, r0",
        "vmov s1, r2",
        "add r3, r1, #128",
        "add r2, r1, #96",
        "add r1, r0, #96",
        "add r0, r0, #128",
        "movw r4, #{code}",
        "orr r4, r4, r4, lsl #16",
        "mov r5, r4",
        "mov r6, #0",
        "mov r7, #0",
        "movw r8, #{four_mid}",
        "orr r8, r8, r8, lsl #16",
        "2:",
        fold_words!("16", "12", "0"),
        fold_words!("20", "8", "4"),
        fold_words!("24", "4", "8"),
        fold_words!("28", "0", "12"),
        "vmov lr, s0",
        "sub r2, r2, #32",
        "add r3, r3, #32",
        "add r0, r0, #32",
        "cmp r1, lr",
        "sub r1, r1, #32",
        "bne 2b",
        "vmov r2, s1",
        "asr r7, r7, #13",
        "stm r2, {{r5, r6, r7}}",
        "pop {{r4-r11, pc}}",
        code = const CODE,
        four_mid = const FOUR_MID,
    )
}
