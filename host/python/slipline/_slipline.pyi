"""
The compiled part of the package `slipline`.
"""

from _typeshed import Incomplete
from collections.abc import Coroutine, Iterator, Sequence
from numpy.typing import ArrayLike
from os import PathLike
from slipline._rest import Rest
from slipline.results import BrownOut, Calibration, Check, Design, Drive, Field, Harmonics, Merit, PortInfo, Profile, Result, Results, Selftest, Simulation, Status, Sweep, Table, Texture, Trim, Verification
from typing import Any, Final, SupportsFloat, SupportsIndex, final

__all__ = ["VERSION", "Device", "Measurement", "Plate", "_Study", "_find_numpy", "connect", "design", "ports", "presets"]

VERSION: Final[str]

@final
class Device:
    """
    A connected device.

    It is driven inside a ``with`` block, and is stopped and disarmed when the block is left, by whatever way: its end, an
    exception, Ctrl-C. Any call renews ``unattended_s``: after so long without one the device is stopped and disarmed, and the
    next call raises :class:`slipline.Unattended`. ``time.sleep`` and a debugger's prompt are no calls. Where no Python code
    can run at all, as in C code that keeps the interpreter's lock, the drive ends within a second.

    Any thread may call it, also while another waits: each call has its own answer, a newer drive supersedes one that the device
    has not accepted yet, and a stop or a disarm ends the waits and measurements of other threads.
    """
    def __enter__(self, /) -> Device: ...
    def __exit__(self, /, _kind: type | None, _error: Any | None, _trace: Any | None) -> None: ...
    def __repr__(self, /) -> str: ...
    def _close(self, /) -> None:
        """
        Stops and disarms the device, and closes the connection; then raises what a signal has raised meanwhile.
        """
    def _log(self, /) -> list[tuple[int, str]]:
        """
        The lines of the link's log that are new since the last call, each with its level of ``logging``.
        """
    def _sign(self, /) -> bool:
        """
        Gives a sign of life, and ends what nobody attends to any more. Returns whether a further sign is due.
        """
    def _wait(self, /, at_samples: SupportsIndex | Result | None, seconds: SupportsFloat | SupportsIndex | None, timeout: SupportsFloat | SupportsIndex | None, is_cancelled: Any) -> int:
        """
        As :meth:`wait`; ends when `is_cancelled` returns true.
        """
    def arm(self, /, *, despite_brown_out_level: bool = False, despite_no_profile: bool = False) -> None:
        """
        Unmutes the amplifier and accepts drives; only inside the block.

        A board without a brown-out level, or without a profile of its actuator, is armed only where the user accepts that.
        """
    def brown_out(self, /, *, set: bool = False, power_is_safe: bool = False) -> BrownOut:
        """
        The level of the board's brown-out reset, as ``slipline board brown-out``; with ``set``, the board writes the level that it needs
        into its chip's option bytes, once, and restarts: press its user button and hold it meanwhile.

        If the power fails meanwhile some chips erase their program, so ``set`` needs ``power_is_safe``. The result has ``written``, and
        the level as it was read back after the restart. Raises ``Refused`` if the button is not held.
        """
    def clear_faults(self, /) -> None:
        """
        Clears the latched faults whose causes are gone. The device is disarmed then: call :meth:`arm`.

        Raises ``Fault`` with those whose causes stand.
        """
    def close(self, /) -> None:
        """
        Stops and disarms the device, and closes the connection, as the end of the block does. Nothing happens if it is closed.
        """
    @property
    def closed(self, /) -> bool:
        """
        Whether the block has ended, and with it the connection.
        """
    def disarm(self, /) -> None:
        """
        Ramps to silence and mutes the amplifier; returns when it is silent.
        """
    def drive(self, /, *, felt_edge_m: SupportsFloat | SupportsIndex | None = None, turning_point_m: SupportsFloat | SupportsIndex | None = None, frequency_hz: SupportsFloat | SupportsIndex | None = None, level: SupportsFloat | SupportsIndex = 0.8, tones: Any | None = None, glide_s: SupportsFloat | SupportsIndex = 0.02, at: SupportsIndex | str | None = None, cancel_harmonics: bool = False) -> Drive:
        """
        Plays tones, to which those that sound glide.

        One place, and a dictionary of a place and a ``level`` for each further one of ``tones``. ``glide_s``: 5 ms to 10 s.
        ``at``: ``None`` for now, a sample index, or ``"trigger"`` for the rise of the trigger input; ``at_samples`` of the
        result is then ``None`` until :meth:`wait` has seen it begin. An index is rounded up to a block of 128 samples. The device
        has room for one change ahead: this call waits until an earlier one for an index has begun, and until its own index is
        less than a minute ahead.

        ``cancel_harmonics`` plays companions at twice and three times the frequency of each tone, opposite to the harmonics of the drive
        that the plate states: up to five tones, which begin in silence and do not glide. Of several tones the sums of their
        frequencies stay.

        Where a newer drive or a stop of another thread takes its place before the device has accepted it, ``superseded`` of the
        result is true, and ``at_samples`` is ``None``.
        """
    def emergency_stop(self, /) -> int:
        """
        Ramps to silence within 2 ms, mutes the amplifier and latches a fault, from any thread; returns the sample index at which
        the ramp begins. Then :meth:`clear_faults`, and :meth:`arm`.
        """
    def erase_profile(self, /) -> Profile:
        """
        Erases the profile from the board's flash, as ``slipline profile erase``. Press the board's user button and hold it meanwhile.
        """
    def hold(self, /, max_rise_db: SupportsFloat | SupportsIndex = 12.0, *, timeout: SupportsFloat | SupportsIndex | None = None) -> None:
        """
        Holds the tones that sound at the level that the sensor measures now, whatever a finger absorbs, until the next drive.

        Leave the plate untouched until it returns. ``max_rise_db``: the largest rise of a tone, 0 to 20 dB. Raises
        ``TimeoutError`` after ``timeout`` seconds.
        """
    def measure(self, /, place_m: SupportsFloat | SupportsIndex | None = None, kind: str = "displacement", input: str = "sensor", *, points: SupportsIndex | None = None, low_hz: SupportsFloat | SupportsIndex | None = None, high_hz: SupportsFloat | SupportsIndex | None = None, level: SupportsFloat | SupportsIndex | None = None, sweep: bool = False, amplifier_v: SupportsFloat | SupportsIndex | None = None, coil_ohm: SupportsFloat | SupportsIndex | None = None, piezo_f: SupportsFloat | SupportsIndex | None = None, shunt_a: SupportsFloat | SupportsIndex | None = None, amplifier_bandwidth_hz: SupportsFloat | SupportsIndex | None = None, filter_bandwidth_hz: SupportsFloat | SupportsIndex | None = None, sensor_mass_kg: SupportsFloat | SupportsIndex = 0.0, sensor_width_m: SupportsFloat | SupportsIndex = 0.0) -> Measurement:
        """
        Measures the response of the sensor at ``place_m`` to the device's tones; arms the device, and disarms it then, also where
        it fails or another thread stops it.

        ``kind``: what the sensor measures; ``input``: ``"sensor"``, or ``"current"`` of the drive, which has no place. ``points``
        frequencies lie from ``low_hz`` to ``high_hz``; ``level`` is 0 to 1; ``sweep`` plays a gliding tone. By the drive circuit,
        the amplifier's volts and the shunt's amperes at full scale and the coil's resistance or the piezo's capacitance, quiet tones
        check that the drive is on; ``amplifier_bandwidth_hz`` and ``filter_bandwidth_hz``, each of second order, bound the images that
        fold onto a measured current (a ``UserWarning`` where a piezo's may be more than 5 % wrong). ``sensor_mass_kg`` and
        ``sensor_width_m`` are those of a sensor that stands on the plate; the sensor of the simulated device has none.
        """
    def measure_harmonics(self, /, place_m: SupportsFloat | SupportsIndex, kind: str = "displacement", *, points: SupportsIndex = 8, level: SupportsFloat | SupportsIndex = 0.5, sensor_mass_kg: SupportsFloat | SupportsIndex = 0.0, sensor_width_m: SupportsFloat | SupportsIndex = 0.0) -> Harmonics:
        """
        Measures the second and third harmonic that the drive adds to tones, as ``slipline measure --harmonics``, by a sensor at
        ``place_m`` near the driven end; arms the device, and disarms it then.

        ``points``, 2 to 64, fundamentals lie over the plate's span, at ``level`` (0.001 to 1) of the table's full scale. The result has
        ``plate``, the plate in use with these harmonics, and ``harmonics``, the second and the third. Give it to :meth:`use`, and
        ``drive(cancel_harmonics=True)`` plays tones that cancel them.
        """
    def open(self, /) -> Device:
        """
        Opens the block without ``with``, as for a notebook: :meth:`close` leaves it.
        """
    @property
    def plate(self, /) -> Plate | None:
        """
        The plate in use; ``None`` before :meth:`use`.
        """
    def play(self, /, texture: Result, *, glide_s: SupportsFloat | SupportsIndex = 0.02, at: SupportsIndex | str | None = None) -> Drive:
        """
        Plays a texture of the plate in use: the result of ``plate.texture()``.
        """
    def profile(self, /) -> Profile:
        """
        The profile of the board's actuator, as ``slipline profile``: the limits that the device itself keeps, for every program.
        ``profile`` of the result is ``None`` where it keeps none.
        """
    def reconnect(self, /) -> None:
        """
        Connects again after a lost link, and gives the device the table of the plate in use. It is disarmed then.

        An open connection is stopped, disarmed and closed first. Raises ``LinkLost`` where no device answers.
        """
    def rest(self, /) -> Rest:
        """
        Disarms the device for a break of any length: a disarmed device needs no call.

        The result's ``go_on()`` arms the device as the latest :meth:`arm` did. In ``with device.rest():`` the end of the block does so.
        """
    @property
    def sample_rate_hz(self, /) -> int:
        """
        Samples of the device's DAC per second.
        """
    def selftest(self, /, *, sensor_wire: bool = False, trigger_wire: bool = False, amplifier_unplugged: bool = False, short: bool = False, amplifier: bool = False) -> Selftest:
        """
        Tests the board by itself, as ``slipline selftest``, with its amplifier muted, and leaves it disarmed.

        ``sensor_wire``: a wire leads from the DAC's pin to the sensor's; ``trigger_wire``: one leads from the trigger output to the
        trigger input. ``amplifier_unplugged`` permits the steps that take the mute pin high, to time it and to make the board fail on
        purpose, and ``short`` takes three seconds, without the latter. The result has ``passed`` and ``steps``, each with ``verdict``: a
        step without its wire is ``"skipped"``.

        ``amplifier`` tests the amplifier instead, connected and switched on, by tones at -40 dB with it muted and then on: do this once
        all else has passed. The simulated device has one with ``sensor_m`` of :func:`slipline.connect`.
        """
    def sequence(self, /, drives: Any, *, timeout: SupportsFloat | SupportsIndex | None = None) -> list[Drive]:
        """
        Plays drives, each from its sample index on, and returns their results when the last one is accepted.

        ``drives`` is a sequence of dictionaries: ``at``, and the other keywords of :meth:`drive` but ``cancel_harmonics``; one without tones ends what
        sounds. Each is sent when the one before has begun, some milliseconds later: those that follow each other more closely are
        refused as late, and the device is stopped. A stop or a drive of another thread ends the sequence; the drives that it has
        kept from being sent are ``superseded``.
        """
    def status(self, /) -> Status:
        """
        What the device reports of itself: the fields of ``slipline info --json``.
        """
    def stop(self, /, *, at: SupportsIndex | None = None, glide_s: SupportsFloat | SupportsIndex = 0.02) -> int:
        """
        Ramps to silence, from any thread; returns the sample index at which the ramp begins. The device stays armed.

        Without ``at`` the ramp begins now and takes 30 ms. ``at``, a sample index, is rounded up to a block of 128 samples; the
        tones fade from there on for ``glide_s``, 5 ms to 10 s. If it has passed, the ramp begins now: the returned index says so.
        It is one change ahead, as a drive for an index, and the next drive waits until it has begun.
        """
    def store_profile(self, /, text: str) -> Profile:
        """
        Stores a profile in the board's flash, as ``slipline profile write``: the text of its file, TOML. Press the board's user button
        and hold it meanwhile.

        Raises ``BadFile`` for the text, ``Refused`` if the button is not held.
        """
    def sweep(self, /, path: str | PathLike[str], *, duration_s: SupportsFloat | SupportsIndex = 4.0, points: SupportsIndex | None = None, low_hz: SupportsFloat | SupportsIndex | None = None, high_hz: SupportsFloat | SupportsIndex | None = None, level: SupportsFloat | SupportsIndex = 0.5) -> Sweep:
        """
        Plays a sweep twice for a separate recorder, as ``slipline sweep``, and writes its description into the file ``path``, which
        :meth:`Measurement.read` needs as ``played`` with each recording; arms the device, and disarms it then.

        ``duration_s`` is that of one sweep, up to 10 s; the shortest one follows from the band, 0.55 s on ``membrane``. ``level`` is that
        of the first sweep, the second one has half of it. An existing file is replaced.
        """
    def trim(self, /, place_m: SupportsFloat | SupportsIndex, kind: str = "displacement", *, duration_s: SupportsFloat | SupportsIndex | None = None, points: SupportsIndex | None = None, low_hz: SupportsFloat | SupportsIndex | None = None, high_hz: SupportsFloat | SupportsIndex | None = None, level: SupportsFloat | SupportsIndex = 0.5, sweep: bool = False) -> Trim:
        """
        Measures the wave speed of the calibrated plate in use by one sensor, as ``slipline trim``, and with ``duration_s`` (up to a
        day) again and again for this time; arms the device, and disarms it then.

        The result has ``plate``, that of the latest speed, and ``begin`` and each of ``later`` with ``wave_speed_share`` and its 95 %
        interval. The other arguments are those of :meth:`measure`. Raises ``Refused`` for a plate without a calibration, and where one
        speed does not explain what was measured.
        """
    def use(self, /, plate: Plate) -> None:
        """
        Makes the device hold the table of this plate, unless it holds it already.
        """
    def verify(self, /, *, tones: SupportsIndex = 16, window_s: SupportsFloat | SupportsIndex = 0.25) -> Verification:
        """
        Compares the device's codes with those that they should be, in four windows; arms the device, and disarms it then.

        Plays up to 16 tones. The result has the fields ``equal`` and ``windows``.
        """
    def wait(self, /, at_samples: SupportsIndex | Result | None = None, *, seconds: SupportsFloat | SupportsIndex | None = None, timeout: SupportsFloat | SupportsIndex | None = None) -> int:
        """
        Waits until the device is at a sample index, until a drive has begun, or for ``seconds`` by the device's clock; returns
        the index at which the wait has ended.

        Of a drive that waits for the trigger it is the index at which it began, which its ``at_samples`` then has, too. A stop or
        a disarm of another thread ends the wait at once. Raises what stops the device meanwhile, and ``TimeoutError`` after
        ``timeout`` seconds by this computer's clock.
        """
    def wait_async(self, /, at_samples: SupportsIndex | Result | None = None, *, seconds: SupportsFloat | SupportsIndex | None = None, timeout: SupportsFloat | SupportsIndex | None = None) -> Coroutine[Any, Any, int]:
        """
        As :meth:`wait`, awaited in ``asyncio``: other tasks run meanwhile, and the task can be cancelled.
        """
    def watch(self, /, period_s: SupportsFloat | SupportsIndex = 0.1) -> Iterator[Status]:
        """
        Iterates over the device's status, the fields of :meth:`status`, every ``period_s`` (0.01 to 60 s) until the block is
        left. Each step is a call, which renews ``unattended_s``.
        """

