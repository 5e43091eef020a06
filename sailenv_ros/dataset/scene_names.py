"""A scene → the names and categories of all that a recipe may choose in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from sailenv_ros.assets.material_library import material_names
from sailenv_ros.scene.randomise.random_rules import selectable
from sailenv_ros.scene.randomise.selectors import Selector, is_meant
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.spec_materials import ALL_PARTS
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.labels import PART_MARK

__all__ = ["SceneNames"]


@dataclass(frozen=True, slots=True)
class SceneNames:
    """Names of a scene with their categories.

    Attributes
    ----------
    by_kind : mapping of str to mapping of str to str
        By the `type` of an entry of `randomise`; ``jointed``: objects on joints; ``camera``: what
        cameras may look at.
    agents : tuple of str
        Agents that the scene brings along.
    materials : mapping of str to frozenset of str
        Names of the materials of each object.
    """

    by_kind: Mapping[str, Mapping[str, str]]
    agents: tuple[str, ...] = ()
    materials: Mapping[str, frozenset[str]] = field(default_factory=dict)

    @classmethod
    def of(cls, spec: SceneSpec, library: SceneLibrary) -> SceneNames:
        """Return the names of a scene."""
        plain = spec.model_dump(mode="json", exclude_unset=True)
        kinds = {
            kind: selectable(plain, kind, lambda asset: library.peek_asset(asset).category) or {}
            for kind in ("object", "material", "light")
        }
        joints = {entry.name for entry in spec.objects if entry.joint is not None}
        kinds["behaviour"] = kinds["object"]
        kinds["jointed"] = {k: v for k, v in kinds["object"].items() if k in joints}
        seen, materials = dict(kinds["material"]), {}
        for entry in spec.objects:
            asset = library.peek_asset(entry.asset)
            materials[entry.name] = frozenset(material_names(asset))
            for part in asset.parts:
                seen[f"{entry.name}{PART_MARK}{part.name}"] = part.category
        return cls({**kinds, "camera": seen}, tuple(one.name for one in spec.agents), materials)

    def with_seen(self, seen: Mapping[str, str]) -> SceneNames:
        """Return them with more that cameras may look at: categories by names."""
        return replace(self, by_kind={**self.by_kind, "camera": {**self.by_kind["camera"], **seen}})

    def meant(self, kind: str, selector: Selector, part: str = ALL_PARTS) -> list[str]:
        """Return what a selector of an entry of that kind means, of that with a material `part`."""
        return [
            name
            for name, category in self.by_kind[kind].items()
            if is_meant(selector, name, category)
            and (part == ALL_PARTS or part in self.materials.get(name, ()))
        ]
