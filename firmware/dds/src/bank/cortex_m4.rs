//! The kernels in the assembly of a Cortex-M4 with its DSP and floating-point extensions (M7 runs it too).
//!
//! The floating-point registers are used as storage only: nothing here computes with floats.
//!
//! All but the conversion to codes are *naked* functions: they use the whole register file, which inline assembly may
//! not claim. They follow the procedure call standard (r4-r11, lr and s16-s31 are saved where used, the stack stays
//! balanced) and write no other memory than their arguments and their own frame, so an interrupt may come at any time.
//! The comments use the names of `portable.rs`, `steady.rs` and `glide.rs`; cycles are those of the M4's reference
//! manual without wait states.
//!
//! A pass (see `layout.rs`) fills the register file exactly:
//! ```text
//! r0 the words' address, r1-r8 the sums, r9-r12 four words, lr one coefficient; s0-s31 the 16 x 2 coefficients
//! per tone: LDM 5 cycles + 2 VMOV + 8 SMMLA = 15 cycles for 8 products, 1.875 each
//! ```
//! A four-sample group is one straight run of 176 instructions, 704 bytes. On the chips with this core the kernels lie in RAM
//! (`memory/fast.x`), where no jump and no cache's size matters: what is unrolled saves its loop and costs room alone.

use core::arch::{asm, naked_asm};
use core::mem::offset_of;

use super::block::{BLOCK, TONES, ToneBlock};
use super::glide::{HALF_UNIT, THETA};
use super::kernel::{Converted, Kernel, Survey};
use super::layout::{GlideBasis, GlideSeeds, SteadyBasis, SteadySeeds, Turn};
use super::quantize::{CODES_PER_UNIT, MAX_CODE, MID_SCALE};
use super::sine::{RADIANS, TABLE};

/// The kernels in assembly.
pub(super) struct CortexM4;

// The memory layout that the assembly relies on.
const _: () = {
    assert!(TONES == 16 && BLOCK == 128);
    assert!(size_of::<ToneBlock>() == 24 && size_of::<Turn>() == 8);
    assert!(offset_of!(ToneBlock, step_end) == 8 && offset_of!(ToneBlock, amplitude) == 16);
    assert!(offset_of!(SteadySeeds, odd) == 128 && offset_of!(SteadyBasis, odd) == 2048);
    assert!(offset_of!(GlideBasis, even) == 512 && offset_of!(GlideSeeds, even) == 512);
    assert!(offset_of!(GlideBasis, odd_bend) == 1024 && offset_of!(GlideSeeds, odd_bend) == 1024);
    assert!(offset_of!(GlideBasis, odd) == 1536 && offset_of!(GlideSeeds, odd) == 1536);
};

/// Four samples from `{from}`, rounded, clamped (which Q remembers) and packed to `{to}`; the squares of the codes' distances
/// from mid-scale are added to `{energy}`, which they cannot make overflow.
macro_rules! four_codes {
    () => {
        concat!(
            "ldm {from}!, {{r2, r3, r4, r5}}\n",
            "smmlar r2, r2, {scale}, {mid}\nsmmlar r3, r3, {scale}, {mid}\n",
            "smmlar r4, r4, {scale}, {mid}\nsmmlar r5, r5, {scale}, {mid}\n",
            "usat r2, #12, r2\nusat r3, #12, r3\nusat r4, #12, r4\nusat r5, #12, r5\n",
            "pkhbt r2, r2, r3, lsl #16\npkhbt r4, r4, r5, lsl #16\n",
            "str r4, [{to}, #4]\nstr r2, [{to}], #8\n",
            "ssub16 r2, r2, {mids}\nssub16 r4, r4, {mids}\n",
            "smlad {energy}, r2, r2, {energy}\nsmlad {energy}, r4, r4, {energy}\n",
        )
    };
}

impl Kernel for CortexM4 {
    #[inline]
    fn survey(tones: &[ToneBlock; TONES], inverted_steps: &[u64; TONES]) -> Survey {
        // SAFETY: the function reads sixteen tones and sixteen steps and writes nothing.
        match unsafe { survey(tones, inverted_steps) } {
            0 => Survey::Unchanged,
            1 => Survey::Retuned,
            _ => Survey::Gliding,
        }
    }

