//! The turning-point table as the device takes it: fixed-point knots, header and CRC.
//!
//! ```text
//! knots (Hz, gain 0..=1) --from_knots--> DeviceTable (Q0.32 turns, Q1.31) --chunks--> device
//! ```
//! A gain is rounded down, so that a table never exceeds the gain of its plate model; a step is rounded to
//! the nearest value: 2^-33 turns are 47 uHz at 400 kS/s.

use crate::out_of_range::OutOfRange;
use slipline_protocol::command::{TableChunk, TableHeader, TravelLimit};
use slipline_protocol::limits::{self, CHUNK_KNOTS};
use slipline_protocol::refusal::Refusal;
use slipline_protocol::table::{self, Knot, Setting};
use slipline_protocol::units::{FinePosition, Gain, Level, Position};

/// A table that a device accepts: valid by the device's own rule.
///
/// ```
/// use slipline_link::{DeviceTable, DeviceTableError};
///
/// # fn main() -> Result<(), DeviceTableError> {
/// // From 0 to 100 mm the frequency falls from 30 kHz to 20 kHz; 1 um of peak displacement at level 1.
/// let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
/// let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6)?;
/// assert_eq!(table.knots().len(), 101);
/// assert_eq!(table.header().span_end_um, 100_000);
///
/// // Above 0.45 of the sample rate.
/// let error = DeviceTable::from_knots((0.0, 0.1), 400e3, [(30e3, 1.0), (200e3, 1.0)], 1e-6);
/// assert!(matches!(error, Err(DeviceTableError::OutOfRange(out)) if out.field == "frequency (Hz)"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DeviceTable {
    header: TableHeader,
    knots: Vec<Knot>,
    peak_at_full_scale_m: f64,
    /// The peak at level 1 over `peak_at_full_scale_m`, at positions uniform over the span; empty if it is 1
    /// everywhere.
    heights: Vec<f64>,
    travel_limit: Option<TravelLimit>,
}

/// Why a table is not valid for a device.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceTableError {
    /// A length, rate, frequency or gain is not a number or does not fit its field.
    #[error("the table's {0}")]
    OutOfRange(#[from] OutOfRange),
    /// The device's own rule refuses it.
    #[error("the table is not valid: {0}")]
    Invalid(Refusal),
}

impl DeviceTable {
    /// A table from its span in metres, the sample rate in Hz, (frequency in Hz, gain) at knots uniform in position,
    /// and the peak displacement at level 1 in metres.
    ///
    /// # Errors
    /// [`DeviceTableError::OutOfRange`] for a value that does not fit its field (span 0..=4 km, rate 1 Hz..=4 GHz,
    /// frequency above 0 and up to 0.45 of the rate, gain 0..=1); [`DeviceTableError::Invalid`] for what the device
    /// would refuse, such as frequencies that do not rise or fall strictly.
    pub fn from_knots(
        span_m: (f64, f64),
        sample_rate_hz: f64,
        knots: impl IntoIterator<Item = (f64, f64)>,
        peak_at_full_scale_m: f64,
    ) -> Result<Self, DeviceTableError> {
        let micrometres = |m: f64| whole("span (um)", m * 1e6, 0.0, f64::from(u32::MAX));
        let sample_rate = whole("sample rate (Hz)", sample_rate_hz, 1.0, f64::from(u32::MAX))?;
        let rate = f64::from(sample_rate);
        let knots = knots
            .into_iter()
            .map(|(frequency_hz, gain)| {
                let turns = within("frequency (Hz)", frequency_hz, 0.0, 0.45 * rate)? / rate;
                let gain = within("gain", gain, 0.0, 1.0)?;
                Ok(Knot {
                    step: (turns * 4_294_967_296.0).round() as u32,
                    gain: Gain((gain * f64::from(Gain::FULL.0)).floor() as u32),
                })
            })
            .collect::<Result<Vec<Knot>, DeviceTableError>>()?;
        let header = TableHeader {
            knots: u16::try_from(knots.len()).unwrap_or(u16::MAX),
            span_start_um: micrometres(span_m.0)?,
            span_end_um: micrometres(span_m.1)?,
            sample_rate_hz: sample_rate,
            crc: 0,
        };
        let (start_um, end_um) = (f64::from(header.span_start_um), f64::from(header.span_end_um));
        within("span's end (um)", end_um, start_um + 1.0, f64::from(u32::MAX))?;
        table::validate(header.knots, knot_of(&knots)).map_err(DeviceTableError::Invalid)?;
        let crc = table::digest(
            header.span_start_um,
            header.span_end_um,
            header.sample_rate_hz,
            header.knots,
            knot_of(&knots),
        );
        let header = TableHeader { crc, ..header };
        Ok(Self { header, knots, peak_at_full_scale_m, heights: Vec::new(), travel_limit: None })
    }

