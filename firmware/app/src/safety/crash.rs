//! The record that the panic and fault handlers write for the next start, in RAM that a reset does not clear.
//!
//! ```text
//! magic 4 | cause 1 | resets 1 | length 1 | ordered 1 | message 96 | crc 4      (little-endian)
//! ```

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use heapless::String;
use slipline_protocol::board::OrderedFault;
use slipline_protocol::event::ResetCause;
use slipline_protocol::frame::CRC;
use slipline_protocol::limits::MAX_CRASH;

const MAGIC: [u8; 4] = *b"SLcr";
const HEADER: usize = 8;
const COVERED: usize = HEADER + MAX_CRASH;

/// Why the last run ended, and how many abnormal ends there were in a row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CrashRecord {
    /// [`ResetCause::Panic`] or [`ResetCause::HardFault`] after a crash; else as the last start recorded it.
    pub cause: ResetCause,
    /// Abnormal resets in a row, none of which was followed by a stable run.
    pub resets: u8,
    /// The panic's message, cut if it is too long; empty if there was no panic.
    pub message: String<MAX_CRASH>,
    /// The fault that was ordered, and is about to end the run.
    pub ordered: Option<OrderedFault>,
}

impl CrashRecord {
    /// The record's length.
    pub const BYTES: usize = COVERED + 4;

    /// A record of a crash, with as much of `message` as fits.
    #[must_use]
    pub fn crashed(cause: ResetCause, resets: u8, message: &dyn core::fmt::Display) -> Self {
        let mut text = Cut(String::new());
        // A message that does not fit is cut: `Cut` never reports an error.
        let _ = core::fmt::write(&mut text, format_args!("{message}"));
        Self { cause, resets, message: text.0, ordered: None }
    }

    /// The record once the device has run long enough to count as sound.
    #[must_use]
    pub fn stable(self) -> Self {
        Self { resets: 0, ..self }
    }

    /// The record's bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; Self::BYTES] {
        let mut covered = [0; COVERED];
        let [m0, m1, m2, m3, cause, resets, length, ordered, message @ ..] = &mut covered;
        [*m0, *m1, *m2, *m3] = MAGIC;
        *cause = self.cause as u8;
        *resets = self.resets;
        let place = ORDERED.iter().position(|known| *known == self.ordered);
        *ordered = place.and_then(|place| u8::try_from(place).ok()).unwrap_or(0);
        // At most 96.
        *length = u8::try_from(self.message.len()).unwrap_or(0);
        for (byte, &from) in message.iter_mut().zip(self.message.as_bytes()) {
            *byte = from;
        }
        let crc = CRC.checksum(&covered).to_le_bytes();
        let mut bytes = [0; Self::BYTES];
        for (byte, from) in bytes.iter_mut().zip(covered.into_iter().chain(crc)) {
            *byte = from;
        }
        bytes
    }

    /// Reads a record; `None` for anything else, such as RAM after power came on.
    #[must_use]
    pub fn decode(bytes: &[u8; Self::BYTES]) -> Option<Self> {
        let (covered, crc) = bytes.split_last_chunk::<4>()?;
        if CRC.checksum(covered) != u32::from_le_bytes(*crc) {
            return None;
        }
        let (&[m0, m1, m2, m3, cause, resets, length, ordered], message) =
            covered.split_first_chunk::<HEADER>()?;
        if [m0, m1, m2, m3] != MAGIC {
            return None;
        }
        let message = core::str::from_utf8(message.get(..usize::from(length))?).ok()?;
        let message = String::try_from(message).ok()?;
        let ordered = *ORDERED.get(usize::from(ordered))?;
        Some(Self { cause: cause_of(cause)?, resets, message, ordered })
    }
}

/// Takes what fits and drops the rest.
struct Cut(String<MAX_CRASH>);

impl core::fmt::Write for Cut {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for c in text.chars() {
            if self.0.push(c).is_err() {
                break;
            }
        }
        Ok(())
    }
}

/// The ordered faults by their bytes: the first for none.
const ORDERED: [Option<OrderedFault>; 4] =
    [None, Some(OrderedFault::Hang), Some(OrderedFault::MaskedInterrupts), Some(OrderedFault::StackOverflow)];

fn cause_of(byte: u8) -> Option<ResetCause> {
    const ALL: [ResetCause; 7] = [
        ResetCause::PowerOn,
        ResetCause::Pin,
        ResetCause::Software,
        ResetCause::Watchdog,
        ResetCause::BrownOut,
        ResetCause::Panic,
        ResetCause::HardFault,
    ];
    ALL.into_iter().find(|&cause| cause as u8 == byte)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_ordered_fault_comes_back() {
        for ordered in ORDERED {
            let record = CrashRecord { ordered, ..CrashRecord::default() };
            assert_eq!(CrashRecord::decode(&record.encode()), Some(record));
        }
    }

    proptest! {
        #[test]
        fn a_record_comes_back_as_it_was_left(resets: u8, message in ".{0,200}") {
            let record = CrashRecord::crashed(ResetCause::Panic, resets, &message);
            prop_assert!(message.starts_with(record.message.as_str()));
            prop_assert!(record.message.len() + 4 > message.len().min(MAX_CRASH));
            prop_assert_eq!(CrashRecord::decode(&record.encode()), Some(record));
        }

        #[test]
        fn a_record_with_a_flipped_bit_is_rejected(at in 0..CrashRecord::BYTES, bit in 0..8u8) {
            let mut bytes = CrashRecord::crashed(ResetCause::HardFault, 1, &"bus error").encode();
            bytes[at] ^= 1 << bit;
            prop_assert_eq!(CrashRecord::decode(&bytes), None);
        }

        #[test]
        fn random_memory_is_no_record(bytes in prop::collection::vec(any::<u8>(), CrashRecord::BYTES)) {
            let bytes: [u8; CrashRecord::BYTES] = bytes.try_into().unwrap();
            prop_assert_eq!(CrashRecord::decode(&bytes), None);
        }
    }
}
