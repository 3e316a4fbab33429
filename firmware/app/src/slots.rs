//! The two table slots: one is in force, the other takes an upload.
//!
//! The renderer reads a slot while the controller writes the other. Knots are atomics only so that this is sound
//! without a lock round every knot; what keeps them consistent is that a slot which a live or a pending program
//! names is never written (see [`Mailbox::slot_is_free`](crate::mailbox::Mailbox::slot_is_free)).

mod maxima;

use core::sync::atomic::{AtomicU32, Ordering};

use slipline_protocol::limits::MAX_KNOTS;
use slipline_protocol::table::{self, Knot, Setting};
use slipline_protocol::units::{FinePosition, Gain};

pub(crate) use self::maxima::Extremes;
use self::maxima::Maxima;

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

struct Slot {
    knots: [KnotCell; MAX_KNOTS],
    maxima: Maxima,
}

impl Slot {
    const fn new() -> Self {
        Self {
            knots: [const { KnotCell { step: AtomicU32::new(0), gain: AtomicU32::new(0) } }; MAX_KNOTS],
            maxima: Maxima::new(),
        }
    }

    fn knot(&self, index: usize) -> Knot {
        self.knots.get(index).map_or_else(Knot::default, KnotCell::get)
    }
}

/// One table, looked up.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    slot: &'a Slot,
    knots: u16,
}

impl Table<'_> {
    /// Step and gain of a tone at `position`.
    #[inline(always)]
    pub(crate) fn evaluate(self, position: FinePosition) -> Setting {
        let (index, fraction) = table::place(self.knots, position);
        let index = usize::from(index);
        if let Some([a, b]) = self.slot.knots.get(index..index.saturating_add(2)) {
            table::between(a.get(), b.get(), fraction)
        } else {
            table::evaluate(self.knots, position, |index| self.slot.knot(index.into()))
        }
    }
}

/// Both slots: 18 KiB.
pub struct TableSlots {
    first: Slot,
    second: Slot,
}

impl TableSlots {
    /// Both empty.
    #[must_use]
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
        self.slot(slot).knot(index.into())
    }

    /// Writes the knot at `index`; beyond the slot's end nothing happens.
    pub(crate) fn write(&self, slot: SlotIndex, index: u16, knot: Knot) {
        let slot = self.slot(slot);
        if let Some(cell) = slot.knots.get(usize::from(index)) {
            cell.step.store(knot.step, Ordering::Relaxed);
            cell.gain.store(knot.gain.0, Ordering::Relaxed);
            slot.maxima.update(index.into(), &slot.knots);
        }
    }

    /// Step and gain of a tone at `position` by a table.
    #[must_use]
    pub fn evaluate(&self, table: TableRef, position: FinePosition) -> Setting {
        self.table(table).evaluate(position)
    }

    /// The largest gain and the steepest interval on the way between two positions, of all knots that it touches.
    pub(crate) fn extremes(&self, table: TableRef, a: FinePosition, b: FinePosition) -> Extremes {
        let (first, last) = knots_between(table, a, b);
        let slot = self.slot(table.slot);
        slot.maxima.between(first.into(), last.into(), &slot.knots)
    }

    /// A table to be evaluated for many positions.
    #[must_use]
    #[inline(always)]
    pub(crate) const fn table(&self, table: TableRef) -> Table<'_> {
        Table { slot: self.slot(table.slot), knots: table.knots }
    }
}

/// First and last knot on the way between two positions, both included.
#[expect(clippy::cast_possible_truncation, reason = "at most 1024 after the shift and the division")]
pub(crate) fn knots_between(table: TableRef, a: FinePosition, b: FinePosition) -> (u16, u16) {
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

    fn knot((step, gain): (u32, u32)) -> Knot {
        Knot { step, gain: Gain(gain) }
    }

    proptest! {
        #[test]
        fn the_extremes_match_every_knot_on_the_way_in_any_order_of_writing(
            old in prop::collection::vec(any::<(u32, u32)>(), MAX_KNOTS),
            new in prop::collection::vec(any::<(u32, u32)>(), 2..=MAX_KNOTS),
            is_backwards: bool,
            ways in prop::collection::vec((0u32..=1 << 31, 0u32..=1 << 31), 20),
        ) {
            let slots = std::boxed::Box::new(TableSlots::new());
            for (index, values) in (0..).zip(old) {
                slots.write(SlotIndex::Second, index, knot(values));
            }
            let count = u16::try_from(new.len()).unwrap();
            for n in 0..count {
                let index = if is_backwards { count - 1 - n } else { n };
                slots.write(SlotIndex::Second, index, knot(new[usize::from(index)]));
            }
            let table = TableRef { slot: SlotIndex::Second, knots: count };
            for (a, b) in ways {
                let (a, b) = (FinePosition::saturating(a), FinePosition::saturating(b));
                let (first, last) = knots_between(table, a, b);
                let touched = &new[usize::from(first)..=usize::from(last)];
                let gain = touched.iter().map(|knot| knot.1).max().unwrap();
                let steepest = touched.windows(2).map(|two| two[0].0.abs_diff(two[1].0)).max().unwrap_or(0);
                prop_assert_eq!(slots.extremes(table, a, b), Extremes { gain, steepest });
            }
        }

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
