"""`pack.yaml` is parsed once until it is changed."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros.assets import pack
from sailenv_ros.assets.pack import PACK_FILE, AssetPack
from sailenv_ros.errors import AssetError


def test_a_file_is_parsed_again_only_when_it_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each page that connects looks for skies in all packs, and costs nobody frames."""
    parsed: list[str] = []
    parse = pack.from_yaml
    monkeypatch.setattr(pack, "from_yaml", lambda text: parsed.append(text) or parse(text))
    (tmp_path / PACK_FILE).write_text("version: 1\ntitle: one\n")
    assert [AssetPack(tmp_path).content.title for _ in range(3)] == ["one"] * 3
    assert len(parsed) == 1
    (tmp_path / PACK_FILE).write_text("version: 1\ntitle: another\n")
    assert AssetPack(tmp_path).content.title == "another"
    (tmp_path / PACK_FILE).write_text("version: 1\ntitle: [\n")
    for _ in range(2):
        with pytest.raises(AssetError):
            AssetPack(tmp_path)
