//! The kernels in the assembly of a Cortex-M4 with its DSP and floating-point extensions (M7 runs it too).
//!
//! The floating-point registers are used as storage only: nothing here computes with floats.
//!
//! Each function is *naked*: the register allocation above is the whole register file, which inline assembly may not
//! claim. They follow the procedure call standard: r4-r11, lr and s16-s31 are saved, the stack stays balanced, no
//! other memory is written than the output block and the function's own frame.

use core::arch::{asm, naked_asm};

use super::{GlideBasis, GlideSeeds, Kernel, SteadyBasis, SteadySeeds};
use crate::bank::BLOCK;
use crate::bank::code::MAX_CODE;

/// The kernels in assembly.
pub(in crate::bank) struct CortexM4;

impl Kernel for CortexM4 {
    fn steady(basis: &SteadyBasis, seeds: &SteadySeeds, out: &mut [i32; BLOCK]) {
        // SAFETY: the function reads exactly the two structures and writes exactly the block, as their types say.
        unsafe { steady(basis, seeds, out) }
    }

    fn glide(basis: &GlideBasis, seeds: &GlideSeeds, out: &mut [i32; BLOCK]) {
        // SAFETY: as above.
        unsafe { glide(basis, seeds, out) }
    }

    fn codes(samples: &[i32; BLOCK], out: &mut [u16; BLOCK]) -> bool {
        const { assert!(MAX_CODE == 4095, "the instruction below saturates to 12 bits") };
        let clamped: u32;
        // SAFETY: 32 rounds read four samples and write four codes each: 128 of both. The only flags changed are
        // those of the comparison and Q, which no compiled code relies on.
        unsafe {
            asm!(
                "msr apsr_nzcvq, {zero}",
                "2:",
                "ldm {from}!, {{r2, r3, r4, r5}}",
                "smmlar r2, r2, {scale}, {mid}",
                "smmlar r3, r3, {scale}, {mid}",
                "smmlar r4, r4, {scale}, {mid}",
                "smmlar r5, r5, {scale}, {mid}",
                "usat r2, #12, r2",
                "usat r3, #12, r3",
                "usat r4, #12, r4",
                "usat r5, #12, r5",
                "pkhbt r2, r2, r3, lsl #16",
                "pkhbt r4, r4, r5, lsl #16",
                "str r4, [{to}, #4]",
                "str r2, [{to}], #8",
                "cmp {from}, {end}",
                "bne 2b",
                "mrs {zero}, apsr",
                zero = inout(reg) 0_u32 => clamped,
                from = inout(reg) samples.as_ptr() => _,
                end = in(reg) samples.as_ptr().wrapping_add(BLOCK),
                to = inout(reg) out.as_mut_ptr() => _,
                scale = in(reg) crate::bank::code::CODES_PER_UNIT,
                mid = in(reg) u32::from(crate::bank::code::MID_SCALE),
                out("r2") _, out("r3") _, out("r4") _, out("r5") _,
                options(nostack),
            );
        }
        clamped & (1 << 27) != 0
    }
}

/// The products of one tone, four words with two coefficients: `add`ed to the eight sums, or the sums `set` to them.
macro_rules! tone {
    ($first:literal, $second:literal, add $op:literal) => {
        concat!(
            "ldm r0!, {{r9, r10, r11, r12}}\n",
            "vmov lr, s",
            $first,
            "\n",
            $op,
            " r1, r9, lr, r1\n",
            $op,
            " r2, r10, lr, r2\n",
            $op,
            " r3, r11, lr, r3\n",
            $op,
            " r4, r12, lr, r4\n",
            "vmov lr, s",
            $second,
            "\n",
            $op,
            " r5, r9, lr, r5\n",
            $op,
            " r6, r10, lr, r6\n",
            $op,
            " r7, r11, lr, r7\n",
            $op,
            " r8, r12, lr, r8\n",
        )
    };
    ($first:literal, $second:literal, set $op:literal) => {
        concat!(
            "ldm r0!, {{r9, r10, r11, r12}}\n",
            "vmov lr, s",
            $first,
            "\n",
            $op,
            " r1, r9, lr\n",
            $op,
            " r2, r10, lr\n",
            $op,
            " r3, r11, lr\n",
            $op,
            " r4, r12, lr\n",
            "vmov lr, s",
            $second,
            "\n",
            $op,
            " r5, r9, lr\n",
            $op,
            " r6, r10, lr\n",
            $op,
            " r7, r11, lr\n",
            $op,
            " r8, r12, lr\n",
        )
    };
}

