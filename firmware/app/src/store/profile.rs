//! The actuator's profile in flash: a record as a table's is, in two slots of its own.

use slipline_protocol::event::StoredConfig;
use slipline_protocol::frame::CRC;
use slipline_protocol::profile::{ActuatorProfile, PROFILE_BYTES};

use super::slots::{has_lost_a_copy, is_whole_beside, newest, other_record};
use super::{FORGOTTEN, LAYOUT, PROFILE, RecordHeader, put, write_record};
use crate::ports::{FLASH_WORD, FlashError, FlashPages, FlashSlot};

/// The first of its slots.
const FIRST: FlashSlot = FlashSlot::ProfileA;
/// Words of a profile's record behind its header.
const WORDS: usize = PROFILE_BYTES / FLASH_WORD;
const _: () = assert!(PROFILE_BYTES == WORDS * FLASH_WORD);

/// The profile that is kept, if there is one, and how the flash was found.
///
/// An older profile is used only with a report ([`StoredConfig::FellBack`]); where one may have been lost altogether it is
/// [`StoredConfig::Damaged`].
pub fn load_profile(flash: &mut impl FlashPages) -> (Option<ActuatorProfile>, StoredConfig) {
    let has_lost_a_copy = has_lost_a_copy(flash, FIRST);
    match (read(flash), has_lost_a_copy) {
        (Ok(Some(profile)), false) => (Some(profile), StoredConfig::Loaded),
        (Ok(Some(profile)), true) => (Some(profile), StoredConfig::FellBack),
        (Ok(None), false) => (None, StoredConfig::Empty),
        (Ok(None), true) => (None, StoredConfig::Damaged),
        // The older one limits, if it is whole.
        (Err(stored), _) => match older(flash) {
            Some(profile) => (Some(profile), StoredConfig::FellBack),
            None => (None, stored),
        },
    }
}

/// The profile beside the newest record, which is a damaged profile.
fn older(flash: &mut impl FlashPages) -> Option<ActuatorProfile> {
    let (slot, _) = newest(flash, FIRST).ok().filter(|(_, record)| is_profile(record))?;
    let older = other_record(flash, slot).filter(is_profile)?;
    payload(flash, slot.other(), &older)
}

fn is_profile(record: &RecordHeader) -> bool {
    (record.layout, record.kind) == (LAYOUT, PROFILE)
}

/// The newest record: a profile, or the absence of one.
fn read(flash: &mut impl FlashPages) -> Result<Option<ActuatorProfile>, StoredConfig> {
    let (slot, record) = match newest(flash, FIRST) {
        Ok(newest) => newest,
        Err(StoredConfig::Empty) => return Ok(None),
        Err(stored) => return Err(stored),
    };
    // A layout or a kind that is not known may be a profile of another version: it must not be ignored.
    if (record.layout, record.kind) == (LAYOUT, FORGOTTEN) {
        return Ok(None);
    }
    let profile = is_profile(&record).then(|| payload(flash, slot, &record)).flatten();
    profile.map(Some).ok_or(StoredConfig::Damaged)
}

/// The profile of a record in a slot, if it is whole.
fn payload(flash: &mut impl FlashPages, slot: FlashSlot, record: &RecordHeader) -> Option<ActuatorProfile> {
    let mut bytes = [0; PROFILE_BYTES];
    for (index, part) in bytes.chunks_exact_mut(FLASH_WORD).enumerate() {
        let mut word = [0; FLASH_WORD];
        flash.read(slot, (index + 1) * FLASH_WORD, &mut word).ok()?;
        part.copy_from_slice(&word);
    }
    (CRC.checksum(&bytes) == record.crc).then(|| ActuatorProfile::read(&bytes))?
}

/// Whether this very profile (or its absence) is stored and the other slot is whole, so that writing would change nothing.
pub fn holds_profile(flash: &mut impl FlashPages, profile: Option<&ActuatorProfile>) -> bool {
    match newest(flash, FIRST) {
        Ok((slot, record)) => {
            is_whole_beside(flash, slot, &record) && read(flash).is_ok_and(|kept| kept.as_ref() == profile)
        }
        Err(stored) => stored == StoredConfig::Empty && profile.is_none(),
    }
}

/// Stores a profile, or the absence of one.
///
/// # Errors
/// [`FlashError`] if the slots are too small, or the flash reports an error or reads back wrong. The record before stays whole
/// then.
pub fn save_profile(
    flash: &mut impl FlashPages,
    profile: Option<&ActuatorProfile>,
) -> Result<(), FlashError> {
    let Some(profile) = profile else {
        return write_record(flash, FIRST, FORGOTTEN, 0, |_| [0; FLASH_WORD]);
    };
    let mut bytes = [0; PROFILE_BYTES];
    profile.write(&mut bytes).ok_or(FlashError)?;
    write_record(flash, FIRST, PROFILE, WORDS, |index| {
        let mut word = [0; FLASH_WORD];
        let part = bytes.chunks_exact(FLASH_WORD).nth(index).unwrap_or_default();
        put(&mut word, 0, part);
        word
    })
}
