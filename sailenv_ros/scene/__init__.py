"""From a scene file to a validated `SceneSpec`."""

from sailenv_ros.scene.loader import SceneKnowledge, load_scene
from sailenv_ros.scene.scene_catalogue import SceneCatalogue
from sailenv_ros.scene.spec import SceneSpec

__all__ = ["SceneCatalogue", "SceneKnowledge", "SceneSpec", "load_scene"]
