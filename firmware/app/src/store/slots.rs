//! State of the two slots: which record is the newest, whether the other slot is as a store leaves it, and how often
//! they have been erased.

use slipline_protocol::event::StoredConfig;

use super::{RecordHeader, SLOT_BYTES};
use crate::ports::{FLASH_WORD, FlashError, FlashPages, FlashSlot};

/// The header of a slot, read.
enum Content {
    Blank,
    Broken,
    Record(RecordHeader),
}

fn content(flash: &mut impl FlashPages, slot: FlashSlot) -> Content {
    let mut word = [0; FLASH_WORD];
    if flash.read(slot, 0, &mut word).is_err() {
        return Content::Broken;
    }
    match RecordHeader::decode(&word) {
        Some(header) => Content::Record(header),
        None if word.iter().all(|&byte| byte == 0xff) => Content::Blank,
        None => Content::Broken,
    }
}

/// Whether nothing has been written to a slot since it was erased.
fn is_blank(flash: &mut impl FlashPages, slot: FlashSlot) -> bool {
    let mut word = [0; FLASH_WORD];
    (0..SLOT_BYTES)
        .step_by(FLASH_WORD)
        .all(|offset| flash.read(slot, offset, &mut word).is_ok() && word.iter().all(|&byte| byte == 0xff))
}

/// The newest record of two slots, the first of which is `first`, and its slot.
///
/// # Errors
/// [`StoredConfig::Empty`] if both slots are blank or have no room, else [`StoredConfig::Damaged`].
pub(super) fn newest(
    flash: &mut impl FlashPages,
    first: FlashSlot,
) -> Result<(FlashSlot, RecordHeader), StoredConfig> {
    if flash.slot_len(first) < SLOT_BYTES {
        return Err(StoredConfig::Empty);
    }
    match (content(flash, first), content(flash, first.other())) {
        (Content::Record(a), Content::Record(b)) => {
            // Serial-number arithmetic: the sign of the difference is right even when the number has wrapped.
            let b_is_newer = b.sequence.wrapping_sub(a.sequence).cast_signed() > 0;
            Ok(if b_is_newer { (first.other(), b) } else { (first, a) })
        }
        (Content::Record(a), _) => Ok((first, a)),
        (_, Content::Record(b)) => Ok((first.other(), b)),
        (Content::Blank, Content::Blank) => Err(StoredConfig::Empty),
        _ => Err(StoredConfig::Damaged),
    }
}

/// The record in the slot beside this one.
pub(super) fn other_record(flash: &mut impl FlashPages, slot: FlashSlot) -> Option<RecordHeader> {
    match content(flash, slot.other()) {
        Content::Record(record) => Some(record),
        Content::Blank | Content::Broken => None,
    }
}

/// Whether the slot beside the newest record is as a store leaves it: it holds the record before, or the newest record
/// is the first one and nothing was ever written there. Anything else is a store that the power cut short, or a header
/// that has decayed and may have been the newest.
pub(super) fn is_whole_beside(flash: &mut impl FlashPages, slot: FlashSlot, newest: &RecordHeader) -> bool {
    match content(flash, slot.other()) {
        Content::Record(_) => true,
        Content::Blank => newest.sequence == 1 && is_blank(flash, slot.other()),
        Content::Broken => false,
    }
}

/// Whether one of the two slots has lost what it held, so that the newest record may be an older one. False where there
/// is no record at all; [`load`](super::load) reports that.
pub fn has_lost_a_copy(flash: &mut impl FlashPages, first: FlashSlot) -> bool {
    newest(flash, first).is_ok_and(|(slot, record)| !is_whole_beside(flash, slot, &record))
}

/// Erasures of both slots together, by the newest record's sequence number. The next record counts an erasure that a
/// power failure cut short, if it left a trace; several in a row count as one. The count restarts when both records
/// are lost.
pub fn erasures(flash: &mut impl FlashPages, first: FlashSlot) -> u32 {
    newest(flash, first).map_or(0, |(_, record)| record.sequence)
}

/// Erases a slot if anything is in it.
///
/// # Errors
/// [`FlashError`] if the chip reports one.
pub(super) fn wipe(flash: &mut impl FlashPages, slot: FlashSlot) -> Result<(), FlashError> {
    if is_blank(flash, slot) { Ok(()) } else { flash.erase(slot) }
}
