"""A small full-speed host on the other end of the cable of an OTG_FS core.

The host resets the bus, enumerates, sets line coding and DTR, and then moves bulk packets, every `POLL` seconds of the
board's time. It may be unplugged, it may stop reading, it may reset the bus at any moment, with or without enumerating,
let it fall asleep, and begin a control transfer that it does not end.
"""
import struct

from .usb_core import ENUMDNE, USBRST, USBSUSP, WKUPINT, UsbCore


class UsbHost(UsbCore):
    POLL = 50e-6
    # A bus without start-of-frame for 3 ms is suspended.
    SUSPEND = 3e-3

    def __init__(self, board):
        self.is_plugged = self.reads = self.enumerates = True
        # Bytes in each full packet to the device; an endpoint takes 64 at most.
        self.packet = 64
        self.sessions = 0
        super().__init__(board)

    def reset(self):
        """The host sees the device go."""
        super().reset()
        self.forget()

    def forget(self):
        """The host's side of a connection restarts."""
        self.transfer = None
        self.to_device, self.from_device = bytearray(), bytearray()
        self.packets = []
        self.is_configured, self.is_awake = False, True
        self.bulk_in = self.bulk_out = None
        self.descriptor, self.configuration, self.strings, self.takes_data = None, None, {}, None
        self.generation = getattr(self, "generation", 0) + 1

    # --- the cable

    def plan(self, seconds, call):
        generation = self.generation

        def run():
            if generation == self.generation:
                call()

        self.board.at(self.board.now + seconds * self.board.CORE_HZ, run)

    def pulled_up(self):
        if self.is_plugged:
            self.plan(1e-3, self.bus_reset)

    def bus_reset(self):
        """The host forgets the device."""
        self.forget()
        self.take_out_of_use()
        self.shows(USBRST)
        self.plan(2e-4, self.speed_known)

    def speed_known(self):
        self.shows(ENUMDNE)
        self.transfer = self.enumerate() if self.enumerates else None
        self.plan(5e-4, self.poll)

    def unplug(self):
        """Pulls the cable. An STM32 that does not watch VBUS sees only that the bus falls asleep."""
        self.is_plugged = False
        self.forget()
        self.plan(self.SUSPEND, lambda: self.shows(USBSUSP))

    def fall_asleep(self):
        """The host sends nothing any more, not even the start of a frame: a laptop whose lid is closed."""
        self.is_awake = False
        self.plan(self.SUSPEND, lambda: None if self.is_awake else self.shows(USBSUSP))

    def wake_up(self):
        self.is_awake = True
        self.shows(WKUPINT)

    def plug(self):
        self.is_plugged = True
        self.forget()
        self.plan(1e-2, self.bus_reset)

    # --- transfers

    def poll(self):
        if self.transfer and self.is_awake:
            try:
                next(self.transfer)
            except StopIteration:
                self.transfer = None
        if self.is_configured and self.is_awake:
            self.move_bulk()
        self.plan(self.POLL, self.poll)

    def move_bulk(self):
        while self.reads:
            packet = self.take(self.bulk_in)
            if packet is None or packet == "stall":
                break
            self.packets.append(len(packet))
            self.from_device += packet
        packet = bytes(self.to_device[: self.packet])
        if packet and len(self.received) < 2 and self.offer(self.bulk_out, packet) is True:
            del self.to_device[: self.packet]

    def control(self, kind, request, value, index, length=0, data=b"", packet=64):
        """A control transfer, as a generator that waits by yielding; returns what was read, or None for a stall. `packet`:
        bytes in each packet to the device."""
        length = length or len(data)
        self.setup(kind, request, value, index, length)
        yield
        if not kind & 0x80:
            for i in range(0, len(data), packet):
                if (yield from self.give(data[i : i + packet])) == "stall":
                    return None
            while (packet := self.take(0)) is None:
                yield
            return None if packet == "stall" else b""
        read = b""
        while True:
            packet = self.take(0)
            if packet == "stall":
                return None
            if packet is None:
                yield
                continue
            read += packet
            if len(packet) < 64 or len(read) >= length:
                break
        yield from self.give(b"")
        return read

    def give(self, data):
        """Gives the control endpoint a packet; returns True or "stall"."""
        while not (taken := self.offer(0, data)):
            yield
        yield
        return taken

    def enumerate(self):
        self.descriptor = yield from self.control(0x80, 6, 0x100, 0, 18)
        yield from self.control(0x00, 5, 7, 0)
        head = yield from self.control(0x80, 6, 0x200, 0, 9)
        total = struct.unpack_from("<H", head, 2)[0]
        self.configuration = yield from self.control(0x80, 6, 0x200, 0, total)
        for i in (1, 2, 3):
            text = yield from self.control(0x80, 6, 0x300 | i, 0x409, 255)
            self.strings[i] = text[2:].decode("utf-16le") if text else None
        i = 0
        while i < len(self.configuration):
            length, kind = self.configuration[i], self.configuration[i + 1]
            if kind == 5 and self.configuration[i + 3] & 3 == 2:
                address = self.configuration[i + 2]
                if address & 0x80:
                    self.bulk_in = address & 15
                else:
                    self.bulk_out = address
            i += length
        yield from self.control(0x00, 9, 1, 0)
        self.takes_data = (yield from self.control(0x21, 0x20, 0, 0, data=struct.pack("<IBBB", 115200, 0, 0, 8))) == b""
        yield from self.control(0x21, 0x22, 3, 0)
        self.is_configured = True
        self.sessions += 1

    # --- what a test uses

    def send(self, data):
        self.to_device += data

    def receive(self):
        data = bytes(self.from_device)
        self.from_device.clear()
        return data
