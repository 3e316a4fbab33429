"""``python -m slipline`` is the program that the wheel installs beside the package: the window and the command line."""

import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

NONE = (
    "slipline: this package was built from source, without the program: install the wheel, or build the program by "
    "`cargo install slipline`"
)


def program() -> Path | None:
    """The program of this very package, whichever ``slipline`` comes first on the PATH; ``None`` where it was built without."""
    for file in metadata.files("slipline") or ():
        if file.name in {"slipline", "slipline.exe"} and file.parent.name in {"bin", "Scripts"}:
            return Path(str(file.locate()))
    return None


def main() -> int:
    """Runs the program with the words that follow, in place of this one where the system can; else returns its exit code."""
    found = program()
    if found is None:
        print(NONE, file=sys.stderr)
        return 1
    words = [str(found), *sys.argv[1:]]
    if os.name != "nt":
        # Signals reach the program itself, which stops the device.
        os.execv(found, words)
    return subprocess.run(words).returncode


if __name__ == "__main__":
    sys.exit(main())
