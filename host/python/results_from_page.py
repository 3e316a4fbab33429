"""Makes slipline/results.py from host/JSON.md: python results_from_page.py [--check]

The page lists every field of every command with its unit and its meaning, and a test compares it with the commands. A result of the
package has the same fields; what differs is stated here.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from keyword import iskeyword
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "JSON.md"
TARGET = HERE / "slipline" / "results.py"

#: The class of each command's answer: its section of the page, the list in it whose items are the results, and its first line.
CLASSES = {
    "Field": ("respond", "", "The field at one frequency; of several frequencies each number is an array of them."),
    "Table": ("table", "", "A drive table, its knots as arrays."),
    "Simulation": ("simulate", "", "A simulated drive: the fields of the first tone, and of all."),
    "Check": ("check", "", "The lights of a plate."),
    "Design": ("design", "", "A plate for a material and a band."),
    "Merit": ("merit", "turning_points[].", "Figures of merit of one boundary."),
    "Texture": ("texture", "", "A texture of tones."),
    "Calibration": ("calibrate", "", "A plate with its numbers fitted."),
    "Drive": ("drive", "", "A drive, as far as it is known when it begins."),
    "Verification": ("verify", "", "The device's codes beside those that they should be."),
    "Selftest": ("selftest", "", "The report of a board's self-test."),
    "Status": ("info", "", "What a device reports of itself."),
    "Harmonics": ("measure --harmonics", "", "The measured harmonics of a drive."),
    "Trim": ("trim", "", "The wave speed of a calibrated plate, measured once and then again and again."),
    "Sweep": ("sweep", "", "A sweep for a separate recorder."),
    "BrownOut": ("board", "", "The level of a board's brown-out reset."),
    "Profile": ("profile", "", "The profile of a board's actuator."),
    "PortInfo": ("ports", "ports[].", "A port of this computer."),
}
#: Fields of a command that a result lacks.
LEFT_OUT = {
    "": ("schema", "files[]"),
    "Drive": ("clipped_samples", "driven_s", "ended_by", "feeling", "hold", "port", "stopped_at_samples"),
    "Texture": ("read",),
    "Verification": ("port",),
    "Selftest": ("date", "port"),
    "Calibration": ("read",),
    "Status": ("defaults",),
}
#: Fields that a result has instead or besides: type and meaning.
OWN = {
    "Status": {"faults": ("list[str]", "Latched faults, by their names")},
    "Design": {"plate": ("Plate", "The plate")},
    "Calibration": {
        "plate": ("Plate | None", "The calibrated plate; None where it is not accepted"),
        "measurements": ("list[Measurement]", "What it was fitted to; none by touches"),
    },
    "Harmonics": {
        "plate": ("Plate", "The measured plate, which states these harmonics"),
        "warnings": ("list[str]", "What was not measured, as sentences"),
    },
    "Trim": {"plate": ("Plate", "The plate of the latest wave speed")},
    "Drive": {
        "at_samples": ("int | None", "Sample index at which it begins; None while it waits for the trigger, and for one that never begins"),
        "superseded": ("bool", "Whether a newer drive or a stop took its place before the device had accepted it"),
    },
}
#: Fields that are None where they do not apply, although the page does not say so.
OR_NONE = {
    "Calibration": ("by", "caution", "chi2_per_n", "turning_point_per_place"),
    "Check": ("turning_point_m",),
    "Design": ("caution",),
    "Trim": ("caution",),
    "FieldTwoDimensions": ("level_db", "one_mode_reflection", "reflection"),
    "Simulation": (
        "felt",
        "felt_edge_by_person_m",
        "measured_felt_edge_by_person_m",
        "measured_felt_edge_m",
        "measured_felt_edge_of_all_by_person_m",
        "measured_turning_point_m",
        "peak_amplitude_m",
        "sensitivity_at_m",
    ),
    "SimulationTone": (
        "felt",
        "felt_edge_by_person_m",
        "measured_felt_edge_by_person_m",
        "measured_felt_edge_m",
        "measured_turning_point_m",
        "peak_amplitude_m",
    ),
    "SimulationTwoDimensions": ("level_db",),
    "Texture": (
        "contrast_db",
        "felt_edge_by_person_m",
        "flutter_db",
        "flutter_hz",
        "flutter_largest_db",
        "flutter_largest_m",
        "position_m",
        "rms_error",
        "rms_m",
        "wanted_rms_m",
        "worst_ripple_db",
        "worst_rms_error",
    ),
    "TextureChord": ("contrast_db",),
    "TextureReach": ("contrast_db", "largest_square_error"),
}
#: Objects that every such result has; others are None where they do not apply.
ALWAYS = {"ActuatorProfile": ("coil",), "Drive": ("table",), "Simulation": ("feeling",), "Status": ("counters",), "Trim": ("begin",)}
#: Fields that the command leaves out where they do not apply; of a result they are None then.
ABSENT = {"Field": ("two_dimensions",), "Simulation": ("two_dimensions",), "SimulationTone": ("two_dimensions",), "CheckLimit": ("at_least", "at_most")}
#: The results whose numbers are arrays where several are requested.
SERIES = ("Field",)


@dataclass
class Node:
    """A field, or an object with fields."""

    unit: str = ""
    meaning: str = ""
    is_list: bool = False
    fields: dict[str, Node] = field(default_factory=dict)


def sections() -> dict[str, Node]:
    """The fields of each command."""
    found: dict[str, Node] = {}
    node = None
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if heading := re.match(r"## (?:`slipline ([a-z]+(?: --harmonics)?)`$)?", line):
            node = found.setdefault(heading[1], Node()) if heading[1] else None
        elif node is not None and (row := re.match(r"\| `([^`]+)` \| (.+?) \| (.+) \|$", line)):
            insert(node, row[1], row[2], row[3])
    return found


def insert(node: Node, path: str, unit: str, meaning: str) -> None:
    name, _, rest = path.partition(".")
    child = node.fields.setdefault(name.removesuffix("[]"), Node())
    child.is_list |= name.endswith("[]")
    if rest:
        insert(child, rest, unit, meaning)
    else:
        child.unit, child.meaning = unit.replace("`", "``"), meaning.replace("`", "``")


def scalar(node: Node) -> str:
    kinds = {"text": "str", "true or false": "bool", "count": "int", "samples": "int", "cycles": "int"}
    return kinds.get(node.unit, "float")


def singular(name: str) -> str:
    """The name of one of a list: stretches, tones."""
    words = "".join(word.capitalize() for word in name.split("_"))
    if words.endswith("ches"):
        return words.removesuffix("es")
    return words.removesuffix("s") if words.endswith("s") and not words.endswith("ss") else words


class Writer:
    def __init__(self) -> None:
        self.classes: dict[str, str] = {}
        self.shapes: dict[str, str] = {}

    def class_of(self, name: str, node: Node, doc: str, top: str) -> str:
        """The name of the class of an object; one with the same fields is used again."""
        lines, nested = [], []
        shape = repr(node)
        if shape in self.shapes:
            return self.shapes[shape]
        for key, child in node.fields.items():
            kind, inner = self.type_of(name, key, child, top)
            meaning, unit = child.meaning, child.unit
            if key in OWN.get(name, {}):
                kind, meaning = OWN[name][key]
                inner, unit = None, "text"
            if inner:
                nested.append(f'"{key}": "{inner}"')
            if iskeyword(key):
                lines.append(f"    # {key}: {kind}, by getattr(): {child.meaning}.")
                continue
            if key in ALWAYS.get(name, ()):
                kind = kind.removesuffix(" | None")
            if key in OR_NONE.get(name, ()) and not kind.endswith("None"):
                kind += " | None"
            lines.append(f"    {key}: {kind}" + (" = None" if key in ABSENT.get(name, ()) else ""))
            in_unit = "" if scalar(child) in ("str", "bool") or unit in ("text", "count", "1", "") else f"; {unit}"
            if meaning:
                text = meaning.replace("null", "None") + in_unit
                lines.append(f'    """{text}."""')
        for key, (kind, meaning) in OWN.get(name, {}).items():
            if key not in node.fields:
                lines += [f"    {key}: {kind}", f'    """{meaning}."""']
        body = "\n".join(lines)
        kept = f"    _nested = {{{', '.join(nested)}}}\n\n" if nested else ""
        self.classes[name] = f'class {name}(Result):\n    """{doc}"""\n\n{kept}{body}\n'
        self.shapes[shape] = name
        return name

    def type_of(self, owner: str, key: str, node: Node, top: str) -> tuple[str, str | None]:
        """The annotation of a field, and the class of the results in it."""
        is_unknown = "null" in node.meaning
        if set(node.fields) == {"re", "im"}:
            return ("NDArray[np.complex128]" if node.is_list else "complex", None)
        if node.fields:
            usual = {"lights": "Light", "check": "Check", "profile": "ActuatorProfile", "tones": f"{top}Tone"}
            own = top + (singular(key) if node.is_list else "".join(word.capitalize() for word in key.split("_")))
            doc = f"One of ``{key}`` of a result." if node.is_list else f"``{key}`` of a result."
            inner = self.class_of(usual.get(key, own), node, doc, top)
            return (f"Results[{inner}]" if node.is_list else f"{inner} | None", inner)
        kind = scalar(node)
        if node.is_list:
            return ("list[str]" if kind == "str" else f"NDArray[np.{'float64' if kind == 'float' else 'int64' if kind == 'int' else 'bool_'}]", None)
        if top in SERIES and kind in ("float", "int", "bool") and key not in ("paper_mode",):
            return (f"{kind} | NDArray[np.{'bool_' if kind == 'bool' else 'float64'}]" + (" | None" if is_unknown else ""), None)
        return (kind + (" | None" if is_unknown or owner == "Status" else ""), None)


def text() -> str:
    page = sections()
    writer = Writer()
    for name, (section, prefix, doc) in CLASSES.items():
        node = page[section]
        if prefix:
            node = node.fields[prefix.removesuffix("[].")]
            node = Node(fields=node.fields)
        if name == "Table":
            knots = node.fields.pop("knots")
            for key, child in knots.fields.items():
                node.fields[key] = Node(child.unit, child.meaning, is_list=True)
        for key in (*LEFT_OUT[""], *LEFT_OUT.get(name, ())):
            node.fields.pop(key.removesuffix("[]"), None)
        node.fields = dict(sorted(node.fields.items()))
        writer.class_of(name, node, doc, name)
    head = '''"""The results of the package's calls: one class for each, made from host/JSON.md by results_from_page.py.

A field is the one of the same name of the command's ``--json``. Numbers are SI floats, and a name ends in its unit. What is unknown is
None, and NaN in an array.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ._result import Result, Results
from ._slipline import Measurement, Plate

'''
    names = sorted([*writer.classes, "Result", "Results"])
    listed = "__all__ = [\n" + "".join(f'    "{name}",\n' for name in names) + "]\n"
    return head + listed + "\n\n" + "\n\n".join(writer.classes.values())


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit(0 if TARGET.read_text(encoding="utf-8") == text() else "results.py is not that of JSON.md: run results_from_page.py")
    TARGET.write_text(text(), encoding="utf-8")
