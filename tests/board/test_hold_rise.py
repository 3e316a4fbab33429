"""The largest rise of a level hold on the very image that is flashed: it counts from the drive, whatever ends the holds since."""
import pytest

from host import BLOCK, RATE_HZ, drive
from rig import MID, MILLISECOND

# The sensor receives a third of what is played. To hold it at that, the tone would have to rise by 9.5 dB.
LEVEL, HEARD, RISE = 0.2, 3, 600
# Six windows with their pauses: a rise of 6 dB takes two, and a hold that may rise by as much again would do so.
WINDOW_BLOCKS, WINDOWS_SECONDS = 20, 6 * 32 * BLOCK / RATE_HZ
TABLE_GLIDE = 20 * MILLISECOND


def peak(rig):
    return max(abs(code - MID) for code in rig.codes(rig.played() - 4 * MILLISECOND, rig.played()))


def held(rig, asked_codes):
    """Holds the tone until nothing changes; its rise in dB, and the peak at the pin."""
    rig.host.hold([(0, asked_codes)], WINDOW_BLOCKS, RISE)
    rig.host.live(WINDOWS_SECONDS)
    progress, _, ((_, _, correction),) = rig.host.held()
    assert progress == "on"
    return correction, peak(rig)


# The application's matter, which the simulated device shows in the gate: to cool the coil takes long here.
@pytest.mark.nightly
def test_a_table_that_ends_a_hold_does_not_let_the_next_one_begin_raised(cool):
    """R-88: 6 dB in all. The coil is cool, or its heat would leave no room."""
    host, board = cool.host, cool.board
    board.adc.at_pins = lambda: (MID + (board.dac.output - MID) // HEARD, MID)
    host.accept("Drive", drive([(0, 0.4, LEVEL)], 5 * MILLISECOND))
    host.live(0.015)
    driven = peak(cool)
    for _ in range(2):
        rise, loudest = held(cool, driven)
        assert abs(rise - RISE / 100) < 0.02 and abs(loudest - 2 * driven) < 0.1 * driven, (rise, driven, loudest)
        host.upload(40)
        host.live(2 * TABLE_GLIDE / RATE_HZ)
        assert host.held()[0] == "ended"
