"""The child process that reads URDF and MJCF files with MuJoCo; see `robot_scene`.

    python -m sailenv_content.scene_import.robot_reader FILE FOLDER MEMORY_BYTES

A compiler of others in C++ works on an untrusted file here: what it stumbles over ends this process
and no other, and it has no more memory than it is given. Writes ``scene.json`` and ``arrays.npz``
into the folder, or ``refused.txt`` with a sentence.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import resource
import sys
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.assets.safe_xml import read_xml

__all__ = ["main"]

MOST_TRIANGLES = 5_000_000
URDF_SETTINGS = (
    '<mujoco><compiler discardvisual="false" fusestatic="false" strippath="false"/></mujoco>'
)
DRAWN_GROUPS = (0, 1, 2)
"""Groups of geometries that MuJoCo's own viewer draws; the others are for collisions only."""


def main(arguments: list[str]) -> int:
    """Read a file; 0 if there is an answer."""
    path, folder, memory = Path(arguments[0]), Path(arguments[1]), int(arguments[2])
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    # MuJoCo writes a log file beside whatever the folder is.
    os.chdir(folder)
    import mujoco

    try:
        model = _compiled(mujoco, path)
        scene, arrays = _described(mujoco, model)
    except Exception as problem:  # whatever the compiler has to say
        (folder / "refused.txt").write_text(" ".join(str(problem).split())[:300], encoding="utf-8")
        return 0
    np.savez(folder / "arrays.npz", **arrays)
    (folder / "scene.json").write_text(json.dumps(scene), encoding="utf-8")
    return 0


def _compiled(mujoco: Any, path: Path) -> Any:
    """Compile a file; a URDF with its visuals, which MuJoCo leaves out unless it is told."""
    root = read_xml(path.read_bytes(), path.name)
    if root.tag != "robot":
        return mujoco.MjSpec.from_file(str(path)).compile()
    text = path.read_bytes().decode("utf-8-sig")
    if root.first("mujoco") is None:
        text = re.sub(r"(<robot\b[^>]*>)", lambda found: found[1] + URDF_SETTINGS, text, count=1)
    meshes = {
        name: (path.parent / name).read_bytes()
        for node in root.walk()
        if node.tag == "mesh" and (name := node.text("filename")) and (path.parent / name).is_file()
    }
    return mujoco.MjSpec.from_string(text, assets=meshes).compile()


def _described(mujoco: Any, model: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)
    if int(model.nmeshface) > MOST_TRIANGLES:
        raise ValueError(f"it has {model.nmeshface} triangles, and {MOST_TRIANGLES} are accepted")
    names = mujoco.mjtObj
    arrays: dict[str, Any] = {}
    for mesh in range(model.nmesh):
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        arrays[f"vertices_{mesh}"] = model.mesh_vert[first : first + count].copy()
        first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        arrays[f"faces_{mesh}"] = model.mesh_face[first : first + count].copy()

    def name(kind: Any, number: int) -> str:
        return mujoco.mj_id2name(model, kind, number) or ""

    bodies = [
        {
            "name": name(names.mjOBJ_BODY, number),
            "position": data.xpos[number].tolist(),
            "quat_wxyz": data.xquat[number].tolist(),
            "mass": float(model.body_mass[number]),
            "parent": int(model.body_parentid[number]),
            "centre": model.body_ipos[number].tolist(),
            "moments": model.body_inertia[number].tolist(),
            "axes_wxyz": model.body_iquat[number].tolist(),
            "rest_position": model.body_pos[number].tolist(),
            "rest_quat_wxyz": model.body_quat[number].tolist(),
            "joints": [
                _joint(mujoco, model, data, number, j)
                for j in range(
                    int(model.body_jntadr[number]),
                    int(model.body_jntadr[number]) + int(model.body_jntnum[number]),
                )
            ],
        }
        for number in range(model.nbody)
    ]
    geoms = []
    for number in range(model.ngeom):
        material = int(model.geom_matid[number])
        rgba = model.mat_rgba[material] if material >= 0 else model.geom_rgba[number]
        shine = float(model.mat_shininess[material]) if material >= 0 else 0.3
        geoms.append(
            {
                "name": name(names.mjOBJ_GEOM, number),
                "body": int(model.geom_bodyid[number]),
                "type": int(model.geom_type[number]),
                "size": model.geom_size[number].tolist(),
                "position": data.geom_xpos[number].tolist(),
                "matrix": data.geom_xmat[number].tolist(),
                "mesh": int(model.geom_dataid[number]),
                "rgba": [float(v) for v in rgba],
                "shininess": shine,
                "drawn": int(model.geom_group[number]) in DRAWN_GROUPS,
                "user": model.geom_user[number].tolist(),
                "collides": bool(model.geom_contype[number] or model.geom_conaffinity[number]),
            }
        )
    lights = [
        {
            "name": name(names.mjOBJ_LIGHT, number),
            "type": int(model.light_type[number]),
            "position": data.light_xpos[number].tolist(),
            "direction": data.light_xdir[number].tolist(),
            "colour": model.light_diffuse[number].tolist(),
            "cutoff": float(model.light_cutoff[number]),
        }
        for number in range(model.nlight)
    ]
    cameras = [
        {
            "name": name(names.mjOBJ_CAMERA, number),
            "position": data.cam_xpos[number].tolist(),
            "matrix": data.cam_xmat[number].tolist(),
            "fov": float(model.cam_fovy[number]),
        }
        for number in range(model.ncam)
    ]
    texts = {}
    for number in range(model.ntext):
        first, size = int(model.text_adr[number]), int(model.text_size[number])
        data = bytes(model.text_data[first : first + size]).rstrip(b"\0")
        texts[name(names.mjOBJ_TEXT, number)] = data.decode("utf-8", "replace")
    scene = {"bodies": bodies, "geoms": geoms, "lights": lights, "cameras": cameras, "texts": texts}
    scene["followers"] = _followers(mujoco, model)
    return scene, arrays


