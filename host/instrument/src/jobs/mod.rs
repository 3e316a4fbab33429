//! Jobs on measurements and devices: fits, rigs, recordings of a sweep. Jobs on plates alone, and the queue, are in
//! [`slipline_model::jobs`].

pub mod calibrate;
pub mod recorded;
pub mod rig;
