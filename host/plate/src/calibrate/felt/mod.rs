//! The calibration by felt edges, without a sensor: weighted samples of plates and drives, and their mean.
//! Calibrations by sensors are in [`super::fit`].
//!
//! ```text
//! touch -> candidates (edges of a tone on one plate: edge_envelope) -> importance_sampling -> mean_edges -> touches
//! ```

pub(crate) mod candidates;
pub(crate) mod edge_envelope;
pub(crate) mod importance_sampling;
pub(crate) mod mean_edges;
pub(crate) mod touch;
pub(crate) mod touches;