    /// The same table for a plate whose own peak at level 1 varies over the span: `heights` are its peaks
    /// over `peak_at_full_scale_m`, at positions uniform over the span. They are not sent to the device; they
    /// are used for the display of its tones.
    ///
    /// # Errors
    /// [`DeviceTableError::OutOfRange`]: fewer than two heights, or a height outside 0 to 1000.
    pub fn with_heights(self, heights: Vec<f64>) -> Result<Self, DeviceTableError> {
        within("number of heights", heights.len() as f64, 2.0, f64::from(u32::MAX))?;
        for &height in &heights {
            within("height", height, 0.0, 1e3)?;
        }
        Ok(Self { heights, ..self })
    }

    /// The same table for an actuator whose travel is limited: the limit is sent to the device with it. The
    /// actuator is given by its resonance in Hz, the quality factor of the resonance, and its travel at a
    /// steady signal of full scale over its peak travel.
    ///
    /// # Errors
    /// [`DeviceTableError::OutOfRange`]: allowed are a resonance of 0.1 Hz to 10 MHz, a quality factor of 0.1
    /// to 1000, and up to 1000 times the peak travel.
    pub fn with_travel_limit(
        self,
        resonance_hz: f64,
        quality: f64,
        static_share: f64,
    ) -> Result<Self, DeviceTableError> {
        let (low, high) = limits::RESONANCE_UHZ;
        within("actuator's resonance (Hz)", resonance_hz, low as f64 / 1e6, high as f64 / 1e6)?;
        let (low, high) = limits::QUALITY_PER_MILLE;
        within("actuator's quality", quality, f64::from(low) / 1e3, f64::from(high) / 1e3)?;
        let (_, high) = limits::STATIC_TRAVEL_PPM;
        within("actuator's travel over its peak travel", static_share, 0.0, f64::from(high) / 1e6)?;
        // Values are rounded towards the larger travel.
        let travel_limit = TravelLimit {
            resonance_uhz: (resonance_hz * 1e6).round() as u64,
            quality_per_mille: (quality * 1e3).ceil() as u32,
            static_ppm: ((static_share * 1e6).ceil() as u32).clamp(limits::STATIC_TRAVEL_PPM.0, high),
        };
        Ok(Self { travel_limit: Some(travel_limit), ..self })
    }

    /// The same table with the travel limit of another one.
    #[must_use]
    pub fn with_travel_limit_of(self, other: &Self) -> Self {
        Self { travel_limit: other.travel_limit, ..self }
    }

    /// The limit of the actuator's travel that is sent with the table; `None` if the travel is not limited.
    #[must_use]
    pub const fn travel_limit(&self) -> Option<TravelLimit> {
        self.travel_limit
    }

    /// The first message of the upload.
    #[must_use]
    pub const fn header(&self) -> TableHeader {
        self.header
    }

