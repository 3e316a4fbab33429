"""Which tests run when, and the states from which they begin: each is reached once, and each test gets a copy."""
import subprocess
from pathlib import Path

import pytest

from bare_chip import Registers
from boards import BOARDS, F407, name
from copies import in_copy
from host import BLOCK
from images import firmware, mirror_codes
from pieces import piece
from rig import Kept, Rig, Sounding

# The fixtures that are boards, shared by all tests of the session.
SHARED = {"rig", "armed", "sounding", "cool", "kept"}



def pytest_addoption(parser):
    parser.addoption("--from", choices=["begin", "end"], dest="side", default="begin", help="where of the list this process begins")
    parser.addoption("--claims", metavar="FOLDER", help="shared by processes that run a list together: who runs which test")
    parser.addoption("--piece", metavar="K/N", help="piece K of N of the tests, all about as long, for a night in parts")


def pytest_configure(config):
    config.addinivalue_line("markers", "nightly: takes long; `.ci/run nightly` runs it")
    config.addinivalue_line("markers", "fuzz: random hosts by the thousand; `.ci/run fuzz` runs it")
    config.addinivalue_line("markers", "every_image: the gate runs it on every board's image, not on the F407's alone")


def mark_nightly(items):
    """What the gate does not run on the other boards' images is for the night; so is a fault's second phase in a block."""
    for item in items:
        parameters = item.callspec.params if hasattr(item, "callspec") else {}
        is_chosen = item.get_closest_marker("every_image") and not parameters.get("phase")
        if parameters.get("facts") not in (None, F407) and not is_chosen:
            item.add_marker(pytest.mark.nightly)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    mark_nightly(items)
    if config.option.piece:
        items[:] = piece([item for item in items if not item.get_closest_marker("fuzz")], config.option.piece)


def claimed(config, items):
    """Those that no other process runs, each claimed when the one before it begins."""
    for number, item in enumerate(items) if config.option.side == "begin" else reversed([*enumerate(items)]):
        try:
            Path(config.option.claims, str(number)).touch(exist_ok=False)
        except FileExistsError:
            continue
        yield item


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session):
    """Two processes run the list from both its ends until they meet: a board is brought into the states from which tests
    begin by one of them, or by both for the board where they meet, and both have something to do until the end."""
    if session.config.option.claims is None or session.config.option.collectonly:
        return None
    mine = claimed(session.config, session.items)
    item = next(mine, None)
    while item is not None:
        following = next(mine, None)
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        item = following
    return True


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """A test that has a board gets a copy of it: it runs in a copy of this process."""
    if SHARED.isdisjoint(pyfuncitem.fixturenames):
        return None
    arguments = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}
    in_copy(lambda: pyfuncitem.obj(**arguments) and None)
    return True


@pytest.fixture(scope="session", params=BOARDS, ids=name)
def facts(request):
    """The board."""
    return request.param


@pytest.fixture(scope="session")
def image(facts):
    """The very image that is flashed."""
    return firmware(facts.feature)


@pytest.fixture(scope="session")
def mirror():
    """Replays accepted commands and returns the codes from..until."""

    def play(accepted, start, until, limit=None, begin=0):
        """`limit`: what the thermal model leaves, per mille, if that is less than all; it must not change meanwhile.
        `begin`: an index at which the device was silent."""
        lines = [f"limit {begin} {limit}"] * (limit is not None) + replayed(accepted)
        output = ask_mirror([f"begin {begin}"] * (begin > 0) + lines + [f"play {start} {until}"])
        return [int.from_bytes(output[i : i + 2], "little") for i in range(0, len(output), 2)]

    return play


@pytest.fixture(scope="session")
def mirrored_lock_ins():
    """Replays accepted commands; returns the weight, the slots that were followed, and each slot's I and Q, by lock-ins on the
    host, of the codes that an input has sampled from an index on."""

    def listen(accepted, start, codes, hann=False, slots=0xFFFF):
        coded = b"".join(code.to_bytes(2, "little") for code in codes).hex()
        output = ask_mirror(replayed(accepted) + [f"listen {start} {len(codes) // BLOCK} {int(hann)} {slots} {coded}"])
        (weight, followed), *answers = [tuple(map(int, line.split())) for line in output.decode().splitlines()]
        return weight, followed, answers

    return listen


def replayed(accepted):
    return [f"{index} {frame.hex()}" for index, frame in accepted]


def ask_mirror(lines):
    text = "".join(f"{line}\n" for line in lines)
    return subprocess.run([mirror_codes()], input=text.encode(), stdout=subprocess.PIPE, check=True).stdout


@pytest.fixture(scope="session")
def rig(facts, image):
    """Switched off so far."""
    return Rig(facts, image)


@pytest.fixture(scope="session")
def armed(facts, image):
    """Connected, with a table, armed."""
    rig = Rig(facts, image)
    rig.host.connect()
    rig.host.upload()
    rig.host.arm()
    return rig


@pytest.fixture(scope="session")
def sounding(facts, image, mirror):
    rig = Sounding(facts, image, mirror)
    assert rig.leaves_the_mirror() == rig.played(), "up to here it plays what the mirror plays"
    return rig


@pytest.fixture(scope="session")
def cool(facts, image):
    """Connected, with a table, armed, and so long after the start that the thermal model lets the full level pass:
    after a reset it takes the coil for hot, and `mirror_codes` does not know the limit."""
    rig = Rig(facts, image)
    rig.host.connect()
    rig.host.upload()
    rig.board.is_hasty = True
    for _ in range(100):
        rig.host.live(0.2)
        if rig.host.status()["foldback_per_mille"] == 1000:
            break
    rig.board.is_hasty = False
    rig.host.live(0.01)
    rig.host.arm()
    assert rig.host.status()["foldback_per_mille"] == 1000
    return rig


@pytest.fixture(scope="session")
def kept(facts, image):
    return Kept(facts, image)


@pytest.fixture
def chip():
    """An F407 without a program, at full speed."""
    registers = Registers()
    registers.run_at_full_speed()
    return registers
