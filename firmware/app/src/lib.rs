//! The Slipline device application: bytes in, DAC codes out, no hardware.
//!
//! ```text
//! thread side                                                         interrupt side
//! bytes -> inbox -> session -> controller -> planning/ -> [ mailbox ] -> motion -> bank -> codes -> DacStream
//!   ^                  |        |  upload -> slots -----^    |    ^      renderer
//!   +----- replies ----+        |  store -> FlashPages       |    |        +-> Mute
//!                               +- safety/ <-----------------+    +-- listening/ <- ADC blocks
//! ```
//! Rooms: `controller` one file per kind of command; `planning` from a command to a motion; `safety` limits, faults and
//! records; `listening` lock-ins, capture and level hold; `bank` and `renderer` everything at the sample rate; `ports` the
//! traits of a board.
//!
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
pub mod bootloader;
pub mod controller;
pub mod digest;
pub mod inbox;
pub mod link;
pub mod listening;
pub mod mailbox;
pub mod motion;
pub mod planning;
pub mod ports;
mod range;
pub mod release;
pub mod renderer;
pub mod safety;
pub mod session;
pub mod slots;
pub mod store;
pub mod timing;
pub mod upload;

pub use bank::{BLOCK, TONES};
pub use controller::Device;
pub use link::Link;
pub use mailbox::Mailbox;
pub use mailbox::Stop;
pub use renderer::Renderer;
pub use safety::boot::Boot;
pub use safety::crash::CrashRecord;
pub use safety::supervisor::Supervisor;
/// The protocol's word for why a device was reset; a shell reads it from the hardware.
pub use slipline_protocol::event::ResetCause;
/// The protocol's times in samples; a shell makes them for its rate.
pub use slipline_protocol::timing::Timing;
