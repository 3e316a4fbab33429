//! The plates and drives near the file's, and the felt edges of tones on them.
//!
//! Coordinates: those of the plate ([`crate::calibrate::fit::unknowns`]), each over its standard deviation; then
//! resistance, mass and stiffness of the source and resonance and quality of the actuator, each as ln(u/(1 - u)) of its
//! place u (0 to 1) in the range of [`crate::truth`]; then the logarithm of the threshold over the level, over its
//! standard deviation.

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

/// Index of the threshold's coordinate, and the prior standard deviation of its logarithm: fingers and sources differ.
pub(crate) const THRESHOLD: usize = COUNT - 1;
pub(crate) const THRESHOLD_KNOWN: f64 = 1.5;
/// Indices of the first coordinates of the source and of the actuator.
const RESISTANCE_AT: usize = OUTER;
const RESONANCE_AT: usize = OUTER + 3;
/// Least number of points of a field: an edge is interpolated between two of them.
const POINTS_LEAST: usize = 301;

/// A tone whose edge is touched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlayedTone {
    pub(crate) frequency_hz: f64,
    /// Amplitude of the DAC codes, over full scale.
    pub(crate) amplitude: f64,
}

/// Parameters of a drive.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DriveNumbers {
    /// Resistance, mass and stiffness, in the units of the spread.
    pub(crate) impedance: [f64; 3],
    /// Resonance frequency over that of the middle of the band.
    resonance: f64,
    quality: f64,
}

/// The plates and drives near the file's.
pub(crate) struct Near<'a> {
    pub(crate) nominal: &'a Plate,
    pub(crate) feeling: Feeling,
    /// Spread of the drive; `None` where the drive is as the file states it.
    pub(crate) drive: Option<DriveSpread>,
    /// Prior standard deviations of the plate's coordinates.
    pub(crate) deviations: [f64; OF_PLATE],
    points: usize,
}

/// One tone on one plate.
pub(crate) struct Felt {
    frequency_hz: f64,
    envelope: Envelope,
    /// ln of the amplitude times all factors that do not depend on the drive's parameters, over the smallest amplitude
    /// that is felt.
    level: f64,
    /// F_p and f(0) of [`LoadedEnd::of_wave`]; `None` where the source is that of the file.
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

    /// The plate at these coordinates, with the file's own drive.
    pub(crate) fn plate_at(&self, at: &Coordinates) -> PlateSpec {
        let of_plate: [f64; OF_PLATE] = std::array::from_fn(|i| at[i] * self.deviations[i]);
        spec_at(self.nominal.spec(), &of_plate)
    }

    /// The plate at these coordinates, with the drive at these coordinates.
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

    /// The DAC amplitude of each tone, given as (frequency in Hz, peak in metres that the file predicts).
    pub(crate) fn amplitudes(&self, tones: &[(f64, f64)]) -> Vec<f64> {
        let plate = self.nominal;
        let grid = Grid::new(plate, Equation::Corrected, self.points, 1);
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

    /// The tones on the plate at these coordinates; `None` where the plate is not valid or a tone does not enter it.
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
                let grid = Grid::new(&plate, Equation::Corrected, self.points, 1);
                solve_each(&grid, &plate, &frequencies, |number, field| {
                    felt.push(tone_of(number, field, &plate, None));
                });
            }
        }
        Some(felt)
    }

    /// Logarithm of the smallest amplitude of this tone that is felt, in the unit of its field.
    fn least(&self, felt: &Felt, numbers: &DriveNumbers, at: &Coordinates) -> f64 {
        let Some(drive) = &self.drive else { return THRESHOLD_KNOWN * at[THRESHOLD] - felt.level };
        let actuator = drive.actuator(numbers.resonance, numbers.quality).response(felt.frequency_hz);
        let load = felt.loaded.as_ref().map_or(Complex64::ONE, |loaded| {
            loaded.force + dynamic_stiffness(numbers.impedance, loaded.rate) * loaded.motion
        });
        // ln|z| without a square root.
        THRESHOLD_KNOWN * at[THRESHOLD] - felt.level - 0.5 * (actuator.norm_sqr() / load.norm_sqr()).ln()
    }

    /// The felt edge of each tone.
    pub(crate) fn edges<'f>(
        &'f self,
        felt: &'f [Felt],
        at: &'f Coordinates,
    ) -> impl Iterator<Item = FeltEdge> + 'f {
        let numbers = self.drive_at(at);
        felt.iter().map(move |felt| felt.envelope.edge(self.least(felt, &numbers, at)))
    }

    /// The felt edges as places, metres: the driven end if nothing is felt, the plate's end if everything is.
    pub(crate) fn places_m(&self, felt: &[Felt], at: &Coordinates) -> Vec<f64> {
        let numbers = self.drive_at(at);
        felt.iter().map(|felt| felt.envelope.place_m(self.least(felt, &numbers, at))).collect()
    }
}

/// The plates and drives, with tones that are felt up to marks.
pub(crate) struct Marked<'a> {
    pub(crate) near: Near<'a>,
    pub(crate) touches: &'a [Touch],
    pub(crate) tones: Vec<PlayedTone>,
}

impl Marked<'_> {
    /// Log likelihood, see [`Target::log_likelihood`]: minus half of the sum of the squared distances of edge and mark,
    /// each over its variance; `None` where a tone has no edge on the plate.
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
                // Logistic distribution: that of ln(u/(1 - u)) for a uniform u.
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
