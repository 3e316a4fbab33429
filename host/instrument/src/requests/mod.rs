//! What a user asks of a plate or a device by words: the requests of the command line and of Python.
//!
//! ```text
//! options of a shell --> request: absent options get their defaults, incomplete ones are refused
//!                          |--measure----> frequencies, method, drive circuit --> native::Measurer
//!                          |--calibrate--> measurements or felt edges ----------> CalibrationReport
//!                          |--tones------> places and levels -------------------> Setup
//!                          \--simulate---> plates, finger, solver --------------> SimulatedDrive
//! ```
//! A shell reads its options and words a refusal with their names. What follows from the options is stated here.

mod brown_out;
mod calibrate;
mod feeling;
mod harmonics;
mod measure;
mod simulate;
mod sweep;
mod tones;

pub use brown_out::BrownOutAnswer;
pub use calibrate::{FeltEdgeError, FeltEdgeRequest, FeltEdgesRequest, measured};
pub use feeling::NamedFeeling;
pub use harmonics::{HarmonicAnswer, HarmonicsAnswer};
pub use measure::{Frequencies, IncompleteCircuit, MeasureRequest, circuit_of};
pub use simulate::{PlannedSimulation, SimulateRequest};
pub use sweep::SweepAnswer;
pub use tones::ToneRequest;