    /// The CRC-32 by which the device identifies it.
    #[must_use]
    pub const fn crc(&self) -> u32 {
        self.header.crc
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    /// The peak displacement at level 1, in metres, for which the table is made; equal over the span.
    #[must_use]
    pub const fn peak_at_full_scale_m(&self) -> f64 {
        self.peak_at_full_scale_m
    }

    /// The position whose tone advances by `turns` turns per sample; `None` outside the table's frequencies.
    #[must_use]
    pub fn place_of_turns(&self, turns: f64) -> Option<FinePosition> {
        if !(0.0..0.5).contains(&turns) {
            return None;
        }
        let count = self.header.knots;
        let step = (turns * 4_294_967_296.0).round() as u32;
        let (index, fraction) = table::place_of_step(count, step, knot_of(&self.knots))?;
        Some(table::position_between(count, index, fraction))
    }

    /// The gain at a frequency in turns per sample; beyond the table that of its nearer end, as in the device.
    #[must_use]
    pub fn gain_of_turns(&self, turns: f64) -> f64 {
        let of = |gain: Gain| f64::from(gain.0) / f64::from(Gain::FULL.0);
        if let Some(place) = self.place_of_turns(turns) {
            return of(self.setting(place).gain);
        }
        let away = |knot: &Knot| (f64::from(knot.step) / 4_294_967_296.0 - turns).abs();
        let ends = self.knots.first().into_iter().chain(self.knots.last());
        ends.min_by(|a, b| away(a).total_cmp(&away(b))).map_or(0.0, |knot| of(knot.gain))
    }

    /// The peak displacement of a tone of level 1 at this position on the table's own plate, in metres.
    #[must_use]
    pub fn peak_m(&self, position: FinePosition) -> f64 {
        let last = self.heights.len().saturating_sub(1);
        let at = f64::from(position.raw()) / f64::from(FinePosition::END.raw()) * last as f64;
        let left = (at as usize).min(last.saturating_sub(1));
        let height = |place: usize| self.heights.get(place).copied().unwrap_or(1.0);
        let here = height(left);
        self.peak_at_full_scale_m * (here + (at - left as f64) * (height(left + 1) - here))
    }

    /// The chunk of an upload that begins with knot `first`; `None` past the end.
    #[must_use]
    pub fn chunk(&self, first: u16) -> Option<TableChunk> {
        let rest = self.knots.get(usize::from(first)..)?;
        let knots = rest.get(..rest.len().min(CHUNK_KNOTS))?;
        if knots.is_empty() {
            return None;
        }
        Some(TableChunk { first, knots: heapless::Vec::from_slice(knots).ok()? })
    }

    /// The position on the wire of a boundary at `x` metres; `None` outside the span (by more than a
    /// rounding) and for NaN.
    #[must_use]
    pub fn position(&self, x_m: f64) -> Option<Position> {
        position_in(&self.header, x_m)
    }

    /// The place of a position, in metres.
    #[must_use]
    pub fn boundary_m(&self, position: Position) -> f64 {
        let (start, end) = span_m(&self.header);
        start + (end - start) * f64::from(position.0) / 65535.0
    }

    /// Step and gain of the device for a boundary at this position.
    #[must_use]
    pub fn setting(&self, position: FinePosition) -> Setting {
        table::evaluate(self.header.knots, position, knot_of(&self.knots))
    }

    /// Checks that tones, each as (place in metres, level), stay within full scale as they rise from silence,
    /// by the device's own rule at full master level. Tones with a place or a level outside its range are
    /// ignored.
    ///
    /// # Errors
    /// [`Refusal::Headroom`], as the device would reply.
    pub fn check_sum(&self, tones: &[(f64, f64)]) -> Result<(), Refusal> {
        Refusal::check_sum(self.sum(tones), Gain::FULL)
    }

    /// The sum of these tones' amplitudes, over full scale.
    #[must_use]
    pub fn sum_of(&self, tones: &[(f64, f64)]) -> f64 {
        self.sum(tones) as f64 / f64::from(Gain::FULL.0)
    }

    fn sum(&self, tones: &[(f64, f64)]) -> u64 {
        let amplitude = |&(boundary_m, level): &(f64, f64)| {
            let gain = self.setting(self.position(boundary_m)?.fine()).gain;
            Some(u64::from(gain.times(Gain::FULL.scaled(self::level(level)?)).0))
        };
        tones.iter().filter_map(amplitude).sum()
    }

    /// The frequency the device plays for a boundary at this position, in Hz.
    #[must_use]
    pub fn frequency_hz(&self, position: Position) -> f64 {
        let turns = self.setting(position.fine()).step.0 as f64 / 18_446_744_073_709_551_616.0;
        turns * f64::from(self.header.sample_rate_hz)
    }
}

/// A table's span in metres.
#[must_use]
pub fn span_m(header: &TableHeader) -> (f64, f64) {
    (f64::from(header.span_start_um) * 1e-6, f64::from(header.span_end_um) * 1e-6)
}

/// The position on the wire of a boundary at `x` metres in a table's span; `None` outside the span by more than a
/// tenth of a micrometre, and for NaN.
#[must_use]
pub(crate) fn position_in(header: &TableHeader, x_m: f64) -> Option<Position> {
    const ROUNDING_M: f64 = 1e-7;
    let (start, end) = span_m(header);
    if !(start - ROUNDING_M..=end + ROUNDING_M).contains(&x_m) {
        return None;
    }
    let fraction = ((x_m - start) / (end - start)).clamp(0.0, 1.0);
    Some(Position((fraction * 65535.0).round() as u16))
}

/// A level on the wire; `None` outside 0..=1 and for NaN.
#[must_use]
pub fn level(level: f64) -> Option<Level> {
    (0.0..=1.0).contains(&level).then(|| Level((level * 65535.0).round() as u16))
}

fn knot_of(knots: &[Knot]) -> impl Fn(u16) -> Knot + '_ {
    |index| knots.get(usize::from(index)).copied().unwrap_or_default()
}

fn within(field: &'static str, got: f64, min: f64, max: f64) -> Result<f64, DeviceTableError> {
    OutOfRange::check(field, got, min, max)?;
    Ok(got)
}

