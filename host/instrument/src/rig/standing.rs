//! The sensor on its mark, and the plate under a sensor that weighs.

use slipline_plate::{Output, Resonators};
use std::sync::Arc;

/// The sensor on its mark.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Standing {
    /// Its signal.
    pub(super) sensor: Arc<Output>,
    /// The plate under a sensor that weighs.
    pub(super) weighed: Option<Arc<Weighed>>,
}

/// The plate while a sensor weighs on it, in place of the bare one.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Weighed {
    pub(super) at_rest: Resonators,
    /// The current through the shunt.
    pub(super) current: Output,
}
