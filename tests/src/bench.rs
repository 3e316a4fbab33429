//! A secret plate under a simulated device with a sensor, measured through the protocol and the device application.

use slipline_instrument::measure::{
    MeasureError, Measured, Measuring, NextStep, Plan, Procedure, Run, Sensor, Wanted,
};
use slipline_instrument::rig::{PreparedRig, RigHand, RigOptions, secret};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_link::{DeviceTable, Request, Snapshot};
use slipline_model::field::simulation::table_for;
use slipline_plate::calibrate::{Measurement, SensorKind};
use slipline_plate::{Complex64, Equation, Plate, preset, respond_batch};
use std::f64::consts::PI;
use std::sync::Arc;

/// The sample rate of the device, Hz.
pub const RATE_HZ: f64 = 400e3;
/// Shares of the length at which the sensor stands.
pub const PLACES: [f64; 2] = [0.1, 0.55];
/// Positions of a field.
const POSITIONS: usize = 1601;
/// Steps after which a measurement never ends.
const STEPS: usize = 1_000_000;

/// An armed device whose inputs sense the true plate, with the table of the nominal plate.
pub struct MeasuringBench {
    /// The nominal plate, which the user assumes.
    pub nominal: Plate,
    /// The plate under the device.
    pub truth: Plate,
    /// The rig.
    pub rig: PreparedRig,
    /// The person at the rig.
    pub hand: RigHand,
    /// The link and the device, in virtual time.
    pub loopback: Loopback,
    /// The order of the measurement.
    pub wanted: Wanted,
    /// The table of the nominal plate.
    pub table: Arc<DeviceTable>,
}

impl MeasuringBench {
    /// A healthy rig under a secret plate near the preset of this name; `points` frequencies are measured.
    ///
    /// # Panics
    /// If the preset does not exist, and where [`MeasuringBench::new`] panics.
    #[must_use]
    pub fn near(name: &str, seed: u64, points: usize) -> Self {
        let nominal = preset(name).expect("a preset");
        let truth = secret(&nominal, seed).expect("a plate near it");
        Self::new(&nominal, &truth, &RigOptions::default(), points)
    }

    /// A rig with these options under `truth`, its sensor at the nearer place; `points` frequencies are measured.
    ///
    /// # Panics
    /// If the plate cannot be simulated, or the device refuses the table.
    #[must_use]
    pub fn new(nominal: &Plate, truth: &Plate, options: &RigOptions, points: usize) -> Self {
        Self::tapped(nominal, truth, options, points, |inputs| inputs)
    }

    /// The same with something between the rig and the device's inputs.
    ///
    /// # Panics
    /// If the plate cannot be simulated, or the device refuses the table.
    #[must_use]
    pub fn tapped(
        nominal: &Plate,
        truth: &Plate,
        options: &RigOptions,
        points: usize,
        tap: impl FnOnce(Box<dyn SimulatedInputs>) -> Box<dyn SimulatedInputs>,
    ) -> Self {
        let options = RigOptions { place_m: PLACES[0] * nominal.length_m(), ..options.clone() };
        let rig = PreparedRig::new(truth, &options, RATE_HZ).expect("a rig");
        let device = SimulatedDevice::with_inputs(Options::default(), tap(rig.inputs()));
        let mut loopback = Loopback::connect_to(device).expect("a device");
        let (_, table) = table_for(nominal, RATE_HZ as u32).expect("a table");
        loopback.perform(Request::Upload(table.clone()), |_| ()).expect("takes the table");
        let wanted = Wanted { points, ..Wanted::of(nominal) };
        Self {
            nominal: nominal.clone(),
            truth: truth.clone(),
            hand: rig.hand(),
            rig,
            loopback,
            wanted,
            table,
        }
    }

    /// The two places of the sensor, metres.
    #[must_use]
    pub fn places_m(&self) -> [f64; 2] {
        PLACES.map(|share| share * self.nominal.length_m())
    }

