//! A block of all tones: where each stands, its basis, the products, and their turn to its phase.
//!
//! About 380 cycles a tone and input, and 140 for a new basis.

use core::arch::naked_asm;

use super::super::basis::{MEAN, MIDDLE, THETA};
use super::super::kernel::Block;
use crate::bank::cortex_m4::sine_cosine;
use crate::bank::sine::{RADIANS, TABLE};

/// The next of a chain: `$before` becomes `2 cos(1) $at - $before`; uses r3.
macro_rules! next {
    ($before:literal, $at:literal) => {
        concat!("smmulr r3, ", $at, ", r5\n", "rsb ", $before, ", ", $before, ", r3, lsl #2\n")
    };
}

/// `$near` and `$far` with 14 fractional bits, rounded, as one word. The upper halves have 15, rounded down.
macro_rules! basis_word {
    ($word:literal, $far:literal, $near:literal) => {
        concat!(
            "pkhtb ", $word, ", ", $far, ", ", $near, ", asr #16\n",
            "shadd16 ", $word, ", ", $word, ", r4\n",
        )
    };
}

/// The four words of a chain that has `$first` and r2.
macro_rules! basis_words {
    ($first:literal) => {
        concat!(
            basis_word!("r9", "r2", $first),
            next!($first, "r2"), next!("r2", $first), basis_word!("r10", "r2", $first),
            next!($first, "r2"), next!("r2", $first), basis_word!("r11", "r2", $first),
            next!($first, "r2"), next!("r2", $first), basis_word!("r12", "r2", $first),
            "stm r1!, {{r9, r10, r11, r12}}\n",
        )
    };
}

/// The cosine of twice the angle of r8 and lr, to r5.
macro_rules! cosine_of_double {
    () => {
        "smmulr r5, lr, lr\nsmmlsr r5, r8, r8, r5\nlsl r5, r5, #1\n"
    };
}

/// The next four words of the folds times the basis's, r4-r7, to r0.
macro_rules! products {
    () => {
        concat!(
            "ldm r1!, {{r0, r2, r3, r12}}\n",
            "smuad r0, r0, r4\nsmlad r0, r2, r5, r0\nsmlad r0, r3, r6, r0\nsmlad r0, r12, r7, r0\n",
        )
    };
}

/// An even pair, turned by the cosine `$cosine` and the sine `$sine`, to the real sum r8 and the imaginary one r9.
macro_rules! even_pair {
    (set $cosine:literal, $sine:literal) => {
        concat!(
            products!(), "vmov lr, ", $cosine, "\nsmmulr r8, r0, lr\n",
            products!(), "vmov lr, ", $sine, "\nsmmulr r9, r0, lr\n",
        )
    };
    (add $cosine:literal, $sine:literal) => {
        concat!(
            products!(), "vmov lr, ", $cosine, "\nsmmlar r8, r0, lr, r8\n",
            products!(), "vmov lr, ", $sine, "\nsmmlar r9, r0, lr, r9\n",
        )
    };
}

/// An odd pair.
macro_rules! odd_pair {
    ($cosine:literal, $sine:literal) => {
        concat!(
            products!(), "vmov lr, ", $cosine, "\nsmmlar r9, r0, lr, r9\n",
            products!(), "vmov lr, ", $sine, "\nsmmlsr r8, r0, lr, r8\n",
        )
    };
}

/// The sums of a block, real r8 and imaginary r9, turned to the tone's phase and added to the totals at `$totals`. r2, r3, r12
/// and lr: sine, cosine, `theta` and the weight.
macro_rules! turn_and_add {
    ($totals:literal) => {
        concat!(
            "smmul r10, r8, r2\nsmmla r10, r9, r3, r10\n",
            "smmul r11, r8, r3\nsmmls r11, r9, r2, r11\n",
            "ldm ", $totals, ", {{r4, r5, r6, r7}}\n",
            "smlal r4, r5, r10, lr\nsmlal r6, r7, r11, lr\n",
            "stm ", $totals, ", {{r4, r5, r6, r7}}\n",
        )
    };
}

