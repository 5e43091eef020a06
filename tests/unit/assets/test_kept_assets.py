"""Assets that are made when they are asked for: the same while in use, and few beside."""

from __future__ import annotations

import gc
import weakref

from sailenv_ros.assets.kept_assets import MAX_KEPT, KeptAssets
from sailenv_ros.types.model import Asset, Model


def _asset(number: int) -> Asset:
    name = f"thing_{number}"
    return Asset(
        name=name, display_name=name, category="", model=Model(name=name, parts=()), collision=()
    )


def test_what_is_in_use_is_the_same_object_and_others_go_when_there_are_many() -> None:
    kept: KeptAssets[int, Asset] = KeptAssets()
    used = kept.get(-1, lambda: _asset(-1))
    left = [weakref.ref(kept.get(k, lambda k=k: _asset(k))) for k in range(3 * MAX_KEPT)]
    gc.collect()
    assert [one() is not None for one in left] == 2 * MAX_KEPT * [False] + MAX_KEPT * [True]
    assert kept.get(-1, lambda: _asset(-2)) is used
    last = left[-1]()
    assert kept.get(3 * MAX_KEPT - 1, lambda: _asset(-2)) is last
