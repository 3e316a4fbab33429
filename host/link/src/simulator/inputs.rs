//! The inputs of the simulated device: the signals at its ADC, and the stream of sampled blocks.

use std::collections::VecDeque;

use slipline_app::BLOCK;
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
///     fn inputs(&self) -> usize {
///         1
///     }
///
///     fn delay_ns(&self) -> i32 {
///         0
///     }
///
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
    /// order.
    fn inputs(&self) -> usize;

    /// Time from DAC code `n` at its pin to the sampling of ADC code `n`, in nanoseconds, constant, as
    /// [`SenseStream::delay_ns`](slipline_app::ports::SenseStream::delay_ns) states it.
    /// [`sample`](Self::sample) must include this delay; filters outside the chip add theirs.
    fn delay_ns(&self) -> i32;

    /// Samples one block. `codes` are those at the DAC's pin, which a late block turns into a ramp to
    /// mid-scale; `muted` is the state of the amplifier. Each row of `sensed` must be filled with 12-bit
    /// codes, mid-scale 2048; rows of missing inputs are ignored. Called for every block that the DAC plays,
    /// in order.
    fn sample(&mut self, codes: &[u16; BLOCK], muted: bool, sensed: &mut [[u16; BLOCK]; INPUTS]);
}

/// The inputs, and their sampled blocks.
pub(super) struct Inputs {
    source: Box<dyn SimulatedInputs>,
    sampled: VecDeque<Result<[[u16; BLOCK]; INPUTS], Overrun>>,
    /// Number of the following blocks to be lost.
    to_lose: u32,
}

impl Inputs {
    pub(super) fn new(source: Box<dyn SimulatedInputs>) -> Self {
        Self { source, sampled: VecDeque::new(), to_lose: 0 }
    }

    pub(super) fn inputs(&self) -> usize {
        self.source.inputs().min(INPUTS)
    }

    pub(super) fn delay_ns(&self) -> i32 {
        self.source.delay_ns()
    }

    /// Takes the oldest waiting block.
    pub(super) fn take(&mut self) -> Option<Result<[[u16; BLOCK]; INPUTS], Overrun>> {
        self.sampled.pop_front()
    }

    /// Returns the source; waiting blocks are dropped.
    pub(super) fn into_source(self) -> Box<dyn SimulatedInputs> {
        self.source
    }

    /// Drops the next `blocks` blocks that are sampled.
    pub(super) fn lose(&mut self, blocks: u32) {
        self.to_lose = self.to_lose.saturating_add(blocks);
    }

    /// Samples one block while these codes are played.
    pub(super) fn sample(&mut self, codes: &[u16; BLOCK], muted: bool) {
        let mut block = [[0; BLOCK]; INPUTS];
        self.source.sample(codes, muted, &mut block);
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