fn whole(field: &'static str, got: f64, min: f64, max: f64) -> Result<u32, DeviceTableError> {
    within(field, got.round(), min, max).map(|value| value as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(count: u16) -> DeviceTable {
        let knots = (0..count).map(|i| (100.0 + f64::from(i), 0.5));
        DeviceTable::from_knots((0.08, 0.28), 400_000.0, knots, 1e-6).unwrap()
    }

    #[test]
    fn a_boundary_goes_to_the_wire_and_back_within_half_a_position() {
        let table = line(513);
        for x_m in [0.08, 0.0801, 0.12, 0.2, 0.28] {
            let back = table.boundary_m(table.position(x_m).unwrap());
            assert!((back - x_m).abs() <= 0.2 / 65535.0 / 2.0 + 1e-12, "{x_m} {back}");
        }
        for x_m in [0.079, 0.281, f64::NAN, f64::INFINITY] {
            assert_eq!(table.position(x_m), None);
        }
    }

    #[test]
    fn the_chunks_are_the_whole_table_in_order() {
        let table = line(1025);
        let mut sent = Vec::new();
        while let Some(chunk) = table.chunk(sent.len() as u16) {
            assert_eq!(usize::from(chunk.first), sent.len());
            sent.extend_from_slice(&chunk.knots);
        }
        assert_eq!(sent, table.knots());
    }

    #[test]
    fn the_device_plays_the_frequency_the_table_says() {
        let table = line(513);
        for (i, want) in [(0u16, 100.0), (32_768, 356.004), (u16::MAX, 612.0)] {
            assert!((table.frequency_hz(Position(i)) - want).abs() < 1e-3, "{i}");
        }
    }

    #[test]
    fn a_limit_of_the_travel_is_rounded_to_the_safe_side_and_refused_by_its_field() {
        let table = line(9);
        assert_eq!(table.travel_limit(), None);
        let limited = table.clone().with_travel_limit(43.2, 3.000_1, 1.234_567_1).unwrap();
        let wanted =
            TravelLimit { resonance_uhz: 43_200_000, quality_per_mille: 3001, static_ppm: 1_234_568 };
        assert_eq!(limited.travel_limit(), Some(wanted));
        assert_eq!(limited.crc(), table.crc(), "the limit is not part of the table");
        let refused = |resonance_hz, quality, share| {
            table.clone().with_travel_limit(resonance_hz, quality, share).unwrap_err().to_string()
        };
        assert_eq!(
            refused(0.05, 1.0, 1.0),
            "the table's actuator's resonance (Hz) is 0.05; allowed are 0.1 to 10000000"
        );
        assert!(refused(50.0, f64::NAN, 1.0).contains("quality"));
        assert!(refused(50.0, 1.0, 1001.0).contains("peak travel is 1001; allowed are 0 to 1000"));
    }

    #[test]
    fn heights_give_the_peak_at_each_place_and_no_part_of_what_is_sent() {
        let (even, table) = (line(9), line(9).with_heights(vec![1.0, 0.9, 1.2]).unwrap());
        assert_eq!(table.crc(), even.crc());
        for (position, height) in [(0, 1.0), (16_384, 0.95), (32_768, 0.9), (u16::MAX, 1.2)] {
            let peak_m = table.peak_m(Position(position).fine());
            assert!((peak_m / 1e-6 - height).abs() < 1e-4, "{position}: {peak_m}");
            assert_eq!(even.peak_m(Position(position).fine()), 1e-6);
        }
        let refused = |heights: &[f64]| line(9).with_heights(heights.to_vec()).unwrap_err().to_string();
        assert!(refused(&[1.0]).contains("number of heights is 1"), "{}", refused(&[1.0]));
        assert!(refused(&[1.0, f64::NAN]).contains("height is NaN"), "{}", refused(&[1.0, f64::NAN]));
    }

    #[test]
    fn values_that_do_not_fit_name_their_field_and_range() {
        let make = |span, rate, knots: &[(f64, f64)]| {
            DeviceTable::from_knots(span, rate, knots.iter().copied(), 1.0).unwrap_err().to_string()
        };
        let good = [(100.0, 0.5), (200.0, 0.5)];
        assert!(make((0.0, f64::NAN), 4e5, &good).contains("span"));
        assert!(make((0.2, 0.1), 4e5, &good).contains("span's end"));
        assert!(make((0.0, 0.1), f64::INFINITY, &good).contains("sample rate"));
        assert!(make((0.0, 0.1), 4e5, &[(100.0, 0.5), (2e5, 0.5)]).contains("180000"));
        assert!(make((0.0, 0.1), 4e5, &[(100.0, f64::NAN), (200.0, 0.5)]).contains("gain"));
        assert!(make((0.0, 0.1), 4e5, &[(100.0, 0.5), (100.0, 0.5)]).contains("strictly"));
        assert!(make((0.0, 0.1), 4e5, &[(100.0, 0.0), (200.0, 0.5)]).contains("gain"));
        assert!(make((0.0, 0.1), 4e5, &[(100.0, 0.5)]).contains("number of knots"));
    }
}
