"""Times `scripts/run` in a fresh clone with empty caches, up to a frame that a client received.

    .venv/bin/python benchmarks/first_start.py             # until the first annotated frame
    .venv/bin/python benchmarks/first_start.py --ros       # and until ROS 2 has joined

The client is a page of the web viewer, as far as its protocol goes: it asks for picture, depth,
category, instance and flow of the debug agent, and takes the first frame that has them all. Lines
of `scripts/run` are printed as they come, with the time since its start [s]. `--revision` takes
another state of the repository, so that two of them can be timed in turn.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import signal
import struct
import subprocess
import tempfile
import threading
import time
from pathlib import Path

import aiohttp

ROOT = Path(__file__).resolve().parents[1]
VIEWS = ["rgb", "depth", "category", "instance", "flow"]
ROS_JOINED = "to see:"
DEADLINE_S = 3600.0


async def first_frame(port: int, running: subprocess.Popen[str]) -> dict[str, object]:
    """Return the header of the first frame that a page receives with all five views."""
    url = f"http://127.0.0.1:{port}"
    async with aiohttp.ClientSession() as session:
        while running.poll() is None:
            with contextlib.suppress(aiohttp.ClientError, OSError):
                async with session.ws_connect(f"{url}/socket", origin=url) as socket:
                    watch = {"do": "watch", "id": 1, "agent": "debug_agent", "views": VIEWS}
                    await socket.send_json(watch)
                    async for message in socket:
                        if message.type is aiohttp.WSMsgType.BINARY:
                            (size,) = struct.unpack_from("<I", message.data)
                            head: dict[str, object] = json.loads(message.data[4 : 4 + size])
                            if head["type"] == "frame":
                                return head
            await asyncio.sleep(0.05)
    raise SystemExit(f"scripts/run ended with status {running.returncode}")


def main() -> None:
    """Clone, run, wait, report, end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--revision", default="HEAD", help="of this repository")
    parser.add_argument("--ros", action="store_true", help="wait until ROS 2 has joined, too")
    parser.add_argument("--port", type=int, default=8190, help="of the web viewer")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="sailenv-first-") as name:
        folder = Path(name)
        clone = folder / "clone"
        subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
        subprocess.run(["git", "-C", clone, "checkout", "--quiet", args.revision], check=True)
        # Those of the environment that this program runs in.
        of_this = ("PYTHONPATH", "LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
        environment = {
            **{key: value for key, value in os.environ.items() if key not in of_this},
            "SAILENV_CACHE": str(folder / "cache"),
            "PYTHONUNBUFFERED": "1",
            "PIP_CACHE_DIR": str(folder / "pip"),
            "UV_CACHE_DIR": str(folder / "uv"),
        }
        ports = ["-p", f"viewer.port:={args.port}", "-p", "gateway.port:=0"]
        started = time.monotonic()
        running = subprocess.Popen(
            [clone / "scripts" / "run", "--ros-args", *ports],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        joined = threading.Event()

        def follow() -> None:
            assert running.stdout is not None
            for line in running.stdout:
                print(f"{time.monotonic() - started:7.1f}  {line.rstrip()}", flush=True)
                if ROS_JOINED in line and "rqt_image_view" in line:
                    joined.set()

        threading.Thread(target=follow, daemon=True).start()
        try:
            head = asyncio.run(asyncio.wait_for(first_frame(args.port, running), DEADLINE_S))
            print(f"{time.monotonic() - started:7.1f}  FIRST FRAME, with {head['views']}")
            if args.ros:
                joined.wait(DEADLINE_S)
                print(f"{time.monotonic() - started:7.1f}  ROS 2 HAS JOINED")
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(running.pid, signal.SIGTERM)
            running.wait(60.0)


if __name__ == "__main__":
    main()
