"""Builds the site of the package's pages without a network, and checks it: python docs_site.py SITE

``SLIPLINE_NOTEBOOKS`` names the folder of the executed notebooks.
"""

from __future__ import annotations

import html.parser
import os
import re
import socket
import sys
from pathlib import Path
from typing import Any

import griffe
from mkdocs.__main__ import cli

PACKAGE = Path(__file__).resolve().parents[2] / "host/python"
#: What a browser loads by itself: elements, and the attribute with the address.
LOADED = {"img": "src", "script": "src", "link": "href", "iframe": "src", "source": "src", "video": "src", "audio": "src"}
#: Links that name an address and load nothing.
NAMING = ("canonical", "prev", "next")
#: What the theme's script loads, and the mark of a page that has it: diagrams, the facts of a repository, and, for browsers of
#: before 2020, what they lack.
OF_THE_THEME = {
    "https://unpkg.com/mermaid@11/": 'class="mermaid"',
    "https://api.github.com/": 'data-md-component="source"',
    "https://unpkg.com/resize-observer-polyfill": None,
}


def refuse(*_: Any) -> None:
    """In place of a socket's connect."""
    raise OSError("the pages are built without a network")


class Loads(html.parser.HTMLParser):
    """The addresses elsewhere that a page loads."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Called for each element."""
        attributes = dict(attrs)
        address = attributes.get(LOADED.get(tag, "")) or ""
        if re.match(r"(https?:)?//", address) and attributes.get("rel") not in NAMING:
            self.found.append(address)


def loaded(site: Path) -> list[str]:
    """What the files of a site would load from elsewhere, each with its file."""
    found = []
    for path in sorted(site.rglob("*")):
        if path.suffix == ".html":
            text = path.read_text(encoding="utf-8")
            loads = Loads()
            loads.feed(text)
            found.extend(f"{path.name}: {address}" for address in loads.found)
            found.extend(f"{path.name}: {mark}" for mark in OF_THE_THEME.values() if mark and mark in text)
        elif path.suffix == ".css":
            addresses = re.findall(r"(?:url\(|@import)\s*['\"]?((?:https?:)?//[^'\")]*)", path.read_text(encoding="utf-8"))
            found.extend(f"{path.name}: {address}" for address in addresses)
        elif path.suffix == ".js" and "lunr" not in path.parts:
            addresses = re.findall(r"https?://[\w.-]*(?:unpkg|jsdelivr|cdnjs|googleapis|github)[^\"'` ]*", path.read_text(encoding="utf-8"))
            found.extend(f"{path.name}: {address}" for address in addresses if not address.startswith(tuple(OF_THE_THEME)))
    return found


def public_names() -> set[str]:
    """The package's public names, and those of the classes' methods and properties; of data, those with a text."""
    package = griffe.load("slipline", search_paths=[PACKAGE], allow_inspection=False)
    names = {f"slipline.{name}" for name in package.exports or () if not name.startswith("_") and not package[name].is_module}
    for module in (name for name in package.exports or () if package[name].is_module):
        exported = ((name, package[module][name]) for name in package[module].exports or ())
        names |= {f"slipline.{module}.{name}" for name, one in exported if not one.is_attribute or one.has_docstring}
    for name in [*names]:
        found = package[name.removeprefix("slipline.")]
        if found.is_class:
            names |= {f"{name}.{member}" for member, one in found.members.items() if not member.startswith("_") and one.has_docstring}
    return names


def main(site: Path) -> None:
    """Builds the site and checks it; ``SystemExit`` with what is wrong."""
    socket.socket.connect = refuse  # type: ignore[method-assign]
    socket.create_connection = refuse  # type: ignore[assignment]
    arguments = ["--quiet", "--strict", "--config-file", str(PACKAGE / "mkdocs.yml"), "--site-dir", str(site)]
    cli(["build", *arguments], standalone_mode=False)
    if found := loaded(site):
        sys.exit("loaded from elsewhere:\n" + "\n".join(found))
    anchors = set(re.findall(r'id="(slipline[^"]*)"', (site / "reference.html").read_text(encoding="utf-8")))
    if missing := public_names() - anchors:
        sys.exit(f"the reference lacks {', '.join(sorted(missing))}")
    if os.environ.get("SLIPLINE_NOTEBOOKS"):
        for page in (site / "notebooks").glob("*.html"):
            if 'src="data:image/png' not in page.read_text(encoding="utf-8"):
                sys.exit(f"{page.name} has no picture: its notebook was not executed")
    print(f"{len([*site.rglob('*.html')])} pages, {len(anchors)} names in the reference")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
