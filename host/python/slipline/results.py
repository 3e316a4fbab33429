"""The results of the package's calls: one class for each, made from host/JSON.md by results_from_page.py.

A field is the one of the same name of the command's ``--json``. Numbers are SI floats, and a name ends in its unit. What is unknown is
None, and NaN in an array.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ._result import Result, Results
from ._slipline import Measurement, Plate

__all__ = [
    "ActuatorProfile",
    "BrownOut",
    "Calibration",
    "CalibrationBefore",
    "CalibrationParameter",
    "Check",
    "CheckAtLeast",
    "CheckLimit",
    "CheckStretch",
    "Design",
    "DesignDamper",
    "DesignFrame",
    "DesignHighest",
    "DesignLeadIn",
    "Drive",
    "DriveTable",
    "DriveTone",
    "Field",
    "FieldTwoDimensions",
    "Harmonics",
    "HarmonicsHarmonic",
    "Light",
    "Merit",
    "PortInfo",
    "Profile",
    "ProfileCoil",
    "ProfileTravel",
    "Result",
    "Results",
    "Selftest",
    "SelftestReading",
    "SelftestStep",
    "Simulation",
    "SimulationFeeling",
    "SimulationTone",
    "SimulationTwoDimensions",
    "Status",
    "StatusCounters",
    "StatusInputs",
    "StatusTable",
    "Sweep",
    "Table",
    "Texture",
    "TextureChord",
    "TextureReach",
    "TextureTone",
    "Trim",
    "TrimBegin",
    "TrimLater",
    "Verification",
    "VerificationWindow",
]


class FieldTwoDimensions(Result):
    """``two_dimensions`` of a result."""

    level_db: float | NDArray[np.float64] | None
    """Level of the peak in two dimensions over that of the one-mode equation; dB."""
    nodes: int | NDArray[np.float64]
    """Nodes before the peak."""
    one_mode_nodes: int | NDArray[np.float64]
    """The same by the one-mode equation."""
    one_mode_reflection: float | NDArray[np.float64] | None
    """The same by the one-mode equation."""
    peak_shift_m: float | NDArray[np.float64] | None
    """Place of the peak less that by the one-mode equation; None where one has none; m."""
    reflection: float | NDArray[np.float64] | None
    """Reflection at the driven end, in two dimensions."""


class Field(Result):
    """The field at one frequency; of several frequencies each number is an array of them."""

    _nested = {"two_dimensions": "FieldTwoDimensions"}

    amplitude: NDArray[np.complex128]
    edge_width_m: float | NDArray[np.float64]
    """From the peak to a tenth of its amplitude; m."""
    frequency_hz: float | NDArray[np.float64]
    """Frequency of the tone or of each answer; Hz."""
    paper_mode: bool
    """Whether the paper's equation was solved."""
    peak_amplitude: float | NDArray[np.float64] | None
    """Amplitude of the peak over that of the drive; None without a peak; times the drive."""
    peak_position_m: float | NDArray[np.float64] | None
    """Place of the peak; None without a peak; m."""
    peak_present: bool | NDArray[np.bool_]
    """Whether there is a peak."""
    plate: str
    """Name of the plate."""
    position_m: NDArray[np.float64]
    """Places along the plate, or the turning point of a knot; m."""
    turning_point_m: float | NDArray[np.float64]
    """Where the wave turns; m."""
    turning_width: str
    """Width by which the wave turns: arc or plain."""
    two_dimensions: FieldTwoDimensions | None = None


class Table(Result):
    """A drive table, its knots as arrays."""

    crc: str
    """CRC-32 of the table, eight hexadecimal digits."""
    frequency_hz: NDArray[np.float64]
    """Frequency of the tone or of each answer; Hz."""
    gain: NDArray[np.float64]
    """Gain of the tone at this knot."""
    knots_without_peak: int
    """Knots where loss leaves no peak."""
    lowered_by_travel_db: float | None
    """By how much the table is lower to keep the peak travel; None without a limit; dB."""
    peak_at_full_scale_m: float
    """Amplitude of the peak at level 1; m."""
    peak_present: NDArray[np.bool_]
    """Whether there is a peak."""
    plate: str
    """Name of the plate."""
    position_m: NDArray[np.float64]
    """Places along the plate, or the turning point of a knot; m."""
    sample_rate_hz: float
    """Sample rate; Hz."""
    sensitivity_at_m: float
    """Where the level is most sensitive; m."""
    sensitivity_db_per_percent: float
    """Change of the level per 1 % of wave speed; dB."""
    span_end_m: float
    """Farthest turning point of the table; m."""
    span_start_m: float
    """Nearest turning point of the table; m."""
    swing_without_gain_db: float
    """Swing of the level over the span without the gains; dB."""
    travel_over_peak_travel: float | None
    """Travel at level 1 over the peak travel; None without a limit."""
    worst_error_db: float
    """Largest error of the level between the knots; dB."""
    worst_shift_m: float
    """Largest shift of the peak between the knots; m."""


