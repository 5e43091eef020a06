"""The 40 classes of NYU Depth V2 by their numbers: S. Gupta et al., CVPR 2013; 0 is none of them.

Names are spelt as `config/category_names.yaml` and the data set spell them.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["NYU40"]

_NAMES = (
    "wall floor cabinet bed chair sofa table door window bookshelf picture counter blinds desk "
    "shelves curtain dresser pillow mirror floor_mat clothes ceiling books refridgerator "
    "television paper towel showercurtain box whiteboard person night_stand toilet sink lamp "
    "bathtub bag otherstructure otherfurniture otherprop"
)

NYU40: Mapping[str, int] = MappingProxyType(
    {name.replace("_", " "): number for number, name in enumerate(_NAMES.split(), start=1)}
)
"""Numbers of the classes, from 1."""
