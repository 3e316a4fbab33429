//! Slipline's end-to-end tests: test rigs, fault injection and measurements.
//!
//! ```text
//! rig::Rig            test client -> [FaultyLink] -> simulated device -> recorded DAC codes -> measurements
//! link_rig::LinkRig   the host's link -> FaultyPorts -> simulated device
//! qemu::Emulator      test client -> serial port -> firmware image in QEMU -> DAC codes on a second serial port
//! bench::Bench        a sensor on a secret plate -> simulated device -> link -> measurement -> calibration
//! recorder::Recorder  the sensor by a clock of its own -> WAV file -> calibration
//! CommandProxy        host program -> Unix socket -> changed commands -> simulated device
//! ```
//! A rig runs the production code; only its inputs and outputs differ. Hardware, time and random numbers are arguments,
//! so a run can be repeated exactly. Each file under `tests/` holds the tests of one subject. A test that covers a row
//! of the reliability table names the row (R-..).
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `rig.rs`, `link_rig.rs`, `bench.rs`, `recorder.rs`, `qemu.rs`: the rigs
//! - `client.rs`, `command_proxy.rs`, `commands.rs`, `programs.rs`: clients and programs at a device
//! - `faulty_link.rs`, `faulty_ports.rs`, `turned_clock.rs`, `wire.rs`, `mass_on_a_spring.rs`, `measure.rs`: faults,
//!   clocks and known inputs, and measurements on codes
//! - `fuzz.rs`: the fuzzer's targets. Tests: `tests/tests/fuzz_corpora.rs`
//! - `bin/`, `soak.rs`, `random_actions.rs`, `transcript.rs`, `truths.rs`: programs of the tests, and what they play
//! - `source_tree.rs`, `named_tests.rs`: the tree's own files, for the tests of its rules
//!
//! `tests/RELIABILITY.md` lists the tests that were weak once, with the mutation by which each was seen red.

#![forbid(unsafe_code)]

pub mod bench;
pub mod client;
#[cfg(unix)]
pub mod command_proxy;
pub mod commands;
pub mod faulty_link;
pub mod faulty_ports;
pub mod fuzz;
pub mod link_rig;
pub mod mass_on_a_spring;
pub mod measure;
pub mod named_tests;
pub mod programs;
pub mod qemu;
pub mod random_actions;
pub mod recorder;
pub mod rig;
pub mod soak;
pub mod source_tree;
pub mod transcript;
pub mod truths;
pub mod turned_clock;
pub mod wire;
