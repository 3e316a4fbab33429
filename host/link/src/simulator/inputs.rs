//! The inputs of the simulated device: the signals at its ADC, and the stream of sampled blocks.

use std::collections::VecDeque;

use slipline_app::BLOCK;
use slipline_app::dds::bank::code::MID_SCALE;
use slipline_app::ports::{INPUTS, Overrun};

/// Blocks that can wait for the device application; if one more is sampled, the oldest is lost.
const RING_BLOCKS: usize = 4;

/// Signals at the inputs of a simulated device.
///
/// ```
/// use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
///
/// /// A wire from the DAC's pin to the sensor's.
/// struct Wire;
///
/// impl SimulatedInputs for Wire {
///     fn sample(&mut self, codes: &[u16; 128], _muted: bool, sensed: &mut [[u16; 128]; 2]) {
///         sensed[0] = *codes;
///     }
/// }
///
/// let mut device = SimulatedDevice::with_inputs(Options::default(), Box::new(Wire));
/// device.advance(10, |_| ());
/// ```
pub trait SimulatedInputs: Send {
    /// Number of inputs, constant: 0 none, 1 the sensor, 2 the sensor and the drive current's shunt, in this
    /// order. 1 where it is not stated.
    fn inputs(&self) -> usize {
        1
    }

    /// Time from DAC code `n` at its pin to the sampling of ADC code `n`, in nanoseconds, constant, as
    /// [`SenseStream::delay_ns`](slipline_app::ports::SenseStream::delay_ns) states it.
    /// [`sample`](Self::sample) must include this delay; filters outside the chip add theirs. 0 where it is not stated.
    fn delay_ns(&self) -> i32 {
        0
    }

    /// Samples one block. `codes` are those at the DAC's pin, which a late block turns into a ramp to
    /// mid-scale; `muted` is the state of the amplifier. Each row of `sensed` must be filled with 12-bit
    /// codes, mid-scale 2048; rows of missing inputs are ignored. Called for every block that the DAC plays,
    /// in order.
    fn sample(&mut self, codes: &[u16; BLOCK], muted: bool, sensed: &mut [[u16; BLOCK]; INPUTS]);
}

/// The wires that a self-test uses, between pins of a simulated device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wires {
    /// From the DAC to the sensor's pin, which then reads the DAC's codes instead of its other source.
    pub dac_to_sensor: bool,
    /// From the trigger output to the trigger input.
    pub trigger: bool,
    /// From the DAC through the amplifier to the sensor: the amplifier's output while it is on, mid-scale while it is muted.
    pub amplifier_to_sensor: bool,
}

impl Wires {
    /// Whether one of them ends at the sensor's pin.
    const fn reach_sensor(self) -> bool {
        self.dac_to_sensor || self.amplifier_to_sensor
    }
}

/// The inputs, and their sampled blocks.
pub(super) struct Inputs {
    source: Option<Box<dyn SimulatedInputs>>,
    wires: Wires,
    sampled: VecDeque<Result<[[u16; BLOCK]; INPUTS], Overrun>>,
    /// Number of the following blocks to be lost.
    to_lose: u32,
}

impl Inputs {
    /// The inputs with these signals, and with wires to the sensor's pin; `None` without either.
    pub(super) fn of(source: Option<Box<dyn SimulatedInputs>>, wires: Wires) -> Option<Self> {
        let is_there = wires.reach_sensor() || source.is_some();
        is_there.then(|| Self { source, wires, sampled: VecDeque::new(), to_lose: 0 })
    }

    pub(super) fn inputs(&self) -> usize {
        let inputs = self.source.as_ref().map_or(0, |source| source.inputs().min(INPUTS));
        if self.wires.reach_sensor() { inputs.max(1) } else { inputs }
    }

    pub(super) fn delay_ns(&self) -> i32 {
        self.source.as_ref().map_or(0, |source| source.delay_ns())
    }

    /// Takes the oldest waiting block.
    pub(super) fn take(&mut self) -> Option<Result<[[u16; BLOCK]; INPUTS], Overrun>> {
        self.sampled.pop_front()
    }

    /// Returns the source, if any; waiting blocks are dropped.
    pub(super) fn into_source(self) -> Option<Box<dyn SimulatedInputs>> {
        self.source
    }

    /// Drops the next `blocks` blocks that are sampled.
    pub(super) fn lose(&mut self, blocks: u32) {
        self.to_lose = self.to_lose.saturating_add(blocks);
    }

    /// Samples one block while these codes are played.
    pub(super) fn sample(&mut self, codes: &[u16; BLOCK], muted: bool) {
        let mut block = [[0; BLOCK]; INPUTS];
        if let Some(source) = &mut self.source {
            source.sample(codes, muted, &mut block);
        }
        if self.wires.dac_to_sensor || self.wires.amplifier_to_sensor && !muted {
            block[0] = *codes;
        } else if self.wires.amplifier_to_sensor {
            block[0] = [MID_SCALE; BLOCK];
        }
        for code in block.as_flattened_mut() {
            *code = (*code).min(4095);
        }
        if self.to_lose > 0 {
            self.to_lose -= 1;
            self.note_loss();
            return;
        }
        self.sampled.push_back(Ok(block));
        // Recorded losses occupy no place in the ring.
        if self.sampled.iter().filter(|sampled| sampled.is_ok()).count() > RING_BLOCKS
            && let Some(oldest) = self.sampled.iter_mut().find(|sampled| sampled.is_ok())
        {
            *oldest = Err(Overrun { blocks: 1 });
        }
    }

    fn note_loss(&mut self) {
        match self.sampled.back_mut() {
            Some(Err(overrun)) => overrun.blocks += 1,
            _ => self.sampled.push_back(Err(Overrun { blocks: 1 })),
        }
    }
}