@final
class Measurement:
    """
    The response of a sensor at one place of a plate, over frequency.

    The response is the sensor's signal over the DAC's amplitude: the signal is ``Re(response e^(-j omega t))`` for a code
    of ``cos(omega t)``.
    """
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self, /) -> tuple: ...
    def __repr__(self, /) -> str: ...
    @property
    def frequency_hz(self, /) -> Incomplete:
        """
        Frequencies, Hz, rising: an array of shape (points,), as are the others.
        """
    @classmethod
    def from_arrays(cls, /, frequency_hz: ArrayLike, response: ArrayLike, *, place_m: SupportsFloat | SupportsIndex, sensor: str = "displacement", noise: ArrayLike | None = None, snr_db: SupportsFloat | SupportsIndex | None = None, unit_per_response: SupportsFloat | SupportsIndex | None = None, sample_rate_hz: SupportsFloat | SupportsIndex | None = None, place_tolerance_m: SupportsFloat | SupportsIndex | None = None, headroom_db: ArrayLike | None = None, sensor_mass_kg: SupportsFloat | SupportsIndex = 0.0, sensor_width_m: SupportsFloat | SupportsIndex = 0.0) -> Measurement:
        """
        A measurement of arrays: complex ``response`` at rising ``frequency_hz``, 8 to 10 000 of them.

        ``response`` is the sensor's signal over the DAC's amplitude, see the class; of an instrument that uses ``e^(+j omega t)`` it
        is the complex conjugate. ``place_m`` is the sensor's place, ``sensor`` what it measures. The noise is the standard deviation
        of the real and of the imaginary part, a number or a series, ``noise``, or ``snr_db`` below the RMS of the responses.
        ``sample_rate_hz`` is that of a DAC with a zero-order hold. ``sensor_mass_kg`` (to 0.1, within a fifth) and
        ``sensor_width_m`` are those of a sensor that stands on the plate and lessens the motion that it measures.

        Raises ``OutOfRange``.
        """
    @classmethod
    def from_csv(cls, /, text: str) -> Measurement:
        """
        The measurement of a text in this package's format.

        Raises ``BadFile``.
        """
    @property
    def headroom_db(self, /) -> Incomplete:
        """
        Headroom of the input below its full scale, dB; NaN where it is unknown.
        """
    @property
    def noise(self, /) -> Incomplete:
        """
        Standard deviation of the real part and of the imaginary part of each response.
        """
    @property
    def place_m(self, /) -> float:
        """
        The sensor's place, metres from the driven end.
        """
    @property
    def place_tolerance_m(self, /) -> float:
        """
        Standard deviation of that place from its mark, metres.
        """
    @classmethod
    def read(cls, /, path: str | PathLike[str], *, plate: Plate | None = None, place_m: SupportsFloat | SupportsIndex | None = None, kind: str | None = None, snr_db: SupportsFloat | SupportsIndex = ..., played: str | PathLike[str] | None = None, channel: SupportsIndex = 1, columns: str | None = None) -> Measurement:
        """
        Reads a measurement's file.

        One of this package is complete. One of another program (REW, .frd, a table, a universal file 58) and a recording of a
        sweep (WAV) need the ``plate`` and the sensor's ``place_m`` from the driven end; ``kind`` is displacement,
        velocity, acceleration or strain, ``snr_db`` the signal-to-noise ratio in dB of a file that states no noise. A recording
        needs ``played``, the description that ``slipline sweep`` wrote, and has the sensor in ``channel``, from 1. ``columns``
        says what the columns of a table are where their names are not clear: ``"frequency=1,level=3:dB,phase=4:rad"``. What
        was read of it is in ``source``.

        Raises ``BadFile`` with what is missing or wrong.
        """
    @property
    def response(self, /) -> Incomplete:
        """
        Complex responses.
        """
    @property
    def sample_rate_hz(self, /) -> float | None:
        """
        Sample rate of the DAC that played the tones, Hz; ``None`` for a source without a hold.
        """
    @property
    def sensor(self, /) -> str:
        """
        What the sensor measures: displacement, velocity, acceleration or strain.
        """
    @property
    def sensor_mass_kg(self, /) -> float:
        """
        Mass of the sensor, kg; 0 for one that does not touch the plate.
        """
    @property
    def sensor_width_m(self, /) -> float:
        """
        Side of the square on which a sensor with a mass stands, metres.
        """
    @property
    def source(self, /) -> str | None:
        """
        What was read of a file by another program: its rows, and what its columns were understood as; ``None`` for others. It
        is not kept in a file or a pickle.
        """
    def to_csv(self, /) -> str:
        """
        The text of its file.
        """
    def to_xarray(self, /) -> Any:
        """
        Its arrays as an ``xarray.Dataset`` over ``frequency_hz``, with ``units`` and ``long_name``; the rest are its attributes.
        Needs xarray: ``pip install slipline[xarray]``.
        """
    @property
    def unit_per_response(self, /) -> float | None:
        """
        Metres, m/s, m/s^2 or strain per unit of ``response``; ``None`` for an uncalibrated sensor.
        """
    def write(self, /, path: str | PathLike[str]) -> None:
        """
        Writes it into a file of this package's format, CSV; an existing file is replaced.
        """

