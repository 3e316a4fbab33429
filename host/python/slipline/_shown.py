"""A result as a text, as HTML of a notebook, as plain data, as a table of pandas and as a picture."""

from __future__ import annotations

import contextlib
import html
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._result import Result

#: Numbers that are shown of an array.
_SHOWN = 3
#: The colours of lights, on white and on dark paper.
_COLOURS = {"green": "#2e7d32", "amber": "#b26a00", "yellow": "#b26a00", "red": "#c62828"}


def text(result: Result) -> str:
    """The fields with their values: long arrays by their shape and first values, results in it by their class."""
    lines = [f"{name}={_value_text(value)}" for name, value in result._fields().items()]
    name = type(result).__name__
    one = f"{name}({', '.join(lines)})"
    return one if len(one) <= 100 else f"{name}(\n    " + ",\n    ".join(lines) + "\n)"


def _value_text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        first = ", ".join(_number(item) for item in value.ravel()[:_SHOWN])
        rest = ", .." if value.size > _SHOWN else ""
        return f"array{value.shape} [{first}{rest}]"
    if isinstance(value, list):
        return f"[{len(value)} {type(value[0]).__name__}]" if value and hasattr(value[0], "_fields") else repr(value)
    return f"<{type(value).__name__}>" if hasattr(value, "_fields") else _number(value)


def _number(value: Any) -> str:
    if isinstance(value, (float, complex, np.floating, np.complexfloating)):
        return f"{value:.6g}"
    return str(value) if isinstance(value, np.generic) else repr(value)


