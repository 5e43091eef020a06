"""The process that pictures assets: what it draws, and what is told when it cannot."""

from __future__ import annotations

import io
import os
import signal

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import RenderError
from sailenv_ros.simulation.models.preview_process import PreviewProcess


def test_the_process_draws_names_and_models() -> None:
    """160 x 120 pixels, something bright before a plain floor; what fails is told in words."""
    process = PreviewProcess("gl", None)
    try:
        by_name = process.thumbnail("sphere")
        assert process.thumbnail(Primitives().load("sphere")) == by_name
        with Image.open(io.BytesIO(by_name)) as image:
            pixels = np.asarray(image.convert("RGB")).astype(int)
        assert pixels.shape == (120, 160, 3)
        assert abs(pixels[60, 80] - pixels[5, 5]).max() > 10
        with pytest.raises(RenderError, match="unicorn"):
            process.thumbnail("unicorn")
        os.kill(process._process.pid, signal.SIGKILL)
        with pytest.raises(RenderError, match="ended with -9"):
            process.thumbnail("cube")
        assert not process.is_alive
    finally:
        process.close()
