"""The lens of a camera as kernels take it: the structure of src/kernels/lens.h."""

from __future__ import annotations

import numpy as np

__all__ = ["LENS"]

LENS = np.dtype([(name, np.float64) for name in ("fx", "fy", "cx", "cy", "near_m", "far_m")])
"""`sailenv::Lens`; `CameraIntrinsics.lens_record` alone fills it in."""
