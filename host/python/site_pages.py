"""A hook of mkdocs: the site's pages that do not lie in docs/.

- ``index.md`` is README.md, the page of the package.
- Pages of the repository that a page links to come along, below ``repository/``, with their pictures: PLATES.md, PHYSICS.md ..
- A notebook is a page, with its outputs where ``SLIPLINE_NOTEBOOKS`` names the folder of the executed ones.
"""

from __future__ import annotations

import base64
import json
import os
import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

PACKAGE = Path(__file__).resolve().parent
ROOT = PACKAGE.parents[1]
#: A link or a picture of Markdown: its text, and its target without and with the anchor.
LINK = re.compile(r"(?P<mark>!?)\[(?P<text>[^\]]*)\]\((?P<target>[^)\s#]+)(?P<anchor>#[^)\s]*)?\)")
#: Places in the site by the paths of the repository, filled by `on_files`.
places: dict[str, str] = {}


def on_files(files: Files, config: Any) -> Files:
    """Adds the pages, and what they link to."""
    places.clear()
    docs = "host/python/docs/"
    for file in files:
        places[docs + file.src_uri] = file.src_uri
    places["host/python/README.md"] = "index.md"
    files.append(File.generated(config, "index.md", content=(PACKAGE / "README.md").read_text(encoding="utf-8")))
    linked = {target for path in [*places] if path.endswith(".md") for target in _targets(path)}
    for path in sorted(linked - places.keys()):
        _add(files, config, path)
        for picture in _targets(path, pictures_only=True) if path.endswith(".md") else ():
            _add(files, config, picture)
    for file in [file for file in files if file.src_uri.endswith(".ipynb")]:
        files.remove(file)
        page = file.src_uri.removesuffix(".ipynb") + ".md"
        places[docs + file.src_uri] = page
        files.append(File.generated(config, page, content=_notebook(Path(file.abs_src_path or ""))))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Leads links to where their files are in the site; of a link to another file the text stays."""
    here = page.file.src_uri
    source = next((path for path, place in places.items() if place == here), here)

    def rewritten(found: re.Match[str]) -> str:
        if "://" in found["target"]:
            return found[0]
        place = places.get(_path(source, found["target"]))
        if place is None:
            return found["text"]
        target = posixpath.relpath(place, posixpath.dirname(here) or ".")
        return f"{found['mark']}[{found['text']}]({target}{found['anchor'] or ''})"

    return LINK.sub(rewritten, markdown)


def _path(source: str, target: str) -> str:
    """The path of a link's target in the repository."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(source), target))


def _targets(source: str, *, pictures_only: bool = False) -> list[str]:
    """The files of the repository to which a page links."""
    links = LINK.finditer((ROOT / source).read_text(encoding="utf-8"))
    paths = [_path(source, link["target"]) for link in links if "://" not in link["target"] and (link["mark"] or not pictures_only)]
    return [path for path in paths if (ROOT / path).is_file()]


def _add(files: Files, config: Any, path: str) -> None:
    if path not in places:
        places[path] = f"repository/{path}"
        files.append(File.generated(config, places[path], abs_src_path=str(ROOT / path)))


def _notebook(path: Path) -> str:
    """A notebook as a page."""
    executed = os.environ.get("SLIPLINE_NOTEBOOKS")
    if executed:
        path = Path(executed) / path.name
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        parts.extend(_output(output) for output in cell.get("outputs", ()))
    return "\n\n".join(parts) + "\n"


def _output(output: Any) -> str:
    """An output of a cell: a picture, a table or a text; nothing of the error stream, which has progress."""
    if output.get("name") == "stderr":
        return ""
    data = output.get("data", {})
    if "image/png" in data:
        # As base64 has it, on one line.
        picture = base64.b64encode(base64.b64decode(data["image/png"])).decode()
        return f'<img alt="{output["output_type"].replace("_", " ")}" src="data:image/png;base64,{picture}">'
    if "text/html" in data:
        return f"<div markdown=\"0\">\n{''.join(data['text/html'])}\n</div>"
    text = "".join(output.get("text") or data.get("text/plain", ""))
    return f"```text\n{text.rstrip()}\n```"