    #[inline]
    fn rebuild(step: u64, slot: usize, basis: &mut SteadyBasis, turn: &mut Turn) {
        if slot < TONES {
            // SAFETY: the function writes the turn and the slot's column of the basis, 16 bytes in each of 16 rows.
            unsafe { rebuild(step, core::ptr::from_mut(basis).cast::<[i32; 4]>().add(slot), turn) }
        }
    }

    #[inline]
    fn seed_steady(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        turns: &[Turn; TONES],
        seeds: &mut SteadySeeds,
    ) {
        // SAFETY: the function reads and writes sixteen phases, reads sixteen tones and turns, and writes the seeds.
        unsafe { seed_steady(phases, tones, turns, seeds) }
    }

    #[inline]
    fn seed_glide(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        basis: &mut GlideBasis,
        seeds: &mut GlideSeeds,
    ) {
        // SAFETY: the function reads and writes sixteen phases, reads sixteen tones, and writes basis and seeds.
        unsafe { seed_glide(phases, tones, basis, seeds) }
    }

    #[inline]
    fn steady(basis: &SteadyBasis, seeds: &SteadySeeds, out: &mut [i32; BLOCK]) {
        // SAFETY: the function reads exactly the two structures and writes exactly the block, as their types say.
        unsafe { steady(basis, seeds, out) }
    }

    #[inline]
    fn glide(basis: &GlideBasis, seeds: &GlideSeeds, out: &mut [i32; BLOCK]) {
        // SAFETY: as `steady` above: reads the two structures, writes the block.
        unsafe { glide(basis, seeds, out) }
    }

    fn codes(samples: &[i32; BLOCK], out: &mut [u16; BLOCK]) -> Converted {
        const { assert!(MAX_CODE == 4095, "the instruction below saturates to 12 bits") };
        let (clamped, energy): (u32, u32);
        // SAFETY: eight rounds read sixteen samples and write sixteen codes each: 128 of both. The only flags changed
        // are those of the comparison, GE and Q, which no compiled code relies on.
        unsafe {
            asm!(
                "msr apsr_nzcvq, {energy}",
                "2:",
                four_codes!(),
                four_codes!(),
                four_codes!(),
                four_codes!(),
                "cmp {from}, {end}",
                "bne 2b",
                "mrs {scale}, apsr",
                energy = inout(reg) 0_u32 => energy,
                from = inout(reg) samples.as_ptr() => _,
                end = in(reg) samples.as_ptr().wrapping_add(BLOCK),
                to = inout(reg) out.as_mut_ptr() => _,
                scale = inout(reg) CODES_PER_UNIT => clamped,
                mid = in(reg) u32::from(MID_SCALE),
                mids = in(reg) u32::from(MID_SCALE) << 16 | u32::from(MID_SCALE),
                out("r2") _, out("r3") _, out("r4") _, out("r5") _,
                options(nostack),
            );
        }
        Converted { is_clamped: clamped & (1 << 27) != 0, energy }
    }
}

/// The products of one tone, four words with two coefficients: `add`ed to the eight sums, or the sums `set` to them.
macro_rules! tone {
    ($first:literal, $second:literal, add $op:literal) => {
        concat!(
            "ldm r0!, {{r9, r10, r11, r12}}\n",
            "vmov lr, s", $first, "\n",
            $op, " r1, r9, lr, r1\n", $op, " r2, r10, lr, r2\n",
            $op, " r3, r11, lr, r3\n", $op, " r4, r12, lr, r4\n",
            "vmov lr, s", $second, "\n",
            $op, " r5, r9, lr, r5\n", $op, " r6, r10, lr, r6\n",
            $op, " r7, r11, lr, r7\n", $op, " r8, r12, lr, r8\n",
        )
    };
    ($first:literal, $second:literal, set $op:literal) => {
        concat!(
            "ldm r0!, {{r9, r10, r11, r12}}\n",
            "vmov lr, s", $first, "\n",
            $op, " r1, r9, lr\n", $op, " r2, r10, lr\n", $op, " r3, r11, lr\n", $op, " r4, r12, lr\n",
            "vmov lr, s", $second, "\n",
            $op, " r5, r9, lr\n", $op, " r6, r10, lr\n", $op, " r7, r11, lr\n", $op, " r8, r12, lr\n",
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
            "ldr r9, [r0, #", $at, "]\nldr r10, [r0, #", $at, " + 4]\n",
            "ldr r11, [r0, #", $at, " + 8]\nldr r12, [r0, #", $at, " + 12]\n",
            "add ", $o0, ", ", $o0, ", r9\nadd ", $o1, ", ", $o1, ", r10\n",
            "add ", $o2, ", ", $o2, ", r11\nadd ", $o3, ", ", $o3, ", r12\n",
            // E - O = 2 E - (E + O)
            "rsb r9, ", $o0, ", r9, lsl #1\nrsb r10, ", $o1, ", r10, lsl #1\n",
            "rsb r11, ", $o2, ", r11, lsl #1\nrsb r12, ", $o3, ", r12, lsl #1\n",
            "str ", $o0, ", [r0, #", $at, "]\nstr ", $o1, ", [r0, #", $at, " + 4]\n",
            "str ", $o2, ", [r0, #", $at, " + 8]\nstr ", $o3, ", [r0, #", $at, " + 12]\n",
            "str r12, [lr, #", $at, "]\nstr r11, [lr, #", $at, " + 4]\n",
            "str r10, [lr, #", $at, " + 8]\nstr r9, [lr, #", $at, " + 12]\n",
        )
    };
}

