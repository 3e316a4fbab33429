//! What crosses between the halves: orders one way, reports the other.

use slipline_protocol::units::SampleIndex;

use crate::faults::FaultLatch;
use crate::motion::Motion;
use crate::slots::SlotIndex;

/// How the output is taken to silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// [`STOP_RAMP_MS`](slipline_protocol::limits::STOP_RAMP_MS).
    Normal,
    /// [`DEAD_MAN_RAMP_MS`](slipline_protocol::limits::DEAD_MAN_RAMP_MS).
    HostLost,
    /// [`EMERGENCY_RAMP_MS`](slipline_protocol::limits::EMERGENCY_RAMP_MS).
    Emergency,
}

impl Stop {
    /// The quicker of two.
    #[must_use]
    pub(crate) const fn quicker(self, other: Option<Self>) -> Self {
        match (self, other) {
            (Self::Emergency, _) | (_, Some(Self::Emergency)) => Self::Emergency,
            (Self::Normal, _) | (_, Some(Self::Normal)) => Self::Normal,
            (Self::HostLost, _) => Self::HostLost,
        }
    }
}

/// What is known of a motion that waits for its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending {
    /// Its start.
    pub at: SampleIndex,
    /// The slot of the table it goes by.
    pub slot: SlotIndex,
    /// Whether any tone sounds at its end.
    pub sounds: bool,
}

/// What the renderer is told at the start of a block.
#[derive(Clone, Copy, Debug)]
pub struct Orders {
    /// What is to begin with this block.
    pub due: Option<Pending>,
    /// Whether it does: the motion in force is the new one.
    pub begins: bool,
    /// A ramp to silence that begins with this block.
    pub stop: Option<Stop>,
    /// Whether drives are accepted.
    pub armed: bool,
    /// Silence is guaranteed up to this index after arming.
    pub ready_at: SampleIndex,
    /// When the host last said that it lives.
    pub fed_at: SampleIndex,
    /// What the thermal fold-back leaves of every amplitude, per mille; `None` before the coil is known of.
    pub limit_per_mille: Option<u16>,
}

/// What the renderer says at the end of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// Nothing sounds from the next block on, until a program says so.
    pub silent: bool,
    /// A stop is ramping.
    pub stopping: bool,
    /// The sum of the amplitudes at the block's end, Q1.31.
    pub sum: u64,
    /// The sum of the squares of all codes' distances from mid-scale since reset; wraps.
    pub energy: u64,
    /// Codes clamped since reset.
    pub clips: u32,
    /// Underruns since reset.
    pub underruns: u32,
    /// The most cycles a block took.
    pub max_cycles: u32,
    /// The thermal limit in force since [`limit_since`](crate::Timing::limit_since) this block's end.
    pub limit_per_mille: Option<u16>,
}

impl Report {
    /// Before the first block.
    pub(crate) const SILENT: Self = Self {
        silent: true,
        stopping: false,
        sum: 0,
        energy: 0,
        clips: 0,
        underruns: 0,
        max_cycles: 0,
        limit_per_mille: None,
    };
}

/// The state at one moment, as the link's half sees it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The first index that is not rendered yet.
    pub next: SampleIndex,
    /// How the output moves.
    pub motion: Motion,
    /// How often that has changed; wraps.
    pub changes: u32,
    /// When the pending program begins.
    pub pending: Option<SampleIndex>,
    /// A stop has been ordered or is ramping.
    pub stopping: bool,
    /// Whether drives are accepted.
    pub armed: bool,
    /// No drive begins before this index.
    pub ready_at: SampleIndex,
    /// The renderer's last report.
    pub report: Report,
    /// The latched faults.
    pub faults: FaultLatch,
}

impl View {
    /// Whether nothing sounds and nothing is about to.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.report.silent && self.pending.is_none()
    }
}

/// Signs of life of the three tasks the supervisor watches; each wraps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pulses {
    /// The renderer: blocks.
    pub renderer: u32,
    /// The link: rounds of its loop.
    pub link: u32,
    /// Safety: ticks.
    pub safety: u32,
}