class SimulationFeeling(Result):
    """``feeling`` of a result."""

    contact_m: float
    """Length of the finger's contact; m."""
    friction_exponent: float
    """Exponent of the law of friction."""
    friction_residual: float
    """Friction that is left at large amplitudes, over the friction at rest."""
    friction_scale_m: float
    """Amplitude that lowers the friction noticeably; m."""
    # from: str, by getattr(): default, or the file of the feeling.
    least_friction_change: float
    """Least change of friction that is felt."""
    threshold: float
    """Threshold of the finger, over the usual one."""


class SimulationTwoDimensions(Result):
    """``two_dimensions`` of a result."""

    level_db: float | None
    """Level of the peak in two dimensions over that of the one-mode equation; dB."""
    nodes: int
    """Nodes before the peak."""
    one_mode_nodes: int
    """The same by the one-mode equation."""
    peak_shift_m: float | None
    """Place of the peak less that by the one-mode equation; None where one has none; m."""


class SimulationTone(Result):
    """One of ``tones`` of a result."""

    _nested = {"two_dimensions": "SimulationTwoDimensions"}

    actual_turning_point_m: float
    """Where the tone's wave turns on the actual plate; m."""
    amplitude: NDArray[np.complex128]
    edge_width_m: float
    """From the peak to a tenth of its amplitude; m."""
    felt: str | None
    """The felt edge as a sentence."""
    felt_edge_by_person_m: NDArray[np.float64] | None
    """Felt edge of a dull and of a keen finger; None where none is felt; m."""
    felt_edge_m: float | None
    """Where a finger feels the tone end, by its level alone; None where it does not; m."""
    frequency_hz: float
    """Frequency of the tone or of each answer; Hz."""
    level: float
    """Level of the tone, 0 to 1 of the table's full scale."""
    measured_amplitude_m: NDArray[np.float64]
    """Amplitude of the tone at each place, as simulated; m."""
    measured_felt_edge_by_person_m: NDArray[np.float64] | None
    """As ``felt_edge_by_person_m``, by the simulated field; m."""
    measured_felt_edge_m: float | None
    """As ``felt_edge_m``, by the simulated field; m."""
    measured_peak_amplitude_m: float | None
    """Amplitude of the peak, as simulated; None without a peak; m."""
    measured_peak_position_m: float | None
    """Place of the peak, as simulated; None without a peak; m."""
    measured_turning_point_m: float | None
    """Turning point by the simulated field; m."""
    peak_amplitude_m: float | None
    """Amplitude of the peak, as predicted; m."""
    peak_position_m: float | None
    """Place of the peak; None without a peak; m."""
    peak_present: bool
    """Whether there is a peak."""
    position_m: NDArray[np.float64]
    """Places along the plate, or the turning point of a knot; m."""
    turning_point_m: float
    """Where the wave turns; m."""
    two_dimensions: SimulationTwoDimensions | None = None


