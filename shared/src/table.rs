//! The turning-point table: the frequency and the gain that put an equal peak at any position on the plate.
//!
//! Knots are uniform in position over the span. Each holds a phase step (the frequency whose turning point lies there)
//! and a gain (the inverse of the response from DAC code to plate peak). Between knots both are linear. Host and device
//! interpolate by the functions of this file, so their results are equal bit for bit.

use crate::limits::{MAX_KNOT_STEP, MAX_KNOTS, MIN_KNOTS};
use crate::refusal::{Field, Refusal};
use crate::schema::body;
use crate::units::{FinePosition, Gain, PhaseStep};

body! {
    /// One knot of a turning-point table.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Knot {
        /// Phase step: the frequency divided by the sample rate.
        pub step: u32 ["2^-32 turns per sample", 1, MAX_KNOT_STEP],
        /// The factor from the peak on the plate to the amplitude at the DAC.
        pub gain: Gain ["2^-31 of the DAC's half swing", 1, Gain::FULL.0],
    }
}

/// The table's value at one position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setting {
    /// The phase step of a tone at this position.
    pub step: PhaseStep,
    /// The factor from the peak on the plate to the amplitude at the DAC.
    pub gain: Gain,
}

/// The value at `position` of a table of `count` knots, which `knot` returns by index.
///
/// [`place`] finds the two knots and [`between`] interpolates. With a `count` below 2 it is the value of knot 0.
pub fn evaluate(count: u16, position: FinePosition, knot: impl Fn(u16) -> Knot) -> Setting {
    let last = count.saturating_sub(1);
    let (index, fraction) = place(count, position);
    between(knot(index), knot((index + 1).min(last)), fraction)
}

/// Between which two of `count` knots a position lies: the index of the first one, and the fraction of the way to the
/// next one, Q1.31, 0..=2^31.
///
/// With `t = position * (count - 1)` the index is `min(floor(t), count - 2)` and the fraction is `t - index`.
#[inline]
pub const fn place(count: u16, position: FinePosition) -> (u16, u32) {
    let last = count.saturating_sub(1);
    // At most 2^31 * 1024: 42 bits.
    let t = position.raw() as u64 * last as u64;
    let (index, last_interval) = (t >> 31, last.saturating_sub(1) as u64);
    let index = if index < last_interval { index } else { last_interval };
    (index as u16, (t - (index << 31)) as u32)
}

/// The value at `fraction` (Q1.31, 0..=2^31) of the way from knot `a` to knot `b`: `a + fraction (b - a)`. The step is
/// exact in Q0.64, the gain is rounded down to Q1.31.
#[inline]
pub const fn between(a: Knot, b: Knot, fraction: u32) -> Setting {
    // Weighted sums need no signs, unlike a difference times the fraction, and are as exact. The weights add up to
    // 2^31, so no sum exceeds 63 bits.
    let (there, here) = (fraction as u64, (1u32 << 31).wrapping_sub(fraction) as u64);
    let step = (a.step as u64 * here + b.step as u64 * there) << 1;
    let gain = (a.gain.0 as u64 * here + b.gain.0 as u64 * there) >> 31;
    Setting { step: PhaseStep(step), gain: Gain(gain as u32) }
}

/// Between which two of `count` knots the tones of a phase step (Q0.32) lie: the index of the first one, and the fraction of
/// the way to the next one, Q1.31, 0..=2^31, rounded down. `None` for a step outside the table's, and for a table of fewer
/// than two knots.
///
/// The steps must rise or fall strictly, as [`validate`] checks.
pub fn place_of_step(count: u16, step: u32, knot: impl Fn(u16) -> Knot) -> Option<(u16, u32)> {
    let last = count.checked_sub(1).filter(|&last| last > 0)?;
    let rises = knot(0).step < knot(last).step;
    // Whether the knot at an index comes after the step.
    let is_after = |index: u16| if rises { knot(index).step > step } else { knot(index).step < step };
    let is_before = |index: u16| if rises { knot(index).step < step } else { knot(index).step > step };
    if is_after(0) || is_before(last) {
        return None;
    }
    // The first interval whose end is not before the step.
    let (mut low, mut high) = (0, last - 1);
    while low < high {
        let middle = low + (high - low) / 2;
        if is_before(middle + 1) { low = middle + 1 } else { high = middle }
    }
    let (a, b) = (knot(low).step, knot(low + 1).step);
    let way = u64::from(a.abs_diff(b)).max(1);
    Some((low, ((u64::from(step.abs_diff(a)) << 31) / way) as u32))
}

