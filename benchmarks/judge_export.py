"""Has exported rooms and furniture judged by the programs that they are for, a line for each.

    python3.11 -m venv judges/usd && judges/usd/bin/pip install usd-core usd-validation-nvidia
    python3.11 -m venv judges/usd25 && judges/usd25/bin/pip install usd-core==25.11
    python3.12 -m venv judges/rep158 && judges/rep158/bin/pip install ros-openusd-compliance-checker
    npm install --prefix judges gltf-validator@2.0.0-dev.3.10
    apt install blender python3-numpy libsdformat-dev
    g++ benchmarks/sdf_poses.cpp -o judges/sdf_poses $(pkg-config --cflags --libs sdformat12)
    python benchmarks/judge_export.py --judges judges room_01 generated:kitchen:17 wardrobe~hinged:7

Needs sailenv_ros with MuJoCo; a judge that is not installed is left out, and said. Names with a
tilde are pieces of furniture.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros import Simulation
from sailenv_ros.scene_export import export_asset, export_scene
from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.gathering import agents_in, asset_world, exported_world
from sailenv_ros.scene_export.glb import write_glb
from sailenv_ros.scene_export.names import identifier
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.world.world import World

SETTLING_S = 2.0
"""For so long MuJoCo lets things rest; none may have moved by more than 5 mm."""

OPENING_S = 6.0

LEAST_PX = 200

GLTF = """
const v = require("gltf-validator"), fs = require("fs");
v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])), {maxIssues: 0}).then((r) =>
  console.log(JSON.stringify({errors: r.issues.numErrors, warnings: r.issues.numWarnings})));
"""

USD = """
import json, sys
from pxr import Usd, UsdGeom, UsdValidation
stage = Usd.Stage.Open(sys.argv[1])
validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
errors = UsdValidation.ValidationContext(validators).Validate(stage)
cache, poses = UsdGeom.XformCache(), {}
for prim in stage.GetDefaultPrim().GetChild("Objects").GetChildren():
    rows = cache.GetLocalToWorldTransform(prim)
    poses[prim.GetDisplayName()] = [list(rows.GetRow(row)) for row in range(4)]
print(json.dumps({"validators": len(validators), "errors": [e.GetName() for e in errors],
                  "poses": poses}))
"""

COMPLIANCE = """
import json, sys
from pxr import UsdUtils
checker = UsdUtils.ComplianceChecker(arkit=False, skipARKitRootLayerCheck=True)
# Wheels lack the definitions of shaders that it compares with; the judge of 26.11 has them.
for rule in [r for r in checker._rules if "ShaderProperty" in type(r).__name__]:
    checker._rules.remove(rule)
checker.CheckCompliance(sys.argv[1])
print(json.dumps({"errors": checker.GetErrors() + checker.GetFailedChecks(),
                  "warnings": len(checker.GetWarnings())}))
