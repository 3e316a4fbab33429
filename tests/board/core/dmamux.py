"""The request router (DMAMUX1: RM0440 chapter 13, RM0433 chapter 17): which peripheral's request reaches which stream."""


class Dmamux:
    CHANNELS = 16
    # Requests only: no synchronisation, no generator.
    REQUEST = 0x7F

    def __init__(self):
        self.reset()

    def reset(self):
        self.routes = [0] * self.CHANNELS
        self.reached = {}

    def channels(self, request):
        """The DMA channels, counted over both controllers, that a request reaches."""
        if request not in self.reached:
            self.reached[request] = [channel for channel, route in enumerate(self.routes) if route & self.REQUEST == request]
        return self.reached[request]

    def read(self, offset):
        assert offset < 4 * self.CHANNELS, f"DMAMUX1 has no modelled register {offset:#x}"
        return self.routes[offset // 4]

    def write(self, offset, value):
        assert offset < 4 * self.CHANNELS, f"DMAMUX1 has no modelled register {offset:#x}"
        assert not value & ~self.REQUEST, "only the request's number is modelled"
        self.routes[offset // 4] = value
        self.reached = {}
