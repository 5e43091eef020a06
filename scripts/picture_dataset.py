"""Picture a data set: the annotations of a COCO file, drawn as pycocotools reads them.

    python scripts/picture_dataset.py FILE

Called by scripts/docs-images.
"""

from __future__ import annotations

import colorsys
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from pycocotools.coco import COCO

from sailenv_ros.dataset.formats import DatasetWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

SCENE, SECONDS = "room_02", 8
LEAST_LABELLED_PX = 900
"""Smaller objects have a mask and no name, which would cover them."""


def main(path: Path) -> None:
    """Write the picture."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name, "dataset")
        eye = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=640, height=480))
        with (
            Simulation(SCENE, mode="lockstep", agent=eye) as simulation,
            DatasetWriter(folder, ["coco"]) as writer,
        ):
            simulation.step(240 * SECONDS)
            writer.add(simulation.capture())
            writer.finish()
        (file,) = folder.rglob("annotations.json")
        coco = COCO(file)
        (image_id,) = coco.getImgIds()
        (picture,) = folder.rglob(Path(coco.loadImgs(image_id)[0]["file_name"]).name)
        with Image.open(picture) as opened:
            annotated(opened.convert("RGB"), coco, image_id).save(path, quality=90)
    print(path)


def annotated(picture: Image.Image, coco: COCO, image_id: int) -> Image.Image:
    """Return the picture beside itself with masks, boxes and names."""
    annotations = sorted(coco.loadAnns(coco.getAnnIds(image_id)), key=lambda a: -a["area"])
    pixels = np.asarray(picture).astype(np.float64)
    colours = [colorsys.hsv_to_rgb(0.618 * n % 1.0, 0.75, 1.0) for n in range(len(annotations))]
    for annotation, colour in zip(annotations, colours, strict=True):
        mask = coco.annToMask(annotation).astype(bool)
        pixels[mask] = 0.45 * pixels[mask] + 0.55 * 255.0 * np.array(colour)
    drawn = Image.fromarray(pixels.astype(np.uint8))
    pen, font = ImageDraw.Draw(drawn), ImageFont.load_default(13)
    for annotation, colour in zip(annotations, colours, strict=True):
        ink = tuple(int(255 * share) for share in colour)
        x, y, width, height = annotation["bbox"]
        pen.rectangle((x, y, x + width, y + height), outline=ink, width=1)
        if annotation["area"] >= LEAST_LABELLED_PX and width < 0.8 * picture.width:
            name = coco.loadCats(annotation["category_id"])[0]["name"]
            box = pen.textbbox((x + 2, y + 1), name, font=font)
            pen.rectangle((box[0] - 2, box[1] - 1, box[2] + 2, box[3] + 1), fill=(20, 20, 24))
            pen.text((x + 2, y + 1), name, fill=ink, font=font)
    sheet = Image.new("RGB", (2 * picture.width + 6, picture.height), (24, 24, 28))
    sheet.paste(picture, (0, 0))
    sheet.paste(drawn, (picture.width + 6, 0))
    return sheet


if __name__ == "__main__":
    main(Path(sys.argv[1]))
