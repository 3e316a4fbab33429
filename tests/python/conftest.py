"""The command line beside the package: what one prints, the other returns."""

import json
import os
import signal
import subprocess

import pytest

# Started in the background by a script they have Ctrl-C ignored, and so would the programs that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

PROGRAM = os.environ.get("SLIPLINE", "slipline")


class Command:
    """A command of ``slipline --json`` that runs while the test computes the same."""

    def __init__(self, *arguments):
        line = [PROGRAM, *(str(argument) for argument in arguments), "--json"]
        self.line = " ".join(line)
        self.process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def answer(self, codes=(0, 3)):
        """Its object; 3 is the exit code of red lights."""
        out, errors = self.process.communicate()
        assert self.process.returncode in codes, f"{self.line}: {errors}"
        return json.loads(out)

    def refusal(self):
        """The object of its error."""
        out, errors = self.process.communicate()
        assert self.process.returncode in (1, 2), f"{self.line}: {out}"
        return json.loads(errors)


@pytest.fixture
def command():
    """Begins a command."""
    return Command
