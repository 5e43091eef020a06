"""Pictures that `compare` has written, each beside its traced twin, on one sheet.

python -m benchmarks.reference.sheet FOLDER -o FILE [--columns N] [--width PX]
"""

from __future__ import annotations

import argparse
from pathlib import Path

from PIL import Image

OURS, REFERENCE = "_ours.png", "_reference.png"
GAP_PX = 6


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="that `compare` wrote")
    parser.add_argument("-o", "--output", type=Path, required=True, help="a picture file")
    parser.add_argument("--columns", type=int, default=4, help="of pairs")
    parser.add_argument("--width", type=int, default=200, help="of each picture [px]")
    arguments = parser.parse_args()
    files = sorted(arguments.folder.glob(f"*{OURS}"))
    width, height = arguments.width, arguments.width * 3 // 4
    across, down = 2 * width + GAP_PX, height + GAP_PX
    rows = -(-len(files) // arguments.columns)
    sheet = Image.new("RGB", (arguments.columns * across - GAP_PX, rows * down - GAP_PX), "white")
    for number, ours in enumerate(files):
        row, column = divmod(number, arguments.columns)
        twin = ours.with_name(ours.name.removesuffix(OURS) + REFERENCE)
        for place, file in enumerate((ours, twin)):
            picture = Image.open(file).convert("RGB")
            picture = picture.resize((width, height), Image.Resampling.LANCZOS)
            sheet.paste(picture, (column * across + place * width, row * down))
    sheet.save(arguments.output, quality=88)


if __name__ == "__main__":
    main()
