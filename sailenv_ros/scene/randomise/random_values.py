"""Drawing: entries, a seed and an index in, values out. Pure; the order of entries is nothing.

Each value has a generator of its own, seeded by the seed, the index, the instant, the entry's name,
the target's name and the key, so that an entry that comes or goes changes no other's values.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Literal

import numpy as np

from sailenv_ros.scene.randomise.drawn import Draw
from sailenv_ros.scene.randomise.randomisation import Randomisation, RandomTargets, Values
from sailenv_ros.scene.randomise.relative import RelativeDraw

__all__ = ["merged", "sampled"]


def sampled(
    things: Sequence[Randomisation],
    targets: RandomTargets,
    *,
    seed: int,
    index: int,
    every: Literal["epoch", "frame"] = "epoch",
    step: int = 0,
) -> Values:
    """Draw everything that is drawn for an epoch, or for a frame.

    Parameters
    ----------
    things : sequence of Randomisation
        As under `randomise` in a scene file.
    targets : RandomTargets
        What there is.
    seed : int
        0 or more.
    index : int
        Which of the seed's epochs, 0 or more.
    every : {'epoch', 'frame'}
    step : int
        Physics steps since the epoch began; counts for frames alone.

    Returns
    -------
    values : dict
        Plain data that JSON can hold; see `Values`. Later entries win over earlier ones. Of what
        is drawn relative to the scene's own value it has both the result and the amount.
    """
    drawn: Values = {}
    amounts: dict[tuple[str, str, str], Values] = {}
    instant = step if every == "frame" else -1
    for thing in things:
        if thing.every != every:
            continue

        def pick(target: str, key: str, draw: Draw, of: Randomisation = thing) -> object:
            words = "\0".join((str(seed), str(index), str(instant), of.name, target, key))
            digest = hashlib.blake2b(words.encode(), digest_size=16).digest()
            generator = np.random.default_rng(int.from_bytes(digest, "little"))
            place = (of.KEY, target, key)
            amounts.pop(place, None)
            if isinstance(draw, RelativeDraw):
                own = targets.own_value(*place)
                amount, value = draw.sample_from(own, generator)
                amounts[place] = {draw.distribution: _plain(amount)}
            else:
                value = draw.sample(generator)
            return _plain(value)

        drawn = merged(drawn, thing.values(targets, pick))
    for (kind, target, key), amount in amounts.items():
        named = {target: {key: amount}} if target else {key: amount}
        drawn = merged(drawn, {"relative": {kind: named}})
    return drawn


def merged(first: Values, second: Values) -> Values:
    """Return both, the second's values where both have one; lists are joined."""
    result = dict(first)
    for key, value in second.items():
        present = result.get(key)
        if isinstance(present, dict) and isinstance(value, dict):
            result[key] = merged(present, value)
        elif isinstance(present, list) and isinstance(value, list) and key == "added":
            result[key] = [*present, *value]
        else:
            result[key] = _plain(value)
    return result


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    return [_plain(part) for part in value] if isinstance(value, list | tuple) else value
