//! Inputs of a simulated device: what its sensor and the shunt of its drive show.

use slipline_link::simulator::SimulatedInputs;
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};

/// A sensor that shows half of the drive, with noise of about a code.
pub(crate) struct Half(pub(crate) u64);

impl SimulatedInputs for Half {
    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        for (sensed, &code) in sensed[0].iter_mut().zip(codes) {
            // Knuth's MMIX generator.
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = (self.0 >> 62) as u16;
            let moved = if muted { 2048 } else { 1024 + code / 2 };
            *sensed = moved + noise - 1;
        }
    }
}

/// A sensor, and a shunt through which nothing flows.
pub(crate) struct NoCurrent(pub(crate) Half);

impl SimulatedInputs for NoCurrent {
    fn inputs(&self) -> usize {
        2
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        let mut noise = [[0; 128]; 2];
        self.0.sample(&[2048; 128], true, &mut noise);
        self.0.sample(codes, muted, sensed);
        sensed[1] = noise[0];
    }
}

/// A sensor that shows a part of the drive in percent, which a test changes, with a dither of a code.
pub(crate) struct Partial {
    shows: Arc<AtomicU16>,
    samples: u32,
}

impl Partial {
    /// What the sensor shows of the drive on an untouched plate, in percent.
    pub(crate) const FREE: u16 = 50;
    /// The same under a finger.
    pub(crate) const TOUCHED: u16 = 25;
    /// The same of a sensor whose cable is pulled: not even the dither.
    pub(crate) const UNPLUGGED: u16 = 0;

    /// A sensor on an untouched plate, and what it shows of the drive.
    pub(crate) fn free() -> (Self, Arc<AtomicU16>) {
        let shows = Arc::new(AtomicU16::new(Self::FREE));
        (Self { shows: Arc::clone(&shows), samples: 0 }, shows)
    }
}

impl SimulatedInputs for Partial {
    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        let shows = i32::from(self.shows.load(Ordering::Relaxed));
        for (sensed, &code) in sensed[0].iter_mut().zip(codes) {
            self.samples = self.samples.wrapping_add(1);
            let driven = if muted { 0 } else { (i32::from(code) - 2048) * shows / 100 };
            let dither = if shows == 0 { 0 } else { (self.samples % 2) as i32 };
            *sensed = (2048 + driven + dither) as u16;
        }
    }
}
