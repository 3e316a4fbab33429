//! A rig whose lengthy computations are done.

use super::amplifier::LowPass;
use super::bench::Bench;
use super::error::RigError;
use super::hand::RigHand;
use super::motor::Motor;
use super::options::RigOptions;
use super::parts::{Parts, current_of};
use super::sampler::{Sampler, Signals};
use crate::measure::{Bandwidths, KnownDrive};
use slipline_link::protocol::board::Analogue;
use slipline_link::simulator::{Options, SimulatedInputs};
use slipline_plate::calibrate::{DriveCircuit, DriveLoad};
use slipline_plate::{Complex64, Plate, SensedPlate};
use std::sync::{Arc, Mutex};

/// Headroom above a tone of the table at level 1: 12 dB, for tables that were made for another plate.
const ROOM: f64 = 4.0;
/// The shunt's range over the largest current of a full-scale tone in the band.
const SHUNT_ROOM: f64 = 1.25;
/// Accepted relative deviation of the current at rest from its data sheet: for a coil by its resistance; for
/// a piezo by the plate's motion, up to a half on plates that are soft below their cut-off, as the simulated
/// ones are.
const TOLERANCES: [f64; 2] = [0.25, 0.6];
/// Number of frequencies at which the largest current is searched.
const CURRENTS: u32 = 64;

/// A rig, ready for devices. Clones, and all devices connected to them, share its bench.
///
/// ```
/// use slipline_link::simulator::{Options, SimulatedDevice};
/// use slipline_instrument::rig::{PreparedRig, RigOptions, secret};
/// use slipline_plate::preset;
///
/// let truth = secret(&preset("membrane").unwrap(), 4).unwrap();
/// let rig = PreparedRig::new(&truth, &RigOptions { place_m: 0.03, ..RigOptions::default() }, 400e3).unwrap();
/// let mut device = SimulatedDevice::with_inputs(Options::default(), rig.inputs());
/// device.advance(10, |_| ());
/// rig.hand().put_sensor(0.16).unwrap();
/// device.advance(10, |_| ());
/// ```
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(into = "SentRig", from = "SentRig")]
pub struct PreparedRig {
    pub(super) parts: Arc<Parts>,
    pub(super) bench: Arc<Mutex<Bench>>,
}

/// A rig on its way from the worker of a browser that has put it together.
#[derive(serde::Serialize, serde::Deserialize)]
struct SentRig(Arc<Parts>, Bench);

impl From<PreparedRig> for SentRig {
    fn from(rig: PreparedRig) -> Self {
        let bench = super::bench::lock(&rig.bench).clone();
        Self(rig.parts, bench)
    }
}

impl From<SentRig> for PreparedRig {
    fn from(SentRig(parts, bench): SentRig) -> Self {
        Self { parts, bench: Arc::new(Mutex::new(bench)) }
    }
}

impl PreparedRig {
    /// Puts a rig together on a true plate, for a device of this sample rate. The computation takes up to a
    /// second.
    ///
    /// # Errors
    /// [`RigError`] names the option that is out of range, or why the plate cannot be simulated in time.
    pub fn new(truth: &Plate, options: &RigOptions, sample_rate_hz: f64) -> Result<Self, RigError> {
        options.check()?;
        let sensed = if options.coil.is_some() { SensedPlate::with_harmonics } else { SensedPlate::new };
        let plate = sensed(truth, options.finger.as_ref(), sample_rate_hz)?;
        let late = options.sensor_delay_s * sample_rate_hz;
        let motor = Motor::of(truth);
        let motor = motor.on_plate_that_yields(plate.held_drive_point_m(motor.held()));
        let current = current_of(&motor, &plate, options.amplifier_hz)?;
        let (low_hz, high_hz) = truth.band_hz();
        let largest_a = (0..=CURRENTS)
            .map(|i| low_hz + (high_hz - low_hz) * f64::from(i) / f64::from(CURRENTS))
            .map(|hz| plate.steady(&current, hz).norm())
            .fold(0.0, f64::max);
        let even = plate.even_amplitude(options.sensor)?;
        let full_scale = [options.full_scale.unwrap_or(ROOM * even), SHUNT_ROOM * largest_a];
        let signals = Signals {
            at_rest: plate.at_rest(),
            current,
            full_scale,
            late: late as usize,
            seed: options.seed,
            noise_lsb: options.noise_lsb,
            coil: options.coil,
            low_pass: options.amplifier_hz.map(|bandwidth_hz| LowPass::new(bandwidth_hz, sample_rate_hz)),
        };
        let late_s = late.fract() / sample_rate_hz;
        let parts = Parts {
            plate,
            motor,
            sensor: options.sensor,
            signals: Arc::new(signals),
            late_s,
            amplifier_hz: options.amplifier_hz,
            linear_share: options.linear_share,
            body: options.body,
        };
        let standing = parts.sensor_at(options.place_m, None)?;
        let bench = Bench { place_m: options.place_m, standing, fault: None };
        Ok(Self { parts: Arc::new(parts), bench: Arc::new(Mutex::new(bench)) })
    }

    /// The inputs of a device that is wired to the rig: its plate is at rest.
    #[must_use]
    pub fn inputs(&self) -> Box<dyn SimulatedInputs> {
        Box::new(Sampler::new(self.parts.signals.clone(), self.bench.clone()))
    }

    /// A person at the rig.
    #[must_use]
    pub fn hand(&self) -> RigHand {
        RigHand::new(self.parts.clone(), self.bench.clone())
    }

    /// The true plate.
    #[must_use]
    pub fn truth(&self) -> &Plate {
        self.parts.plate.plate()
    }

    /// The motor that drives it.
    #[must_use]
    pub fn motor(&self) -> Motor {
        self.parts.motor
    }

    /// Sensor value at the end of the input's range, in metres, m/s, m/s^2 or strain.
    #[must_use]
    pub fn sensor_full_scale(&self) -> f64 {
        self.parts.signals.full_scale[0]
    }

    /// The current through the shunt per code of 1 in the steady state, in ampere, with the hold of the codes.
    #[must_use]
    pub fn current(&self, frequency_hz: f64) -> Complex64 {
        let rate_hz = self.parts.plate.sample_rate_hz();
        let low_pass =
            self.parts.signals.low_pass.map_or(Complex64::ONE, |it| it.response(frequency_hz, rate_hz));
        low_pass * self.parts.plate.steady(&self.parts.signals.current, frequency_hz)
    }

    /// The options of the simulated device that it belongs to.
    #[must_use]
    pub fn device_options(&self) -> Options {
        let usual = Options::default();
        let linear_per_mille = (1e3 * self.parts.linear_share).round() as u16;
        Options { analogue: Analogue { linear_per_mille, ..usual.analogue }, ..usual }
    }

    /// Data-sheet values of the drive, and the shunt's range.
    #[must_use]
    pub fn known_drive(&self) -> KnownDrive {
        let motor = self.motor();
        let [of_coil, of_piezo] = TOLERANCES;
        let load = motor.load();
        let tolerance = if matches!(load, DriveLoad::Coil { .. }) { of_coil } else { of_piezo };
        let circuit = DriveCircuit { full_scale_v: motor.full_scale_v, load, tolerance };
        let bandwidths = Bandwidths { amplifier_hz: self.parts.amplifier_hz, filter_hz: None };
        KnownDrive { circuit, full_scale_a: self.shunt_full_scale_a(), bandwidths }
    }

    /// Current at the end of the shunt's range, in ampere.
    #[must_use]
    pub fn shunt_full_scale_a(&self) -> f64 {
        self.parts.signals.full_scale[1]
    }
}
