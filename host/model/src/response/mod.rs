//! Measured responses for display: their list, their curves over the frequency, the headroom of the input,
//! and their agreement with the plate on the screen.
//!
//! ```text
//! file, device --Measurement--> Shelf --> Bode (level, phase, noise) --> plots
//!                                 \----> jobs::compare (plate file) --> Comparison --> sentence, residual
//! ```

mod bode;
mod headroom;
mod shelf;
mod words;

pub use bode::{Bode, levels_db, unwrapped_deg};
pub use headroom::{Headroom, LIGHT_DB, light};
pub use shelf::{Entry, Shelf, ShelfFull};
pub use words::{differs, is_measurement};
