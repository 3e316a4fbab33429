//! Plan of a measurement: its tones, their combs, and the time of each.
//!
//! A comb consists of up to 16 multiples of one base frequency f0 = 1/T. A window of length T then separates
//! its tones exactly, since all their sums and differences are multiples of f0. The wanted frequencies are
//! uniform in the logarithm, but for 1 Hz on each side of 50 n and 60 n Hz, where the mains hum. With K combs the first one gets the 1st, (K+1)th, (2K+1)th ... frequency, and so
//! on: neighbours in a comb are far apart, which permits a short T. T of each comb is searched from the
//! shortest possible value to a third more, for multiples that are nearest to the wanted frequencies.
//!
//! After a comb has begun, the plate's response settles as exp(-t/tau), tau = 2/(eta omega), with the loss
//! factor eta and the lowest tone's omega: modes near that tone ring longest. The loss of a plate is
//! uncertain before its calibration. After twice [`SETTLED`] tau, 0.25 % (-52 dB) of the transient remain
//! even if the loss is half of the stated one and is the plate's only damping; a driven end that absorbs
//! waves, as every matched one does, shortens the ringing. Measurements of many combs settle for [`SETTLED`]
//! tau alone.
//!
//! A comb with answers that are not clear is measured for longer, up to [`Plan::windows`] times T: it has settled
//! by then, which takes most of its time.

use super::error::MeasureError;
use super::mains::{away_from_hum, is_hum};
use slipline_link::BLOCK;
use slipline_plate::calibrate::{DriveLoad, WINDOWS_MAX, band_hz, drive_check_hz};
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::{Plate, limits};
use std::f64::consts::TAU;

/// Time constants of the plate before a window, at least: 0.25 % of the transient remain with the stated
/// loss, 5 % with half of it.
pub const SETTLED: f64 = 6.0;
/// Combs of a plan of 200 points. A plan of fewer combs spends as much time on settling in total, but at most twice as much
/// on each comb.
const COMBS: f64 = 13.0;
/// Longest time to settle, seconds: a plate whose stated loss is nearly zero would take minutes.
const SETTLE_MAX_S: f64 = 5.0;
/// Shortest time to settle, seconds: the filters of an input settle as well.
const SETTLE_MIN_S: f64 = 2e-3;
/// Limits of a comb's rise time, seconds, and its share of the time to settle: a slow rise excites less
/// beside the tones.
pub(super) const RISE_S: (f64, f64) = (5e-3, 0.02);
pub(super) const RISE: f64 = 0.1;
/// Shortest window, seconds: 2000 samples at 400 kS/s.
const WINDOW_MIN_S: f64 = 5e-3;
/// Longest window, seconds.
const WINDOW_MAX_S: f64 = 5.0;
/// Longest window as a share of the time to settle: more time is better spent on another comb.
const WINDOW_OF_SETTLE: f64 = 0.25;
/// How much longer than the shortest a comb's period may be: to come near the wanted frequencies; and to be
/// possible at all where earlier combs have taken its frequencies.
const SEARCH: f64 = 4.0 / 3.0;
const SEARCH_MAX: f64 = 8.0;
/// Smallest relative distance of two measured frequencies: a file stores six digits.
const APART: f64 = 1e-5;
/// Highest tone over the sample rate, the device's limit.
pub(super) const HIGHEST: f64 = 0.45;
/// Highest multiple of a base frequency.
const HARMONIC_MAX: f64 = u16::MAX as f64;
/// Offsets from the nearest multiple that are tried, in order, if it is taken.
const STEPS_ASIDE: [f64; 5] = [0.0, -1.0, 1.0, -2.0, 2.0];
/// Frequencies per wavelength on the plate at the highest frequency: at each sensor the response swings that
/// often because of the standing wave before the boundary. `tests/calibration` of the plate crate shows that
/// 60 and 150 suffice for the presets.
const POINTS_PER_WAVE: f64 = 9.5;
/// Number of frequencies of a measurement.
pub const POINTS: Range = Range::new(8.0, 1600.0, "");
/// Levels that may be requested: below, the responses vanish in the noise.
pub const LEVEL: Range = Range::new(1e-3, 1.0, "");

/// A requested measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// Lowest frequency, Hz (0.5 Hz and more).
    pub low_hz: f64,
    /// Highest frequency, Hz (up to 0.45 of the sample rate).
    pub high_hz: f64,
    /// Number of frequencies, 8 to 1600.
    pub points: usize,
    /// Largest sum of all tones' amplitudes, as a share of full scale, 0.001 to 1. No tone's peak on the
    /// plate exceeds this share of the table's.
    pub level: f64,
}

