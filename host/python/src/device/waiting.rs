//! Waiting for a sample index, or for the beginning of a drive.

use super::{Device, lock};
use crate::error::Failure;
use crate::result::Answer;
use pyo3::prelude::*;

/// What is waited for.
#[derive(Clone, Debug, FromPyObject)]
pub(crate) enum Awaited<'py> {
    /// A sample index.
    Index(u64),
    /// The result of a drive.
    Drive(Bound<'py, Answer>),
}

impl Device {
    pub(super) fn wait_for(&self, py: Python<'_>, awaited: Awaited<'_>) -> PyResult<u64> {
        let index = match awaited {
            Awaited::Index(index) => index,
            Awaited::Drive(drive) => match drive.getattr("at_samples")?.extract()? {
                Some(index) => index,
                None => {
                    let began = self.wait_for_trigger(py)?;
                    drive.get().set(py, "at_samples", began)?;
                    return Ok(began);
                }
            },
        };
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
