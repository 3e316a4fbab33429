"""A result as a text, as HTML of a notebook, as plain data, as a table of pandas and as a picture."""

from __future__ import annotations

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
    if hasattr(value, "to_toml"):
        return value.to_toml()
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

    arrays = {name: value for name, value in fields.items() if isinstance(value, np.ndarray) and value.ndim == 1}
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
    """Draws an envelope, the lights of a check, or a table of drive; returns the axes of matplotlib."""
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots(layout="constrained")[1]
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
                label = f"{frequencies[row]:.5g} Hz" if frequencies.size == np.atleast_2d(series).shape[0] else None
                axes.plot(1e3 * position_m, np.abs(values), label=label)
            axes.set(xlabel="place / mm", ylabel=name, title=fields.get("plate"))
            return axes
    raise ValueError("plot() draws a field, a simulated envelope, a drive table, and the lights of a check")
