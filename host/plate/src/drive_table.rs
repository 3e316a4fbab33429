//! The turning-point table: for each place of the boundary, the frequency and the gain that put it there at equal
//! level.
//!
//! The gain is the inverse of everything between the DAC code and the plate's peak: the zero-order hold's droop
//! sinc(f/fs), the actuator, the driven end and the plate with its resonances. The device interpolates step and
//! gain linearly between knots, so the table is made for that: knots are moved onto the plate's resonances (by
//! less than a knot), gains share the error between a knot and the middle of its neighbours, and what is left
//! between the knots is measured and reported.
//!
//! A wave speed that is known to a tolerance only shifts the ripple of an imperfect match along the plate. A table
//! that undoes the ripple where it is supposed to be doubles it where it is not. So with a tolerance the gain at each
//! knot lies in the middle, in dB, between the lowest and the highest peak of all speeds within it: the worst
//! departure is then the ripple itself, whatever the true speed.

use crate::airy;
use crate::numerov::{self, Grid};
use crate::peak::{self, Peak};
use crate::plate::Plate;
use crate::progress::{Progress, Stopped};
use crate::respond::Equation;
use crate::sample_rate::{self, SampleRateError};
use num_complex::Complex64;
use std::f64::consts::PI;
use thiserror::Error;

/// Most knots of a table.
pub const KNOTS_MAX: usize = 1025;
/// Wave speeds over a tolerance at which the levels are computed, the nominal one among them; odd. At 1 % and 40 kHz
/// on the plates at hand the ripple turns by about pi over the tolerance: a tenth of a turn from speed to speed.
const SPEEDS: usize = 9;
/// Frequencies between two looks at whether the table is still wanted.
const FREQUENCIES_AT_ONCE: usize = 64;

/// Why a table could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TableError {
    /// The sample rate cannot carry the plate's band.
    #[error(transparent)]
    SampleRate(#[from] SampleRateError),
    /// The number of knots is not usable.
    #[error("knots = {knots}: must be 2 to {KNOTS_MAX}")]
    Knots {
        /// The number that was asked for.
        knots: usize,
    },
    /// The plate does not answer somewhere in its span (its amplitude is zero or not a number).
    #[error("the plate does not answer at {position_m} m ({frequency_hz} Hz): nothing to level there")]
    Silent {
        /// Turning point, metres.
        position_m: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// The computation was given up.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// One knot of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// Nominal place of the boundary, metres (uniform over the span).
    pub position_m: f64,
    /// Frequency, Hz; strictly rising from knot to knot.
    pub frequency_hz: f64,
    /// Gain, above 0 and at most 1.
    pub gain: f64,
    /// Whether the plate shows a turning-point peak here; where loss leaves none, the level is defined by the
    /// amplitude at the turning point (an Airy peak would be 1/0.6628 of it).
    pub peak_present: bool,
}

/// A turning-point table for one plate at one sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTable {
    /// Place of the first knot, metres.
    pub span_start_m: f64,
    /// Place of the last knot, metres.
    pub span_end_m: f64,
    /// Sample rate the table was made for, Hz.
    pub sample_rate_hz: f64,
    /// The knots, uniform in position.
    pub knots: Vec<Knot>,
    /// Peak displacement at level 1 (DAC amplitude = gain), the same everywhere on the span, metres.
    pub peak_at_full_scale_m: f64,
    /// Largest departure of the peak from its level at the knots, between them and at the resonances, dB.
    pub worst_error_db: f64,
    /// Largest distance between a commanded boundary and the turning point it gets, metres.
    pub worst_shift_m: f64,
    /// Swing of the peak over the span without gains, dB (largest over smallest).
    pub swing_without_gain_db: f64,
    /// Knots without a turning-point peak.
    pub knots_without_peak: usize,
}

impl DriveTable {
    /// Builds the table with `knots` knots (2 to 1025) over the plate's span.
    ///
    /// # Errors
    /// [`TableError`] when the rate cannot carry the band, `knots` is out of range, or the plate is silent somewhere.
    pub fn build(plate: &Plate, sample_rate_hz: f64, knots: usize) -> Result<Self, TableError> {
        Self::build_watched(plate, sample_rate_hz, knots, &mut Progress::new(&mut |_| true))
    }

