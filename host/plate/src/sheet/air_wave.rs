//! The wave of a sheet in air.
//!
//! Air makes K^2 a function of the frequency that rises more slowly than omega^2, and a wave carries more of it toward its turning
//! point (`definition/air_along.rs`). That has no causal law in time that is exact: K^2 is real at all frequencies and no
//! polynomial. v_tt = c^2 (v_xx + v_zz + a(x) v) has
//!
//! ```text
//! K(x)^2 = a(x) + omega^2/c^2
//! ```
//! without loss and with the same conditions at the edges and the driven end, whatever a and c are. One tone is exact, and 1/c^2 is
//! the mean of dK^2/d omega^2 along the plate, by which its transients travel. For more tones, c is that of least squares over
//! tones and places, and a(x) makes the largest relative error of the tones that reach x least. v is sqrt(Omega) times the
//! displacement, with the power weight Omega of the air along the plate, whose derivatives are left out as in
//! `frequency/numerov.rs`. Motion slower than every width mode would grow where K^2 < a, so a(x) stays below (pi/2W)^2 of its
//! place; where the tones would need more, a smaller c takes the rest. A grid is made for steps of the plate in a vacuum, so c is at
//! most V.
//!
//! What a baffle holds together at a distance is not local, and the sheet does not have it (`distant_air.rs`).

use crate::definition::air_along::AirAlong;
use crate::definition::plate::Plate;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Largest relative error of the wavenumber in air that a sheet may have. It moves a boundary by 2.2 mm where the plate
/// narrows by 4.62 /m.
pub(crate) const WAVENUMBER_ERROR_MAX: f64 = 0.01;
/// Largest a over the least K^2 of a motion of the plate at its place. The grid has that a little lower.
const LIFT_MAX: f64 = 0.9;
/// Tones of a band.
const TONES: u32 = 33;
/// Half of the distance of the two frequencies of a derivative, relative.
const BESIDE: f64 = 1e-3;

/// The stations of a grid along the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stations {
    pub(super) step_m: f64,
    pub(super) count: usize,
}

/// c, a(x) and sqrt(Omega(x)) of the text above.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AirWave {
    pub(super) speed_m_per_s: f64,
    step_m: f64,
    /// a at each station, 1/m^2; empty without air, where it is 0.
    lift_per_m2: Vec<f64>,
    /// sqrt(Omega) at each station; empty without air, where it is 1.
    root_weight: Vec<f64>,
}

impl AirWave {
    /// The wave that has the plate's wavenumber at a frequency, Hz, or as nearly as one equation has it between two.
    pub(super) fn of(plate: &Plate, (low_hz, high_hz): (f64, f64), stations: Stations) -> Self {
        let vacuum = plate.spec().model.wave_speed_m_per_s().unwrap_or(f64::NAN);
        let step_m = stations.step_m;
        if !plate.carries_air() {
            return Self { speed_m_per_s: vacuum, step_m, lift_per_m2: Vec::new(), root_weight: Vec::new() };
        }
        let mode = plate.width_mode(1);
        let tone = |frequency_hz: f64| Tone::of(plate, frequency_hz);
        let middle_hz = (low_hz * high_hz).sqrt();
        let is_one = high_hz <= low_hz * (1.0 + 1e-9);
        let tones: Vec<Tone> =
            if is_one { vec![tone(middle_hz)] } else { between((low_hz, high_hz)).map(tone).collect() };
        let beside = [1.0 - BESIDE, 1.0 + BESIDE].map(|factor| tone(middle_hz * factor));
        let places: Vec<Place> = (0..stations.count)
            .map(|station| {
                let x = station as f64 * step_m;
                let least = (FRAC_PI_2 / plate.half_width_m(x)).powi(2);
                Place { x, across: mode.width_term(x), most: LIFT_MAX * least }
            })
            .collect();
        let mut slope = slope_of(&places, if is_one { &beside } else { &tones });
        slope = slope.max(vacuum.powi(-2));
        for place in &places {
            let (squared, wanted) = place.mean(&tones);
            slope = slope.max((wanted - place.most) / squared);
        }
        let middle = tone(middle_hz).air;
        Self {
            speed_m_per_s: slope.recip().sqrt(),
            step_m,
            lift_per_m2: places.iter().map(|place| place.lift(&tones, slope)).collect(),
            root_weight: places.iter().map(|at| middle.weight_from_end(at.across, at.x).sqrt()).collect(),
        }
    }

