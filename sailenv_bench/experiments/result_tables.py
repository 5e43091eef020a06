"""Tables of a result; the one module that knows every experiment by its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from sailenv_bench.experiments.detection_tables import detection_tables
from sailenv_bench.experiments.endless_tables import endless_tables
from sailenv_bench.experiments.stream_tables import stream_tables
from sailenv_bench.experiments.tables import Table, accuracy_tables, speed_tables
from sailenv_bench.experiments.throughput_tables import throughput_tables

__all__ = ["tables_of"]

_TABLES: Mapping[str, Callable[[Mapping[str, Any]], list[Table]]] = MappingProxyType(
    {
        "flow_speed": speed_tables,
        "flow_accuracy": accuracy_tables,
        "detection": detection_tables,
        "throughput": throughput_tables,
        "streams": stream_tables,
        "endless": endless_tables,
    }
)


def tables_of(result: Mapping[str, Any]) -> list[Table]:
    """Return the tables of a result as `results.load_result` reads it."""
    return _TABLES[result["experiment"]](result["data"])
