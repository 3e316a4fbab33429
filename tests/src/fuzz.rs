//! The fuzz targets and the properties that must hold for every input.
//!
//! Each function is one target: it takes bytes and panics if a property does not hold. The fuzzer's binaries under
//! `fuzz/` call them; a plain `cargo test` replays the inputs under `corpus/` (tests/fuzz_corpora.rs).

mod device;
mod files;
mod host;
mod inputs;

pub use device::{decode, program, rx_bytes, session, stored};
pub use files::{load_measurement, load_plate, load_setup};
pub use host::connection;
pub use inputs::inputs;

/// A target by its name.
pub type Target = (&'static str, fn(&[u8]));

/// Every target, by the name of its binary and of its corpus.
pub const TARGETS: [Target; 10] = [
    ("connection", connection),
    ("decode", decode),
    ("inputs", inputs),
    ("load_measurement", load_measurement),
    ("load_plate", load_plate),
    ("load_setup", load_setup),
    ("program", program),
    ("rx_bytes", rx_bytes),
    ("session", session),
    ("stored", stored),
];
