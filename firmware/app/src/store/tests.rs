//! the power fails at every write and erase, twice in a row and in several ways, in flash with and without
//! error correction; what is read back is always a whole record.

mod copies;

use std::vec;
use std::vec::Vec;

use slipline_protocol::limits::MAX_KNOT_STEP;

use super::*;

const RATE: u32 = 400_000;

/// The state of the word that was being written, or the slot that was being erased, when the power failed.
#[derive(Clone, Copy, Debug)]
enum Tear {
    /// Unchanged.
    Before,
    /// This many bytes are written, or this share of 32 of the slot is erased.
    Bytes(usize),
    /// Reading it is an ECC error.
    Unreadable,
    /// Completely written or erased; the next operation was not begun.
    After,
}

const TEARS: [Tear; 7] = [
    Tear::Before,
    Tear::Bytes(1),
    Tear::Bytes(4),
    Tear::Bytes(8),
    Tear::Bytes(31),
    Tear::Unreadable,
    Tear::After,
];

#[derive(Clone)]
struct Flash {
    slots: [Vec<u8>; 2],
    unreadable: [Vec<bool>; 2],
    /// Operations left until the power fails, and what it leaves.
    cut: Option<(usize, Tear)>,
    dead: bool,
    operations: usize,
}

impl Flash {
    fn new() -> Self {
        Self {
            slots: [vec![0xff; SLOT_BYTES], vec![0xff; SLOT_BYTES]],
            unreadable: [vec![false; SLOT_BYTES / FLASH_WORD], vec![false; SLOT_BYTES / FLASH_WORD]],
            cut: None,
            dead: false,
            operations: 0,
        }
    }

    /// The device starts again.
    fn powered_up(mut self) -> Self {
        self.dead = false;
        self.cut = None;
        self.operations = 0;
        self
    }

    /// Counts an operation; returns what it leaves if the power fails in it.
    fn operate(&mut self) -> Result<Option<Tear>, FlashError> {
        if self.dead {
            return Err(FlashError);
        }
        self.operations += 1;
        match self.cut {
            Some((0, tear)) => {
                self.dead = true;
                Ok(Some(tear))
            }
            Some((left, tear)) => {
                self.cut = Some((left - 1, tear));
                Ok(None)
            }
            None => Ok(None),
        }
    }
}

impl FlashPages for Flash {
    fn slot_len(&self, _: FlashSlot) -> usize {
        SLOT_BYTES
    }

    fn endurance(&self) -> u32 {
        10_000
    }

    fn erase(&mut self, slot: FlashSlot) -> Result<(), FlashError> {
        let tear = self.operate()?;
        let (bytes, bad) = (&mut self.slots[slot as usize], &mut self.unreadable[slot as usize]);
        match tear {
            Some(Tear::Before) => {}
            // An erase that stops half-way leaves a part erased.
            Some(Tear::Bytes(part)) => bytes[..SLOT_BYTES * part / FLASH_WORD].fill(0xff),
            Some(Tear::Unreadable) => bad.fill(true),
            Some(Tear::After) | None => {
                bytes.fill(0xff);
                bad.fill(false);
            }
        }
        if self.dead { Err(FlashError) } else { Ok(()) }
    }

    fn write(&mut self, slot: FlashSlot, offset: usize, word: &Word) -> Result<(), FlashError> {
        let tear = self.operate()?;
        let place = &mut self.slots[slot as usize][offset..offset + FLASH_WORD];
        assert!(place.iter().all(|&byte| byte == 0xff), "a word is written once after an erase");
        let done = match tear {
            Some(Tear::Before) => 0,
            Some(Tear::Bytes(done)) => done,
            Some(Tear::Unreadable) => {
                self.unreadable[slot as usize][offset / FLASH_WORD] = true;
                FLASH_WORD
            }
            Some(Tear::After) | None => FLASH_WORD,
        };
        place[..done].copy_from_slice(&word[..done]);
        if self.dead { Err(FlashError) } else { Ok(()) }
    }

    fn read(&mut self, slot: FlashSlot, offset: usize, word: &mut Word) -> Result<(), FlashError> {
        if self.dead || self.unreadable[slot as usize][offset / FLASH_WORD] {
            return Err(FlashError);
        }
        word.copy_from_slice(&self.slots[slot as usize][offset..offset + FLASH_WORD]);
        Ok(())
    }
}

type Kept = (TableHeader, Vec<Knot>);

fn table(knots: u16, seed: u32) -> Kept {
    let knots: Vec<Knot> = (0..u32::from(knots))
        .map(|i| Knot { step: seed + i * 1000 + 1, gain: Gain(1 + (seed ^ i) % (1 << 31)) })
        .collect();
    let count = knots.len() as u16;
    let crc = table::digest(1000, 2000, RATE, count, |i| knots[usize::from(i)]);
    let header =
        TableHeader { knots: count, span_start_um: 1000, span_end_um: 2000, sample_rate_hz: RATE, crc };
    (header, knots)
}

fn read_back(flash: &mut Flash) -> Result<Kept, StoredConfig> {
    let mut knots = Vec::new();
    let header = load(flash, RATE, |index, knot| {
        assert_eq!(usize::from(index), knots.len());
        knots.push(knot);
    })?;
    assert!(is_sound(&header, |i| knots[usize::from(i)]));
    Ok((header, knots))
}

fn keep(flash: &mut Flash, (header, knots): &Kept) -> Result<(), FlashError> {
    save(flash, header, |index| knots[usize::from(index)])
}

