//! The upload of a table: in order, without gaps, into the slot that is not in force, then checked as a whole.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::command::{TableChunk, TableHeader};
use slipline_protocol::limits::{MAX_KNOTS, MIN_KNOTS};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::table::{self, Digester, Knot, Validator};
use slipline_protocol::units::SampleIndex;

use crate::mailbox::Mailbox;
use crate::range::{in_range, within};
use crate::slots::{SlotIndex, TableRef};

/// Knots that are worked on between two looks for a stop. Judging the travel of more takes so long while lock-ins measure that a
/// stop may miss the block that waits.
const KNOTS_AT_ONCE: usize = 1;

/// An upload under way.
///
/// Each knot is checked and added to the digest when it comes, so that a commit takes no longer than a chunk.
#[derive(Clone, Debug)]
pub struct Upload {
    header: TableHeader,
    slot: SlotIndex,
    received: u16,
    moved_at: SampleIndex,
    validator: Validator,
    /// Refusal for the first invalid knot, given at the commit.
    fault: Option<Refusal>,
    digester: Digester,
}

/// Checks the header's fields.
///
/// # Errors
/// [`Refusal::OutOfRange`].
pub fn check_header(header: &TableHeader, sample_rate_hz: u32) -> Result<(), Refusal> {
    in_range(Field::KnotCount, MIN_KNOTS as u64, MAX_KNOTS as u64, header.knots.into())?;
    within(Field::SampleRate, (sample_rate_hz, sample_rate_hz), header.sample_rate_hz)?;
    within(Field::Span, (0, u32::MAX - 1), header.span_start_um)?;
    within(Field::Span, (header.span_start_um.saturating_add(1), u32::MAX), header.span_end_um)
}

/// The digest of what a slot holds under a header. `look` is called every few knots.
pub fn digest<M: RawMutex>(
    header: &TableHeader,
    slot: SlotIndex,
    mailbox: &Mailbox<M>,
    mut look: impl FnMut(),
) -> u32 {
    let TableHeader { span_start_um, span_end_um, sample_rate_hz, knots, .. } = *header;
    table::digest(span_start_um, span_end_um, sample_rate_hz, knots, |index| {
        if usize::from(index).is_multiple_of(KNOTS_AT_ONCE) {
            look();
        }
        mailbox.slots().knot(slot, index)
    })
}

impl Upload {
    /// Begins an upload into `slot`.
    ///
    /// # Errors
    /// [`Refusal::OutOfRange`] for the header's fields.
    pub fn begin(
        header: &TableHeader,
        slot: SlotIndex,
        sample_rate_hz: u32,
        now: SampleIndex,
    ) -> Result<Self, Refusal> {
        check_header(header, sample_rate_hz)?;
        let TableHeader { span_start_um, span_end_um, sample_rate_hz, knots, .. } = *header;
        Ok(Self {
            header: *header,
            slot,
            received: 0,
            moved_at: now,
            validator: Validator::default(),
            fault: None,
            digester: Digester::new(span_start_um, span_end_um, sample_rate_hz, knots),
        })
    }

    /// Takes the next knots, a few at once: `took` is called after each few with all that have been taken so far, and with the
    /// first of the few. It may look for a stop, since a chunk takes a good part of a block's time; a chunk is taken whole,
    /// whatever it finds.
    ///
    /// # Errors
    /// [`Refusal::ChunkOrder`] for any but the next, or after the last; [`Refusal::OutOfRange`] for none or too many. Nothing is taken
    /// then.
    pub fn take<M: RawMutex>(
        &mut self,
        chunk: &TableChunk,
        mailbox: &Mailbox<M>,
        now: SampleIndex,
        mut took: impl FnMut(TableRef, u16),
    ) -> Result<(), Refusal> {
        let left = usize::from(self.header.knots.saturating_sub(self.received));
        if chunk.first != self.received || left == 0 {
            return Err(Refusal::ChunkOrder { expected: self.received });
        }
        in_range(Field::KnotCount, 1, left as u64, chunk.knots.len() as u64)?;
        for few in chunk.knots.chunks(KNOTS_AT_ONCE) {
            let first = self.received;
            for &knot in few {
                self.take_one(knot, mailbox);
            }
            took(self.written(), first);
        }
        self.moved_at = now;
        Ok(())
    }

    fn take_one<M: RawMutex>(&mut self, knot: Knot, mailbox: &Mailbox<M>) {
        let is_written = mailbox.write_knot(self.slot, self.received, knot);
        if self.fault.is_none() {
            // A slot that is not free any more does not hold what was sent.
            self.fault = if is_written { self.validator.take(knot).err() } else { Some(Refusal::TableCrc) };
        }
        self.digester.take(knot);
        self.received = self.received.saturating_add(1);
    }

    /// Checks the whole: all there, valid, and what was announced.
    ///
    /// # Errors
    /// [`Refusal::UploadIncomplete`], [`Refusal::TableCrc`], or what [`table::validate`] finds.
    pub fn check(&self) -> Result<(), Refusal> {
        if self.received < self.header.knots {
            return Err(Refusal::UploadIncomplete { received: self.received });
        }
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        if self.digester.clone().finish() != self.header.crc {
            return Err(Refusal::TableCrc);
        }
        Ok(())
    }

    /// The announced header.
    #[must_use]
    pub const fn header(&self) -> &TableHeader {
        &self.header
    }

    /// The table as the renderer would name it.
    #[must_use]
    pub const fn table(&self) -> TableRef {
        TableRef { slot: self.slot, knots: self.header.knots }
    }

    /// The part of the table that has arrived so far.
    #[must_use]
    pub const fn written(&self) -> TableRef {
        TableRef { slot: self.slot, knots: self.received }
    }

    /// Knots received so far.
    #[must_use]
    pub const fn received(&self) -> u16 {
        self.received
    }

    /// Whether the last knots came `after` samples ago or earlier.
    #[must_use]
    pub const fn is_stale(&self, now: SampleIndex, after: u64) -> bool {
        now.saturating_sub(self.moved_at) >= after
    }
}
