"""The 2-D wave equation, 5-point leapfrog in f32, on NumPy, numba and Devito.

The problem of every engine, `speed.rs` included: `cells` x `rows` cells inside fixed edges, started from rest in the
shape of the lowest mode, v+ = 2 v - v- + C (left + right + above + below - 4 v) with C = 0.25.

Each function returns (million cells per second, value at the middle after `steps` steps).
"""

import time

import numba
import numpy as np

C = np.float32(0.25)


def shape(cells, rows):
    """The lowest mode, with its border of zeros."""
    x = np.sin(np.pi * np.arange(cells + 2) / (cells + 1))
    z = np.sin(np.pi * np.arange(rows + 2) / (rows + 1))
    field = np.outer(z, x).astype(np.float32)
    field[0, :] = field[-1, :] = field[:, 0] = field[:, -1] = 0.0
    return field


def middle(field, cells, rows):
    return float(field[1 + rows // 2, 1 + cells // 2])


def speed(cells, rows, steps, seconds):
    return cells * rows * steps / seconds / 1e6


def best(run, runs):
    """The shortest of `runs` runs, seconds."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def on_numpy(cells, rows, steps, runs):
    now, past, work = shape(cells, rows), shape(cells, rows), np.empty((rows, cells), np.float32)

    def run(now, past, count):
        for _ in range(count):
            v = now[1:-1, 1:-1]
            np.add(now[1:-1, :-2], now[1:-1, 2:], out=work)
            np.add(work, now[:-2, 1:-1], out=work)
            np.add(work, now[2:, 1:-1], out=work)
            np.multiply(work, C, out=work)
            inner = past[1:-1, 1:-1]
            np.subtract(work, inner, out=inner)
            np.multiply(v, np.float32(2) - 4 * C, out=work)
            np.add(inner, work, out=inner)
            now, past = past, now
        return now, past

    now, past = run(now, past, steps)
    check = middle(now, cells, rows)
    # NumPy is slow and steady: fewer steps per timed run do.
    count = max(2, steps // 10)
    return speed(cells, rows, count, best(lambda: run(now, past, count), runs)), check


def _steps(now, past, steps):
    rows, cells = now.shape
    own = np.float32(2) - np.float32(4) * C
    for _ in range(steps):
        for j in range(1, rows - 1):
            for i in range(1, cells - 1):
                past[j, i] = (
                    own * now[j, i]
                    - past[j, i]
                    + C * (now[j, i - 1] + now[j, i + 1] + now[j - 1, i] + now[j + 1, i])
                )
        now, past = past, now
    return now, past


def _steps_parallel(now, past, steps):
    rows, cells = now.shape
    own = np.float32(2) - np.float32(4) * C
    for _ in range(steps):
        for j in numba.prange(1, rows - 1):
            for i in range(1, cells - 1):
                past[j, i] = (
                    own * now[j, i]
                    - past[j, i]
                    + C * (now[j, i - 1] + now[j, i + 1] + now[j - 1, i] + now[j + 1, i])
                )
        now, past = past, now
    return now, past


_numba_one = numba.njit(fastmath=True)(_steps)
_numba_parallel = numba.njit(fastmath=True, parallel=True)(_steps_parallel)


def on_numba(cells, rows, steps, runs, threads=1):
    kernel = _numba_one if threads == 1 else _numba_parallel
    numba.set_num_threads(min(threads, numba.config.NUMBA_NUM_THREADS))
    now, past = kernel(shape(cells, rows), shape(cells, rows), steps)
    check = middle(now, cells, rows)
    return speed(cells, rows, steps, best(lambda: kernel(now, past, steps), runs)), check


def on_devito(cells, rows, steps, runs, threads=1):
    import os

    import devito

    devito.configuration["log-level"] = "ERROR"
    devito.configuration["language"] = "C" if threads == 1 else "openmp"
    os.environ["OMP_NUM_THREADS"] = str(threads)
    grid = devito.Grid(shape=(rows + 2, cells + 2), dtype=np.float32)
    u = devito.TimeFunction(name="u", grid=grid, time_order=2, space_order=2)
    z, x = grid.dimensions
    hz, hx = z.spacing, x.spacing
    around = (
        u.subs(x, x - hx) + u.subs(x, x + hx) + u.subs(z, z - hz) + u.subs(z, z + hz)
    )
    update = devito.Eq(u.forward, (2 - 4 * 0.25) * u - u.backward + 0.25 * around, subdomain=grid.interior)
    operator = devito.Operator([update], opt="advanced")
    for level in range(3):
        u.data[level] = shape(cells, rows)

    def run():
        # Devito's own timer measures the generated loops alone, without the cost of calling the operator.
        summary = operator.apply(time_m=1, time_M=steps, nthreads=threads) if threads > 1 else operator.apply(
            time_m=1, time_M=steps
        )
        return sum(entry.time for entry in summary.values())

    run()
    check = middle(np.asarray(u.data[(steps + 1) % 3]), cells, rows)
    return speed(cells, rows, steps, min(run() for _ in range(runs))), check
