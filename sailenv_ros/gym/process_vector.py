"""Vector environments over several processes, which write observations into shared memory.

Environment k is the same whatever process it is in: what comes out does not depend on how many
there are. A process that dies is told in one sentence as soon as it is gone.
"""

from __future__ import annotations

import itertools
import multiprocessing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

import numpy as np
from gymnasium.vector import VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidRequest,
    SailenvError,
    SimulationClosed,
)
from sailenv_ros.gym.room_env import Arrays, Info
from sailenv_ros.gym.shared_vector import (
    COUNT,
    SharedVectorEnv,
    Step,
    empty_batch,
    env_class,
    listed_seeds,
)
from sailenv_ros.system.own_process import OwnProcess

__all__ = ["ProcessVectorEnv", "make_vector"]

START_TIMEOUT_S = 600.0
"""Time limit of an answer: the first may wait for rooms to be made [s]."""

END_TIMEOUT_S = 5.0
"""Time that processes have to end by themselves [s]."""


def make_vector(
    task: str, num_envs: int = 1, *, processes: int = 1, **settings: Any
) -> SharedVectorEnv | ProcessVectorEnv:
    """Return a vector environment in this process, or over several; see both classes."""
    count = COUNT.integer("num_envs", num_envs)
    if COUNT.integer("processes", processes) > count:
        raise InvalidRequest("processes", processes, f"at most as many as environments, {count}")
    if processes == 1:
        return SharedVectorEnv(task, num_envs, **settings)
    return ProcessVectorEnv(task, num_envs, processes=processes, **settings)


@dataclass(frozen=True, slots=True)
class _Worker:
    """A process and its environments."""

    process: SpawnProcess
    pipe: Connection
    rows: slice


