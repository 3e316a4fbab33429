"""Random actions of a USB host that follows no rule: what it sends, what it leaves unfinished, what it does to the bus.

An action is a tuple of its name and its arguments, so that a sequence can be printed, cut down, and played again.
"""

DESCRIPTOR, LINE_CODING = 6, 0x20
TO_DEVICE, FROM_DEVICE = 0x00, 0x80
# Bytes that a request announces: none, the lengths of the descriptors, one packet and its neighbours, the most there is.
LENGTHS = 0, 1, 2, 7, 8, 9, 18, 63, 64, 65, 128, 255, 1000, 0xFFFF
# Seconds: shorter than a poll of the host, than a suspension, and longer than both.
TIMES = 1e-5, 1e-4, 3e-4, 1e-3, 4e-3


def request(chance):
    """A setup packet's type, request, value, index and length: most of them known to a device, with arguments of any kind."""
    length = chance.choice(LENGTHS)
    endpoint = chance.choice([0, 1, 2, 3, 4, 5, 9, 15]) | chance.choice([0, 0x80])
    return chance.choice([
        lambda: (FROM_DEVICE, DESCRIPTOR, chance.randrange(17) << 8 | chance.randrange(6), chance.choice([0, 0x409]), length),
        # SET_ADDRESS, SET_CONFIGURATION, SET_INTERFACE and GET_INTERFACE.
        lambda: (TO_DEVICE, 5, chance.choice([0, 1, 7, 127, 128, 0xFFFF]), 0, 0),
        lambda: (TO_DEVICE, 9, chance.choice([0, 0, 1, 1, 2, 255]), 0, 0),
        lambda: (0x01, 11, chance.randrange(3), chance.randrange(4), 0),
        lambda: (0x81, 10, 0, chance.randrange(4), length),
        # GET_STATUS of the device, an interface and an endpoint; CLEAR_FEATURE and SET_FEATURE.
        lambda: (FROM_DEVICE | chance.randrange(4), 0, 0, endpoint, length),
        lambda: (chance.randrange(4), chance.choice([1, 3]), chance.randrange(3), endpoint, 0),
        # The class's: SET_LINE_CODING, GET_LINE_CODING, SET_CONTROL_LINE_STATE, SEND_BREAK.
        lambda: (0x21, LINE_CODING, 0, chance.randrange(3), length),
        lambda: (0xA1, 0x21, 0, chance.randrange(3), length),
        lambda: (0x21, chance.choice([0, 0x22, 0x23]), chance.randrange(4), chance.randrange(3), length),
        lambda: (chance.randrange(256), chance.randrange(256), chance.randrange(1 << 16), chance.randrange(1 << 16), length),
    ])()  # fmt: skip


def action(chance):
    return chance.choice([
        # A control transfer: the bytes of each packet to the device, how many packets from the device are fetched, and the
        # bytes of the packet that ends a transfer from the device (none, if the host knows the rules).
        *[lambda: (
            "control", request(chance), [chance.choice([0, 1, 7, 8, 63, 64]) for _ in range(chance.randrange(4))],
            chance.choice([0, 1, 9]), chance.choice([0, 0, 0, 1, 64]), chance.choice(TIMES),
        )] * 8,
        lambda: ("setups", [request(chance) for _ in range(chance.randrange(2, 4))], chance.choice(TIMES)),
        lambda: ("bulk", chance.randrange(1, 4), [chance.choice([0, 1, 63, 64]) for _ in range(chance.randrange(1, 5))]),
        lambda: ("fetch", chance.randrange(1, 4)),
        lambda: ("reads", chance.random() < 0.5),
        lambda: ("reset", chance.random() < 0.5, chance.choice(TIMES)),
        lambda: ("sleep", chance.choice(TIMES)),
        lambda: ("wake",),
        lambda: ("unplug", chance.choice(TIMES)),
        lambda: ("plug", chance.choice([1e-3, 0.012, 0.015])),
    ])()  # fmt: skip


def sequence(chance):
    return [action(chance) for _ in range(chance.randrange(2, 12))]


def play(rig, actions):
    """Plays them, one after the other, whatever the state of the bus. What a host sends over a cable that is pulled, or over
    a bus that it has put to sleep or resets, does not arrive."""
    chance = Bytes()
    for name, *arguments in actions:
        PLAYERS[name](rig.board, rig.cable, chance, *arguments)


class Bytes:
    """Bytes of every kind, none of which make a frame: a count, with a delimiter now and then."""

    def __init__(self):
        self.count = 0

    def take(self, length):
        self.count += length
        return bytes((self.count + i) % 251 for i in range(length))


def give_up_after(board, cable, transfer, seconds):
    cable.transfer = transfer
    end = board.seconds + seconds
    while cable.transfer and board.seconds < end:
        board.run(min(5e-5, seconds))
    cable.transfer = None


def control(board, cable, data, setup, packets, fetched, last, seconds):
    def transfer():
        cable.setup(*setup)
        yield
        if setup[0] & FROM_DEVICE:
            for _ in range(fetched):
                while (packet := cable.take(0)) is None:
                    yield
                if packet == "stall":
                    return
                if len(packet) < 64:
                    break
            yield from cable.give(data.take(last))
            return
        for length in packets:
            if (yield from cable.give(data.take(length))) == "stall":
                return
        while cable.take(0) is None:
            yield

    give_up_after(board, cable, transfer(), seconds)


def setups(board, cable, data, requests, seconds):
    def transfer():
        for setup in requests:
            cable.setup(*setup)
        yield

    give_up_after(board, cable, transfer(), seconds)
    board.run(seconds)


def bulk(board, cable, data, endpoint, packets):
    def transfer():
        for length in packets:
            packet = data.take(length)
            while not cable.offer(endpoint, packet):
                yield
            yield

    give_up_after(board, cable, transfer(), 1e-3)


def fetch(board, cable, data, endpoint):
    def transfer():
        while cable.take(endpoint) is None:
            yield

    give_up_after(board, cable, transfer(), 3e-4)


def reads(board, cable, data, is_so):
    cable.reads = is_so


def reset(board, cable, data, enumerates, seconds):
    if cable.is_plugged:
        cable.enumerates = enumerates
        cable.bus_reset()
    board.run(seconds)


def sleep(board, cable, data, seconds):
    if cable.is_plugged:
        cable.fall_asleep()
    board.run(seconds)


def wake(board, cable, data):
    if cable.is_plugged and not cable.is_awake:
        cable.wake_up()


def unplug(board, cable, data, seconds):
    cable.unplug()
    board.run(seconds)


def plug(board, cable, data, seconds):
    if not cable.is_plugged:
        cable.plug()
    board.run(seconds)


PLAYERS = {
    call.__name__: call for call in (control, setups, bulk, fetch, reads, reset, sleep, wake, unplug, plug)
}  # fmt: skip