    /// The lowest and the highest of these tones, Hz.
    pub(super) fn band_of(tones_hz: &[f64]) -> Option<(f64, f64)> {
        let ends =
            tones_hz.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &hz| (low.min(hz), high.max(hz)));
        (!tones_hz.is_empty()).then_some(ends)
    }

    /// Whether a changes along the plate.
    pub(super) fn is_lifted(&self) -> bool {
        !self.lift_per_m2.is_empty()
    }

    /// a at a station, 1/m^2.
    pub(super) fn lift_per_m2(&self, station: usize) -> f64 {
        self.lift_per_m2.get(station).copied().unwrap_or(0.0)
    }

    /// The factor of a station's displacement on the grid.
    pub(super) fn root_weight(&self, station: usize) -> f64 {
        self.root_weight.get(station).copied().unwrap_or(1.0)
    }

    /// Largest relative error of the wavenumber at a frequency, Hz, between the driven end and its turning point.
    pub(super) fn error_at(&self, plate: &Plate, frequency_hz: f64) -> f64 {
        let tone = Tone::of(plate, frequency_hz);
        let mode = plate.width_mode(1);
        let at = |(station, lift): (usize, &f64)| {
            let across = mode.width_term(station as f64 * self.step_m);
            let squared = lift + tone.squared / self.speed_m_per_s.powi(2);
            tone.reaches(across).then(|| ((squared / tone.at(across)).sqrt() - 1.0).abs())
        };
        self.lift_per_m2.iter().enumerate().filter_map(at).fold(0.0, f64::max)
    }

    /// The largest of them from one frequency to another, Hz.
    pub(super) fn error_between(&self, plate: &Plate, band_hz: (f64, f64)) -> f64 {
        between(band_hz).map(|frequency_hz| self.error_at(plate, frequency_hz)).fold(0.0, f64::max)
    }

    /// r of the damping term r v_t, 1/s, that takes the loss of the plate's wave at a frequency, Hz, on its way to the turning point.
    pub(super) fn damping_per_s(&self, plate: &Plate, frequency_hz: f64) -> f64 {
        let tone = Tone::of(plate, frequency_hz);
        let mode = plate.width_mode(1);
        // K^2 (1 + j eta) = a + (omega^2 + j r omega)/c^2, and eta K^2/2k is lost on the way.
        let (mut lost, mut way) = (0.0, 0.0);
        for station in 0..self.lift_per_m2.len() {
            let across = mode.width_term(station as f64 * self.step_m);
            if tone.reaches(across) {
                let here = tone.air.at(across);
                let along = (here.wavenumber_squared - across).sqrt().recip();
                lost += here.loss_share * here.wavenumber_squared * along;
                way += along;
            }
        }
        if way == 0.0 {
            (lost, way) = (plate.dilution(frequency_hz) * plate.wavenumber_squared(frequency_hz), 1.0);
        }
        plate.stiffness_loss_at(frequency_hz) * lost / way * self.speed_m_per_s.powi(2) / (TAU * frequency_hz)
    }
}

/// Frequencies from one to another, Hz, a band of tones.
fn between((low_hz, high_hz): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..TONES).map(move |i| low_hz * (high_hz / low_hz).powf(f64::from(i) / f64::from(TONES - 1)))
}

/// omega^2, and the plate's wave.
struct Tone {
    squared: f64,
    air: AirAlong,
}

impl Tone {
    fn of(plate: &Plate, frequency_hz: f64) -> Self {
        let air = plate.width_mode(1).air_or_uniform(frequency_hz);
        Self { squared: (TAU * frequency_hz).powi(2), air }
    }

    /// Whether it is a wave at a place whose (q/s)^2 is `across`.
    fn reaches(&self, across: f64) -> bool {
        across < self.air.turning
    }

    /// K^2 there.
    fn at(&self, across: f64) -> f64 {
        self.air.at(across).wavenumber_squared
    }
}

/// A station: its place, (q/s)^2 and the largest a.
struct Place {
    x: f64,
    across: f64,
    most: f64,
}

impl Place {
    /// The tones that reach it; beyond all turning points the highest.
    fn tones<'a>(&self, tones: &'a [Tone]) -> &'a [Tone] {
        let first = tones.partition_point(|tone| !tone.reaches(self.across));
        &tones[first.min(tones.len() - 1)..]
    }

    /// Means of omega^2 and of K^2 over its tones, weighted for relative errors.
    fn mean(&self, tones: &[Tone]) -> (f64, f64) {
        let mut sums = [0.0; 3];
        for tone in self.tones(tones) {
            let wavenumber = tone.at(self.across);
            let weight = wavenumber.powi(-2);
            sums = [sums[0] + weight, sums[1] + weight * tone.squared, sums[2] + weight * wavenumber];
        }
        (sums[1] / sums[0], sums[2] / sums[0])
    }

    /// a: the largest relative error of its tones is least, by the two that are farthest apart.
    fn lift(&self, tones: &[Tone], slope: f64) -> f64 {
        let wanted = |tone: &Tone| {
            let squared = tone.at(self.across);
            (squared - slope * tone.squared, squared)
        };
        let wanted: Vec<(f64, f64)> = self.tones(tones).iter().map(wanted).collect();
        let (mut lift, mut farthest) = (wanted[0].0, 0.0);
        for (i, a) in wanted.iter().enumerate() {
            for b in &wanted[..i] {
                let apart = (a.0 - b.0).abs() / (a.1 + b.1);
                if apart > farthest {
                    (lift, farthest) = ((a.0 * b.1 + b.0 * a.1) / (a.1 + b.1), apart);
                }
            }
        }
        lift.min(self.most)
    }
}

/// dK^2/d omega^2 by least squares over the tones, with an a of its own at each place.
fn slope_of(places: &[Place], tones: &[Tone]) -> f64 {
    let (mut rise, mut run) = (0.0, 0.0);
    for place in places {
        let (squared, wavenumber) = place.mean(tones);
        for tone in place.tones(tones) {
            let there = tone.at(place.across);
            let (dx, dy) = (tone.squared - squared, there - wavenumber);
            let weight = there.powi(-2);
            rise += weight * dx * dy;
            run += weight * dx * dx;
        }
    }
    rise / run
}