impl Wanted {
    /// The measurement for a calibration of this plate: its band, a sufficient number of frequencies (60 for
    /// the preset `membrane`, 150 for `al-bending`), at half of full scale.
    #[must_use]
    pub fn of(plate: &Plate) -> Self {
        let (low_hz, high_hz) = band_hz(plate);
        let slope = plate.spec().model.width_slope(1);
        let wavenumber = (slope * plate.wavenumber_squared(high_hz)).sqrt();
        let points = 10.0 * (POINTS_PER_WAVE * plate.length_m() * wavenumber / TAU / 10.0).round();
        Self { low_hz, high_hz, points: points.clamp(60.0, 400.0) as usize, level: 0.5 }
    }

    pub(super) fn check(&self, rate_hz: f64) -> Result<(), OutOfRange> {
        let highest = Range { high: HIGHEST * rate_hz, ..limits::FREQUENCY };
        OutOfRange::check("from", self.low_hz, Range { high: highest.high / 1.01, ..highest })?;
        OutOfRange::check("to", self.high_hz, Range { low: 1.01 * self.low_hz, ..highest })?;
        OutOfRange::check("points", self.points as f64, POINTS)?;
        OutOfRange::check("level", self.level, LEVEL)
    }

    /// The frequencies of its points, away from the hum of the mains.
    fn frequencies_hz(&self) -> Result<Vec<f64>, MeasureError> {
        away_from_hum(self.low_hz, self.high_hz, self.points).ok_or_else(|| crowded(self))
    }
}

/// Tones that are played and measured together.
#[derive(Debug, Clone, PartialEq)]
pub struct Comb {
    /// The period, which is also the length of the window, in blocks of 128 samples.
    pub period_blocks: u16,
    /// The multiples of the base frequency, rising.
    pub harmonics: Vec<u16>,
    /// Samples from the rise's end to the window.
    pub settle_samples: u64,
    /// Rise time of the tones, seconds.
    pub rise_s: f64,
}

impl Comb {
    /// The frequencies of its tones, Hz.
    pub fn frequencies_hz(&self, rate_hz: f64) -> impl Iterator<Item = f64> + '_ {
        let base_hz = rate_hz / (BLOCK as f64 * f64::from(self.period_blocks));
        self.harmonics.iter().map(move |&harmonic| f64::from(harmonic) * base_hz)
    }

    /// Length of its window, samples.
    #[must_use]
    pub fn window_samples(&self) -> u64 {
        BLOCK as u64 * u64::from(self.period_blocks)
    }
}

/// All combs of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The device's sample rate, Hz.
    pub rate_hz: f64,
    /// Largest sum of all tones' amplitudes, as a share of full scale.
    pub level: f64,
    /// The combs in the order in which they are played.
    pub combs: Vec<Comb>,
    /// Largest number of windows over which a comb's answers are averaged, where one is not enough to make
    /// them clear.
    pub windows: u16,
}

impl Plan {
    /// The plan for a plate, a device's sample rate, and the number of tones that it measures at once.
    ///
    /// # Errors
    /// [`MeasureError`]: a number is out of its range, or the band has no room for the points.
    pub fn new(plate: &Plate, wanted: &Wanted, rate_hz: f64, lock_ins: usize) -> Result<Self, MeasureError> {
        wanted.check(rate_hz)?;
        if lock_ins == 0 {
            return Err(MeasureError::NoInputs);
        }
        let count = wanted.points.div_ceil(lock_ins.min(slipline_link::protocol::limits::MAX_TONES));
        let all_hz = wanted.frequencies_hz()?;
        let mut taken: Vec<f64> = Vec::with_capacity(wanted.points);
        let mut combs = Vec::with_capacity(count);
        for first in 0..count {
            let tones: Vec<f64> = all_hz.iter().skip(first).step_by(count).copied().collect();
            let point_hz = all_hz[1] - all_hz[0];
            let comb = comb(plate, point_hz, rate_hz, &tones, &taken);
            let mut comb = comb.ok_or_else(|| crowded(wanted))?;
            let longer = (COMBS / count as f64).clamp(1.0, 2.0);
            comb.settle_samples = (longer * comb.settle_samples as f64).ceil() as u64;
            taken.extend(comb.frequencies_hz(rate_hz));
            combs.push(comb);
        }
        Ok(Self { rate_hz, level: wanted.level, combs, windows: WINDOWS_MAX })
    }

