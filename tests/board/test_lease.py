"""Arming is a lease: a host that only keeps alive is left by the device."""
import pytest

from host import RATE_HZ, drive
from messages import ArmLease
from rig import start


# The renderer's matter, not the chip's: the other images have it at night.
@pytest.mark.parametrize("later", [pytest.param(False, marks=pytest.mark.nightly), True], ids=["no other drive", "a later drive"])
def test_a_device_that_is_armed_on_a_lease_disarms_by_itself(armed, later):
    """R-81: a drive that is to begin later has not begun, and is dropped."""
    armed.host.accept("ArmFor", ArmLease(1000))
    at = start(armed)
    began = armed.board.seconds
    if later:
        armed.host.accept("Drive", drive([(0, 0.4, 0.3)], 2000, at + 3 * RATE_HZ))
    armed.board.is_hasty = True
    armed.host.live(0.9)
    assert armed.board.pin(armed.facts.unmute) == 1
    # The ramp of 30 ms, and the blocks of mid-scale behind it.
    armed.board.run_until(lambda: not armed.board.pin(armed.facts.unmute), 0.2, step=0.001)
    assert 1.02 < armed.board.seconds - began + 0.02 < 1.06
    status = armed.host.status()
    assert (status["state"], status["faults"]) == ("idle", set())
    assert status["now"] > at + 400_000
