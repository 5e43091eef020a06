"""Families and their styles: what makes a piece of values that a seed draws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sailenv_content.families.builder import PieceBuilder
    from sailenv_content.families.parameters import Values

__all__ = ["Family", "Style"]


@dataclass(frozen=True, slots=True)
class Style:
    """One way in which a family looks.

    Attributes
    ----------
    make : callable
        ``make(builder, values)`` puts the piece together: x to its front, z up, the origin at the
        middle of its base (on a wall: at the lower middle of its back, below a
        ceiling: at its lowest point). It may raise `Unfit`.
    parameters : mapping
        By name: `Span`, `Whole`, `Choice`, or a value that is always the same.
    category : str
        Empty takes the family's.
    """

    make: Callable[[PieceBuilder, Values], None]
    parameters: Mapping[str, Any] = field(default_factory=dict)
    category: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """A family of pieces.

    Attributes
    ----------
    name : str
    category : str
        Name in the category table.
    styles : mapping of str to Style
    least_m, most_m : (3,) tuple of float
        Sizes along x, y, z that a piece may have [m]; one that has not is drawn again.
    """

    name: str
    category: str
    styles: Mapping[str, Style]
    least_m: tuple[float, float, float]
    most_m: tuple[float, float, float]
