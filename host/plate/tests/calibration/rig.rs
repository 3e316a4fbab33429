//! An unknown plate, drawn at random near a nominal one, and what a sensor on it measures: by the one-mode
//! equation or in two dimensions, with noise and 12 bits.

use super::bar;
use slipline_plate::calibrate::{self, MeasuredPoint, Measurement, SensorKind, band_hz};
pub(crate) use slipline_plate::truth::Random;
use slipline_plate::truth::near;
use slipline_plate::{
    Complex64, DriveTable, Equation, Finger, Peak, Plate, airy, plane, preset, respond_batch, respond_touched,
};
use std::f64::consts::TAU;

/// The rate of the device that plays the tones, Hz.
const RATE_HZ: f64 = 400e3;
/// Knots of a table; more would not change what is measured here.
const KNOTS: usize = 129;
/// Boundaries over the span at which a table is judged: of a plate whose fields take no time.
pub(crate) const BOUNDARIES: usize = 33;
/// Codes of an input from zero to full scale.
const CODES: f64 = 2048.0;
/// Tones that are played together.
const TONES: usize = 16;
/// Points of a field: an error of 1e-6.
const POINTS: usize = 1601;

/// What a plate is solved with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Solver {
    OneMode,
    TwoDimensions,
    /// A membrane in two dimensions whose end a bar moves.
    Bar,
}

/// A nominal plate and the true one.
#[derive(Clone)]
pub(crate) struct Rig {
    pub(crate) nominal: Plate,
    pub(crate) truth: Plate,
    pub(crate) solver: Solver,
    /// The sensor's signal over the displacement, the amplifier included.
    pub(crate) gain: f64,
    pub(crate) delay_s: f64,
    pub(crate) finger: Option<Finger>,
    /// Compliance of clamped edges in two dimensions, metres.
    pub(crate) edge_compliance_m: f64,
    pub(crate) snr_db: f64,
    /// The band in which it is measured, Hz.
    pub(crate) measured_hz: (f64, f64),
    /// Whether tones whose answers are not clear are measured for longer, as a device's are.
    pub(crate) averages: bool,
    /// Boundaries over the span at which a table is judged.
    pub(crate) boundaries: usize,
}

impl Rig {
    /// A truth near the preset with a delay and a gain.
    pub(crate) fn new(name: &str, solver: Solver, random: &mut Random) -> Self {
        Self::of(preset(name).expect("a preset"), solver, random)
    }

    /// The same near this plate.
    pub(crate) fn of(nominal: Plate, solver: Solver, random: &mut Random) -> Self {
        let truth = near(&nominal, random).expect("a valid plate");
        Self {
            truth,
            solver,
            gain: random.factor(1e3, 1e6),
            delay_s: random.within(0.0, 3.0) / nominal.band_hz().1,
            measured_hz: band_hz(&nominal),
            nominal,
            finger: None,
            edge_compliance_m: 0.0,
            snr_db: 40.0,
            averages: false,
            boundaries: BOUNDARIES,
        }
    }

    /// The same truth behind the drive of the nominal plate: its levels are those of the file but for what the plate
    /// itself changes.
    pub(crate) fn with_stated_drive(mut self) -> Self {
        let mut spec = self.truth.spec().clone();
        (spec.drive_end, spec.actuator) = (self.nominal.spec().drive_end, None);
        self.truth = Plate::new(spec).expect("a valid plate");
        self
    }

    /// Frequencies over the band that a calibration needs, uniform in the logarithm.
    pub(crate) fn frequencies_hz(&self, count: usize) -> Vec<f64> {
        let (low, high) = self.measured_hz;
        (0..count).map(|i| low * (high / low).powf(i as f64 / (count - 1) as f64)).collect()
    }

    pub(crate) fn fields(&self, frequencies_hz: &[f64]) -> Vec<Vec<Complex64>> {
        let each =
            |field: &dyn Fn(f64) -> Vec<Complex64>| frequencies_hz.iter().map(|&hz| field(hz)).collect();
        match (self.solver, &self.finger) {
            (Solver::OneMode, None) => {
                respond_batch(&self.truth, frequencies_hz, POINTS, Equation::Corrected).expect("in the band")
            }
            (Solver::OneMode, Some(finger)) => each(&|hz| {
                let touched = respond_touched(&self.truth, Some(finger), hz, POINTS, Equation::Corrected);
                touched.expect("in the band").amplitude
            }),
            (Solver::Bar, _) => each(&|hz| bar::field(&self.truth, hz, POINTS)),
            (Solver::TwoDimensions, _) => {
                let Self { finger, edge_compliance_m, .. } = *self;
                let setup = plane::Setup { finger, edge_compliance_m, ..plane::Setup::of(&self.truth) };
                each(&|hz| plane::respond(&self.truth, hz, POINTS, &setup).expect("in the band").amplitude)
            }
        }
    }