    /// [`DriveTable::build`] that tells how far it is and can be stopped: a moment for a usual plate,
    /// many times as long for one of many wavelengths whose speed has a tolerance.
    ///
    /// # Errors
    /// As [`DriveTable::build`], and [`TableError::Stopped`].
    pub fn build_watched(
        plate: &Plate,
        sample_rate_hz: f64,
        knots: usize,
        progress: &mut Progress<'_>,
    ) -> Result<Self, TableError> {
        if !(2..=KNOTS_MAX).contains(&knots) {
            return Err(TableError::Knots { knots });
        }
        let chain = Chain::new(plate, sample_rate_hz)?;
        let (start, end) = plate.span_m();
        let place = |k: f64| start + (end - start) * k / (knots - 1) as f64;
        let places: Vec<f64> = (0..knots).map(|k| place(k as f64)).collect();
        // Halves: knots at even indices, middles at odd ones.
        let halves: Vec<f64> = (0..2 * knots - 1).map(|k| place(0.5 * k as f64)).collect();
        let others = other_speeds(plate);
        let others = chains(&others, sample_rate_hz);
        // Frequencies that each stage solves, per knot: they share out the progress.
        let speeds = 1.0 + others.len() as f64;
        let whole = 2.0 + 2.0 * speeds + 4.0;
        let ends = [0.0, 2.0, 2.0 + speeds, 2.0 + 2.0 * speeds, whole].map(|end| end / whole);
        let levels = chain.levels_at(&halves, &mut progress.part(ends[0], ends[1]))?;
        let shifted = onto_resonances(&chain, &places, &halves, &levels);

        let mut frequency: Vec<f64> = shifted.iter().map(|&x| plate.frequency_for_boundary_hz(x)).collect();
        rising(&mut frequency);
        let at_knots = amid(&chain, &others, &frequency, &mut progress.part(ends[1], ends[2]))?;
        let middles: Vec<f64> = frequency.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let between = amid(&chain, &others, &middles, &mut progress.part(ends[2], ends[3]))?;
        let mut gain: Vec<f64> = at_knots.iter().map(|level| 1.0 / level.amplitude).collect();
        share_error(&mut gain, &at_knots, &between);
        let largest = gain.iter().copied().fold(0.0, f64::max);
        gain.iter_mut().for_each(|gain| *gain /= largest);
        let level = 1.0 / largest;

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
            swing_without_gain_db: 20.0 * (high / low).log10(),
            knots_without_peak: at_knots.iter().filter(|level| !level.peak_present).count(),
        };
        table.measure(plate, &chain, level, &mut progress.part(ends[3], ends[4]))?;
        Ok(table)
    }

    /// Frequency at `position_m`, Hz, interpolated as the device does; clamped to the span.
    pub fn frequency_hz(&self, position_m: f64) -> f64 {
        self.between(position_m, |knot| knot.frequency_hz)
    }

    /// Gain at `position_m`, interpolated as the device does; clamped to the span.
    pub fn gain(&self, position_m: f64) -> f64 {
        self.between(position_m, |knot| knot.gain)
    }

    fn between(&self, position_m: f64, value: impl Fn(&Knot) -> f64) -> f64 {
        let last = self.knots.len() - 1;
        let at = (position_m - self.span_start_m) / (self.span_end_m - self.span_start_m) * last as f64;
        let at = if at.is_nan() { 0.0 } else { at.clamp(0.0, last as f64) };
        let left = (at as usize).min(last - 1);
        let t = at - left as f64;
        value(&self.knots[left]) * (1.0 - t) + value(&self.knots[left + 1]) * t
    }

    /// Measures the error at each knot and at three places between each pair.
    fn measure(
        &mut self,
        plate: &Plate,
        chain: &Chain<'_>,
        level: f64,
        progress: &mut Progress<'_>,
    ) -> Result<(), TableError> {
        let count = 4 * (self.knots.len() - 1) + 1;
        let places: Vec<f64> = (0..count)
            .map(|i| {
                self.span_start_m + (self.span_end_m - self.span_start_m) * i as f64 / (count - 1) as f64
            })
            .collect();
        let frequencies: Vec<f64> = places.iter().map(|&x| self.frequency_hz(x)).collect();
        let levels = chain.levels(&frequencies, progress)?;
        for ((&x, &frequency), found) in places.iter().zip(&frequencies).zip(&levels) {
            let error_db = 20.0 * (self.gain(x) * found.amplitude / level).log10();
            self.worst_error_db = self.worst_error_db.max(error_db.abs());
            let turning = plate.turning_point_m(frequency).unwrap_or(f64::NAN);
            self.worst_shift_m = self.worst_shift_m.max((turning - x).abs());
        }
        Ok(())
    }
}

