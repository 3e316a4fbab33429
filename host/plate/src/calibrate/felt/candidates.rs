//! The plates and drives near a file's, and the felt edges of tones on them.
//!
//! Coordinates: those of the plate ([`crate::calibrate::fit::unknowns`]), each over its standard deviation; then
//! resistance, mass and spring of the source, resonance and quality of the actuator, as ln(u/(1 - u)) of their place u in the range of
//! [`crate::truth`]; then the logarithm of the threshold over the level, over its standard deviation.

use super::edge_envelope::Envelope;
use super::importance_sampling::{COUNT, Coordinates, OUTER, Target};
use super::touch::Touch;
use crate::calibrate::fit::response::plate_response::{LoadedEnd, Units, dynamic_stiffness};
use crate::calibrate::fit::response::wave::{FINE, Wave, points};
use crate::calibrate::fit::unknowns::{OF_PLATE, spec_at};
use crate::definition::{DriveEnd, Plate, PlateSpec};
use crate::feeling::{Feeling, FeltEdge};
use crate::frequency::numerov::{Grid, solve_each};
use crate::frequency::{Equation, POINTS_MAX};
use crate::table::level;
use crate::truth::{DriveSpread, QUALITY, REACTANCE, RESISTANCE, RESONANCE, Random};
use num_complex::Complex64;

/// The threshold's coordinate, and its standard deviation as a logarithm: fingers and sources differ.
pub(crate) const THRESHOLD: usize = COUNT - 1;
pub(crate) const THRESHOLD_KNOWN: f64 = 1.5;
/// The drive's coordinates.
const RESISTANCE_AT: usize = OUTER;
const RESONANCE_AT: usize = OUTER + 3;
/// Fewest points of a field: an edge lies between two of them.
const POINTS_LEAST: usize = 301;

/// A tone that is touched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlayedTone {
    pub(crate) frequency_hz: f64,
    /// The DAC's amplitude.
    pub(crate) amplitude: f64,
}

/// The numbers of a drive.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DriveNumbers {
    /// Resistance, mass and stiffness in the units of the spread.
    pub(crate) impedance: [f64; 3],
    /// Over the middle of the band.
    resonance: f64,
    quality: f64,
}

/// Plates and drives near a file's.
pub(crate) struct Near<'a> {
    pub(crate) nominal: &'a Plate,
    pub(crate) feeling: Feeling,
    /// `None` where the drive is as the file states it.
    pub(crate) drive: Option<DriveSpread>,
    /// Standard deviations of the plate's coordinates beforehand.
    pub(crate) deviations: [f64; OF_PLATE],
    points: usize,
}

/// One tone on one plate.
pub(crate) struct Felt {
    frequency_hz: f64,
    envelope: Envelope,
    /// Logarithm of the amplitude and of all that does not depend on the drive's numbers, over the least that is felt.
    level: f64,
    /// F_p and f(0) of [`LoadedEnd::of_wave`]; nothing where the source is that of the file.
    loaded: Option<Loaded>,
}

struct Loaded {
    rate: Complex64,
    force: Complex64,
    motion: Complex64,
}

impl<'a> Near<'a> {
    pub(crate) fn new(
        nominal: &'a Plate,
        feeling: Feeling,
        drive: Option<DriveSpread>,
        deviations: [f64; OF_PLATE],
        highest_hz: f64,
    ) -> Self {
        let points = points(nominal.spec(), highest_hz, FINE).clamp(POINTS_LEAST, POINTS_MAX);
        Self { nominal, feeling, drive, deviations, points }
    }

    /// The plate at these coordinates under the file's own drive.
    pub(crate) fn plate_at(&self, at: &Coordinates) -> PlateSpec {
        let of_plate: [f64; OF_PLATE] = std::array::from_fn(|i| at[i] * self.deviations[i]);
        spec_at(self.nominal.spec(), &of_plate)
    }

