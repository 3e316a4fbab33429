"""The blocks of README and of the package's pages run, in order, and print what the pages say."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
PACKAGE = HERE.parents[1] / "host/python"
#: What a page uses beside the package: PsychoPy's calls, and a batch system that runs its jobs here.
STAND_INS = HERE / "stand_ins"
PAGES = [page for page in (PACKAGE / "README.md", *sorted((PACKAGE / "docs").glob("*.md"))) if "```python\n" in page.read_text()]


def run(page: Path, folder: Path) -> tuple[int, str, str]:
    """Runs a page in a folder: its exit code, what it printed, and its error stream."""
    environment = {
        **os.environ,
        "MPLBACKEND": "Agg",
        # Programs of packages, too.
        "PATH": f"{STAND_INS / 'commands'}:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(STAND_INS),
    }
    line = [sys.executable, str(HERE / "page_blocks.py"), str(page)]
    done = subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[Path, Future[tuple[int, str, str]]]]:
    """Two pages at a time: each waits for a device about as long as it computes."""
    with ThreadPoolExecutor(2) as pool:
        yield {page: pool.submit(run, page, tmp_path_factory.mktemp(page.stem)) for page in PAGES}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_blocks_of_a_page_run_and_print_what_the_page_says(page: Path, runs: dict[Path, Future[tuple[int, str, str]]]) -> None:
    code, _, errors = runs[page].result()
    assert code == 0, errors


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
    code, _, errors = run(tmp_path / "page.md", tmp_path)
    assert code == 1 and words in errors


def test_blocks_share_their_names_and_may_be_all_right(tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("```python\nx = 1\n```\n\n```python\nprint(x)\n```\n\n```text\n1\n```\n")
    assert run(tmp_path / "page.md", tmp_path) == (0, "2 blocks\n", "")