class Simulation(Result):
    """A simulated drive: the fields of the first tone, and of all."""

    _nested = {"feeling": "SimulationFeeling", "tones": "SimulationTone", "two_dimensions": "SimulationTwoDimensions"}

    actual_plate: str
    """Name of the plate on which the waves run."""
    actual_turning_point_m: float
    """Where the tone's wave turns on the actual plate; m."""
    amplitude: NDArray[np.complex128]
    chord_gain_db: float | None
    """How much louder the chord is than the sum of its tones allows; None where it is none; dB."""
    clipped_samples: int
    """Samples that were limited at the end of the DAC's range; samples."""
    edge_width_m: float
    """From the peak to a tenth of its amplitude; m."""
    feeling: SimulationFeeling
    felt: str | None
    """The felt edge as a sentence."""
    felt_edge_by_person_m: NDArray[np.float64] | None
    """Felt edge of a dull and of a keen finger; None where none is felt; m."""
    felt_edge_m: float | None
    """Where a finger feels the tone end, by its level alone; None where it does not; m."""
    frequency_hz: float
    """Frequency of the tone or of each answer; Hz."""
    has_table_gains: bool
    """Whether the table's gains were used."""
    level: float
    """Level of the tone, 0 to 1 of the table's full scale."""
    measured_amplitude_m: NDArray[np.float64]
    """Amplitude of the tone at each place, as simulated; m."""
    measured_felt_edge_by_person_m: NDArray[np.float64] | None
    """As ``felt_edge_by_person_m``, by the simulated field; m."""
    measured_felt_edge_m: float | None
    """As ``felt_edge_m``, by the simulated field; m."""
    measured_felt_edge_of_all_by_person_m: NDArray[np.float64] | None
    """As ``measured_felt_edge_by_person_m``, of all tones together; m."""
    measured_felt_edge_of_all_m: float | None
    """As ``measured_felt_edge_m``, of all tones together; None where a beat is too slow; m."""
    measured_peak_amplitude_m: float | None
    """Amplitude of the peak, as simulated; None without a peak; m."""
    measured_peak_position_m: float | None
    """Place of the peak, as simulated; None without a peak; m."""
    measured_s: float
    """Time at the end over which the field was measured; s."""
    measured_turning_point_m: float | None
    """Turning point by the simulated field; m."""
    peak_amplitude_m: float | None
    """Amplitude of the peak, as predicted; m."""
    peak_at_full_scale_m: float
    """Amplitude of the peak at level 1; m."""
    peak_position_m: float | None
    """Place of the peak; None without a peak; m."""
    peak_present: bool
    """Whether there is a peak."""
    plate: str
    """Name of the plate."""
    position_m: NDArray[np.float64]
    """Places along the plate, or the turning point of a knot; m."""
    sensitivity_at_m: float | None
    """Where the level is most sensitive; m."""
    sensitivity_db: float | None
    """Error of the table on the actual plate; None on its own plate; dB."""
    simulated_s: float
    """Time that was simulated; s."""
    slow_beat_hz: float | None
    """Beat that the measured time does not resolve; None if there is none; Hz."""
    tones: Results[SimulationTone]
    turning_point_m: float
    """Where the wave turns; m."""
    two_dimensions: SimulationTwoDimensions | None = None


class CheckAtLeast(Result):
    """``at_least`` of a result."""

    amber: float
    """Last value that is amber; unit of the light."""
    green: float
    """Last value that is green; unit of the light."""


class CheckLimit(Result):
    """``limit`` of a result."""

    _nested = {"at_least": "CheckAtLeast", "at_most": "CheckAtLeast"}

    at_least: CheckAtLeast | None = None
    at_most: CheckAtLeast | None = None


class CheckStretch(Result):
    """One of ``stretches`` of a result."""

    from_m: float
    """End of the stretch nearer the drive; m."""
    to_m: float
    """End of the stretch farther from the drive; m."""


class Light(Result):
    """One of ``lights`` of a result."""

    _nested = {"limit": "CheckLimit", "stretches": "CheckStretch"}

    colour: str
    """unchecked, green, amber or red."""
    high: float | None
    """Upper end of the 95 % interval; None where there is none; unit of ``value``."""
    limit: CheckLimit | None
    low: float | None
    """Lower end of the 95 % interval; None where there is none; unit of ``value``."""
    name: str
    """Name."""
    sentence: str
    """Meaning of the light, and a remedy."""
    stretches: Results[CheckStretch]
    turning_point_m: float
    """Where the wave turns; m."""
    unit: str
    """Unit of ``value``; empty for a pure number."""
    value: float | None
    """The number; None where there is none; in ``unit``, or SI."""


class Check(Result):
    """The lights of a plate."""

    _nested = {"lights": "Light"}

    band_hz: NDArray[np.float64]
    """Lowest and highest frequency of the check; Hz."""
    level_tolerance_db: float | None
    """Half of the 95 % interval of the level; None where no levels were measured; dB."""
    lights: Results[Light]
    plate: str
    """Name of the plate."""
    turning_point_m: float | None
    """Where the wave turns; m."""
    turning_point_tolerance_m: float | None
    """Half of the 95 % interval of turning points; None where unknown; m."""
    worst: str
    """The worst colour."""


class DesignLeadIn(Result):
    """``lead_in`` of a result."""

    end_resistance_n_s_per_m: float
    """Resistance at the far end of the lead-in; N s/m."""
    length_m: float
    """Length; m."""
    loss_factor: float
    """Loss factor."""


