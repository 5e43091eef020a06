"""The source of people for the `AssetLibrary`: a name in, a person out, kept on disk."""

from __future__ import annotations

from sailenv_content.people.fetch_bodies import BODIES_COMMAND, SOURCE, body_data
from sailenv_content.people.looks import people
from sailenv_ros.assets.model_cache import cached_object
from sailenv_ros.assets.named_assets import NamedAssets
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.native.library import native_library
from sailenv_ros.system.array_cache import code_digest
from sailenv_ros.types.model import Asset

__all__ = ["IN_PARTS", "PeopleSource"]

IN_PARTS = "_in_parts"
"""Ends the name of a person whose hair and clothes have labels of their own."""

PREFIX = "person_"

_CODE = ("../sailenv_content/people", "assets", "types")
"""Folders of the modules that the making of a person goes through."""


class PeopleSource(NamedAssets):
    """People by their names, ``person_01`` and ``person_01_in_parts``; none without the data."""

    def speaks_of(self, name: str) -> bool:
        """Return whether a name is meant to be one of a person."""
        return name.startswith(PREFIX)

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no person of a name; None if there is one."""
        whole = name.removesuffix(IN_PARTS)
        return None if whole in people() else UnknownName("person", whole, people())

    def _prepare(self, name: str) -> None:
        if body_data() is None:
            raise AssetError(name, f"the data of bodies is not here; fetch it: {BODIES_COMMAND}")

    def _make(self, name: str) -> Asset:
        whole, data = name.removesuffix(IN_PARTS), body_data()
        assert data is not None
        look = people()[whole]

        def make() -> Asset:
            from sailenv_content.people.making import make_person  # imports SciPy

            return make_person(name, look, data, labelled=name != whole)

        key = SOURCE, native_library().digest, name, look.model_dump_json()
        return cached_object("person", key, make, code=code_digest(*_CODE, libraries=("scipy",)))
