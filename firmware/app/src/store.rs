//! The table stored in flash: a record in one of two slots; the other slot holds the record before it.
//!
//! ```text
//! slot   = header word | payload words                                          (32 bytes a word)
//! header = magic 4 | layout 1 | kind 1 | zero 2 | sequence 4 | bytes 4 | payload crc 4 | zero 8 | header crc 4
//! payload (kind 1) = span start 4 | span end 4 | sample rate 4 | knots 2 | zero 2 | table crc 4 | zero 12
//!                    then per knot: step 4 | gain 4                              (little-endian, zeros to the word)
//! payload (kind 0) = nothing: no table is stored
//! payload (kind 2) = an actuator's profile as it goes over the wire, zeros to three words (`profile`)
//! ```
//! A record is written into the slot that does not hold the newest record: erase, payload, header last. So whenever the
//! power fails, the newest record with a valid header is the complete old or the complete new one. The record with the
//! higher sequence number is the newer; the number wraps. If a payload is damaged later, the store reports damage and
//! does not use the older table, which the user had replaced. If a header is damaged later, the older record becomes
//! the newest: [`has_lost_a_copy`] reports that, so that it is not used unnoticed.
//!
//! Flash wears with each erasure, so what is stored already is not written again ([`holds`]), and the sequence number
//! counts the erasures ([`erasures`]).

use slipline_protocol::command::TableHeader;
use slipline_protocol::event::StoredConfig;
use slipline_protocol::frame::CRC;
use slipline_protocol::limits::MAX_KNOTS;
use slipline_protocol::table::{self, Knot};
use slipline_protocol::units::Gain;

mod budget;
mod profile;
mod slots;

use self::slots::{is_whole_beside, newest, wipe};
use crate::ports::{FLASH_WORD, FlashError, FlashPages, FlashSlot};
use crate::upload::check_header;

pub use self::budget::Budget;
pub use self::profile::{holds_profile, load_profile, save_profile};
pub use self::slots::{erasures, has_lost_a_copy};

type Word = [u8; FLASH_WORD];

const MAGIC: [u8; 4] = *b"SLst";
/// Rises when the layout of a slot changes.
const LAYOUT: u8 = 1;
const FORGOTTEN: u8 = 0;
const TABLE: u8 = 1;
const PROFILE: u8 = 2;
const KNOTS_PER_WORD: usize = FLASH_WORD / 8;

/// The bytes that a slot must have at least.
pub const SLOT_BYTES: usize = FLASH_WORD * (2 + MAX_KNOTS.div_ceil(KNOTS_PER_WORD));

/// A slot's header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RecordHeader {
    layout: u8,
    kind: u8,
    sequence: u32,
    bytes: u32,
    crc: u32,
}

impl RecordHeader {
    fn encode(&self) -> Word {
        let mut word = [0; FLASH_WORD];
        let crc_at = FLASH_WORD - 4;
        put(&mut word, 0, &MAGIC);
        put(&mut word, 4, &[self.layout, self.kind]);
        put(&mut word, 8, &self.sequence.to_le_bytes());
        put(&mut word, 12, &self.bytes.to_le_bytes());
        put(&mut word, 16, &self.crc.to_le_bytes());
        let crc = CRC.checksum(word.get(..crc_at).unwrap_or_default());
        put(&mut word, crc_at, &crc.to_le_bytes());
        word
    }

    fn decode(word: &Word) -> Option<Self> {
        let (covered, crc) = word.split_last_chunk::<4>()?;
        let whole = CRC.checksum(covered) == u32::from_le_bytes(*crc) && word.starts_with(&MAGIC);
        whole.then_some(Self {
            layout: *word.get(4)?,
            kind: *word.get(5)?,
            sequence: number(word, 8)?,
            bytes: number(word, 12)?,
            crc: number(word, 16)?,
        })
    }
}

fn put(word: &mut Word, at: usize, bytes: &[u8]) {
    for (to, &from) in word.iter_mut().skip(at).zip(bytes) {
        *to = from;
    }
}

fn number(word: &Word, at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*word.get(at..)?.first_chunk::<4>()?))
}

