//! The kernel of the processor that the crate is compiled for.

#[cfg(all(target_arch = "arm", target_os = "none"))]
pub(super) use super::cortex_m4::CortexM4 as Native;
#[cfg(not(all(target_arch = "arm", target_os = "none")))]
pub(super) use super::portable::Portable as Native;
