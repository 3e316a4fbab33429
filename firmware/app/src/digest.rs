//! A CRC-32 of the DAC codes of a window, computed only while the window is open.
//!
//! The renderer computes it within the block's time. So it takes two codes at once, with four tables of 256 words
//! ("slicing by 4"): half the cycles of the protocol's CRC, which works byte by byte.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

#[cfg(all(target_arch = "arm", target_os = "none"))]
#[expect(unsafe_code, reason = "assembly; listed in firmware/UNSAFE.md")]
// The formatter would put each operand of an instruction on a line of its own.
#[rustfmt::skip]
mod cortex_m4;

#[cfg(all(target_arch = "arm", target_os = "none"))]
use self::cortex_m4::after_eights;

use slipline_dds::bank::BLOCK;
use slipline_protocol::command::DigestWindow;
use slipline_protocol::frame::CRC;
use slipline_protocol::units::SampleIndex;

/// What a byte followed by none, one, two and three bytes of zeros adds to the remainder.
static TABLES: [[u32; 256]; 4] = tables();

#[expect(
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    reason = "evaluated by the compiler: an index out of range does not build; a byte fits"
)]
const fn tables() -> [[u32; 256]; 4] {
    let mut tables = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 256 {
        // The protocol's polynomial, bits reversed like the input.
        let mut remainder = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            remainder = (remainder >> 1) ^ (CRC.algorithm.poly.reverse_bits() * (remainder & 1));
            bit += 1;
        }
        tables[0][byte] = remainder;
        byte += 1;
    }
    let mut zeros = 1;
    while zeros < 4 {
        byte = 0;
        while byte < 256 {
            let before = tables[zeros - 1][byte];
            tables[zeros][byte] = (before >> 8) ^ tables[0][(before & 0xFF) as usize];
            byte += 1;
        }
        zeros += 1;
    }
    tables
}

/// The remainder so far, of codes as two bytes each, the lower one first.
#[derive(Clone, Copy)]
struct Remainder(u32);

impl Remainder {
    const START: Self = Self(CRC.algorithm.init);

    #[inline]
    fn take(&mut self, codes: &[u16]) {
        let (eights, rest) = codes.as_chunks();
        *self = after_eights(*self, eights);
        if !rest.is_empty() {
            self.take_rest(rest);
        }
    }

    // Rare, at a window's two ends: it takes no room among what every block runs.
    #[cold]
    #[inline(never)]
    fn take_rest(&mut self, codes: &[u16]) {
        for &code in codes {
            // The codes fill the lower two bytes only; the upper two move down.
            let Self(before) = *self;
            self.0 = (before >> 16) ^ Self(before << 16).after(u32::from(code) << 16);
        }
    }

    /// After four bytes.
    #[inline(always)]
    fn after(self, bytes: u32) -> u32 {
        let sum = self.0 ^ bytes;
        let [none, one, two, three] = &TABLES;
        lookup(three, sum) ^ lookup(two, sum >> 8) ^ lookup(one, sum >> 16) ^ lookup(none, sum >> 24)
    }

    const fn digest(self) -> u32 {
        self.0 ^ CRC.algorithm.xorout
    }
}

/// The remainder after all the codes.
#[cfg(not(all(target_arch = "arm", target_os = "none")))]
fn after_eights(remainder: Remainder, eights: &[[u16; 8]]) -> Remainder {
    let (pairs, _) = eights.as_flattened().as_chunks();
    pairs.iter().fold(remainder, |remainder, &[first, second]| {
        Remainder(remainder.after(u32::from(first) | u32::from(second) << 16))
    })
}

#[inline(always)]
#[expect(clippy::indexing_slicing, reason = "a byte is below 256; the check is compiled away")]
fn lookup(table: &[u32; 256], sum: u32) -> u32 {
    table[(sum & 0xFF) as usize]
}

/// State of a digest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DigestState {
    /// No digest was ordered.
    None,
    /// The window lies ahead or is open.
    Waiting(DigestWindow),
    /// The window is over.
    Done(DigestWindow, u32),
}

/// The renderer's part: takes every block, adds up those of the window.
pub(crate) struct Digester {
    running: Option<(DigestWindow, Remainder)>,
    /// Its value before the last block.
    before: Option<Remainder>,
}

impl Digester {
    pub(crate) const fn new() -> Self {
        Self { running: None, before: None }
    }

    /// Takes the block at `index` and returns the new state, if it has changed.
    pub(crate) fn take(
        &mut self,
        state: DigestState,
        index: SampleIndex,
        codes: &[u16; BLOCK],
    ) -> Option<DigestState> {
        let DigestState::Waiting(window) = state else {
            self.running = None;
            self.before = None;
            return None;
        };
        if self.running.as_ref().is_none_or(|(running, _)| *running != window) {
            self.running = Some((window, Remainder::START));
        }
        let (_, remainder) = self.running.as_mut()?;
        self.before = Some(*remainder);
        let end = window.from.saturating_add(u64::from(window.count));
        // The window's part of this block, as offsets of at most a block.
        let offset = |at: SampleIndex| usize::try_from(at.saturating_sub(index)).unwrap_or(BLOCK).min(BLOCK);
        remainder.take(codes.get(offset(window.from)..offset(end)).unwrap_or_default());
        if end > index.saturating_add(BLOCK as u64) {
            return None;
        }
        let (_, remainder) = self.running.take()?;
        Some(DigestState::Done(window, remainder.digest()))
    }

    /// Takes the block at `index` once more, with other codes. Nothing has been taken since it was taken first.
    pub(crate) fn retake(
        &mut self,
        state: DigestState,
        index: SampleIndex,
        codes: &[u16; BLOCK],
    ) -> Option<DigestState> {
        let window = match state {
            DigestState::Waiting(window) if self.running.is_some_and(|(running, _)| running == window) => {
                window
            }
            DigestState::Done(window, _) => window,
            DigestState::Waiting(_) | DigestState::None => return None,
        };
        // None: it was done before that block.
        self.running = Some((window, self.before?));
        self.take(DigestState::Waiting(window), index, codes)
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_digest_is_the_protocols_crc_of_the_windows_codes_wherever_the_window_begins_and_ends(
            codes in prop::collection::vec(0u16..4096, 4 * BLOCK),
            from in 0u64..300,
            count in 1u32..200,
        ) {
            let window = DigestWindow { from, count };
            let (mut digester, mut state) = (Digester::new(), DigestState::Waiting(window));
            let (blocks, _) = codes.as_chunks::<BLOCK>();
            for (index, block) in (0..).step_by(BLOCK).zip(blocks) {
                state = digester.take(state, index, block).unwrap_or(state);
            }
            let bytes: Vec<u8> = codes.iter().flat_map(|code| code.to_le_bytes()).collect();
            let (first, end) = (2 * from as usize, 2 * (from as usize + count as usize));
            prop_assert_eq!(state, DigestState::Done(window, CRC.checksum(&bytes[first..end])));
        }
    }
}
