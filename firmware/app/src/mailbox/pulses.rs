//! Counters by which the supervisor sees that the tasks run.

/// Runs of each of the three tasks that the supervisor watches; each count wraps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pulses {
    /// The renderer: blocks.
    pub renderer: u32,
    /// The link: rounds of its loop.
    pub link: u32,
    /// Safety: ticks.
    pub safety: u32,
}
