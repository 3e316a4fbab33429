//! The rig in the time domain: samples of its two inputs.

use super::amplifier::LowPass;
use super::bench::{Bench, lock};
use super::coil::Coil;
use super::converter::{HALF, code};
use super::fault::RigFault;
use super::standing::Weighed;
use slipline_link::BLOCK;
use slipline_link::simulator::SimulatedInputs;
use slipline_plate::truth::Random;
use slipline_plate::{Output, Resonators};
use std::fmt;
use std::sync::{Arc, Mutex};

/// What a device samples of a rig, apart from the sensor's place and the fault.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Signals {
    /// The true plate.
    pub(super) at_rest: Resonators,
    /// The current through the shunt.
    pub(super) current: Output,
    /// Values at the ends of both inputs' ranges: in the sensor's unit, and in ampere.
    pub(super) full_scale: [f64; 2],
    /// Whole samples of the sensor's delay.
    pub(super) late: usize,
    /// Seed and standard deviation of the inputs' noise, in steps of the converter.
    pub(super) seed: u64,
    pub(super) noise_lsb: f64,
    /// The coil, unless it is linear.
    pub(super) coil: Option<Coil>,
    /// The amplifier at rest, unless it passes every frequency.
    pub(super) low_pass: Option<LowPass>,
}

impl fmt::Debug for Signals {
    /// Omits some thousand numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Signals").field("full_scale", &self.full_scale).finish_non_exhaustive()
    }
}

/// One device connected to the rig.
pub(super) struct Sampler {
    signals: Arc<Signals>,
    bench: Arc<Mutex<Bench>>,
    resonators: Resonators,
    /// The plate that they are of, where a sensor weighs on it.
    weighed: Option<Arc<Weighed>>,
    /// Ring buffer of the sensor's signals during its delay.
    late: Vec<f64>,
    /// Index of the oldest signal in it.
    oldest: usize,
    random: Random,
    low_pass: Option<LowPass>,
}

impl Sampler {
    pub(super) fn new(signals: Arc<Signals>, bench: Arc<Mutex<Bench>>) -> Self {
        let weighed = lock(&bench).standing.weighed.clone();
        Self {
            resonators: weighed.as_ref().map_or(&signals.at_rest, |it| &it.at_rest).clone(),
            weighed,
            late: vec![0.0; signals.late],
            oldest: 0,
            random: Random::new(signals.seed),
            low_pass: signals.low_pass,
            signals,
            bench,
        }
    }

    /// A sensor that weighs was put elsewhere: the plate under it is another one, and at rest.
    fn stand_under(&mut self, weighed: Option<Arc<Weighed>>) {
        let is_same = match (&self.weighed, &weighed) {
            (Some(before), Some(now)) => Arc::ptr_eq(before, now),
            (before, now) => before.is_none() && now.is_none(),
        };
        if !is_same {
            self.resonators = weighed.as_ref().map_or(&self.signals.at_rest, |it| &it.at_rest).clone();
            self.weighed = weighed;
        }
    }

    /// Delays the sensor's signal by whole samples.
    fn delay(&mut self, signals: &mut [f64]) {
        if self.late.is_empty() {
            return;
        }
        for signal in signals {
            std::mem::swap(signal, &mut self.late[self.oldest]);
            self.oldest = (self.oldest + 1) % self.late.len();
        }
    }
}

impl SimulatedInputs for Sampler {
    fn inputs(&self) -> usize {
        2
    }

    fn delay_ns(&self) -> i32 {
        // Inputs are sampled when each code leaves the DAC.
        0
    }

    fn sample(&mut self, codes: &[u16; BLOCK], muted: bool, sensed: &mut [[u16; BLOCK]; 2]) {
        let Bench { standing, fault, .. } = lock(&self.bench).clone();
        self.stand_under(standing.weighed);
        let volts = if muted { 0.0 } else { fault.map_or(1.0, RigFault::drive) };
        let drive = |volts: f64| codes.map(|code| volts * (f64::from(code) - HALF) / HALF);
        let mut signals = [[0.0; BLOCK]; 2];
        let [of_sensor, of_shunt] = &mut signals;
        let current = self.weighed.as_ref().map_or(&self.signals.current, |it| &it.current);
        let mut linear = drive(volts);
        if let Some(low_pass) = &mut self.low_pass {
            linear.iter_mut().for_each(|volts| *volts = low_pass.next(*volts));
        }
        let moved = self.signals.coil.map_or(linear, |coil| linear.map(|linear| coil.displacement(linear)));
        self.resonators.run(&moved, [&*standing.sensor, current], [of_sensor, of_shunt]);
        self.delay(&mut signals[0]);
        let [full_scale, full_scale_a] = self.signals.full_scale;
        let gain = match fault {
            Some(RigFault::Unplugged) => 0.0,
            Some(RigFault::Clipped) => RigFault::TOO_MUCH,
            _ => 1.0,
        };
        signals[0].iter_mut().for_each(|signal| *signal *= gain / full_scale);
        signals[1].iter_mut().for_each(|signal| *signal /= full_scale_a);
        match fault {
            // The ringing plate moves the motor, but the circuit is open.
            Some(RigFault::OpenMotor) => signals[1] = [0.0; BLOCK],
            Some(RigFault::ShortedMotor) => signals[1] = drive(if muted { 0.0 } else { RigFault::TOO_MUCH }),
            _ => {}
        }
        let noise_lsb = self.signals.noise_lsb;
        for n in 0..BLOCK {
            let noise = self.random.normals();
            for input in 0..2 {
                sensed[input][n] = code(signals[input][n], noise_lsb * noise[input]);
            }
        }
        if let Some(RigFault::Stuck(stuck)) = fault {
            sensed[0] = [stuck; BLOCK];
        }
    }
}