    /// The plan for [`drive_check_hz`]: tones far below the plate's cut-off, whose amplitudes add up
    /// to `level`, and windows of `window_s` seconds at least.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] without lock-ins.
    pub fn of_drive(
        plate: &Plate,
        load: &DriveLoad,
        rate_hz: f64,
        lock_ins: usize,
        level: f64,
        window_s: f64,
    ) -> Result<Self, MeasureError> {
        if lock_ins == 0 {
            return Err(MeasureError::NoInputs);
        }
        let tones = drive_check_hz(plate, load);
        // The tones are multiples of their distance; the window has as many of its periods as it needs to be
        // long enough.
        let base_hz = tones[1] - tones[0];
        let periods = (window_s * base_hz).ceil();
        let period_blocks =
            (periods * rate_hz / (base_hz * BLOCK as f64)).round().clamp(1.0, f64::from(u16::MAX));
        let found_hz = rate_hz / (period_blocks * BLOCK as f64);
        let settle_s = settle_s(plate, tones[0]);
        let comb = |tones: &[f64]| Comb {
            period_blocks: period_blocks as u16,
            harmonics: tones.iter().map(|hz| (hz / found_hz).round() as u16).collect(),
            settle_samples: (settle_s * rate_hz).ceil() as u64,
            rise_s: (RISE * settle_s).clamp(RISE_S.0, RISE_S.1),
        };
        Ok(Self { rate_hz, level, combs: tones.chunks(lock_ins).map(comb).collect(), windows: 1 })
    }

    /// The comb with the most tones alone and one window: frequencies over the plan's whole band, in a fraction
    /// of its time.
    #[must_use]
    pub fn of_one_comb(&self) -> Self {
        let most = self.combs.iter().max_by_key(|comb| comb.harmonics.len());
        Self { combs: most.into_iter().cloned().collect(), windows: 1, ..*self }
    }

    /// Samples that the device needs: silence for the noise, and the rises, settling times and windows, one
    /// window per comb. Delays of the link and the fades between combs are not included.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.quiet_samples() + self.combs.iter().map(|comb| self.samples_of(comb)).sum::<u64>()
    }

    /// Largest number of windows of a comb, whose blocks the device counts in 16 bits.
    pub(super) fn windows_of(&self, comb: &Comb) -> u16 {
        self.windows.clamp(1, (u16::MAX / comb.period_blocks.max(1)).saturating_add(1))
    }

    /// Samples of the silent first comb, before and during the noise window.
    pub(super) fn quiet_samples(&self) -> u64 {
        self.combs.first().map_or(0, |comb| self.rise_samples(comb) + comb.window_samples())
    }

    /// Samples of a comb.
    pub(super) fn samples_of(&self, comb: &Comb) -> u64 {
        self.rise_samples(comb) + comb.settle_samples + comb.window_samples()
    }

    /// Samples of a comb's rise.
    pub(super) fn rise_samples(&self, comb: &Comb) -> u64 {
        (comb.rise_s * self.rate_hz).ceil() as u64
    }
}

fn crowded(wanted: &Wanted) -> MeasureError {
    MeasureError::Crowded { points: wanted.points, low_hz: wanted.low_hz, high_hz: wanted.high_hz }
}

/// Time constant of the decay exp(-t/tau) of a plate's response to tones at this frequency and above,
/// seconds. Below its cut-off a plate has no waves that ring: the cut-off itself rings then.
pub(super) fn time_constant_s(plate: &Plate, lowest_hz: f64) -> f64 {
    let lowest_hz = lowest_hz.max(plate.cut_off_hz());
    2.0 / (plate.loss_factor_at(lowest_hz).max(1e-4) * TAU * lowest_hz)
}

/// Settling time of a plate's response to tones at this frequency and above, seconds.
pub(super) fn settle_s(plate: &Plate, lowest_hz: f64) -> f64 {
    (SETTLED * time_constant_s(plate, lowest_hz)).clamp(SETTLE_MIN_S, SETTLE_MAX_S)
}

