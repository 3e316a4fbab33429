//! Measurements: the responses that sensors reported, their files, the frequencies to measure, and the refusals of a
//! single measurement. No plate is fitted here.

pub(crate) mod averaging;
pub(crate) mod band;
pub(crate) mod csv;
pub(crate) mod drive_check;
pub(crate) mod foreign;
pub(crate) mod sensor;
pub(crate) mod signal;
