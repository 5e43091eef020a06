"""Normal maps and metallic-roughness maps in one texture."""

from __future__ import annotations

import numpy as np

from sailenv_ros.render.scene.packed_maps import pack_maps
from sailenv_ros.types.model import Material


def test_both_maps_keep_what_they_hold() -> None:
    """Normal's x and y, then roughness (green) and metallic (blue)."""
    random = np.random.default_rng(3)
    finish, normal = random.integers(0, 256, (2, 8, 16, 4)).astype(np.uint8)
    joined = pack_maps(Material(metallic_roughness_texture=finish, normal_texture=normal))
    assert joined is not None
    assert (joined[..., :2] == normal[..., :2]).all()
    assert (joined[..., 2:] == finish[..., 1:3]).all()


def test_the_smaller_map_is_brought_to_the_greater() -> None:
    """Whichever it is; a plain one stays plain."""
    small, large = np.full((4, 4, 4), 77, np.uint8), np.full((16, 8, 4), 200, np.uint8)
    one = pack_maps(Material(metallic_roughness_texture=small, normal_texture=large))
    other = pack_maps(Material(metallic_roughness_texture=large, normal_texture=small))
    assert one is not None
    assert other is not None
    assert one.shape == other.shape == (16, 8, 4)
    assert (one == [200, 200, 77, 77]).all()
    assert (other == [77, 77, 200, 200]).all()


def test_one_map_or_none() -> None:
    """What is not there holds nothing of meaning; without both there is no texture."""
    only = np.full((4, 4, 4), 9, np.uint8)
    finish = pack_maps(Material(metallic_roughness_texture=only))
    normal = pack_maps(Material(normal_texture=only))
    assert finish is not None
    assert (finish[..., 2:] == 9).all()
    assert normal is not None
    assert (normal[..., :2] == 9).all()
    assert pack_maps(Material()) is None
