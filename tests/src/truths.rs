//! Row 2 of what must hold of calibrations: true plates drawn at random, each measured through protocol, device
//! application and simulated rig, and calibrated from two places of the sensor.

use crate::bench::{MeasuringBench, PLACES, RATE_HZ};
use slipline_instrument::measure::{Plan, Wanted};
use slipline_instrument::rig::{RigOptions, limits};
use slipline_link::protocol::limits::MAX_TONES;
use slipline_model::field::simulation::table_for;
use slipline_plate::calibrate::{
    CalibrateError, Calibrated, Departure, MeasuredPoint, Measurement, Priors, SensorKind, departure,
    from_ratio, predicted,
};
use slipline_plate::truth::{Random, near};
use slipline_plate::{Complex64, Model, Plate, PlateSpec, preset};

/// A ratio of root mean squares.
const SNR: f64 = 100.0;
/// Codes from zero to the end of an input's range.
const CODES: f64 = 2048.0;
/// Fewest codes of noise that an input needs so that its mean is linear.
const DITHER_LSB: f64 = 0.5;
/// The input's range over the largest peak of a tone of the table on the true plate: 12 dB.
const ROOM: f64 = 4.0;

/// The name of `al-bending` between clamped edges. Its span ends beyond the farther sensor, and where the second even width
/// mode does not yet run to the nearer one.
pub const CLAMPED: &str = "al-bending-clamped";

/// The plate that the user believes in: a preset, or [`CLAMPED`].
///
/// # Panics
/// If there is no such plate.
#[must_use]
pub fn nominal(name: &str) -> Plate {
    if name != CLAMPED {
        return preset(name).expect("a preset");
    }
    let spec = preset("al-bending").expect("a preset").spec().clone();
    let model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    let (span_start_m, span_end_m) = (0.1, 0.175);
    Plate::new(PlateSpec { name: name.to_owned(), model, span_start_m, span_end_m, ..spec }).expect("a plate")
}

/// Where the noise is 40 dB below the signal, by root mean squares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// At the input: the lock-ins take 15 to 40 dB of it away.
    Input,
    /// In the responses, behind the lock-ins.
    Responses,
}

/// What a calibration did for one true plate.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The seed of the plate.
    pub seed: u64,
    /// By the nominal plate's table.
    pub before: Departure,
    /// By the calibrated plate's.
    pub after: Departure,
    /// The calibration.
    pub found: Calibrated,
    /// Signal over noise of the responses at both places, dB.
    pub snr_db: [f64; 2],
    /// Samples that the device ran.
    pub samples: u64,
}

impl Judged {
    /// One line of a table.
    #[must_use]
    pub fn line(&self) -> String {
        let Self { seed, before, after, found, snr_db, samples } = self;
        format!(
            "{seed:4}  {:5.2} -> {:6.3} mm (stated {:5.3})  {:5.2} -> {:5.3} dB (stated {:5.3})  chi2/n {:4.2}  SNR {:.0}, {:.0} dB  {:4.1} s",
            1e3 * before.boundary_m,
            1e3 * after.boundary_m,
            1e3 * found.boundary_tolerance_m,
            before.level_db,
            after.level_db,
            found.level_tolerance_db,
            found.chi2_per_n,
            snr_db[0],
            snr_db[1],
            *samples as f64 / RATE_HZ,
        )
    }
}

/// The true plate of a seed under a device whose sensor has a gain and a delay of its own.
struct Drawn {
    nominal: Plate,
    truth: Plate,
    options: RigOptions,
    wanted: Wanted,
    noise: Noise,
}

impl Drawn {
    fn new(name: &str, seed: u64, noise: Noise) -> Self {
        let nominal = nominal(name);
        let mut random = Random::new(seed);
        let truth = near(&nominal, &mut random).expect("a plate");
        Self::on(nominal, truth, random, noise)
    }

    fn on(nominal: Plate, truth: Plate, mut random: Random, noise: Noise) -> Self {
        let (_, table) = table_for(&truth, RATE_HZ as u32).expect("a table");
        let options = RigOptions {
            full_scale: Some(ROOM * table.peak_at_full_scale_m() * random.factor(1.0, 4.0)),
            sensor_delay_s: (random.within(0.0, 3.0) / nominal.band_hz().1).min(limits::SENSOR_DELAY.high),
            seed: random.bits(),
            ..RigOptions::default()
        };
        let wanted = Wanted::of(&nominal);
        Self { nominal, truth, options, wanted, noise }
    }

