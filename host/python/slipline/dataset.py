"""A result as an ``xarray.Dataset``. Loaded where one is asked for: xarray is no dependency."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["dataset", "described", "of_measurement"]


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
    found = xarray.Dataset(variables, coords=coordinates, attrs=attributes)
    for key, variable in found.variables.items():
        variable.attrs.update(described(str(key)))
    return found


#: The ends of names that are units, the longest first.
_UNITS = {
    "_n_s_per_m": "N s m-1",
    "_m_per_s": "m s-1",
    "_per_m": "m-1",
    "_hz": "Hz",
    "_db": "dB",
    "_kg": "kg",
    "_samples": "samples",
    "_turns": "turns",
    "_m": "m",
    "_s": "s",
}


def described(name: str) -> dict[str, str]:
    """The attributes ``units`` and ``long_name`` of a field by its name, which ends in its unit; without one it is a share."""
    for end, unit in _UNITS.items():
        if name.endswith(end):
            return {"long_name": name.removesuffix(end).replace("_", " "), "units": unit}
    return {"long_name": name.replace("_", " "), "units": "1"}


def of_measurement(measurement: Any) -> Any:
    """A measurement over its frequencies."""
    import xarray

    attributes = {name: getattr(measurement, name) for name in ("place_m", "place_tolerance_m", "sensor")}
    for name in ("unit_per_response", "sample_rate_hz", "sensor_mass_kg", "sensor_width_m"):
        if getattr(measurement, name):
            attributes[name] = getattr(measurement, name)
    names = ("response", "noise", "headroom_db")
    found = xarray.Dataset(
        {name: (("frequency_hz",), getattr(measurement, name)) for name in names},
        coords={"frequency_hz": measurement.frequency_hz},
        attrs=attributes,
    )
    for key, variable in found.variables.items():
        variable.attrs.update(described(str(key)))
    return found
