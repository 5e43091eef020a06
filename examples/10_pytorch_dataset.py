"""Frames as a PyTorch IterableDataset: each worker process has its own camera.

An Agent works in the process that made it alone, so each worker makes its own.
Without PyTorch the same data set is iterated in this process.
"""

from collections.abc import Iterator

import numpy as np

from sailenv_ros import Agent

try:
    from torch.utils.data import DataLoader, IterableDataset, get_worker_info
except ImportError:
    DataLoader, IterableDataset = None, object

    def get_worker_info() -> None:
        """Start as no worker."""


LOCKSTEP = {"scene": "optical", "mode": "lockstep"}


class FrameDataset(IterableDataset):
    """Pictures (3, H, W) float32 with category ids (H, W) int64, from random places."""

    def __init__(self, frames: int, namespace: str) -> None:
        super().__init__()
        self.frames = frames
        self.namespace = namespace

    def __iter__(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield this worker's share of the frames."""
        worker = get_worker_info()
        number, workers = (0, 1) if worker is None else (worker.id, worker.num_workers)
        rng = np.random.default_rng(number)
        with Agent(width=160, height=120, following=False, namespace=self.namespace) as agent:
            for _ in range(number, self.frames, workers):
                agent.set_position((*rng.uniform(-4.0, 4.0, 2), 1.5), teleport=True)
                agent.set_rotation((0.0, 0.0, rng.uniform(-180.0, 180.0)), teleport=True)
                frame = agent.get_frame()
                picture = frame["main"][..., ::-1].transpose(2, 0, 1).astype(np.float32) / 255.0
                yield picture, frame["category"].astype(np.int64)


# One simulator for all workers, which join it; it ends with this Agent.
with Agent(width=16, height=16, namespace="/example", simulator=LOCKSTEP):
    dataset = FrameDataset(frames=12, namespace="/example")
    if DataLoader is None:
        print("PyTorch is not installed; frame by frame, in this process:")
        batches = ((picture[None], category[None]) for picture, category in dataset)
    else:
        batches = DataLoader(dataset, batch_size=4, num_workers=2)
    seen = 0
    for pictures, categories in batches:
        seen += len(pictures)
        print(tuple(pictures.shape), tuple(categories.shape), f"{float(pictures.mean()):.3f}")
    print("frames:", seen)
