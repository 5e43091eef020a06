"""Accuracy of optical flow: ours and that of estimators, against an analytic motion field.

Scenarios and methods in, end-point errors and pictures out. Runs in process, in lockstep.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.flow_methods import FlowMethod
from sailenv_bench.experiments.flow_scenes import BASE_SCENE, TEXTURED, Scenario, textured_cube_zip
from sailenv_bench.experiments.motion_field import BoxSolid, Instant, MotionField, motion_field
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.colours import colour_flow
from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

__all__ = [
    "OURS",
    "Accuracy",
    "FlowErrors",
    "begin_scenario",
    "evaluate_scenario",
    "flow_test_scene",
]

OURS = "sailenv"
STEPS = 8
"""Physics steps between two pictures: 1/30 s."""

SETTLE_STEPS = 24
STANDING = look_at((-1.7, -0.9, 1.75), (0.3, 0.0, 1.4))
EYE = "eye"

MOVES_PX = 0.05
"""Least displacement between two pictures that counts as motion [px]."""


@dataclass(slots=True)
class FlowErrors:
    """Errors of one method, gathered over picture pairs."""

    errors_px: list[NDArray[np.float32]] = field(default_factory=list)
    of_part_px: dict[str, list[NDArray[np.float32]]] = field(default_factory=dict)

    def add(self, error: NDArray[np.float64], parts: Mapping[str, NDArray[np.bool_]]) -> None:
        """Add errors (N,) [px], and which of the points belong to each part."""
        self.errors_px.append(error.astype(np.float32))
        for name, chosen in parts.items():
            self.of_part_px.setdefault(name, []).append(error[chosen].astype(np.float32))

    def summary(self) -> dict[str, float]:
        """Return mean, 95th percentile and maximum [px per pair], and the mean of each part."""
        errors = np.concatenate(self.errors_px).astype(np.float64)
        result = {
            "mean": float(errors.mean()),
            "p95": float(np.percentile(errors, 95)),
            "max": float(errors.max()),
        }
        for name, gathered in self.of_part_px.items():
            values = np.concatenate(gathered).astype(np.float64)
            result[f"mean_{name}"] = float(values.mean()) if len(values) else float("nan")
        return result


@dataclass(frozen=True, slots=True, kw_only=True)
class Accuracy:
    """Result of one scenario.

    Attributes
    ----------
    errors : dict of str to dict
        By method, `OURS` first: what `FlowErrors.summary` gives; of the parts ``moving``,
        ``visible`` in the earlier picture, ``hidden`` there, and ``leaving``: not within it.
    compared : float
        Share of the pictures' pixels that were compared, 0 to 1: those where arithmetic and
        renderer see the same object and its point was before the earlier camera.
    mean_motion_px : float
        Mean length of the motion field [px per frame].
    pictures : dict of str to (H, W, 3) uint8
        RGB of the last pair: the picture, the field, each method's flow at one scale of colours.
    """

    errors: dict[str, dict[str, float]]
    compared: float
    mean_motion_px: float
    pictures: dict[str, NDArray[np.uint8]]


@contextmanager
def flow_test_scene(width: int, height: int, *, seed: int = 0) -> Iterator[Simulation]:
    """Open a lockstep simulation with an empty scene, the textured cube and a camera.

    Ends with the block; nothing is left behind.
    """
    with tempfile.TemporaryDirectory(prefix="sailenv-flow-") as folder:
        path = Path(folder) / "flow.yaml"
        path.write_text(json.dumps(BASE_SCENE), encoding="utf-8")  # JSON is YAML, too
        with Simulation(path, mode="lockstep", seed=seed) as simulation:
            simulation.upload_model(textured_cube_zip(), name=TEXTURED, filename="cube.zip")
            lens = CameraIntrinsics(width=width, height=height)
            simulation.register_agent(AgentSpec(name=EYE, intrinsics=lens, rate_hz=0.0))
            yield simulation


def evaluate_scenario(
    simulation: Simulation,
    scenario: Scenario,
    methods: Sequence[FlowMethod],
    *,
    pairs: int,
    gap: int = 1,
    on_pair: Callable[[], None] = lambda: None,
) -> Accuracy:
    """Compare every method with the arithmetic over pairs of pictures.

    Estimators are asked where each pixel of the present picture was in the earlier one, so that
    all methods answer for the same points; the answer's sign is turned.

    Parameters
    ----------
    simulation : Simulation
        A `flow_test_scene`.
    pairs : int
        At least 1.
    gap : int
        From one picture of a pair to the other, in frames of 1/30 s; at least 1.
    on_pair : callable
        Called after each.
    """
    boxes = begin_scenario(simulation, scenario)
    evaluated = {name: FlowErrors() for name in (OURS, *(method.name for method in methods))}
    motion_px, compared = [], []
    frame, instant = _observed(simulation, boxes)
    flows: dict[str, NDArray[Any]] = {}
    for _ in range(pairs):
        past_frame, past = frame, instant
        simulation.step(STEPS * gap)
        frame, instant = _observed(simulation, boxes)
        truth = motion_field(boxes, instant, past)
        sure = _comparable(truth, frame)
        flows = _estimates(frame, past_frame, methods)
        speed = np.linalg.norm(truth.displacement_px[sure], axis=-1)
        parts = {
            "moving": speed > MOVES_PX,
            "visible": ~(truth.hidden | truth.leaves)[sure],
            "hidden": truth.hidden[sure],
            "leaving": truth.leaves[sure],
        }
        for name, flow in flows.items():
            error = np.linalg.norm(flow[sure] - truth.displacement_px[sure], axis=-1)
            evaluated[name].add(error, parts)
        motion_px.append(speed.mean())
        compared.append(sure.mean())
        on_pair()
    return Accuracy(
        errors={name: entry.summary() for name, entry in evaluated.items()},
        compared=float(np.mean(compared)),
        mean_motion_px=float(np.mean(motion_px)),
        pictures=_pictures(frame, truth, flows, methods),
    )


def begin_scenario(simulation: Simulation, scenario: Scenario) -> list[BoxSolid]:
    """Begin a scenario in a `flow_test_scene`; return its boxes."""
    objects = scenario.objects()
    ids = simulation.load_scenario({"objects": objects})
    simulation.set_follow(scenario.camera_moves, agent=EYE)
    if not scenario.camera_moves:
        simulation.set_pose(STANDING, teleport=True, agent=EYE)
    simulation.step(SETTLE_STEPS)
    return [_solid(entry, number) for entry, number in zip(objects, ids, strict=True)]


def _solid(entry: dict[str, Any], instance_id: int) -> BoxSolid:
    """Return the box of a scene's entry: the built-in cube's origin lies in its middle."""
    x, y, z = (0.5 * float(length) for length in entry["scale"])
    below, above = (0.0, 2 * z) if entry["asset"] == TEXTURED else (-z, z)
    return BoxSolid(
        name=entry["name"], instance_id=instance_id, low=(-x, -y, below), high=(x, y, above)
    )


def _observed(simulation: Simulation, boxes: Sequence[BoxSolid]) -> tuple[Frame, Instant]:
    frame = simulation.capture(("rgb", "instance", "flow", "flow_valid"), agent=EYE)
    poses = [simulation.get_object(box.instance_id).pose for box in boxes]
    return frame, Instant(camera=frame.camera, poses=poses)


def _comparable(truth: MotionField, frame: Frame) -> NDArray[np.bool_]:
    """Return (H, W) where both see the same object and its point was before the earlier camera."""
    sure: NDArray[np.bool_] = (frame["instance"] == truth.instance) & frame["flow_valid"]
    return sure & np.isfinite(truth.displacement_px).all(axis=-1)


def _estimates(frame: Frame, past: Frame, methods: Sequence[FlowMethod]) -> dict[str, NDArray[Any]]:
    """Return each method's displacement (H, W, 2) from the earlier picture to this [px]."""
    flows: dict[str, NDArray[Any]] = {OURS: frame["flow"].astype(np.float64) * frame.dt_s}
    now, then = (np.ascontiguousarray(entry["rgb"][..., ::-1]) for entry in (frame, past))
    for method in methods:
        flows[method.name] = -method.compute(now, then)
    return flows


def _pictures(
    frame: Frame,
    truth: MotionField,
    flows: dict[str, NDArray[Any]],
    methods: Sequence[FlowMethod],
) -> dict[str, NDArray[np.uint8]]:
    """Show flows as hue by direction and brightness by speed, all at the field's own scale."""
    lengths = np.linalg.norm(np.nan_to_num(truth.displacement_px), axis=-1)
    full = float(np.percentile(lengths, 99.5)) or 1.0
    labels = {OURS: "sailenv_ros", **{method.name: method.label for method in methods}}
    shown = {"picture": frame["rgb"].copy(), "arithmetic": truth.displacement_px}
    shown |= {labels[name]: flow for name, flow in flows.items()}
    return {
        label: values
        if values.dtype == np.uint8
        else colour_flow(values.astype(np.float32), full_px_s=full)
        for label, values in shown.items()
    }
