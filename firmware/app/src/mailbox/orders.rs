//! Thread side to interrupt side: what the renderer reads at the start of a block.

use slipline_protocol::units::SampleIndex;

use super::pending::Pending;
use super::stop::Stop;
use crate::digest::DigestState;

/// The renderer's orders, read at the start of a block.
#[derive(Clone, Copy, Debug)]
pub struct Orders {
    /// What is to begin with this block.
    pub due: Option<Pending>,
    /// Whether it does: the motion in force is the new one.
    pub begins: bool,
    /// Whether something waits for a rise of the trigger input from this block on.
    pub listens: bool,
    /// A ramp to silence that begins with this block.
    pub stop: Option<Stop>,
    /// Whether drives are accepted.
    pub armed: bool,
    /// Whether they are while the amplifier stays muted.
    pub on_bench: bool,
    /// Silence is guaranteed up to this index after arming.
    pub ready_at: SampleIndex,
    /// The index of the last keep-alive.
    pub fed_at: SampleIndex,
    /// Where the device disarms by its lease.
    pub lease_ends: SampleIndex,
    /// The thermal fold-back factor, per mille; `None` before the coil is known.
    pub limit_per_mille: Option<u16>,
    /// The digest that is asked for.
    pub digest: DigestState,
}