/// The products of the second to the last tone.
macro_rules! other_tones {
    ($op:literal) => {
        concat!(
            tone!("2", "3", add $op), tone!("4", "5", add $op), tone!("6", "7", add $op),
            tone!("8", "9", add $op), tone!("10", "11", add $op), tone!("12", "13", add $op),
            tone!("14", "15", add $op), tone!("16", "17", add $op), tone!("18", "19", add $op),
            tone!("20", "21", add $op), tone!("22", "23", add $op), tone!("24", "25", add $op),
            tone!("26", "27", add $op), tone!("28", "29", add $op), tone!("30", "31", add $op),
        )
    };
}

/// With `E` of four samples at `[r0, above]` and `O` in four registers: writes `E + O` there and `E - O`, in reverse
/// order, at `[lr, below]`.
macro_rules! unfold {
    ($o0:literal, $o1:literal, $o2:literal, $o3:literal, $at:literal) => {
        concat!(
            "ldr r9, [r0, #",
            $at,
            "]\nldr r10, [r0, #",
            $at,
            " + 4]\n",
            "ldr r11, [r0, #",
            $at,
            " + 8]\nldr r12, [r0, #",
            $at,
            " + 12]\n",
            "add ",
            $o0,
            ", ",
            $o0,
            ", r9\nadd ",
            $o1,
            ", ",
            $o1,
            ", r10\n",
            "add ",
            $o2,
            ", ",
            $o2,
            ", r11\nadd ",
            $o3,
            ", ",
            $o3,
            ", r12\n",
            // E - O = 2 E - (E + O)
            "rsb r9, ",
            $o0,
            ", r9, lsl #1\nrsb r10, ",
            $o1,
            ", r10, lsl #1\n",
            "rsb r11, ",
            $o2,
            ", r11, lsl #1\nrsb r12, ",
            $o3,
            ", r12, lsl #1\n",
            "str ",
            $o0,
            ", [r0, #",
            $at,
            "]\nstr ",
            $o1,
            ", [r0, #",
            $at,
            " + 4]\n",
            "str ",
            $o2,
            ", [r0, #",
            $at,
            " + 8]\nstr ",
            $o3,
            ", [r0, #",
            $at,
            " + 12]\n",
            "str r12, [lr, #",
            $at,
            "]\nstr r11, [lr, #",
            $at,
            " + 4]\n",
            "str r10, [lr, #",
            $at,
            " + 8]\nstr r9, [lr, #",
            $at,
            " + 12]\n",
        )
    };
}

/// Writes the eight sums to `[r9]`, four per sub-block.
macro_rules! store_sums {
    ($second:literal) => {
        concat!(
            "str r1, [r9]\nstr r2, [r9, #4]\nstr r3, [r9, #8]\nstr r4, [r9, #12]\n",
            "str r5, [r9, #",
            $second,
            "]\nstr r6, [r9, #",
            $second,
            " + 4]\n",
            "str r7, [r9, #",
            $second,
            " + 8]\nstr r8, [r9, #",
            $second,
            " + 12]\n",
        )
    };
}

