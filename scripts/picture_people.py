"""Draw people and animals in a living room, or animals alone.

python scripts/picture_people.py FILE [--animals]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

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

BETWEEN_S, SECONDS = 4, 8
"""One after another takes its place."""

LIES_S = 14
"""After which all animals rest."""


ANIMALS = """
version: 1
room: {size: [5, 4.4, 2.6]}
objects:
  - {name: couch, asset: couch_02, position: [0, 1.65, 0], rotation: [0, 0, -90], static: true}
  - {name: black, asset: cat_03, position: [-0.5, 0.6, 0], rotation: [0, 0, 90],
     behaviours: [{type: lie, beds: [couch]}]}
  - {name: ginger, asset: cat_02, position: [0.8, 0.25, 0], rotation: [0, 0, -20]}
  - {name: tabby, asset: cat_01, position: [0.3, -0.25, 0], rotation: [0, 0, 205],
     behaviours: [{type: lie}]}
  - {name: beagle, asset: dog_01, position: [-0.95, 0.0, 0], rotation: [0, 0, -40]}
  - {name: retriever, asset: dog_02, position: [-0.1, 0.35, 0], rotation: [0, 0, -30],
     behaviours: [{type: lie}]}
  - {name: small, asset: dog_03, position: [1.35, 0.75, 0], rotation: [0, 0, -105],
     behaviours: [{type: sit}]}
lights:
  - {name: sun, type: directional, direction: [-0.6, 0.5, -1], intensity: 1.5}
  - {name: lamp, type: point, position: [0.6, 0, 2.4], intensity: 12}
"""
ANIMALS_EYE, ANIMALS_TARGET = (0.1, -1.5, 0.95), (0.1, 0.5, 0.24)


def main() -> None:
    """Draw them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("output", type=Path)
    parser.add_argument("--animals", action="store_true")
    options = parser.parse_args()
    eye = AgentSpec(name="eye", intrinsics=LENS, following=False)
    picture = _animals(eye) if options.animals else _family(eye)
    cv2.imwrite(str(options.output), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    print(f"{options.output}: {options.output.stat().st_size / 1e3:.0f} kB")


def _animals(eye: AgentSpec) -> NDArray[np.uint8]:
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "animals.yaml"
        scene.write_text(ANIMALS)
        with Simulation(scene, mode="lockstep", seed=1, agent=eye) as simulation:
            simulation.set_pose(look_at(ANIMALS_EYE, ANIMALS_TARGET), teleport=True)
            simulation.step(240 * LIES_S)
            return np.array(simulation.capture("rgb")["rgb"])


def _family(eye: AgentSpec) -> NDArray[np.uint8]:
    ensure_baked("room_02", allow_modules=False)
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
        return np.array(simulation.capture("rgb")["rgb"])


if __name__ == "__main__":
    main()
