"""The blocks of README and of the package's pages run, in order, and print what the pages say."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
PACKAGE = HERE.parents[1] / "host/python"
#: What a page uses beside the package: PsychoPy's calls, and a batch system that runs its jobs here.
STAND_INS = HERE / "stand_ins"
PAGES = [page for page in (PACKAGE / "README.md", *sorted((PACKAGE / "docs").glob("*.md"))) if "```python\n" in page.read_text()]


def run(page: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a page in a folder."""
    environment = {
        **os.environ,
        "MPLBACKEND": "Agg",
        "PATH": f"{STAND_INS / 'commands'}:{os.environ['PATH']}",
        "PYTHONPATH": str(STAND_INS),
    }
    line = [sys.executable, str(HERE / "page_blocks.py"), str(page)]
    return subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_blocks_of_a_page_run_and_print_what_the_page_says(page: Path, tmp_path: Path) -> None:
    done = run(page, tmp_path)
    assert done.returncode == 0, done.stderr
    print(f"{page.name}: {done.stdout}")


@pytest.mark.parametrize(
    "blocks, words",
    [
        ("```python\nprint(1)\n```\n\n```text\n2\n```\n", "line 4: the block prints\n1\n"),
        ("```python\npass\n```\n\nProse.\n\n```python\nraise ValueError\n```\n", "page.md\", line 10, in <module>"),
        ("```python\nx = 1\n```\n\n```text\n1\n```\n\nProse.\n\n```python\nprint(x)\n```\n", "line 4: the block prints\n"),
    ],
)
def test_another_text_and_an_exception_are_found_with_their_line(blocks: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text(f"# Page\n\n{blocks}")
    done = run(tmp_path / "page.md", tmp_path)
    assert done.returncode == 1 and words in done.stderr


def test_blocks_share_their_names_and_may_be_all_right(tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("```python\nx = 1\n```\n\n```python\nprint(x)\n```\n\n```text\n1\n```\n")
    done = run(tmp_path / "page.md", tmp_path)
    assert (done.returncode, done.stdout) == (0, "2 blocks\n"), done.stderr
