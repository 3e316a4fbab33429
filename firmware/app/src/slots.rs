//! The two table slots: one is in force, the other takes an upload.
//!
//! The renderer reads a slot while the controller writes the other. Knots are atomics only so that this is sound
//! without a lock round every knot; what keeps them consistent is that a slot which a live or a pending program
//! names is never written (see [`Mailbox::slot_is_free`](crate::mailbox::Mailbox::slot_is_free)).

use core::sync::atomic::{AtomicU32, Ordering};

use slipline_protocol::limits::MAX_KNOTS;
use slipline_protocol::table::{self, Knot, Setting};
use slipline_protocol::units::{FinePosition, Gain};

/// Which slot, and how many knots of it count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TableRef {
    /// The slot.
    pub slot: SlotIndex,
    /// Its knots; 0 where there is no table.
    pub knots: u16,
}

/// The name of a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlotIndex {
    /// The first.
    #[default]
    First,
    /// The second.
    Second,
}

impl SlotIndex {
    /// The other slot.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

struct KnotCell {
    step: AtomicU32,
    gain: AtomicU32,
}

impl KnotCell {
    #[inline(always)]
    fn get(&self) -> Knot {
        Knot { step: self.step.load(Ordering::Relaxed), gain: Gain(self.gain.load(Ordering::Relaxed)) }
    }
}

struct Slot([KnotCell; MAX_KNOTS]);

impl Slot {
    const fn new() -> Self {
        Self([const { KnotCell { step: AtomicU32::new(0), gain: AtomicU32::new(0) } }; MAX_KNOTS])
    }

    fn knot(&self, index: u16) -> Knot {
        self.0.get(usize::from(index)).map_or_else(Knot::default, KnotCell::get)
    }
}

/// One table, looked up.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    slot: &'a Slot,
    knots: u16,
}

impl Table<'_> {
    /// What a tone at `position` needs by this table.
    #[inline(always)]
    pub(crate) fn evaluate(self, position: FinePosition) -> Setting {
        let (index, fraction) = table::place(self.knots, position);
        let index = usize::from(index);
        if let Some([a, b]) = self.slot.0.get(index..index.saturating_add(2)) {
            table::between(a.get(), b.get(), fraction)
        } else {
            table::evaluate(self.knots, position, |index| self.slot.knot(index))
        }
    }
}

/// Both slots: 16 KiB.
pub struct TableSlots {
    first: Slot,
    second: Slot,
}

impl TableSlots {
    /// Both empty.
    #[must_use]
    #[expect(
        clippy::new_without_default,
        reason = "16 KiB belong into a static, which needs the const constructor"
    )]
    pub const fn new() -> Self {
        Self { first: Slot::new(), second: Slot::new() }
    }

    const fn slot(&self, index: SlotIndex) -> &Slot {
        match index {
            SlotIndex::First => &self.first,
            SlotIndex::Second => &self.second,
        }
    }

    /// The knot at `index`; the default beyond the slot's end.
    #[must_use]
    pub fn knot(&self, slot: SlotIndex, index: u16) -> Knot {
        self.slot(slot).knot(index)
    }

    /// Writes the knot at `index`; beyond the slot's end nothing happens.
    pub(crate) fn write(&self, slot: SlotIndex, index: u16, knot: Knot) {
        if let Some(cell) = self.slot(slot).0.get(usize::from(index)) {
            cell.step.store(knot.step, Ordering::Relaxed);
            cell.gain.store(knot.gain.0, Ordering::Relaxed);
        }
    }

    /// What a tone at `position` needs by this table.
    #[must_use]
    pub fn evaluate(&self, table: TableRef, position: FinePosition) -> Setting {
        self.table(table).evaluate(position)
    }

    /// A table to be evaluated for many positions.
    #[must_use]
    #[inline(always)]
    pub(crate) const fn table(&self, table: TableRef) -> Table<'_> {
        Table { slot: self.slot(table.slot), knots: table.knots }
    }
}

/// Which knots the way between two positions touches, first and last, both included.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "at most 1024 after the shift and the division")]
pub fn knots_between(table: TableRef, a: FinePosition, b: FinePosition) -> (u16, u16) {
    let last = table.knots.saturating_sub(1);
    let place = |p: FinePosition| u64::from(p.raw()) * u64::from(last);
    let (low, high) = (a.min(b), a.max(b));
    let first = (place(low) >> 31) as u16;
    let end = place(high).div_ceil(1 << 31) as u16;
    (first.min(last), end.max(first.saturating_add(1)).min(last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_place_on_the_way_lies_outside_the_knots_named(knots in 2u16..=1025, a in 0u32..=1 << 31, b in 0u32..=1 << 31, u in 0u32..=1000) {
            let table = TableRef { slot: SlotIndex::First, knots };
            let (a, b) = (FinePosition::saturating(a), FinePosition::saturating(b));
            let (first, last) = knots_between(table, a, b);
            let way = i64::from(b.raw()) - i64::from(a.raw());
            let p = i64::from(a.raw()) + way * i64::from(u) / 1000;
            let place = p as f64 / f64::from(1u32 << 31) * f64::from(knots - 1);
            prop_assert!(f64::from(first) <= place && place <= f64::from(last), "{first} {place} {last}");
        }
    }
}
