//! The sound of this system.
//!
//! On Linux it is the protocol of PulseAudio, which PipeWire answers, too: it needs no library of the system, neither to
//! build nor to run. Elsewhere it is the system's own interface.

#[cfg(target_os = "linux")]
mod pulse;
#[cfg(target_os = "linux")]
pub(super) use pulse::run;

#[cfg(not(target_os = "linux"))]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "a thread of its own waits"))]
mod native;
#[cfg(not(target_os = "linux"))]
pub(super) use native::run;
