"""A data set by recipe, and a PyTorch data set of it: made in this process, read by two workers.

Without PyTorch its frames are read one after another.
"""

import tempfile
from pathlib import Path

import numpy as np

from sailenv_ros.dataset import engine_of, load_job, make_dataset, open_dataset

try:
    from torch.utils.data import DataLoader, Dataset
except ImportError:
    DataLoader, Dataset = None, object

RECIPE = """\
version: 1
seed: 1
scenes: [{scene: optical}]
clips: {train: 12, val: 4}
clip: {gap: 0.2}
cameras: [{type: orbit, object: cube, width: 160, height: 120, distance: [3.5, 6]}]
views: [rgb, category, instance]
formats: [webdataset]
shard: {clips: 8}
"""


class Pictures(Dataset):
    """Pictures (3, H, W) float32 with category ids (H, W) int64."""

    def __init__(self, folder: Path, split: str) -> None:
        # Can be sent to workers: each opens the files anew.
        self.frames = open_dataset(folder, split)

    def __len__(self) -> int:
        return len(self.frames)

    def __getitem__(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        frame = self.frames[number].frame
        picture = frame["rgb"].transpose(2, 0, 1).astype(np.float32) / 255.0
        return picture, frame["category"].astype(np.int64)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        recipe = Path(folder) / "cubes.yaml"
        recipe.write_text(RECIPE)
        made = make_dataset(load_job(recipe), Path(folder) / "cubes", engine_of(1, None))
        print(f"{made.frames} frames, SHA-256 {made.sha256[:12]}")
        train = Pictures(Path(folder) / "cubes", "train")
        if DataLoader is None:
            print("PyTorch is not installed; frame by frame, in this process:")
            batches = ([one[None] for one in train[number]] for number in range(len(train)))
        else:
            batches = DataLoader(
                train, batch_size=4, num_workers=2, multiprocessing_context="spawn"
            )
        seen = 0
        for pictures, labels in batches:
            seen += len(pictures)
            print(tuple(pictures.shape), tuple(labels.shape), f"{float(pictures.mean()):.3f}")
        print("frames:", seen)
        train.frames.close()