    /// From the code to the driven end, in units of the sensor.
    fn drive(&self, frequency_hz: f64) -> Complex64 {
        let turn = std::f64::consts::PI * frequency_hz / RATE_HZ;
        let lag = Complex64::cis(TAU * frequency_hz * self.delay_s);
        self.truth.drive_response(frequency_hz) * lag * (turn.sin() / turn) * self.truth.spec().full_scale_m
    }

    /// What an uncalibrated displacement sensor at each place measures, whose marks are at `marks_m`.
    pub(crate) fn measure<const N: usize>(
        &self,
        places_m: [f64; N],
        count: usize,
        random: &mut Random,
    ) -> [Measurement; N] {
        let frequencies = self.frequencies_hz(count);
        let step_m = self.truth.length_m() / (POINTS - 1) as f64;
        let fields = self.fields(&frequencies);
        places_m.map(|place_m| {
            let at = place_m / step_m;
            let (left, t) = (at as usize, at.fract());
            let seen = |(field, &hz): (&Vec<Complex64>, &f64)| {
                let here = field[left] * (1.0 - t) + field.get(left + 1).map_or(Complex64::ZERO, |f| f * t);
                here * self.drive(hz) * self.gain
            };
            let clean: Vec<Complex64> = fields.iter().zip(&frequencies).map(seen).collect();
            self.sampled(place_m, &frequencies, &clean, random)
        })
    }

    /// With noise and in codes; the input's range is twice the largest answer.
    pub(crate) fn sampled(
        &self,
        place_m: f64,
        frequencies_hz: &[f64],
        clean: &[Complex64],
        random: &mut Random,
    ) -> Measurement {
        let mean: f64 = clean.iter().map(Complex64::norm_sqr).sum::<f64>() / clean.len() as f64;
        let largest = clean.iter().map(|answer| answer.norm()).fold(0.0, f64::max);
        let code = 2.0 * largest / CODES;
        let noise = mean.sqrt() * 10_f64.powf(-self.snr_db / 20.0);
        let coded = |value: f64| (value / code).round() * code;
        let mut window = |answer: &Complex64| {
            let noisy = answer + Complex64::new(random.normal(), random.normal()) * noise;
            Complex64::new(coded(noisy.re), coded(noisy.im))
        };
        let mut sums: Vec<Complex64> = clean.iter().map(&mut window).collect();
        let deviation = noise.hypot(code / 12_f64.sqrt());
        let combs = clean.len().div_ceil(TONES);
        let mut windows = vec![1_u16; combs];
        for comb in (0..combs).filter(|_| self.averages) {
            let tones = || (comb..clean.len()).step_by(combs);
            windows[comb] = calibrate::windows(tones().map(|tone| sums[tone].norm() / deviation));
            for tone in (1..windows[comb]).flat_map(|_| tones()) {
                sums[tone] += window(&clean[tone]);
            }
        }
        let points = frequencies_hz.iter().zip(clean).zip(&sums).enumerate();
        let points = points.map(|(tone, ((&frequency_hz, answer), sum))| {
            let windows = f64::from(windows[tone % combs]);
            MeasuredPoint {
                frequency_hz,
                response: sum / windows,
                noise: deviation / windows.sqrt(),
                headroom_db: Some((20.0 * (2.0 * largest / answer.norm()).log10()).min(300.0)),
            }
        });
        let points = points.collect();
        let measured = Measurement::at(place_m, SensorKind::Displacement, points);
        Measurement { sample_rate_hz: Some(RATE_HZ), ..measured }
    }

    /// The table that a device gets for `plate`.
    pub(crate) fn table(&self, plate: &Plate) -> DriveTable {
        DriveTable::build(plate, RATE_HZ, KNOTS).expect("a table")
    }

    /// The true plate's deflection under a tone of this DAC amplitude, metres.
    pub(crate) fn tone(&self, frequency_hz: f64, amplitude: f64) -> Vec<Complex64> {
        let drive = self.drive(frequency_hz) * amplitude;
        self.fields(&[frequency_hz]).remove(0).into_iter().map(|f| f * drive).collect()
    }

