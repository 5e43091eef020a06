"""Every request of a simulation as a blocking method with a deadline.

The methods are those of `SimulationCore` by name: those of `agent_requests.py` are in
`agent_calls.py`, and so forth. Knows no thread and no queue.
"""

from __future__ import annotations

from sailenv_ros.simulation.agent_calls import AgentCalls
from sailenv_ros.simulation.model_calls import ModelCalls
from sailenv_ros.simulation.motion_calls import MotionCalls
from sailenv_ros.simulation.save_calls import SaveCalls
from sailenv_ros.simulation.world_calls import WorldCalls

__all__ = ["REQUESTS", "Requests"]

REQUESTS = frozenset(
    {
        "add_light",
        "attach_behaviour",
        "capture",
        "change_object",
        "change_scene",
        "delete_agent",
        "despawn_object",
        "detach_behaviours",
        "drive_mover",
        "get_object",
        "get_picture",
        "get_pose",
        "lights",
        "load_scenario",
        "move_object",
        "mover_pose",
        "pause",
        "register_agent",
        "remove_light",
        "reset",
        "resume",
        "save_scene",
        "scene_text",
        "set_ambient_light",
        "set_background",
        "set_environment",
        "set_follow",
        "set_intrinsics",
        "set_light",
        "set_mover_controller",
        "set_picture",
        "set_pose",
        "set_position",
        "set_rate",
        "set_real_time_factor",
        "set_rotation",
        "set_waypoints",
        "spawn_object",
        "spawnable_display_names",
        "step",
        "thumbnail",
        "toggle_follow",
        "turn_mover",
        "upload_model",
    }
)
"""Names that `Simulation.request` takes: public requests of `SimulationCore`, and what needs no
world: models and thumbnails."""


class Requests(AgentCalls, MotionCalls, WorldCalls, ModelCalls, SaveCalls):
    """The blocking methods; `Simulation` adds the queue that `request` puts them into."""

    def change_scene(self, name: str, *, timeout_s: float = 120.0) -> None:
        """Leave the present world for another scene, at simulated time 0."""
        self._ask("change_scene", timeout_s, name)

    def reset(self, seed: int | None = None, *, timeout_s: float = 120.0) -> int:
        """Begin the present scene anew, with another seed if one is given; give the epoch."""
        result: int = self._ask("reset", timeout_s, seed)
        return result

    def pause(self, *, timeout_s: float = 30.0) -> None:
        """Hold simulated time."""
        self._ask("pause", timeout_s)

    def resume(self, *, timeout_s: float = 30.0) -> None:
        """Let simulated time run on."""
        self._ask("resume", timeout_s)

    def set_real_time_factor(self, factor: float, *, timeout_s: float = 30.0) -> None:
        """Change how many simulated seconds per wall second are aimed at, 0.1 to 10."""
        self._ask("set_real_time_factor", timeout_s, factor)

    def step(self, count: int = 1, *, timeout_s: float = 600.0) -> int:
        """Advance by physics steps of 1/240 s; give the simulated time afterwards [ns]."""
        result: int = self._ask("step", timeout_s, count)
        return result
