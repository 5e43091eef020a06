"""Choice of the objects that annotations tell of, and of what is stuff rather than a thing."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.errors import InvalidRequest

__all__ = ["ALL_OBJECTS", "AnnotationRules"]


@dataclass(frozen=True, slots=True, kw_only=True)
class AnnotationRules:
    """Objects that are annotated.

    Attributes
    ----------
    least_pixels : int
        Objects of which fewer are visible are left out.
    categories : tuple of str
        Objects of others are left out; empty takes all.
    stuff : tuple of str
        Categories whose surfaces are no objects, such as walls: left out of annotations of
        objects, and one segment each in COCO's panoptic ones.

    Raises
    ------
    InvalidRequest
        If the least size is below 1, or a category is both wanted and stuff.
    """

    least_pixels: int = 1
    categories: tuple[str, ...] = ()
    stuff: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.least_pixels < 1:
            raise InvalidRequest("least_pixels", self.least_pixels, "1 or more")
        both = [name for name in self.stuff if name in self.categories]
        if both:
            raise InvalidRequest("categories", both[0], "none that is stuff")

    def has(self, category: str) -> bool:
        """Return whether objects of a category are annotated."""
        return category not in self.stuff and (not self.categories or category in self.categories)


ALL_OBJECTS = AnnotationRules()
