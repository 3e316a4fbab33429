"""The result of a call."""

from __future__ import annotations

import sys
from typing import Any, ClassVar, TypeVar

from . import _shown


class Result:
    """The result of a call. Its attributes are the fields of the same command's ``--json``.

    Numbers are SI floats, series of numbers are numpy arrays, complex numbers are complex, and lists of objects are lists of
    results. What is unknown or does not apply is ``None``, and NaN in an array.
    """

    #: The classes of the results in it, by the names of their fields.
    _nested: ClassVar[dict[str, str]] = {}

    def __init__(self, fields: dict[str, Any]) -> None:
        """A result of these fields."""
        for name, value in fields.items():
            self.__dict__[name] = self._typed(name, value)

    def _typed(self, name: str, value: Any) -> Any:
        if isinstance(value, dict):
            kind = self._nested.get(name)
            return (getattr(sys.modules[type(self).__module__], kind) if kind else Result)(value)
        if isinstance(value, list):
            items = [self._typed(name, item) for item in value]
            return Results(items) if items and isinstance(items[0], Result) else items
        return value

    def _fields(self) -> dict[str, Any]:
        return self.__dict__

    def __repr__(self) -> str:
        return _shown.text(self)

    def _repr_html_(self) -> str:
        return _shown.table(self.__dict__)

    def to_dict(self) -> dict[str, Any]:
        """The fields as plain data that ``json`` writes: arrays are lists, complex numbers ``{"re", "im"}``, NaN and infinity
        ``None``."""
        plain: dict[str, Any] = _shown.plain(self.__dict__)
        return plain

    def to_xarray(self) -> Any:
        """The arrays as an ``xarray.Dataset`` over ``position_m`` and, of several frequencies, ``frequency_hz``, each with ``units`` and
        ``long_name``; the numbers and texts are its attributes. Needs xarray: ``pip install slipline[xarray]``."""
        from .dataset import dataset

        return dataset(self.__dict__)

    def to_pandas(self, name: str | None = None) -> Any:
        """A list of results in it as a ``pandas.DataFrame``, a row for each: that of the field ``name``, or its lights, tones or
        parameters; without any list its arrays, a column for each. Needs pandas."""
        return _shown.pandas(self.__dict__, name)

    def plot(self, axes: Any = None) -> Any:
        """Draws a field, a simulated envelope, a drive table, the lights of a check, or what was measured for a calibration beside its
        model with matplotlib, into ``axes`` or new ones, which it returns."""
        return _shown.plot(self.__dict__, axes)


R = TypeVar("R", bound=Result)


class Results(list[R]):
    """A list of results, which a notebook shows as a table with a row for each."""

    def _repr_html_(self) -> str:
        return _shown.list_table(self)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each result and a column for each field that is one value. Needs pandas."""
        return _shown.frame(self)
