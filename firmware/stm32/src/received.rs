//! Which bytes of a receiving DMA's ring have yet to be read.
//!
//! ```text
//! ring   |........RRRRRRRRuuuuuuuuuu..........|      R read, u unread: `count` bytes before `end`
//!                                   ^ end: where the DMA writes next, at the last look
//! ```
//! The place of the DMA is known modulo the ring only. Its two flags, for the ring's half and its end, show what the place does not:
//! that both have risen since the last look says that it has gone over half of the ring, and maybe round it more than once. So a
//! reader may be late by half of the ring. If it is later, what came last is kept, because a stop may be in it; what is lost is
//! known. The flags are taken before the place is read, and looked at once more after it, but not taken: one that rises between two
//! looks is seen by the later one, too.

/// Bytes of the ring.
pub(crate) const RING: usize = 512;
/// A reader that is late by more has lost bytes.
const LATE: usize = RING / 2;
/// The bytes that are certainly new then: a flag may have risen before the place was read the last time and count again, and one
/// may rise after it is read now. Interrupts of a block come between at most, in which the line brings 30 bytes.
const KEPT: usize = LATE - 96;

/// The reader's side of the ring.
pub(crate) struct Received {
    end: usize,
    count: usize,
}

impl Received {
    /// The DMA has yet to write the ring's first byte.
    pub(crate) const fn new() -> Self {
        Self { end: 0, count: 0 }
    }

    /// The DMA is at `end` now, and both of its flags have risen since the last look or not. Returns whether bytes are lost.
    pub(crate) fn look(&mut self, end: usize, both_flags: bool) -> bool {
        let end = end % RING;
        self.count += (RING + end - self.end) % RING;
        self.end = end;
        let is_late = both_flags || self.count > LATE;
        if is_late {
            self.count = KEPT;
        }
        is_late
    }

    /// Number of bytes between the first unread one and a place; more than the ring holds if the place is ahead of the
    /// last look.
    pub(crate) fn until(&self, place: usize) -> usize {
        (RING + place + self.count - self.end) % RING
    }

    /// Takes at most `most` unread bytes: the place of the first, and how many follow each other in the ring.
    pub(crate) fn take(&mut self, most: usize) -> (usize, usize) {
        let first = (RING + self.end - self.count) % RING;
        let count = self.count.min(most).min(RING - first);
        self.count -= count;
        (first, count)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A DMA that writes the low byte of each byte's number, and its flags.
    struct Writer {
        ring: [u8; RING],
        written: usize,
        half: bool,
        whole: bool,
    }

    impl Writer {
        fn write(&mut self, count: usize) {
            for _ in 0..count {
                if let Some(place) = self.ring.get_mut(self.written % RING) {
                    *place = self.written as u8;
                }
                self.written += 1;
                self.half |= self.written % RING == RING / 2;
                self.whole |= self.written.is_multiple_of(RING);
            }
        }

        /// Bytes may come between the place and either look at the flags.
        fn look(&mut self, received: &mut Received, between: (usize, usize)) -> bool {
            let (half, whole) = (self.half, self.whole);
            (self.half, self.whole) = (false, false);
            self.write(between.0);
            let end = self.written % RING;
            self.write(between.1);
            received.look(end, (half || self.half) && (whole || self.whole))
        }
    }

    fn read(writer: &Writer, received: &mut Received, most: usize) -> Vec<u8> {
        let (first, count) = received.take(most);
        writer.ring.get(first..first + count).expect("within the ring").to_vec()
    }

    #[test]
    fn a_place_lies_as_many_bytes_ahead_as_are_unread_before_it_also_across_the_rings_end() {
        let received = Received { end: 10, count: 7 };
        assert_eq!([3, 4, 10].map(|place| received.until(place)), [0, 1, 7]);
        let received = Received { end: 5, count: 7 };
        assert_eq!([RING - 2, RING - 1, 0, 5].map(|place| received.until(place)), [0, 1, 2, 7]);
    }

    proptest! {
        /// In order and none twice, but where the look has said that bytes are lost; and that it says whenever some are.
        #[test]
        fn every_byte_is_read_once_or_known_to_be_lost(
            steps in prop::collection::vec((0..1400_usize, (0..30_usize, 0..30_usize), 0..600_usize), 1..60),
        ) {
            let mut writer = Writer { ring: [0; RING], written: 0, half: false, whole: false };
            let (mut received, mut next) = (Received::new(), 0);
            for (count, between, most) in steps {
                // In most cases the reader is in time.
                writer.write(if count > 300 { count } else { count / 4 });
                let is_lost = writer.look(&mut received, between);
                if is_lost {
                    let kept = writer.written - between.1 - received.count;
                    prop_assert!(kept >= next, "{} bytes are read twice", next - kept);
                    next = kept;
                }
                let bytes = read(&writer, &mut received, most);
                let expected: Vec<u8> = (next..next + bytes.len()).map(|number| number as u8).collect();
                prop_assert_eq!(&bytes, &expected);
                next += bytes.len();
                prop_assert_eq!(next + received.count, writer.written - between.1, "no byte is forgotten");
            }
        }
    }

    #[test]
    fn a_reader_late_by_half_the_ring_loses_nothing_and_a_later_one_keeps_the_newest() {
        for (late, kept) in [(LATE, LATE), (LATE + 1, KEPT), (RING, KEPT), (RING + 3, KEPT), (5 * RING, KEPT)]
        {
            let mut writer = Writer { ring: [0; RING], written: 0, half: false, whole: false };
            writer.write(late);
            let mut received = Received::new();
            assert_eq!(writer.look(&mut received, (0, 0)), late > LATE, "{late}");
            assert_eq!(received.count, kept);
            let mut bytes = read(&writer, &mut received, RING);
            bytes.append(&mut read(&writer, &mut received, RING));
            assert_eq!(bytes.len(), kept);
            assert_eq!(bytes.last(), Some(&((late - 1) as u8)));
        }
    }

    /// The place alone would show 8 bytes, and the flags that were taken before it one of the two.
    #[test]
    fn a_round_that_ends_between_the_flags_and_the_place_is_seen() {
        let mut writer = Writer { ring: [0; RING], written: 0, half: false, whole: false };
        let mut received = Received::new();
        writer.write(RING / 2);
        assert!(!writer.look(&mut received, (0, 0)));
        assert_eq!(read(&writer, &mut received, RING).len(), RING / 2);
        writer.write(RING - 12);
        assert!(writer.look(&mut received, (20, 0)), "a round is lost");
    }
}
