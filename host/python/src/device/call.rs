//! Connecting, and the course of each call on a device.

use super::attention::Attention;
use super::{Block, Device, State, closed, lock};
use crate::arguments::in_range;
use crate::error::{Exception, Failure};
use crate::plate::Plate as PyPlate;
use crate::result::kind::PortInfo;
use crate::result::{Answer, fields};
use pyo3::prelude::*;
use slipline_instrument::device_info::PortAnswer;
use slipline_instrument::native::{Client, InterruptibleLink};
use slipline_instrument::rig::{PreparedRig, RigOptions};
use slipline_link::Port;
use slipline_link::native::list_ports;
use slipline_link::simulator::Options;
use slipline_plate::quantity::Range;
use std::cell::RefCell;
use std::sync::{Arc, Mutex};
use std::time::Duration;

thread_local! {
    /// The exception of a signal that has interrupted the call of this thread. Python raises it in one thread only, so another
    /// one must not take it.
    static SIGNAL: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// The time that an armed device may be left alone.
const UNATTENDED: Range = Range::new(1.0, 600.0, "s");

/// Connects to a device: ``"sim"``, a serial port's name such as ``"/dev/ttyACM0"``, or ``"unix:PATH"``.
///
/// Nothing is armed by it. ``actual_plate`` is the plate under the simulated device, ``sensor_m`` the place of the
/// displacement sensor on it: without them it has no inputs. ``unattended_s``, 1 to 600: after so long without a call an armed
/// device is stopped and disarmed.
#[pyfunction]
#[pyo3(signature = (port="sim", *, actual_plate=None, sensor_m=None, unattended_s=60.0))]
pub(crate) fn connect(
    py: Python<'_>,
    port: &str,
    actual_plate: Option<&PyPlate>,
    sensor_m: Option<f64>,
    unattended_s: f64,
) -> PyResult<Device> {
    in_range("unattended_s", unattended_s, UNATTENDED)?;
    let port: Port = port.parse().map_err(Failure::refused)?;
    let truth = match (actual_plate, sensor_m, &port) {
        (None, None, _) => None,
        (Some(plate), _, Port::Simulated) => Some(Arc::clone(&plate.plate)),
        (None, Some(_), Port::Simulated) => {
            return Err(Failure::wrong_arguments(
                "sensor_m",
                "given with actual_plate, the plate on which the sensor stands",
            )
            .into());
        }
        (_, _, Port::Serial(_) | Port::Unix(_)) => {
            let given = format_args!("actual_plate and sensor_m with the port {port}");
            return Err(Failure::wrong_arguments(given, "those of the simulated device: port \"sim\"").into());
        }
    };
    if let (Some(plate), Some(sensor_m)) = (&truth, sensor_m) {
        in_range("sensor_m", sensor_m, Range::new(0.0, plate.length_m(), "m"))?;
    }
    let rig = truth
        .map(|plate| {
            crate::waiting::compute(py, move |_| {
                let options = RigOptions { place_m: sensor_m.unwrap_or(0.0), ..RigOptions::default() };
                let rate_hz = f64::from(Options::default().sample_rate_hz);
                PreparedRig::new(&plate, &options, rate_hz).map_err(|error| Failure::of(&error))
            })
        })
        .transpose()?;
    let is_interrupted = || {
        let asked = Python::try_attach(|py| py.check_signals());
        let exception = asked.and_then(Result::err);
        let is_there = exception.is_some();
        if is_there {
            SIGNAL.set(exception);
        }
        is_there
    };
    let client = Client::interruptible(rig.as_ref(), is_interrupted).map_err(Failure::from)?;
    let device = Device {
        client,
        port: port.clone(),
        rig,
        attention: Attention::new(Duration::from_secs_f64(unattended_s)),
        process: std::process::id(),
        state: Mutex::new(State::default()),
        reconnecting: Mutex::new(()),
        latest_log: Mutex::new(None),
    };
    device.call(py, move |client| Ok(client.observe(&port)?))?;
    Ok(device)
}

/// The exception of a signal that has interrupted the call of this thread.
pub(super) fn take_signal() -> Option<PyErr> {
    SIGNAL.take()
}

/// The ports of this computer at which a device can be, as ``slipline ports``: results with ``port``, ``label``, ``is_ours`` and
/// ``usb_serial``.
#[pyfunction]
pub(crate) fn ports(py: Python<'_>) -> PyResult<Vec<Answer<PortInfo>>> {
    let ports = py.detach(list_ports);
    ports.iter().map(|info| Answer::of(py, fields(&PortAnswer::from(info)))).collect()
}

impl Device {
    /// Carries out a call: without the interpreter, attended, and ended by a signal.
    pub(super) fn call<R: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&Client<InterruptibleLink>) -> Result<R, Failure> + Send,
    ) -> PyResult<R> {
        if self.process != std::process::id() {
            return Err(Failure::refused("the device belongs to the process that has connected it").into());
        }
        if lock(&self.state).block == Block::Closed {
            return Err(closed().into());
        }
        let Some(_call) = self.attention.begin() else {
            let limit_s = self.attention.limit().as_secs_f64();
            let text = format!("no call came for {limit_s} s, so the device was stopped and disarmed");
            return Err(Failure::Because(Exception::Unattended, text).into());
        };
        let result = py.detach(|| act(&self.client));
        if let Some(exception) = take_signal() {
            // Where the call has ended before it has noticed the interruption, the next one must not end by it.
            let _ = self.client.check_attended();
            self.client.stop_and_disarm();
            return Err(exception);
        }
        result.map_err(|failure| {
            let is_closed = lock(&self.state).block == Block::Closed;
            if is_closed { closed().into() } else { failure.into() }
        })
    }

    /// Whether the device can be driven, by its latest status.
    pub(super) fn is_armed(&self) -> bool {
        self.client.snapshot().is_armed()
    }
}
