"""The package's errors come out of other processes as they went in."""

from __future__ import annotations

import copy
import errno
import multiprocessing
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import pytest

from sailenv_ros import errors
from sailenv_ros.errors import SailenvError

FULL = OSError(errno.ENOSPC, "no space")

ERRORS: dict[str, SailenvError] = {
    type(error).__name__: error
    for error in (
        SailenvError("a sentence"),
        errors.InvalidRequest("width", 3, "8 to 4096 [px]"),
        errors.UnknownName("view", "dept", ["depth", "rgb"]),
        errors.NameTaken("agent", "eye"),
        errors.InvalidEntry("object 'chair'", {}, [("mass", "must be above 0")]),
        errors.InvalidState("it is running"),
        errors.NoFreeSpace("there is none"),
        errors.AddressInUse("the gateway", "::1", 80),
        errors.InternalFault("an error"),
        errors.SceneError(
            [errors.SceneDiagnostic(path="a.yaml", line=1, column=2, field="x", message="is wrong")]
        ),
        errors.AssetError("chair", "has no mesh"),
        errors.AssetMissing("arm.urdf", "there is no such file"),
        errors.PhysicsError("it diverged"),
        errors.RenderError("it cannot be drawn"),
        errors.ContextError(["no device"]),
        errors.NativeLibraryError("it is missing"),
        errors.SimulationClosed("it was closed"),
        errors.WrongProcess("Simulation", made_in=7),
        errors.DeadlineExceeded("a frame", 30.0),
        errors.SimulatorLost("a frame", 1.5),
        errors.ProtocolError("a byte is wrong"),
        errors.RecordingError("it is damaged"),
        errors.WriteFailed("a.bin", FULL),
        errors.PlaceTaken("folder"),
        errors.BegunOtherwise("folder", {"seed": (1, 2)}),
        errors.StorageError("light", "a.light", FULL),
        errors.MissingPackage("a plot", "matplotlib", "pip install matplotlib"),
    )
}


def test_each_error_of_the_tree_is_tried_below() -> None:
    tree = {
        name
        for name, value in vars(errors).items()
        if isinstance(value, type) and issubclass(value, SailenvError)
    }
    assert set(ERRORS) == tree


@pytest.mark.parametrize("way", [lambda e: pickle.loads(pickle.dumps(e)), copy.deepcopy, copy.copy])
@pytest.mark.parametrize("name", ERRORS)
def test_an_error_travels(name: str, way: Callable[[Any], Any]) -> None:
    """Type, sentence and attributes; the sentence is not built anew of itself."""
    error = ERRORS[name]
    sent = way(error)
    assert type(sent) is type(error)
    assert str(sent) == str(error)
    assert vars(sent) == vars(error)


def refuse() -> None:
    """Raise an error whose constructor takes several arguments."""
    raise ERRORS["UnknownName"]


def test_a_pool_of_processes_gives_the_error_back() -> None:
    """One that could not be read there broke the whole pool."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        with pytest.raises(errors.UnknownName, match="did you mean 'depth'"):
            pool.submit(refuse).result(60)
        assert pool.submit(len, "abc").result(60) == 3


def test_a_sentence_repeats_no_long_names() -> None:
    """Names come from clients too, who may send a megabyte."""
    long = "x" * 1_000_000
    wrong = (
        errors.InvalidRequest(f"behaviour {long!r}", long, "one of: spin"),
        errors.InvalidEntry(f"object {long!r}", long, [("mass", "must be more than 0")]),
    )
    assert all(len(str(error)) < 400 for error in wrong)
