//! The Slipline device application: bytes in, DAC codes out, no hardware.
//!
//! ```text
//! thread side                                                    interrupt side
//! bytes -> inbox -> session -> controller -> plan -> [ mailbox ] -> motion -> bank -> codes -> DacStream
//!   ^                  |           |  upload -> slots ----^            |
//!   +----- replies ----+           |  store -> FlashPages              +-> Mute
//!                                  +- thermal, faults, supervisor
//! ```
//! Thin shells run it: the boards, an emulated Cortex-M4, and the host's simulated device. The thread side may refuse
//! a command and take its time. The interrupt side may not fail, wait or branch on anything but the program and the
//! sample index. One [`Mailbox`] stands between them. There is no clock: time is the sample index.
#![no_std]
#![expect(
    async_fn_in_trait,
    reason = "the ports are used by generics in one task, whose executor sees the type"
)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::cast_possible_truncation
    )
)]

#[cfg(test)]
extern crate std;

pub mod bank;
pub mod boot;
pub mod bootloader;
pub mod capture;
pub mod chord;
pub mod controller;
pub mod crash;
pub mod digest;
pub mod excursion;
pub mod fade;
pub mod faults;
pub mod foldback;
pub mod headroom;
pub mod hold;
pub mod inbox;
pub mod level;
pub mod link;
pub mod listener;
pub mod lock_in;
pub mod mailbox;
pub mod motion;
pub mod plan;
pub mod ports;
pub mod program;
pub mod ramp;
mod range;
pub mod release;
pub mod renderer;
pub mod session;
pub mod slots;
pub mod store;
pub mod supervisor;
pub mod thermal;
pub mod timing;
pub mod upload;

pub use bank::{BLOCK, TONES};
pub use boot::Boot;
pub use controller::Device;
pub use crash::CrashRecord;
pub use link::Link;
pub use mailbox::Mailbox;
pub use mailbox::Stop;
pub use renderer::Renderer;
/// The protocol's word for why a device was reset; a shell reads it from the hardware.
pub use slipline_protocol::event::ResetCause;
pub use supervisor::Supervisor;
pub use timing::Timing;
