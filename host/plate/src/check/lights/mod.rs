//! The lights, one file per subject.

pub(super) mod actuator;
pub(super) mod air;
pub(super) mod distortion;
pub(super) mod drift;
pub(super) mod drive;
pub(super) mod felt_edge;
pub(super) mod frame;
pub(super) mod linear_output;
pub(super) mod sensitivity;
pub(super) mod shape;
pub(super) mod sound;
pub(super) mod thickness;
pub(super) mod touch;
pub(super) mod wave;
