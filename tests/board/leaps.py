"""The device's time leaps: a model takes many seconds for one of the device's."""
import struct

from host import BLOCK, RATE_HZ
from rig import MILLISECOND
from test_long_runs import words_after_a_block


def leap(rig, seconds):
    """Moves the renderer's sample index on, from which all of the application takes its time. A tone's phase, the coil's heat and the
    host do not notice; an armed device notices that the host was silent."""
    (start,) = (address for name, address in rig.board.symbols.items() if "RENDERER" in name and "EXECUTOR" not in name)
    end = min(address for address in rig.board.symbols.values() if address > start)
    now = rig.host.status()["now"]
    seen = words_after_a_block(rig, start, end)
    rig.board.run(9.5 * BLOCK / RATE_HZ)
    later = words_after_a_block(rig, start, end)
    (index,) = [i for i, (a, b) in enumerate(zip(seen, later)) if now <= a < b == a + 10 * BLOCK and a - now < 4 * MILLISECOND]
    blocks = round(seconds * RATE_HZ / BLOCK)
    rig.board.cpu.mem_write(start + 4 * index, struct.pack("<Q", later[index] + blocks * BLOCK))
    rig.host.live(0.003)
    assert abs(rig.host.status()["now"] - now - blocks * BLOCK) < 10 * MILLISECOND
