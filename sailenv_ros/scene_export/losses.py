"""Sentences that say what a format cannot hold of a scene."""

from __future__ import annotations

from collections.abc import Iterator

from sailenv_ros.scene_export.contents import ExportedScene

__all__ = [
    "RICH",
    "camera_losses",
    "counted",
    "joint_losses",
    "light_losses",
    "motion_losses",
    "physics_losses",
]

RICH = (".glb", ".usda", ".usdz")
"""Formats that hold motion and baked light."""


def counted(count: int, noun: str) -> str:
    """Return a number with its noun, e.g. ``"2 lights"``."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def physics_losses(scene: ExportedScene, name: str, *, extras: bool) -> Iterator[str]:
    """Yield what a format without physics leaves out."""
    where = "; masses and joints stand in its extras" if extras else ""
    if any(body.shapes for body in scene.bodies):
        yield f"{name} has no collision shapes, masses and joints{where}"


def joint_losses(scene: ExportedScene, name: str) -> Iterator[str]:
    """Yield what a format with joints leaves out of them."""
    acting = sum(body.joint is not None and body.joint.acts for body in scene.bodies)
    if acting:
        yield f"soft close and detents of {counted(acting, 'joint')} have no equal in {name}"


def light_losses(scene: ExportedScene, name: str) -> Iterator[str]:
    """Yield what punctual lights leave out."""
    areas = sum(light.type == "area" for light in scene.lights)
    if areas:
        yield f"{counted(areas, 'area light')} became spots of the same power in {name}"
    exponents = sum(light.exponent > 0.0 for light in scene.lights if light.type == "spot")
    if exponents:
        yield f"{counted(exponents, 'spot')} lost the exponent, which {name} does not have"
    if scene.environment is not None:
        yield f"the sky and ambient light have no equal in {name}"


def camera_losses(scene: ExportedScene, name: str, *, shifts: bool = False) -> Iterator[str]:
    """Yield what a pin-hole in the middle of its picture leaves out.

    Parameters
    ----------
    shifts : bool
        True for a format that has the principal point.
    """
    lenses = [camera.intrinsics for camera in scene.cameras]
    bent = sum(not lens.is_pinhole and not lens.is_parallel for lens in lenses)
    if bent:
        yield (
            f"the lenses of {counted(bent, 'camera')} have no equal in {name}; it has pin-holes of "
            "the same focal length"
        )
    off = sum(bool(lens.cx_offset_px or lens.cy_offset_px) for lens in lenses)
    if off and not shifts:
        yield f"the principal points of {counted(off, 'camera')} have no equal in {name}"


def motion_losses(scene: ExportedScene, suffix: str) -> Iterator[str]:
    """Yield what of a motion is left out."""
    motion = scene.motion
    if motion is None:
        return
    if suffix not in RICH:
        yield f"{suffix} has no motion; the first moment was written"
        return
    stiff = sum(
        piece.deforms and piece.instance.id not in motion.meshes
        for body in scene.bodies
        for piece in body.pieces
    )
    if stiff:
        yield f"{counted(stiff, 'person')} keep their shape, which frames of files do not have"
