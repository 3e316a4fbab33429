//! A recorder apart from the device: it samples the rig's sensor by a clock of its own and writes a WAV file.

use slipline_link::BLOCK;
use slipline_link::simulator::SimulatedInputs;
use slipline_plate::truth::Random;
use std::f64::consts::TAU;
use std::io::Cursor;
use std::sync::{Arc, Mutex, PoisonError};

/// Samples of the device that make one of the recorder's filter: far above what a plate with low frequencies does.
const MEAN: usize = 8;

/// The signal of the rig's sensor, as the device's codes.
#[derive(Clone, Default)]
pub struct Tape(Arc<Mutex<Vec<u16>>>);

/// Inputs whose first one is also taped.
struct Tapped {
    inputs: Box<dyn SimulatedInputs>,
    tape: Tape,
}

impl SimulatedInputs for Tapped {
    fn inputs(&self) -> usize {
        self.inputs.inputs()
    }

    fn delay_ns(&self) -> i32 {
        self.inputs.delay_ns()
    }

    fn sample(&mut self, codes: &[u16; BLOCK], muted: bool, sensed: &mut [[u16; BLOCK]; 2]) {
        self.inputs.sample(codes, muted, sensed);
        self.tape.0.lock().unwrap_or_else(PoisonError::into_inner).extend(&sensed[0]);
    }
}

/// Properties of a recorder.
#[derive(Debug, Clone, Copy)]
pub struct SoundRecorder {
    /// Values a second, as it names it.
    pub rate_hz: u32,
    /// How much faster its clock is, as a share.
    pub clock: f64,
    /// Its full scale over the sensor's.
    pub gain: f64,
    /// Noise, RMS, over full scale.
    pub noise: f64,
    /// A hum of 50 Hz, over full scale.
    pub hum: f64,
}

impl Tape {
    /// Inputs that are taped.
    #[must_use]
    pub fn on(&self, inputs: Box<dyn SimulatedInputs>) -> Box<dyn SimulatedInputs> {
        Box::new(Tapped { inputs, tape: self.clone() })
    }

    /// Starts a new recording.
    pub fn rewind(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// What a recorder makes of the tape: a WAV file of two channels in 16 bits, the second one with the sensor. A mean of eight
    /// samples, and a cubic through four of these at each time of the recorder's clock.
    ///
    /// # Panics
    /// If the tape is empty.
    #[must_use]
    pub fn recorded(&self, device_hz: f64, by: &SoundRecorder) -> Vec<u8> {
        let codes = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mean = |codes: &[u16]| {
            let sum: f64 = codes.iter().map(|&code| f64::from(code) - 2048.0).sum();
            sum / (2048.0 * MEAN as f64)
        };
        let means: Vec<f64> = codes.chunks_exact(MEAN).map(mean).collect();
        let step = device_hz / MEAN as f64 / (f64::from(by.rate_hz) * (1.0 + by.clock));
        let spec = hound::WavSpec {
            channels: 2,
            sample_rate: by.rate_hz,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let mut random = Random::new(5);
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = hound::WavWriter::new(&mut bytes, spec).expect("a writer");
        for n in 0.. {
            let time = 1.0 + n as f64 * step;
            let (place, t) = (time as usize, time.fract());
            let Some(four) = means.get(place - 1..place + 3) else { break };
            // Lagrange's cubic through the times -1, 0, 1 and 2.
            let weights = [
                -t * (t - 1.0) * (t - 2.0) / 6.0,
                (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
                -(t + 1.0) * t * (t - 2.0) / 2.0,
                (t + 1.0) * t * (t - 1.0) / 6.0,
            ];
            let heard: f64 = four.iter().zip(weights).map(|(value, weight)| value * weight).sum();
            let hum = by.hum * (TAU * 50.0 * n as f64 / f64::from(by.rate_hz)).sin();
            let value = by.gain * heard + hum + by.noise * random.normal();
            for value in [by.noise * random.normal(), value] {
                let code = (value * 32_768.0).round().clamp(-32_768.0, 32_767.0);
                writer.write_sample(code as i16).expect("written");
            }
        }
        writer.finalize().expect("written");
        bytes.into_inner()
    }
}
