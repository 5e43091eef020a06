"""Playing a clip of recorded motion: where there is room for it, and from standing to standing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.motions import find_clip
from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity, ClipPlay
from sailenv_ros.postures.blending import JointTurns
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.retargeting import retargeted
from sailenv_ros.postures.skeleton import Posture, turn_about
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.world.activities.base import Actor, Instant, Place, SpotActivity

__all__ = ["Playing"]

Doubles = NDArray[np.float64]

_BLEND_S = 0.35
"""Time from standing to the clip, and back [s]."""

_SPACING_M = 0.2


class Playing(SpotActivity):
    """A person who moves as somebody once did.

    Parameters
    ----------
    actor : Actor
    play : ClipPlay
    here : (2,) tuple of float
        Where the person is [m].
    yaw : float
        Which way it looks [rad].
    """

    travels = True

    def __init__(self, actor: Actor, play: ClipPlay, here: Place, yaw: float) -> None:
        self._rig, self._scale = actor.rig, actor.scale
        self._clip = retargeted(find_clip(play.clip), actor.rig)
        self._speed, self._times = play.speed, play.times
        self.feet = here if play.place is None else play.place
        self.yaw = yaw if play.facing_deg is None else float(np.radians(play.facing_deg))
        self._done_s, self._round = -_BLEND_S, 0
        self._stops = False

    @property
    def word(self) -> Activity:
        """Word for it now."""
        return "playing"

    def way(self) -> Doubles:
        """Return (N, 2) places that the body passes in all rounds [m]."""
        x, y, turn = self._clip.end
        found, base = [], np.array([*self.feet, self.yaw])
        steps = self._clip.way
        for _ in range(self._times):
            c, s = np.cos(base[2]), np.sin(base[2])
            own = np.array([[c, -s], [s, c]])
            found.append(self._scale * steps @ own.T + base[:2])
            base = np.array([*(self._scale * own @ [x, y] + base[:2]), base[2] + turn])
        places = np.concatenate(found)
        away = np.cumsum(np.append(0.0, np.linalg.norm(np.diff(places, axis=0), axis=1)))
        keep = np.unique(np.searchsorted(away, np.arange(0.0, away[-1] + _SPACING_M, _SPACING_M)))
        return places[np.minimum(keep, len(places) - 1)]

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once the person stands again."""
        self._done_s += STEP_S * (self._speed if 0.0 <= self._done_s < self._length_s else 1.0)
        if self._done_s >= self._length_s and self._round + 1 < self._times and not self._stops:
            self._round += 1
            self._done_s = 0.0
        return self._done_s < self._length_s + _BLEND_S

    def end(self) -> None:
        """Begin to end it: it is the last round."""
        self._stops = True

    def moved(self, begin: Doubles) -> Doubles:
        """Return the pose of the body, which goes along with the clip."""
        x, y, turn = self._clip.end
        matrix = begin
        for _ in range(self._round):
            matrix = matrix @ _on_floor(self._scale * x, self._scale * y, turn)
        return np.asarray(matrix @ self._own())

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        own = self._own()
        played = self._clip.posture(self._time_s)
        back = own[:3, :3].T
        posture = Posture(
            root_m=back @ (played.root_m - own[:3, 3] / self._scale),
            turns={name: back @ turn for name, turn in played.turns.items()},
        )
        blend = self._stands
        if blend <= 0.0:
            return posture
        stands = walking_posture(self._rig, now.moment, now.time_s, seed=now.seed, look=now.look)
        one, two = (JointTurns.of(self._rig, each) for each in (posture, stands))
        return one.towards(two, blend).posture(self._rig)

    @property
    def _length_s(self) -> float:
        return self._clip.duration_s

    @property
    def _time_s(self) -> float:
        return float(np.clip(self._done_s, 0.0, self._length_s))

    @property
    def _stands(self) -> float:
        """Share of standing at the beginning and at the end."""
        away = max(-self._done_s, self._done_s - self._length_s)
        return smooth_step(float(np.clip(away / _BLEND_S, 0.0, 1.0)))

    def _own(self) -> Doubles:
        """Return the pose of the body from where the round began."""
        frame = self._clip.place_at(self._time_s)
        share = self._time_s / max(self._length_s, 1e-9)
        return _on_floor(self._scale * frame[0], self._scale * frame[1], share * self._clip.end[2])


def _on_floor(x: float, y: float, yaw: float) -> Doubles:
    matrix = np.eye(4)
    matrix[:3, :3] = turn_about("z", float(np.degrees(yaw)))
    matrix[:2, 3] = x, y
    return matrix
