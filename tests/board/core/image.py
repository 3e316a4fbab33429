"""What the model needs to know of an ELF image."""
from elftools.elf.elffile import ELFFile

# Endless sleep, for tests of the models alone: `wfe`, and a jump back to it.
IDLE = b"\x20\xbf\xfd\xe7"


class Image:
    """Segments to load, symbols, and where the instructions stand that the model watches."""

    def __init__(self, path):
        self.segments, self.symbols = [], {}
        with open(path, "rb") as file:
            elf = ELFFile(file)
            for segment in elf.iter_segments():
                if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                    self.segments.append((segment["p_paddr"], segment.data()))
            for section in elf.iter_sections():
                if section["sh_type"] == "SHT_SYMTAB":
                    self.symbols |= {symbol.name: symbol["st_value"] for symbol in section.iter_symbols()}
            text = elf.get_section_by_name(".text")
            self.code, self.start = text.data(), text["sh_addr"]

    def places(self, *codes):
        """Addresses of these halfwords in the program."""
        return [self.start + i for i in range(0, len(self.code) - 1, 2) if self.code[i : i + 2] in codes]

    @property
    def event_waits(self):
        """WFE."""
        return self.places(b"\x20\xbf")

    @property
    def interrupt_waits(self):
        """WFI."""
        return self.places(b"\x30\xbf")

    @property
    def signals(self):
        """SEV."""
        return self.places(b"\x40\xbf")

    @property
    def barriers(self):
        """`dsb sy`."""
        return [at for at in self.places(b"\xbf\xf3") if self.code[at - self.start + 2 :][:2] == b"\x4f\x8f"]

    @property
    def masks(self):
        """`cpsid i`."""
        return self.places(b"\x72\xb6")

    @property
    def unmasks(self):
        """`cpsie i` and `msr primask, rN`."""
        code = self.code
        restores = [
            self.start + i
            for i in range(0, len(code) - 3, 2)
            if code[i] >> 4 == 8 and code[i + 1 : i + 4] == b"\xf3\x10\x88"
        ]
        return self.places(b"\x62\xb6") + restores


class Idle(Image):
    """No program: a processor that sleeps, and registers for a test to write."""

    def __init__(self, start, stack):
        self.symbols = {}
        self.code, self.start = IDLE, start + 0x400
        self.segments = [(start, stack.to_bytes(4, "little") + (self.start | 1).to_bytes(4, "little")), (self.start, IDLE)]