    /// The same with the drive at these coordinates.
    pub(crate) fn spec_at(&self, at: &Coordinates) -> PlateSpec {
        let mut spec = self.plate_at(at);
        if let Some(drive) = &self.drive {
            let numbers = self.drive_at(at);
            if let Some(source) = drive.source {
                spec.drive_end = DriveEnd::Source(source.with(numbers.impedance));
            }
            spec.actuator = Some(drive.actuator(numbers.resonance, numbers.quality));
        }
        spec
    }

    pub(crate) fn drive_at(&self, at: &Coordinates) -> DriveNumbers {
        let share = |i: usize| (1.0 + (-at[i]).exp()).recip();
        let even = |(low, high): (f64, f64), i: usize| low + (high - low) * share(i);
        let factor = |(low, high): (f64, f64), i: usize| low * (high / low).powf(share(i));
        let [resistance, mass, stiffness] = [0, 1, 2].map(|i| RESISTANCE_AT + i);
        DriveNumbers {
            impedance: [factor(RESISTANCE, resistance), even(REACTANCE, mass), even(REACTANCE, stiffness)],
            resonance: factor(RESONANCE, RESONANCE_AT),
            quality: factor(QUALITY, RESONANCE_AT + 1),
        }
    }

    /// The DAC's amplitude for which the file predicts each of these peaks, metres, at these frequencies.
    pub(crate) fn amplitudes(&self, tones: &[(f64, f64)]) -> Vec<f64> {
        let plate = self.nominal;
        let grid = Grid::new(plate, 1, Equation::Corrected, self.points, 1);
        let step_m = plate.length_m() / (self.points - 1) as f64;
        let frequencies: Vec<f64> = tones.iter().map(|tone| tone.0).collect();
        let mut amplitudes = Vec::with_capacity(tones.len());
        solve_each(&grid, plate, &frequencies, |number, field| {
            let (frequency_hz, peak_m) = tones[number];
            let drive = plate.drive_response(frequency_hz).norm() * plate.spec().full_scale_m;
            amplitudes.push(peak_m / (drive * level::peak_amplitude(plate, field, step_m, frequency_hz).0));
        });
        amplitudes
    }

    /// The tones on the plate at these coordinates; `None` where the plate is refused or a tone does not enter it.
    pub(crate) fn felt(&self, at: &Coordinates, tones: &[PlayedTone]) -> Option<Vec<Felt>> {
        let spec = self.plate_at(at);
        let frequencies: Vec<f64> = tones.iter().map(|tone| tone.frequency_hz).collect();
        let mut felt = Vec::with_capacity(tones.len());
        let tone_of = |number: usize, field: &[Complex64], plate: &Plate, loaded: Option<Loaded>| {
            let PlayedTone { frequency_hz, amplitude } = tones[number];
            let response = match self.drive {
                Some(_) => 1.0,
                None => plate.drive_response(frequency_hz).norm(),
            };
            let least = self.feeling.just_felt_m(frequency_hz);
            Felt {
                frequency_hz,
                envelope: Envelope::of(field, plate, &self.feeling),
                level: (amplitude * response * spec.full_scale_m / least).ln(),
                loaded,
            }
        };
        match self.drive.and_then(|drive| drive.source.map(|source| (drive.middle_hz, source))) {
            Some((middle_hz, source)) => {
                let units = Units { impedance: source.matched, omega: source.omega };
                let end = LoadedEnd::new(&spec, source.end, units)?;
                let wave = Wave::with_slope(spec.clone(), self.points, middle_hz).ok()?;
                if !frequencies.iter().all(|&frequency_hz| wave.enters(frequency_hz)) {
                    return None;
                }
                wave.fields(&frequencies, |number, field| {
                    let frequency_hz = frequencies[number];
                    let [force, motion] = end.of_wave(frequency_hz, field[0], wave.slope(frequency_hz));
                    let loaded = Loaded { rate: units.rate(frequency_hz), force, motion };
                    felt.push(tone_of(number, field, wave.plate(), Some(loaded)));
                });
            }
            None => {
                let plate = Plate::new(spec.clone()).ok()?;
                let allowed = crate::frequency::respond_range(&plate);
                if !frequencies.iter().all(|&frequency_hz| allowed.contains(frequency_hz)) {
                    return None;
                }
                let grid = Grid::new(&plate, 1, Equation::Corrected, self.points, 1);
                solve_each(&grid, &plate, &frequencies, |number, field| {
                    felt.push(tone_of(number, field, &plate, None));
                });
            }
        }
        Some(felt)
    }

