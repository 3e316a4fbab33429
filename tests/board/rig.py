"""A board with a host on its cable, and what a test asks of the codes that it plays."""
import random

from unicorn import UC_HOOK_CODE

from boards import RENDERER_IRQ
from host import BLOCK, RATE_HZ, Host, drive

MID = 2048
MILLISECOND = RATE_HZ // 1000
# The thermal limit changes at multiples of this many samples only (limits::FOLDBACK_PERIOD_MS, in whole blocks).
LIMIT_PERIOD = 320 * MILLISECOND
# Codes, standard deviation.
NOISE = 0.5
# What is played before sample 0: one code from the holding register, two blocks from the ring.
BEFORE_FIRST = 1 + 2 * BLOCK


class Rig:
    """`initial`: what memory holds when the renderer has its first turn, instead of what the start has put there, by address."""

    def __init__(self, facts, image, initial=None):
        self.facts = facts
        self.board = facts.chip(image)
        if initial:
            self.change(initial)
        self.cable = facts.cable(self.board)
        self.host = Host(self.board, self.cable)

    def wire(self, *wires):
        """Fits wires between pins, by the names that `slipline selftest --wire` has for them. The converters have their noise (BOARDS.md,
        "Noise"), which smooths the steps of the codes."""
        for wire in wires:
            if wire == "dac=sensor":
                draw = random.Random(5)
                self.board.adc.at_pins = lambda: (noisy(self.board.dac.output, NOISE, draw), MID)
            else:
                assert wire == "trigger=trigger-in", wire
                self.board.pins.connect(self.facts.trigger, self.facts.trigger_input)

    def change(self, initial):
        """Changes memory when the renderer's interrupt is entered for the first time."""
        board = self.board
        vector = board.cpu.mem_read(board.FLASH_START + 4 * (16 + RENDERER_IRQ), 4)
        handler = int.from_bytes(vector, "little") & ~1

        def on_entry(*_):
            while initial:
                board.cpu.mem_write(*initial.popitem())

        board.cpu.hook_add(UC_HOOK_CODE, on_entry, begin=handler, end=handler + 1)

    def codes(self, start, until):
        """The codes the DAC has played for the samples start..until."""
        return self.board.dac.codes[BEFORE_FIRST + start : BEFORE_FIRST + until]

    def played(self):
        """The index of the next sample to be played."""
        return len(self.board.dac.codes) - BEFORE_FIRST

    def pulses(self):
        """The address of the mailbox's three counts: of the renderer's, the link's and the safety checks' turns."""
        board = self.board
        (start,) = (address for name, address in board.symbols.items() if "MAILBOX" in name)
        end = min(address for address in board.symbols.values() if address > start)
        blocks = self.played() // BLOCK
        seen = []
        for _ in range(2):
            memory = board.cpu.mem_read(start, end - start)
            seen.append([int.from_bytes(memory[i : i + 4], "little") for i in range(0, len(memory), 4)])
            self.host.live(0.01)
        steps = [b - a for a, b in zip(*seen)]
        found = [
            i for i in range(len(steps) - 2)
            if 0 < seen[0][i] - blocks < 8 and 25 < steps[i] < 45 and 0 < steps[i + 1] < 40 and 0 < steps[i + 2] < 10
        ]  # fmt: skip
        assert len(found) == 1, found
        return start + 4 * found[0]

    def upload_to_keep(self, count):
        """Uploads a table that may be stored then; returns its CRC."""
        was_hasty, self.board.is_hasty = self.board.is_hasty, True
        self.host.accept("Disarm")
        self.host.live(0.1)
        crc = self.host.upload(count)
        self.host.live(0.05)
        self.board.is_hasty = was_hasty
        return crc

    def keep(self, count):
        """Uploads a table and stores it; returns its CRC."""
        crc = self.upload_to_keep(count)
        self.host.accept("Store", patience=self.facts.store_seconds)
        return crc

    def stored_crc(self):
        """The CRC of the table in force after a start; None if there is none."""
        active = self.host.ask("TableDigest", answer="Table").active
        return active and active.crc


class Kept(Rig):
    """A table is stored, and another one is about to be."""

    def __init__(self, facts, image):
        super().__init__(facts, image)
        self.host.connect()
        self.old = self.keep(33)
        self.new = self.upload_to_keep(34)


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
        self.limit = self.host.status()["foldback_per_mille"]
        # 32 kHz as loud as it may be, and a lower tone that glides.
        self.at = self.host.accept("Drive", drive([(0, 0.3, 0.6), (1, 0.9, 0.2)], 5 * MILLISECOND))
        self.host.live(0.02)
        until = self.at + 60 * MILLISECOND
        self.expected = mirror(self.host.accepted, self.at, until, self.limit)

    def leaves_the_mirror(self):
        """The index of the first code that is not the mirror's."""
        codes = self.codes(self.at, self.played())
        assert len(codes) <= len(self.expected)
        return self.at + next((i for i, (a, b) in enumerate(zip(codes, self.expected)) if a != b), len(codes))


def noisy(code, deviation, draw):
    """A code with noise."""
    return min(max(round(code + draw.gauss(0, deviation)), 0), 4095)


def start(rig, tones=((0, 0.4, 0.5),), glide=5 * MILLISECOND):
    """Drives, and returns the index from which on it sounds."""
    at = rig.host.accept("Drive", drive(list(tones), glide))
    rig.host.live(0.02)
    return at


def is_silent(codes):
    return bool(codes) and set(codes) == {MID}