/// Writes the eight sums to `[r9]`, four per sub-block.
macro_rules! store_sums {
    ($second:literal) => {
        concat!(
            "str r1, [r9]\nstr r2, [r9, #4]\nstr r3, [r9, #8]\nstr r4, [r9, #12]\n",
            "str r5, [r9, #", $second, "]\nstr r6, [r9, #", $second, " + 4]\n",
            "str r7, [r9, #", $second, " + 8]\nstr r8, [r9, #", $second, " + 12]\n",
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
            "ldr r5, [r9, #", $second, "]\nldr r6, [r9, #", $second, " + 4]\n",
            "ldr r7, [r9, #", $second, " + 8]\nldr r8, [r9, #", $second, " + 12]\n",
        )
    };
}

/// The next pair's 32 coefficients, from the address at `[sp, #8]`.
macro_rules! load_seeds {
    () => {
        "ldr r1, [sp, #8]\nvldmia r1!, {{s0-s31}}\nstr r1, [sp, #8]\n"
    };
}

/// The sums of four samples of a pass of packed corrections, times `tau / 8` and scaled to those of the main pass: `$tau` is
/// the first sample's `2 tau` with 25 fractional bits, the others' are two more each.
macro_rules! bends {
    ($tau0:literal, $tau1:literal, $tau2:literal, $tau3:literal) => {
        concat!(
            tone!("0", "1", set "smuad"),
            other_tones!("smlad"),
            "mov r9, #", $tau0, "\nmov r10, #", $tau1, "\nmov r11, #", $tau2, "\nmov r12, #", $tau3, "\n",
            "smmul r1, r1, r9\nsmmul r2, r2, r10\nsmmul r3, r3, r11\nsmmul r4, r4, r12\n",
            "smmul r5, r5, r9\nsmmul r6, r6, r10\nsmmul r7, r7, r11\nsmmul r8, r8, r12\n",
        )
    };
}

