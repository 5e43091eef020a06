"""A policy of stable-baselines3 that judges all directions alike, and mirrored worlds, too.

What it learns of one direction it knows of all others, from a fraction of the steps.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.policies import ActorCriticPolicy
from torch import Tensor, nn

from benchmarks.gym_search_policies import FIRST, MIRRORED, TURNS
from benchmarks.gym_searcher import ORDER, SECTORS, SIGNS

__all__ = ["DirectionPolicy"]

HIDDEN = 64, 64


def _network(inputs: int, outputs: int, gain: float) -> nn.Sequential:
    sizes = (inputs, *HIDDEN)
    layers: list[nn.Module] = []
    for before, after in pairwise(sizes):
        layers += [nn.Linear(before, after), nn.Tanh()]
    last = nn.Linear(sizes[-1], outputs)
    for layer in (*layers, last):
        if isinstance(layer, nn.Linear):
            nn.init.orthogonal_(layer.weight, gain if layer is last else 2.0**0.5)
            nn.init.zeros_(layer.bias)
    return nn.Sequential(*layers, last)


class _Scores(nn.Module):
    """Scores of decisions, and the value, of the world and the mirrored one together."""

    def __init__(self) -> None:
        super().__init__()
        size = len(ORDER)
        self._order = torch.as_tensor(ORDER)
        self._signs = torch.as_tensor(SIGNS, dtype=torch.float32)
        self._actions, self._first = list(MIRRORED), torch.tensor(FIRST)
        rows = SECTORS * np.arange(4)[:, None]
        turned = (np.arange(SECTORS) + np.arange(TURNS)[:, None, None] * SECTORS // TURNS) % SECTORS
        self._turned = torch.as_tensor((rows + turned).reshape(TURNS, -1))
        left = torch.arange(TURNS) * (math.tau / TURNS)
        self._sine, self._cosine = torch.sin(left), torch.cos(left)
        self._cost = torch.stack([self._cosine, self._sine], 1)
        self._ways = _network(size + 2, 2, 0.01)
        self._rest = _network(size, len(MIRRORED) - 2 * TURNS, 0.01)
        self._value = _network(size, 1, 1.0)
        self.latent_dim_pi, self.latent_dim_vf = len(MIRRORED), 1  # as the base class asks

    def forward(self, seen: Tensor) -> tuple[Tensor, Tensor]:
        """Return scores and value."""
        return self.forward_actor(seen), self.forward_critic(seen)

    def forward_actor(self, seen: Tensor) -> Tensor:
        """Return scores of decisions."""
        scores: Tensor = self._scores(seen) + self._scores(self._of(seen))[:, self._actions]
        return scores + self._first

    def forward_critic(self, seen: Tensor) -> Tensor:
        """Return the value."""
        value: Tensor = (self._value(seen) + self._value(self._of(seen))) / 2.0
        return value

    def _of(self, seen: Tensor) -> Tensor:
        return seen[:, self._order] * self._signs

    def _scores(self, seen: Tensor) -> Tensor:
        """Return scores from what each direction is like once one has turned there."""
        count, around = len(seen), 4 * SECTORS
        known, sine, cosine, rest = torch.split(
            seen[:, around:], [1, 1, 1, seen.shape[1] - around - 3], 1
        )
        ahead = cosine * self._cosine + sine * self._sine
        aside = sine * self._cosine - cosine * self._sine
        same = torch.cat([known, rest], 1)[:, None].expand(-1, TURNS, -1)
        cost = self._cost.expand(count, -1, -1)
        ways = torch.cat([seen[:, self._turned], aside[..., None], ahead[..., None], same, cost], 2)
        walks, turns = self._ways(ways).unbind(2)
        return torch.cat([walks, turns, self._rest(seen)], 1)


class DirectionPolicy(ActorCriticPolicy):
    """See above; for a `Strider`."""

    def __init__(self, *settings: Any, **more: Any) -> None:
        super().__init__(*settings, **{**more, "ortho_init": False})  # it begins as made

    def _build_mlp_extractor(self) -> None:
        self.mlp_extractor = _Scores()

    def _build(self, lr_schedule: Any) -> None:
        super()._build(lr_schedule)
        self.action_net, self.value_net = nn.Identity(), nn.Identity()