/// The position at `fraction` (Q1.31) of the way from the knot at `index` to the next of `count`: the inverse of [`place`], to
/// 2^-31 of the span, rounded down.
#[must_use]
pub const fn position_between(count: u16, index: u16, fraction: u32) -> FinePosition {
    let last = if count > 1 { count as u64 - 1 } else { 1 };
    FinePosition::saturating(((((index as u64) << 31) + fraction as u64) / last) as u32)
}

/// Checks a whole table: [`MIN_KNOTS`] to [`MAX_KNOTS`] knots; steps that rise or fall strictly, within
/// 1..=[`MAX_KNOT_STEP`] (0.45 turns per sample); gains within 1..=[`Gain::FULL`].
///
/// # Errors
/// The fault of the first knot that has one: [`Refusal::OutOfRange`] with the field and its value, or
/// [`Refusal::NotMonotonic`] with the knot's index.
pub fn validate(count: u16, knot: impl Fn(u16) -> Knot) -> Result<(), Refusal> {
    Refusal::check(Field::KnotCount, MIN_KNOTS as i64, MAX_KNOTS as i64, count.into())?;
    let mut validator = Validator::default();
    (0..count).try_for_each(|index| validator.take(knot(index)))
}

/// Checks knots as [`validate`] does, one after another from the first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Validator {
    index: u16,
    previous: Option<u32>,
    is_rising: Option<bool>,
}

impl Validator {
    /// Checks the next knot.
    ///
    /// # Errors
    /// [`Refusal::OutOfRange`] or [`Refusal::NotMonotonic`]. After an error there is nothing more to check.
    pub fn take(&mut self, Knot { step, gain }: Knot) -> Result<(), Refusal> {
        Refusal::check(Field::KnotStep, 1, MAX_KNOT_STEP.into(), step.into())?;
        Refusal::check(Field::KnotGain, 1, Gain::FULL.0.into(), gain.0.into())?;
        if let Some(previous) = self.previous {
            // The first two knots give the direction.
            let is_rising = *self.is_rising.get_or_insert(step > previous);
            let in_order = if is_rising { step > previous } else { step < previous };
            if !in_order {
                return Err(Refusal::NotMonotonic { knot: self.index });
            }
        }
        self.previous = Some(step);
        self.index = self.index.saturating_add(1);
        Ok(())
    }
}

/// The table's CRC-32. It covers, little-endian: the span's start and end in um and the sample rate in Hz, four bytes
/// each; the number of knots, two bytes; and every knot's step and gain, four bytes each.
pub fn digest(
    span_start_um: u32,
    span_end_um: u32,
    sample_rate_hz: u32,
    count: u16,
    mut knot: impl FnMut(u16) -> Knot,
) -> u32 {
    let mut digester = Digester::new(span_start_um, span_end_um, sample_rate_hz, count);
    (0..count).for_each(|index| digester.take(knot(index)));
    digester.finish()
}

/// Computes a table's [`digest`], one knot after another from the first.
#[derive(Clone)]
pub struct Digester(crc::Digest<'static, u32>);

impl core::fmt::Debug for Digester {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.debug_tuple("Digester").field(&self.clone().finish()).finish()
    }
}

impl Digester {
    /// Before the first knot.
    #[must_use]
    pub fn new(span_start_um: u32, span_end_um: u32, sample_rate_hz: u32, count: u16) -> Self {
        let mut crc = crate::frame::CRC.digest();
        crc.update(&span_start_um.to_le_bytes());
        crc.update(&span_end_um.to_le_bytes());
        crc.update(&sample_rate_hz.to_le_bytes());
        crc.update(&count.to_le_bytes());
        Self(crc)
    }

    /// Takes the next knot.
    pub fn take(&mut self, Knot { step, gain }: Knot) {
        self.0.update(&step.to_le_bytes());
        self.0.update(&gain.0.to_le_bytes());
    }

