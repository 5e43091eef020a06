"""Answers and expressions are found again in exported MJCF, by MuJoCo, and in COCO's masks.

    python benchmarks/judge_language.py write FOLDER [--rooms N] [--first K]
    python benchmarks/judge_language.py judge FOLDER

`write` makes pictures of generated rooms by several cameras, before and after some things were
moved and opened, with their questions, masks, and a model for each instant. `judge`, in an
environment with mujoco, scipy and pycocotools and without this project, prints for each kind of
question how many answers it finds the same, how often the commonest one is right, and what chance
is; then how many expressions are true of one object alone. It reads no proof. Colours are not
judged: neither file has them.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

LONG_S = 600.0
"""Time limit of one step, for busy machines [s]."""

CAMERAS = 12
KINDS = ("kitchen", "office", "living_room", "bedroom", "bathroom")


def write(folder: Path, rooms: int, first_room: int) -> None:
    """Write pictures, questions, masks and models of rooms, from a number on."""
    import dataclasses

    import numpy as np

    from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, export_scene
    from sailenv_ros.dataset.formats import DatasetWriter
    from sailenv_ros.simulation.scene_facts import scene_facts

    folder.mkdir(parents=True)
    images: list[dict[str, str]] = []
    lens = CameraIntrinsics(width=640, height=480)
    with DatasetWriter(folder / "data", ["vqa", "coco"]) as writer:
        for number in range(first_room, first_room + rooms):
            name = f"generated:{KINDS[number % len(KINDS)]}:{100 + number}"
            rng = np.random.default_rng(number)
            first = AgentSpec(name="camera_0", intrinsics=lens, following=False)
            with Simulation(name, mode="lockstep", light="plain", agent=first) as simulation:
                views = simulation.sample_cameras.within(LONG_S)(
                    "room_view", CAMERAS, agent="camera_0", seed=number
                )
                for place, view in enumerate(views):
                    if place:
                        spec = dataclasses.replace(first, name=f"camera_{place}")
                        simulation.register_agent(spec)
                    simulation.set_pose(view.pose, agent=f"camera_{place}")
                found = []
                for instant in range(2):
                    if instant:
                        _change(simulation, rng)
                    simulation.step(1)
                    file = f"{number}_{instant}.xml"
                    export_scene(simulation, folder / file)
                    facts = simulation.read(scene_facts, timeout_s=LONG_S)
                    for place in range(len(views)):
                        agent = f"camera_{place}"
                        frame = simulation.capture.within(LONG_S)(
                            ("rgb", "instance", "albedo"), agent=agent
                        )
                        _ = frame.amodal  # drawn now, as the simulation ends before it is written
                        told = dataclasses.replace(
                            frame, facts=facts, draw_amodal=frame.amodal_source
                        )
                        found.append((place, instant, told, file, agent))
            for _, _, frame, file, agent in sorted(found, key=lambda one: one[:2]):
                writer.add(frame)
                images.append({"model": file, "camera": agent})
        writer.finish()
    (folder / "images.json").write_text(json.dumps(images))


def _change(simulation, rng) -> None:  # type: ignore[no-untyped-def]
    """Move three things that lie loose, and open half of what opens."""
    joints = simulation.get_joints()
    on_joints = {joint.name for joint in joints}
    info = simulation.info
    loose = [
        one.name
        for one in info.instances
        if not (one.static or one.is_part or one.name in on_joints)
    ]
    for name in rng.permutation(sorted(loose))[:3].tolist():
        x, y, z = simulation.get_object(name).pose.position_m
        simulation.move_object(name, (x + rng.uniform(-0.2, 0.2), y + rng.uniform(-0.2, 0.2), z))
    for joint in joints:
        far = joint.high if abs(joint.high) > abs(joint.low) else joint.low
        if abs(far) < 10.0 and rng.random() < 0.5:
            simulation.set_joint_position(joint.name, far * rng.uniform(0.3, 1.0))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("write", "judge"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rooms", type=int, default=10)
    parser.add_argument("--first", type=int, default=0, help="number of the first room")
    parser.add_argument("--answers", type=int, default=10_500, help="so many are recomputed")
    parser.add_argument(
        "--part", type=int, nargs=2, default=(0, 1), metavar=("K", "N"), help="rooms k of n alone"
    )
    args = parser.parse_args()
    if args.what == "write":
        write(args.folder, args.rooms, args.first)
    else:
        sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
        from benchmarks.recomputed_answers import judge

        judge(args.folder, args.answers, *args.part)
