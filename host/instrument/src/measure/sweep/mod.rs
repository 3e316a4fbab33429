//! An exponential sweep: one tone that glides through the band, and a capture of the input's samples.
//!
//! ```text
//! Plate, table, Wanted --SweepPlan--> how long, how many captures
//!      table of the sweep --> device: a tone glides over all its places, which fades in and out by the table's gains
//!      captures of the input ---------+
//!      codes that the device played --+--deconvolution--> Measured
//! ```
//! The sweep has a table of its own, whose places have exponentially rising frequencies. Its gains are those
//! of the plate's table except at both ends, where they fade to zero. So a tone that waits at its first place
//! is silent, and one glide plays the whole sweep, from rest to rest. At the end the device's own table is
//! restored.
//!
//! For a separate recorder the same sweep is played twice and described:
//! ```text
//! Plate, table, Wanted --PlayedSweep--Playing--> device ... plate, sensor, phone ... WAV file
//!                           | TOML                                                     |
//!                           +--------------------HeardSweep----------------------------+--> responses
//! ```

mod chirp;
mod deconvolution;
mod heard;
mod plan;
mod played;
mod playing;
mod recording;
mod sweeping;
mod table;

pub use chirp::Chirp;
pub use heard::{HeardError, HeardSweep};
pub use plan::SweepPlan;
pub use played::{PLAYED_BYTES_MAX, PlayedFileError, PlayedSweep, QUIETER, SWEEP_S};
pub use playing::Playing;
pub use sweeping::Sweeping;
