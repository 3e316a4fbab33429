"""The image under test, built once, and boards that run it."""
import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from boards import BOARDS, F407, name
from host import DRIVE, RATE_HZ, Host, drive

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


def pytest_configure(config):
    config.addinivalue_line("markers", "nightly: takes long; `.ci/run nightly` runs it")
    config.addinivalue_line("markers", "every_image: the gate runs it on every board's image, not on the F407's alone")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """What the gate does not run on the other boards' images is for the night; so is a fault's second phase in a block."""
    for item in items:
        parameters = item.callspec.params if hasattr(item, "callspec") else {}
        is_chosen = item.get_closest_marker("every_image") and not parameters.get("phase")
        if parameters.get("facts") not in (None, F407) and not is_chosen:
            item.add_marker(pytest.mark.nightly)


@pytest.fixture(scope="session", params=BOARDS, ids=name)
def facts(request):
    """The board."""
    return request.param


@pytest.fixture(scope="session")
def image(facts, tmp_path_factory):
    """The very image that is flashed; a copy, for other boards' images go to the same place."""
    copy = tmp_path_factory.mktemp("image") / "slipline-stm32.elf"
    return shutil.copy(firmware(facts.feature), copy)


@pytest.fixture(scope="session")
def mirror():
    """Replays accepted commands and returns the codes from..until."""
    program = cargo("-p", "slipline-tests", "--bin", "mirror_codes")

    def play(accepted, start, until, limit=None):
        """`limit`: what the thermal model leaves, per mille, if that is less than all; it must not change meanwhile."""
        lines = "".join(f"{index} {frame.hex()}\n" for index, frame in accepted) + f"play {start} {until}\n"
        lines = lines if limit is None else f"limit 0 {limit}\n" + lines
        output = subprocess.run([program], input=lines.encode(), stdout=subprocess.PIPE, check=True).stdout
        return [int.from_bytes(output[i : i + 2], "little") for i in range(0, len(output), 2)]

    return play


class Rig:
    """A board with a host on its cable."""

    def __init__(self, facts, image):
        self.facts = facts
        self.board = facts.chip(image)
        self.cable = facts.cable(self.board)
        self.host = Host(self.board, self.cable)

    def codes(self, start, until):
        """The codes the DAC has played for the samples start..until."""
        # The value DAC and ring start with: one in the holding register, two blocks in the ring.
        first = 1 + 2 * 128
        return self.board.dac.codes[first + start : first + until]

    def played(self):
        """The index of the next sample to be played."""
        return len(self.board.dac.codes) - (1 + 2 * 128)


@pytest.fixture
def rig(facts, image):
    return Rig(facts, image)


# The thermal limit changes at multiples of this many samples only (limits::FOLDBACK_PERIOD_MS, in whole blocks).
LIMIT_PERIOD = 320 * RATE_HZ // 1000


class Sounding(Rig):
    """Connected, armed, and just at the beginning of a drive: the thermal limit stays as it is for long enough."""

    def __init__(self, facts, image, mirror):
        super().__init__(facts, image)
        self.host.connect()
        self.host.upload()
        while self.host.status()["now"] % LIMIT_PERIOD > LIMIT_PERIOD // 8:
            self.board.is_hasty = True
            self.host.live(0.02)
        self.board.is_hasty = False
        self.host.live(0.002)
        self.host.arm()
        self.limit = self.host.status()["foldback"]
        # 32 kHz as loud as it may be, and a lower tone that glides.
        self.at = self.host.accept(DRIVE, drive([(0, 0.3, 0.6), (1, 0.9, 0.2)], 5 * RATE_HZ // 1000))
        self.host.live(0.02)
        until = self.at + 60 * RATE_HZ // 1000
        self.expected = mirror(self.host.accepted, self.at, until, self.limit)

    def leaves_the_mirror(self):
        """The index of the first code that is not the mirror's."""
        codes = self.codes(self.at, self.played())
        assert len(codes) <= len(self.expected)
        return self.at + next((i for i, (a, b) in enumerate(zip(codes, self.expected)) if a != b), len(codes))


@pytest.fixture(scope="session")
def sounding(facts, image, mirror):
    """Never changed: cases run on copies of it (`copies.on_copy`)."""
    rig = Sounding(facts, image, mirror)
    assert rig.leaves_the_mirror() == rig.played(), "up to here it plays what the mirror plays"
    return rig


@pytest.fixture(scope="session")
def cool(facts, image):
    """Connected, with a table, armed, and so long after the start that the thermal model lets the full level pass:
    after a reset it takes the coil for hot, and `mirror_codes` is not told the limit. Shared, for it takes a while."""
    rig = Rig(facts, image)
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
