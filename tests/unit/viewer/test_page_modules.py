"""Rules of the page's modules: all are type-checked, and each element has one owner."""

from __future__ import annotations

import re
from importlib.resources import files
from itertools import chain

import pytest

MODULES = {
    entry.name: entry.read_text(encoding="utf-8")
    for entry in (files("sailenv_ros.viewer") / "page").iterdir()
    if entry.name.endswith(".js")
}
LOOKED_UP = re.compile(r"""(?:\$|own|getElementById|querySelector)\(\s*["'`]#?([\w-]+)["'`]""")


@pytest.mark.parametrize("name", sorted(MODULES))
def test_a_module_is_checked_and_short(name: str) -> None:
    """From its first line on, without exceptions; no longer than a module in Python may be."""
    text = MODULES[name]
    assert text.startswith("// @ts-check\n")
    assert not re.findall(r"@ts-(?:ignore|nocheck|expect-error)", text)
    assert len(text.splitlines()) <= 350


def test_each_element_has_one_owner() -> None:
    """What index.html names is looked up in one module; others learn of it by the store."""
    page = (files("sailenv_ros.viewer") / "page" / "index.html").read_text(encoding="utf-8")
    named = set(re.findall(r'\bid="([\w-]+)"', page))
    owners: dict[str, set[str]] = {}
    for module, text in MODULES.items():
        for id_ in LOOKED_UP.findall(text):
            owners.setdefault(id_, set()).add(module)
    assert named
    assert set(owners) <= named
    assert {id_: found for id_, found in owners.items() if len(found) > 1} == {}


def test_nothing_is_global_and_nothing_is_asked_for_by_a_clock() -> None:
    """No module hangs anything on the window; the simulator tells what changes."""
    whole = "".join(chain.from_iterable(MODULES.values()))
    assert "window." not in whole
    assert "globalThis" not in whole
    assert "setInterval" not in whole
