"""The parts of `sailenv bench all`, in the order of the table."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from sailenv_bench.suite.measurement import Measurement
from sailenv_ros.errors import InvalidState, UnknownName

__all__ = ["PARTS", "Part", "load_part", "parts_named"]

CHECKOUT = Path(__file__).resolve().parents[2]
"""The folder of the repository, if the package is used from there."""

Measure = Callable[[bool], Iterable[Measurement]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A benchmark that belongs to the run.

    Attributes
    ----------
    name : str
        On the command line and in the JSON file.
    title : str
        In the table.
    module : str
        Module with a function ``measurements(quick)``. One without dots is a file of the
        repository's folder ``benchmarks``, which an installed package does not have.
    """

    name: str
    title: str
    module: str

    @property
    def source(self) -> str:
        """The command that measures it alone, or the module."""
        return self.module if "." in self.module else f"benchmarks/{self.module}.py"


PARTS = (
    Part(name="frames", title="Rendering a frame in process", module="native_renderer"),
    Part(name="agent", title="`Agent.get_frame()`, five views, end to end", module="end_to_end"),
    Part(name="flow-speed", title="Picture and flow, the paper's experiment",
         module="sailenv_bench.suite.flow_speed"),
    Part(name="flow-accuracy", title="End-point error of flow",
         module="sailenv_bench.suite.flow_accuracy"),
    Part(name="objects", title="Ground truth of objects", module="object_truth"),
    Part(name="motion", title="Motion between frames, and tracks", module="motion"),
    Part(name="datasets", title="Making a data set", module="dataset_speed"),
    Part(name="streams", title="Making a stream", module="sailenv_bench.suite.stream_speed"),
    Part(name="recording", title="Writing a recording in process", module="recording"),
    Part(name="starts", title="Start to the first frame", module="starts"),
    Part(name="baking", title="Baking the light of a room", module="bake_speed"),
    Part(name="bodies", title="Physics of many bodies: processor time of a simulated second",
         module="many_bodies"),
)  # fmt: skip


def parts_named(names: Iterable[str]) -> tuple[Part, ...]:
    """Return the parts of some names in the order of the table; all if there are no names.

    Raises
    ------
    UnknownName
    """
    wanted = set(names)
    known = {part.name: part for part in PARTS}
    for name in sorted(wanted - set(known)):
        raise UnknownName("part", name, known)
    return tuple(part for part in PARTS if not wanted or part.name in wanted)


def load_part(part: Part, checkout: Path = CHECKOUT) -> Measure:
    """Return the function that measures a part.

    The folder ``benchmarks`` must be in ``sys.path`` if the part is a file of it.

    Raises
    ------
    InvalidState
        If it is a file of the repository and the package was installed without that.
    """
    if "." not in part.module and not (checkout / part.source).is_file():
        raise InvalidState(
            f"the part {part.name!r} can be run only from a checkout of the repository, "
            f"which has {part.source}"
        )
    measure: Measure = import_module(part.module).measurements
    return measure
