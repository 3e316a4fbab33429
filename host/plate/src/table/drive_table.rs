//! The turning-point table: for each position of the boundary, the frequency that puts it there and the gain that
//! gives every position the same peak.
//!
//! The gain is the inverse of everything between the DAC code and the plate's peak: the zero-order hold's droop
//! sinc(f/fs), the actuator, the driven end and the plate with its resonances. The device interpolates phase step and
//! gain linearly between knots, and the table allows for that in three steps: knots are moved onto the plate's
//! resonances by less than the distance of two knots; the gains balance the error at each knot against the error
//! half-way to its neighbours; the remaining error is measured and reported.

use super::error::{KNOTS_MAX, TableError};
use super::knots::{balance_errors, make_increasing, move_onto_resonances};
use super::level::{DriveToPeak, drives_to_peak, mid_levels, other_plates};
use super::travel::TableTravel;
use crate::definition::plate::Plate;
use crate::definition::sample_rate::hold_droop;
use crate::progress::Progress;
use crate::quantity::{OutOfRange, decibels};
use crate::special::ramp::ramp;
use num_complex::Complex64;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// One knot of the table.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Knot {
    /// Nominal position of the boundary, metres (uniform over the span).
    pub position_m: f64,
    /// Frequency, Hz; strictly increasing from knot to knot.
    pub frequency_hz: f64,
    /// Gain, above 0 and at most 1.
    // JSON, 1: Gain of the tone at this knot
    pub gain: f64,
    /// Whether the plate has a turning-point peak here. Where loss leaves none, the table levels the amplitude at the
    /// turning point over 0.6628, which is the height of the Airy peak.
    pub peak_present: bool,
}

/// A turning-point table for one plate at one sample rate. [`DriveTable::build`] makes it: its knots rise in frequency, and its
/// gains level the peak.
///
/// ```
/// use slipline_plate::{DriveTable, preset};
///
/// let table = DriveTable::build(&preset("membrane").unwrap(), 400e3, 65).unwrap();
/// assert_eq!(table.knots().len(), 65);
/// assert!(table.knots().iter().all(|knot| knot.gain > 0.0 && knot.gain <= 1.0));
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DriveTable {
    span_start_m: f64,
    span_end_m: f64,
    sample_rate_hz: f64,
    #[serde(deserialize_with = "in_order")]
    knots: Vec<Knot>,
    peak_at_full_scale_m: f64,
    worst_error_db: f64,
    worst_shift_m: f64,
    swing_without_gain_db: f64,
    knots_without_peak: usize,
    #[serde(deserialize_with = "two_or_more")]
    nominal_heights: Vec<f64>,
    travel: Option<TableTravel>,
}

/// Knots from another worker of a browser: what [`DriveTable::build`] makes can be interpolated.
fn in_order<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Knot>, D::Error> {
    let knots = Vec::<Knot>::deserialize(from)?;
    let rise = knots.windows(2).all(|pair| pair[0].frequency_hz < pair[1].frequency_hz);
    let fit = rise && knots.iter().all(|knot| knot.gain > 0.0 && knot.gain <= 1.0);
    if fit && (2..=KNOTS_MAX).contains(&knots.len()) {
        Ok(knots)
    } else {
        Err(D::Error::custom(
            "a table has 2 to 1025 knots of rising frequency, with gains above 0 and at most 1",
        ))
    }
}

/// Heights from another worker, likewise.
fn two_or_more<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    let heights = Vec::<f64>::deserialize(from)?;
    if heights.len() < 2 { Err(D::Error::custom("a table has 2 heights or more")) } else { Ok(heights) }
}

/// Steps of a device's phase in one period.
const PHASE_STEPS: f64 = 4_294_967_296.0;

impl DriveTable {
    /// Builds the table with `knots` knots (2 to 1025) over the plate's span.
    ///
    /// # Errors
    /// [`TableError::SampleRate`] if the rate cannot carry the band, [`TableError::Knots`] if `knots` is out of
    /// range, [`TableError::Flat`] if a device cannot distinguish the frequencies of two knots,
    /// [`TableError::Silent`] if the plate has no finite amplitude above zero at a position of its span.
    pub fn build(plate: &Plate, sample_rate_hz: f64, knots: usize) -> Result<Self, TableError> {
        Self::build_watched(plate, sample_rate_hz, knots, &mut Progress::unwatched())
    }

