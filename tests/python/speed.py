"""Speed of many fields: Python beside Rust, scipy's banded solver, and two threads beside one; of studies: two processors beside one.

    python tests/python/speed.py RUST_PROGRAM
    python tests/python/speed.py study [local]      # 10 000 plates by threads; 100 000 by Dask's processes

A plate keeps its grids from call to call; the program in Rust makes them in each run. RUST_PROGRAM is the example `oracle` of
slipline-plate, built for release, as the package is.
"""

import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
from scipy.linalg import solve_banded

import slipline

POINTS, FREQUENCIES, RUNS = 2000, 64, 60
# Rounds of two threads beside one: enough to hide the start of a thread.
CALLS = 16


def best(call):
    """The shortest of several runs, seconds."""
    call()
    times = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return min(times)


def banded(frequencies_hz):
    """As many tridiagonal systems of as many complex unknowns."""
    bands = np.ones((3, POINTS), complex)
    right = np.zeros(POINTS, complex)
    right[0] = 1.0
    for hz in frequencies_hz:
        bands[1] = -2.0 + 1e-9 * hz - 1e-6j
        solve_banded((1, 1), bands, right, check_finite=False)


def calls(plate, frequencies_hz, count):
    """Begins a thread that makes this number of calls."""

    def respond():
        for _ in range(count):
            plate.respond(frequencies_hz, points=POINTS)

    thread = threading.Thread(target=respond)
    thread.start()
    return thread


def in_threads(plate, frequencies_hz, count):
    """All calls, distributed over this number of threads."""
    threads = [calls(plate, frequencies_hz, CALLS // count) for _ in range(count)]
    for thread in threads:
        thread.join()


STUDY = {
    "plate": "membrane",
    "seed": 7,
    "turning_point_m": [0.12, 0.18, 0.24],
    "vary": {
        "model.wave_speed_m_per_s": {"normal": 0.01},
        "loss_factor": {"log_normal": 0.3},
        "taper.rate_per_m": {"uniform": 0.02},
    },
}


def study(address):
    """A study by one and by two processors, of which each begins where all that is imported later is imported already."""
    times = {}
    for processors in (1, 2, 1, 2):
        os.sched_setaffinity(0, range(processors))
        for count in (100, 100_000 if address else 10_000):
            with tempfile.TemporaryDirectory() as folder:
                begin, begin_here = time.perf_counter(), time.process_time()
                slipline.study.run({**STUDY, "count": count}, address, store=f"{folder}/study.zarr")
                time_s, here_s = time.perf_counter() - begin, time.process_time() - begin_here
        known = times.get(processors, (time_s, here_s))
        times[processors] = tuple(map(min, known, (time_s, here_s)))
    (one, one_here), (two, two_here) = times[1], times[2]
    print(f"study             {one:7.2f} s   by one processor, {two:.2f} s by two: {one / two:.2f} times as fast (aim 1.6)")
    if not address:
        print(f"processor's time  {one_here:7.2f} s   by one, {two_here:.2f} s by two: {two_here / one_here:.2f} times as much (aim 1.1)")


def main():
    if sys.argv[1:2] == ["study"]:
        return study(*sys.argv[2:] or [None])
    plate = slipline.Plate("membrane")
    frequencies_hz = np.linspace(*plate.band_hz, FREQUENCIES)
    python = best(lambda: plate.respond(frequencies_hz, points=POINTS))
    one, two = (best(lambda: in_threads(plate, frequencies_hz, count)) / CALLS for count in (1, 2))
    scipy = best(lambda: banded(frequencies_hz))
    print(f"{FREQUENCIES} fields of {POINTS} points, the best of {RUNS} runs")
    print(f"Python            {1e3 * python:7.2f} ms")
    print(f"two threads       {1e3 * two:7.2f} ms  {one / two:.2f} times as fast as one (aim 1.7)")
    print(f"scipy, unrefined  {1e3 * scipy:7.2f} ms  {scipy / python:.2f} times Python's time")
    if sys.argv[1:]:
        arguments = [sys.argv[1], "respond_many", "membrane", str(POINTS), str(FREQUENCIES), str(RUNS)]
        rust = float(subprocess.run(arguments, check=True, capture_output=True, text=True).stdout)
        print(f"Rust              {1e3 * rust:7.2f} ms  Python takes {python / rust:.2f} times as long (aim 1.15)")


if __name__ == "__main__":
    main()
