"""The OTG_FS core in device mode (RM0090 chapter 34): its registers, its FIFOs, and what a host meets on its wire."""
import struct

OUT_DATA, OUT_DONE, SETUP_DONE, SETUP_DATA = 2, 3, 4, 6
USBSUSP, USBRST, ENUMDNE, RXFLVL, IEPINT, OEPINT, WKUPINT = 1 << 11, 1 << 12, 1 << 13, 1 << 4, 1 << 18, 1 << 19, 1 << 31
GAHBCFG, GRSTCTL, GINTSTS, GINTMSK, GRXSTSR, GRXSTSP, CID = 0x08, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x3C
DIEPTXF0, DIEPTXF1, DCTL, DSTS, DIEPMSK, DOEPMSK, DAINT, DAINTMSK, DIEPEMPMSK = (
    0x28, 0x104, 0x804, 0x808, 0x810, 0x814, 0x818, 0x81C, 0x834,
)  # fmt: skip
IN_ENDPOINTS, OUT_ENDPOINTS, FIFOS, FIFOS_END = 0x900, 0xB00, 0x1000, 0x20000
SOFT_DISCONNECT = 1 << 1
# GRSTCTL: the AHB master is idle; flushes of transmit and receive FIFOs, which read 1 until they are over.
IDLE, FLUSHES = 1 << 31, 1 << 5 | 1 << 4
ENDPOINTS = 4
ENABLE, DISABLE, SNAK, CNAK, STALL, ACTIVE = 1 << 31, 1 << 30, 1 << 27, 1 << 26, 1 << 21, 1 << 15
# What a write of a control register starts, and reading does not show.
COMMANDS = 0b11111 << 26
FULL_SPEED = 3 << 1
# DOEPTSIZ0.STUPCNT counts in these.
SETUP_COUNT = 1 << 29
CORE_ID = 0x1200


