"""A simulation with what serves it besides ROS: gateway, web viewer, what is built meanwhile.

Knows no ROS: a simulator can begin before ROS is installed, and be joined to it later.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TYPE_CHECKING, TypeVar

from sailenv_ros.errors import AddressInUse
from sailenv_ros.gateway import GatewayServer
from sailenv_ros.ros.nodes.lifecycle import StopRequest, finished_within
from sailenv_ros.ros.nodes.parameter_table import SimParameters
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.background_build import BackgroundBuild, BuildStep, furnishing

if TYPE_CHECKING:
    from sailenv_ros.viewer import ViewerServer

__all__ = ["Hosted", "load_simulation"]

_log = logging.getLogger(__name__)

Server = TypeVar("Server")


class Hosted:
    """A simulation, its servers and its background build, as parameters ask for them.

    Parameters
    ----------
    simulation : Simulation
        Owned from now on.
    parameters : SimParameters
    first : sequence of BuildStep
        What is built in the background before furniture and light.
    """

    def __init__(
        self, simulation: Simulation, parameters: SimParameters, *first: BuildStep
    ) -> None:
        self.simulation = simulation
        self.parameters = parameters
        self._gateway = _unless_taken(
            parameters.gateway_port,
            "SAILenv clients cannot connect here",
            lambda port: GatewayServer(
                simulation,
                host=parameters.gateway_host,
                port=port,
                protocol=parameters.gateway_protocol,
            ),
        )
        self._viewer = _unless_taken(
            parameters.viewer_port,
            "there is no window in the browser here",
            lambda port: _viewer(simulation, parameters, port),
        )
        steps = [*first, *_furnishing(simulation, parameters)]
        self._build = BackgroundBuild(simulation, steps) if steps else None

    @property
    def viewer_url(self) -> str:
        """Address of the web viewer; empty if there is none."""
        return "" if self._viewer is None else self._viewer.url

    def close_servers(self) -> None:
        """End everything but the simulation; a second call does nothing."""
        for part in (self._build, self._gateway, self._viewer):
            if part is not None:
                part.close()
        self._build = self._gateway = self._viewer = None

    def close_simulation(self, timeout_s: float) -> bool:
        """End the simulation; False if it did not end in time."""
        return finished_within(self.simulation.close, timeout_s)


def load_simulation(parameters: SimParameters, stop: StopRequest) -> Simulation | None:
    """Start the simulation; None if the end was asked for meanwhile.

    Raises
    ------
    SailenvError
        If it cannot start.
    """
    loading: Future[Simulation] = Future()

    def load() -> None:
        try:
            loading.set_result(_simulation(parameters))
        except BaseException as error:  # raised again in the main thread
            loading.set_exception(error)

    thread = threading.Thread(target=load, name="loading", daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(0.02)
        if stop.is_set:
            # What is being loaded goes with the process, if not before.
            loading.add_done_callback(_close_loaded)
            thread.join(1.0)
            return None
    return loading.result()


def _close_loaded(loading: Future[Simulation]) -> None:
    if loading.exception() is None:
        loading.result().close()


def _simulation(parameters: SimParameters) -> Simulation:
    simulation = Simulation(
        parameters.scene,
        mode=parameters.mode,
        real_time_factor=parameters.real_time_factor,
        seed=parameters.seed,
        paused=parameters.paused,
        backend=parameters.backend,
        render_device=parameters.render_device,
        scene_paths=parameters.scene_paths,
        allow_modules=parameters.allow_modules,
        light=parameters.light,
    )
    try:
        agent = parameters.agent
        if agent is not None and agent.name not in {spec.name for spec in simulation.info.agents}:
            simulation.register_agent(agent)
    except BaseException:
        simulation.close()
        raise
    return simulation


def _furnishing(simulation: Simulation, parameters: SimParameters) -> list[BuildStep]:
    if parameters.build_missing == "nothing":
        return []
    step = furnishing(
        str(parameters.scene or simulation.info.scene),
        everything=parameters.build_missing == "all",
        scene_paths=parameters.scene_paths,
        allow_modules=parameters.allow_modules,
        light=parameters.light != "plain",
    )
    return [step]


def _viewer(simulation: Simulation, parameters: SimParameters, port: int) -> ViewerServer:
    # With its web library a fifth of what a simulator imports; without a viewer nobody needs it.
    from sailenv_ros.dataset.live_capture import LiveCapture
    from sailenv_ros.viewer import ViewerServer

    return ViewerServer(
        simulation,
        host=parameters.viewer_host,
        port=port,
        control=parameters.viewer_control,
        data_sets=LiveCapture(),
    )


def _unless_taken(port: int, otherwise: str, serve: Callable[[int], Server]) -> Server | None:
    """Start a server; none on port 0, nor on one that is taken, of which the log then tells."""
    if not port:
        return None
    try:
        return serve(port)
    except AddressInUse as problem:
        # Another simulator on this machine is no reason not to start; anything else is.
        _log.warning("%s: %s", otherwise, problem)
        return None