    /// The logarithm of the least amplitude that is felt of such a tone, in the unit of its field.
    fn least(&self, felt: &Felt, numbers: &DriveNumbers, at: &Coordinates) -> f64 {
        let Some(drive) = &self.drive else { return THRESHOLD_KNOWN * at[THRESHOLD] - felt.level };
        let actuator = drive.actuator(numbers.resonance, numbers.quality).response(felt.frequency_hz);
        let load = felt.loaded.as_ref().map_or(Complex64::ONE, |loaded| {
            loaded.force + dynamic_stiffness(numbers.impedance, loaded.rate) * loaded.motion
        });
        // ln|z| without a root.
        THRESHOLD_KNOWN * at[THRESHOLD] - felt.level - 0.5 * (actuator.norm_sqr() / load.norm_sqr()).ln()
    }

    /// Where the edges are felt.
    pub(crate) fn edges<'f>(
        &'f self,
        felt: &'f [Felt],
        at: &'f Coordinates,
    ) -> impl Iterator<Item = FeltEdge> + 'f {
        let numbers = self.drive_at(at);
        felt.iter().map(move |felt| felt.envelope.edge(self.least(felt, &numbers, at)))
    }

    /// The same, with the ends of the plate for an edge that is not on it, metres.
    pub(crate) fn places_m(&self, felt: &[Felt], at: &Coordinates) -> Vec<f64> {
        let numbers = self.drive_at(at);
        felt.iter().map(|felt| felt.envelope.place_m(self.least(felt, &numbers, at))).collect()
    }
}

/// Plates and drives on which tones are felt up to marks.
pub(crate) struct Marked<'a> {
    pub(crate) near: Near<'a>,
    pub(crate) touches: &'a [Touch],
    pub(crate) tones: Vec<PlayedTone>,
}

impl Marked<'_> {
    /// The same as [`Target::log_likelihood`]: minus half of the sum of the squared distances over the variances.
    pub(crate) fn log_likelihood_of(&self, felt: &[Felt], at: &Coordinates) -> Option<f64> {
        let mut sum = 0.0;
        for (edge, touch) in self.near.edges(felt, at).zip(self.touches) {
            let off = (edge.place_m()? - touch.mark_m) / touch.tolerance_m;
            sum -= 0.5 * off * off;
        }
        Some(sum)
    }
}

impl Target for Marked<'_> {
    type Outer = Vec<Felt>;

    fn draw(&self, random: &mut Random) -> Coordinates {
        Coordinates::from_fn(|i, _| {
            if (OUTER..THRESHOLD).contains(&i) {
                let share = random.within(1e-9, 1.0 - 1e-9);
                (share / (1.0 - share)).ln()
            } else {
                random.normal()
            }
        })
    }

    fn log_prior(&self, at: &Coordinates) -> f64 {
        let of = |i: usize| {
            if (OUTER..THRESHOLD).contains(&i) {
                // Logistic: what ln(u/(1 - u)) of an even u has.
                -at[i].abs() - 2.0 * (-at[i].abs()).exp().ln_1p()
            } else {
                -0.5 * at[i] * at[i]
            }
        };
        (0..COUNT).map(of).sum()
    }

    fn outer(&self, at: &Coordinates) -> Option<Vec<Felt>> {
        self.near.felt(at, &self.tones)
    }

    fn log_likelihood(&self, felt: &Vec<Felt>, at: &Coordinates) -> Option<f64> {
        self.log_likelihood_of(felt, at)
    }
}
