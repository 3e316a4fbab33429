//! Fisher's information of two sensors on the nominal plate: what a calibration by the ratio of their places would reach.

use crate::calibrate::error::CalibrateError;
use crate::calibrate::fit::gain::level_error;
use crate::calibrate::fit::gaussian_process::{Places, Process};
use crate::calibrate::fit::pairs::{MODEL_ERROR, tail_error, tail_variances};
use crate::calibrate::fit::parameter::INTERVAL;
use crate::calibrate::fit::response::prediction::per_metre;
use crate::calibrate::fit::response::wave::{FINE, Wave, points};
use crate::calibrate::fit::search::PLACE_STEP_M;
use crate::calibrate::fit::spread::{Nodes, Turning, given};
use crate::calibrate::fit::unknowns::{EDGE_GIVE, OF_PLATE_MAX, spec_at, steps};
use crate::calibrate::measurement::sensor::{Measurement, PLACE_TOLERANCE_M, SensorKind};
use crate::definition::{Plate, Resonator};
use crate::progress::Progress;
use crate::table::level::DriveToPeak;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// The sensors' places.
const PLACES: usize = 2;
/// Standard deviation of the drive over what a plate file says of it, in the logarithm (1.7 dB), and its correlation
/// length over the ripple's period: a source that does not match leaves a ripple of the resonances.
const DRIVE: f64 = 0.2;
/// The same of a source that reflects, behind an actuator that resonates: the ripple of a resonant plate is a comb (4.3 dB).
const RESONANT_DRIVE: f64 = 0.5;
const OF_RIPPLE: f64 = 0.5;
/// Resonances of an actuator that no file states, over the middle of the band, and their quality: the worst of those of a secret
/// plate ([`crate::truth`]).
const RESONANT: [f64; 2] = [0.5, 1.0];
const QUALITY: f64 = 5.0;
/// Rate without a zero-order hold, Hz: only the shape over the band counts.
const NO_HOLD_HZ: f64 = 1e8;

/// What sensors of one kind see at places of the nominal plate.
pub(crate) struct Information {
    frequencies_hz: Vec<f64>,
    /// At each frequency: the wave at each place, and its derivatives.
    rows: Vec<Vec<Seen>>,
    /// Derivatives of the logarithm of the peak over the wave's own scale.
    of_peak: Vec<[f64; OF_PLATE_MAX]>,
    turning: Turning,
    nodes: Nodes,
    drive: Process,
    /// Gains of actuators that no file states, at each frequency: they resonate in the band or below it.
    resonant: [Vec<f64>; 2],
    /// The information about the plate's coordinates.
    deviations: Vec<f64>,
    band_hz: (f64, f64),
    level_error: f64,
    tail_error: f64,
}

/// A sensor's signal at one place, as its nominal drive makes it.
#[derive(Clone, Copy)]
struct Seen {
    signal: f64,
    of_plate: [f64; OF_PLATE_MAX],
    per_metre: f64,
}

impl Seen {
    /// The same behind an actuator of this gain.
    fn times(self, gain: f64) -> Self {
        Self {
            signal: gain * self.signal,
            of_plate: self.of_plate.map(|slope| gain * slope),
            per_metre: gain * self.per_metre,
        }
    }
}

/// Halves of the 95 % intervals that a pair would reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reached {
    pub(crate) boundary_m: f64,
    pub(crate) level_db: f64,
    /// The level behind the worst of the actuators.
    pub(crate) resonant_db: f64,
    pub(crate) nodes_m: f64,
    /// The boundary's over the one that is left if how far the edges give is known, behind the worst of the actuators.
    pub(crate) by_edges: f64,
}

