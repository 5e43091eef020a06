"""A lamp as kernels and shaders take it: the structure of src/kernels/light_law.h."""

from __future__ import annotations

import numpy as np

__all__ = ["LAMP"]

LAMP = np.dtype(
    [
        ("colour", "<f4", 3),
        ("kind", "<i4"),
        ("position", "<f4", 3),
        ("range_m", "<f4"),
        ("direction", "<f4", 3),
        ("inner_cosine", "<f4"),
        ("outer_cosine", "<f4"),
        ("exponent", "<f4"),
        ("padding", "<f4", 2),
    ]
)
"""`sailenv::Lamp`; `types.lights.lamp_rows` alone fills it in."""