class ProcessVectorEnv(VectorEnv[Arrays, Any, Any]):
    """Environments over several processes.

    Parameters
    ----------
    task, num_envs, max_episode_steps, copy
        As of `SharedVectorEnv`.
    processes : int
        At most as many as environments.
    **settings
        Of each environment.
    """

    metadata = SharedVectorEnv.metadata

    def __init__(
        self,
        task: str,
        num_envs: int = 2,
        *,
        processes: int = 2,
        max_episode_steps: int | None = None,
        copy: bool = True,
        **settings: Any,
    ) -> None:
        self.num_envs = COUNT.integer("num_envs", num_envs)
        model = env_class(task)(**settings)  # refuses what cannot be, before anything is started
        self.render_mode = model.render_mode
        self.single_observation_space = model.observation_space
        self.single_action_space = model.action_space
        model.close()
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._copies = copy
        self._own = OwnProcess(type(self).__name__)
        self._workers: list[_Worker] = []
        context = multiprocessing.get_context("spawn")
        shapes = empty_batch(self.observation_space)
        memory = {name: context.RawArray("B", max(1, one.nbytes)) for name, one in shapes.items()}
        self._batch = _batch_in(memory, shapes)
        kept = {name: (memory[name], one.shape, one.dtype.str) for name, one in shapes.items()}
        ends = np.linspace(0, self.num_envs, processes + 1).astype(int).tolist()
        try:
            for first, last in itertools.pairwise(ends):
                ours, theirs = context.Pipe()
                order = (task, last - first, first, max_episode_steps, settings)
                process = context.Process(target=_serve, args=(theirs, kept, order), daemon=True)
                process.start()
                theirs.close()
                self._workers.append(_Worker(process, ours, slice(first, last)))
            self._answers()
        except BaseException:
            self.close_extras()
            raise

    @property
    def pids(self) -> tuple[int, ...]:
        """Ids of the processes."""
        return tuple(worker.process.pid or 0 for worker in self._workers)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> tuple[Arrays, Info]:
        """Begin an episode in each environment; environment k has the seed ``seed + k``."""
        seeds = listed_seeds(seed, self.num_envs)
        answers = self._ask(lambda rows: ("reset", seeds[rows], options))
        return self._observations(), self._joined([info for (info,) in answers])

    def step(self, actions: Any) -> Step:
        """Carry out one action in each environment; errors as of `SharedVectorEnv.step`."""
        if not self.action_space.contains(actions):
            raise InvalidRequest("actions", actions, f"one of {self.action_space}")
        answers = self._ask(lambda rows: ("step", actions[rows]))
        rewards, terminated, truncated, infos = zip(*answers, strict=True)
        return (
            self._observations(),
            np.concatenate(rewards),
            np.concatenate(terminated),
            np.concatenate(truncated),
            self._joined(infos),
        )

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return the picture of each environment; None without a `render_mode`."""
        if self.render_mode is None:
            return None
        return tuple(picture for (some,) in self._ask(lambda rows: ("render",)) for picture in some)

    def close_extras(self, **kwargs: Any) -> None:
        """End all processes; in a fork nothing is done: they are the parent's."""
        if self._own.is_inherited:
            return
        for worker in self._workers:
            worker.pipe.close()  # which ends its process
        for worker in self._workers:
            worker.process.join(END_TIMEOUT_S)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
            worker.process.close()
        self._workers.clear()

    # -- inside ----------------------------------------------------------------------------

    def _ask(self, request: Any) -> list[tuple[Any, ...]]:
        self._own.require()
        if not self._workers:
            raise SimulationClosed("the environments were closed")
        for number, worker in enumerate(self._workers):
            try:
                worker.pipe.send(request(worker.rows))
            except OSError:
                self._lost(number)
        return self._answers()

    def _answers(self) -> list[tuple[Any, ...]]:
        """Return what each process says; the first error, if there is one, once all have."""
        answers: list[tuple[Any, ...]] = []
        for number, worker in enumerate(self._workers):
            ready = wait([worker.pipe, worker.process.sentinel], START_TIMEOUT_S)
            if not ready:
                raise DeadlineExceeded(f"process {number} of the environments", START_TIMEOUT_S)
            try:
                answers.append(worker.pipe.recv())
            except (EOFError, OSError):
                self._lost(number)
        for answer in answers:
            if answer and isinstance(answer[0], Exception):
                raise answer[0]
        return answers

    def _lost(self, number: int) -> None:
        """Close everything, and say which process is gone."""
        worker = self._workers[number]
        worker.process.join(END_TIMEOUT_S)
        pid, code = worker.process.pid, worker.process.exitcode
        count, rows = len(self._workers), worker.rows
        self.close()
        raise SimulationClosed(
            f"process {pid} (number {number} of {count}, environments {rows.start} to "
            f"{rows.stop - 1}) died with exit code {code}"
        )

    def _observations(self) -> Arrays:
        if not self._copies:
            return self._batch
        return {name: one.copy() for name, one in self._batch.items()}

    def _joined(self, infos: Sequence[Info]) -> Info:
        """Return one `info` of those of several processes."""
        joined: Info = {}
        for worker, info in zip(self._workers, infos, strict=True):
            for name, values in info.items():
                if name not in joined:
                    joined[name] = np.zeros(self.num_envs, values.dtype)
                joined[name][worker.rows] = values
        return joined


def _batch_in(memory: Mapping[str, Any], shapes: Arrays) -> Arrays:
    return {
        name: np.frombuffer(memory[name], one.dtype, one.size).reshape(one.shape)
        for name, one in shapes.items()
    }


def _serve(pipe: Connection, kept: Mapping[str, Any], order: tuple[Any, ...]) -> None:
    """Run the environments of one process until its pipe is closed."""
    task, count, first, most_steps, settings = order
    out = {
        name: np.frombuffer(memory, np.dtype(dtype), int(np.prod(shape))).reshape(shape)[
            first : first + count
        ]
        for name, (memory, shape, dtype) in kept.items()
    }
    try:
        env = SharedVectorEnv(task, count, max_episode_steps=most_steps, out=out, **settings)
    except SailenvError as error:
        pipe.send((error,))
        return
    pipe.send(())
    try:
        while True:
            command, *arguments = pipe.recv()
            try:
                if command == "reset":
                    _, info = env.reset(seed=arguments[0], options=arguments[1])
                    answer: tuple[Any, ...] = (info,)
                elif command == "step":
                    _, *answered = env.step(arguments[0])
                    answer = tuple(answered)
                else:
                    answer = (env.render(),)
            except SailenvError as error:
                answer = (error,)
            pipe.send(answer)
    except (EOFError, OSError, KeyboardInterrupt):
        pass
    finally:
        env.close()
