"""Pushers of the objects and the camera of the streams of continual optical flow (CoLLAs 2022).

The published programs step 1 ms a picture and call 25 pictures a second. Here a second is one: all
velocities are such that objects and camera move as far from picture to picture as there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.geometry import look_at

__all__ = ["FurnitureForces", "LaptopForces", "RoamingForces"]

Vector = NDArray[np.float64]

FRAME_S = 1.0 / 25.0

PUBLISHED_STEP_S = 0.001

SLOWER = PUBLISHED_STEP_S / FRAME_S
"""Factor on the velocities of the published programs."""


class LaptopForces:
    """Pushes one floating object at random within a rectangle, which the camera looks at.

    Parameters
    ----------
    seed : int
    """

    NAME = "laptop"
    EYE_M = (0.0, 0.0, 0.995)
    LEAST_M, MOST_M = np.array([-0.421, 0.615]), np.array([0.433, 1.39])
    """Range of its position: to the left and up, seen from the camera [m]."""

    NEAR_M = 0.2
    """Nearer than this to a side of the rectangle it is sent back."""

    CHANCE = 0.01
    IMPULSE_N_S, MASS_KG = 0.9, 0.3
    """Impulse of the published program, and the mass: theirs is not published; this one moves the
    picture by about a pixel, beyond the 0.5 px from which the metrics count a pixel as moving."""

    SPEED_M_S = IMPULSE_N_S / MASS_KG * SLOWER

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 1])

    def apply(self, simulation: Simulation, number: int) -> None:
        """Send it another way, if it is time, and turn the camera to it."""
        thing = simulation.get_object(self.NAME)
        simulation.set_pose(look_at(self.EYE_M, thing.pose.position_m))
        place = np.asarray(thing.pose.position_m)[1:]
        # Drawn in every frame, so that what happens at the sides changes nothing later.
        chance, direction = self._rng.uniform(), self._rng.normal(size=2)
        wanted: Vector | None = None
        if number == 1:
            wanted = direction / self.MASS_KG * SLOWER
        elif min((place - self.LEAST_M).min(), (self.MOST_M - place).min()) < self.NEAR_M:
            wanted = 5.0 * SLOWER * ((self.LEAST_M + self.MOST_M) / 2.0 - place)
        elif chance < self.CHANCE:
            wanted = self.SPEED_M_S * direction / np.linalg.norm(direction)
        if wanted is None:
            return
        now = np.asarray(thing.linear_velocity)
        change = np.array([0.0, *wanted]) - now
        simulation.apply_wrench(self.NAME, force_n=thing.mass_kg * change / STEP_S)


class FurnitureForces:
    """Pushes and twists furniture in every frame, by Gaussian forces and torques.

    Parameters
    ----------
    seed : int
    """

    NAMES = ("bed", "lamp", "box", "side table")
    FORCE_N = 5.0
    TORQUE_NM = 0.5

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 2])

    def apply(self, simulation: Simulation, number: int) -> None:
        """Push each for the time of a frame."""
        for name in self.NAMES:
            drawn = self._rng.normal(size=6)
            simulation.apply_wrench(
                name,
                force_n=self.FORCE_N * drawn[:3],
                torque_nm=self.TORQUE_NM * drawn[3:],
                duration_s=FRAME_S,
            )


class RoamingForces:
    """Pushes the furniture, and a camera that is a body and looks at a point.

    The scene's mover is the camera's body: a small ball that floats, with drag, and bounces off
    whatever it strikes.

    Parameters
    ----------
    seed : int
    """

    IMPULSES_N_S = (0.8 * SLOWER, 1.1 * SLOWER)
    EVERY = 200
    """Frames between two pushes."""

    SLOW_M_S, FAST_M_S = 3.0 * SLOWER, 8.5 * SLOWER
    SLOW_FRAMES = 20
    """Number of slow frames after which it is pushed, too."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 3])
        self._furniture = FurnitureForces(seed)
        self._slow = 0
        self._last: tuple[int, float] | None = None

    def apply(self, simulation: Simulation, number: int) -> None:
        """Push all: the camera against its way if it is fast, else along an axis if it is time."""
        self._furniture.apply(simulation, number)
        velocity = np.asarray(simulation.get_mover_velocity()[0])
        impulse = self._impulse(velocity, number)
        if impulse.any():
            mover = simulation.info.movers[0].name
            simulation.apply_wrench(mover, force_n=impulse / STEP_S)

    def _impulse(self, velocity: Vector, number: int) -> Vector:
        """Return the impulse before a frame [N s]; asked once a frame, in order."""
        # Drawn in every frame, so that how fast it is changes nothing later.
        impulse = float(self._rng.uniform(*self.IMPULSES_N_S))
        direction = self._other_direction()
        speed = float(np.linalg.norm(velocity))
        self._slow = self._slow + 1 if speed < self.SLOW_M_S else 0
        pushed = np.zeros(3)
        if speed > self.FAST_M_S:
            pushed = -impulse / speed * velocity
        elif number % self.EVERY == 0 or self._slow >= self.SLOW_FRAMES:
            self._last = direction
            pushed[direction[0]] = direction[1] * impulse
        return pushed

    def _other_direction(self) -> tuple[int, float]:
        """Draw an axis and a sign, not those of the last push."""
        while True:
            drawn = int(self._rng.integers(3)), float(self._rng.integers(2) * 2 - 1)
            if drawn != self._last:
                return drawn
