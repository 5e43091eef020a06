"""Paths of the files that are shipped beside the code: scenes and configuration.

A source checkout and an editable install have `scenes/` and `config/` beside the package. Every
other install (venv, user site, `--target`, ament prefix) has them in `share/sailenv_ros/` of some
folder above the package, whatever the scheme calls the folders between. Knows no file by name.
"""

from __future__ import annotations

from pathlib import Path

from sailenv_ros.errors import AssetError

__all__ = ["resource_path", "resource_root"]

_PACKAGE = "sailenv_ros"


def resource_path(*parts: str) -> Path:
    """Find a shipped file or folder.

    Parameters
    ----------
    *parts : str
        Its path inside the project, e.g. ``"config", "categories.yaml"`` or ``"scenes"``.

    Raises
    ------
    AssetError
        If it is not there: the install is broken.
    """
    path = resource_root().joinpath(*parts)
    if not path.exists():
        raise AssetError("/".join(parts), f"not found at {path}; install {_PACKAGE} again")
    return path


def resource_root(package: Path | None = None) -> Path:
    """Find the folder that holds `scenes/` and `config/`.

    Parameters
    ----------
    package : Path or None
        Folder of the package; None means this one's.

    Raises
    ------
    AssetError
        If no folder above the package has them: the install is broken.
    """
    package = Path(__file__).parents[1] if package is None else package
    # A symlinked install keeps the data beside the link or beside what it points to.
    for start in dict.fromkeys((package, package.resolve())):
        for folder in start.parents:
            for root in (folder, folder / "share" / _PACKAGE):
                if _is_root(root):
                    return root
    raise AssetError(
        _PACKAGE, f"no scenes/ and config/ found above {package}; install {_PACKAGE} again"
    )


def _is_root(folder: Path) -> bool:
    # categories.yaml, because a foreign folder above us may well have a config/ of its own.
    return (folder / "config" / "categories.yaml").is_file() and (folder / "scenes").is_dir()
