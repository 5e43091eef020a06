"""Error of flow beside estimators: `sailenv bench flow-accuracy` as one part."""

from __future__ import annotations

from collections.abc import Iterator

from sailenv_bench.experiments.flow_accuracy import OURS, evaluate_scenario, flow_test_scene
from sailenv_bench.experiments.flow_methods import opencv_methods
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_bench.suite.measurement import Measurement

__all__ = ["measurements"]


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure each scenario, or the first two."""
    methods = opencv_methods()
    width, height, pairs = (160, 120, 2) if quick else (320, 240, 6)
    with flow_test_scene(width, height) as simulation:
        for name in list(SCENARIOS)[: 2 if quick else None]:
            scenario = SCENARIOS[name]
            errors = evaluate_scenario(simulation, scenario, methods, pairs=pairs).errors
            best = min(methods, key=lambda method: errors[method.name]["mean"])
            yield Measurement(
                name=f"{scenario.label}, {width}×{height}, mean error",
                value=errors[OURS]["mean"],
                unit="px",
                other=f"{best.label}, the best estimate",
                other_value=errors[best.name]["mean"],
            )