/// Reads the stored table. Checks the CRC of the record and the table's header, then passes index and value of each
/// knot to `sink`. The knots themselves are checked by [`is_sound`].
///
/// # Errors
/// [`StoredConfig::Empty`] if no table is stored or the slots are too small, [`StoredConfig::WrongVersion`] for another
/// layout or another sample rate, [`StoredConfig::Damaged`] for anything else that is not whole. After an error in
/// reading the flash, `sink` may have got some knots.
pub fn load(
    flash: &mut impl FlashPages,
    sample_rate_hz: u32,
    mut sink: impl FnMut(u16, Knot),
) -> Result<TableHeader, StoredConfig> {
    let (slot, record) = newest(flash, FlashSlot::A)?;
    if record.layout != LAYOUT {
        return Err(StoredConfig::WrongVersion);
    }
    if record.kind == FORGOTTEN {
        return Err(StoredConfig::Empty);
    }
    let header = read_header(flash, slot).ok_or(StoredConfig::Damaged)?;
    let words = payload_words(&header).ok_or(StoredConfig::Damaged)?;
    let mut crc = CRC.digest();
    let mut word = [0; FLASH_WORD];
    for index in 0..words {
        flash.read(slot, (index + 1) * FLASH_WORD, &mut word).map_err(|FlashError| StoredConfig::Damaged)?;
        crc.update(&word);
    }
    if crc.finalize() != record.crc || record.kind != TABLE {
        return Err(StoredConfig::Damaged);
    }
    if header.sample_rate_hz != sample_rate_hz {
        return Err(StoredConfig::WrongVersion);
    }
    check_header(&header, sample_rate_hz).map_err(|_| StoredConfig::Damaged)?;
    for index in 0..words - 1 {
        flash.read(slot, (index + 2) * FLASH_WORD, &mut word).map_err(|FlashError| StoredConfig::Damaged)?;
        for part in 0..KNOTS_PER_WORD {
            let knot = index * KNOTS_PER_WORD + part;
            let (Some(step), Some(gain)) = (number(&word, part * 8), number(&word, part * 8 + 4)) else {
                return Err(StoredConfig::Damaged);
            };
            if let Ok(knot) = u16::try_from(knot)
                && knot < header.knots
            {
                sink(knot, Knot { step, gain: Gain(gain) });
            }
        }
    }
    Ok(header)
}

/// The words after the record's header; `None` for an impossible number of knots.
fn payload_words(header: &TableHeader) -> Option<usize> {
    let knots = usize::from(header.knots);
    (knots <= MAX_KNOTS).then_some(1 + knots.div_ceil(KNOTS_PER_WORD))
}

fn read_header(flash: &mut impl FlashPages, slot: FlashSlot) -> Option<TableHeader> {
    let mut word = [0; FLASH_WORD];
    flash.read(slot, FLASH_WORD, &mut word).ok()?;
    Some(TableHeader {
        span_start_um: number(&word, 0)?,
        span_end_um: number(&word, 4)?,
        sample_rate_hz: number(&word, 8)?,
        knots: u16::from_le_bytes(*word.get(12..)?.first_chunk::<2>()?),
        crc: number(&word, 16)?,
    })
}

/// The payload's word at `index`.
fn payload_word(header: &TableHeader, knot: &impl Fn(u16) -> Knot, index: usize) -> Word {
    let mut word = [0; FLASH_WORD];
    let Some(knots_word) = index.checked_sub(1) else {
        put(&mut word, 0, &header.span_start_um.to_le_bytes());
        put(&mut word, 4, &header.span_end_um.to_le_bytes());
        put(&mut word, 8, &header.sample_rate_hz.to_le_bytes());
        put(&mut word, 12, &header.knots.to_le_bytes());
        put(&mut word, 16, &header.crc.to_le_bytes());
        return word;
    };
    for part in 0..KNOTS_PER_WORD {
        if let Ok(index) = u16::try_from(knots_word * KNOTS_PER_WORD + part)
            && index < header.knots
        {
            let Knot { step, gain } = knot(index);
            put(&mut word, part * 8, &step.to_le_bytes());
            put(&mut word, part * 8 + 4, &gain.0.to_le_bytes());
        }
    }
    word
}

