"""Surroundings of rooms: gardens, streets, corridors at their real size, made by code."""

from sailenv_ros.assets.outside.building import outside_asset, outside_of
from sailenv_ros.assets.outside.daylight import Daylight, daylight_of

__all__ = ["Daylight", "daylight_of", "outside_asset", "outside_of"]