impl Information {
    pub(crate) fn new(
        plate: &Plate,
        kind: SensorKind,
        deviations: Vec<f64>,
        places_m: &[f64],
        frequencies_hz: &[f64],
    ) -> Result<Self, CalibrateError> {
        let highest_hz = *frequencies_hz.last().ok_or(CalibrateError::NoFit)?;
        let count = points(plate.spec(), highest_hz, FINE);
        let on_plate = |at: f64| at.clamp(0.0, plate.length_m());
        let all: Vec<f64> = places_m
            .iter()
            .flat_map(|&at| [at, on_plate(at + PLACE_STEP_M), on_plate(at - PLACE_STEP_M)])
            .collect();
        let wave = |coordinates: &[f64]| -> Result<_, CalibrateError> {
            let wave = Wave::new(spec_at(plate.spec(), coordinates), count)?;
            Ok(wave.with_peak(kind, &all, frequencies_hz))
        };
        let (of_plate, steps) = (deviations.len(), steps(plate.spec()));
        let here = wave(&vec![0.0; of_plate])?;
        let beside = (0..of_plate).map(|i| {
            let mut beside = vec![0.0; of_plate];
            beside[i] = steps[i];
            wave(&beside)
        });
        let beside = beside.collect::<Result<Vec<_>, _>>()?;
        let levels =
            DriveToPeak::unchecked(plate, NO_HOLD_HZ).levels(frequencies_hz, &mut Progress::unwatched())?;
        let sensor = Measurement::at(0.0, kind, Vec::new());
        // The derivative of the sensor's signal at a place, or of the peak.
        let value = |row: &(Vec<f64>, f64), at: Option<usize>| at.map_or(row.1, |at| row.0[3 * at]);
        let slopes = |at: Option<usize>, i: usize| -> [f64; OF_PLATE_MAX] {
            let slope = |k: usize| (value(&beside[k][i], at) - value(&here[i], at)) / steps[k];
            std::array::from_fn(|k| if k < of_plate { slope(k) } else { 0.0 })
        };
        let row = |i: usize| {
            let (p, peak) = &here[i];
            let rise = per_metre(plate, &sensor, frequencies_hz[i]).norm();
            let source = levels[i].amplitude * plate.spec().full_scale_m * rise / peak;
            let seen = |at: usize| Seen {
                signal: source * p[3 * at],
                of_plate: slopes(Some(at), i).map(|slope| source * slope),
                per_metre: source * (p[3 * at + 1] - p[3 * at + 2]) / (all[3 * at + 1] - all[3 * at + 2]),
            };
            (0..places_m.len()).map(seen).collect()
        };
        let of_peak = |i: usize| slopes(None, i).map(|slope| slope / here[i].1);
        Ok(Self {
            rows: (0..here.len()).map(row).collect(),
            of_peak: (0..here.len()).map(of_peak).collect(),
            turning: Turning::of(plate).ok_or(CalibrateError::NoFit)?,
            nodes: Nodes::of(plate).ok_or(CalibrateError::NoFit)?,
            drive: drive(plate, frequencies_hz[0], highest_hz),
            resonant: RESONANT.map(|share| resonant(share, frequencies_hz)),
            frequencies_hz: frequencies_hz.to_vec(),
            deviations,
            band_hz: plate.band_hz(),
            level_error: level_error(plate),
            tail_error: tail_error(&plate.spec().model),
        })
    }

    /// Root of the mean square of the signals over all frequencies and places.
    pub(crate) fn usual(&self) -> f64 {
        let squares = self.rows.iter().flatten().map(|seen| seen.signal * seen.signal);
        let count = self.rows.iter().map(Vec::len).sum::<usize>();
        (squares.sum::<f64>() / count as f64).sqrt()
    }

    /// Share of the frequencies at which the sensor at a place shows less than `least`.
    pub(crate) fn silent_share(&self, at: usize, least: f64) -> f64 {
        let silent = self.rows.iter().filter(|row| row[at].signal < least).count();
        silent as f64 / self.rows.len() as f64
    }

    /// What the pair of two places would reach under this noise; `None` where its information is singular. An actuator that resonates
    /// takes the signal from the rest of the band.
    pub(crate) fn reached(&self, pair: [usize; 2], noise: f64) -> Option<Reached> {
        let stated = self.reached_behind((&vec![1.0; self.rows.len()], DRIVE), pair, noise)?;
        let resonant =
            self.resonant.iter().map(|gains| self.reached_behind((gains, RESONANT_DRIVE), pair, noise));
        let resonant = resonant.collect::<Option<Vec<_>>>()?;
        let worst = |of: fn(&Reached) -> f64| resonant.iter().map(of).fold(of(&stated), f64::max);
        Some(Reached { resonant_db: worst(|it| it.level_db), by_edges: worst(|it| it.by_edges), ..stated })
    }

