"""Frames of a running simulation → a data set, while time runs; steps and moves nothing itself."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Final

from sailenv_ros.dataset.formats.formats import FORMATS, format_class
from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.types.agents import WAITED_RATE
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS

__all__ = ["MAX_FRAMES", "STANDS_S", "LiveCapture"]

MAX_FRAMES = 300
"""Most frames of one capture."""

STANDS_S = 10.0
"""Where time stands still for so long, the capture ends [s of wall time]."""

LOOK_S = 0.25
"""Time between two looks at whether the capture is to end [s]."""

FRAME_S = 120.0
"""Deadline of one frame with its facts [s]."""


class LiveCapture:
    """Writes data sets of what an agent of a running simulation sees.

    Attributes
    ----------
    formats : tuple of str
        Names of the formats that can be written.
    """

    formats: Final = tuple(FORMATS)

    def write(
        self,
        simulation: Simulation,
        folder: Path,
        format_name: str,
        *,
        agent: str,
        frames: int,
        rate_hz: float,
        stopped: threading.Event,
        on_frame: Callable[[int], None] = lambda count: None,
    ) -> int:
        """Write so many frames of an agent; fewer if it is stopped, or time stands still.

        Parameters
        ----------
        simulation : Simulation
        folder : Path
            Empty, or not there yet.
        format_name : str
            One of `formats`.
        agent : str
        frames : int
            1 to `MAX_FRAMES`.
        rate_hz : float
            Frames per simulated second; fewer come where drawing and writing take longer.
        stopped : threading.Event
            Ends the capture once it is set: what was seen until then is written.
        on_frame : callable
            Called with the number of frames that have been written, after each; what it raises
            ends the work, and leaves the data set unfinished.

        Returns
        -------
        count : int
            Frames that were written.

        Raises
        ------
        UnknownName, InvalidRequest
            If format, agent or a number cannot be accepted.
        InvalidState
            If the simulation is paused, or it was stopped before the first frame.
        RecordingError
            If a file cannot be written.
        """
        # What a simulator needs only now and then is loaded then.
        from sailenv_ros.dataset.formats.dataset_writer import DatasetWriter
        from sailenv_ros.simulation.scene_facts import scene_facts

        checked_integer("frames", frames, 1, MAX_FRAMES)
        WAITED_RATE.number("rate_hz", rate_hz)
        made = format_class(format_name)
        specs = {spec.name: spec for spec in simulation.info.agents}
        if agent not in specs:
            raise UnknownName("agent", agent, specs)
        if simulation.info.paused and frames > 1:
            raise InvalidState("simulated time stands still; let it run, and capture again")
        more = ("albedo",) if made.needs_facts else ()
        chosen = {*FIVE_VIEWS, *specs[agent].views, *made.views, *more}
        views = tuple(view for view in VIEWS if view in chosen)

        def seen(core: SimulationCore) -> Frame:
            frame = core.render(core.agents[agent], views)
            return replace(frame, facts=scene_facts(core)) if made.needs_facts else frame

        count, source = 0, f"{simulation.info.scene}, agent {agent}"
        with DatasetWriter(folder, [format_name], source=source) as writer:
            with closing(_instants(simulation, 1e9 / rate_hz, stopped)) as instants:
                for _ in instants:
                    writer.add(simulation.read(seen, timeout_s=FRAME_S))
                    count += 1
                    on_frame(count)
                    if count == frames:
                        break
            if not count:
                raise InvalidState("the capture was stopped before its first frame")
        return count


def _instants(
    simulation: Simulation, period_ns: float, stopped: threading.Event
) -> Generator[None, None, None]:
    """Return now, and each time a period of simulated time has passed; until it is stopped.

    It also ends where time stands still for `STANDS_S`.
    """
    stepped = threading.Event()
    stop_listening = simulation.on_step(lambda _: stepped.set())
    try:
        epoch, due_ns = simulation.info.epoch, float(simulation.sim_time_ns)
        stood_s = 0.0
        while not stopped.is_set() and stood_s < STANDS_S:
            now_ns = float(simulation.sim_time_ns)
            if simulation.info.epoch != epoch:  # its time begins at 0 again
                epoch, due_ns = simulation.info.epoch, now_ns
            if now_ns >= due_ns:
                due_ns += period_ns * (1.0 + (now_ns - due_ns) // period_ns)
                yield
                continue
            stepped.clear()
            stood_s = 0.0 if stepped.wait(LOOK_S) else stood_s + LOOK_S
    finally:
        stop_listening()
