"""Hook of mkdocs: what pages link to outside of docs/ becomes part of the site.

Pages link to files of the repository (``../config/categories.yaml``), as readers of the repository
need it. On the site each such file lies below ``source/``, a folder is a page that lists its files.
A link to something that is not there ends the build, as every warning does.
"""

from __future__ import annotations

import re
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from mkdocs.structure.files import File, InclusionLevel

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]

_OUTSIDE = re.compile(r"(\]\(|\[[^\]]+\]: )((?:\.\./)+)([^)\s#]+)")
"""A Markdown link that leaves its folder: its beginning, the way up, the rest without an anchor."""


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add every file that pages link to outside of docs/."""
    for page in list(files.documentation_pages()):
        for match in _OUTSIDE.finditer(page.content_string):
            target = _target(page.src_uri, match)
            if target is not None:
                for added in _added(target, config):
                    if files.get_file_from_path(added.src_uri) is None:
                        files.append(added)
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links to where the files lie on the site."""
    up = "../" * page.file.src_uri.count("/")

    def led(match: re.Match[str]) -> str:
        target = _target(page.file.src_uri, match)
        if target is None:
            return match[0]
        return f"{match[1]}{up}{_place(target)}"

    return _OUTSIDE.sub(led, markdown)


def _target(page: str, match: re.Match[str]) -> Path | None:
    """Return the file or folder that is linked to; None where it lies in docs/ or is missing."""
    folder = (ROOT / "docs" / PurePosixPath(page)).parent
    target = (folder / match[2] / match[3]).resolve()
    if not target.exists() or target.is_relative_to(ROOT / "docs"):
        return None
    return target


def _place(target: Path) -> str:
    """Return the path on the site, from its root, as pages link to it."""
    name = target.relative_to(ROOT).as_posix()
    if target.is_dir():
        return f"source/{name}/index.md"
    return f"source/{name}.txt" if target.suffix == ".md" else f"source/{name}"


def _added(target: Path, config: MkDocsConfig) -> list[File]:
    if not target.is_dir():
        return [_file(target, config)]
    members = sorted(p for p in target.iterdir() if p.is_file() and not p.name.startswith("."))
    name = target.relative_to(ROOT).as_posix()
    listed = "\n".join(f"- [{p.name}]({Path(_place(p)).name})" for p in members)
    listing = File.generated(
        config,
        _place(target),
        content=f"# {name}\n\n{listed}\n",
        inclusion=InclusionLevel.NOT_IN_NAV,
    )
    return [listing, *(_file(member, config) for member in members)]


def _file(source: Path, config: MkDocsConfig) -> File:
    """Return a file of the site with the bytes of the source."""
    return File.generated(config, _place(source), abs_src_path=str(source))