@final
class Plate:
    """
    A plate: a preset by its name, or a TOML file of this format.

    Plates of the same content are equal; a plate can be pickled and used as a key.

    Raises ``BadFile`` if it is neither, ``OutOfRange`` for a number of the file that is not allowed.
    """
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self, /) -> int: ...
    def __new__(cls, /, name_or_path: str | PathLike[str]) -> Plate: ...
    def __reduce__(self, /) -> tuple: ...
    def __repr__(self, /) -> str: ...
    @property
    def band_hz(self, /) -> tuple[float, float]:
        """
        The frequencies of these two turning points, Hz.
        """
    def calibrate(self, /, measurements: Any, *, current: str | None = None, touch: Any | None = None, level: SupportsFloat | SupportsIndex | None = None, touch_tolerance_m: SupportsFloat | SupportsIndex | None = None, touched_drive: str | None = None, feeling: str | PathLike[str] | None = None, half_width_m: SupportsFloat | SupportsIndex | None = None, end_half_width_m: SupportsFloat | SupportsIndex | None = None, length_m: SupportsFloat | SupportsIndex | None = None, calipers_tolerance_m: SupportsFloat | SupportsIndex | None = None) -> Calibration:
        """
        The plate with its numbers fitted, as ``slipline calibrate``, by measurements of one sensor at two places or at one, by
        the drive's current, or by felt edges.

        ``measurements`` is a sequence of one to three ``Measurement`` (a third place is a check), or ``()`` with ``touch``.
        ``current`` is ``"coil"`` or ``"piezo"``: the measurement is that of the current. ``touch`` is a sequence of
        ``(asked_m, felt_m)``, with ``level``, ``touch_tolerance_m``, ``touched_drive`` (``"as-told"`` or ``"unknown"``) and
        ``feeling`` (a file). The calipers gave ``half_width_m``, ``end_half_width_m`` and ``length_m``, within
        ``calipers_tolerance_m``.

        ``.plate`` is the calibrated plate, or ``None`` where ``.accepted`` is false; then ``.reason`` says why.

        Raises ``OutOfRange``, ``Refused`` and ``BadFile``. After Ctrl-C the fit runs on in the background, and its
        result is dropped.
        """
    def check(self, /, *, felt_edge_m: SupportsFloat | SupportsIndex | None = None, turning_point_m: SupportsFloat | SupportsIndex | None = None, frequency_hz: SupportsFloat | SupportsIndex | None = None, level: SupportsFloat | SupportsIndex = 1.0, off_centre: bool = False, linear_share: SupportsFloat | SupportsIndex = 1.0) -> Check:
        """
        The lights of the plate, as ``slipline check``: at one place, or the worst over its span.

        ``level`` is that of the tone, 0 to 1 of the table's full scale; ``off_centre`` is a drive beside the centre line.
        ``linear_share`` is the share of full scale within which the output of a board's DAC is linear, 0.1 to 1: ``linear_share`` of
        :meth:`Device.status`.
        ``.worst`` is the worst colour; ``.lights`` is a list with ``name``, ``value``, ``unit``, ``colour`` and ``sentence``.

        Raises ``OutOfRange``; ``Refused`` if no tone of this level has this felt edge, or the plate has no table.
        """
    def frequency_hz(self, /, turning_point_m: ArrayLike) -> Any:
        """
        The frequency whose wave turns at ``turning_point_m``, Hz: a number, or an array for a series.

        Raises ``OutOfRange`` beyond the plate's span.
        """
    @classmethod
    def from_toml(cls, /, text: str) -> Plate:
        """
        The plate of a plate file's text.

        Raises ``BadFile``, or ``OutOfRange`` with the field of the file.
        """
    @property
    def length_m(self, /) -> float:
        """
        From the driven to the narrow end, metres.
        """
    def merit(self, /, *, turning_point_m: SupportsFloat | SupportsIndex | None = None) -> Results[Merit]:
        """
        Figures of merit, as ``slipline merit``: a list, of one boundary or of up to five over the span.

        Raises ``OutOfRange``; ``Refused`` if there is no room for an even area before any of them.
        """
    @property
    def name(self, /) -> str:
        """
        Name.
        """
    def replace(self, /, **numbers) -> Plate:
        """
        The plate with other numbers: ``plate.replace(loss_factor=0.02, taper={"rate_per_m": 4.1})``. Paths of the file are taken,
        too: ``plate.replace(**{"taper.rate_per_m": 4.1})``.

        Raises ``OutOfRange``; ``TypeError`` for a number that its file does not state.
        """
    def respond(self, /, frequency_hz: ArrayLike | None = None, *, turning_point_m: ArrayLike | None = None, felt_edge_m: ArrayLike | None = None, level: SupportsFloat | SupportsIndex = 0.8, points: SupportsIndex = 2001, finger: Sequence[float | str] | None = None, paper_mode: bool = False, two_dimensions: bool = False) -> Field:
        """
        The field at one frequency or at several, as ``slipline respond``: those of ``frequency_hz``, or of the tones with these
        turning points or felt edges; a felt edge is that of a tone of ``level``.

        ``points`` places, 8 to 200 001, lie from the driven to the narrow end. ``finger`` is ``(place_m, "light")``,
        ``(place_m, "firm")``, or ``(place_m, resistance_n_s_per_m, mass_kg, contact_m)``. ``paper_mode`` is the paper's equation;
        ``two_dimensions`` solves the whole plate, too. Of a sequence of n frequencies each number is an array of shape
        (n,), and ``amplitude`` one of shape (n, points).

        Raises ``OutOfRange``: ``frequency_hz`` goes from the cut-off at the wide end to four times the highest that turns on
        the plate, and a call takes up to 100 000 of them; ``MemoryError`` where the result has no room.
        """
    def simulate(self, /, *, felt_edge_m: ArrayLike | None = None, turning_point_m: ArrayLike | None = None, frequency_hz: ArrayLike | None = None, level: ArrayLike | None = None, actual_plate: Plate | str | PathLike[str] | None = None, duration_s: SupportsFloat | SupportsIndex | None = None, no_table: bool = False, sheet: bool = False, finger: Sequence[float | str] | None = None, feeling: str | PathLike[str] | None = None, setup: str | PathLike[str] | None = None) -> Simulation:
        """
        A drive through the whole signal chain and on the plate in time, as ``slipline simulate``.

        The tones are named by one of ``felt_edge_m``, ``turning_point_m`` and ``frequency_hz``: a number, or a sequence of up to
        16. ``level`` is 0 to 1, one for all or one for each; 0.8 by default. ``actual_plate`` is a ``Plate``, a name or
        ``"secret:SEED"``; ``duration_s`` is 0.01 to 600; ``no_table`` drives without the table's gains, ``sheet`` solves the sheet in
        two dimensions; ``finger`` is as for ``respond``, ``feeling`` a file, and ``setup`` a setup file, in the place of tones.

        The fields are those of the first tone and of all; ``.tones`` has those of each.

        Raises ``OutOfRange``; ``Refused`` if no tone of this level has this felt edge, or the sum of the tones is too large;
        ``BadFile``.
        """
    @property
    def span_m(self, /) -> tuple[float, float]:
        """
        The nearest and the farthest turning point, metres from the driven end.
        """
    def table(self, /, *, sample_rate_hz: SupportsFloat | SupportsIndex = 400e3, knots: SupportsIndex = 1025) -> Table:
        """
        The drive table, as ``slipline table``: its knots as the arrays ``position_m``, ``frequency_hz``, ``gain`` and
        ``peak_present``, its checksum ``crc`` and the rest.

        Raises ``OutOfRange`` for ``sample_rate_hz`` and for ``knots`` (2 to 1025); ``Refused`` if the plate has no table.
        """
    def texture(self, /, *, solid_m: SupportsFloat | SupportsIndex | None = None, profile: Any | None = None, image: str | PathLike[str] | None = None, stripes_m: SupportsFloat | SupportsIndex | None = None, beat: Any | None = None, tones: SupportsIndex = 16) -> Texture:
        """
        A texture, as ``slipline texture``; one of these is wanted:

        ``solid_m``: an even area to the place where the finger feels it end. ``profile``: two arrays, places in metres and the
        wanted RMS amplitude in any unit. ``image``: a PNG file, whose middle row is the profile. ``stripes_m``: the nodes of one
        tone, this far apart. ``beat``: ``(place_m, beat_hz)``. ``tones`` is the largest number of tones, 1 to 16.

        Raises ``OutOfRange``, ``Refused`` if the plate cannot have it, ``BadFile`` for the image.
        """
    def to_dict(self, /) -> Any:
        """
        The fields of its plate file as plain data.
        """
    def to_toml(self, /) -> str:
        """
        The text of its plate file.
        """
    def turning_point_m(self, /, frequency_hz: ArrayLike) -> Any:
        """
        The turning point of the wave of ``frequency_hz``, metres: a number, or an array for a series.

        Raises ``OutOfRange`` beyond the plate's band.
        """