class UsbCore:
    def __init__(self, board):
        self.board = board
        board.usb = self
        board.add_line(board.USB_IRQ, self.is_line_high)
        # The transmit FIFOs whose flush never ends; 16 stands for all at once.
        self.stuck_fifos = set()
        self.reset()

    def reset(self):
        """The core as the chip's reset leaves it."""
        self.registers = {CID: CORE_ID, DCTL: SOFT_DISCONNECT}
        self.status = self.flushing = 0
        self.received, self.words = [], []
        self.in_control, self.in_size, self.in_flags = [0] * ENDPOINTS, [0] * ENDPOINTS, [0] * ENDPOINTS
        self.in_fifo = [bytearray() for _ in range(ENDPOINTS)]
        self.out_control, self.out_size, self.out_flags = [0] * ENDPOINTS, [0] * ENDPOINTS, [0] * ENDPOINTS
        self.in_refuses = [False] * ENDPOINTS
        self.out_refuses = [True] * ENDPOINTS

    def pulled_up(self):
        """The device shows itself on the bus."""

    def shows(self, status):
        """Something has happened on the bus."""
        self.status |= status
        self.raise_interrupt()

    # --- registers

    def flags(self):
        value = self.status | (RXFLVL if self.received else 0)
        value |= IEPINT if self.in_interrupts() & self.registers.get(DAINTMSK, 0) else 0
        value |= OEPINT if self.out_interrupts() << 16 & self.registers.get(DAINTMSK, 0) else 0
        return value

    def in_interrupts(self):
        mask, empty = self.registers.get(DIEPMSK, 0), self.registers.get(DIEPEMPMSK, 0)
        return sum(
            1 << n for n in range(ENDPOINTS) if self.in_flags[n] & mask or (empty >> n & 1 and self.space(n) > 8)
        )

    def out_interrupts(self):
        return sum(1 << n for n in range(ENDPOINTS) if self.out_flags[n] & self.registers.get(DOEPMSK, 0))

    def is_line_high(self):
        return bool(self.registers.get(GAHBCFG, 0) & 1 and self.flags() & self.registers.get(GINTMSK, 0))

    def raise_interrupt(self):
        if self.is_line_high():
            self.board.pend(self.board.USB_IRQ)

    def space(self, n):
        """Free words of an IN endpoint's FIFO."""
        depth = (self.registers.get(DIEPTXF0 if n == 0 else DIEPTXF1 + 4 * (n - 1), 0) >> 16) or 16
        return max(0, depth - (len(self.in_fifo[n]) + 3) // 4)

    def read(self, offset):
        if offset == GINTSTS:
            return self.flags()
        if offset == GRSTCTL:
            return IDLE | self.flushing
        if offset in (GRXSTSR, GRXSTSP):
            return self.pop_status() if offset == GRXSTSP else (self.received[0][0] if self.received else 0)
        if FIFOS <= offset < FIFOS_END:
            return self.words.pop(0) if self.words else 0
        if offset == DSTS:
            return FULL_SPEED | (int(self.board.seconds * 1000) & 0x3FFF) << 8
        if offset == DAINT:
            return self.in_interrupts() | self.out_interrupts() << 16
        if IN_ENDPOINTS <= offset < IN_ENDPOINTS + 0x20 * ENDPOINTS:
            n, register = divmod(offset - IN_ENDPOINTS, 0x20)
            empty = 0x80 if self.space(n) > 8 else 0
            return {
                0x00: self.in_control[n], 0x08: self.in_flags[n] | empty, 0x10: self.in_size[n], 0x18: self.space(n),
            }.get(register, 0)  # fmt: skip
        if OUT_ENDPOINTS <= offset < OUT_ENDPOINTS + 0x20 * ENDPOINTS:
            n, register = divmod(offset - OUT_ENDPOINTS, 0x20)
            active = ACTIVE if n == 0 else 0
            return {0x00: self.out_control[n] | active, 0x08: self.out_flags[n], 0x10: self.out_size[n]}.get(register, 0)
        return self.registers.get(offset, 0)

    def pop_status(self):
        if not self.received:
            return 0
        status, words = self.received.pop(0)
        self.words = list(words)
        kind, endpoint = status >> 17 & 15, status & 15
        if kind == SETUP_DONE:
            self.out_flags[endpoint] |= 8
        if kind == OUT_DONE:
            self.out_flags[endpoint] |= 1
        return status

    def write(self, offset, value):
        if offset == GINTSTS:
            self.status &= ~value
        elif offset == GRSTCTL:
            self.flush(value)
            return
        elif FIFOS <= offset < FIFOS_END:
            self.in_fifo[(offset >> 12) - 1] += struct.pack("<I", value)
            return
        elif IN_ENDPOINTS <= offset < IN_ENDPOINTS + 0x20 * ENDPOINTS:
            self.write_in(*divmod(offset - IN_ENDPOINTS, 0x20), value)
        elif OUT_ENDPOINTS <= offset < OUT_ENDPOINTS + 0x20 * ENDPOINTS:
            self.write_out(*divmod(offset - OUT_ENDPOINTS, 0x20), value)
        elif offset == DCTL:
            was, self.registers[DCTL] = self.registers[DCTL], value
            if was & SOFT_DISCONNECT and not value & SOFT_DISCONNECT:
                self.pulled_up()
            return
        else:
            self.registers[offset] = value
        self.raise_interrupt()

    def flush(self, value):
        is_stuck = value & FLUSHES and value >> 6 & 31 in self.stuck_fifos
        self.flushing = value & FLUSHES if is_stuck else 0
        if value & 1 << 5:
            which = value >> 6 & 31
            for n in range(ENDPOINTS):
                if which in (n, 16):
                    self.in_fifo[n].clear()
        if value & 1 << 4:
            self.received.clear()

    def write_in(self, n, register, value):
        if register == 0x00:
            if value & CNAK:
                self.in_refuses[n] = False
            if value & SNAK:
                self.in_refuses[n] = True
            keep, control = self.in_control[n] & ENABLE, value & ~(COMMANDS & ~ENABLE)
            if value & DISABLE:
                keep, control = 0, control & ~ENABLE
                self.in_fifo[n].clear()
                self.in_flags[n] |= 2
            self.in_control[n] = control | keep | (ACTIVE if n == 0 else 0)
        elif register == 0x08:
            self.in_flags[n] &= ~value
        elif register == 0x10:
            self.in_size[n] = value

    def write_out(self, n, register, value):
        if register == 0x00:
            if value & CNAK:
                self.out_refuses[n] = False
            if value & SNAK:
                self.out_refuses[n] = True
            self.out_control[n] = value & ~(COMMANDS | ENABLE)
        elif register == 0x08:
            self.out_flags[n] &= ~value
        elif register == 0x10:
            self.out_size[n] = value

    # --- what a host meets

    def take_out_of_use(self):
        """A reset of the bus takes the endpoints but 0 out of use (RM0090 34.16.4, USBAEP)."""
        for control in (self.in_control, self.out_control):
            control[1:] = [value & ~ACTIVE for value in control[1:]]

    def push(self, kind, endpoint, data=b""):
        padded = data + bytes(-len(data) % 4)
        words = struct.unpack(f"<{len(padded) // 4}I", padded)
        self.received.append((endpoint | len(data) << 4 | kind << 17, words))
        self.raise_interrupt()

    def is_in_use(self, control, n):
        return not n or control[n] & ACTIVE

    def take(self, n):
        """A whole IN packet of an endpoint, None while it refuses or is not in use, or "stall"."""
        if not self.is_in_use(self.in_control, n):
            return None
        if self.in_control[n] & STALL:
            return "stall"
        size = self.in_size[n] & 0x7FFFF
        if self.in_refuses[n] or not self.in_control[n] & ENABLE or len(self.in_fifo[n]) < size:
            return None
        data = bytes(self.in_fifo[n][:size])
        del self.in_fifo[n][: (size + 3) // 4 * 4]
        self.in_control[n] &= ~ENABLE
        self.in_size[n] = 0
        self.in_flags[n] |= 1
        self.raise_interrupt()
        return data

    def offer(self, n, data=b""):
        """Sends an OUT packet to an endpoint: whether it takes that, None while it refuses or is not in use, or "stall"."""
        if not self.is_in_use(self.out_control, n):
            return None
        if self.out_control[n] & STALL:
            return "stall"
        if self.out_refuses[n]:
            return None
        self.out_refuses[n] = True
        self.push(OUT_DATA, n, data)
        self.push(OUT_DONE, n)
        return True

    def setup(self, kind, request, value, index, length):
        """The first packet of a control transfer, which every device must take at any time (USB 2.0, 8.5.3)."""
        self.in_control[0] &= ~STALL
        self.out_control[0] &= ~STALL
        # The core internally sets the IN NAK and OUT NAK bits (RM0090 34.17.5): what was to be sent before is not sent any
        # more, however late the program looks at the packet.
        self.in_refuses[0] = self.out_refuses[0] = True
        # The core counts down how many more it can keep (RM0090 34.17.5).
        self.out_size[0] -= SETUP_COUNT if self.out_size[0] >= SETUP_COUNT else 0
        self.push(SETUP_DATA, 0, struct.pack("<BBHHH", kind, request, value, index, length))
        self.push(SETUP_DONE, 0)