class DesignDamper(Result):
    """``damper`` of a result."""

    _nested = {"lead_in": "DesignLeadIn"}

    largest_reflection: float
    """Largest share of the returning wave that the end reflects."""
    lead_in: DesignLeadIn | None
    match_frequency_hz: float
    """Frequency at which the damper matches; Hz."""
    ratio_range: NDArray[np.float64]
    """Smallest and largest R/Z over the band."""
    resistance_n_s_per_m: float
    """Resistance of the damper; N s/m."""


class DesignFrame(Result):
    """``frame`` of a result."""

    first_bending_hz: float
    """First bending of the frame with free ends; Hz."""
    mass_kg: float
    """Mass of the frame, both sheets; kg."""
    material: str
    """Material of the frame."""
    over_threshold_db: float | None
    """Largest motion of the frame beyond the boundary over what a usual finger feels; None where unknown; dB."""
    sheet_m: float
    """Thickness of each of the frame's two sheets; m."""
    table_mass_kg: float
    """Mass of the table to which the frame must be screwed; 0 where it may lie free; kg."""


class DesignHighest(Result):
    """``highest`` of a result."""

    edge_width_m: float
    """From the peak to a tenth of its amplitude; m."""
    frequency_hz: float
    """Frequency of the tone or of each answer; Hz."""
    half_width_m: float
    """Half of the width, at the driven end or at this place; m."""
    loss_integral: float
    """Integral I of the loss: the wave arrives with exp(-I) of its amplitude."""
    turning_point_m: float
    """Where the wave turns; m."""
    wavelengths: float
    """Wavelengths from the driven end to the turning point."""


class Design(Result):
    """A plate for a material and a band."""

    _nested = {"check": "Check", "damper": "DesignDamper", "frame": "DesignFrame", "highest": "DesignHighest", "lowest": "DesignHighest"}

    caution: str | None
    """A caution that no measurement reveals and the user must check."""
    check: Check | None
    damper: DesignDamper | None
    end_half_width_m: float
    """Half of the width at the narrow end; m."""
    frame: DesignFrame | None
    half_width_m: float
    """Half of the width, at the driven end or at this place; m."""
    highest: DesignHighest | None
    loss_factor: float
    """Loss factor."""
    loss_factor_limit: float
    """Loss factor up to which the peak is the largest amplitude."""
    lowest: DesignHighest | None
    mode_free_travel_m: float
    """Travel without a second width mode, the drive on the centre line; m."""
    mounting: str
    """How the parts are mounted."""
    not_checked: str | None
    """Why the lights are missing; None if they are present."""
    plate: Plate
    """The plate."""
    rate_per_m: float
    """Rate d of the taper; 1/m."""
    single_turning_point_off_centre_to_m: float
    """Farthest turning point without a second one, the drive beside the centre line; m."""
    single_turning_point_to_m: float
    """Farthest turning point without a second one, the drive on the centre line; m."""
    tension_n_per_m: float | None
    """Tension per width; None for a plate that is not stretched; N/m."""
    toml: str
    """The plate file."""


class Merit(Result):
    """Figures of merit of one boundary."""

    bits_per_s: float | None
    """Rate at which a finger can tell places apart by the edge; None where unknown; bit/s."""
    contrast_db: float
    """Level before the edge over the level behind it; dB."""
    edge_width_m: float
    """From the peak to a tenth of its amplitude; m."""
    felt_contrast_db: float | None
    """The same ratio in sensation, with the drive's harmonics; None where the plate file states none; dB."""
    frequency_hz: float
    """Frequency of the tone or of each answer; Hz."""
    ripple_db: float | None
    """Ripple of the area; None where there is none; dB."""
    switching_time_s: float
    """Time in which the boundary moves; s."""
    turning_point_m: float
    """Where the wave turns; m."""
    two_point_m: float | None
    """Least distance of two boundaries that are felt apart; None where unknown; m."""


class TextureChord(Result):
    """``chord`` of a result."""

    base_frequency_hz: float
    """The tones of a chord are multiples of this frequency; Hz."""
    chord_gain_db: float | None
    """How much louder the chord is than the sum of its tones allows; None where it is none; dB."""
    contrast_db: float | None
    """Level before the edge over the level behind it; dB."""
    harmonics: NDArray[np.int64]
    """Multiples of the base frequency, one for each tone."""
    headroom_db: float
    """Level of the input below the end of its range; of a chord, above the sum of its tones; dB."""
    is_used: bool
    """Whether the chord is used."""
    ripple_db: float | None
    """Ripple of the area; None where there is none; dB."""
    rms_error: float
    """Error of the RMS amplitude, over its largest value."""


