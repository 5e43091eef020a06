"""Probes of `sailenv doctor` that need a process of their own: drivers and native libraries.

`python -m sailenv_ros.cli.doctor_probes NAME` prints one marked line of JSON. A driver may hang,
crash or print whatever it likes: `try_probe` survives it and says what happened.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import json
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sailenv_ros.errors import SailenvError

if TYPE_CHECKING:
    from sailenv_ros.render.contract import BackendName

__all__ = ["PROBES", "try_probe"]

END_TIMEOUT_S = 5.0

_MARK = "sailenv-probe:"


def probe_ros() -> dict[str, Any]:
    """Import ROS; ``missing`` names what is not there."""
    found: dict[str, Any] = {"missing": []}
    for name in ("rclpy", "sensor_msgs.msg", "std_srvs.srv", "sailenv_msgs.msg"):
        try:
            # By name: no module but those at the ROS border may import it for good.
            module = importlib.import_module(name)
        except ImportError as problem:
            found["missing"].append(f"{name.partition('.')[0]} ({problem})")
            continue
        if module.__file__ is None:
            # In a checkout, the folder of the message definitions passes for a namespace package.
            found["missing"].append(f"{name.partition('.')[0]} (not on Python's path)")
        else:
            found[name.partition(".")[0]] = module.__file__
            if name == "rclpy":
                found["rmw"] = module.get_rmw_implementation_identifier()
    return found


def probe_graphics() -> dict[str, Any]:
    """Try every EGL device."""
    from sailenv_ros.render.gl.context import probe_devices

    return {
        "devices": [
            {**dataclasses.asdict(report), "software": report.software}
            for report in probe_devices()
        ]
    }


def probe_scenes() -> dict[str, Any]:
    """Load every scene that is found; a text with errors instead of "" where there are some."""
    from sailenv_ros.simulation.scenes import SceneLibrary

    library = SceneLibrary()
    errors = {}
    for name in library.scene_names:
        try:
            library.load(name)
            errors[name] = ""
        except SailenvError as problem:
            errors[name] = str(problem).splitlines()[0]
    return {"scenes": errors, "assets": len(library.spawnables)}


def probe_frame(backend: BackendName) -> dict[str, Any]:
    """Render a frame with the five views, as a simulator would; the second one is timed."""
    from sailenv_ros.simulation import Simulation
    from sailenv_ros.types.agents import AgentSpec

    with Simulation(mode="lockstep", backend=backend) as simulation:
        simulation.register_agent(AgentSpec(name="doctor", rate_hz=0.0))
        simulation.capture(agent="doctor")
        simulation.step(8)
        frame = simulation.capture(agent="doctor")
        return {
            "scene": frame.scene,
            "renderer": simulation.info.renderer,
            "ms": frame.timings_s["render"] * 1e3,
            "instances": len({*frame["instance"].flat} - {0}),
        }


PROBES: dict[str, Callable[[], dict[str, Any]]] = {
    "ros": probe_ros,
    "graphics": probe_graphics,
    "scenes": probe_scenes,
    "frame by auto": partial(probe_frame, "auto"),
    "frame by native": partial(probe_frame, "native"),
}


def try_probe(name: str, timeout_s: float) -> tuple[dict[str, Any] | None, str]:
    """Run a probe in a process of its own.

    Parameters
    ----------
    name : str
        One of `PROBES`.
    timeout_s : float
        How long it may take [s].

    Returns
    -------
    found : dict or None
        What it found; None if it came to nothing.
    why_not : str
        What happened instead; "" if all is well.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "sailenv_ros.cli.doctor_probes", name],
        # Where this package was imported from, so that the other process finds the same one.
        cwd=Path(__file__).resolve().parents[2],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
    )
    try:
        out, err = process.communicate(timeout=timeout_s)
    except subprocess.TimeoutExpired:
        process.kill()
        # Not waited for without end: a process that is stuck in a driver does not die.
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.communicate(timeout=END_TIMEOUT_S)
        return None, f"did not come back within {timeout_s:g} s, and was ended"
    for line in out.splitlines():
        if line.startswith(_MARK):
            found: dict[str, Any] = json.loads(line.removeprefix(_MARK))
            return found, ""
    return None, _why(process.returncode, err)


def _why(status: int, err: str) -> str:
    if status < 0:
        return f"crashed ({signal.Signals(-status).name})"
    last_lines = [line for line in err.splitlines() if line.strip()]
    return last_lines[-1] if last_lines else f"ended with status {status} and said nothing"


if __name__ == "__main__":
    print(_MARK + json.dumps(PROBES[sys.argv[1]]()), flush=True)
