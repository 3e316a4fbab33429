//! The Slipline device application: bytes in, DAC codes out, no hardware.
//!
//! ```text
//! thread side                                                         interrupt side
//! bytes -> inbox -> session -> controller -> planning/ -> [ mailbox ] -> motion -> dds -> codes -> DacStream
//!   ^                  |        |  upload -> slots -----^    |    ^      renderer
//!   +----- replies ----+        |  store -> FlashPages       |    |        +-> Mute
//!                               +- safety/ <-----------------+    +-- listening/ <- ADC blocks
//! ```
//! Thin shells run it: the boards, an emulated Cortex-M4, and the host's simulated device. The thread side may refuse
//! a command and take its time. The interrupt side may not fail, wait or branch on anything but the program and the
//! sample index. One [`Mailbox`] stands between them. There is no clock: time is the sample index.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `inbox.rs`, `link.rs`, `session.rs`: received bytes, the loop of the thread side, and the sessions that dispatch
//!   commands
//! - `controller.rs`: one file for each kind of command: checks, then refuses or executes it
//! - `planning/`: from a command to a motion: `planning/plan.rs` (tones, levels, glides), `planning/ramp.rs` (begin and
//!   stop), `planning/chord.rs` and the proof of its peak. Tests: `tests/tests/ramps.rs`, `tests/tests/chord.rs`
//! - `motion.rs`: the motion between two programs
//! - `renderer.rs`: from the mailbox to DAC codes; it also raises the trigger output and obeys the stop on the desk.
//!   Tests: `tests/tests/trigger.rs`, `tests/tests/desk_stop.rs`
//! - `mailbox.rs`: all state that both sides use, with the lease of an armed device and the drive that waits for the
//!   trigger input. Tests: `tests/tests/lease.rs`, `tests/tests/trigger_input.rs`
//! - `listening/`: captures and the level hold (its gain: `listening/hold/law.rs`), over the lock-ins of `slipline-dds`.
//!   Tests: `tests/tests/hold.rs`, `tests/board/test_lock_in.py`
//! - `safety/`: faults, heat, travel (`safety/excursion/`), the profile's bounds, the fade of a missing block, the
//!   record of a crash. Tests: `tests/tests/health.rs`, `tests/tests/travel.rs`, `tests/tests/foldback.rs`
//! - `ports.rs`: the traits of a board. A second output channel gets its port here, its bank in `renderer.rs` and its
//!   converter in `firmware/stm32/src/dac.rs`; then follow "Add a message" in `CONTRIBUTING.md`
//! - `slots.rs`, `upload.rs`, `store.rs`: the turning-point tables in memory, their upload, and the records in flash
//!   (table and profile). Tests: `tests/tests/storage.rs`, `tests/tests/profile.rs`
//! - `digest.rs`: the CRC of a window of codes, for `slipline verify`. Tests: `tests/tests/verify.rs`
//! - `timing.rs`, `range.rs`: the protocol's times in samples, and checks of ranges
//! - `two_steps.rs`, `release.rs`: the way into the ROM bootloader or a fault on purpose, and the firmware's release
#![no_std]
#![expect(
    clippy::new_without_default,
    reason = "what is large belongs into a static, which needs a const constructor"
)]
#![expect(
    async_fn_in_trait,
    reason = "only generic code in one task uses the ports, and its executor sees the concrete type"
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
pub mod two_steps;
pub mod upload;

pub use controller::Device;
pub use link::Link;
pub use mailbox::Mailbox;
pub use mailbox::Stop;
pub use renderer::Renderer;
pub use safety::boot::Boot;
pub use safety::crash::CrashRecord;
pub use safety::supervisor::Supervisor;
/// The oscillator bank and the lock-ins, for shells and tests.
pub use slipline_dds as dds;
pub use slipline_dds::bank::{BLOCK, TONES};
/// The protocol's word for why a device was reset; a shell reads it from the hardware.
pub use slipline_protocol::event::ResetCause;
/// The protocol's times in samples; a shell makes them for its rate.
pub use slipline_protocol::timing::Timing;