def _followers(mujoco: Any, model: Any) -> list[dict[str, Any]]:
    """Return the joints that go with others in proportion."""
    kind, joint = mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtObj.mjOBJ_JOINT
    return [
        {
            "joint": mujoco.mj_id2name(model, joint, int(model.eq_obj1id[number])) or "",
            "leader": mujoco.mj_id2name(model, joint, int(model.eq_obj2id[number])) or "",
            "offset": float(model.eq_data[number][0]),
            "multiplier": float(model.eq_data[number][1]),
        }
        for number in range(model.neq)
        if int(model.eq_type[number]) == kind and int(model.eq_obj2id[number]) >= 0
    ]


def _joint(mujoco: Any, model: Any, data: Any, body: int, joint: int) -> dict[str, Any]:
    """Return a joint: its kind, axis and point in the body's axes, limits, and what moves it."""
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, joint) or ""
    kind, at, dof = (int(a[joint]) for a in (model.jnt_type, model.jnt_qposadr, model.jnt_dofadr))
    ball = mujoco.mjtJoint.mjJNT_BALL
    # The torque or force of the weight of all that hangs on it, at most.
    axis, turns = data.xaxis[joint], kind == mujoco.mjtJoint.mjJNT_HINGE
    lever = 1.0
    if turns:
        arm = data.subtree_com[body] - data.xanchor[joint]
        lever = float(np.linalg.norm(arm - axis * (axis @ arm)))
    share = float(np.hypot(axis[0], axis[1])) if turns else abs(float(axis[2]))
    limited = bool(model.jnt_actfrclimited[joint])
    return {
        "name": name,
        "type": kind,
        "axis": model.jnt_axis[joint].tolist(),
        "origin": model.jnt_pos[joint].tolist(),
        "limited": bool(model.jnt_limited[joint]),
        "range": model.jnt_range[joint].tolist(),
        "reference": float(model.qpos0[at]),
        "start": float(data.qpos[at] - model.qpos0[at]),
        "start_quat_wxyz": data.qpos[at : at + 4].tolist() if kind == ball else [],
        "damping": float(model.dof_damping[dof]),
        "friction": float(model.dof_frictionloss[dof]),
        "weight": float(model.body_subtreemass[body]) * 9.81 * lever * share,
        "effort": float(max(np.abs(model.jnt_actfrcrange[joint]))) if limited else 0.0,
    }


if __name__ == "__main__":
    with contextlib.suppress(MemoryError):
        sys.exit(main(sys.argv[1:]))
    sys.exit(3)
