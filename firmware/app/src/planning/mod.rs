//! From a checked command to a motion that the renderer can play: everything that may take time or refuse.
//!
//! `program` is the change that is asked for, `plan` makes its motion, `headroom` bounds its sum in integers, `chord` proves
//! the peak of multiples of one base, `level` and `ramp` are the laws of amplitude. Nothing here runs in an interrupt but
//! the ramp's table.

pub mod chord;
pub mod headroom;
pub mod level;
pub mod plan;
pub mod program;
pub mod ramp;
