"""What the tests run, built by cargo: the boards' images, and programs of the test crate."""
import fcntl
import functools
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
TARGET = "thumbv7em-none-eabihf"


def cargo(*arguments):
    """Builds with cargo and returns the executables' paths by their names."""
    command = [os.environ.get("CARGO", "cargo"), *arguments, "--message-format", "json"]
    output = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout
    messages = [json.loads(line) for line in output.splitlines()]
    return {message["target"]["name"]: Path(message["executable"]) for message in messages if message.get("executable")}


@functools.cache
def mirror_codes():
    """The example of that name. Without `-p`, so that it is built of what `cargo test` builds, too."""
    return cargo("build", "--example", "mirror_codes")["mirror_codes"]


@functools.cache
def selftest_in_step():
    """The test crate's program of that name, built as `mirror_codes` is."""
    return cargo("build", "--bin", "selftest_in_step")["selftest_in_step"]


@functools.cache
def bench():
    """The benchmark for the emulator."""
    return cargo("build", "--release", "-p", "slipline-qemu", "--target", TARGET, "--bin", "slipline-bench")["slipline-bench"]


@functools.cache
def firmware(board):
    """Builds a board's image by the documented command and returns the path of a copy, which is the board's own: cargo
    puts every board's image into the same place. The gate runs two processes of tests at once, so one at a time."""
    features = ["--no-default-features", "--features", board]
    with open(Path(__file__).parent / "images.py") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        built = cargo("build", "--release", "-p", "slipline-stm32", "--target", TARGET, *features)["slipline-stm32"]
        copy = built.with_name(f"tested-{board}.elf")
        shutil.copy(built, copy.with_suffix(".new"))
        # A process that reads the old copy continues to read that.
        copy.with_suffix(".new").replace(copy)
    return copy


@functools.cache
def flash_files(board):
    """The files by which a board's image is flashed, by the ends of their names; made as `.ci/images` makes them."""
    elf = firmware(board)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([ROOT / ".ci" / "flash-files", elf, Path(folder, "image")], check=True)
        return {path.name.removeprefix("image"): path.read_bytes() for path in Path(folder).iterdir()}