class TextureReach(Result):
    """``reach`` of a result."""

    contrast_db: float | None
    """Level before the edge over the level behind it; dB."""
    largest_square_error: float | None
    """Largest error of the square of the amplitude with any number of tones."""
    ripple_db: float | None
    """Ripple of the area; None where there is none; dB."""
    rms_error: float
    """Error of the RMS amplitude, over its largest value."""


class TextureTone(Result):
    """One of ``tones`` of a result."""

    felt: str
    """The felt edge as a sentence."""
    felt_edge_by_person_m: NDArray[np.float64]
    """Felt edge of a dull and of a keen finger; None where none is felt; m."""
    felt_edge_m: float | None
    """Where a finger feels the tone end, by its level alone; None where it does not; m."""
    frequency_hz: float
    """Frequency of the tone or of each answer; Hz."""
    level: float
    """Level of the tone, 0 to 1 of the table's full scale."""
    phase_turns: float
    """Phase of the tone; turns."""
    second_boundary_db: float | None
    """How far this harmonic is over the threshold there; negative where it is not felt, None without harmonics; dB."""
    second_boundary_felt_to_m: float | None
    """Where a finger feels this harmonic end; None where it does not end on the plate, is not felt, or without harmonics; m."""
    second_boundary_m: float | None
    """Turning point of the drive's harmonic that is felt most beyond the felt edge; None without harmonics in the plate file; m."""
    turning_point_m: float
    """Where the wave turns; m."""


class Texture(Result):
    """A texture of tones."""

    _nested = {"chord": "TextureChord", "reach": "TextureReach", "tones": "TextureTone"}

    chord: TextureChord | None
    contrast_db: float | None
    """Level before the edge over the level behind it; dB."""
    felt_edge_by_person_m: NDArray[np.float64] | None
    """Felt edge of a dull and of a keen finger; None where none is felt; m."""
    flutter_db: float | None
    """Swing of the RMS over 30 ms within a second, at the median place; dB."""
    flutter_hz: float | None
    """Frequency of this swing; Hz."""
    flutter_largest_db: float | None
    """Largest swing of the RMS over 30 ms in the area; dB."""
    flutter_largest_m: float | None
    """Place of that swing; m."""
    plate: str
    """Name of the plate."""
    position_m: NDArray[np.float64] | None
    """Places along the plate, or the turning point of a knot; m."""
    reach: TextureReach | None
    ripple_db: float | None
    """Ripple of the area; None where there is none; dB."""
    rms_error: float | None
    """Error of the RMS amplitude, over its largest value."""
    rms_m: NDArray[np.float64] | None
    """RMS amplitude at each place; m."""
    stripes_felt_db: float | None
    """Depth of the stripes under a contact, in the middle; None for others; dB."""
    stripes_m: float | None
    """Distance of the stripes in the middle; None for others; m."""
    tones: Results[TextureTone]
    wanted_rms_m: NDArray[np.float64] | None
    """The wanted RMS amplitude at each place; m."""
    worst_ripple_db: float | None
    """As ``ripple_db``, the worst within the tolerances; dB."""
    worst_rms_error: float | None
    """As ``rms_error``, the worst within the tolerances."""


class CalibrationBefore(Result):
    """``before`` of a result."""

    level_error_db: float | None
    """Largest error of the level by the file before; None where no levels were measured; dB."""
    turning_point_error_m: float
    """Largest error of turning points by the file before; m."""


class CalibrationParameter(Result):
    """One of ``parameters`` of a result."""

    high: float | None
    """Upper end of the 95 % interval; None where there is none; unit of ``value``."""
    low: float | None
    """Lower end of the 95 % interval; None where there is none; unit of ``value``."""
    name: str
    """Name."""
    value: float | None
    """The number; None where there is none; in ``unit``, or SI."""


class Calibration(Result):
    """A plate with its numbers fitted."""

    _nested = {"before": "CalibrationBefore", "parameters": "CalibrationParameter"}

    accepted: bool
    """Whether the calibration is accepted; if not, ``reason`` says why."""
    before: CalibrationBefore | None
    by: str | None
    """The way: two places, two places and a check, one sensor, current or touches."""
    caution: str | None
    """A caution that no measurement reveals and the user must check."""
    chi2_per_n: float | None
    """Square of the deviation per answer, in units of its noise."""
    felt_edge_tolerance_m: float | None
    """Half of the 95 % interval of the felt edge; None except by touches; m."""
    level_tolerance_db: float | None
    """Half of the 95 % interval of the level; None where no levels were measured; dB."""
    misfit: float | None
    """Error of the model that explains the deviation; None by touches."""
    parameters: Results[CalibrationParameter]
    plate: Plate | None
    """The calibrated plate; None where it is not accepted."""
    reason: str | None
    """Why the calibration is refused; None if it is accepted."""
    turning_point_per_place: NDArray[np.float64] | None
    """Shift of turning points per metre that a sensor is off its mark; m/m."""
    turning_point_tolerance_m: float | None
    """Half of the 95 % interval of turning points; None where unknown; m."""
    measurements: list[Measurement]
    """What it was fitted to; none by touches."""


