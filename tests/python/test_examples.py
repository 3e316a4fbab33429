"""The examples of the package run as their first lines say."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "host/python/examples"

#: The arguments of each example, and what its output has.
RUNS = {
    "envelope": (["picture.png"], "written: picture.png"),
    "trials": (["subject", "12"], "12 trials: felt at 16"),
    "measure_and_calibrate": (["fitted.toml"], "written: fitted.toml; the turning points are known to 0."),
    "lsl_markers": (["subject"], "3 markers sent"),
    "robust_taper": (["robust.toml", "2"], "written: robust.toml"),
    "tolerances": (["study.zarr", "200"], "200 plates; share of each field"),
}


def test_every_example_is_run_here() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(RUNS)


@pytest.mark.parametrize("name", RUNS)
def test_an_example_runs(name: str, tmp_path: Path) -> None:
    needs = {"lsl_markers": "pylsl", "robust_taper": "cma"}.get(name)
    if needs and importlib.util.find_spec(needs) is None:
        pytest.skip(f"no {needs} here")
    arguments, words = RUNS[name]
    line = [sys.executable, str(EXAMPLES / f"{name}.py"), *arguments]
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(line, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert words in done.stdout
    assert (tmp_path / arguments[0]).exists()
    if name == "robust_taper":
        before, after = (float(done.stdout.split(f"{word} ")[1].split(",")[0].split(";")[0]) for word in ("before", "after"))
        assert after < before
    if name == "tolerances":
        # By the physics: the place follows the rate of the taper, and the loss has nearly no part in it.
        rows = [line.split() for line in done.stdout.splitlines()[2:]]
        loss, speed, rate, r_squared = ([float(row[column]) for row in rows] for column in (1, 3, 5, 7))
        assert min(r_squared) > 0.99 and max(loss) < 0.1 and min(rate) + min(speed) > 50
