//! The time of this worker, since it was started.

use std::time::Duration;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn milliseconds() -> f64;
}

/// The time since this worker, or the page, was started.
pub(crate) fn now() -> Duration {
    Duration::from_secs_f64(milliseconds().max(0.0) / 1e3)
}
