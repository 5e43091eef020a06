"""The kernels that frames are made with: those of the native library, or plain NumPy's.

Both compute the same bytes. Without the native library frames are right, and slow: it is missing
only where the package was installed from its sources without a C++ compiler.
"""

from __future__ import annotations

from sailenv_ros.native import (
    ambient_visibility,
    annotation,
    light_gathering,
    light_maps,
    motion_kernels,
    picture_kernels,
    ray_kernels,
    resolve,
)
from sailenv_ros.native.library import native_is_usable
from sailenv_ros.render import reference_kernels, reference_motion, reference_rays
from sailenv_ros.render.gl import reflection_blur

__all__ = [
    "annotate_pixels",
    "blur_directions",
    "build_tree",
    "cast_rays",
    "find_ambient_visibility",
    "gather_light",
    "make_picture",
    "move_points",
    "resolve_samples",
    "transform_points",
]


if native_is_usable():
    annotate_pixels = annotation.annotate_pixels
    blur_directions = light_maps.blur_directions
    build_tree = ray_kernels.build_tree
    cast_rays = ray_kernels.cast_rays
    find_ambient_visibility = ambient_visibility.find_ambient_visibility
    gather_light = light_gathering.gather_light
    make_picture = picture_kernels.make_picture
    resolve_samples = resolve.resolve_samples
    move_points = motion_kernels.move_points
    transform_points = motion_kernels.transform_points
else:
    annotate_pixels = reference_kernels.annotate_pixels
    blur_directions = reflection_blur.blur_directions
    build_tree = reference_rays.build_tree
    cast_rays = reference_rays.cast_rays
    find_ambient_visibility = reference_kernels.find_ambient_visibility
    gather_light = reference_kernels.gather_light
    make_picture = reference_kernels.make_picture
    resolve_samples = reference_kernels.resolve_samples
    move_points = reference_motion.move_points
    transform_points = reference_motion.transform_points
