"""What the sides of a box send out, against the light on them."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.light.relight.sent_light import sent_by_light, sent_by_probes
from sailenv_ros.types.baked_light import LIGHT_TERMS, ObjectLight, ProbeGrid
from sailenv_ros.types.geometry import Pose
from tests.support.tiny_scenes import box_mesh, model_of

GREY = (0.5, 0.5, 0.5, 1.0)
TURNED = Pose.from_rpy_deg((1.0, 2.0, 0.5), (0.0, 0.0, 90.0)).matrix()


def test_each_side_sends_out_what_arrives_there() -> None:
    """The terms say: even light 0.1, more from where the body's +x faces, rising with height."""
    bounced = np.zeros((1, LIGHT_TERMS, 3), np.float32)
    bounced[0, 0] = 0.1
    bounced[0, 4] = 0.3  # +x, everywhere
    bounced[0, 7] = 0.2  # +x, for each metre up
    direct = np.zeros((1, LIGHT_TERMS), np.float32)
    direct[0, 0] = 0.05
    axes = TURNED[:3, :3].T
    light = ObjectLight(bounced=bounced, direct=direct, axes=axes.astype(np.float32))
    normals = np.concatenate([axes, -axes]).astype(np.float32)
    positions = (TURNED[:3, 3] + 0.1 * normals).astype(np.float32)
    model = model_of(box_mesh(0.2), base_colour=GREY)
    sent = sent_by_light(light, positions, normals, model)
    albedo = sent[5, 0] / 0.15
    assert 0.4 < albedo < 0.6
    np.testing.assert_allclose(sent[1:] / albedo, 0.15, rtol=1e-4)
    np.testing.assert_allclose(sent[0] / albedo, 0.15 + 0.3 + 0.2 * 0.5, rtol=1e-3)


def test_probes_tell_where_light_comes_from() -> None:
    """Light that rises along the world's x is that of the side which faces there."""
    probes = np.zeros((2, 2, 2, 4, 3), np.float32)
    probes[..., 0, :], probes[..., 1, :] = 0.3, 0.2
    grid = ProbeGrid(origin_m=(0.0, 0.0, 0.0), spacing_m=(4.0, 4.0, 4.0), shape=(2, 2, 2))
    model = model_of(box_mesh(0.2), base_colour=GREY)
    sent = sent_by_probes(probes, grid, model, (1.0, 1.0, 1.0), TURNED)
    # The body's -y faces the world's x.
    expected = np.array([0.3, 0.1, 0.3, 0.3, 0.5, 0.3])
    assert sent.shape == (6, 3)
    assert sent[:, 1] / sent[0, 1] == pytest.approx(expected / 0.3, rel=1e-4)