/// The corrections of all pairs, at label `$pair`: the sums' address of a pair's first group is stored at `[sp, $slot]`, those
/// of the second lie `$next` bytes on, the next pair's 128. Leaves the words' address at the start of the next pass.
macro_rules! bends_of_all_pairs {
    ($slot:literal, $next:literal, $second:literal, $pair:literal, $end:literal) => {
        concat!(
            $pair, ":\n",
            load_seeds!(),
            bends!("1 << 25", "3 << 25", "5 << 25", "7 << 25"),
            "ldr r9, [sp, #", $slot, "]\n",
            store_sums!("64"),
            bends!("9 << 25", "11 << 25", "13 << 25", "15 << 25"),
            "ldr r9, [sp, #", $slot, "]\nldr r10, [sp, #", $end, "]\n",
            "add r9, r9, #", $next, "\n",
            store_sums!("64"),
            "add r9, r9, #", $second, "\n",
            "str r9, [sp, #", $slot, "]\n",
            "sub r0, r0, #512\n",
            "cmp r9, r10\n",
            "bne ", $pair, "b\n",
            "sub r9, r9, #512\n",
            "str r9, [sp, #", $slot, "]\n",
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
        "add r3, r2, #544",
        "str r3, [sp, #16]",
        "add r3, r2, #528",
        "str r3, [sp, #20]",
        // E's corrections
        bends_of_all_pairs!("0", "16", "112", "2", "16"),
        // E
        "3:",
        load_seeds!(),
        "30:",
        "ldr r9, [sp]",
        load_sums!("64"),
        tone!("0", "1", add "smmla"),
        other_tones!("smmla"),
        "ldr r9, [sp]",
        "ldr r10, [sp, #12]",
        "cmp r0, r10",
        store_sums!("64"),
        "beq 31f",
        "add r9, r9, #16",
        "str r9, [sp]",
        "b 30b",
        "31:",
        "add r9, r9, #112",
        "str r9, [sp]",
        "ldr r10, [sp, #16]",
        "sub r0, r0, #512",
        "cmp r9, r10",
        "bne 3b",
        "add r0, r0, #512",
        "sub r9, r9, #512",
        "str r9, [sp]",
        // O's corrections
        bends_of_all_pairs!("4", "-16", "144", "4", "20"),
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

/// Sine and cosine of the phase `$angle` into `$s` and `$c`, with the table's address in `$table` and [`RADIANS`] in
/// `$radians`; uses `$a` and `$b`. 14 cycles.
macro_rules! sine_cosine {
    (
        $angle:literal, $table:literal, $radians:literal, $s:literal, $c:literal,
        $sine:literal, $cosine:literal, $a:literal, $b:literal
    ) => {
        concat!(
            "lsr ", $s, ", ", $angle, ", #22\n", "lsl ", $a, ", ", $angle, ", #10\n",
            "add ", $s, ", ", $table, ", ", $s, ", lsl #3\n", "eor ", $a, ", ", $a, ", #0x80000000\n",
            "ldr ", $sine, ", [", $s, "]\n", "ldr ", $cosine, ", [", $s, ", #4]\n",
            "smmul ", $b, ", ", $a, ", ", $radians, "\n", // r
            "smmul ", $a, ", ", $b, ", ", $b, "\n",
            "asr ", $a, ", ", $a, ", #1\n", // r^2 / 2
            "smmla ", $s, ", ", $cosine, ", ", $b, ", ", $sine, "\n",
            "smmls ", $c, ", ", $sine, ", ", $b, ", ", $cosine, "\n",
            "smmls ", $s, ", ", $sine, ", ", $a, ", ", $s, "\n",
            "smmls ", $c, ", ", $cosine, ", ", $a, ", ", $c, "\n",
        )
    };
}

pub(crate) use sine_cosine;

/// 2 if a tone moves, else 1 if a step is new, else 0; about 25 cycles a tone, and none after the first that moves.
#[unsafe(naked)]
unsafe extern "C" fn survey(tones: &[ToneBlock; TONES], inverted_steps: &[u64; TONES]) -> u32 {
    naked_asm!(
        "push {{r4-r11, lr}}",
        "mov r12, #-1", // stays all ones while every step is the inverse of its inverted one
        "add lr, r1, #128",
        "2:",
        "ldm r0!, {{r3-r8}}",
        "ldm r1!, {{r9, r10}}",
        "eor r5, r5, r3",
        "eor r6, r6, r4",
        "eor r7, r7, r8",
        "orr r5, r5, r6",
        "eor r9, r9, r3",
        "orrs r5, r5, r7",
        "bne 3f",
        "eor r10, r10, r4",
        "and r12, r12, r9",
        "and r12, r12, r10",
        "cmp r1, lr",
        "bne 2b",
        "adds r12, r12, #1",
        "ite eq",
        "moveq r0, #0",
        "movne r0, #1",
        "pop {{r4-r11, pc}}",
        "3:",
        "mov r0, #2",
        "pop {{r4-r11, pc}}",
    )
}

/// From one sample to the next: turns the angle of cosine lr and sine r8 by that of r5 and r4.
macro_rules! turn {
    () => {
        concat!(
            "smmulr r10, r8, r5\nsmmulr r11, lr, r5\n",
            "smmlar r10, lr, r4, r10\nsmmlsr r11, r8, r4, r11\n",
            "lsl r8, r10, #1\nlsl lr, r11, #1\n",
        )
    };
}

/// The basis words of one sample, cosine in lr and sine in r8, `$at` bytes on in the tone's column at r2.
macro_rules! steady_words {
    ($at:literal) => {
        concat!("str lr, [r2, #", $at, "]\nstr r8, [r2, #2048 + ", $at, "]\n")
    };
}

/// `rebuild` of `steady.rs`, about 350 cycles.
#[unsafe(naked)]
unsafe extern "C" fn rebuild(step: u64, column: *mut [i32; 4], turn: &mut Turn) {
    naked_asm!(
        ".fpu fpv4-sp-d16",
        "push {{r4-r11, lr}}",
        "movw r6, #:lower16:{table}",
        "movt r6, #:upper16:{table}",
        "movw r7, #{radians} & 0xFFFF",
        "movt r7, #{radians} >> 16",
        "lsl r8, r1, #5",
        "orr r8, r8, r0, lsr #27",
        sine_cosine!("r8", "r6", "r7", "r4", "r5", "r9", "r10", "r11", "r12"),
        "str r5, [r3]",
        "str r4, [r3, #4]",
        sine_cosine!("r1", "r6", "r7", "r4", "r5", "r9", "r10", "r11", "r12"),
        "lsrs r1, r1, #1",
        "rrx r0, r0", // half the step: the first sample's phase
        "lsl r3, r1, #4",
        "orr r3, r3, r0, lsr #28",
        "lsl r9, r0, #4",
        "vmov s0, r9",
        "add r9, r2, #2048",
        "vmov s1, r9",
        "2:",
        sine_cosine!("r1", "r6", "r7", "r8", "lr", "r9", "r10", "r11", "r12"),
        steady_words!("0"),
        turn!(),
        steady_words!("4"),
        turn!(),
        steady_words!("8"),
        turn!(),
        steady_words!("12"),
        turn!(),
        steady_words!("256"),
        turn!(),
        steady_words!("260"),
        turn!(),
        steady_words!("264"),
        turn!(),
        steady_words!("268"),
        "vmov r9, s0",
        "vmov r10, s1",
        "adds r0, r0, r9",
        "adc r1, r1, r3",
        "add r2, r2, #512",
        "cmp r2, r10",
        "bne 2b",
        "pop {{r4-r11, pc}}",
        table = sym TABLE,
        radians = const RADIANS,
    )
}

/// `seed` of `steady.rs` for sixteen tones, about 50 cycles each.
#[unsafe(naked)]
unsafe extern "C" fn seed_steady(
    phases: &mut [u64; TONES],
    tones: &[ToneBlock; TONES],
    turns: &[Turn; TONES],
    seeds: &mut SteadySeeds,
) {
    naked_asm!(
        ".fpu fpv4-sp-d16",
        "push {{r4-r11, lr}}",
        "add r4, r0, #128",
        "vmov s0, r4",
        "movw r11, #:lower16:{table}",
        "movt r11, #:upper16:{table}",
        "movw r12, #{radians} & 0xFFFF",
        "movt r12, #{radians} >> 16",
        "2:",
        "ldr r4, [r0]",
        "ldr r5, [r0, #4]",
        "ldr r6, [r1]",
        "ldr r7, [r1, #4]",
        "ldr r8, [r1, #16]",
        "lsl r9, r7, #6",
        "orr r9, r9, r6, lsr #26",
        "lsl r6, r6, #6",
        "adds r4, r4, r6",
        "adc r5, r5, r9", // the phase at sample 64
        "sub r10, r5, r7, lsr #1", // at the centre
        "adds r4, r4, r6",
        "adc r5, r5, r9", // at the next block
        "str r4, [r0], #4",
        "str r5, [r0], #4",
        "lsr r8, r8, #1",
        "usat r8, #30, r8",
        sine_cosine!("r10", "r11", "r12", "r4", "lr", "r6", "r7", "r5", "r9"),
        "smmul r4, r8, r4",
        "smmul r5, r8, lr",
        "ldrd r6, r7, [r2], #8",
        "smmul r8, r4, r6",
        "smmul r9, r5, r6",
        "smmls r10, r5, r7, r8",
        "smmla r8, r5, r7, r8",
        "smmla lr, r4, r7, r9",
        "smmls r9, r4, r7, r9",
        "str r8, [r3, #4]",
        "str lr, [r3, #128]",
        "str r9, [r3, #132]",
        "str r10, [r3], #8",
        "vmov r4, s0",
        "add r1, r1, #24",
        "cmp r0, r4",
        "bne 2b",
        "pop {{r4-r11, pc}}",
        table = sym TABLE,
        radians = const RADIANS,
    )
}

/// The seeds of one sub-block, `$at` bytes on from `r0`. r1 the table, r2 the phase and r3 its gain, r4 the amplitude,
/// r5 the detuning, r6 the swell, r7 [`RADIANS`]; s2-s8 what they change by and the block's other constants.
macro_rules! sub_block {
    ($at:literal) => {
        concat!(
            sine_cosine!("r2", "r1", "r7", "r8", "lr", "r9", "r10", "r11", "r12"),
            // The seeds.
            "asr r9, r4, #1\n",
            "smmul r10, r9, r8\n",
            "smmul r9, r9, lr\n",
            "str r10, [r0, #512 + ", $at, "]\n",
            "str r9, [r0, #1536 + ", $at, "]\n",
            // Sine over cosine, imaginary over real, swell over curl.
            "pkhtb r8, r8, lr, asr #16\n",
            "vmov r9, s6\n",
            "smmla r9, r4, r5, r9\n", // imaginary
            "vmov r10, s7\nvmov r11, s8\n",
            "smmls r10, r9, r11, r10\n", // real
            "smmul r11, r9, r5\n", // curl
            "pkhtb r9, r9, r10, asr #16\n",
            "pkhtb r10, r6, r11, asr #21\n",
            // The four products of two complex numbers each, and their upper halves.
            "mov r11, #0x8000\n",
            "smlsd r12, r9, r8, r11\nsmladx r9, r9, r8, r11\n",
            "smlsdx lr, r10, r8, r11\nsmlad r10, r10, r8, r11\n",
            "pkhtb r12, lr, r12, asr #16\npkhtb r9, r10, r9, asr #16\n",
            "str r12, [r0, #", $at, "]\n",
            "str r9, [r0, #1024 + ", $at, "]\n",
        )
    };
}

/// On to the next sub-block.
macro_rules! onward {
    () => {
        concat!(
            "vmov r10, s2\nvmov r11, s3\nvmov r12, s4\nvmov lr, s5\n",
            "add r2, r2, r3\n",
            "add r3, r3, r10\nadd r4, r4, r11\nadd r5, r5, r12\nadd r6, r6, lr\n",
        )
    };
}

/// The basis words of one sample: cosine in lr, sine in r8, half a unit in r6; `$tau` is `-2 tau` with 26 fractional
/// bits, `$at` the sample's place in the tone's column at r0.
macro_rules! basis_words {
    ($tau:literal, $at:literal) => {
        concat!(
            "mov r9, #", $tau, "\n",
            "smmla r10, lr, r9, r6\nsmmla r11, r8, r9, r6\n",
            "pkhtb r10, r10, r8, asr #18\npkhtb r11, r11, lr, asr #18\n",
            "str r10, [r0, #", $at, "]\n",
            "str lr, [r0, #512 + ", $at, "]\n",
            "str r11, [r0, #1024 + ", $at, "]\n",
            "str r8, [r0, #1536 + ", $at, "]\n",
        )
    };
}

/// `rebuild` and `seed` of `glide.rs` for sixteen tones, about 580 cycles each.
#[unsafe(naked)]
unsafe extern "C" fn seed_glide(
    phases: &mut [u64; TONES],
    tones: &[ToneBlock; TONES],
    basis: &mut GlideBasis,
    seeds: &mut GlideSeeds,
) {
    // s0 RADIANS, s1 THETA, s2-s8 as `sub_block` says, s9 phases, s10 tones, s11 basis, s12 seeds, s13 the phases'
    // end, s14 half the basis's step, s15 TABLE.
    naked_asm!(
        ".fpu fpv4-sp-d16",
        "push {{r4-r11, lr}}",
        "vmov s10, r1",
        "vmov s11, r2",
        "vmov s12, r3",
        "add r4, r0, #128",
        "vmov s13, r4",
        "movw r4, #{radians} & 0xFFFF",
        "movt r4, #{radians} >> 16",
        "vmov s0, r4",
        "movw r4, #{theta} & 0xFFFF",
        "movt r4, #{theta} >> 16",
        "vmov s1, r4",
        "movw r4, #:lower16:{table}",
        "movt r4, #:upper16:{table}",
        "vmov s15, r4",
        "2:",
        "vmov r1, s10",
        "ldr r2, [r0]",
        "ldr r3, [r0, #4]",
        "ldm r1!, {{r4, r5, r6, r7, r8, r9}}",
        // The next block's phase: 64 (step + step_end) on.
        "adds r10, r4, r6",
        "adc r11, r5, r7",
        "lsl r11, r11, #6",
        "orr r11, r11, r10, lsr #26",
        "adds r12, r2, r10, lsl #6",
        "adc r11, r3, r11",
        "str r12, [r0], #4",
        "str r11, [r0], #4",
        "vmov s9, r0",
        "vmov s10, r1",
        // The change, in 2^-40 turns.
        "subs r6, r6, r4",
        "sbc r7, r7, r5",
        "ssat r7, #23, r7",
        "lsl r7, r7, #8",
        "orr r7, r7, r6, lsr #24",
        // The first centre's phase, and the way to the next.
        "lsl r10, r5, #3",
        "orr r10, r10, r4, lsr #29",
        "sub r10, r10, r5, lsr #1",
        "add r2, r3, r10",
        "mov r11, #225 << 14",
        "smmla r2, r7, r11, r2",
        "lsl r3, r5, #4",
        "orr r3, r3, r4, lsr #28",
        "mov r11, #31 << 20",
        "smmla r3, r7, r11, r3",
        "asr r11, r7, #7",
        "vmov s2, r11",
        "mov r11, #127 << 16",
        "smmla r12, r7, r11, r5",
        "lsr r12, r12, #1",
        "vmov s14, r12",
        // Amplitude, detuning and the rest.
        "vmov r11, s1",
        "smmul r10, r7, r11", // theta
        "lsr r8, r8, #1",
        "lsr r9, r9, #1",
        "usat r8, #30, r8",
        "usat r9, #30, r9",
        "sub r7, r9, r8", // ramp
        "mov r11, #15 << 24",
        "smmla r4, r7, r11, r8",
        "asr r8, r7, #3",
        "vmov s3, r8",
        "vmov s4, r10",
        "mov r9, #{half}",
        "add r12, r7, r9",
        "vmov s7, r12",
        "sub r5, r10, r10, lsl #2",
        "sub r5, r5, r10, asr #1",
        "mov r11, #5 << 23",
        "smmul r11, r10, r11",
        "vmov s8, r11",
        "smmla r12, r7, r11, r9",
        "vmov s6, r12",
        "asr r11, r10, #2",
        "smmla r6, r4, r11, r9",
        "asr r12, r5, #4",
        "smmla r6, r7, r12, r6",
        "smmul r8, r8, r11",
        "asr r10, r10, #4",
        "smmla r8, r7, r10, r8",
        "vmov s5, r8",
        "vmov r0, s12",
        "vmov r7, s0",
        "vmov r1, s15",
        "add r8, r0, #8",
        "vmov s12, r8",
        // Eight sub-blocks, in one straight run: there is no loop to be paid for.
        sub_block!("0"),
        onward!(),
        sub_block!("4"),
        onward!(),
        sub_block!("128"),
        onward!(),
        sub_block!("132"),
        onward!(),
        sub_block!("256"),
        onward!(),
        sub_block!("260"),
        onward!(),
        sub_block!("384"),
        onward!(),
        sub_block!("388"),
        // The basis.
        "vmov r2, s14",
        "vmov r0, s11",
        "mov r6, #{half}",
        "add r3, r0, #16",
        "vmov s11, r3",
        sine_cosine!("r2", "r1", "r7", "r8", "lr", "r9", "r10", "r11", "r12"),
        "smmulr r4, r8, lr",
        "smmulr r5, lr, lr",
        "lsl r4, r4, #2",
        "smmlsr r5, r8, r8, r5",
        "lsl r5, r5, #1",
        basis_words!("-1 << 26", "0"),
        turn!(),
        basis_words!("-3 << 26", "4"),
        turn!(),
        basis_words!("-5 << 26", "8"),
        turn!(),
        basis_words!("-7 << 26", "12"),
        turn!(),
        basis_words!("-9 << 26", "256"),
        turn!(),
        basis_words!("-11 << 26", "260"),
        turn!(),
        basis_words!("-13 << 26", "264"),
        turn!(),
        basis_words!("-15 << 26", "268"),
        "vmov r0, s9",
        "vmov r1, s13",
        "cmp r0, r1",
        "bne 2b",
        "pop {{r4-r11, pc}}",
        table = sym TABLE,
        radians = const RADIANS,
        theta = const THETA,
        half = const HALF_UNIT,
    )
}
