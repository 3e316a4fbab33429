"""Memory, which may appear at several addresses."""
import ctypes
import mmap

from unicorn import UC_PROT_ALL


class Memory:
    """The same memory of this computer wherever it is mapped. Private: a copy of the process (`copies`) has its own."""

    def __init__(self, cpu, start, size):
        self.cpu, self.size = cpu, size
        self.memory = mmap.mmap(-1, size, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
        self.host_address = ctypes.addressof(ctypes.c_char.from_buffer(self.memory))
        self.map(start, size)

    def map(self, address, size, rights=UC_PROT_ALL):
        """Shows its beginning at an address. Unicorn wants whole pages."""
        self.cpu.mem_map_ptr(address, size, rights, self.host_address)
