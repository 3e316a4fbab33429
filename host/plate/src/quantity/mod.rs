//! Numbers and names that users type and read: parsing, formatting, ranges and refusals.
//!
//! ```text
//! text "12,5 cm" -> parse, unit -> 0.125 (SI) -> Range::contains -> used
//!                     |                             |
//!                     +-> QuantityError             +-> OutOfRange, or a plate's error: field, value, range
//!                                                         |
//! number -> number_format, display, ticks -> text <- refusal: one wording, in the notation of the caller
//! a mistyped name -> suggestion -> the name that was probably meant
//! ```

mod display;
mod level;
mod notation;
pub mod number_format;
mod parse;
mod range;
pub(crate) mod refusal;
mod suggestion;
pub mod ticks;
mod unit;

pub use display::{
    Measure, TypedRange, show_frequency, show_half_width, show_length, show_place, show_range, show_si,
};
pub use level::{decibels, from_decibels};
pub(crate) use notation::PlateFile;
pub use notation::{Caption, Form, Notation};
pub use parse::{
    PlaceOrFrequency, bare, decibel, frequency_hz, length_m, level, mass_kg, place_or_frequency, plain,
    short_time_s, time_s,
};
pub use range::{Count, Counted, Range};
pub use refusal::{NotAllowed, OutOfRange, QuantityError, WrongCount, must_be, only};
pub(crate) use suggestion::hint;
pub use suggestion::nearest;
pub use unit::{FIELD_DIGITS, Unit};