#[test]
fn what_is_kept_is_read_back_and_what_is_forgotten_is_not() {
    let mut flash = Flash::new();
    assert_eq!(read_back(&mut flash), Err(StoredConfig::Empty));
    for knots in [2, 3, 5, 257, 1025] {
        let kept = table(knots, u32::from(knots));
        keep(&mut flash, &kept).unwrap();
        assert_eq!(read_back(&mut flash), Ok(kept));
    }
    forget(&mut flash).unwrap();
    assert_eq!(read_back(&mut flash), Err(StoredConfig::Empty));
}

/// Asserts that a power failure left the content before the store or the one after it, whole.
fn check(flash: &Flash, old: &Result<Kept, StoredConfig>, new: &Result<Kept, StoredConfig>, what: &str) {
    let found = read_back(&mut flash.clone().powered_up());
    // Where no table was stored, a half-written header is reported as damage, not as blank flash. There is no table in
    // either case.
    let nothing = |content: &Result<Kept, StoredConfig>| {
        matches!(content, Err(StoredConfig::Empty | StoredConfig::Damaged))
    };
    assert!(
        found == *old || found == *new || (nothing(old) && nothing(&found)),
        "{what}: {:?}",
        found.map(|(header, _)| header)
    );
}

#[test]
fn power_cut_at_any_moment_and_again_at_any_moment_leaves_the_old_or_the_new_whole() {
    let (old, new, newer) = (table(9, 7), table(6, 1_000_000), table(3, 2_000_000));
    let mut blank = Flash::new();
    let mut once = Flash::new();
    keep(&mut once, &old).unwrap();
    let mut twice = once.clone();
    keep(&mut twice, &table(4, 3)).unwrap();
    keep(&mut twice, &old).unwrap();
    let mut forgotten = twice.clone();
    forget(&mut forgotten).unwrap();
    let nothing = Err(StoredConfig::Empty);
    let starts = [
        (&mut blank, nothing.clone()),
        (&mut once, Ok(old.clone())),
        (&mut twice, Ok(old)),
        (&mut forgotten, nothing.clone()),
    ];
    let mut cuts = 0;
    for (start, before) in starts {
        for forgetting in [false, true] {
            let store = |flash: &mut Flash| if forgetting { forget(flash) } else { keep(flash, &new) };
            let after = if forgetting { nothing.clone() } else { Ok(new.clone()) };
            let mut whole = start.clone().powered_up();
            store(&mut whole).unwrap();
            assert_eq!(read_back(&mut whole), after);
            for first in 0..whole.operations {
                for first_tear in TEARS {
                    let mut torn = start.clone().powered_up();
                    torn.cut = Some((first, first_tear));
                    assert_eq!(store(&mut torn), Err(FlashError));
                    check(&torn, &before, &after, "one cut");
                    let torn = torn.powered_up();
                    let between = read_back(&mut torn.clone());
                    // The user tries again with another table, and the power fails again.
                    let mut retried = torn.clone();
                    keep(&mut retried, &newer).unwrap();
                    assert_eq!(read_back(&mut retried), Ok(newer.clone()));
                    for second in 0..retried.operations {
                        for second_tear in TEARS {
                            let mut again = torn.clone();
                            again.cut = Some((second, second_tear));
                            assert_eq!(keep(&mut again, &newer), Err(FlashError));
                            check(&again, &between, &Ok(newer.clone()), "two cuts");
                            cuts += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(cuts > 1000, "{cuts}");
}

#[test]
fn every_single_flipped_bit_is_found() {
    let mut flash = Flash::new();
    let kept = table(7, 99);
    keep(&mut flash, &kept).unwrap();
    let used = FLASH_WORD * 4;
    for at in 0..used {
        for bit in 0..8 {
            let mut rotten = flash.clone();
            rotten.slots[0][at] ^= 1 << bit;
            assert_eq!(read_back(&mut rotten), Err(StoredConfig::Damaged), "byte {at} bit {bit}");
        }
    }
}

#[test]
fn the_sequence_number_wraps_and_the_newest_still_wins() {
    let mut flash = Flash::new();
    let kept = table(5, 5);
    keep(&mut flash, &kept).unwrap();
    let word: Word = flash.slots[0][..FLASH_WORD].try_into().unwrap();
    let last = RecordHeader { sequence: u32::MAX, ..RecordHeader::decode(&word).unwrap() };
    flash.slots[0][..FLASH_WORD].copy_from_slice(&last.encode());
    for seed in 0..5 {
        let next = table(6, 1000 + seed);
        keep(&mut flash, &next).unwrap();
        assert_eq!(read_back(&mut flash), Ok(next));
    }
}

#[test]
fn another_layout_or_another_sample_rate_is_reported_as_another_version() {
    let mut flash = Flash::new();
    keep(&mut flash, &table(5, 5)).unwrap();
    assert_eq!(load(&mut flash, RATE + 1, |_, _| {}), Err(StoredConfig::WrongVersion));
    let word: Word = flash.slots[0][..FLASH_WORD].try_into().unwrap();
    let other = RecordHeader { layout: LAYOUT + 1, ..RecordHeader::decode(&word).unwrap() };
    flash.slots[0][..FLASH_WORD].copy_from_slice(&other.encode());
    assert_eq!(read_back(&mut flash), Err(StoredConfig::WrongVersion));
}

#[test]
fn a_whole_record_of_an_invalid_table_is_not_sound() {
    let (header, mut knots) = table(5, 5);
    assert!(is_sound(&header, |i| knots[usize::from(i)]));
    knots[3].step = MAX_KNOT_STEP + 1;
    assert!(!is_sound(&header, |i| knots[usize::from(i)]));
}