class DriveTable(Result):
    """``table`` of a result."""

    crc: str
    """CRC-32 of the table, eight hexadecimal digits."""


class DriveTone(Result):
    """One of ``tones`` of a result."""

    felt: str
    """The felt edge as a sentence."""
    felt_edge_by_person_m: NDArray[np.float64]
    """Felt edge of a dull and of a keen finger; None where none is felt; m."""
    felt_edge_m: float | None
    """Where a finger feels the tone end, by its level alone; None where it does not; m."""
    frequency_hz: float
    """Frequency of the tone or of each answer; Hz."""
    level: float
    """Level of the tone, 0 to 1 of the table's full scale."""
    second_boundary_db: float | None
    """How far this harmonic is over the threshold there; negative where it is not felt, None without harmonics; dB."""
    second_boundary_felt_to_m: float | None
    """Where a finger feels this harmonic end; None where it does not end on the plate, is not felt, or without harmonics; m."""
    second_boundary_m: float | None
    """Turning point of the drive's harmonic that is felt most beyond the felt edge; None without harmonics in the plate file; m."""
    turning_point_m: float
    """Where the wave turns; m."""


class Drive(Result):
    """A drive, as far as it is known when it begins."""

    _nested = {"table": "DriveTable", "tones": "DriveTone"}

    at_samples: int | None
    """Sample index at which it begins; None while it waits for the trigger, and for one that never begins."""
    chord_gain_db: float | None
    """How much louder the chord is than the sum of its tones allows; None where it is none; dB."""
    plate: str
    """Name of the plate."""
    table: DriveTable
    tones: Results[DriveTone]
    superseded: bool
    """Whether a newer drive or a stop took its place before the device had accepted it."""


class VerificationWindow(Result):
    """One of ``windows`` of a result."""

    at_samples: int
    """Index of the first sample; samples."""
    device_crc: str | None
    """CRC-32 of the codes by the device; None if it gave none."""
    equal: bool
    """Whether the codes of device and mirror are equal."""
    mirror_crc: str
    """CRC-32 of the codes by the mirror."""
    samples: int
    """Number of samples."""
    stage: str
    """Kind of change within the window."""


class Verification(Result):
    """The device's codes beside those that they should be."""

    _nested = {"windows": "VerificationWindow"}

    equal: bool
    """Whether the codes of device and mirror are equal."""
    windows: Results[VerificationWindow]


class SelftestReading(Result):
    """One of ``readings`` of a result."""

    at_least: float | None
    """The lowest allowed number; None without such a limit; in ``value_unit``."""
    at_most: float | None
    """The highest allowed number; None without such a limit; in ``value_unit``."""
    quantity: str
    """What was measured."""
    value: float
    """The number; in ``value_unit``."""
    value_unit: str
    """Unit of ``value`` and of its limits; empty for a pure number or a count."""


class SelftestStep(Result):
    """One of ``steps`` of a result."""

    _nested = {"readings": "SelftestReading"}

    name: str
    """Name."""
    readings: Results[SelftestReading]
    sentence: str
    """What the result means; of a skipped step, what is missing."""
    verdict: str
    """green, amber, red, or skipped where the step is not shown."""


class Selftest(Result):
    """The report of a board's self-test."""

    _nested = {"steps": "SelftestStep"}

    board: str
    """The board."""
    build: str
    """The firmware's build."""
    codes_crc: str | None
    """CRC-32 over the digests of the compared codes, eight hexadecimal digits; None where none were compared."""
    firmware: str
    """Version of the firmware."""
    image_sha256: str | None
    """SHA-256 of the image of this build, 64 hexadecimal digits; None where the program does not hold it."""
    passed: bool
    """Whether no step is red."""
    short: bool
    """Whether it was a short test."""
    simulated: bool
    """Whether the device is simulated."""
    steps: Results[SelftestStep]
    unit: str
    """Number of this device."""
    wires: list[str]
    """The wires that were fitted, as --wire takes them."""