/// `follow` of `portable.rs`.
///
/// With `Y_j` of the pairs, `D = 2 V - 5 X` and `V = sum j (j + 1) / 2 Y_j`. That is a sum of sums: of the even folds,
/// whose pairs come from the outermost inwards, `3 T_3 + 2 T_2 + T_1`, `T_j` the sum up to pair `j`. The odd folds come
/// from the innermost outwards: theirs is `6 X - (T_0 + 2 T_1 + 3 T_2)`, all counted on from the end of the even ones.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn follow(block: *mut Block<'_, 1>) -> u32 {
    // s0-s7 rotors; s8 the follower, s9 a place in the sums, s10 sine, s11 cosine, s12 the slot and later the inputs to come,
    // s13 theta, s14 the weight, s15 the mean phase; s16 TABLE, s17 RADIANS, s18 MEAN, s19 THETA, s20 the slots to come, s21
    // those that are followed, s22 the block, s23 its `jumps`.
    naked_asm!(
        ".fpu fpv4-sp-d16",
        "push {{r4-r11, lr}}",
        "vpush {{s16-s23}}",
        "movw r1, #:lower16:{table}",
        "movt r1, #:upper16:{table}",
        "vmov s16, r1",
        "movw r1, #{radians} & 0xFFFF",
        "movt r1, #{radians} >> 16",
        "vmov s17, r1",
        "movw r1, #{mean} & 0xFFFF",
        "movt r1, #{mean} >> 16",
        "vmov s18, r1",
        "movw r1, #{theta} & 0xFFFF",
        "movt r1, #{theta} >> 16",
        "vmov s19, r1",
        // The first input's sums and folds: both are 256 bytes.
        "ldr r1, [r0, #36]",
        "ldr r2, [r0, #12]",
        "ldr r3, [r0, #16]",
        "add r2, r2, r1, lsl #8",
        "add r3, r3, r1, lsl #8",
        "str r2, [r0, #12]",
        "str r3, [r0, #16]",
        "ldr r1, [r0, #24]",
        "ldr r2, [r0, #28]",
        "ldr r3, [r0, #32]",
        "vmov s14, r1",
        "vmov s20, r2",
        "vmov s21, r2",
        "vmov s22, r0",
        "vmov s23, r3",
        "2:",
        "vmov r0, s20",
        "cmp r0, #0",
        "beq 9f",
        "rbit lr, r0",
        "clz lr, lr",
        "sub r1, r0, #1",
        "and r0, r0, r1",
        "vmov s20, r0",
        "vmov s12, lr",
        "vmov r3, s22",
        "ldm r3, {{r0, r1, r2}}",
        "add r0, r0, lr, lsl #5",
        "mov r12, #88",
        "mla r1, lr, r12, r1",
        "add r2, r2, lr, lsl #4",
        "vmov s8, r1",
        "vmov s9, r2",
        // Phase, step, step_end, amplitude, amplitude_end.
        "ldm r0, {{r2, r3, r4, r5, r6, r7, r8, r9}}",
        "ldr r10, [r1]",
        "ldr r11, [r1, #4]",
        "orrs r8, r8, r9",
        "beq 8f",
        "eor r10, r10, r2",
        "eor r11, r11, r3",
        "orr r10, r10, r11",
        "vmov r11, s23",
        "tst r10, r11",
        "bne 8f",
        // Where it ends: 64 (step + step_end) on.
        "adds r10, r4, r6",
        "adc r11, r5, r7",
        "lsl r11, r11, #6",
        "orr r11, r11, r10, lsr #26",
        "adds r2, r2, r10, lsl #6",
        "adc r11, r3, r11",
        "str r2, [r1], #4",
        "str r11, [r1], #4",
        // The change, in 2^-40 turns.
        "subs r6, r6, r4",
        "sbc r7, r7, r5",
        "ssat r7, #23, r7",
        "lsl r7, r7, #8",
        "orr r7, r7, r6, lsr #24",
        // The mean phase, the step in the middle, and theta.
        "lsl r9, r5, #6",
        "orr r9, r9, r4, lsr #26",
        "add r3, r3, r9",
        "sub r3, r3, r5, lsr #1",
        "vmov r9, s18",
        "smmla r3, r7, r9, r3",
        "vmov s15, r3",
        "mov r9, #{middle}",
        "smmla r0, r7, r9, r5",
        "vmov r9, s19",
        "smmul r9, r7, r9",
        "vmov s13, r9",
        "vmov r6, s16",
        "vmov r7, s17",
        "ldr r9, [r1, #72]",
        "mvn r3, r0",
        "cmp r3, r9",
        "beq 3f",
        // `rebuild` of `basis.rs`.
        "str r3, [r1, #72]",
        "mov r4, #0x00010001",
        "lsr r2, r0, #1",
        sine_cosine!("r2", "r6", "r7", "r8", "lr", "r9", "r10", "r11", "r12"),
        cosine_of_double!(),
        "sub lr, lr, lr, asr #14",
        "sub r8, r8, r8, asr #14",
        "smmulr r3, lr, r5",
        "rsb r2, lr, r3, lsl #2",
        basis_words!("lr"),
        // The constant, for which the sum of the cosines stands.
        "smuad lr, r9, r4",
        "smlad lr, r10, r4, lr",
        "smlad lr, r11, r4, lr",
        "smlad lr, r12, r4, lr",
        "lsl lr, lr, #12",
        "vmov s0, lr",
        "smmulr r3, r8, r5",
        "add r2, r8, r3, lsl #2",
        basis_words!("r8"),
        // The rotors.
        "lsl r2, r0, #3",
        sine_cosine!("r2", "r6", "r7", "r8", "lr", "r9", "r10", "r11", "r12"),
        cosine_of_double!(),
        "asr r9, lr, #2",
        "asr r8, r8, #2",
        "smmulr r10, r9, r5",
        "rsb r10, r9, r10, lsl #2",
        "smmulr r11, r10, r5",
        "rsb r11, r9, r11, lsl #2",
        "smmulr r12, r11, r5",
        "rsb r12, r10, r12, lsl #2",
        "stm r1!, {{r9, r10, r11, r12}}",
        "vmov r4, s0",
        "smmulr r9, r9, r4",
        "smmulr r10, r10, r4",
        "smmulr r11, r11, r4",
        "smmulr r12, r12, r4",
        "add lr, r12, r12, lsl #1",
        "add r12, r12, r11",
        "add lr, lr, r12, lsl #1",
        "add r12, r12, r10",
        "add lr, lr, r12",
        "add r12, r12, r9",
        "add r4, r12, r12, lsl #2",
        "rsb lr, r4, lr, lsl #1",
        "smmulr r9, r8, r5",
        "add r9, r8, r9, lsl #2",
        "smmulr r10, r9, r5",
        "rsb r10, r8, r10, lsl #2",
        "smmulr r11, r10, r5",
        "rsb r11, r9, r11, lsl #2",
        "stm r1, {{r8, r9, r10, r11, r12, lr}}",
        "3:",
        // Where the tone stands.
        "vmov r0, s15",
        sine_cosine!("r0", "r6", "r7", "r2", "r3", "r9", "r10", "r11", "r12"),
        "vmov r12, s13",
        "smmul r9, r12, r12",
        "mov r10, #21",
        "mul r9, r9, r10",
        "asr r9, r9, #1",
        "smmls r2, r2, r9, r2",
        "smmls r3, r3, r9, r3",
        "vmov s10, r2",
        "vmov s11, r3",
        // The constant.
        "vmov r1, s8",
        "vmov r0, s9",
        "vmov lr, s14",
        "ldr r8, [r1, #72]",
        "ldr r9, [r1, #76]",
        "smmul r9, r9, r12",
        turn_and_add!("r0"),
        // The inputs.
        "vmov r4, s22",
        "ldr r2, [r4, #12]",
        "ldr r1, [r4, #16]",
        "ldr r3, [r4, #20]",
        "vmov lr, s12",
        "vmov r0, s8",
        "cmp r3, #0",
        "beq 2b",
        "vmov s12, r3",
        "add r2, r2, lr, lsl #4",
        "vmov s9, r2",
        "add r3, r0, #40",
        "vldmia r3, {{s0-s7}}",
        "add r0, r0, #8",
        "4:",
        "ldm r0!, {{r4, r5, r6, r7}}",
        "vmov s8, r0",
        even_pair!(set "s3", "s7"),
        "add r10, r8, r8, lsl #1",
        "add r11, r9, r9, lsl #1",
        even_pair!(add "s2", "s6"),
        "add r10, r10, r8, lsl #1",
        "add r11, r11, r9, lsl #1",
        even_pair!(add "s1", "s5"),
        "add r10, r10, r8",
        "add r11, r11, r9",
        even_pair!(add "s0", "s4"),
        "vmov r0, s8",
        "ldm r0, {{r4, r5, r6, r7}}",
        odd_pair!("s0", "s4"),
        "sub r10, r10, r8",
        "sub r11, r11, r9",
        odd_pair!("s1", "s5"),
        "sub r10, r10, r8, lsl #1",
        "sub r11, r11, r9, lsl #1",
        odd_pair!("s2", "s6"),
        "sub r10, r10, r8",
        "sub r11, r11, r9",
        "sub r10, r10, r8, lsl #1",
        "sub r11, r11, r9, lsl #1",
        odd_pair!("s3", "s7"),
        // 2 (V - 6 X) + 7 X
        "rsb r0, r8, r8, lsl #3",
        "rsb r2, r9, r9, lsl #3",
        "add r10, r0, r10, lsl #1",
        "add r11, r2, r11, lsl #1",
        "vmov r12, s13",
        "smmls r8, r11, r12, r8",
        "smmla r9, r10, r12, r9",
        "vmov r2, s10",
        "vmov r3, s11",
        "vmov lr, s14",
        "vmov r0, s9",
        turn_and_add!("r0"),
        // The next input: its folds come next.
        "vmov r3, s12",
        "subs r3, r3, #1",
        "beq 2b",
        "vmov s12, r3",
        "add r0, r0, #16 * 16",
        "vmov s9, r0",
        "vmov r0, s8",
        "sub r0, r0, #16",
        "b 4b",
        // Silent, or not where it was left.
        "8:",
        "vmov r0, s21",
        "mov r1, #1",
        "lsl r1, r1, lr",
        "bic r0, r0, r1",
        "vmov s21, r0",
        "b 2b",
        "9:",
        "vmov r0, s21",
        "vpop {{s16-s23}}",
        "pop {{r4-r11, pc}}",
        table = sym TABLE,
        radians = const RADIANS,
        mean = const MEAN,
        middle = const MIDDLE,
        theta = const THETA,
    )
}
