"""Commands and their answers: numbers, repeats, and the session."""
from __future__ import annotations

import queue
import threading
import time
from typing import Any, Optional, Union

from errors import Closed, DecodeError, NoAnswer, Refused
from frame import TO_DEVICE, TO_HOST, Frame, FrameReader
from messages import COMMANDS, EVENTS, Kind, kind_of
from stream import Stream

ANSWER_TIME_S = 0.2
REPEATS = 3
# These may keep the device busy with its flash.
SLOW_ANSWER_TIME_S = {"Store": 5.0, "Forget": 5.0}
_WRITE_TIME_S = 1.0
# Commands that are not numbered take sequences so far ahead of the numbered ones.
_UNNUMBERED_AHEAD = 0x8000
_UNNUMBERED_COUNT = 0x4000


class Channel:
    """Sends commands over a stream and matches the answers. Threads may share it; a stop waits for nothing."""

    def __init__(self, stream: Stream) -> None:
        self._stream = stream
        self.session = 0
        self.damaged = 0
        """Frames from the device that were damaged."""
        self.next_sequence = 1
        """The number of the next numbered command."""
        self._unnumbered = 0
        # One numbered command at a time; `_sending` guards the stream and what stands in frames.
        self._numbered = threading.Lock()
        self._sending = threading.Lock()
        self._waiting: dict[int, queue.Queue[Frame]] = {}
        self._ended: Optional[Exception] = None
        self._closing = threading.Event()
        self._reader = threading.Thread(target=self._read, name="slipline-reader", daemon=True)
        self._reader.start()

    def begin(self, session: int) -> None:
        """Enters a session that the device has begun."""
        with self._sending:
            self.session, self.next_sequence = session, 1

    def request(
        self, command: Union[str, Kind], value: Any = None, *, session: Optional[int] = None, repeats: int = REPEATS
    ) -> tuple[Frame, Any]:
        """Sends a command with its body and returns the answer: its frame and its value.

        `command` is the name of one of `COMMANDS`, or a kind of its own. The frame is of the present session unless
        `session` says otherwise. Raises `FieldError` before anything is sent, `Refused`, `NoAnswer`, or `Closed`.
        """
        kind = COMMANDS[command] if isinstance(command, str) else command
        kind.check(value)
        if not kind.numbered:
            return self._exchange(kind, value, session, repeats)
        with self._numbered:
            return self._exchange(kind, value, session, repeats)

    def send_bytes(self, data: bytes) -> None:
        """Writes bytes as they are."""
        with self._sending:
            self._stream.write(data, _WRITE_TIME_S)

    def close(self) -> None:
        """Ends the reader and closes the stream."""
        self._closing.set()
        self._reader.join(timeout=5)
        self._stream.close()

    def _exchange(self, kind: Kind, value: Any, session: Optional[int], repeats: int) -> tuple[Frame, Any]:
        answers: queue.Queue[Frame] = queue.Queue()
        with self._sending:
            sequence = self._take_sequence(kind)
            session = self.session if session is None else session
            self._waiting[sequence] = answers
        frame = Frame(TO_DEVICE, session, sequence, kind.id, kind.encode(value)).encode()
        try:
            for _ in range(1 + repeats):
                self.send_bytes(frame)
                answer = self._wait(answers, SLOW_ANSWER_TIME_S.get(kind.name, ANSWER_TIME_S))
                if answer is not None:
                    return answer, self._judge(kind, sequence, answer)
            raise NoAnswer(f"{kind.name}: no answer to {1 + repeats} frames of {ANSWER_TIME_S} s each")
        finally:
            with self._sending:
                del self._waiting[sequence]

    def _take_sequence(self, kind: Kind) -> int:
        if kind.numbered:
            sequence = self.next_sequence
            self.next_sequence = (sequence + 1) % 0x10000
            return sequence
        self._unnumbered = (self._unnumbered + 1) % _UNNUMBERED_COUNT
        return (self.next_sequence + _UNNUMBERED_AHEAD + self._unnumbered) % 0x10000

    def _wait(self, answers: queue.Queue[Frame], timeout_s: float) -> Optional[Frame]:
        # In small waits, to notice the end of the stream.
        until = time.monotonic() + timeout_s
        while True:
            left = until - time.monotonic()
            try:
                return answers.get(timeout=max(0.0, min(left, 0.05)))
            except queue.Empty:
                if self._ended is not None:
                    raise Closed(str(self._ended)) from self._ended
                if left <= 0:
                    return None

    def _judge(self, kind: Kind, sequence: int, answer: Frame) -> Any:
        answered_by = kind_of(answer.id)
        value = answered_by.decode(answer.body)
        if answered_by is not EVENTS["Refused"]:
            return value
        if kind.numbered and value.name in ("BadSequence", "StaleSession"):
            # These two refusals have not used the number.
            with self._sending:
                self.next_sequence = value.expected if value.name == "BadSequence" else sequence
        raise Refused(kind.name, value)

    def _read(self) -> None:
        frames = FrameReader()
        try:
            while not self._closing.is_set():
                for frame in frames.feed(self._stream.read(0.05)):
                    if isinstance(frame, DecodeError):
                        self.damaged += 1
                    elif frame.direction == TO_HOST:
                        with self._sending:
                            answers = self._waiting.get(frame.sequence)
                        if answers is not None:
                            answers.put(frame)
        except Closed as error:
            self._ended = error
        except Exception as error:  # No answer will come: the waiting call gets the cause.
            self._ended = error