// Frame of `steady`: [sp] where E and later E + O of the next group go, [sp, #4] where its E - O go, [sp, #8] the odd
// seeds, [sp, #12] the words' address while r0 is needed, [sp, #16] the end of the first.
#[unsafe(naked)]
unsafe extern "C" fn steady(basis: &SteadyBasis, seeds: &SteadySeeds, out: &mut [i32; BLOCK]) {
    naked_asm!(
        ".fpu fpv4-sp-d16", // naked functions do not inherit the target's features
        "push {{r4-r11, lr}}",
        "vpush {{s16-s31}}",
        "sub sp, sp, #20",
        "add r3, r2, #128", // E and E + O of the first group: samples 32..36 and 96..100
        "str r3, [sp]",
        "add r4, r2, #112", // E - O: samples 28..32 and 92..96, backwards
        "str r4, [sp, #4]",
        "add r4, r2, #256",
        "str r4, [sp, #16]",
        "vldmia r1!, {{s0-s31}}",
        "str r1, [sp, #8]",
        "2:",
        tone!("0", "1", set "smmul"),
        other_tones!("smmla"),
        "ldr r9, [sp]",
        "ldr r10, [sp, #16]",
        store_sums!("256"),
        "add r9, r9, #16",
        "str r9, [sp]",
        "cmp r9, r10",
        "bne 2b",
        "sub r9, r9, #128",
        "str r9, [sp]",
        "ldr r1, [sp, #8]",
        "vldmia r1, {{s0-s31}}",
        "3:",
        tone!("0", "1", set "smmul"),
        other_tones!("smmla"),
        "str r0, [sp, #12]",
        "ldr r0, [sp]",
        "ldr lr, [sp, #4]",
        unfold!("r1", "r2", "r3", "r4", "0"),
        unfold!("r5", "r6", "r7", "r8", "256"),
        "add r1, r0, #16",
        "sub lr, lr, #16",
        "str r1, [sp]",
        "str lr, [sp, #4]",
        "ldr r2, [sp, #16]",
        "ldr r0, [sp, #12]",
        "cmp r1, r2",
        "bne 3b",
        "add sp, sp, #20",
        "vpop {{s16-s31}}",
        "pop {{r4-r11, pc}}",
    )
}

/// Loads the eight sums from `[r9]`, as `store_sums` left them.
macro_rules! load_sums {
    ($second:literal) => {
        concat!(
            "ldr r1, [r9]\nldr r2, [r9, #4]\nldr r3, [r9, #8]\nldr r4, [r9, #12]\n",
            "ldr r5, [r9, #",
            $second,
            "]\nldr r6, [r9, #",
            $second,
            " + 4]\n",
            "ldr r7, [r9, #",
            $second,
            " + 8]\nldr r8, [r9, #",
            $second,
            " + 12]\n",
        )
    };
}

/// The next pair's 32 coefficients, from the address at `[sp, #8]`.
macro_rules! load_seeds {
    () => {
        "ldr r1, [sp, #8]\nvldmia r1!, {{s0-s31}}\nstr r1, [sp, #8]\n"
    };
}

/// The sums of a pass of packed corrections, scaled to those of the main pass.
macro_rules! bends {
    () => {
        concat!(
            tone!("0", "1", set "smuad"),
            other_tones!("smlad"),
            "asr r1, r1, #3\nasr r2, r2, #3\nasr r3, r3, #3\nasr r4, r4, #3\n",
            "asr r5, r5, #3\nasr r6, r6, #3\nasr r7, r7, #3\nasr r8, r8, #3\n",
        )
    };
}

/// After a group whose sums' address `r9` is stored at `[sp, $slot]`: on by `$next` bytes to the second group at label
/// `$group`, or on by `$onward` to the next pair at label `$pair`, until `$end`. Leaves the words' address at the
/// start of the next pass.
macro_rules! next_group {
    ($slot:literal, $next:literal, $group:literal, $onward:literal, $pair:literal, $end:literal, $done:literal) => {
        concat!(
            "ldr r10, [sp, #12]\n",
            "cmp r0, r10\n",
            "beq ",
            $done,
            "f\n",
            "add r9, r9, #",
            $next,
            "\n",
            "str r9, [sp, #",
            $slot,
            "]\n",
            "b ",
            $group,
            "b\n",
            $done,
            ":\n",
            "add r9, r9, #",
            $onward,
            "\n",
            "str r9, [sp, #",
            $slot,
            "]\n",
            "ldr r10, [sp, #",
            $end,
            "]\n",
            "sub r0, r0, #512\n",
            "cmp r9, r10\n",
            "bne ",
            $pair,
            "b\n",
            "add r0, r0, #1024\n",
            "str r0, [sp, #12]\n",
            "sub r0, r0, #512\n",
        )
    };
}

