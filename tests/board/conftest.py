"""The image under test, built once, and boards that run it."""
import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from host import Host
from stm32f407 import Board, UsbHost

ROOT = Path(__file__).parents[2]
TARGET = "thumbv7em-none-eabihf"


def cargo(*arguments):
    """Builds with cargo and returns the executable's path."""
    command = [os.environ.get("CARGO", "cargo"), "build", "--message-format", "json", *arguments]
    output = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout
    messages = [json.loads(line) for line in output.splitlines()]
    return [message["executable"] for message in messages if message.get("executable")][-1]


def firmware(board):
    """Builds a board's image by the documented command and returns its path."""
    features = ["--no-default-features", "--features", board]
    return cargo("--release", "-p", "slipline-stm32", "--target", TARGET, *features)


@pytest.fixture(scope="session")
def image(tmp_path_factory):
    """The very image that is flashed; a copy, for other boards' images go to the same place."""
    copy = tmp_path_factory.mktemp("image") / "slipline-stm32.elf"
    return shutil.copy(firmware("board-f4discovery"), copy)


@pytest.fixture(scope="session")
def mirror():
    """Replays accepted commands and returns the codes from..until."""
    program = cargo("-p", "slipline-tests", "--bin", "mirror_codes")

    def play(accepted, start, until):
        lines = "".join(f"{index} {frame.hex()}\n" for index, frame in accepted) + f"play {start} {until}\n"
        output = subprocess.run([program], input=lines.encode(), stdout=subprocess.PIPE, check=True).stdout
        return [int.from_bytes(output[i : i + 2], "little") for i in range(0, len(output), 2)]

    return play


class Rig:
    """A board with a host on its cable."""

    def __init__(self, image):
        self.board = Board(image)
        self.usb = UsbHost(self.board)
        self.host = Host(self.board, self.usb)

    def codes(self, start, until):
        """The codes the DAC has played for the samples start..until."""
        # The value DAC and ring start with: one in the holding register, two blocks in the ring.
        first = 1 + 2 * 128
        return self.board.dac.codes[first + start : first + until]

    def played(self):
        """The index of the next sample to be played."""
        return len(self.board.dac.codes) - (1 + 2 * 128)


@pytest.fixture
def rig(image):
    return Rig(image)


@pytest.fixture(scope="session")
def cool(image):
    """Connected, with a table, armed, and so long after the start that the thermal model lets the full level pass:
    after a reset it takes the coil for hot, and `mirror_codes` is not told the limit. Shared, for it takes a while."""
    rig = Rig(image)
    rig.host.connect()
    rig.host.upload()
    rig.board.is_hasty = True
    for _ in range(100):
        rig.host.live(0.2)
        if rig.host.status()["foldback"] == 1000:
            break
    rig.board.is_hasty = False
    rig.host.live(0.01)
    rig.host.arm()
    assert rig.host.status()["foldback"] == 1000
    return rig


@pytest.fixture
def armed(rig):
    """Connected, with a table, armed."""
    rig.host.connect()
    rig.host.upload()
    rig.host.arm()
    return rig
