//! The computations on a plate that a program asks for, and their answers: the fields of the command line's `--json`
//! (`host/JSON.md` has the meaning of each), which are the attributes in Python.
//!
//! ```text
//! what is asked --compute--> result of the plate's library --answer--> fields (serde) --> a line of JSON
//!                                                                                    \--> attributes in Python
//! ```

pub mod calibrate;
pub mod check;
mod complex;
pub mod design;
pub mod feeling;
pub mod merit;
pub mod respond;
pub mod simulate;
pub mod table;
pub mod texture;
mod tone;
mod two_dimensions;

pub use complex::Complex;
pub use tone::ToneAnswer;
pub use two_dimensions::TwoDimensions;