// Frame of `glide`: [sp] where E and E + O go, [sp, #4] where O and E - O go, [sp, #8] the next seeds, [sp, #12] the
// end of the pass's words, [sp, #16] and [sp, #20] the ends of the first two, [sp, #24] r0 while it is needed.
#[unsafe(naked)]
unsafe extern "C" fn glide(basis: &GlideBasis, seeds: &GlideSeeds, out: &mut [i32; BLOCK]) {
    naked_asm!(
        ".fpu fpv4-sp-d16", // naked functions do not inherit the target's features
        "push {{r4-r11, lr}}",
        "vpush {{s16-s31}}",
        "sub sp, sp, #28",
        // Within the 128 bytes of a pair: E and E + O at 32 and 48, O and E - O at 16 and 0; the second sub-block's
        // 64 bytes on.
        "add r3, r2, #32",
        "str r3, [sp]",
        "add r3, r2, #16",
        "str r3, [sp, #4]",
        "str r1, [sp, #8]",
        "add r3, r0, #512",
        "str r3, [sp, #12]",
        "add r3, r2, #544",
        "str r3, [sp, #16]",
        "add r3, r2, #528",
        "str r3, [sp, #20]",
        // E's corrections
        "2:",
        load_seeds!(),
        "20:",
        bends!(),
        "ldr r9, [sp]",
        store_sums!("64"),
        next_group!("0", "16", "20", "112", "2", "16", "21"),
        "sub r9, r9, #512",
        "str r9, [sp]",
        // E
        "3:",
        load_seeds!(),
        "30:",
        "ldr r9, [sp]",
        load_sums!("64"),
        tone!("0", "1", add "smmla"),
        other_tones!("smmla"),
        "ldr r9, [sp]",
        store_sums!("64"),
        next_group!("0", "16", "30", "112", "3", "16", "31"),
        "sub r9, r9, #512",
        "str r9, [sp]",
        // O's corrections
        "4:",
        load_seeds!(),
        "40:",
        bends!(),
        "ldr r9, [sp, #4]",
        store_sums!("64"),
        next_group!("4", "-16", "40", "144", "4", "20", "41"),
        "sub r9, r9, #512",
        "str r9, [sp, #4]",
        // O, and both
        "5:",
        load_seeds!(),
        "50:",
        "ldr r9, [sp, #4]",
        load_sums!("64"),
        tone!("0", "1", add "smmla"),
        other_tones!("smmla"),
        "str r0, [sp, #24]",
        "ldr r0, [sp]",
        "ldr lr, [sp, #4]",
        unfold!("r1", "r2", "r3", "r4", "0"),
        unfold!("r5", "r6", "r7", "r8", "64"),
        "mov r9, r0",
        "ldr r0, [sp, #24]",
        "ldr r10, [sp, #12]",
        "cmp r0, r10",
        "beq 51f",
        "add r9, r9, #16",
        "sub lr, lr, #16",
        "str r9, [sp]",
        "str lr, [sp, #4]",
        "b 50b",
        "51:",
        "add r9, r9, #112",
        "add lr, lr, #144",
        "str r9, [sp]",
        "str lr, [sp, #4]",
        "sub r0, r0, #512",
        "ldr r10, [sp, #16]",
        "cmp r9, r10",
        "bne 5b",
        "add sp, sp, #28",
        "vpop {{s16-s31}}",
        "pop {{r4-r11, pc}}",
    )
}
