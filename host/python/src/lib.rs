//! Slipline in Python: the compiled module `slipline._slipline`, below the thin Python package `slipline`.
//!
//! ```text
//! Python's arguments -> place, options -> model, instrument -> answer (serde) -> result (Python attributes, numpy)
//! errors of Rust -> error -> slipline.Error and what is below it
//! ```
//! No panic hook and no signal handler of the program's is set here: the interpreter keeps its own.

#![forbid(unsafe_code)]
#![warn(clippy::expect_used, clippy::unwrap_used)]

mod error;

/// The compiled part of the package `slipline`.
#[pyo3::pymodule]
mod _slipline {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
