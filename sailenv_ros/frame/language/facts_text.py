"""`SceneFacts` ↔ one line of JSON, which recordings keep."""

from __future__ import annotations

import base64
import dataclasses
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.language.scene_facts import Gap, Opening, SceneFacts
from sailenv_ros.space.free_space import BodySize, FreeSpace

__all__ = ["facts_of_text", "text_of_facts"]


def text_of_facts(facts: SceneFacts) -> str:
    """Return facts as JSON; the same text for the same facts."""
    told = {
        "sim_time_ns": facts.sim_time_ns,
        "gaps": [[*pair, gap.gap_m, gap.rise] for pair, gap in facts.gaps.items()],
        "enclosed": [[*pair, met] for pair, met in facts.enclosed.items()],
        "openings": [
            [id_, one.whole, one.position, one.share] for id_, one in facts.openings.items()
        ],
        "materials": [[id_, dict(shares)] for id_, shares in facts.materials.items()],
        "spaces": [
            {
                "rows": len(space.cells),
                "cells": base64.b64encode(space.cells.tobytes()).decode(),
                "origin_m": space.origin_m,
                "body": dataclasses.asdict(space.body),
                "stamp_ns": space.stamp_ns,
            }
            for space in facts.spaces
        ],
    }
    return json.dumps(told, separators=(",", ":"))


def facts_of_text(text: str) -> SceneFacts:
    """Read facts that `text_of_facts` wrote.

    Raises
    ------
    InvalidRequest
        If it did not.
    """
    try:
        told = json.loads(text)
        return SceneFacts(
            sim_time_ns=told["sim_time_ns"],
            gaps={(a, b): Gap(gap_m=gap, rise=rise) for a, b, gap, rise in told["gaps"]},
            enclosed={(a, b): met for a, b, met in told["enclosed"]},
            openings={
                id_: Opening(whole=whole, position=position, share=share)
                for id_, whole, position, share in told["openings"]
            },
            materials=dict(told["materials"]),
            spaces=tuple(map(_space, told["spaces"])),
        )
    except (ValueError, TypeError, KeyError) as problem:
        accepted = f"JSON with the fields of SceneFacts ({problem})"
        raise InvalidRequest("facts", f"{text[:40]}…", accepted) from None


def _space(told: Mapping[str, Any]) -> FreeSpace:
    cells = np.frombuffer(base64.b64decode(told["cells"]), np.int8).reshape(told["rows"], -1)
    x, y = told["origin_m"]
    body = BodySize(**told["body"])
    return FreeSpace(cells=cells, origin_m=(x, y), body=body, stamp_ns=told["stamp_ns"])
