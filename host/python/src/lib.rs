//! Slipline in Python: the compiled module `slipline._slipline`, below the thin Python package `slipline`.
//!
//! ```text
//! Python's arguments -> place, options -> model, instrument -> answer (serde) -> result (Python attributes, numpy)
//! errors of Rust -> error -> slipline.Error and what is below it
//! device -> instrument's native client <- sign of life of a Python thread
//! study -> any range of its plates as arrays -> the package's store
//! ```
//! No panic hook and no signal handler of the program's is set here: the interpreter keeps its own.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `plate.rs`, `field.rs`, `calibrate.rs`, `simulate.rs`, `texture.rs`: `slipline.Plate` and its calls (`plate/`).
//!   Tests: `tests/python/test_plates.py`
//! - `device/`: what Python calls on a device. Tests: `tests/python/test_device.py`, of trims, sweeps and profiles
//!   `tests/python/test_device_lab.py`
//! - `design.rs`, `measurement.rs`, `feeling.rs`, `finger.rs`, `actual.rs`, `place.rs`: arguments and other classes
//! - `study.rs`: any range of a study's plates; its store and cluster: `host/python/slipline/study.py`; an objective for
//!   optimisers: `host/python/slipline/_objective.py`. Tests: `tests/python/test_study.py`
//! - `result.rs`, `error.rs`: answers as attributes, errors as exceptions
//! - `options.rs`, `arguments.rs`, `coroutine.rs`: the entries of a dictionary, numbers and series, and objects of
//!   Python's own code
//! - `responders.rs`, `waiting.rs`: what a plate keeps from call to call; Ctrl-C during a computation
//!
//! Also: the thin layer `host/python/slipline/`, examples (`host/python/examples/`) and the `PsychoPy` plug-in
//! (`host/python/psychopy-slipline/`). Tests: `tests/python/test_examples.py`, `tests/python/test_psychopy_plugin.py`.
//! Pages and notebooks: `host/python/docs/`, made into a site by `host/python/mkdocs.yml`. Tests:
//! `tests/python/test_pages.py`, `tests/python/notebooks.py`, `tests/python/docs_site.py`

#![forbid(unsafe_code)]
#![warn(clippy::expect_used, clippy::unwrap_used)]
// A new error, request or outcome must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

mod actual;
mod arguments;
mod calibrate;
mod coroutine;
mod design;
mod device;
mod error;
mod feeling;
mod field;
mod finger;
mod measurement;
mod options;
mod place;
mod plate;
mod responders;
mod result;
mod simulate;
mod study;
mod texture;
mod waiting;

/// The compiled part of the package `slipline`.
#[pyo3::pymodule]
mod _slipline {
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use crate::design::design;
    #[pymodule_export]
    use crate::device::{Device, connect, ports};
    #[pymodule_export]
    use crate::find_numpy;
    #[pymodule_export]
    use crate::measurement::Measurement;
    #[pymodule_export]
    use crate::plate::{Plate, presets};
    #[pymodule_export]
    use crate::study::Study;
}

/// Finds NumPy's functions, as the first array would do: that ends in a panic where Ctrl-C comes just then. The package calls it
/// while it is imported; a module's own initialisation would hide from its stubs what it holds.
#[pyo3::pyfunction]
#[pyo3(name = "_find_numpy")]
fn find_numpy(py: pyo3::Python<'_>) {
    numpy::PyArray1::<f64>::zeros(py, 0, false);
}
