"""The blocking methods about models of the catalogue; part of `Requests`."""

from __future__ import annotations

from sailenv_ros.simulation.calls import Calls

__all__ = ["ModelCalls"]


class ModelCalls(Calls):
    """Requests that need no world: they are answered beside the loop."""

    def upload_model(
        self,
        data: bytes,
        *,
        name: str,
        filename: str,
        category: str | None = None,
        height_m: float | None = None,
        timeout_s: float = 120.0,
    ) -> str:
        """Add a model to the catalogue; give the name that it is spawned by.

        The simulation goes on meanwhile. See `sailenv_ros.simulation.uploads` for the arguments;
        an empty name is made from the file's, with a number where it is in use.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest, AssetError
            If it cannot be used; the catalogue is as it was then.
        """
        result: str = self._ask(
            "upload_model",
            timeout_s,
            data,
            name=name,
            filename=filename,
            category=category,
            height_m=height_m,
        )
        return result

    def thumbnail(self, asset: str, *, timeout_s: float = 60.0) -> bytes:
        """Give a picture of an object of the catalogue: PNG, 160 by 120 pixels.

        Drawn at the first request by a process beside the simulator, which goes on meanwhile, and
        kept in the user's cache for the next time.

        Parameters
        ----------
        asset : str
            Catalogue or display name.

        Raises
        ------
        UnknownName
            If there is no such asset.
        RenderError, DeadlineExceeded
            If it cannot be drawn.
        """
        result: bytes = self._ask("thumbnail", timeout_s, asset)
        return result
