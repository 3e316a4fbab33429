"""A result as an ``xarray.Dataset``. Loaded where one is asked for: xarray is no dependency."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["dataset"]


def dataset(fields: dict[str, Any]) -> Any:
    """The arrays of these fields over ``position_m``, or ``frequency_hz``, or both; numbers and texts as attributes.

    An array of any other length has a dimension of its own name. Results and lists of results are left out.
    """
    import xarray

    of_several = np.ndim(fields.get("amplitude", 0.0)) == 2
    positions = np.size(fields.get("position_m", ()))
    frequencies = np.size(fields["frequency_hz"]) if of_several else -1
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    attributes: dict[str, Any] = {}
    for name, value in fields.items():
        if isinstance(value, np.ndarray):
            if value.ndim == 2:
                variables[name] = (("frequency_hz", "position_m"), value)
            elif name == "position_m" or (name == "frequency_hz" and of_several):
                coordinates[name] = value
            elif of_several and value.size == frequencies:
                variables[name] = (("frequency_hz",), value)
            elif value.size == positions:
                variables[name] = (("position_m",), value)
            else:
                variables[name] = ((name + "_number",), value)
        elif isinstance(value, (bool, int, float, complex, str)):
            attributes[name] = value
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)
