//! Models of the chain before the plate, with the coordinates of their fit, and the fitted source in the plate file.
//! The plate itself is in [`super::response`].

pub(crate) mod data;
pub(crate) mod drive_current;
pub(crate) mod sensor_signal;
pub(crate) mod source_file;
pub(crate) mod source_model;
pub(crate) mod third_mode;
