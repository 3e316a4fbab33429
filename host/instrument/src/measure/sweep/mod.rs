//! An exponential sweep: one tone that glides through the band, and a capture of what the input saw.
//!
//! ```text
//! Plate, table, Wanted --SweepPlan--> how long, how many captures
//!      table of the sweep --> device: a tone glides over all its places, which fades in and out by the table's gains
//!      captures of the input ---------+
//!      codes that the device played --+--deconvolution--> Measured
//! ```
//! The sweep is a table of its own, whose places have exponentially rising frequencies, and whose gains are those of the
//! plate's table but at both ends, where they fade to nothing. So a tone that waits at its first place is not heard, and one
//! glide plays the whole sweep, from rest to rest. At the end the device gets its own table back.
//!
//! For a recorder that is no part of the device the same sweep is played twice, and described:
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
