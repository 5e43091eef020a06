"""A client of ROS's standard interfaces, which tests call by the names of their types.

Requests are made as the installed version of `simulation_interfaces` has them: 1.5 or 2.1.
"""

from __future__ import annotations

from typing import Any

from simulation_interfaces import srv
from simulation_interfaces.msg import EntityFilters, Resource, Result, SimulationState

from sailenv_ros.ros.nodes.simulation_interfaces.server import service_name
from tests.support.ros_probe import Probe

__all__ = ["OK", "StandardClient", "set_resource", "spawn_request", "world"]

OK = Result.RESULT_OK


class StandardClient:
    """Calls services; a code that is not the expected one is an error."""

    def __init__(self, probe: Probe) -> None:
        self._probe = probe

    def __call__(self, kind: str, code: int | None = OK, **fields: Any) -> Any:
        """Call the service of a type; None accepts every code."""
        return self.send(kind, getattr(srv, kind).Request(**fields), code)

    def send(self, kind: str, request: Any, code: int | None = OK) -> Any:
        """Send a request to the service of a type."""
        answer = self._probe.call(getattr(srv, kind), service_name(kind), request)
        if hasattr(answer, "result"):
            told = answer.result
            assert code is None or told.result == code, (kind, told)
            assert told.result == OK or told.error_message
        return answer

    def spawn(self, name: str, asset: str = "cube", code: int = OK, **fields: Any) -> str:
        """Spawn an asset; return the entity's name."""
        answer = self.send("SpawnEntity", spawn_request(name, asset, **fields), code)
        return str(answer.entity_name)

    def state(self, entity: str) -> Any:
        """Return the state of an entity."""
        return self("GetEntityState", entity=entity).state

    def set_state(self, entity: str, state: Any, code: int = OK) -> None:
        """Set pose and twist, and the acceleration where it is not 0."""
        request = srv.SetEntityState.Request(entity=entity, state=state)
        for flag in ("set_pose", "set_twist"):
            if hasattr(request, flag):
                setattr(request, flag, True)
        if hasattr(request, "set_acceleration"):
            request.set_acceleration = state.acceleration.linear.x != 0.0
        self.send("SetEntityState", request, code)

    def entities(self, **filters: Any) -> list[str]:
        """Return the names of the entities that pass filters."""
        return list(self("GetEntities", filters=EntityFilters(**filters)).entities)

    def set_to(self, state: int, code: int = OK) -> None:
        """Ask for a state of the simulation."""
        self("SetSimulationState", code, state=SimulationState(state=state))

    @property
    def simulation_state(self) -> int:
        """The state of the simulation."""
        return int(self("GetSimulationState").state.state)


def spawn_request(name: str, asset: str, **fields: Any) -> Any:
    """Make the request to spawn an asset ``at`` a place [m]."""
    at = fields.pop("at", (40.0, 0.0, 50.0))
    request = srv.SpawnEntity.Request(name=name, **fields)
    set_resource(request, uri=asset and f"sailenv://asset/{asset}")
    place = request.initial_pose.pose.position
    place.x, place.y, place.z = map(float, at)
    return request


def set_resource(request: Any, *, uri: str = "", text: str = "") -> None:
    """Name what is to be spawned."""
    resource = getattr(request, "entity_resource", request)
    resource.uri, resource.resource_string = uri, text


def world(name: str = "", *, uri: str = "", text: str = "") -> dict[str, Any]:
    """Return the fields of a request for a scene, or for another resource."""
    fields = {"uri": uri or (name and f"sailenv://scene/{name}"), "resource_string": text}
    flat = hasattr(srv.LoadWorld.Request, "uri")
    return fields if flat else {"world_resource": Resource(**fields)}
