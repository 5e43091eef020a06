"""Frames of bent lenses as a pin-hole sees them: held against a pin-hole at the same place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, look_at
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.undistorted import undistorted

THINGS = """\
  - {name: ground, asset: plane, category: floor, static: true}
  - {name: desk, asset: cube, category: desk, static: true, scale: [0.8, 1.6, 0.7],
     position: [2, 0, 0.35]}
  - {name: ball, asset: sphere, category: toy, static: true, scale: 0.5, position: [2, 0.4, 0.95]}
"""
BENT = {
    "plumb_bob": {
        "distortion_model": "plumb_bob",
        "distortion": (-0.2, 0.05, 0.001, -0.001, 0.01),
        "fx_px": 150.0,
        "fy_px": 151.0,
        "cx_offset_px": 4.0,
    },
    "equidistant": {
        "distortion_model": "equidistant",
        "distortion": (0.01, -0.003, 0.001, 0.0),
        "fx_px": 90.0,
        "fy_px": 91.0,
        "max_angle_deg": 70.0,
    },
}
VIEWS = ("rgb", "depth", "range", "instance", "category", "normals", "albedo", "flow")
EYE = AgentSpec(
    name="eye",
    following=False,
    views=VIEWS,
    intrinsics=CameraIntrinsics(width=160, height=120),
    pose=look_at((0.0, -0.4, 1.3), (2.0, 0.0, 0.5)),
)


@pytest.mark.parametrize("name", BENT)
def test_a_pin_hole_sees_the_same(simulation: Simulation, name: str) -> None:
    simulation.set_intrinsics(CameraIntrinsics(width=160, height=120, **BENT[name]), agent="eye")
    bent = simulation.capture()
    found = undistorted(bent)
    straight = found.camera.intrinsics
    assert straight.is_pinhole
    assert (straight.fx, straight.cx, straight.cy) == (BENT[name]["fx_px"], 79.5, 59.5)
    simulation.set_intrinsics(straight, agent="eye")
    meant = simulation.capture()
    seen = found["instance"] > 0
    assert seen.mean() > 0.6
    same = seen & (found["instance"] == meant["instance"])
    assert same.sum() > 0.98 * seen.sum()
    # Within surfaces: at their edges pixels have one of two.
    inner = same.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(meant["instance"], step, axis) == meant["instance"]
            inner &= np.roll(found["instance"], step, axis) == found["instance"]
    for view, least in (("depth", 2e-3), ("range", 2e-3)):
        off = np.abs(found[view][inner] / meant[view][inner].astype(np.float64) - 1.0)
        assert np.percentile(off, 99.0) < least
        assert np.median(off) < 3e-5
    assert np.abs(found["rgb"].astype(int) - meant["rgb"])[inner].mean() < 2.0
    assert (found["category"] == meant["category"])[inner].all()
    assert np.abs(found["albedo"] - meant["albedo"])[inner].mean() < 1e-3
    assert "flow" not in found
    assert found.draw_amodal is None


def test_what_the_lens_did_not_see_is_empty(simulation: Simulation) -> None:
    lens = CameraIntrinsics(width=160, height=120, **{**BENT["equidistant"], "max_angle_deg": 35.0})
    simulation.set_intrinsics(lens, agent="eye")
    found = undistorted(simulation.capture())
    corner = found["instance"][:8, :8]
    assert not corner.any()
    assert not found["rgb"][:8, :8].any()
    assert np.isinf(found["depth"][:8, :8]).all()
    assert found["instance"][60, 80]


def test_pin_holes_stay_and_parallel_rays_are_refused(simulation: Simulation) -> None:
    simulation.set_intrinsics(CameraIntrinsics(width=160, height=120), agent="eye")
    frame = simulation.capture()
    again = undistorted(frame)
    assert again.camera.intrinsics.fx == frame.camera.intrinsics.fx
    assert (again["rgb"] == frame["rgb"]).all()
    parallel = CameraIntrinsics(
        width=160, height=120, distortion_model="orthographic", fx_px=60.0, fy_px=60.0
    )
    camera = replace(frame.camera, intrinsics=parallel)
    with pytest.raises(InvalidRequest, match="parallel rays"):
        undistorted(replace(frame, camera=camera))
