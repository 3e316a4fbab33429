//! Waiting for a sample index, for a time by the device's clock, or for the beginning of a drive.

use super::{Device, lock};
use crate::arguments::{in_range, optional};
use crate::error::{Exception, Failure};
use crate::result::ResultArgument;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyInt;
use pyo3::{Borrowed, type_hint_union};
use slipline_instrument::native::{Client, InterruptibleLink};
use slipline_plate::quantity::Range;
use std::time::{Duration, Instant};

/// Times of waits and of their limits.
const WAITS: Range = Range::new(0.0, 86_400.0, "s");

/// What is waited for.
#[derive(Clone, Debug)]
pub(crate) enum Awaited<'py> {
    /// A sample index.
    Index(u64),
    /// The result of a drive.
    Drive(Bound<'py, PyAny>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Awaited<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr =
        type_hint_union!(<u64 as FromPyObject<'a, 'py>>::INPUT_TYPE, ResultArgument::TYPE);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Some(ResultArgument(drive)) = ResultArgument::of(&given)? {
            return Ok(Self::Drive(drive));
        }
        sample_index("at_samples", &given, "a sample index, or the result of drive() or stop()")
            .map(Self::Index)
    }
}

/// A sample index as the argument `at`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleIndex(pub(super) u64);

impl<'a, 'py> FromPyObject<'a, 'py> for SampleIndex {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = <u64 as FromPyObject<'a, 'py>>::INPUT_TYPE;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        sample_index("at", &given, "None, or a sample index").map(Self)
    }
}

/// A sample index.
pub(super) fn sample_index(name: &str, given: &Bound<'_, PyAny>, allowed: &str) -> PyResult<u64> {
    given.extract().map_err(|_| {
        let text = format!("{name} = {given}");
        if given.is_instance_of::<PyInt>() {
            let (value, range) = (given.extract().unwrap_or(f64::NAN), (0.0, u64::MAX as f64));
            let message = slipline_plate::quantity::must_be(text, "0 to 18446744073709551615");
            return Failure::OutOfRange { message, field: name.to_owned(), value, range }.into();
        }
        Failure::wrong_arguments(text, allowed).into()
    })
}

/// The limits of a wait: until when, and while what holds.
pub(super) struct Limits {
    timeout_s: Option<f64>,
    until: Option<Instant>,
    is_cancelled: Option<Py<PyAny>>,
}

impl Limits {
    /// At most `timeout` seconds from now; `is_cancelled` is asked every 50 ms.
    pub(super) fn new(timeout: Option<f64>, is_cancelled: Option<Py<PyAny>>) -> Result<Self, Failure> {
        optional("timeout", timeout, WAITS)?;
        let until = timeout.map(|timeout_s| Instant::now() + Duration::from_secs_f64(timeout_s));
        Ok(Self { timeout_s: timeout, until, is_cancelled })
    }

    /// Begins to wait at this device.
    pub(super) fn begin(self, client: &Client<InterruptibleLink>) -> Wait<'_> {
        Wait { client, stops: client.stops(), limits: self, end: None }
    }
}

/// Why a wait has ended before what it waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// A call of another thread stopped or disarmed the device.
    Stopped,
    /// The time is over.
    Timeout,
    /// Nobody waits any more.
    Cancelled,
}

/// A wait under way.
pub(super) struct Wait<'a> {
    client: &'a Client<InterruptibleLink>,
    stops: u32,
    limits: Limits,
    end: Option<End>,
}

impl Wait<'_> {
    /// Whether it goes on.
    pub(super) fn goes_on(&mut self) -> bool {
        let is_over = |until: Instant| Instant::now() >= until;
        self.end = if self.limits.until.is_some_and(is_over) {
            Some(End::Timeout)
        } else if self.limits.is_cancelled.as_ref().is_some_and(is_true) {
            Some(End::Cancelled)
        } else if self.client.stops() != self.stops {
            Some(End::Stopped)
        } else {
            None
        };
        self.end.is_none()
    }

    /// Fails unless it has ended by what it waited for, or by a stop.
    pub(super) fn check(&self) -> Result<(), Failure> {
        match self.end {
            None | Some(End::Stopped) => Ok(()),
            Some(End::Timeout) => {
                let timeout_s = self.limits.timeout_s.unwrap_or_default();
                let text = format!("the wait was not over after timeout = {timeout_s} s");
                Err(Failure::Because(Exception::Timeout, text))
            }
            Some(End::Cancelled) => Err(Failure::refused("the wait was cancelled")),
        }
    }
}