@final
class _Study:
    """
    A study: the plates of a specification, each driven by the nominal plate's table.

    Raises ``OutOfRange`` and ``BadFile`` for the text; ``Refused`` if the nominal plate has no table, or no boundary at a place.
    """
    meanings: Final[list[str]]
    """
    The meaning of each number of a status, from 0.
    """
    def __new__(cls, /, text: str) -> _Study: ...
    @property
    def count(self, /) -> int:
        """
        Number of plates.
        """
    @property
    def is_2d(self, /) -> bool:
        """
        Whether each plate is solved in two dimensions.
        """
    @property
    def place_m(self, /) -> list[float]:
        """
        Its places, metres: turning points on the nominal plate.
        """
    def plate(self, /, i: SupportsIndex) -> Plate:
        """
        Plate ``i``, from 0.

        Raises ``OutOfRange`` if the study has no such plate; ``BadFile`` if the plate file refuses its numbers.
        """
    @property
    def results(self, /) -> list[tuple[str, str, str]]:
        """
        Its results, each with its unit and its meaning.
        """
    def run(self, /, first: SupportsIndex, end: SupportsIndex) -> tuple[Incomplete, Incomplete, list[Incomplete]]:
        """
        The plates ``first`` to ``end`` (excluded): ``status`` (plates,), the fields that vary (plates, fields), and of each result
        its numbers (plates, places). Other threads run meanwhile.
        """
    def to_toml(self, /) -> str:
        """
        Its specification, the same text for equal ones: with its whole plate.
        """
    @property
    def varied(self, /) -> list[tuple[str, str]]:
        """
        The variables of the fields that vary, each with the field's path in the plate file.
        """

