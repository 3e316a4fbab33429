//! What Python calls on a device.

use super::drive::At;
use super::lab::profile_fields;
use super::measure::{Wish, asked_sensor, circuit, frequencies};
use super::step::{Step, asked_tone, further_tone};
use super::wait::{Awaited, Limits, SampleIndex};
use super::{Block, Device, Loaded, closed, lock, may_be_armed, take_signal};
use crate::arguments::{count_in, in_range, items};
use crate::coroutine::{Coroutine, Rest, StatusIterator};
use crate::error::Failure;
use crate::measurement::Measurement;
use crate::plate::{Plate as PyPlate, check_length};
use crate::result::kind::{BrownOut, Drive, Harmonics, Profile, Selftest, Status, Sweep, Trim, Verification};
use crate::result::{Answer, ResultArgument, fields};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyType;
use slipline_instrument::device_info::DeviceInfo;
use slipline_instrument::hold::{Holding, MAX_RISE};
use slipline_instrument::measure::{Bandwidths, LEVEL, SWEEP_S, verify_windows_s};
use slipline_instrument::native::ArmingConsent;
use slipline_instrument::profile_file;
use slipline_instrument::requests::MeasureRequest;
use slipline_instrument::selftest::SelftestRequest;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_model::field::simulation::table_for;
use slipline_plate::quantity::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Times between two looks of an iterator.
const PERIODS: Range = Range::new(0.01, 60.0, "s");

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

    /// Disarms the device for a break of any length: a disarmed device needs no call.
    ///
    /// The result's ``go_on()`` arms the device as the latest :meth:`arm` did. In ``with device.rest():`` the end of the block does so.
    fn rest<'py>(slf: &Bound<'py, Self>) -> PyResult<Rest<'py>> {
        let device = slf.get();
        device.disarm(slf.py())?;
        let ArmingConsent { despite_brown_out_level, despite_no_profile } = lock(&device.state).consent;
        let rest = slf.py().import("slipline._rest")?.getattr("Rest")?;
        Ok(Rest(rest.call1((slf, despite_brown_out_level, despite_no_profile))?))
    }

    /// Clears the latched faults whose causes are gone. The device is disarmed then: call :meth:`arm`.
    ///
    /// Raises ``Fault`` with those whose causes stand.
    fn clear_faults(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, |client| Ok(client.clear_faults()?))
    }

    /// Connects again after a lost link, and gives the device the table of the plate in use. It is disarmed then.
    ///
    /// An open connection is stopped, disarmed and closed first. Raises ``LinkLost`` where no device answers.
    fn reconnect(&self, py: Python<'_>) -> PyResult<()> {
        let (port, loaded) = (self.port.clone(), lock(&self.state).loaded.clone());
        let turn = &self.reconnecting;
        self.call(py, move |client| {
            // One thread would close the connection that another one waits for.
            let _turn = lock(turn);
            client.observe(&port)?;
            if let Some(loaded) = loaded {
                client.use_table(loaded.on_device)?;
            }
            Ok(())
        })
    }

    /// Plays tones, to which those that sound glide.
    ///
    /// One place, and a dictionary of a place and a ``level`` for each further one of ``tones``. ``glide_s``: 5 ms to 10 s.
    /// ``at``: ``None`` for now, a sample index, or ``"trigger"`` for the rise of the trigger input; ``at_samples`` of the
    /// result is then ``None`` until :meth:`wait` has seen it begin. An index is rounded up to a block of 128 samples. The device
    /// has room for one change ahead: this call waits until an earlier one for an index has begun, and until its own index is
    /// less than a minute ahead.
    ///
    /// ``cancel_harmonics`` plays companions at twice and three times the frequency of each tone, opposite to the harmonics of the drive
    /// that the plate states: up to five tones, which begin in silence and do not glide. Of several tones the sums of their
    /// frequencies stay.
    ///
    /// Where a newer drive or a stop of another thread takes its place before the device has accepted it, ``superseded`` of the
    /// result is true, and ``at_samples`` is ``None``.
    #[pyo3(signature = (*, felt_edge_m=None, turning_point_m=None, frequency_hz=None, level=0.8, tones=None, glide_s=0.02, at=None, cancel_harmonics=false))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn drive(
        &self,
        py: Python<'_>,
        felt_edge_m: Option<f64>,
        turning_point_m: Option<f64>,
        frequency_hz: Option<f64>,
        level: f64,
        tones: Option<Bound<'_, PyAny>>,
        glide_s: f64,
        at: Option<At>,
        cancel_harmonics: bool,
    ) -> PyResult<Answer<Drive>> {
        let first = asked_tone(felt_edge_m, turning_point_m, frequency_hz, level)?;
        let further = tones.map_or(Ok(Vec::new()), |tones| items("tones", &tones, MAX_TONES))?;
        let further = further.iter().map(|tone| further_tone(tone, level));
        let tones = first.map(Ok).into_iter().chain(further).collect::<PyResult<Vec<_>>>()?;
        self.drive_tones(py, tones, glide_s, At::begin(at), cancel_harmonics)
    }

    /// Plays drives, each from its sample index on, and returns their results when the last one is accepted.
    ///
    /// ``drives`` is a sequence of dictionaries: ``at``, and the other keywords of :meth:`drive` but ``cancel_harmonics``; one without tones ends what
    /// sounds. Each is sent when the one before has begun, some milliseconds later: those that follow each other more closely are
    /// refused as late, and the device is stopped. A stop or a drive of another thread ends the sequence; the drives that it has
    /// kept from being sent are ``superseded``.
    #[pyo3(signature = (drives, *, timeout=None))]
    fn sequence(
        &self,
        py: Python<'_>,
        drives: &Bound<'_, PyAny>,
        timeout: Option<f64>,
    ) -> PyResult<Vec<Answer<Drive>>> {
        let steps = items("drives", drives, Step::MOST)?;
        let steps = steps.iter().map(Step::read).collect::<PyResult<Vec<_>>>()?;
        self.play_steps(py, steps, Limits::new(timeout, None)?)
    }

    /// Plays a texture of the plate in use: the result of ``plate.texture()``.
    #[pyo3(signature = (texture, *, glide_s=0.02, at=None))]
    fn play(
        &self,
        py: Python<'_>,
        texture: ResultArgument<'_>,
        glide_s: f64,
        at: Option<At>,
    ) -> PyResult<Answer<Drive>> {
        self.play_texture(py, &texture.0, glide_s, At::begin(at))
    }

    /// Waits until the device is at a sample index, until a drive has begun, or for ``seconds`` by the device's clock; returns
    /// the index at which the wait has ended.
    ///
    /// Of a drive that waits for the trigger it is the index at which it began, which its ``at_samples`` then has, too. A stop or
    /// a disarm of another thread ends the wait at once. Raises what stops the device meanwhile, and ``TimeoutError`` after
    /// ``timeout`` seconds by this computer's clock.
    #[pyo3(signature = (at_samples=None, *, seconds=None, timeout=None))]
    fn wait(
        &self,
        py: Python<'_>,
        at_samples: Option<Awaited<'_>>,
        seconds: Option<f64>,
        timeout: Option<f64>,
    ) -> PyResult<u64> {
        self.wait_for(py, at_samples, seconds, Limits::new(timeout, None)?)
    }

    /// As :meth:`wait`; ends when `is_cancelled` returns true.
    #[pyo3(signature = (at_samples, seconds, timeout, is_cancelled))]
    fn _wait(
        &self,
        py: Python<'_>,
        at_samples: Option<Awaited<'_>>,
        seconds: Option<f64>,
        timeout: Option<f64>,
        is_cancelled: Py<PyAny>,
    ) -> PyResult<u64> {
        self.wait_for(py, at_samples, seconds, Limits::new(timeout, Some(is_cancelled))?)
    }

    /// As :meth:`wait`, awaited in ``asyncio``: other tasks run meanwhile, and the task can be cancelled.
    #[pyo3(signature = (at_samples=None, *, seconds=None, timeout=None))]
    fn wait_async<'py>(
        slf: &Bound<'py, Self>,
        at_samples: Option<Awaited<'py>>,
        seconds: Option<f64>,
        timeout: Option<f64>,
    ) -> PyResult<Coroutine<'py>> {
        let at_samples = match at_samples {
            None => slf.py().None().into_bound(slf.py()),
            Some(Awaited::Index(index)) => index.into_pyobject(slf.py())?.into_any(),
            Some(Awaited::Drive(drive)) => drive,
        };
        let wait = slf.py().import("slipline._waiting")?.getattr("wait_async")?;
        Ok(Coroutine(wait.call1((slf, at_samples, seconds, timeout))?))
    }

    /// Iterates over the device's status, the fields of :meth:`status`, every ``period_s`` (0.01 to 60 s) until the block is
    /// left. Each step is a call, which renews ``unattended_s``.
    #[pyo3(signature = (period_s=0.1))]
    fn watch<'py>(slf: &Bound<'py, Self>, period_s: f64) -> PyResult<StatusIterator<'py>> {
        in_range("period_s", period_s, PERIODS)?;
        let watch = slf.py().import("slipline._waiting")?.getattr("watch")?;
        Ok(StatusIterator(watch.call1((slf, period_s))?))
    }

    /// Ramps to silence, from any thread; returns the sample index at which the ramp begins. The device stays armed.
    ///
    /// Without ``at`` the ramp begins now and takes 30 ms. ``at``, a sample index, is rounded up to a block of 128 samples; the
    /// tones fade from there on for ``glide_s``, 5 ms to 10 s. If it has passed, the ramp begins now: the returned index says so.
    /// It is one change ahead, as a drive for an index, and the next drive waits until it has begun.
    #[pyo3(signature = (*, at=None, glide_s=0.02))]
    fn stop(&self, py: Python<'_>, at: Option<SampleIndex>, glide_s: f64) -> PyResult<u64> {
        match at {
            None => self.call(py, |client| Ok(client.stop()?)),
            Some(SampleIndex(at)) => self.stop_at(py, at, glide_s),
        }
    }

    /// Ramps to silence within 2 ms, mutes the amplifier and latches a fault, from any thread; returns the sample index at which
    /// the ramp begins. Then :meth:`clear_faults`, and :meth:`arm`.
    fn emergency_stop(&self, py: Python<'_>) -> PyResult<u64> {
        self.call(py, |client| Ok(client.emergency_stop()?))
    }

    /// Holds the tones that sound at the level that the sensor measures now, whatever a finger absorbs, until the next drive.
    ///
    /// Leave the plate untouched until it returns. ``max_rise_db``: the largest rise of a tone, 0 to 20 dB. Raises
    /// ``TimeoutError`` after ``timeout`` seconds.
    #[pyo3(signature = (max_rise_db=12.0, *, timeout=None))]
    fn hold(&self, py: Python<'_>, max_rise_db: f64, timeout: Option<f64>) -> PyResult<()> {
        in_range("max_rise_db", max_rise_db, MAX_RISE)?;
        let limits = Limits::new(timeout, None)?;
        let (plate, began) = (self.loaded()?.plate, lock(&self.state).began);
        self.call(py, move |client| {
            let mut wait = limits.begin(client);
            if client.hold(&mut Holding::default(), &plate, max_rise_db, began, || wait.goes_on())? {
                return Ok(());
            }
            wait.check()?;
            // An emergency stop of that thread has latched a fault.
            client.refresh()?;
            client.check_drives()?;
            Err(Failure::refused("nothing is held: another thread stopped the device"))
        })
    }

    /// Measures the response of the sensor at ``place_m`` to the device's tones; arms the device, and disarms it then, also where
    /// it fails or another thread stops it.
    ///
    /// ``kind``: what the sensor measures; ``input``: ``"sensor"``, or ``"current"`` of the drive, which has no place. ``points``
    /// frequencies lie from ``low_hz`` to ``high_hz``; ``level`` is 0 to 1; ``sweep`` plays a gliding tone. By the drive circuit,
    /// the amplifier's volts and the shunt's amperes at full scale and the coil's resistance or the piezo's capacitance, quiet tones
    /// check that the drive is on; ``amplifier_bandwidth_hz`` and ``filter_bandwidth_hz``, each of second order, bound the images that
    /// fold onto a measured current (a ``UserWarning`` where a piezo's may be more than 5 % wrong). ``sensor_mass_kg`` and
    /// ``sensor_width_m`` are those of a sensor that stands on the plate; the sensor of the simulated device has none.
    #[pyo3(signature = (place_m=None, kind="displacement", input="sensor", *, points=None, low_hz=None, high_hz=None, level=None, sweep=false, amplifier_v=None, coil_ohm=None, piezo_f=None, shunt_a=None, amplifier_bandwidth_hz=None, filter_bandwidth_hz=None, sensor_mass_kg=0.0, sensor_width_m=0.0))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn measure(
        &self,
        py: Python<'_>,
        place_m: Option<f64>,
        kind: &str,
        input: &str,
        points: Option<i64>,
        low_hz: Option<f64>,
        high_hz: Option<f64>,
        level: Option<f64>,
        sweep: bool,
        amplifier_v: Option<f64>,
        coil_ohm: Option<f64>,
        piezo_f: Option<f64>,
        shunt_a: Option<f64>,
        amplifier_bandwidth_hz: Option<f64>,
        filter_bandwidth_hz: Option<f64>,
        sensor_mass_kg: f64,
        sensor_width_m: f64,
    ) -> PyResult<Measurement> {
        self.check_block("measure()")?;
        let bandwidths = Bandwidths { amplifier_hz: amplifier_bandwidth_hz, filter_hz: filter_bandwidth_hz };
        let sensor = asked_sensor(input, place_m, kind, (sensor_mass_kg, sensor_width_m))?;
        let frequencies = frequencies(points, low_hz, high_hz, level)?;
        let known = circuit(amplifier_v, coil_ohm, piezo_f, shunt_a, bandwidths)?;
        let request = MeasureRequest { frequencies, is_sweep: sweep, known };
        self.measure_plate(py, Wish { sensor, request })
    }

    /// Measures the second and third harmonic that the drive adds to tones, as ``slipline measure --harmonics``, by a sensor at
    /// ``place_m`` near the driven end; arms the device, and disarms it then.
    ///
    /// ``points``, 2 to 64, fundamentals lie over the plate's span, at ``level`` (0.001 to 1) of the table's full scale. The result has
    /// ``plate``, the plate in use with these harmonics, and ``harmonics``, the second and the third. Give it to :meth:`use`, and
    /// ``drive(cancel_harmonics=True)`` plays tones that cancel them.
    #[pyo3(signature = (place_m, kind="displacement", *, points=8, level=0.5, sensor_mass_kg=0.0, sensor_width_m=0.0))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn measure_harmonics(
        &self,
        py: Python<'_>,
        place_m: f64,
        kind: &str,
        points: i64,
        level: f64,
        sensor_mass_kg: f64,
        sensor_width_m: f64,
    ) -> PyResult<Answer<Harmonics>> {
        self.check_block("measure_harmonics()")?;
        let sensor = asked_sensor("sensor", Some(place_m), kind, (sensor_mass_kg, sensor_width_m))?;
        in_range("level", level, LEVEL)?;
        let wish = Wish { sensor, request: MeasureRequest::default() };
        self.measure_harmonics_of(py, wish, points, level)
    }

    /// Measures the wave speed of the calibrated plate in use by one sensor, as ``slipline trim``, and with ``duration_s`` (up to a
    /// day) again and again for this time; arms the device, and disarms it then.
    ///
    /// The result has ``plate``, that of the latest speed, and ``begin`` and each of ``later`` with ``wave_speed_share`` and its 95 %
    /// interval. The other arguments are those of :meth:`measure`. Raises ``Refused`` for a plate without a calibration, and where one
    /// speed does not explain what was measured.
    #[pyo3(signature = (place_m, kind="displacement", *, duration_s=None, points=None, low_hz=None, high_hz=None, level=0.5, sweep=false))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn trim(
        &self,
        py: Python<'_>,
        place_m: f64,
        kind: &str,
        duration_s: Option<f64>,
        points: Option<i64>,
        low_hz: Option<f64>,
        high_hz: Option<f64>,
        level: f64,
        sweep: bool,
    ) -> PyResult<Answer<Trim>> {
        self.check_block("trim()")?;
        let sensor = asked_sensor("sensor", Some(place_m), kind, (0.0, 0.0))?;
        let frequencies = frequencies(points, low_hz, high_hz, Some(level))?;
        let request = MeasureRequest { frequencies, is_sweep: sweep, known: None };
        self.trim_plate(py, Wish { sensor, request }, duration_s)
    }

    /// Plays a sweep twice for a separate recorder, as ``slipline sweep``, and writes its description into the file ``path``, which
    /// :meth:`Measurement.read` needs as ``played`` with each recording; arms the device, and disarms it then.
    ///
    /// ``duration_s`` is that of one sweep, up to 10 s; the shortest one follows from the band, 0.55 s on ``membrane``. ``level`` is that
    /// of the first sweep, the second one has half of it. An existing file is replaced.
    #[pyo3(signature = (path, *, duration_s=4.0, points=None, low_hz=None, high_hz=None, level=0.5))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn sweep(
        &self,
        py: Python<'_>,
        path: PathBuf,
        duration_s: f64,
        points: Option<i64>,
        low_hz: Option<f64>,
        high_hz: Option<f64>,
        level: f64,
    ) -> PyResult<Answer<Sweep>> {
        self.check_block("sweep()")?;
        in_range("duration_s", duration_s, SWEEP_S)?;
        let frequencies = frequencies(points, low_hz, high_hz, Some(level))?;
        self.sweep_plate(py, path, frequencies, duration_s)
    }

    /// The level of the board's brown-out reset, as ``slipline board brown-out``; with ``set``, the board writes the level that it needs
    /// into its chip's option bytes, once, and restarts: press its user button and hold it meanwhile.
    ///
    /// If the power fails meanwhile some chips erase their program, so ``set`` needs ``power_is_safe``. The result has ``written``, and
    /// the level as it was read back after the restart. Raises ``Refused`` if the button is not held.
    #[pyo3(signature = (*, set=false, power_is_safe=false))]
    fn brown_out(&self, py: Python<'_>, set: bool, power_is_safe: bool) -> PyResult<Answer<BrownOut>> {
        if set && !power_is_safe {
            let text =
                "brown_out(set=True) asks whether the board's power is safe: add power_is_safe=True if it is";
            return Err(Failure::refused(text).into());
        }
        self.brown_out_of(py, set)
    }

    /// The profile of the board's actuator, as ``slipline profile``: the limits that the device itself keeps, for every program.
    /// ``profile`` of the result is ``None`` where it keeps none.
    fn profile(&self, py: Python<'_>) -> PyResult<Answer<Profile>> {
        Answer::of(py, self.call(py, profile_fields)?)
    }

    /// Stores a profile in the board's flash, as ``slipline profile write``: the text of its file, TOML. Press the board's user button
    /// and hold it meanwhile.
    ///
    /// Raises ``BadFile`` for the text, ``Refused`` if the button is not held.
    fn store_profile(&self, py: Python<'_>, text: &str) -> PyResult<Answer<Profile>> {
        check_length("the profile", text, profile_file::BYTES_MAX)?;
        let profile = profile_file::read(text).map_err(|error| Failure::bad_file("the profile", error))?;
        self.change_profile(py, Some(profile))
    }

    /// Erases the profile from the board's flash, as ``slipline profile erase``. Press the board's user button and hold it meanwhile.
    fn erase_profile(&self, py: Python<'_>) -> PyResult<Answer<Profile>> {
        self.change_profile(py, None)
    }

    /// Compares the device's codes with those that they should be, in four windows; arms the device, and disarms it then.
    ///
    /// Plays up to 16 tones. The result has the fields ``equal`` and ``windows``.
    #[pyo3(signature = (*, tones=16, window_s=0.25))]
    fn verify(&self, py: Python<'_>, tones: i64, window_s: f64) -> PyResult<Answer<Verification>> {
        let tones = count_in("tones", tones, Range::new(1.0, MAX_TONES as f64, ""))?;
        let tones = u8::try_from(tones).unwrap_or(u8::MAX);
        self.check_block("verify()")?;
        let (plate, consent) = (self.loaded()?.plate, lock(&self.state).consent);
        let verified = self.call(py, move |client| {
            let windows = verify_windows_s(f64::from(client.identity()?.sample_rate_hz));
            in_range("window_s", window_s, windows)?;
            may_be_armed(client, consent)?;
            client.disarm()?;
            Ok(fields(&client.verify(&plate, tones, window_s)?))
        })?;
        Answer::of(py, verified)
    }

    /// Tests the board by itself, as ``slipline selftest``, with its amplifier muted, and leaves it disarmed.
    ///
    /// ``sensor_wire``: a wire leads from the DAC's pin to the sensor's; ``trigger_wire``: one leads from the trigger output to the
    /// trigger input. ``amplifier_unplugged`` permits the steps that take the mute pin high, to time it and to make the board fail on
    /// purpose, and ``short`` takes three seconds, without the latter. The result has ``passed`` and ``steps``, each with ``verdict``: a
    /// step without its wire is ``"skipped"``.
    ///
    /// ``amplifier`` tests the amplifier instead, connected and switched on, by tones at -40 dB with it muted and then on: do this once
    /// all else has passed. The simulated device has one with ``sensor_m`` of :func:`slipline.connect`.
    #[pyo3(signature = (*, sensor_wire=false, trigger_wire=false, amplifier_unplugged=false, short=false, amplifier=false))]
    fn selftest(
        &self,
        py: Python<'_>,
        sensor_wire: bool,
        trigger_wire: bool,
        amplifier_unplugged: bool,
        short: bool,
        amplifier: bool,
    ) -> PyResult<Answer<Selftest>> {
        self.check_block("selftest()")?;
        if amplifier && (sensor_wire || trigger_wire || amplifier_unplugged) {
            let text = "selftest(amplifier=True) tests an amplifier that is connected, without wires: leave out the others";
            return Err(Failure::refused(text).into());
        }
        self.test_board(
            py,
            SelftestRequest {
                has_sensor_wire: sensor_wire,
                has_trigger_wire: trigger_wire,
                is_amplifier_unplugged: amplifier_unplugged,
                is_amplifier_on: amplifier,
                is_short: short,
                ..SelftestRequest::default()
            },
        )
    }

    /// What the device reports of itself: the fields of ``slipline info --json``.
    fn status(&self, py: Python<'_>) -> PyResult<Answer<Status>> {
        let port = self.port.clone();
        let info = self.call(py, move |client| {
            let snapshot = client.refreshed()?;
            Ok(fields(&DeviceInfo::of(&port, &snapshot)))
        })?;
        Answer::of(py, info)
    }

    /// Samples of the device's DAC per second.
    #[getter]
    fn sample_rate_hz(&self, py: Python<'_>) -> PyResult<u32> {
        self.call(py, |client| Ok(client.identity()?.sample_rate_hz))
    }

    /// The plate in use; ``None`` before :meth:`use`.
    #[getter]
    fn plate(&self) -> Option<PyPlate> {
        let loaded = lock(&self.state).loaded.clone()?;
        Some(PyPlate { plate: loaded.plate, responders: Arc::default() })
    }

    /// Opens the block without ``with``, as for a notebook: :meth:`close` leaves it.
    fn open(slf: Bound<'_, Self>) -> PyResult<Bound<'_, Self>> {
        Self::__enter__(slf)
    }

    /// Stops and disarms the device, and closes the connection, as the end of the block does. Nothing happens if it is closed.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self._close(py)
    }

    /// Whether the block has ended, and with it the connection.
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
        take_signal().map_or(Ok(()), Err)
    }

    /// The lines of the link's log that are new since the last call, each with its level of ``logging``.
    fn _log(&self) -> Vec<(u8, String)> {
        self.new_lines()
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
