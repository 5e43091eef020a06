"""From a catalogue name to everything that places an object: looks, collision shape, category."""

from sailenv_ros.assets.asset_library import AssetLibrary, AssetSource
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.fit import ObjectFit
from sailenv_ros.assets.paint import painted

__all__ = ["AssetLibrary", "AssetSource", "ObjectFit", "load_categories", "painted"]
