"""Runs a test program that was built for wasm32-wasip1: a processor of 32 bits without threads, processes and sockets.

As cargo's runner: `CARGO_TARGET_WASM32_WASIP1_RUNNER="python tests/wasi/run.py" cargo test --target wasm32-wasip1`.
The program sees the workspace's files, which it cannot change, and this process's environment.
"""

import sys
from pathlib import Path

import wasmtime

ROOT = Path(__file__).resolve().parents[2]


def main(program, *arguments):
    engine = wasmtime.Engine()
    store = wasmtime.Store(engine)
    wasi = wasmtime.WasiConfig()
    wasi.argv = [program, *arguments]
    wasi.inherit_env()
    wasi.inherit_stdout()
    wasi.inherit_stderr()
    # By its own path, and as the working folder, which is the root: proptest looks for its stored cases below that.
    for folder in (str(ROOT), "/"):
        wasi.preopen_dir(str(ROOT), folder, fs_mutable=False)
    store.set_wasi(wasi)
    linker = wasmtime.Linker(engine)
    linker.define_wasi()
    instance = linker.instantiate(store, wasmtime.Module.from_file(engine, program))
    try:
        instance.exports(store)["_start"](store)
    except wasmtime.ExitTrap as ended:
        return ended.code
    except wasmtime.Trap as trap:
        # A panic ends the program before its closing line: the gate counts failed tests by this one.
        print(trap, file=sys.stderr)
        print("\ntest result: FAILED. 0 passed; 1 failed; 0 ignored", flush=True)
        return 101
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