/// The peak a drive makes: how high per unit of DAC amplitude, and whether it is a peak at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Peak amplitude per unit of DAC amplitude (of full-scale displacement); where there is no peak, the amplitude
    /// at the turning point over 0.6628.
    pub amplitude: f64,
    /// Whether there is a turning-point peak.
    pub peak_present: bool,
}

/// Everything between the DAC and the plate's peak, prepared for many frequencies of one plate.
pub(crate) struct Chain<'a> {
    plate: &'a Plate,
    grid: Grid,
    step_m: f64,
    sample_rate_hz: f64,
}

impl<'a> Chain<'a> {
    pub(crate) fn new(plate: &'a Plate, sample_rate_hz: f64) -> Result<Self, TableError> {
        sample_rate::check(plate, sample_rate_hz)?;
        Ok(Self::unchecked(plate, sample_rate_hz))
    }

    /// The same for a plate whose band may end a little above what the rate carries.
    pub(crate) fn unchecked(plate: &'a Plate, sample_rate_hz: f64) -> Self {
        let highest_hz = plate.band_hz().1;
        // 1e-6 of the amplitude is 1e-5 dB: a coarser grid than a response needs.
        let points = 257;
        let refinement = numerov::refinement(plate, highest_hz, plate.length_m() / 256.0).div_ceil(4).max(2);
        let grid = Grid::new(plate, 1, Equation::Corrected, points, refinement);
        let step_m = plate.length_m() / (256 * refinement) as f64;
        Self { plate, grid, step_m, sample_rate_hz }
    }

