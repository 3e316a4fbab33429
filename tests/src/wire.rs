//! Inputs whose codes are known exactly: a wire from the DAC to the sensor, and a shunt that is stuck.

use std::collections::VecDeque;

use slipline_link::simulator::SimulatedInputs;

use crate::rig::{BLOCK, MID};

/// The sensor sees what is at the pin [`LAG`](Self::LAG) samples later, at half its size and [`OFFSET`](Self::OFFSET) codes
/// above mid-scale. The second input is [`STUCK`](Self::STUCK).
#[derive(Clone, Debug)]
pub struct Wire(VecDeque<u16>);

impl Wire {
    /// How many samples later the sensor sees a code.
    pub const LAG: usize = 5;
    /// The sensor's code where the pin is at mid-scale, less mid-scale.
    pub const OFFSET: u16 = 100;
    /// The only code of the second input.
    pub const STUCK: u16 = 1234;

    /// A wire that has carried mid-scale.
    #[must_use]
    pub fn new() -> Self {
        Self(VecDeque::from([MID; Self::LAG]))
    }

    /// The sensor's code for a code at the pin.
    #[must_use]
    pub const fn heard(code: u16) -> u16 {
        (code + MID) / 2 + Self::OFFSET
    }

    /// The sensor's next code, while this one is at the pin.
    pub fn carry(&mut self, code: u16) -> u16 {
        self.0.push_back(code);
        self.0.pop_front().map_or(MID, Self::heard)
    }
}

impl Default for Wire {
    fn default() -> Self {
        Self::new()
    }
}

impl SimulatedInputs for Wire {
    fn inputs(&self) -> usize {
        2
    }

    fn delay_ns(&self) -> i32 {
        -250
    }

    fn sample(&mut self, codes: &[u16; BLOCK as usize], _: bool, sensed: &mut [[u16; BLOCK as usize]; 2]) {
        for (code, sensor) in codes.iter().zip(&mut sensed[0]) {
            *sensor = self.carry(*code);
        }
        sensed[1] = [Self::STUCK; BLOCK as usize];
    }
}
