//! Waiting for a sample index, or for the beginning of a drive.

use super::{Device, lock};
use crate::error::Failure;
use crate::result::Answer;
use pyo3::prelude::*;

impl Device {
    pub(super) fn wait_for(&self, py: Python<'_>, at_samples: &Bound<'_, PyAny>) -> PyResult<u64> {
        let drive = at_samples.cast::<Answer>().ok();
        let index = match drive {
            Some(drive) => drive.getattr("at_samples")?,
            None => at_samples.clone(),
        };
        if drive.is_some() && index.is_none() {
            let began = self.wait_for_trigger(py)?;
            for drive in drive {
                drive.get().set(py, "at_samples", began)?;
            }
            return Ok(began);
        }
        let wrong = |_| Failure::wrong_arguments("at_samples of wait()", "a sample index, or a drive");
        let index: u64 = index.extract().map_err(wrong)?;
        self.call(py, move |client| Ok(client.wait_until(index, || true)?))?;
        Ok(index)
    }

    /// The sample index at which the latest drive that waits for the trigger begins.
    fn wait_for_trigger(&self, py: Python<'_>) -> PyResult<u64> {
        let accepted = lock(&self.state).accepted;
        let accepted = accepted.ok_or_else(|| Failure::refused("no drive waits for the trigger any more"))?;
        let began = self.call(py, move |client| Ok(client.wait_for_trigger(accepted, || true)?))?;
        // Nothing else ends the wait.
        let began = began.unwrap_or(accepted);
        let mut state = lock(&self.state);
        (state.began, state.accepted) = (Some(began), None);
        Ok(began)
    }
}