    /// As [`DriveTable::build`], with reports of its progress; it can be stopped. A plate of many wavelengths whose
    /// wave speed has a tolerance takes many times as long as most plates.
    ///
    /// # Errors
    /// As [`DriveTable::build`], and [`TableError::Stopped`].
    pub fn build_watched(
        plate: &Plate,
        sample_rate_hz: f64,
        knots: usize,
        progress: &mut Progress<'_>,
    ) -> Result<Self, TableError> {
        OutOfRange::check_count("knots", knots, 2..=KNOTS_MAX)?;
        let drive_to_peak = DriveToPeak::new(plate, sample_rate_hz)?;
        let (start, end) = plate.span_m();
        let band_hz = plate.band_hz();
        // A device distinguishes frequencies by the step of a 32-bit phase.
        if (band_hz.1 - band_hz.0) / (knots - 1) as f64 <= sample_rate_hz / PHASE_STEPS {
            return Err(TableError::Flat { span_m: (start, end), band_hz, knots });
        }
        let place = |k: f64| start + (end - start) * k / (knots - 1) as f64;
        let places: Vec<f64> = (0..knots).map(|k| place(k as f64)).collect();
        // Knots at even indices, the positions half-way between them at odd ones.
        let halves: Vec<f64> = (0..2 * knots - 1).map(|k| place(0.5 * k as f64)).collect();
        let others = other_plates(plate);
        let others = drives_to_peak(&others, sample_rate_hz);
        // The stages take progress in proportion to the frequencies that they solve: 2 per knot, 1 per knot and
        // plate, the same half-way between the knots, then 4 per knot.
        let plates = 1.0 + others.len() as f64;
        let whole = 2.0 + 2.0 * plates + 4.0;
        let ends = [0.0, 2.0, 2.0 + plates, 2.0 + 2.0 * plates, whole].map(|end| end / whole);
        let levels = drive_to_peak.levels_at(&halves, &mut progress.part(ends[0], ends[1]))?;
        let shifted = move_onto_resonances(&drive_to_peak, &places, &halves, &levels);

        let mut frequency: Vec<f64> = shifted.iter().map(|&x| plate.frequency_for_boundary_hz(x)).collect();
        make_increasing(&mut frequency);
        let at_knots = mid_levels(&drive_to_peak, &others, &frequency, &mut progress.part(ends[1], ends[2]))?;
        let middles: Vec<f64> = frequency.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let between = mid_levels(&drive_to_peak, &others, &middles, &mut progress.part(ends[2], ends[3]))?;
        let mut gain: Vec<f64> = at_knots.iter().map(|level| 1.0 / level.amplitude).collect();
        balance_errors(&mut gain, &at_knots, &between);
        let largest = gain.iter().copied().fold(0.0, f64::max);
        gain.iter_mut().for_each(|gain| *gain /= largest);
        let travel = TableTravel::limit(plate, &frequency, &mut gain);
        let level = travel.map_or(1.0, |travel| travel.scale) / largest;

        let amplitudes = at_knots.iter().chain(&levels).map(|level| level.amplitude);
        let (low, high) =
            amplitudes.fold((f64::INFINITY, 0.0_f64), |(low, high), a| (low.min(a), high.max(a)));
        let mut table = Self {
            span_start_m: start,
            span_end_m: end,
            sample_rate_hz,
            knots: (0..knots)
                .map(|k| Knot {
                    position_m: places[k],
                    frequency_hz: frequency[k],
                    gain: gain[k],
                    peak_present: at_knots[k].peak_present,
                })
                .collect(),
            peak_at_full_scale_m: level * plate.spec().full_scale_m,
            worst_error_db: 0.0,
            worst_shift_m: 0.0,
            swing_without_gain_db: decibels(high / low),
            knots_without_peak: at_knots.iter().filter(|level| !level.peak_present).count(),
            nominal_heights: Vec::new(),
            travel,
        };
        table.measure(plate, &drive_to_peak, level, &mut progress.part(ends[3], ends[4]))?;
        Ok(table)
    }

    /// Positions of the first and the last knot, metres.
    #[must_use]
    pub const fn span_m(&self) -> (f64, f64) {
        (self.span_start_m, self.span_end_m)
    }

    /// Sample rate that the table is made for, Hz.
    #[must_use]
    pub const fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// The knots, uniform in position: 2 to 1025, of rising frequency.
    #[must_use]
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    /// Peak displacement at level 1 (DAC amplitude = gain), metres; the same over the whole span.
    #[must_use]
    pub const fn peak_at_full_scale_m(&self) -> f64 {
        self.peak_at_full_scale_m
    }

    /// Largest deviation of the peak from that level, dB; measured at each knot and at three positions between each
    /// two, for the nominal wave speed.
    #[must_use]
    pub const fn worst_error_db(&self) -> f64 {
        self.worst_error_db
    }

    /// Largest distance between a commanded boundary and the turning point of the table's frequency, metres.
    #[must_use]
    pub const fn worst_shift_m(&self) -> f64 {
        self.worst_shift_m
    }

    /// Largest over smallest peak on the span if all gains were equal, dB.
    #[must_use]
    pub const fn swing_without_gain_db(&self) -> f64 {
        self.swing_without_gain_db
    }