/// Stores a table.
///
/// # Errors
/// [`FlashError`] if the slots are too small, the table has too many knots, or the flash reports an error or reads back
/// wrong. The record before stays whole then.
pub fn save(
    flash: &mut impl FlashPages,
    header: &TableHeader,
    knot: impl Fn(u16) -> Knot,
) -> Result<(), FlashError> {
    let words = payload_words(header).ok_or(FlashError)?;
    write_record(flash, FlashSlot::A, TABLE, words, |index| payload_word(header, &knot, index))
}

/// Stores a record that marks the absence of a table.
///
/// # Errors
/// [`FlashError`] if the slots are too small, or the flash reports an error or reads back wrong. The record before
/// stays whole then.
pub fn forget(flash: &mut impl FlashPages) -> Result<(), FlashError> {
    write_record(flash, FlashSlot::A, FORGOTTEN, 0, |_| [0; FLASH_WORD])
}

/// Whether this very table is stored, and the other slot is whole: to store it would change nothing.
pub fn holds(flash: &mut impl FlashPages, header: &TableHeader, knot: impl Fn(u16) -> Knot) -> bool {
    let Ok((slot, record)) = newest(flash, FlashSlot::A) else { return false };
    let Some(words) = payload_words(header) else { return false };
    if (record.layout, record.kind) != (LAYOUT, TABLE) || !is_whole_beside(flash, slot, &record) {
        return false;
    }
    let mut crc = CRC.digest();
    for index in 0..words {
        let (wanted, mut word) = (payload_word(header, &knot, index), [0; FLASH_WORD]);
        if flash.read(slot, (index + 1) * FLASH_WORD, &mut word).is_err() || word != wanted {
            return false;
        }
        crc.update(&word);
    }
    crc.finalize() == record.crc
}

/// Whether no table is stored, so that forgetting it would change nothing.
pub fn holds_nothing(flash: &mut impl FlashPages) -> bool {
    match newest(flash, FlashSlot::A) {
        Ok((slot, record)) => {
            (record.layout, record.kind) == (LAYOUT, FORGOTTEN) && is_whole_beside(flash, slot, &record)
        }
        Err(state) => state == StoredConfig::Empty,
    }
}

/// Writes a record into one of two slots, the first of which is `first`.
fn write_record(
    flash: &mut impl FlashPages,
    first: FlashSlot,
    kind: u8,
    words: usize,
    payload: impl Fn(usize) -> Word,
) -> Result<(), FlashError> {
    if flash.slot_len(first) < SLOT_BYTES {
        return Err(FlashError);
    }
    let (slot, sequence) = match newest(flash, first) {
        Ok((slot, newest)) => {
            // A slot that is not as a store leaves it was erased once more than the records show.
            let erasures = if is_whole_beside(flash, slot, &newest) { 1 } else { 2 };
            (slot.other(), newest.sequence.wrapping_add(erasures))
        }
        Err(_) => {
            // There is no record that could be lost. What is left of one in the other slot would look like a loss.
            wipe(flash, first.other())?;
            (first, 1)
        }
    };
    flash.erase(slot)?;
    let mut crc = CRC.digest();
    for index in 0..words {
        let word = payload(index);
        write_and_check(flash, slot, (index + 1) * FLASH_WORD, &word)?;
        crc.update(&word);
    }
    // At most 8 KiB.
    let bytes = u32::try_from(words * FLASH_WORD).map_err(|_| FlashError)?;
    let header = RecordHeader { layout: LAYOUT, kind, sequence, bytes, crc: crc.finalize() };
    write_and_check(flash, slot, 0, &header.encode())
}

fn write_and_check(
    flash: &mut impl FlashPages,
    slot: FlashSlot,
    offset: usize,
    word: &Word,
) -> Result<(), FlashError> {
    flash.write(slot, offset, word)?;
    let mut back = [0; FLASH_WORD];
    flash.read(slot, offset, &mut back)?;
    if back == *word { Ok(()) } else { Err(FlashError) }
}

/// Whether a loaded table may be used: its knots are valid and its CRC is the one in its header.
#[must_use]
pub fn is_sound(header: &TableHeader, knot: impl Fn(u16) -> Knot) -> bool {
    table::validate(header.knots, &knot).is_ok()
        && table::digest(header.span_start_um, header.span_end_um, header.sample_rate_hz, header.knots, &knot)
            == header.crc
}

#[cfg(test)]
mod tests;
