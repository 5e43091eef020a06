"""Shipped files are found from wherever the package was installed to."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros.errors import AssetError
from sailenv_ros.system.resources import resource_path, resource_root

INSTALLS = {
    "venv": ("lib/python3.12/site-packages", "share/sailenv_ros"),
    "user site": (".local/lib/python3.12/site-packages", ".local/share/sailenv_ros"),
    "Debian": ("usr/local/lib/python3.12/dist-packages", "usr/local/share/sailenv_ros"),
    "ament prefix": (
        "ws/install/sailenv_ros/lib/python3.12/site-packages",
        "ws/install/sailenv_ros/share/sailenv_ros",
    ),
    "target folder": ("deployed", "deployed/share/sailenv_ros"),
    "checkout": ("sailenv_ros_checkout", "sailenv_ros_checkout"),
}


def install(root: Path, packages: str, data: str) -> tuple[Path, Path]:
    """Make the folders of an install; return those of the package and of the data."""
    package = root / packages / "sailenv_ros"
    package.mkdir(parents=True)
    (root / data / "scenes").mkdir(parents=True)
    (root / data / "config").mkdir()
    (root / data / "config" / "categories.yaml").touch()
    return package, root / data


@pytest.mark.parametrize("scheme", INSTALLS)
def test_every_install_scheme_is_understood(scheme: str, tmp_path: Path) -> None:
    """The data of that very install is found."""
    package, data = install(tmp_path, *INSTALLS[scheme])
    assert resource_root(package) == data


def test_the_nearest_data_wins(tmp_path: Path) -> None:
    """A workspace built inside a checkout reads its own data, not the checkout's."""
    install(tmp_path, "source", "source")
    package, data = install(
        tmp_path / "source" / "install", "lib/x/site-packages", "share/sailenv_ros"
    )
    assert resource_root(package) == data


def test_a_link_to_the_package_is_followed(tmp_path: Path) -> None:
    """An install by links reads the data beside what the link points to."""
    package, data = install(tmp_path, "source", "source")
    link = tmp_path / "build" / "sailenv_ros"
    link.parent.mkdir()
    link.symlink_to(package)
    assert resource_root(link) == data


def test_somebody_elses_config_is_not_mistaken(tmp_path: Path) -> None:
    """Folders of the right names with other things in them are passed over."""
    package, data = install(tmp_path, "lib/python3.12/site-packages", "share/sailenv_ros")
    for name in ("config", "scenes"):
        (package.parent / name).mkdir()
    assert resource_root(package) == data


def test_a_broken_install_is_told(tmp_path: Path) -> None:
    """Without data there is one sentence that says where it was looked for."""
    package = tmp_path / "lib" / "sailenv_ros"
    package.mkdir(parents=True)
    with pytest.raises(AssetError, match=f"above {package}; install sailenv_ros again"):
        resource_root(package)


def test_a_missing_file_is_told() -> None:
    """The sentence names the file as it was asked for."""
    with pytest.raises(AssetError, match=r"config/no_such\.yaml.*install sailenv_ros again"):
        resource_path("config", "no_such.yaml")


def test_what_the_package_itself_needs_is_there() -> None:
    """The files that the code asks for by name are shipped."""
    for parts in (("config", "categories.yaml"), ("config", "fastdds.xml"), ("scenes",)):
        assert resource_path(*parts).exists()