class StatusCounters(Result):
    """``counters`` of a result."""

    clipped_samples: int
    """Samples that were limited at the end of the DAC's range; samples."""
    crc_errors: int
    """Frames with a wrong checksum."""
    dropped: int
    """Frames that did not fit."""
    duplicates: int
    """Commands that came twice."""
    frames: int
    """Frames received."""
    max_cycles: int
    """Cycles of the longest block."""
    overlong: int
    """Frames that were too long."""
    underruns: int
    """Blocks that came too late."""


class StatusInputs(Result):
    """``inputs`` of a result."""

    count: int
    """Number of inputs."""
    delay_s: float
    """Delay of the inputs behind the DAC; s."""
    lock_ins: int
    """Lock-ins of the inputs."""
    lost_blocks: int
    """Blocks of the inputs that were lost."""


class StatusTable(Result):
    """``table`` of a result."""

    crc: str
    """CRC-32 of the table, eight hexadecimal digits."""
    knot_count: int
    """Knots of the table."""
    sample_rate_hz: float
    """Sample rate; Hz."""
    span_end_m: float
    """Farthest turning point of the table; m."""
    span_start_m: float
    """Nearest turning point of the table; m."""


class Status(Result):
    """What a device reports of itself."""

    _nested = {"counters": "StatusCounters", "inputs": "StatusInputs", "table": "StatusTable"}

    block_samples: int | None
    """Samples of a block; samples."""
    board: str | None
    """The board."""
    brown_out_guarded: bool | None
    """Whether the brown-out level is set; None for an older device."""
    build: str | None
    """The firmware's build."""
    compatibility: str | None
    """How the versions of device and program agree."""
    core_hz: float | None
    """Clock of the device's processor; None where it is not reported; Hz."""
    counters: StatusCounters
    crash: str | None
    """Record of the last crash; None if there is none."""
    dac_bits: int | None
    """Bits of the DAC."""
    dead_man_s: float | None
    """Silence of the host after which the device stops; s."""
    faults: list[str]
    """Latched faults, by their names."""
    firmware: str | None
    """Version of the firmware."""
    flash_erasures: int | None
    """Erasures of the flash so far."""
    flash_erasures_promised: int | None
    """Erasures that its maker promises."""
    heat: float | None
    """Estimated heat of the actuator, over its limit."""
    inputs: StatusInputs | None
    linear_share: float | None
    """Share of full scale within which the DAC's output is linear; None where it is not reported."""
    max_knots: int | None
    """Most knots of a table."""
    max_tones: int | None
    """Most tones at once."""
    mute_resistor: str | None
    """State of the mute resistor."""
    now_samples: int | None
    """Index of the device's present sample; samples."""
    port: str | None
    """The port, as --port takes it."""
    profile_erasures: int | None
    """Erasures of the flash of the actuator's profile so far."""
    profile_erasures_promised: int | None
    """Erasures of it that its maker promises."""
    profile_name: str | None
    """Name of the actuator's profile; None if the device keeps none."""
    protocol: str | None
    """Version of the device's protocol."""
    reference_v: float | None
    """Reference voltage of DAC and ADC; None where it is not measured; V."""
    reset: str | None
    """Cause of the device's last reset."""
    round_trip_s: float | None
    """Mean round trip of a frame; s."""
    sample_rate_hz: float | None
    """Sample rate; Hz."""
    simulated: bool | None
    """Whether the device is simulated."""
    state: str | None
    """State of the device."""
    stop_input: str | None
    """State of the stop input."""
    stored: str | None
    """Content of the device's flash."""
    stores_left: int | None
    """Tables that may be stored or forgotten in flash now."""
    table: StatusTable | None
    trigger_input: bool | None
    """Whether the device has a trigger input; None where it is not reported."""
    unit: str | None
    """Number of this device."""
    user_button: str | None
    """State of the user button."""
    worst_block: float | None
    """Time of the longest block over its limit."""


class HarmonicsHarmonic(Result):
    """One of ``harmonics`` of a result."""

    frequency_hz: NDArray[np.float64]
    """Frequency of the tone or of each answer; Hz."""
    lead_deg: NDArray[np.float64]
    """By how much the harmonic leads ``order`` times the fundamental's phase; degrees."""
    order: int
    """Frequency of the harmonic over that of its tone."""
    ratio_db: NDArray[np.float64]
    """Harmonic of the drive over its fundamental; dB."""
    ratio_noise: float
    """Largest standard deviation of the harmonic over its fundamental, by the noise of the input."""
    unclear: int
    """Frequencies at which the sensor does not receive the harmonic's frequency clearly, which are left out."""