def _find_numpy() -> None:
    """
    Finds NumPy's functions, as the first array would do: that ends in a panic where Ctrl-C comes just then. The package calls it
    while it is imported; a module's own initialisation would hide from its stubs what it holds.
    """

def connect(port: str = "sim", *, actual_plate: Plate | None = None, sensor_m: SupportsFloat | SupportsIndex | None = None, unattended_s: SupportsFloat | SupportsIndex = 60.0) -> Device:
    """
    Connects to a device: ``"sim"``, a serial port's name such as ``"/dev/ttyACM0"``, or ``"unix:PATH"``.

    Nothing is armed by it. ``actual_plate`` is the plate under the simulated device, ``sensor_m`` the place of the
    displacement sensor on it: without them it has no inputs. ``unattended_s``, 1 to 600: after so long without a call an armed
    device is stopped and disarmed.
    """

def design(material: str, thickness_m: SupportsFloat | SupportsIndex, band_hz: Any, length_m: SupportsFloat | SupportsIndex, *, edge: str | None = None, wave_speed_m_per_s: SupportsFloat | SupportsIndex | None = None, tension_n_per_m: SupportsFloat | SupportsIndex | None = None, shear: bool = False, air: str | None = None, thin: bool = False, start_margin_m: SupportsFloat | SupportsIndex | None = None, end_margin_m: SupportsFloat | SupportsIndex | None = None, loss_factor: SupportsFloat | SupportsIndex | None = None, full_scale_m: SupportsFloat | SupportsIndex | None = None, rim_m: SupportsFloat | SupportsIndex | None = None, name: str | None = None) -> Design:
    """
    A plate for a material and a band, as ``slipline design``.

    ``material`` is one of aluminium, steel, stainless-steel, brass, glass, fr4, acrylic, polycarbonate, polyester-film,
    silicone-rubber and latex; ``thickness_m`` is 1e-6 to 0.1, ``band_hz`` the lowest and the highest frequency of the tones,
    ``length_m`` 0.005 to 10. The wave is named by one of ``edge`` (``"supported"`` or ``"clamped"``), ``wave_speed_m_per_s``,
    ``tension_n_per_m`` and ``shear``; ``air`` is ``"bare-frame"``, ``"baffle"`` or ``"vacuum"``, and ``thin`` leaves out the
    plate's thickness in its bending.

    ``.plate`` is the plate; ``.check`` has its lights.

    Raises ``OutOfRange`` and ``Refused``.
    """

def ports() -> list[PortInfo]:
    """
    The ports of this computer at which a device can be, as ``slipline ports``: results with ``port``, ``label``, ``is_ours`` and
    ``usb_serial``.
    """

def presets() -> list[str]:
    """
    The names of the presets.
    """