    /// Drive-to-peak gain at each frequency.
    pub(crate) fn levels(
        &self,
        frequencies_hz: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Level>, TableError> {
        let count = frequencies_hz.len();
        let mut levels = Vec::with_capacity(count);
        for part in frequencies_hz.chunks(FREQUENCIES_AT_ONCE) {
            progress.at(levels.len() as f64 / count as f64)?;
            numerov::solve_each(&self.grid, self.plate, part, |number, field| {
                levels.push(self.judge(part[number], field));
            });
        }
        levels.into_iter().collect()
    }

    fn levels_at(&self, places_m: &[f64], progress: &mut Progress<'_>) -> Result<Vec<Level>, TableError> {
        let frequencies: Vec<f64> =
            places_m.iter().map(|&x| self.plate.frequency_for_boundary_hz(x)).collect();
        self.levels(&frequencies, progress)
    }

    pub(crate) fn level(&self, frequency_hz: f64) -> Result<Level, TableError> {
        self.judge(frequency_hz, &numerov::solve(&self.grid, self.plate, frequency_hz))
    }

    fn judge(&self, frequency_hz: f64, field: &[Complex64]) -> Result<Level, TableError> {
        let turning_point_m = self.plate.turning_point_m(frequency_hz).unwrap_or(0.0);
        let kappa = self.plate.kappa_per_m(frequency_hz).unwrap_or(f64::NAN);
        let found = peak::find(field, self.step_m, turning_point_m, kappa);
        let on_plate = match found {
            Some(Peak { amplitude, .. }) => amplitude,
            None => {
                let at = turning_point_m.min(self.plate.length_m());
                peak::amplitude_at(field, self.step_m, at) * airy::PEAK_VALUE / airy::ai(0.0)
            }
        };
        let amplitude = on_plate * self.before_the_plate(frequency_hz);
        if !(amplitude.is_finite() && amplitude > 0.0) {
            return Err(TableError::Silent { position_m: turning_point_m, frequency_hz });
        }
        Ok(Level { amplitude, peak_present: found.is_some() })
    }

    /// Zero-order hold and actuator.
    fn before_the_plate(&self, frequency_hz: f64) -> f64 {
        let turn = PI * frequency_hz / self.sample_rate_hz;
        let droop = turn.sin() / turn;
        droop * self.plate.spec().actuator.map_or(1.0, |actuator| actuator.response(frequency_hz).norm())
    }
}

/// The peak amplitude that a table for `plate` levels at one frequency, per unit of DAC amplitude; `others` are its
/// [`other_speeds`].
pub(crate) fn levelled(
    plate: &Plate,
    others: &[Plate],
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> Result<f64, TableError> {
    let chain = Chain::new(plate, sample_rate_hz)?;
    let others = chains(others, sample_rate_hz);
    let levels = amid(&chain, &others, &[frequency_hz], &mut Progress::new(&mut |_| true))?;
    Ok(levels[0].amplitude)
}

/// The plate at other wave speeds within its tolerance; a speed at which it is no valid plate is left out.
pub(crate) fn other_speeds(plate: &Plate) -> Vec<Plate> {
    let tolerance = plate.spec().wave_speed_tolerance;
    if tolerance == 0.0 {
        return Vec::new();
    }
    let half = (SPEEDS / 2) as f64;
    (0..SPEEDS)
        .filter(|&number| number != SPEEDS / 2)
        .filter_map(|number| plate.with_wave_speed(1.0 + tolerance * (number as f64 / half - 1.0)).ok())
        .collect()
}

fn chains(plates: &[Plate], sample_rate_hz: f64) -> Vec<Chain<'_>> {
    plates.iter().map(|plate| Chain::unchecked(plate, sample_rate_hz)).collect()
}

/// The nominal plate's levels, each moved to the middle, in dB, of the lowest and the highest that all plates give.
fn amid(
    nominal: &Chain<'_>,
    others: &[Chain<'_>],
    frequencies_hz: &[f64],
    progress: &mut Progress<'_>,
) -> Result<Vec<Level>, TableError> {
    let speeds = 1.0 + others.len() as f64;
    let levels = nominal.levels(frequencies_hz, &mut progress.part(0.0, 1.0 / speeds))?;
    let mut ranges: Vec<_> = levels.iter().map(|level| (level.amplitude, level.amplitude)).collect();
    for (number, chain) in others.iter().enumerate() {
        let done = 1.0 + number as f64;
        let part = &mut progress.part(done / speeds, (done + 1.0) / speeds);
        for ((low, high), other) in ranges.iter_mut().zip(chain.levels(frequencies_hz, part)?) {
            *low = low.min(other.amplitude);
            *high = high.max(other.amplitude);
        }
    }
    let middle =
        |(level, (low, high)): (Level, (f64, f64))| Level { amplitude: (low * high).sqrt(), ..level };
    Ok(levels.into_iter().zip(ranges).map(middle).collect())
}

/// Moves knots so that each sharp resonance of the level falls on a knot; between resonances the shift is linear.
fn onto_resonances(chain: &Chain<'_>, places: &[f64], halves: &[f64], levels: &[Level]) -> Vec<f64> {
    let spacing = places[1] - places[0];
    let mut anchors: Vec<(usize, f64)> = vec![(0, 0.0)];
    for i in 1..halves.len() - 1 {
        let (before, here, after) = (levels[i - 1].amplitude, levels[i].amplitude, levels[i + 1].amplitude);
        if here < before || here <= after || 2.0 * here < 1.02 * (before + after) {
            continue;
        }
        let at = |x: f64| {
            let frequency = chain.plate.frequency_for_boundary_hz(x);
            chain.level(frequency).map_or(0.0, |level| level.amplitude)
        };
        let top = golden_maximum(halves[i - 1], halves[i + 1], at);
        let knot = ((top - places[0]) / spacing).round() as usize;
        let last = anchors.last().map_or(0, |anchor| anchor.0);
        if knot > last + 2 && knot + 2 < places.len() {
            anchors.push((knot, top - places[knot]));
        }
    }
    anchors.push((places.len() - 1, 0.0));
    let mut shifted = places.to_vec();
    for pair in anchors.windows(2) {
        let ((left, from), (right, to)) = (pair[0], pair[1]);
        for (k, place) in shifted.iter_mut().enumerate().take(right + 1).skip(left) {
            let t = (k - left) as f64 / (right - left) as f64;
            *place = places[k] + from * (1.0 - t) + to * t;
        }
    }
    shifted
}

fn golden_maximum(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.618_033_988_749_895;
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..14 {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = value(b);
        }
    }
    0.5 * (low + high)
}

/// Guards the strict order that the device demands against rounding.
fn rising(frequency: &mut [f64]) {
    for k in 1..frequency.len() {
        frequency[k] = frequency[k].max(frequency[k - 1] * (1.0 + 1e-12));
    }
}

/// Splits the error in the middle of an interval between the middle and its two knots.
fn share_error(gain: &mut [f64], at_knots: &[Level], between: &[Level]) {
    for _ in 0..3 {
        let error: Vec<f64> = between
            .iter()
            .enumerate()
            .map(|(k, level)| (0.5 * (gain[k] + gain[k + 1]) * level.amplitude).ln())
            .collect();
        for k in 0..gain.len() {
            let left = if k > 0 { error[k - 1] } else { error[0] };
            let right = error.get(k).copied().unwrap_or(left);
            let own = (gain[k] * at_knots[k].amplitude).ln();
            // The middle's error falls as much as the knot's own grows; stop where they are equal and opposite.
            let worst = if left.abs() > right.abs() { left } else { right };
            gain[k] *= (-0.5 * (worst + own)).exp();
        }
    }
}
