#!/usr/bin/env python3
"""Runs Slipline's plate solvers and their peers on the same problems and prints one table.

    python3 host/plate/benches/peers/compare.py [--rounds N]

The first run makes a virtual environment beside this file with the versions of requirements.txt. Needs a C compiler
(Devito generates C). Engines take turns in every round, runs last a few milliseconds and the fastest of each counts, so
that other work on the machine disturbs none of them for long; compare ratios, not absolute figures.
"""

import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
GRIDS = [(128, 32, 960), (512, 128, 384), (2048, 512, 32)]


def enter_environment():
    """Restarts this script inside its own virtual environment, and creates it first if it does not exist."""
    environment = HERE / ".venv"
    python = environment / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    if pathlib.Path(sys.prefix).resolve() == environment:
        return
    if not (environment / "complete").exists():
        subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
        install = [str(python), "-m", "pip", "install", "--quiet", "-r", str(HERE / "requirements.txt")]
        subprocess.run(install, check=True)
        (environment / "complete").touch()
    raise SystemExit(subprocess.run([str(python), __file__, *sys.argv[1:]]).returncode)


def ours():
    """{(problem, engine): (value, check)} of our own benchmark."""
    command = ["cargo", "bench", "--quiet", "-p", "slipline-plate", "--bench", "speed", "--", "--lines"]
    text = subprocess.run(command, cwd=HERE, check=True, capture_output=True, text=True).stdout
    rows = [line.split("\t") for line in text.splitlines() if line.count("\t") == 4]
    return {(row[0], row[1]): (float(row[2]), float(row[4])) for row in rows}


def peers(runs):
    """The same of NumPy, numba, Devito and scipy."""
    import numpy as np

    import fdtd
    import frequency

    results = {}
    for cells, rows, steps in GRIDS:
        problem = f"fdtd {cells}x{rows}"
        results[problem, "numpy"] = fdtd.on_numpy(cells, rows, steps, 10)
        for threads in (1, 2):
            results[problem, f"numba {threads}"] = fdtd.on_numba(cells, rows, steps, runs, threads)
            results[problem, f"devito {threads}"] = fdtd.on_devito(cells, rows, steps, runs, threads)
    frequencies = 20e3 + 20e3 * np.arange(64) / 63
    results["frequency 2000x64", "solve_banded"] = frequency.on_solve_banded(2000, frequencies, runs // 4)
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3, help="rounds in which every engine runs (default 3)")
    rounds = parser.parse_args().rounds
    best = {}
    for number in range(rounds):
        print(f"round {number + 1} of {rounds}", file=sys.stderr)
        for results in (ours(), peers(100)):
            for key, (value, check) in results.items():
                better = min if key[0].startswith("frequency") else max
                before = best.get(key, (value, check))[0]
                best[key] = (better(value, before), check)
    print_table(best)


def print_table(best):
    print("| problem | engine | speed | slipline on one thread is | result at a point |")
    print("|---|---|---|---|---|")
    for (problem, engine), (value, check) in sorted(best.items(), key=lambda item: (problem_order(item[0][0]), item[0][1])):
        reference = best.get((problem, "slipline 1"))
        if problem.startswith("fdtd"):
            unit, ratio = "Mcell/s", reference[0] / value
        elif problem.startswith("frequency"):
            unit, ratio = "ms", value / reference[0]
        else:
            unit, ratio = "x real time", 1.0
        same = "" if engine == "slipline 1" else f"{ratio:.1f} x as fast"
        print(f"| {problem} | {engine} | {value:.4g} {unit} | {same} | {check:.4f} |")


def problem_order(problem):
    return ["fdtd 128x32", "fdtd 512x128", "fdtd 2048x512", "frequency 2000x64"].index(problem) if problem.startswith(
        ("fdtd", "frequency")
    ) else 9


if __name__ == "__main__":
    enter_environment()
    sys.path.insert(0, str(HERE))
    main()
