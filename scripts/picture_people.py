"""Draw people and animals in a living room: python scripts/picture_people.py FILE."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import cv2

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, Simulation, look_at
from sailenv_ros.cli.scene_bake import ensure_baked

LENS = CameraIntrinsics(width=1000, height=625, vertical_fov_deg=55.0)
EYE, TARGET = (-3.2, -1.75, 1.62), (-0.98, 0.7, 0.6)
QUALITY = 88
AWAY = ("tablet", "ochre cushion")
"""Things on the couch of the cat."""

FOR_LONG = (900.0, 900.0)
CAT: dict[str, Any] = {"type": "lie", "beds": ["leather couch"], "lying": FOR_LONG}
SITS: dict[str, Any] = {"type": "sit", "sitting": FOR_LONG}

BEINGS: tuple[tuple[str, tuple[float, float], float, dict[str, Any]], ...] = (
    ("cat_02", (-2.33, 1.1), 90.0, CAT),
    ("dog_01", (-0.95, -1.45), 150.0, {"type": "lie", "lying": FOR_LONG}),
    ("person_18", (-1.2, -0.7), 0.0, {**SITS, "seats": ["couch"]}),
    ("person_09", (-1.2, 1.35), -90.0, {**SITS, "seats": ["leather couch"]}),
    ("person_16", (-0.62, 1.2), 150.0, {}),
    ("person_01", (0.75, -0.75), 90.0, {}),
    ("person_22", (0.55, 0.25), -75.0, {}),
    ("person_07", (-0.35, -1.2), 180.0, {}),
)
"""Those who are there: asset, place [m], direction [deg], and what each does."""

BETWEEN_S, SECONDS = 4, 4
"""One after another takes its place."""


def main() -> None:
    """Draw them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path)
    output = parser.parse_args().output
    ensure_baked("room_02", allow_modules=False)
    eye = AgentSpec(name="eye", intrinsics=LENS, following=False)
    with Simulation("room_02", mode="lockstep", seed=1, agent=eye) as simulation:
        for name in AWAY:
            simulation.despawn_object(name)
        for asset, (x, y), yaw, does in BEINGS:
            pose = Pose.from_rpy_deg((x, y, 0.0), (0.0, 0.0, yaw))
            simulation.spawn_object(asset, object_name=asset, pose=pose, use_parent=False)
            if does:
                simulation.add_behaviour(asset, does)
                simulation.step(240 * BETWEEN_S)
        simulation.set_pose(look_at(EYE, TARGET), teleport=True)
        simulation.step(240 * SECONDS)
        picture = simulation.capture("rgb")["rgb"]
    cv2.imwrite(str(output), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    print(f"{output}: {output.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
