//! Waiting for a computation without holding the interpreter, and for Ctrl-C meanwhile.
//!
//! ```text
//! call -> thread that computes, detached from the interpreter -> result
//!         every 50 ms: does Python have a signal? -> the computation is cancelled, the exception raised at once
//! ```

use crate::error::Failure;
use pyo3::prelude::*;
use slipline_plate::Progress;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Longest time between two looks at Python's signals.
const LOOK: Duration = Duration::from_millis(50);

/// Computes on a thread of its own while other Python threads run. After Ctrl-C it raises at once; a computation that
/// reports no progress then runs to its end, and its result is dropped.
pub(crate) fn compute<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&mut Progress<'_>) -> Result<R, Failure> + Send + 'static,
) -> PyResult<R> {
    let is_wanted = Arc::new(AtomicBool::new(true));
    let (send, mut done) = channel();
    let worker = {
        let is_wanted = Arc::clone(&is_wanted);
        thread::Builder::new().name("slipline".to_owned()).spawn(move || {
            let result = work(&mut Progress::new(&mut |_| is_wanted.load(Ordering::Relaxed)));
            // Nobody waits for it any more after a signal.
            drop(send.send(result));
        })?
    };
    loop {
        let results = &mut done;
        match py.detach(move || results.recv_timeout(LOOK)) {
            Ok(result) => return Ok(result?),
            Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| {
                is_wanted.store(false, Ordering::Relaxed);
            })?,
            Err(RecvTimeoutError::Disconnected) => {
                // It has panicked: pyo3 makes an exception of it here.
                let panic = py.detach(|| worker.join()).err();
                resume_unwind(panic.unwrap_or_else(|| Box::new("a computation ended without a result")));
            }
        }
    }
}