class Harmonics(Result):
    """The measured harmonics of a drive."""

    _nested = {"harmonics": "HarmonicsHarmonic"}

    harmonic_level: float
    """Level of the tones at which the harmonics were measured, over the table's full scale."""
    harmonics: Results[HarmonicsHarmonic]
    kind: str | None
    """What the sensor measures: displacement, velocity, acceleration or strain; None of a current."""
    place_m: float
    """Place of the sensor; m."""
    plate: Plate
    """The measured plate, which states these harmonics."""
    toml: str
    """The plate file."""
    warnings: list[str]
    """What was not measured, as sentences."""


class TrimBegin(Result):
    """``begin`` of a result."""

    chi2_per_n: float
    """Square of the deviation per answer, in units of its noise."""
    high: float
    """Upper end of the 95 % interval of the wave speed."""
    low: float
    """Lower end of the 95 % interval of the wave speed."""
    wave_speed_share: float
    """Wave speed over that of the file."""


class TrimLater(Result):
    """One of ``later`` of a result."""

    after_s: float
    """Time since the first measurement; s."""
    chi2_per_n: float
    """Square of the deviation per answer, in units of its noise."""
    high: float
    """Upper end of the 95 % interval of the wave speed."""
    low: float
    """Lower end of the 95 % interval of the wave speed."""
    wave_speed_share: float
    """Wave speed over that of the file."""


class Trim(Result):
    """The wave speed of a calibrated plate, measured once and then again and again."""

    _nested = {"begin": "TrimBegin", "later": "TrimLater"}

    begin: TrimBegin
    caution: str | None
    """A caution that no measurement reveals and the user must check."""
    ended_by: str
    """time, stop or input (of --stdin), or the signal that ended it."""
    later: Results[TrimLater]
    place_m: float
    """Place of the sensor; m."""
    plate: Plate
    """The plate of the latest wave speed."""
    turning_point_error_m: float
    """Largest error of turning points by the file before; m."""


class Sweep(Result):
    """A sweep for a separate recorder."""

    apart_s: float
    """From the beginning of the first sweep to that of the second; s."""
    first_hz: float
    """Frequency at the beginning of the sweep; Hz."""
    last_hz: float
    """Frequency at the end of the sweep; Hz."""
    levels: NDArray[np.float64]
    """Levels of the two sweeps, 0 to 1 of full scale."""
    plate: str
    """Name of the plate."""
    played_s: float
    """Time of both sweeps with the silence between them; s."""
    sample_rate_hz: float
    """Sample rate; Hz."""
    sweep_s: float
    """Time of one sweep; s."""


class BrownOut(Result):
    """The level of a board's brown-out reset."""

    brown_out_guarded: bool | None
    """Whether the brown-out level is set; None for an older device."""
    brown_out_level: int
    """Level of the brown-out reset, counted from the lowest threshold."""
    brown_out_level_needed: int
    """Lowest level that guards the board."""
    option_bytes: str
    """The chip's register of option bytes that holds the level, eight hexadecimal digits."""
    written: bool
    """Whether the level was written, and compared after the restart."""


class ProfileCoil(Result):
    """``coil`` of a result."""

    body_s: float
    """Time constant of the coil's body; s."""
    full_sine: float
    """Heat of a sine at full scale, over the limit."""
    winding_s: float
    """Time constant of the coil's winding; s."""


class ProfileTravel(Result):
    """``travel`` of a result."""

    quality: float
    """Quality factor of the actuator's resonance."""
    resonance_hz: float
    """Resonance of the actuator; Hz."""
    static_travel: float
    """Static travel at full scale, over the peak travel."""


class ActuatorProfile(Result):
    """``profile`` of a result."""

    _nested = {"coil": "ProfileCoil", "travel": "ProfileTravel"}

    coil: ProfileCoil
    longest_drive_s: float
    """Longest drive without a command; s."""
    max_rise_db: float
    """Largest rise of a held tone; dB."""
    max_sum: float
    """Largest sum of the tones, over full scale."""
    name: str
    """Name."""
    stop_input: bool
    """Whether the board's stop input is used."""
    travel: ProfileTravel | None


class Profile(Result):
    """The profile of a board's actuator."""

    _nested = {"profile": "ActuatorProfile"}

    profile: ActuatorProfile | None
    stored: str
    """Content of the device's flash."""


class PortInfo(Result):
    """A port of this computer."""

    is_ours: bool
    """Whether it is known to be a Slipline device."""
    label: str
    """The port in words."""
    port: str
    """The port, as --port takes it."""
    usb_serial: str | None
    """Serial number at USB; None without one."""
