"""The code and the tables that firmware/stm32/memory/fast.x lists lie in RAM."""
import re
from fnmatch import fnmatchcase

import pytest
from elftools.elf.elffile import ELFFile

from images import ROOT, firmware

MEMORY = ROOT / "firmware/stm32/memory"
PATTERNS = re.findall(r"^\s*\*\(\.(?:text|rodata)\.(\S+)\);", (MEMORY / "fast.x").read_text(), re.M)
# The memory of each board's chip that code in RAM must lie in to run without wait states.
BOARDS = {"board-f4discovery": range(0x1000, 0x1C000), "board-nucleo-g474re": range(0x10000000, 0x10008000)}


@pytest.mark.parametrize("board", BOARDS)
def test_the_costly_code_and_its_tables_lie_in_ram(board):
    assert PATTERNS
    with open(firmware(board), "rb") as file:
        elf = ELFFile(file)
        symbols = elf.get_section_by_name(".symtab")
        places = {s.name: s["st_value"] for s in symbols.iter_symbols() if s["st_info"]["type"] in ("STT_FUNC", "STT_OBJECT")}
        fast = elf.get_section_by_name(".fast")
        assert fast["sh_addr"] in BOARDS[board] and fast["sh_addr"] + fast["sh_size"] in BOARDS[board]
    for pattern in PATTERNS:
        found = {name: place for name, place in places.items() if fnmatchcase(name, pattern) and not name.startswith("__Thumb")}
        assert found, f"{pattern} matches no symbol"
        for name, place in found.items():
            assert place in BOARDS[board], f"{name} lies at {place:#x}"