/// Whether a function of Python says so; after an exception nobody waits any more.
fn is_true(function: &Py<PyAny>) -> bool {
    let asked = Python::try_attach(|py| function.call0(py)?.is_truthy(py));
    asked.is_none_or(|asked| asked.unwrap_or(true))
}

impl Device {
    /// Waits for one of these; returns the index at which the wait has ended.
    pub(super) fn wait_for(
        &self,
        py: Python<'_>,
        awaited: Option<Awaited<'_>>,
        seconds: Option<f64>,
        limits: Limits,
    ) -> PyResult<u64> {
        match (awaited, seconds) {
            (Some(Awaited::Index(index)), None) => self.wait_until(py, |_| Ok(index), limits),
            (Some(Awaited::Drive(drive)), None) => self.wait_for_drive(py, &drive, limits),
            (None, Some(seconds)) => {
                in_range("seconds", seconds, WAITS)?;
                let index = move |client: &Client<InterruptibleLink>| -> Result<u64, Failure> {
                    let rate_hz = f64::from(client.identity()?.sample_rate_hz);
                    Ok(client.refresh()?.saturating_add((seconds * rate_hz).round() as u64))
                };
                self.wait_until(py, index, limits)
            }
            (awaited, _) => {
                let given = if awaited.is_some() { "at_samples and seconds" } else { "neither" };
                Err(Failure::wrong_arguments(given, "one of at_samples and seconds of wait()").into())
            }
        }
    }

    fn wait_until(
        &self,
        py: Python<'_>,
        index: impl FnOnce(&Client<InterruptibleLink>) -> Result<u64, Failure> + Send,
        limits: Limits,
    ) -> PyResult<u64> {
        self.call(py, move |client| {
            let mut wait = limits.begin(client);
            let index = index(client)?;
            if client.wait_until(index, || wait.goes_on())? {
                return Ok(index);
            }
            wait.check()?;
            // Where the other thread has stopped it.
            Ok(client.refresh()?)
        })
    }

    fn wait_for_drive(&self, py: Python<'_>, drive: &Bound<'_, PyAny>, limits: Limits) -> PyResult<u64> {
        if let Some(index) = drive.getattr("at_samples")?.extract::<Option<u64>>()? {
            return self.wait_until(py, |_| Ok(index), limits);
        }
        let is_superseded = drive.getattr("superseded").is_ok_and(|it| it.is_truthy().unwrap_or(false));
        if is_superseded {
            return Err(superseded().into());
        }
        let Some(accepted) = lock(&self.state).accepted else {
            return Err(Failure::refused("no drive waits for the trigger any more").into());
        };
        let state = &self.state;
        let began = self.call(py, move |client| {
            let mut wait = limits.begin(client);
            let is_latest = || lock(state).accepted == Some(accepted);
            // A stop drops the drive, which the device reports.
            let began = client.wait_for_trigger(accepted, || {
                (wait.goes_on() || wait.end == Some(End::Stopped)) && is_latest()
            })?;
            wait.check()?;
            Ok(began)
        })?;
        let Some(began) = began else {
            drive.setattr("superseded", true)?;
            return Err(superseded().into());
        };
        {
            let mut state = lock(&self.state);
            if state.accepted == Some(accepted) {
                (state.began, state.accepted) = (Some(began), None);
            }
        }
        drive.setattr("at_samples", began)?;
        Ok(began)
    }
}

fn superseded() -> Failure {
    Failure::refused("the drive never began: a newer drive or a stop took its place")
}