    /// Number of knots without a turning-point peak.
    #[must_use]
    pub const fn knots_without_peak(&self) -> usize {
        self.knots_without_peak
    }

    /// The peak over [`DriveTable::peak_at_full_scale_m`] at each knot and at three positions between each two, for
    /// the nominal wave speed and loss. With a tolerance the gains level the middle of the tolerance interval, so the
    /// nominal plate itself is off by up to [`DriveTable::worst_error_db`].
    #[must_use]
    pub fn nominal_heights(&self) -> &[f64] {
        &self.nominal_heights
    }

    /// The effect of the actuator's peak travel on the table; `None` if the plate file does not limit the travel.
    #[must_use]
    pub const fn travel(&self) -> Option<TableTravel> {
        self.travel
    }

    /// Frequency at `position_m` metres, Hz, interpolated linearly as the device does. Positions outside the span give
    /// its nearest end, NaN its start.
    pub fn frequency_hz(&self, position_m: f64) -> f64 {
        self.between(position_m, self.knots.len(), |knot| self.knots[knot].frequency_hz)
    }

    /// Gain at `position_m` metres, interpolated linearly as the device does. Positions outside the span give its
    /// nearest end, NaN its start.
    pub fn gain(&self, position_m: f64) -> f64 {
        self.between(position_m, self.knots.len(), |knot| self.knots[knot].gain)
    }

    /// Peak of a tone of level 1 at `position_m` metres on the nominal plate, metres; where the plate has no
    /// turning-point peak, the amplitude at the turning point over 0.6628. Positions outside the span give its nearest
    /// end, NaN its start.
    pub fn peak_m(&self, position_m: f64) -> f64 {
        let heights = &self.nominal_heights;
        self.peak_at_full_scale_m * self.between(position_m, heights.len(), |place| heights[place])
    }

    /// Complex displacement of the driven end of `plate`, metres, for a tone of level 1 at `position_m`; the plate may be another
    /// one than the table's.
    pub fn driven_end_m(&self, plate: &Plate, position_m: f64) -> Complex64 {
        let frequency_hz = self.frequency_hz(position_m);
        let dac = self.gain(position_m) * hold_droop(frequency_hz, self.sample_rate_hz);
        plate.drive_response(frequency_hz) * dac * plate.spec().full_scale_m
    }

    /// Linear interpolation at a position of `count` values (2 or more) at positions uniform over the span.
    fn between(&self, position_m: f64, count: usize, value: impl Fn(usize) -> f64) -> f64 {
        let last = count - 1;
        let at = (position_m - self.span_start_m) / (self.span_end_m - self.span_start_m) * last as f64;
        let at = if at.is_nan() { 0.0 } else { at.clamp(0.0, last as f64) };
        let left = (at as usize).min(last - 1);
        let t = at - left as f64;
        value(left) * (1.0 - t) + value(left + 1) * t
    }

    /// Measures the height of the peak at each knot and at three positions between each two.
    fn measure(
        &mut self,
        plate: &Plate,
        drive_to_peak: &DriveToPeak,
        level: f64,
        progress: &mut Progress<'_>,
    ) -> Result<(), TableError> {
        let count = 4 * (self.knots.len() - 1) + 1;
        let places: Vec<f64> = ramp(self.span_start_m, self.span_end_m, count).collect();
        let frequencies: Vec<f64> = places.iter().map(|&x| self.frequency_hz(x)).collect();
        let levels = drive_to_peak.levels(&frequencies, progress)?;
        for ((&x, &frequency), found) in places.iter().zip(&frequencies).zip(&levels) {
            let height = self.gain(x) * found.amplitude / level;
            let error_db = decibels(height);
            self.nominal_heights.push(height);
            self.worst_error_db = self.worst_error_db.max(error_db.abs());
            let turning = plate.turning_point_m(frequency).unwrap_or(f64::NAN);
            self.worst_shift_m = self.worst_shift_m.max((turning - x).abs());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_from_elsewhere_is_taken_only_if_it_can_be_interpolated() {
        let plate = crate::preset("membrane").expect("a preset");
        let table = DriveTable::build(&plate, 400e3, 17).expect("a table");
        let sent = |table: &DriveTable| {
            postcard::from_bytes::<DriveTable>(&postcard::to_extend(table, Vec::new()).expect("bytes"))
        };
        assert_eq!(sent(&table), Ok(table.clone()));
        let is_refused = |change: fn(&mut DriveTable)| {
            let mut changed = table.clone();
            change(&mut changed);
            sent(&changed).is_err()
        };
        assert!(is_refused(|it| it.knots.reverse()), "falling frequencies");
        assert!(is_refused(|it| it.knots.truncate(1)), "one knot");
        assert!(is_refused(|it| it.knots[3].gain = 1.5), "a gain above 1");
        assert!(is_refused(|it| it.nominal_heights.clear()), "no heights");
    }
}
