"""The program's self-test of a board on a desk, in the board's own time.

    slipline's procedure, link and mirror <-- lines of a look --> Desk <-- bytes --> the cable of the model

The model is slower than the board, so `slipline selftest` itself, whose deadlines are the computer's, would find every answer late and
the clocks wrong. The program `selftest_in_step` of the test crate is the same procedure with the model's clock: its verdicts do not
depend on the computer.
"""
import json
import subprocess

from images import selftest_in_step

# Time between two looks of the program at its line, and the time after which a test that has not ended never will.
LOOK_US, PATIENCE = 1000, 60.0
# What the program asks a person, and the level of the user button then.
PRESSED = {"Press the user button now.": 1, "Press the user button now and hold it.": 1, "Let the user button go now.": 0}


class Desk:
    """`words` are those of `selftest_in_step`; `clock` is the host's time over the board's."""

    def __init__(self, rig, *words, clock=1.0):
        self.rig, self.clock = rig, clock
        self.program = subprocess.Popen([selftest_in_step(), *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        rig.board.run_until(lambda: rig.cable.is_configured, 0.2)
        self.began, self.looks, self.report = rig.board.seconds, 0, None
        # The person presses what is asked.
        self.obeys = True

    @property
    def seconds(self):
        """The board's time since the program began."""
        return self.rig.board.seconds - self.began

    def look(self, event=None):
        """Lets the board run and the program look once; `event`: "stop" is the user's. Returns whether the test has ended."""
        self.looks += 1
        self.rig.board.run(LOOK_US * 1e-6)
        received = self.rig.cable.receive().hex() or "-"
        time = round(self.looks * LOOK_US * self.clock)
        for on_line in (received, event) if event else (received,):
            self.program.stdin.write(f"{time} {on_line}\n".encode())
            self.program.stdin.flush()
            answer = self.program.stdout.readline().decode()
            assert answer, "the program has ended without a report"
            if answer.startswith("{"):
                self.report = json.loads(answer)
                self.program.wait()
                return True
            answer, prompt = answer.rstrip("\n").split(" ", 1)
            self.rig.cable.send(b"" if answer == "-" else bytes.fromhex(answer))
            if self.obeys and prompt in PRESSED:
                self.rig.board.pins.drive(self.rig.facts.button, PRESSED[prompt])
        return False

    def test(self):
        """The report of the whole test."""
        while self.report is None and not self.look():
            assert self.seconds < PATIENCE, "it never ends"
        return self.report

    def verdicts(self):
        """The steps' names by their verdicts, those that no version shows left out."""
        found = {}
        for step in self.report["steps"]:
            if step["name"] not in NEVER:
                found.setdefault(step["verdict"], []).append(step["name"])
        return found


# The steps that no message of today can show, and that of the amplifier, which is tested by itself.
NEVER = {"bootloader", "faults", "others", "amplifier"}
