"""A stand-in for a device, with the calls that a list of trials uses, on a clock that only its calls move."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
import slipline
from slipline import _trial_play, trials
from slipline._rest import Rest

RATE_HZ = 400_000
CRC = "0badcafe"
PLACES = {"felt_edge_m": 0.2, "turning_point_m": 0.16, "frequency_hz": 126.5}


class Device:
    """Each drive begins a tenth of a second after the last call. Armed and left alone for a minute, it disarms itself."""

    sample_rate_hz = RATE_HZ

    def __init__(self, *, now: int = 1_000, started_s: float = 0.0, crc: str = CRC) -> None:
        self.now = now
        self.calls: list[tuple[Any, ...]] = []
        #: Called with the name of each call, before it.
        self.before: Callable[[str], object] = lambda _name: None
        self.plate: Any = None
        self._started_s = started_s
        self._crc = crc
        self._armed = True
        self._latest_s = self.seconds()

    def seconds(self) -> float:
        """This computer's clock."""
        return self._started_s + self.now / RATE_HZ

    def pass_s(self, seconds: float) -> None:
        """Time passes without a call."""
        self.now += round(seconds * RATE_HZ)

    def _call(self, name: str, *more: Any) -> None:
        self.before(name)
        alone_s = self.seconds() - self._latest_s
        self._latest_s = self.seconds()
        if self._armed and alone_s > 60.0:
            self._armed = False
            raise slipline.Unattended("no call came for 60 s, so the device was stopped and disarmed")
        if name != "status":
            self.calls.append((name, *more))

    def status(self) -> Any:
        self._call("status")
        table = SimpleNamespace(crc=self._crc, span_start_m=0.08, span_end_m=0.28)
        return SimpleNamespace(sample_rate_hz=float(RATE_HZ), now_samples=self.now, unit="unit-1", table=table)

    def arm(self, **consent: bool) -> None:
        self._call("arm")
        self._armed = True

    def rest(self) -> Rest:
        self._call("rest")
        self._armed = False
        return Rest(self)  # type: ignore[arg-type]

    def drive(self, *, level: float, tones: Any = (), **place: float) -> Any:
        self._call("drive", place, level, *tones)
        return self._begin([{**PLACES, **place, "level": level}, *({**PLACES, **tone} for tone in tones)])

    def play(self, texture: Any) -> Any:
        self._call("play")
        return self._begin([{**PLACES, "level": tone.level} for tone in texture.tones])

    def _begin(self, tones: list[dict[str, float]]) -> Any:
        if not self._armed:
            raise slipline.Refused("the device is not armed")
        self.now += 40_000
        crc = SimpleNamespace(crc=self._crc)
        heard = [SimpleNamespace(**tone) for tone in tones]
        return SimpleNamespace(at_samples=self.now, tones=heard, plate="membrane", table=crc, superseded=False)

    def wait(self, at: Any = None, *, seconds: float = 0.0) -> int:
        self._call("wait" if at is not None else "pause", *([round(seconds, 6)] if at is None else []))
        until = self.now + round(seconds * RATE_HZ) if at is None else at if isinstance(at, int) else at.at_samples
        self.now = max(self.now, until)
        return self.now

    def stop(self, *, at: int | None = None) -> int:
        self._call("stop" if at is None else "end")
        return self.now if at is None else at

    def names(self) -> list[str]:
        """The names of its calls."""
        return [call[0] for call in self.calls]


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Device]:
    """Makes a device, and makes its clock this computer's."""

    def make(**arguments: Any) -> Device:
        made = Device(**arguments)
        clock = SimpleNamespace(monotonic=made.seconds, time=lambda: 1_800_000_000.0 + made.seconds())
        monkeypatch.setattr(_trial_play, "time", clock)
        return made

    assert _trial_play.time is time
    return make


def run(device: Any, listed: Any, respond: Callable[[dict[str, Any]], Any], folder: Any, **more: Any) -> list[dict[str, str]]:
    """Runs trials into the file of :func:`events`."""
    return trials.run(device, listed, respond, folder=folder, **{"subject": "01", "task": "edge", **more})


def events(folder: Any) -> Any:
    """The path of the file that :func:`run` writes."""
    return folder / "sub-01" / "ses-01" / "beh" / "sub-01_ses-01_task-edge_events.tsv"
