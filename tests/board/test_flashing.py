"""The released files, on a board that was never flashed, and as updates of one that has kept a table and a profile."""
import flashing
from boards import F407
from copies import on_copy
from host import profile
from images import flash_files
from rig import is_silent, start
from test_profile import write

# Which of the files BOARDS.md names for an update: all but those for factory-new boards.
FOR_UPDATES = {"board-f4discovery": {".dfu", ".hex"}, "board-nucleo-g474re": {".bin"}, "board-nucleo-h743zi2": {".bin"}}


def whole_flash(rig):
    board = rig.board
    return bytes(board.cpu.mem_read(board.FLASH_START, board.MEMORIES[board.FLASH_START]))


def test_each_released_file_makes_a_factory_new_board_that_can_be_armed_and_drives(rig):
    """R-93."""
    released = flash_files(rig.facts.feature)
    for_new_boards_only = {"-factory-new.bin"} if rig.facts == F407 else set()
    assert set(released) == FOR_UPDATES[rig.facts.feature] | for_new_boards_only
    if ".dfu" in released:
        at, vectors = flashing.read_dfuse(released[".dfu"])[-1]
        # dfu-util's `:leave` starts what lies at the address that was written last; it writes 2048 bytes at a time.
        assert at == rig.board.FLASH_START and len(vectors) <= 2048
    as_loaded = whole_flash(rig)
    for name, file in released.items():
        flashing.make_factory_new(rig.board)
        flashing.flash(rig.board, name, file)
        assert whole_flash(rig) == as_loaded, f"{name}: the program, and nothing else"
    identity = rig.host.connect()
    rig.host.live(0.01)
    assert (identity["stored"], rig.host.profile(), rig.host.status()["faults"]) == ("empty", (None, "empty"), set())
    rig.host.upload()
    rig.host.arm()
    at = start(rig)
    assert not is_silent(rig.codes(at, rig.played()))


def test_an_update_keeps_table_and_profile(kept):
    """R-93: whichever of its two places holds the newest profile, after one write of it and after three."""
    kept.board.is_hasty = True
    for number in range(3):
        write(kept, profile(f"profile {number}", 400 - 50 * number))
        before = whole_flash(kept)
        for name in FOR_UPDATES[kept.facts.feature]:
            on_copy(kept, lambda copy: check_update(copy, name, before))
    for name in FOR_UPDATES[kept.facts.feature]:
        flashing.flash(kept.board, name, flash_files(kept.facts.feature)[name])
    kept.host.forget()
    kept.host.connect()
    kept.host.live(0.01)
    assert (kept.host.profile(), kept.stored_crc()) == (("profile 2", "loaded"), kept.old)
    assert kept.host.status()["faults"] == set()


def check_update(rig, name, before):
    flashing.flash(rig.board, name, flash_files(rig.facts.feature)[name])
    assert whole_flash(rig) == before, f"{name}: the program and what was kept, byte for byte"
