"""A data set by recipe: made in this process, read in batches by two workers of PyTorch.

Without PyTorch its frames are read one after another.
"""

import tempfile
from pathlib import Path

from sailenv_ros import dataset

try:
    from torch.utils.data import DataLoader
except ImportError:
    DataLoader = None

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


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        recipe = Path(folder) / "cubes.yaml"
        recipe.write_text(RECIPE)
        made = dataset.make(recipe, Path(folder) / "cubes")
        print(f"{made.frames} frames, SHA-256 {made.sha256[:12]}")
        form = "numpy" if DataLoader is None else "torch"
        with dataset.open(Path(folder) / "cubes", "train", format=form) as train:
            if DataLoader is None:
                print("PyTorch is not installed; frame by frame, in this process:")
                batches = (
                    {
                        name: value[None]
                        for name, value in one.items()
                        if name in ("rgb", "category")
                    }
                    for one in train
                )
            else:
                batches = DataLoader(train, batch_size=4, num_workers=2)
            seen = 0
            for batch in batches:
                pictures, labels = batch["rgb"] / 255.0, batch["category"]
                seen += len(pictures)
                print(tuple(pictures.shape), tuple(labels.shape), f"{float(pictures.mean()):.3f}")
            print("frames:", seen)
