//! Copies of memory, in the place of those that come with the compiler, which take up to four cycles a byte; these take one, or two
//! thirds of one between aligned places.
//!
//! A decoded command and a planned motion have some hundred bytes and are moved several times, at any alignment, and no stop is
//! looked for meanwhile. The cores read and write words at any address of normal memory; registers of peripherals are never
//! copied in this way.

use core::arch::naked_asm;

/// Copies `bytes`; the two places do not overlap.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memcpy(to: *mut u8, from: *const u8, bytes: usize) {
    naked_asm!(
        "subs r2, r2, #16",
        "blo 3f",
        "push {{r4, r5}}",
        "2:",
        "ldr r3, [r1]",
        "ldr r4, [r1, #4]",
        "ldr r5, [r1, #8]",
        "ldr r12, [r1, #12]",
        "adds r1, r1, #16",
        "str r3, [r0]",
        "str r4, [r0, #4]",
        "str r5, [r0, #8]",
        "str r12, [r0, #12]",
        "adds r0, r0, #16",
        "subs r2, r2, #16",
        "bhs 2b",
        "pop {{r4, r5}}",
        "3:",
        // Fewer than 16 are left, by the lowest bits: carry for 8 bytes, minus for 4; then for 2 and 1.
        "lsls r3, r2, #29",
        "itttt cs",
        "ldrcs r3, [r1], #4",
        "strcs r3, [r0], #4",
        "ldrcs r3, [r1], #4",
        "strcs r3, [r0], #4",
        "itt mi",
        "ldrmi r3, [r1], #4",
        "strmi r3, [r0], #4",
        "lsls r2, r2, #31",
        "itt cs",
        "ldrhcs r3, [r1], #2",
        "strhcs r3, [r0], #2",
        "itt mi",
        "ldrbmi r3, [r1]",
        "strbmi r3, [r0]",
        "bx lr",
    )
}

/// As [`__aeabi_memcpy`], between places that words are aligned to. Also as `__aeabi_memcpy8`.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memcpy4(to: *mut u8, from: *const u8, bytes: usize) {
    naked_asm!(
        ".globl __aeabi_memcpy8",
        ".thumb_set __aeabi_memcpy8, __aeabi_memcpy4",
        "subs r2, r2, #32",
        "blo 3f",
        "push {{r4-r9}}",
        "2:",
        "ldmia r1!, {{r3-r9, r12}}",
        "stmia r0!, {{r3-r9, r12}}",
        "subs r2, r2, #32",
        "bhs 2b",
        "pop {{r4-r9}}",
        "3:",
        "add r2, r2, #32",
        "b.w {rest}",
        rest = sym __aeabi_memcpy,
    )
}