"""

Judge = Callable[["Judged"], str]


@dataclass(frozen=True, kw_only=True)
class Judged:
    """An exported file: of what, where judges are, what it holds, and how its world is built."""

    name: str
    file: Path
    judges: Path
    scene: ExportedScene
    build: Callable[[], World]


def judge_gltf(one: Judged) -> str:
    """Count errors and warnings of Khronos' validator."""
    if not (one.judges / "node_modules" / "gltf-validator").is_dir():
        return "gltf-validator is not installed"
    done = subprocess.run(
        ["node", "-e", GLTF, str(one.file)],
        cwd=one.judges,
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(done.stdout)
    return f"gltf-validator: {found['errors']} errors, {found['warnings']} warnings"


def judge_blender(one: Judged) -> str:
    """Compare the outlines of all objects by Blender's own rendering with our ids."""
    program = shutil.which("blender")
    if program is None or "~" in one.name:
        return "Blender is not installed" if program is None else "Blender: rooms alone"
    lens = CameraIntrinsics(width=640, height=480)
    with closing(one.build()) as world, tempfile.TemporaryDirectory() as folder:
        seen = exported_world(world, agents_in(world, [AgentSpec(name="own", intrinsics=lens)]))
        file = Path(folder) / "seen.glb"
        file.write_bytes(write_glb(seen, "").data)
        script = str(Path(__file__).with_name("blender_ids.py"))
        command = [program, "-b", "-P", script, "--", str(file), "own", "640", "480", folder]
        plain = {"HOME": folder, "PATH": "/usr/bin:/bin"}  # Debian's own Python
        subprocess.run(command, env=plain, capture_output=True, check=True)
        theirs = np.load(Path(folder) / "ids.npy")
    with Simulation(one.name, mode="lockstep", light="plain", width=640, height=480) as simulation:
        ours = np.asarray(simulation.capture("instance", agent="own")["instance"])
    # Leaves outside are cut out of a filtered picture, by each program in its way.
    left_out = {0, *(body.instance.id for body in seen.bodies if body.is_outside)}
    overlaps = []
    for number in set(np.unique(ours).tolist()) - left_out:
        first, second = ours == number, theirs == number
        if first.sum() >= LEAST_PX:
            overlaps.append((first & second).sum() / (first | second).sum())
    kept = ~np.isin(ours, list(left_out))
    differ = int((ours != theirs)[kept].sum())
    return (
        f"Blender: IoU of {len(overlaps)} objects of {LEAST_PX} px and more from "
        f"{min(overlaps):.4f}; {differ} of {int(kept.sum())} pixels of objects differ"
    )


def judge_mujoco(one: Judged) -> str:
    """Load, compare poses and axes with ours, let rest, and push every joint to its limits."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(one.file))
    data = mujoco.MjData(model)

    def begin() -> None:
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        else:
            mujoco.mj_resetData(model, data)
        mujoco.mj_forward(model, data)

    begin()
    off, tilt = 0.0, 0.0
    for body in one.scene.bodies:
        if not body.is_outside:
            at = data.xpos[model.body(body.name).id]
            off = max(off, float(np.abs(at - body.pose.position_m).max()))
        if body.joint is not None and body.joint.type != "fixed":
            axis = body.pose.matrix()[:3, :3] @ np.array(body.joint.axis)
            found = data.xaxis[model.joint(body.name).id]
            tilt = max(tilt, float(np.abs(found - axis).max()))
    before = data.xpos.copy()
    while data.time < SETTLING_S:
        mujoco.mj_step(model, data)
    moved = 1000.0 * np.linalg.norm(data.xpos - before, axis=1)
    said = f"MuJoCo: poses {off:.1e} m, axes {tilt:.1e}; after {SETTLING_S:g} s moved"
    said += f" {moved.max():.1f} mm ({model.body(int(moved.argmax())).name})"
    model.opt.gravity[:] = 0.0
    found = ((body.name, body.joint) for body in one.scene.bodies)
    joints = {name: joint for name, joint in found if joint is not None and joint.type != "fixed"}
    results = {
        name: _opened(mujoco, model, data, model.joint(name).id, joint.effort, begin)
        for name, joint in joints.items()
    }
    if results:
        ours = _opened_here(one.build)
        free = sum(share > 0.99 for share in results.values())
        apart = {name: abs(min(share, 1.0) - ours[name]) for name, share in results.items()}
        worst = max(apart, key=lambda name: apart[name])
        said += f"; {free} of {len(results)} joints go to their far end; shares of the way differ"
        said += f" from ours by {apart[worst]:.3f} ({worst})"
    return said


def _opened(
    mujoco: Any, model: Any, data: Any, number: int, effort: float, begin: Callable[[], None]
) -> float:
    """Push a joint to its far end, without gravity, harder and harder until it moves.

    Returns the share of the way that it went.
    """
    begin()
    at, dof = model.jnt_qposadr[number], model.jnt_dofadr[number]
    low, high = model.jnt_range[number]
    far = high if abs(high) > abs(low) else low
    least = 1.5 * model.dof_frictionloss[dof]
    force = least
    while data.time < OPENING_S:
        slow = data.qvel[dof] / far < 2.5 / OPENING_S
        force = min(1.01 * force + 0.01, effort) if slow else max(0.9 * force, 0.5 * least)
        data.qfrc_applied[dof] = np.sign(far) * force
        mujoco.mj_step(model, data)
    data.qfrc_applied[dof] = 0.0
    return float(data.qpos[at] / far)


def _opened_here(build: Callable[[], World]) -> dict[str, float]:
    """Move each joint to its far end with our engine; return the shares of their ways."""
    shares = {}
    with closing(build()) as world:
        for joint in world.joints():
            far = joint.high if abs(joint.high) > abs(joint.low) else joint.low
            world.set_joint(joint.id, far, 3.0)
            world.step(round(240 * OPENING_S))
            found = world.joint(joint.id)
            assert found is not None
            shares[joint.name] = found.position / far
            world.set_joint(joint.id, joint.position)
            world.step(1)
    return shares


def judge_usd(one: Judged) -> str:
    """Run every validator of usd-core; compare the bodies' poses with ours."""
    found = _python(one, "usd", USD)
    if found is None:
        return "usd-core is not installed"
    ours = {body.name: body.pose.matrix() for body in one.scene.bodies}
    assert set(found["poses"]) == set(ours)
    off = max(float(np.abs(np.array(found["poses"][name]).T - ours[name]).max()) for name in ours)
    said = f"usd-core, {found['validators']} validators: {len(found['errors'])} errors"
    return f"{said} {sorted(set(found['errors'])) or ''}; poses {off:.1e} m"


def judge_compliance(one: Judged) -> str:
    """Run the ComplianceChecker of older versions."""
    found = _python(one, "usd25", COMPLIANCE)
    if found is None:
        return "usd-core 25.11 is not installed"
    return f"ComplianceChecker: {len(found['errors'])} errors, {found['warnings']} warnings"


def judge_nvidia(one: Judged) -> str:
    """Run NVIDIA's validator."""
    program = one.judges / "usd" / "bin" / "nvidia_usd_validate"
    if not program.is_file():
        return "usd-validation-nvidia is not installed"
    done = subprocess.run([program, one.file], capture_output=True, text=True, check=False)
    lines = (done.stdout + done.stderr).splitlines()
    counts = [line.split(":")[-2:] for line in lines if "Failures:" in line or "Errors:" in line]
    failed = [
        line.split(":")[-2].strip() for line in lines if re.search(r": [1-9]\d* Failures", line)
    ]
    told = ", ".join(f"{int(count)} {word.strip().lower()}" for word, count in counts)
    return f"usd-validation-nvidia: {told or 'nothing found'} {sorted(failed) or ''}".rstrip()


def judge_rep158(one: Judged) -> str:
    """Run the checker of the draft REP 158."""
    program = one.judges / "rep158" / "bin" / "usd-check"
    if not program.is_file():
        return "ros-openusd-compliance-checker is not installed"
    command = [str(program), "--export", "--extensions", "--format", "json", str(one.file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    found = json.loads(done.stdout)["violations"]
    counts = Counter(one["severity"] for one in found)
    return f"REP 158: {counts['error']} errors, {counts['warning']} warnings"


def _python(one: Judged, folder: str, program: str) -> Any:
    """Run a program in a judge's environment; return what it prints as JSON, None without one."""
    python = one.judges / folder / "bin" / "python"
    if not python.exists():
        return None
    command = [str(python), "-c", program, str(one.file.absolute())]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def judge_sdformat(one: Judged) -> str:
    """Load by Gazebo's library; compare links with bodies whose joints stand at 0."""
    program = one.judges / "sdf_poses"
    if not program.is_file():
        return "sdf_poses is not built"
    done = subprocess.run([program, one.file], capture_output=True, text=True, check=True)
    lines = [line.split(" ") for line in done.stdout.splitlines()]
    errors = sum(words[0] == "error" for words in lines)
    links = {words[1]: np.array(words[2:5], np.float64) for words in lines if words[0] == "link"}
    joints = sum(words[0] == "joint" for words in lines)
    still = [body for body in one.scene.bodies if body.joint is None and not body.is_outside]
    off = max(np.abs(links[identifier(b.name)] - b.pose.position_m).max() for b in still)
    return f"sdformat 12: {errors} errors, {len(links)} links, {joints} joints; places {off:.0e} m"


OF_USD = (judge_usd, judge_compliance, judge_nvidia, judge_rep158)

JUDGES: dict[str, tuple[Judge, ...]] = {
    ".glb": (judge_gltf, judge_blender),
    ".xml": (judge_mujoco,),
    ".usda": OF_USD,
    ".usdz": OF_USD,
    ".sdf": (judge_sdformat,),
}


def main() -> None:
    """Export each scene and piece in each format, and have it judged."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="+", metavar="NAME")
    parser.add_argument("--judges", type=Path, default=Path("judges"), help="see above")
    parser.add_argument("--formats", nargs="+", default=list(JUDGES), choices=list(JUDGES))
    parser.add_argument("--without", nargs="+", default=[], help="judges: blender, usd, …")
    parser.add_argument("--keep", type=Path, help="folder for the files")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep or Path(temporary)
        for name in args.names:
            _judge(name, folder, args.judges.absolute(), args.formats, args.without)


def _judge(
    name: str, folder: Path, judges: Path, formats: Sequence[str], without: Sequence[str]
) -> None:
    library = SceneLibrary(baked_light=False)
    if "~" in name:

        def build() -> World:
            return asset_world(library.peek_asset(name), library.categories)
    else:

        def build() -> World:
            return library.build(name)

    with closing(build()) as world:
        scene = exported_world(world, agents_in(world, library.agents_of(world.scene)))
    for suffix in formats:
        file = folder / f"{name.replace(':', '_').replace('~', '_')}{suffix}"
        begun = time.monotonic()
        report = (export_asset if "~" in name else export_scene)(name, file, overwrite=True)
        took = time.monotonic() - begun
        size_mb = report.size_bytes / 1e6
        print(f"{name} {suffix}: {report.instances} instances, {took:.1f} s, {size_mb:.1f} MB")
        one = Judged(name=name, file=file, judges=judges, scene=scene, build=build)
        for judge in JUDGES[suffix]:
            if judge.__name__.removeprefix("judge_") not in without:
                print(f"  {judge(one)}", flush=True)


if __name__ == "__main__":
    main()