    /// Drives the true plate with a table made for `plate`.
    pub(crate) fn judge(&self, plate: &Plate) -> Judgement {
        let (boundary_m, levels) = self.driven(plate);
        // The sensor is not calibrated: one factor for the whole span is free.
        let middle =
            levels.iter().copied().fold(f64::MIN, f64::max) + levels.iter().copied().fold(f64::MAX, f64::min);
        let level_db = levels.iter().map(|level| (level - 0.5 * middle).abs()).fold(0.0, f64::max);
        Judgement { boundary_m, level_db }
    }

    /// The same: the largest error of the boundary, metres, and how far each level is from their mean, dB.
    pub(crate) fn errors(&self, plate: &Plate) -> (f64, Vec<f64>) {
        let (mut boundary_m, levels) = self.driven(plate);
        if self.solver == Solver::OneMode {
            // Of the plate itself: a table of few knots moves them onto resonances.
            boundary_m = self.boundary_m(|place_m| plate.frequency_for_boundary_hz(place_m));
        }
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        (boundary_m, levels.iter().map(|level| (level - mean).abs()).collect())
    }

    /// The largest error of the boundary by the equation of one mode, metres, where the tone of a boundary has this frequency, Hz.
    fn boundary_m(&self, frequency_hz: impl Fn(f64) -> f64) -> f64 {
        let off = |place_m: f64| {
            (self.truth.turning_point_m(frequency_hz(place_m)).expect("enters") - place_m).abs()
        };
        self.places_m().map(off).fold(0.0, f64::max)
    }

    /// The same with a table made for `plate`.
    pub(crate) fn boundary_by_table_m(&self, plate: &Plate) -> f64 {
        let table = self.table(plate);
        self.boundary_m(|place_m| table.frequency_hz(place_m))
    }

    /// The boundaries over the span at which a table is judged, metres.
    fn places_m(&self) -> impl Iterator<Item = f64> + use<> {
        let ((start, end), last) = (self.nominal.span_m(), self.boundaries - 1);
        (0..=last).map(move |i| start + (end - start) * i as f64 / last as f64)
    }

    /// The largest error of the boundary, metres, and the level at each place, dB.
    fn driven(&self, plate: &Plate) -> (f64, Vec<f64>) {
        let table = self.table(plate);
        let places: Vec<f64> = self.places_m().collect();
        let frequencies: Vec<f64> = places.iter().map(|&x| table.frequency_hz(x)).collect();
        let mut levels = Vec::new();
        let mut boundary_m: f64 = 0.0;
        for ((&x, &hz), field) in places.iter().zip(&frequencies).zip(self.fields(&frequencies)) {
            let peak = Peak::of(&field, &self.truth, hz);
            let turning_m = self.truth.turning_point_m(hz).expect("enters");
            boundary_m = boundary_m.max(match (self.solver, peak) {
                (Solver::OneMode, _) => (turning_m - x).abs(),
                // In two dimensions the peak has a place, a turning point is a notion of one mode.
                (Solver::TwoDimensions | Solver::Bar, Some(peak)) => {
                    (peak.position_m - expected_peak_m(plate, hz)).abs()
                }
                (Solver::TwoDimensions | Solver::Bar, None) => 0.0,
            });
            let amplitude = peak.map_or_else(
                || {
                    let at = turning_m.min(self.truth.length_m()) / self.truth.length_m();
                    let there = field[(at * (POINTS - 1) as f64).round() as usize].norm();
                    there * airy::PEAK_VALUE / airy::ai(0.0)
                },
                |peak| peak.amplitude,
            );
            levels.push(20.0 * (amplitude * self.drive(hz).norm() * table.gain(x)).log10());
        }
        (boundary_m, levels)
    }
}

/// Where the plate of the table has its peak, metres.
fn expected_peak_m(plate: &Plate, frequency_hz: f64) -> f64 {
    let field = respond_batch(plate, &[frequency_hz], POINTS, Equation::Corrected).expect("in the band");
    Peak::of(&field[0], plate, frequency_hz).map_or(f64::NAN, |peak| peak.position_m)
}

/// What a table does on the true plate: the largest errors over the span.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judgement {
    pub(crate) boundary_m: f64,
    pub(crate) level_db: f64,
}

/// The middle of a list, and its largest.
pub(crate) fn middle_and_worst(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    (values[values.len() / 2], values[values.len() - 1])
}
