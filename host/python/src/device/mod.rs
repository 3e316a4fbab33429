//! The device.
//!
//! ```text
//! Python's call --attention--> call.rs, detached from the interpreter --> native client --> link's thread --> device
//!       Ctrl-C --every 50 ms--> the drive is stopped, the exception raised
//! slipline._alive (a Python thread) --sign--> sign of life; after `unattended_s` without a call: stop and disarm
//! ```
//! Where Python cannot run, no sign comes, and the link's thread stops and disarms the device within a second; where that
//! thread cannot run either, the device's own dead-man does.

mod attention;
mod call;
mod drive;
mod failure;
mod measure;
mod waiting;

pub(crate) use call::connect;

use crate::error::Failure;
use crate::measurement::Measurement;
use crate::plate::Plate as PyPlate;
use crate::result::{Answer, fields};
use attention::Attention;
use drive::{At, asked_tone, further_tone};
use measure::Wish;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use slipline_instrument::device_info::DeviceInfo;
use slipline_instrument::hold::{Holding, MAX_RISE};
use slipline_instrument::measure::verify_windows_s;
use slipline_instrument::native::{ArmingConsent, Client, ClientError, InterruptibleLink};
use slipline_instrument::rig::PreparedRig;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_link::{DeviceTable, Port};
use slipline_model::field::simulation::table_for;
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::{DriveTable, Plate};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use waiting::Awaited;

/// A connected device.
///
/// It is driven inside a ``with`` block, and is stopped and disarmed when the block is left, by whatever way: its end, an
/// exception, Ctrl-C. Any call renews ``unattended_s``: after so long without one the device is stopped and disarmed, and the
/// next call raises :class:`slipline.Unattended`. ``time.sleep`` and a debugger's prompt are no calls. Where no Python code
/// can run at all, as in C code that keeps the interpreter's lock, the drive ends within a second.
#[pyclass(frozen, weakref, module = "slipline")]
pub(crate) struct Device {
    client: Client<InterruptibleLink>,
    port: Port,
    rig: Option<PreparedRig>,
    attention: Attention,
    /// The exception of a signal that has interrupted the call under way.
    signal: Arc<Mutex<Option<PyErr>>>,
    /// The process that has connected: a fork of it has no link.
    process: u32,
    state: Mutex<State>,
}

/// The present use of the device.
#[derive(Default)]
struct State {
    block: Block,
    loaded: Option<Loaded>,
    /// The consent of the latest `arm()`.
    consent: ArmingConsent,
    /// The sample index at which the latest drive begins.
    began: Option<u64>,
    /// The index of acceptance of the latest drive that waits for the trigger.
    accepted: Option<u64>,
}

/// The plate in use, with its tables.
#[derive(Clone)]
struct Loaded {
    plate: Arc<Plate>,
    table: Arc<DriveTable>,
    on_device: Arc<DeviceTable>,
}

/// The `with` block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Block {
    #[default]
    Before,
    Inside,
    Closed,
}

