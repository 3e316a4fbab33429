"""``python -m slipline`` is the program of the wheel."""

import os
import subprocess
import sys
from importlib import metadata

import pytest

from slipline import __main__ as module


def test_a_package_without_the_program_says_how_to_get_it(monkeypatch, capsys):
    monkeypatch.setattr(metadata, "files", lambda name: [metadata.PackagePath("slipline/__init__.py")])
    assert module.main() == 1
    assert "cargo install slipline" in capsys.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="there the program is a process below")
def test_the_words_go_to_the_program_that_the_package_has_recorded(tmp_path):
    program = tmp_path / "bin" / "slipline"
    program.parent.mkdir()
    program.write_text('#!/bin/sh\necho "$@"\nexit 3\n')
    program.chmod(0o755)
    script = f"""
import sys
from importlib import metadata
from pathlib import Path
class Recorded:
    name, parent = "slipline", Path("../../../bin")
    def locate(self): return Path({str(program)!r})
metadata.files = lambda name: [Recorded()]
from slipline.__main__ import main
sys.argv = ["slipline", "drive", "--port", "sim"]
sys.exit(main())
"""
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (ended.stdout, ended.returncode) == ("drive --port sim\n", 3), ended.stderr