def plain(value: Any) -> Any:
    """Plain data that ``json`` writes: lists, complex numbers as ``{"re", "im"}``, and ``None`` for NaN and infinity."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, complex):
        return {"re": plain(value.real), "im": plain(value.imag)}
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "_fields"):
        return plain(value._fields())
    for to_text in ("to_toml", "to_csv"):
        if hasattr(value, to_text):
            return getattr(value, to_text)()
    return value


def rows(fields: dict[str, Any], name: str | None) -> list[Result]:
    """The list of results in these fields: the one of this name, or the only one."""
    lists = {key: value for key, value in fields.items() if isinstance(value, list) and value and hasattr(value[0], "_fields")}
    if name is None:
        for usual in ("lights", "tones", "parameters"):
            if usual in lists:
                name = usual
                break
        else:
            if len(lists) != 1:
                raise ValueError(f"the result has {len(lists)} lists of results: name one of {', '.join(lists) or 'none'}")
            (name,) = lists
    if name not in lists:
        raise ValueError(f"{name!r}: the result has the lists {', '.join(lists) or 'none'}")
    found: list[Result] = lists[name]
    return found


def frame(results: Sequence[Result]) -> Any:
    """A ``pandas.DataFrame`` with a row for each result and a column for each field that is one value."""
    import pandas  # type: ignore[import-untyped]

    data = [{name: item for name, item in one._fields().items() if np.ndim(item) == 0 and not hasattr(item, "_fields")} for one in results]
    return pandas.DataFrame(data)


def pandas(fields: dict[str, Any], name: str | None) -> Any:
    """A list of results as a table, or where there is none the arrays."""
    has_lists = any(isinstance(value, list) and value and hasattr(value[0], "_fields") for value in fields.values())
    return frame(rows(fields, name)) if has_lists or name else columns(fields)


def columns(fields: dict[str, Any]) -> Any:
    """A ``pandas.DataFrame`` of the arrays of one length, the commonest."""
    import pandas  # type: ignore[import-untyped]

    of_several = np.ndim(fields.get("amplitude", 0.0)) == 2
    # Of several frequencies a row is one of them, which has no place: as many places as frequencies would look like one each.
    kept = {name: value for name, value in fields.items() if not (of_several and name == "position_m")}
    arrays = {name: value for name, value in kept.items() if isinstance(value, np.ndarray) and value.ndim == 1}
    lengths = [value.size for value in arrays.values()]
    if not lengths:
        raise ValueError("the result has no arrays and no lists of results")
    length = max(set(lengths), key=lengths.count)
    return pandas.DataFrame({name: value for name, value in arrays.items() if value.size == length})


def table(fields: dict[str, Any]) -> str:
    """HTML: the lights with their colours, or the rows of a list, or the fields."""
    lists = [value for value in fields.values() if isinstance(value, list) and value and hasattr(value[0], "_fields")]
    if not lists:
        return _html([{"field": name, "value": _value_text(value)} for name, value in fields.items()])
    return list_table(rows(fields, None) if "lights" in fields or "tones" in fields else lists[0])


def list_table(results: Sequence[Result]) -> str:
    """HTML of a list of results: a row for each."""
    shown = [{name: item for name, item in one._fields().items() if np.ndim(item) == 0 and not hasattr(item, "_fields")} for one in results]
    return _html(shown)


def _html(data: list[dict[str, Any]]) -> str:
    names = list(dict.fromkeys(name for row in data for name in row))
    head = "".join(f"<th>{html.escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(_cell(name, row.get(name)) for name in names) + "</tr>" for row in data)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(name: str, value: Any) -> str:
    shown = "" if value is None else value if isinstance(value, str) else _number(value)
    colour = _COLOURS.get(str(value)) if name == "colour" else None
    style = f' style="color: white; background: {colour}"' if colour else ""
    return f"<td{style}>{html.escape(shown)}</td>"


def plot(fields: dict[str, Any], axes: Any) -> Any:
    """Draws an envelope, the lights of a check, a table of drive, or a calibration beside its model; returns the axes of matplotlib."""
    curves = model_curves(fields) if "measurements" in fields else None
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots(layout="constrained")[1]
    if curves is not None:
        for label, frequency_hz, measured_db, model_db in curves:
            (points,) = axes.plot(frequency_hz, measured_db, ".", label=f"measured, {label}")
            axes.plot(frequency_hz, model_db, color=points.get_color(), label="model")
        axes.set(xlabel="frequency / Hz", ylabel="level / dB", title=fields["plate"].name)
        axes.legend()
        return axes
    lights = fields.get("lights")
    if isinstance(lights, list) and lights:
        names = [light.name for light in lights]
        axes.barh(names, [1.0] * len(lights), color=[_COLOURS.get(str(light.colour), "#777777") for light in lights])
        for row, light in enumerate(lights):
            axes.text(0.02, row, "" if light.value is None else f"{light.value:.4g} {light.unit or ''}", va="center", color="white")
        axes.invert_yaxis()
        axes.set(xticks=[], title=fields.get("plate"))
        return axes
    position_m = fields.get("position_m")
    for name in ("amplitude", "rms_m", "envelope_m", "gain"):
        series = fields.get(name)
        if isinstance(position_m, np.ndarray) and isinstance(series, np.ndarray) and series.shape[-1] == position_m.size:
            frequencies = np.atleast_1d(np.asarray(fields.get("frequency_hz", np.nan), dtype=float))
            for row, values in enumerate(np.atleast_2d(series)):
                curve = f"{frequencies[row]:.5g} Hz" if frequencies.size == np.atleast_2d(series).shape[0] else None
                axes.plot(1e3 * position_m, np.abs(values), label=curve)
            axes.set(xlabel="place / mm", ylabel=name, title=fields.get("plate"))
            return axes
    raise ValueError("plot() draws a field, a simulated envelope, a drive table, the lights of a check, and a calibration")


def model_curves(fields: dict[str, Any]) -> list[tuple[str, Any, Any, Any]]:
    """Of a calibration: label, frequencies, and the measured and the modelled level in dB. Two places have one curve, the response at
    the second one over that at the first one, in which the drive has no part, and a third place as a check has none; one place has the response with the level of its
    model, because the response is in no unit."""
    plate, measurements = fields["plate"], fields["measurements"][:2]
    if plate is None or fields["by"] not in ("two places", "two places and a check", "one sensor"):
        raise ValueError("plot() draws an accepted calibration by one sensor, at two places or at one")
    if any(measured.sensor == "strain" for measured in measurements):
        raise ValueError("plot() draws no calibration by strain: its model has none")
    frequency_hz = measurements[0].frequency_hz
    both = [(measured.response, _model(plate, measured)) for measured in measurements]
    if len(both) == 2:
        near, far = measurements
        if not np.array_equal(near.frequency_hz, far.frequency_hz):
            raise ValueError("plot() draws two places that were measured at the same frequencies")
        ratios = (both[1][column] / both[0][column] for column in (0, 1))
        measured_db, model_db = (20 * np.log10(np.abs(ratio)) for ratio in ratios)
        return [(f"{1e3 * far.place_m:.0f} mm over {1e3 * near.place_m:.0f} mm", frequency_hz, measured_db, model_db)]
    measured_db, model_db = (20 * np.log10(np.abs(values)) for values in both[0])
    model_db = model_db + np.nanmedian(measured_db - model_db)
    return [(f"{1e3 * measurements[0].place_m:.0f} mm", frequency_hz, measured_db, model_db)]


def _model(plate: Any, measured: Any) -> Any:
    """The plate's response at the sensor, NaN where no wave enters."""
    from .errors import Error

    def at(frequency_hz: Any) -> Any:
        field = plate.respond(frequency_hz)
        return np.array([np.interp(measured.place_m, field.position_m, row) for row in np.atleast_2d(field.amplitude)])

    order = {"displacement": 0, "velocity": 1, "acceleration": 2}[measured.sensor]
    try:
        found = at(measured.frequency_hz)
    except Error:
        found = np.full(measured.frequency_hz.shape, np.nan, complex)
        for number, hz in enumerate(measured.frequency_hz):
            with contextlib.suppress(Error):
                found[number : number + 1] = at(hz)
    return found * measured.frequency_hz**order