/// Any number: its range is that of the plate or the device.
const ANY: Range = Range::new(f64::NEG_INFINITY, f64::INFINITY, "");

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Each value under these locks is complete at any time.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[pymethods]
impl Device {
    /// Makes the device hold the table of this plate, unless it holds it already.
    #[pyo3(name = "use")]
    fn use_plate(&self, py: Python<'_>, plate: &PyPlate) -> PyResult<()> {
        let plate = Arc::clone(&plate.plate);
        let (loaded, is_limited) = self.call(py, move |client| {
            let rate_hz = client.identity()?.sample_rate_hz;
            let made = client.during(|| table_for(&plate, rate_hz))?;
            let (table, on_device) = made.map_err(|error| Failure::of(&error))?;
            client.use_table(Arc::clone(&on_device))?;
            let is_limited = on_device.travel_limit().is_none() || client.snapshot().can_limit_travel();
            Ok((Loaded { plate, table: Arc::new(table), on_device }, is_limited))
        })?;
        lock(&self.state).loaded = Some(loaded);
        if !is_limited {
            let text = c"the device does not limit the actuator's travel: its firmware is too old for it";
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), text, 1)?;
        }
        Ok(())
    }

    /// Unmutes the amplifier and accepts drives; only inside the block.
    ///
    /// A board without a brown-out level, or without a profile of its actuator, is armed only where the user accepts that.
    #[pyo3(signature = (*, despite_brown_out_level=false, despite_no_profile=false))]
    fn arm(&self, py: Python<'_>, despite_brown_out_level: bool, despite_no_profile: bool) -> PyResult<()> {
        self.check_block("arm()")?;
        let consent = ArmingConsent { despite_brown_out_level, despite_no_profile };
        self.call(py, move |client| {
            may_be_armed(client, consent)?;
            // The attention of this program takes the place of a lease.
            Ok(client.arm_for(None)?)
        })?;
        lock(&self.state).consent = consent;
        Ok(())
    }

    /// Ramps to silence and mutes the amplifier; returns when it is silent.
    fn disarm(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, |client| Ok(client.disarm()?))
    }

    /// Plays tones, to which those that sound glide.
    ///
    /// One place, and a dictionary of a place and a ``level`` for each further one of ``tones``. ``glide_s``: 5 ms to 10 s.
    /// ``at``: ``None`` for now, a sample index, or ``"trigger"`` for the rise of the trigger input; ``at_samples`` of the
    /// result is then ``None`` until :meth:`wait` has seen it begin.
    #[pyo3(signature = (*, felt_edge_m=None, turning_point_m=None, frequency_hz=None, level=0.8, tones=Vec::new(), glide_s=0.02, at=None))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn drive(
        &self,
        py: Python<'_>,
        felt_edge_m: Option<f64>,
        turning_point_m: Option<f64>,
        frequency_hz: Option<f64>,
        level: f64,
        tones: Vec<Bound<'_, PyDict>>,
        glide_s: f64,
        at: Option<At>,
    ) -> PyResult<Answer> {
        let first = asked_tone(felt_edge_m, turning_point_m, frequency_hz, level)?;
        let further = tones.iter().map(|tone| further_tone(tone, level));
        let tones = first.map(Ok).into_iter().chain(further).collect::<PyResult<Vec<_>>>()?;
        self.drive_tones(py, tones, glide_s, At::apply(at)?)
    }

    /// Plays a texture of the plate in use: the result of ``plate.texture()``.
    #[pyo3(signature = (texture, *, glide_s=0.02, at=None))]
    fn play(
        &self,
        py: Python<'_>,
        texture: &Bound<'_, Answer>,
        glide_s: f64,
        at: Option<At>,
    ) -> PyResult<Answer> {
        self.play_texture(py, texture, glide_s, At::apply(at)?)
    }

    /// Waits until the device is at a sample index, or until a drive has begun; returns the index.
    ///
    /// Of a drive that waits for the trigger it is the index at which it began, which its ``at_samples`` then has, too. Raises
    /// what stops the device meanwhile.
    fn wait(&self, py: Python<'_>, at_samples: Awaited<'_>) -> PyResult<u64> {
        self.wait_for(py, at_samples)
    }

    /// Ramps to silence, from any thread; returns the sample index at which the ramp begins. The device stays armed.
    fn stop(&self, py: Python<'_>) -> PyResult<u64> {
        self.call(py, |client| Ok(client.stop()?))
    }

    /// Holds the tones that sound at the level that the sensor measures now, whatever a finger absorbs, until the next drive.
    ///
    /// Leave the plate untouched until it returns. ``max_rise_db``: the largest rise of a tone, 0 to 20 dB.
    #[pyo3(signature = (max_rise_db=12.0))]
    fn hold(&self, py: Python<'_>, max_rise_db: f64) -> PyResult<()> {
        OutOfRange::check("max_rise_db", max_rise_db, MAX_RISE).map_err(|it| Failure::out_of_range(&it))?;
        let (plate, began) = (self.loaded()?.plate, lock(&self.state).began);
        self.call(py, move |client| {
            client.hold(&mut Holding::default(), &plate, max_rise_db, began, || true)?;
            Ok(())
        })
    }

    /// Measures the response of the sensor at ``place_m`` to the device's tones; arms the device, and disarms it then.
    ///
    /// ``kind``: what the sensor measures; ``input``: ``"sensor"``, or ``"current"`` of the drive, which has no place. Options:
    /// those of ``slipline measure`` for the frequencies (``points``, ``sweep``, ``to`` and, because it is a word of Python,
    /// ``from_``), ``level`` and the drive circuit, by which quiet tones check that the drive is on.
    #[pyo3(signature = (place_m=None, kind="displacement", input="sensor", **as_cli))]
    fn measure(
        &self,
        py: Python<'_>,
        place_m: Option<f64>,
        kind: &str,
        input: &str,
        as_cli: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Measurement> {
        self.check_block("measure()")?;
        self.measure_plate(py, Wish::new(place_m, kind, input, as_cli)?)
    }

    /// Compares the device's codes with those that they should be, in four windows; arms the device, and disarms it then.
    ///
    /// Plays up to 16 tones. The result has the fields ``equal`` and ``windows``.
    #[pyo3(signature = (*, tones=16, window_s=0.25))]
    fn verify(&self, py: Python<'_>, tones: u8, window_s: f64) -> PyResult<Answer> {
        let of_tones = Range::new(1.0, MAX_TONES as f64, "");
        OutOfRange::check("tones", tones.into(), of_tones).map_err(|it| Failure::out_of_range(&it))?;
        self.check_block("verify()")?;
        let (plate, consent) = (self.loaded()?.plate, lock(&self.state).consent);
        let verified = self.call(py, move |client| {
            let windows = verify_windows_s(f64::from(client.identity()?.sample_rate_hz));
            OutOfRange::check("window_s", window_s, windows).map_err(|it| Failure::out_of_range(&it))?;
            may_be_armed(client, consent)?;
            client.disarm()?;
            Ok(fields(&client.verify(&plate, tones, window_s)?))
        })?;
        Answer::of(py, verified)
    }

    /// What the device reports of itself: the fields of ``slipline info --json``.
    fn status(&self, py: Python<'_>) -> PyResult<Answer> {
        let port = self.port.clone();
        let info = self.call(py, move |client| {
            client.refresh()?;
            Ok(fields(&DeviceInfo::of(&port, &client.snapshot())))
        })?;
        Answer::of(py, info)
    }

    /// Whether the block has been left, and the connection with it.
    #[getter]
    fn closed(&self) -> bool {
        lock(&self.state).block == Block::Closed
    }

    fn __enter__(slf: Bound<'_, Self>) -> PyResult<Bound<'_, Self>> {
        {
            let mut state = lock(&slf.get().state);
            match state.block {
                Block::Before => state.block = Block::Inside,
                Block::Inside => return Err(Failure::refused("the device is in a block already").into()),
                Block::Closed => return Err(closed().into()),
            }
        }
        slf.py().import("slipline._alive")?.call_method1("begin", (&slf,))?;
        Ok(slf)
    }

    fn __exit__(
        &self,
        py: Python<'_>,
        _kind: Option<Bound<'_, PyType>>,
        _error: Option<Bound<'_, PyAny>>,
        _trace: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        self._close(py)
    }

    /// Stops and disarms the device, and closes the connection; then raises what a signal has raised meanwhile.
    fn _close(&self, py: Python<'_>) -> PyResult<()> {
        let before = std::mem::replace(&mut lock(&self.state).block, Block::Closed);
        if before != Block::Closed && self.process == std::process::id() {
            py.detach(|| self.client.disconnect());
        }
        lock(&self.signal).take().map_or(Ok(()), Err)
    }

    /// Gives a sign of life, and ends what nobody attends to any more. Returns whether a further sign is due.
    fn _sign(&self) -> bool {
        if self.closed() || self.process != std::process::id() {
            return false;
        }
        if self.is_armed() && self.attention.ends() {
            self.client.stop_and_disarm();
        }
        self.client.sign_of_life();
        true
    }

    fn __repr__(&self) -> String {
        format!(
            "Device({:?}, closed={})",
            self.port.to_string(),
            if self.closed() { "True" } else { "False" }
        )
    }
}

impl Device {
    /// Refuses what arms the device outside the block.
    fn check_block(&self, call: &str) -> Result<(), Failure> {
        match lock(&self.state).block {
            Block::Inside => Ok(()),
            Block::Closed => Err(closed()),
            Block::Before => Err(Failure::refused(format_args!(
                "{call} is refused outside the block: write `with connect(...) as device:`"
            ))),
        }
    }

    /// The plate in use.
    fn loaded(&self) -> Result<Loaded, Failure> {
        let loaded = lock(&self.state).loaded.clone();
        loaded.ok_or_else(|| Failure::refused("the device has no plate: call use(plate) first"))
    }
}

fn closed() -> Failure {
    Failure::refused("the device is closed: its block was left; connect again")
}

fn may_be_armed(client: &Client<InterruptibleLink>, consent: ArmingConsent) -> Result<(), Failure> {
    client.may_be_armed(consent).map_err(|error| {
        let option = if matches!(error, ClientError::Unguarded(_)) {
            "despite_brown_out_level"
        } else if matches!(error, ClientError::NoProfile) {
            "despite_no_profile"
        } else {
            return error.into();
        };
        Failure::refused(format_args!("{error} To arm it anyway: arm({option}=True)."))
    })
}
