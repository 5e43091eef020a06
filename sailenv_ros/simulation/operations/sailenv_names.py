"""Names of the original SAILenv client for what has another name here, for its scripts.

Colours are red, green, blue from 0 to 255 (sRGB) here.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from sailenv_ros.simulation.operations.agent_operations import AgentOperations, set_following
from sailenv_ros.simulation.operations.environment import EnvironmentOperations
from sailenv_ros.simulation.operations.light_operations import LightOperations
from sailenv_ros.simulation.operations.operation import operation
from sailenv_ros.simulation.operations.scene_tables import SceneTables
from sailenv_ros.simulation.operations.targets import HasAgents
from sailenv_ros.types.colour import linear_from_srgb8, srgb8_from_linear
from sailenv_ros.types.lights import LightType

__all__ = ["SailenvNames"]

Vector3 = tuple[float, float, float]


class SailenvNames(AgentOperations, LightOperations, EnvironmentOperations, SceneTables):
    """Duplicates that exist for scripts of the SAILenv client; `docs/porting.md` lists them."""

    # -- agents and tables -----------------------------------------------------------------

    def get_position(self, *, agent: str | None = None) -> Vector3:
        """Return an agent's world coordinates [m]."""
        return self.get_pose(agent=agent).position_m

    def get_rotation(self, *, agent: str | None = None) -> Vector3:
        """Return an agent's roll, pitch, yaw about fixed axes [deg]."""
        return self.get_pose(agent=agent).rpy_deg

    @operation()
    @staticmethod
    def toggle_follow(core: HasAgents, *, agent: str | None = None) -> bool:
        """Switch between following and not; return the new state."""
        return set_following(core, not core.agents[agent].spec.following, agent)

    def get_categories(self) -> dict[int, str]:
        """Return `categories`."""
        return self.categories

    @property
    def spawnable_objects_names(self) -> list[str]:
        """Names of the catalogue that `spawn_object` takes."""
        return list(self.info.spawnables)

    @property
    def lights_names(self) -> list[str]:
        """Names of the scene's lights."""
        return [light.name for light in self.lights]

    # -- lights ----------------------------------------------------------------------------

    def get_light_color(self, light_name: str) -> tuple[int, int, int]:
        """Return a light's red, green, blue, 0 to 255."""
        return srgb8_from_linear(self.get_light(light_name).colour)

    def set_light_color(self, light_name: str, r: int, g: int, b: int) -> None:
        """Set a light's red, green, blue, 0 to 255."""
        self.set_light(light_name, colour=linear_from_srgb8("colour", (r, g, b)))

    def get_light_intensity(self, light_name: str) -> float:
        """Return a light's intensity (see `Light` for its unit)."""
        return self.get_light(light_name).intensity

    def set_light_intensity(self, light_name: str, intensity: float) -> None:
        """Set a light's intensity, 0 or more."""
        self.set_light(light_name, intensity=intensity)

    def get_light_indirect_multiplier(self, light_name: str) -> float:
        """Return the factor of a light's bounced part."""
        return self.get_light(light_name).indirect_multiplier

    def set_light_indirect_multiplier(self, light_name: str, indirect_multiplier: float) -> None:
        """Set the factor of a light's bounced part, 0 or more."""
        self.set_light(light_name, indirect_multiplier=indirect_multiplier)

    def get_light_position(self, light_name: str) -> Vector3:
        """Return a light's world coordinates [m]."""
        return self.get_light(light_name).position_m

    def set_light_position(self, light_name: str, position: ArrayLike) -> None:
        """Put a light at world coordinates [m]."""
        self.set_light(light_name, position_m=position)

    def get_light_direction(self, light_name: str) -> Vector3:
        """Return the unit vector that a light travels along."""
        return self.get_light(light_name).direction

    def set_light_direction(self, light_name: str, direction: ArrayLike) -> None:
        """Set the vector, of any length, that a light travels along."""
        self.set_light(light_name, direction=direction)

    def get_light_type(self, light_name: str) -> str:
        """Return a light's type: directional, point, spot or area."""
        return self.get_light(light_name).type

    def set_light_type(self, light_name: str, light_type: LightType) -> None:
        """Make a light directional, point, spot or area."""
        self.set_light(light_name, type=light_type)

    # -- surroundings ----------------------------------------------------------------------

    def get_ambient_light_color(self) -> tuple[int, int, int]:
        """Return red, green, blue, 0 to 255, of the light that arrives from everywhere."""
        return srgb8_from_linear(self.get_ambient_light())

    def set_ambient_light_color(self, r: int, g: int, b: int) -> None:
        """Set red, green, blue, 0 to 255, of the light that arrives from everywhere."""
        self.set_ambient_light(linear_from_srgb8("colour", (r, g, b)))

    def change_main_camera_clear_flags(self, r: int, g: int, b: int) -> None:
        """Show a colour (0 to 255 each) where nothing is hit; the sky if one is negative."""
        if min(r, g, b) < 0:
            self.set_background("sky")
        else:
            self.set_background("colour", linear_from_srgb8("colour", (r, g, b)))
