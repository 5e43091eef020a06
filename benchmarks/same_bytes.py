"""Draw the same instants on several machines and compare the bytes.

    python benchmarks/same_bytes.py save FOLDER [SCENE ...]
    python benchmarks/same_bytes.py draw FOLDER

`save` writes what is drawn of each scene (a pickle, for these machines alone) and the SHA-256 of
each view that this machine's native renderer makes of it; `draw`, on another machine, makes them
again and tells which differ, in how many pixels and by how much. `benchmarks/aarch64` uses it.
"""

from __future__ import annotations

import argparse
import pickle
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import WorldSnapshot

VIEWS = ("rgb", "depth", "category", "instance", "normals", "albedo")
SCENES = ("optical", "room_01", "room_03")
SIZE = (320, 240)


def main() -> int:
    """Save, or draw and compare; 1 if anything but pictures and colours differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("what", choices=("save", "draw"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    options = parser.parse_args()
    if options.what == "save":
        options.folder.mkdir(parents=True, exist_ok=True)
        for scene in options.scenes:
            _save(options.folder, scene)
        return 0
    return max(_compared(path) for path in sorted(options.folder.glob("*.pickle")))


def _save(folder: Path, scene: str) -> None:
    import render_passes  # type: ignore[import-not-found]  # beside this file

    from sailenv_ros.types.camera import CameraIntrinsics

    world = render_passes.world_maker(scene, 400)()
    intrinsics = CameraIntrinsics(width=SIZE[0], height=SIZE[1])
    camera = render_passes._camera_of(world, intrinsics)(world.sim_time_ns)
    snapshot = world.snapshot()
    (folder / f"{scene}.pickle").write_bytes(pickle.dumps((snapshot, camera)))
    np.savez(folder / f"{scene}.npz", **_drawn(snapshot, camera))  # type: ignore[arg-type]
    world.close()


def _drawn(snapshot: WorldSnapshot, camera: Camera) -> dict[str, NDArray[np.generic]]:
    renderer = NativeRenderer(threads=2)
    try:
        views = renderer.render(RenderRequest(snapshot, camera, VIEWS)).views
        return {name: views[name].copy() for name in VIEWS}
    finally:
        renderer.close()


def _compared(path: Path) -> int:
    """Print how each view differs from the saved one; return 1 if one does that must not."""
    snapshot, camera = pickle.loads(path.read_bytes())
    differs = 0
    with np.load(path.with_suffix(".npz")) as saved:
        for name, view in _drawn(snapshot, camera).items():
            if view.tobytes() == saved[name].tobytes():
                print(f"{path.stem:10} {name:10} equal")
                continue
            off = np.abs(view.astype(float) - saved[name].astype(float))
            share = (off.reshape(*view.shape[:2], -1) > 0).any(axis=2).mean()
            print(f"{path.stem:10} {name:10} {share:.2%} of the pixels differ, by {off.max():.3g}")
            differs |= name not in ("rgb", "albedo")
    return int(differs)


if __name__ == "__main__":
    sys.exit(main())