    /// The device's report of its inputs.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn inputs(&self) -> InputsReport {
        self.loopback.view().device.inputs.expect("a device with inputs")
    }

    /// Measures with the sensor, whose stated place is `place_m`; `change` may do something at each step.
    ///
    /// # Errors
    /// Why there is no measurement.
    ///
    /// # Panics
    /// If it never ends.
    pub fn measure(
        &mut self,
        place_m: f64,
        change: impl FnMut(&mut Loopback, &mut Run<Measuring>, usize, Option<&Request>),
    ) -> Result<Measured, MeasureError> {
        let measuring = self.measuring(place_m)?;
        self.run(measuring, change)
    }

    /// The measurement of [`Self::measure`].
    ///
    /// # Errors
    /// Why there is none.
    ///
    /// # Panics
    /// If the device has no inputs.
    pub fn measuring(&self, place_m: f64) -> Result<Measuring, MeasureError> {
        let inputs = self.inputs();
        let plan = Plan::new(&self.nominal, &self.wanted, RATE_HZ, inputs.lock_ins.into())?;
        let sensor = Sensor { place_m, kind: SensorKind::Displacement, input: 0, body: None };
        Measuring::new(plan, self.table.clone(), sensor, &inputs)
    }

    /// Runs a procedure to its end; `change` may do something at each step.
    ///
    /// # Errors
    /// Why it found nothing.
    ///
    /// # Panics
    /// If it never ends.
    pub fn run<P: Procedure>(
        &mut self,
        procedure: P,
        mut change: impl FnMut(&mut Loopback, &mut Run<P>, usize, Option<&Request>),
    ) -> Result<P::Found, MeasureError> {
        let mut procedure = Run::of(procedure);
        let mut ticket = None;
        for steps in 0.. {
            assert!(steps < STEPS, "it never ends");
            let step = procedure.step();
            let asked = if let NextStep::Ask(request) = &step { Some(request) } else { None };
            change(&mut self.loopback, &mut procedure, steps, asked);
            match step {
                NextStep::Ask(request) => ticket = Some(self.loopback.hand_over(request)),
                NextStep::Wait => {
                    self.loopback.pass(1, |_| ());
                    let view: &Snapshot = self.loopback.view();
                    procedure.watch(view);
                    if let Some(outcome) = ticket.and_then(|ticket| view.outcome(ticket)) {
                        procedure.take(outcome);
                    }
                }
                NextStep::Ended => break,
            }
        }
        procedure.finish()
    }

    /// Runs a procedure twice and ends it where `is_due` says so, by a cancellation and by an emergency stop: each time it says
    /// why, and leaves the plate still and the device with its table.
    ///
    /// # Panics
    /// If something goes wrong.
    pub fn ends_early<P: Procedure>(
        &mut self,
        make: impl Fn(&Self) -> P,
        mut is_due: impl FnMut(usize, Option<&Request>) -> bool,
    ) {
        for is_cancelled in [true, false] {
            let procedure = make(self);
            let found = self.run(procedure, |loopback, run, step, asked| {
                let is_due = is_due(step, asked);
                if is_due && is_cancelled {
                    run.cancel();
                } else if is_due {
                    loopback.hand_over(Request::EmergencyStop);
                }
            });
            let error = found.err().expect("it was ended");
            let is_stop = matches!(error, MeasureError::Fault(_) | MeasureError::Stopped);
            assert!(if is_cancelled { error == MeasureError::Cancelled } else { is_stop }, "{error:?}");
            let mut codes = Vec::new();
            self.loopback.pass(20_000, |block| codes = block.to_vec());
            assert!(codes.iter().all(|code| *code == codes[0]), "something sounds");
            assert_eq!(self.loopback.view().table.confirmed.as_deref(), Some(&*self.table));
        }
    }

    /// The same sensor at both places, one after the other.
    ///
    /// # Panics
    /// If something goes wrong.
    pub fn at_both(&mut self) -> [Measurement; 2] {
        self.places_m().map(|place_m| {
            self.hand.put_sensor(place_m).expect("on the plate");
            self.measure(place_m, |_, _, _, _| ()).expect("measured").measurement
        })
    }
}

/// Response of a displacement sensor on a plate by the frequency domain, in metres per DAC amplitude of 1, with the codes' hold.
///
/// # Panics
/// If the plate has no answer at a frequency.
#[must_use]
pub fn predicted(truth: &Plate, place_m: f64, frequencies_hz: &[f64]) -> Vec<Complex64> {
    let fields = respond_batch(truth, frequencies_hz, POSITIONS, Equation::Corrected).expect("fields");
    let at = place_m / truth.length_m() * (POSITIONS - 1) as f64;
    let (left, t) = (at as usize, at.fract());
    let seen = |(field, &hz): (&Vec<Complex64>, &f64)| {
        let turn = PI * hz / RATE_HZ;
        let here = field[left] * (1.0 - t) + field[left + 1] * t;
        here * truth.drive_response(hz) * truth.spec().full_scale_m * (turn.sin() / turn)
    };
    fields.iter().zip(frequencies_hz).map(seen).collect()
}
