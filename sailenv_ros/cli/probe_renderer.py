"""Tries a renderer and says in one line of JSON what came of it; run by `sailenv doctor`.

``python -m sailenv_ros.cli.probe_renderer gl`` may hang or crash with a bad driver, which is why
it is a process of its own.
"""

from __future__ import annotations

import json
import logging
import sys
from typing import Any

from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import ContextError

__all__ = ["main"]


def main(backend: str) -> dict[str, Any]:
    """Try every device of a back end and render one frame; give what to print."""
    answer: dict[str, Any] = {}
    try:
        if backend == "gl":
            from sailenv_ros.render.context import probe_devices

            answer["devices"] = [
                {
                    "index": report.index,
                    "refused": bool(report.refused),
                    "text": str(report).partition(": ")[2],
                }
                for report in probe_devices()
            ]
        answer.update(_frame(backend))
    except ContextError as refusal:
        answer["fault"] = str(refusal)
    except Exception as fault:  # whatever a driver does is what doctor reports
        answer["fault"] = f"{type(fault).__name__}: {fault}"
    return answer


def _frame(backend: Any) -> dict[str, Any]:
    from sailenv_ros.simulation import Simulation

    lens = CameraIntrinsics(width=160, height=120)
    with Simulation(mode="lockstep", backend=backend) as simulation:
        simulation.register_agent(AgentSpec(name="doctor", intrinsics=lens))
        frame = simulation.capture("doctor")
        if not frame["instance"].any():
            return {"fault": "a frame was rendered, but it is empty"}
        renderer = simulation.info.renderer
    milliseconds = frame.timings_s["render"] * 1e3
    return {
        "rendered": f"{renderer}; a frame of 160 × 120 in {milliseconds:.0f} ms",
        "software": "software" in renderer,
    }


if __name__ == "__main__":
    logging.disable(logging.CRITICAL)
    print(json.dumps(main(sys.argv[1])))