    /// The same behind an actuator with these gains and a drive of this standard deviation. The noise keeps its share of the root of
    /// the mean square of the signals.
    fn reached_behind(
        &self,
        (gains, drive): (&[f64], f64),
        [a, b]: [usize; 2],
        noise: f64,
    ) -> Option<Reached> {
        let drive = Process { size: drive, ..self.drive };
        let square = |gain: fn(f64) -> f64| -> f64 {
            self.rows
                .iter()
                .zip(gains)
                .flat_map(|(row, of)| row.iter().map(move |it| (gain(*of) * it.signal).powi(2)))
                .sum()
        };
        let noise = noise * (square(|gain| gain) / square(|_| 1.0)).sqrt();
        let of_plate = self.deviations.len();
        let count = of_plate + PLACES;
        let known = self.deviations.iter().chain(&[PLACE_TOLERANCE_M; PLACES]).map(|it| it.powi(-2));
        let mut information = DMatrix::from_diagonal(&DVector::from_iterator(count, known));
        let mut slopes: Vec<Vec<f64>> = vec![Vec::new(); count];
        let mut variances = Vec::with_capacity(self.rows.len());
        let signals = self.rows.iter().zip(gains).map(|(row, gain)| [a, b].map(|at| gain * row[at].signal));
        let tails = tail_variances(signals, self.tail_error);
        for (((row, of_peak), &gain), tail) in self.rows.iter().zip(&self.of_peak).zip(gains).zip(tails) {
            let (a, b) = (row[a].times(gain), row[b].times(gain));
            let variance = |seen: Seen| noise.powi(2) + (MODEL_ERROR * seen.signal).powi(2) + tail;
            let (of_a, of_b) = (variance(a), variance(b));
            let spread = (of_a * b.signal.powi(2) + of_b * a.signal.powi(2)).sqrt();
            // The weights of both in the source's amplitude.
            let weight = a.signal.powi(2) / of_a + b.signal.powi(2) / of_b;
            let along = |of_a_by: f64, of_b_by: f64| {
                let ratio = (a.signal * of_b_by - b.signal * of_a_by) / spread;
                let source = (a.signal * of_a_by / of_a + b.signal * of_b_by / of_b) / weight;
                (ratio, source)
            };
            let mut of_ratio = [0.0; OF_PLATE_MAX + PLACES];
            for i in 0..count {
                let (ratio, source) = match i.checked_sub(of_plate) {
                    None => along(a.of_plate[i], b.of_plate[i]),
                    Some(0) => along(a.per_metre, 0.0),
                    Some(_) => along(0.0, b.per_metre),
                };
                of_ratio[i] = ratio;
                slopes[i].push(of_peak[..of_plate].get(i).copied().unwrap_or(0.0) - source);
            }
            for i in 0..count {
                for j in 0..count {
                    information[(i, j)] += of_ratio[i] * of_ratio[j];
                }
            }
            variances.push(weight.recip());
        }
        let covariance = information.cholesky()?.inverse();
        let places = Places { at: self.frequencies_hz.iter().map(|hz| hz.ln()).collect(), variances };
        let level_of = (true, self.level_error);
        let level_db = drive.deviation_db(&places, &slopes, &covariance, self.band_hz, level_of)?;
        let (boundary_m, _) = self.turning.deviations(&covariance);
        let (known_m, _) = self.turning.deviations(&given(&covariance, EDGE_GIVE));
        let nodes_m = self.nodes.deviation_m(&covariance);
        [boundary_m, level_db, nodes_m].iter().all(|it| it.is_finite()).then_some(Reached {
            boundary_m: INTERVAL * boundary_m,
            level_db: INTERVAL * level_db,
            resonant_db: INTERVAL * level_db,
            nodes_m: INTERVAL * nodes_m,
            by_edges: boundary_m / known_m,
        })
    }
}

/// Gains of an actuator that resonates at this share of the middle of the band.
fn resonant(share: f64, frequencies_hz: &[f64]) -> Vec<f64> {
    let (Some(low_hz), Some(high_hz)) = (frequencies_hz.first(), frequencies_hz.last()) else {
        return Vec::new();
    };
    let resonance_hz = 0.5 * share * (low_hz + high_hz);
    let resonator = Resonator { resonance_hz, quality: QUALITY, travel: None };
    frequencies_hz.iter().map(|&hz| resonator.response(hz).norm()).collect()
}

/// What is known of the drive's correction over the logarithm of the frequency. A ripple's period is one more half wave on the
/// plate.
fn drive(plate: &Plate, low_hz: f64, high_hz: f64) -> Process {
    let phase = |hz: f64| plate.width_mode(1).phase_to(plate.length_m(), hz);
    let ripples = ((phase(high_hz) - phase(low_hz)) / PI).max(1.0);
    Process { size: DRIVE, length: OF_RIPPLE * (high_hz / low_hz).ln() / ripples }
}