    /// What the sensor measures at a place, and how many samples that took.
    fn measured(&self, place_m: f64) -> (Measurement, u64) {
        let options = RigOptions { noise_lsb: self.noise_lsb(place_m), ..self.options.clone() };
        let mut bench = MeasuringBench::new(&self.nominal, &self.truth, &options, self.wanted.points);
        bench.hand.put_sensor(place_m).expect("on the plate");
        let begin = bench.loopback.samples();
        let measured = bench.measure(place_m, |_, _, _, _| ()).expect("measured");
        (measured.measurement, bench.loopback.samples() - begin)
    }

    /// The noise at the input for a place, codes.
    fn noise_lsb(&self, place_m: f64) -> f64 {
        let plan = Plan::new(&self.nominal, &self.wanted, RATE_HZ, MAX_TONES).expect("a plan");
        let mut frequencies_hz: Vec<f64> =
            plan.combs.iter().flat_map(|comb| comb.frequencies_hz(RATE_HZ)).collect();
        frequencies_hz.sort_by(f64::total_cmp);
        let combs = plan.combs.len() as f64;
        let amplitude = plan.level * combs / frequencies_hz.len() as f64;
        let window = plan.combs.iter().map(|comb| comb.window_samples() as f64).sum::<f64>() / combs;
        let point = |frequency_hz: &f64| MeasuredPoint {
            frequency_hz: *frequency_hz,
            response: Complex64::ONE,
            noise: 1.0,
            headroom_db: None,
        };
        let points = frequencies_hz.iter().map(point).collect();
        let sensor = Measurement::at(place_m, SensorKind::Displacement, points);
        let there = predicted(&self.truth, &sensor).expect("on the plate").into_iter().flatten();
        let square = there.map(|it| it.norm_sqr()).sum::<f64>() / frequencies_hz.len() as f64;
        let full_scale = self.options.full_scale.expect("given in the options");
        let codes = CODES * amplitude * square.sqrt() / full_scale;
        let noise = match self.noise {
            Noise::Input => codes * (0.5 * frequencies_hz.len() as f64 / combs).sqrt(),
            // A window of N samples leaves sqrt(2/N) of an input's noise in an amplitude.
            Noise::Responses => codes * (0.5 * window).sqrt(),
        };
        (noise / SNR).clamp(DITHER_LSB, limits::NOISE.high)
    }
}

/// Measures the true plate of a seed at two places and calibrates the preset by it.
///
/// # Errors
/// Why the calibration was refused.
///
/// # Panics
/// If there is no such preset, or something goes wrong in the measurement.
pub fn calibrate(name: &str, seed: u64, noise: Noise) -> Result<Judged, CalibrateError> {
    judge(&Drawn::new(name, seed, noise), seed)
}

/// As [`calibrate`], where the true plate is the one that the user believes in.
///
/// # Errors
/// Why the calibration was refused.
///
/// # Panics
/// As [`calibrate`].
pub fn calibrate_itself(name: &str, noise: Noise) -> Result<Judged, CalibrateError> {
    judge(&Drawn::on(nominal(name), nominal(name), Random::new(0), noise), 0)
}

fn judge(drawn: &Drawn, seed: u64) -> Result<Judged, CalibrateError> {
    let [(near, first), (far, second)] = PLACES.map(|share| drawn.measured(share * drawn.nominal.length_m()));
    let found = from_ratio(&drawn.nominal, [&near, &far], &Priors::default())?;
    let judged = |plate: &Plate| departure(plate, &drawn.truth, RATE_HZ).expect("a table");
    let (before, after) = (judged(&drawn.nominal), judged(&found.plate));
    let snr_db = [&near, &far].map(snr_db);
    Ok(Judged { seed, before, after, snr_db, samples: first + second, found })
}

/// Root of the mean square of the responses over that of their noise, dB.
fn snr_db(sensor: &Measurement) -> f64 {
    let square = |of: fn(&MeasuredPoint) -> f64| sensor.points.iter().map(|it| of(it).powi(2)).sum::<f64>();
    10.0 * (square(|it| it.response.norm()) / square(|it| it.noise)).log10()
}

/// The middle of a list, and its largest.
///
/// # Panics
/// If it is empty.
#[must_use]
pub fn middle_and_worst(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    (values[values.len() / 2], values[values.len() - 1])
}