/// The comb of these tones, of points this far apart; `None` if they are too close to each other.
fn comb(plate: &Plate, point_hz: f64, rate_hz: f64, tones_hz: &[f64], taken: &[f64]) -> Option<Comb> {
    let (lowest_hz, highest_hz) = (*tones_hz.first()?, *tones_hz.last()?);
    let settle_s = settle_s(plate, lowest_hz);
    // The base frequency is at most the distance of two tones, and need not be finer than that of two points.
    let apart_hz = tones_hz.windows(2).map(|two| two[1] - two[0]).fold(lowest_hz, f64::min);
    let shortest_s = apart_hz.recip().max(WINDOW_MIN_S);
    let window_s = (WINDOW_OF_SETTLE * settle_s).clamp(shortest_s, point_hz.recip().max(shortest_s));
    let longest_s = (HARMONIC_MAX / highest_hz).min(WINDOW_MAX_S);
    let blocks = |seconds: f64| seconds * rate_hz / BLOCK as f64;
    let first = blocks(window_s).ceil();
    let last = |search: f64| (search * first).min(blocks(longest_s)).min(f64::from(u16::MAX)).floor() as u32;
    let candidate = |blocks: u32| {
        let period_blocks = u16::try_from(blocks).ok()?;
        let base_hz = rate_hz / (BLOCK as f64 * f64::from(period_blocks));
        let harmonics = harmonics(tones_hz, base_hz, HIGHEST * rate_hz, taken)?;
        let found = || harmonics.iter().map(|&harmonic| f64::from(harmonic) * base_hz);
        // Relative errors, as the distance of two points is relative.
        let missed: f64 = found().zip(tones_hz).map(|(hz, wanted)| (hz / wanted - 1.0).powi(2)).sum();
        Some((missed, period_blocks, harmonics))
    };
    let (first, near, far) = (first as u32, last(SEARCH), last(SEARCH_MAX));
    let best = (first..=near).filter_map(candidate).min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, period_blocks, harmonics) = best.or_else(|| (near + 1..=far).find_map(candidate))?;
    let rise_s = (RISE * settle_s).clamp(RISE_S.0, RISE_S.1);
    Some(Comb { period_blocks, harmonics, settle_samples: (settle_s * rate_hz).ceil() as u64, rise_s })
}

