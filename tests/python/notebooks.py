"""Executes the package's notebooks, each in an empty folder, and writes them with their outputs: python notebooks.py FOLDER"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).resolve().parents[2] / "host/python/docs/notebooks"


def execute(path: Path, folder: Path) -> None:
    """Executes a notebook; raises ``CellExecutionError`` with the cell that fails."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    if any(cell.get("outputs") or cell.get("execution_count") for cell in notebook.cells):
        sys.exit(f"{path.name} has outputs: keep it without, they are made from it")
    with tempfile.TemporaryDirectory() as empty:
        NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": empty}}).execute()
    # The times of the cells would make other bytes of each execution.
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
    nbformat.write(notebook, folder / path.name)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        begin_s = time.monotonic()
        execute(path, target)
        print(f"{path.name}: executed in {time.monotonic() - begin_s:.0f} s")
