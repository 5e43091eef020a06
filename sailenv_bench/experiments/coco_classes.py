"""COCO's classes: the 80 names in their usual order, and the gaps in the ids of its files."""

from __future__ import annotations

__all__ = ["COCO_NAMES", "PAPER_CLASSES", "index_of_category_id"]

_NAMES = (
    "person|bicycle|car|motorcycle|airplane|bus|train|truck|boat|traffic light|fire hydrant|"
    "stop sign|parking meter|bench|bird|cat|dog|horse|sheep|cow|elephant|bear|zebra|giraffe|"
    "backpack|umbrella|handbag|tie|suitcase|frisbee|skis|snowboard|sports ball|kite|baseball bat|"
    "baseball glove|skateboard|surfboard|tennis racket|bottle|wine glass|cup|fork|knife|spoon|"
    "bowl|banana|apple|sandwich|orange|broccoli|carrot|hot dog|pizza|donut|cake|chair|couch|"
    "potted plant|bed|dining table|toilet|tv|laptop|mouse|remote|keyboard|cell phone|microwave|"
    "oven|toaster|sink|refrigerator|book|clock|vase|scissors|teddy bear|hair drier|"
    "toothbrush"
)
COCO_NAMES: tuple[str, ...] = tuple(_NAMES.split("|"))
"""Names by class index, 0 to 79."""

_UNUSED = (12, 26, 29, 30, 45, 66, 68, 69, 71, 83)
_BY_ID = {number: index for index, number in enumerate(n for n in range(1, 91) if n not in _UNUSED)}

PAPER_CLASSES: tuple[str, ...] = (
    "bed", "book", "chair", "couch", "dining table", "fork", "laptop", "airplane", "potted plant",
    "remote", "spoon", "tennis racket", "toilet", "tv",
)  # fmt: skip
"""The paper's 14 classes, in its table's order; our categories have the same names."""


def index_of_category_id(category_id: int) -> int:
    """Turn an id of COCO's files, 1 to 90 with gaps, into a class index; -1 for none."""
    return _BY_ID.get(category_id, -1)