/// The multiples of a base frequency that are nearest to these tones: rising, up to `highest_hz`, without the
/// taken ones and those at the hum of the mains.
fn harmonics(tones_hz: &[f64], base_hz: f64, highest_hz: f64, taken: &[f64]) -> Option<Vec<u16>> {
    let mut found: Vec<u16> = Vec::with_capacity(tones_hz.len());
    for hz in tones_hz {
        let nearest = (hz / base_hz).round();
        let is_free = |multiple: &f64| {
            let hz = multiple * base_hz;
            (1.0..=HARMONIC_MAX).contains(multiple)
                && hz <= highest_hz
                && !is_hum(hz)
                && found.last().is_none_or(|before| *multiple > f64::from(*before))
                && taken.iter().all(|other| (other / hz - 1.0).abs() > APART)
        };
        let multiple = STEPS_ASIDE.iter().map(|step| nearest + step).find(is_free)?;
        found.push(multiple as u16);
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::preset;

    const RATE_HZ: f64 = 400e3;

    fn plan(name: &str, points: usize, lock_ins: usize) -> Plan {
        let plate = preset(name).unwrap();
        let wanted = Wanted { points, ..Wanted::of(&plate) };
        Plan::new(&plate, &wanted, RATE_HZ, lock_ins).unwrap()
    }

    /// All frequencies, rising.
    fn frequencies(plan: &Plan) -> Vec<f64> {
        let mut all: Vec<f64> = plan.combs.iter().flat_map(|comb| comb.frequencies_hz(RATE_HZ)).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn two_hundred_points_take_15_seconds_of_a_membrane_and_3_of_aluminium() {
        for (name, most_s) in
            [("membrane", 14.0), ("membrane-heavy", 14.0), ("al-bending", 1.2), ("al-sh", 2.8)]
        {
            let plan = plan(name, 200, 16);
            let seconds = plan.samples() as f64 / RATE_HZ;
            assert!(seconds < most_s, "{name}: {seconds} s");
            assert_eq!((plan.combs.len(), frequencies(&plan).len()), (13, 200), "{name}");
        }
    }

    #[test]
    fn the_frequencies_lie_over_the_band_without_gaps_and_none_twice() {
        for (name, points, lock_ins) in [
            ("membrane", 200, 16),
            ("membrane", 60, 16),
            ("al-bending", 150, 16),
            ("al-bending", 200, 5),
            ("al-sh", 40, 16),
            ("membrane", 400, 2),
            ("al-bending", 800, 16),
        ] {
            let plate = preset(name).unwrap();
            let (low, high) = band_hz(&plate);
            let plan = plan(name, points, lock_ins);
            let found = frequencies(&plan);
            let step = (high / low).ln() / (points - 1) as f64;
            assert!((found[0] / low).ln().abs() < 3.0 * step, "{name}: {}", found[0]);
            assert!((found[points - 1] / high).ln().abs() < 3.0 * step, "{name}: {}", found[points - 1]);
            let gaps = found.windows(2).map(|two| (two[1] / two[0]).ln() / step);
            let (least, most) = gaps.fold((f64::MAX, 0.0_f64), |(a, b), gap| (a.min(gap), b.max(gap)));
            // 2 Hz of hum lie within some gaps.
            let hum = (1.0 + 2.0 / low).ln() / step;
            assert!(least * step > APART && most < 6.0 + hum, "{name} {points}: {least} {most}");
            for comb in &plan.combs {
                assert!(
                    comb.harmonics.len() <= lock_ins && comb.harmonics.windows(2).all(|two| two[0] < two[1])
                );
            }
        }
    }

    #[test]
    fn a_comb_settles_for_six_time_constants_of_its_lowest_tone_and_few_of_them_for_twelve() {
        for (points, wanted) in [(200, 6.0), (60, 12.0)] {
            let plan = plan("membrane", points, 16);
            for comb in &plan.combs {
                let lowest_hz = comb.frequencies_hz(RATE_HZ).next().unwrap();
                let constants = comb.settle_samples as f64 / RATE_HZ * 0.03 * TAU * lowest_hz / 2.0;
                assert!((constants / wanted - 1.0).abs() < 0.03, "{points} points: {constants}");
            }
        }
    }

    #[test]
    fn the_most_windows_take_39_seconds_of_a_membrane_and_six_of_aluminium() {
        for (name, points, once_s, longest_s) in [("membrane", 60, 7.4, 39.0), ("al-bending", 150, 1.2, 6.0)]
        {
            let plan = plan(name, points, 16);
            let further = |comb: &Comb| u64::from(plan.windows_of(comb) - 1) * comb.window_samples();
            let most = plan.samples() + plan.combs.iter().map(further).sum::<u64>();
            let seconds = [plan.samples(), most].map(|samples| samples as f64 / RATE_HZ);
            println!("{name}: {seconds:?} s");
            assert!(seconds[0] < once_s && seconds[1] < longest_s && seconds[1] > 3.0 * seconds[0], "{name}");
            assert!(plan.combs.iter().all(|comb| plan.windows_of(comb) == 32), "{name}");
        }
        // The device counts a window's blocks in 16 bits.
        let plan = plan("membrane", 60, 16);
        let long = Comb { period_blocks: 20_000, ..plan.combs[0].clone() };
        assert_eq!(plan.windows_of(&long), 4);
        assert_eq!(plan.windows_of(&Comb { period_blocks: 1, ..long }), 32);
    }

    #[test]
    fn one_comb_has_fifteen_frequencies_of_the_plan_over_its_band() {
        for (name, points) in [("membrane", 60), ("al-bending", 150)] {
            let plan = plan(name, points, 16);
            let (all, some) = (frequencies(&plan), frequencies(&plan.of_one_comb()));
            assert!(some.len() >= 15 && some.iter().all(|hz| all.contains(hz)), "{name}: {some:?}");
            let band = |hertz: &[f64]| hertz[hertz.len() - 1] / hertz[0];
            assert!(band(&some).ln() > 0.85 * band(&all).ln(), "{name}: {some:?}");
            assert!(plan.of_one_comb().samples() < plan.samples() / 2, "{name}");
        }
    }

    #[test]
    fn sixty_frequencies_suffice_for_the_membrane_and_150_for_aluminium() {
        for (name, wanted) in [("membrane", 60), ("al-bending", 150)] {
            assert_eq!(Wanted::of(&preset(name).unwrap()).points, wanted, "{name}");
        }
    }

    #[test]
    fn what_cannot_be_planned_names_its_field_and_range() {
        let plate = preset("membrane").unwrap();
        let good = Wanted::of(&plate);
        let refused = |wanted: Wanted| Plan::new(&plate, &wanted, RATE_HZ, 16).unwrap_err().to_string();
        for (wanted, message) in [
            (Wanted { low_hz: 0.1, ..good }, "from = 0.1 Hz: must be 0.5 Hz to 178.2 kHz"),
            (Wanted { low_hz: f64::NAN, ..good }, "from = no number"),
            (Wanted { high_hz: 200e3, ..good }, "to = 200 kHz: must be 83.14 Hz to 180 kHz"),
            (Wanted { points: 7, ..good }, "points = 7: must be 8 to 1600"),
            (Wanted { level: 0.0, ..good }, "level = 0: must be 0.001 to 1"),
            (Wanted { low_hz: 40e3, high_hz: 40.4e3, points: 1600, ..good }, "1600 frequencies"),
        ] {
            let found = refused(wanted);
            assert!(found.starts_with(message), "{message}: {found}");
        }
        assert_eq!(Plan::new(&plate, &good, RATE_HZ, 0), Err(MeasureError::NoInputs));
    }
}