    /// The digest of the knots so far.
    #[must_use]
    pub fn finish(self) -> u32 {
        self.0.finalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Position;
    use proptest::prelude::*;

    fn line(count: u16) -> impl Fn(u16) -> Knot {
        move |i| Knot { step: 1000 + u32::from(i) * 1_000_000 / u32::from(count), gain: Gain(1 << 30) }
    }

    #[test]
    fn the_ends_of_the_span_are_the_first_and_the_last_knot() {
        for count in [2, 3, 513, 1025] {
            let knot = line(count);
            assert_eq!(evaluate(count, Position::START.fine(), &knot).step.0, u64::from(knot(0).step) << 32);
            assert_eq!(
                evaluate(count, Position::END.fine(), &knot).step.0,
                u64::from(knot(count - 1).step) << 32
            );
        }
    }

    #[test]
    fn extreme_knots_do_not_overflow() {
        let steep = |i: u16| Knot {
            step: if i == 0 { 1 } else { MAX_KNOT_STEP },
            gain: if i == 0 { Gain::FULL } else { Gain(1) },
        };
        let near_end = evaluate(2, FinePosition::saturating((1 << 31) - 1), steep);
        assert!(near_end.step.0 >> 32 <= u64::from(MAX_KNOT_STEP) && near_end.gain.0 <= 2);
        assert_eq!(evaluate(0, FinePosition::END, |_| Knot::default()), Setting::default());
    }

    proptest! {
        #[test]
        fn interpolation_is_the_straight_line_between_knots(raw in 0u32..=1 << 31, a in 1..=MAX_KNOT_STEP, b in 1..=MAX_KNOT_STEP) {
            let knot = |i: u16| Knot { step: if i == 0 { a } else { b }, gain: Gain(if i == 0 { a } else { b }) };
            let got = evaluate(2, FinePosition::saturating(raw), knot);
            let u = f64::from(raw) / f64::from(1u32 << 31);
            let want = f64::from(a) + u * (f64::from(b) - f64::from(a));
            prop_assert!((got.step.0 as f64 / 4_294_967_296.0 - want).abs() < 1e-5);
            prop_assert!((f64::from(got.gain.0) - want).abs() <= 1.0);
        }

        #[test]
        fn the_place_of_a_step_is_where_the_table_has_it(
            mut steps in prop::collection::vec(1..=MAX_KNOT_STEP, 2..60),
            falls: bool,
            at in 0.0..=1.0,
        ) {
            steps.sort_unstable();
            steps.dedup();
            prop_assume!(steps.len() > 1);
            if falls {
                steps.reverse();
            }
            let count = steps.len() as u16;
            let knot = |index: u16| Knot { step: steps[usize::from(index)], gain: Gain(1) };
            let (low, high) = (knot(0).step.min(knot(count - 1).step), knot(0).step.max(knot(count - 1).step));
            let wanted = low + (at * f64::from(high - low)) as u32;
            for step in [wanted, low, high].into_iter().chain(steps.iter().copied()) {
                let (index, fraction) = place_of_step(count, step, knot).unwrap();
                prop_assert!(index + 1 < count && fraction <= 1 << 31);
                let there = between(knot(index), knot(index + 1), fraction).step.0;
                // Largest effect of the fraction's rounding.
                let unit = (u64::from(knot(index).step.abs_diff(knot(index + 1).step)) << 1) + 1;
                prop_assert!(there.abs_diff(u64::from(step) << 32) <= unit, "{step}: {there}");
                let position = position_between(count, index, fraction);
                let steepest = steps.windows(2).map(|two| u64::from(two[0].abs_diff(two[1]))).max().unwrap();
                let found = evaluate(count, position, knot).step.0;
                prop_assert!(found.abs_diff(there) <= (steepest << 1) * u64::from(count), "{found} {there}");
            }
            for outside in [low - 1, high.saturating_add(1)] {
                prop_assert_eq!(place_of_step(count, outside, knot), None);
            }
            prop_assert_eq!(place_of_step(1, low, knot), None);
        }

        #[test]
        fn one_bad_knot_makes_the_table_invalid(at in 1u16..600, kind in 0..4) {
            let good = line(601);
            prop_assert_eq!(validate(601, &good), Ok(()));
            let bad = |i: u16| {
                let mut knot = good(i);
                if i == at {
                    match kind {
                        0 => knot.step = good(i - 1).step,
                        1 => knot.step = 0,
                        2 => knot.step = MAX_KNOT_STEP + 1,
                        _ => knot.gain = Gain(Gain::FULL.0 + 1),
                    }
                }
                knot
            };
            prop_assert!(validate(601, bad).is_err());
            prop_assert_ne!(digest(0, 1, 1, 601, &good), digest(0, 1, 1, 601, bad));
        }
    }
}
