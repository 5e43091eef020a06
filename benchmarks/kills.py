"""Kill works by SIGKILL at random moments; say what they left and whether the next run repairs it.

    python benchmarks/kills.py [WORK ...] [--trials N] [--seed N]

The works are in `tests/support/kill_trials.py`: a stream, a data set by two workers, the light of a
room, three pieces of furniture; and a SAILenv client at a gateway. A kill is at a random moment of
each N-th part of the time that an undisturbed run takes. After it whatever has a final name must be
whole and as an undisturbed run makes it; processes and sockets must be gone; the next run must end
with the same bytes and leave nothing beside them. A killed client's place must be free again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from sailenv_ros import Simulation
from sailenv_ros.gateway import GatewayServer
from tests.support.kill_trials import (
    WORKS,
    Digests,
    Work,
    WorkProcess,
    files_whole,
    prepared,
    run_to_its_end,
)
from tests.support.killed_client import ClientProcess
from tests.support.waiting import until

CLIENT = "client"
CLIENT_FRAMES = 100
PLACE_S = 10.0
"""Time within which a killed client's place is free again [s]."""


def main() -> int:
    """Try; 0 if nothing broke."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("works", nargs="*", metavar="WORK", default=[*WORKS, CLIENT])
    parser.add_argument("--trials", type=int, default=20, metavar="N")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    options = parser.parse_args()
    faults = 0
    for name in options.works:
        random = np.random.default_rng([options.seed, *name.encode()])
        if name == CLIENT:
            faults += _client_trials(options.trials, random)
        else:
            faults += _trials(name, WORKS[name], options.trials, random)
    return int(faults > 0)


def _trials(name: str, work: Work, trials: int, random: np.random.Generator) -> int:
    with tempfile.TemporaryDirectory(prefix="sailenv-kills-") as place:
        began = time.monotonic()
        wanted = run_to_its_end(work, prepared(work, Path(place) / "undisturbed"))
        duration_s = time.monotonic() - began
        print(f"{name}: {len(wanted)} files in {duration_s:.1f} s undisturbed", flush=True)
        faults = late = 0
        for number, moment_s in enumerate(_moments(trials, duration_s, random)):
            folder = prepared(work, Path(place) / str(number))
            found: list[str] = []
            try:
                whole = _killed(work, folder, moment_s, found)
                late += whole is None
                _compare(whole or {}, wanted, found, "after the kill")
                made = run_to_its_end(work, folder)
                _compare(made, wanted, found, "after the next run")
                found += [f"{path} is missing" for path in wanted.keys() - made.keys()]
            except (AssertionError, ValueError, OSError) as problem:
                found.append(str(problem))
            faults += bool(found)
            kept = "ended before" if whole is None else f"{len(whole)} files whole"
            print(f"  {moment_s:6.2f} s: {kept}; {'; '.join(found) or 'right'}", flush=True)
    print(f"{name}: {faults} of {trials} wrong, {late} ended before they were killed", flush=True)
    return faults


def _moments(trials: int, duration_s: float, random: np.random.Generator) -> Iterator[float]:
    for number in range(trials):
        yield duration_s * (number + random.random()) / trials


def _killed(work: Work, folder: Path, moment_s: float, found: list[str]) -> Digests | None:
    """Begin a work and kill it; return what is whole, None if it ended before."""
    with WorkProcess(work, folder) as process:
        deadline = time.monotonic() + moment_s
        while time.monotonic() < deadline:
            if process.ended:
                return None
            time.sleep(0.002)
        process.kill()
        found += [f"left: {leak}" for leak in process.lasting()]
        return files_whole(work, folder)


def _compare(made: Digests, wanted: Digests, found: list[str], when: str) -> None:
    found += [
        f"{path} is not as it should be {when}"
        for path, digest in made.items()
        if wanted.get(path) != digest
    ]


def _client_trials(trials: int, random: np.random.Generator) -> int:
    faults = 0
    with (
        Simulation("optical", mode="lockstep") as simulation,
        GatewayServer(simulation, port=0) as gateway,
    ):
        began = time.monotonic()
        wanted = _seen(gateway)
        duration_s = time.monotonic() - began
        slowest_s = 0.0
        agents = len(simulation.info.agents)
        for moment_s in _moments(trials, duration_s, random):
            with ClientProcess(gateway.port, CLIENT_FRAMES) as client:
                time.sleep(moment_s)
                client.kill()
            killed = time.monotonic()
            until(lambda: not gateway.clients, "the peer to be gone", PLACE_S)
            until(lambda: len(simulation.info.agents) == agents, "its place to be free", PLACE_S)
            slowest_s = max(slowest_s, time.monotonic() - killed)
            faults += _seen(gateway) != wanted
    print(
        f"{CLIENT}: {faults} of {trials} wrong; the place was free after {slowest_s:.2f} s at most;"
        f" {duration_s:.1f} s undisturbed"
    )
    return faults


def _seen(gateway: GatewayServer) -> str:
    with ClientProcess(gateway.port, CLIENT_FRAMES) as client:
        return client.digest()


if __name__ == "__main__":
    sys.exit(main())
