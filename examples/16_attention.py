"""A focus of attention that moves over a stream by gravitation, what it sees, and sparse labels.

The focus is a body in the picture that details and motion attract (Zanca, Melacci and Gori,
"Gravitational Laws of Focus of Attention", TPAMI 2020):

    a = G sum_i m_i (y_i - x) / (|y_i - x|^2 + e^2) - friction v

A mass m_i is the gradient of brightness, less where the focus has just been, plus exact motion.
Looks at a lap of the stream `solid`, 400 frames of 256 x 256, and writes what it saw onto a sheet.
With a published trajectory of that stream (lines of row, column, their velocities) it tells the
same of that.

    python examples/16_attention.py [SHEET.png [TRAJECTORY.foa]]
"""

import sys
import time

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros import Simulation
from sailenv_ros.dataset.streams.table import stream_named
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet

FRAMES, CROP_PX, CELL_PX, SUBSTEPS = 400, 64, 8, 20
GRAVITY, SOFTENING_PX, FRICTION = 600.0, 10.0, 0.25  # [px^2 / frame^2], [px], [1 / frame]
DETAIL, MOTION = 0.5, 1.0  # what all masses of a kind weigh together
FORGETTING, INHIBITED_PX = 0.1, 24.0  # of where the focus has been: [1 / frame], [px]
LABELS_EACH, LABELS_APART = 3, 100

Array = NDArray[np.float64]


class Gravitation:
    """The focus of attention; each call is a frame and returns where it is, (row, column) [px]."""

    def __init__(self, height: int, width: int) -> None:
        cells = height // CELL_PX, width // CELL_PX
        rows, columns = (CELL_PX * (np.arange(count) + 0.5) for count in cells)
        self.places = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1)
        self.inhibited = np.zeros(cells)
        self.bounds = np.array([height - 1.0, width - 1.0])
        self.place, self.velocity = 0.5 * self.bounds, np.array([3.0, 2.0])

    def __call__(self, rgb: NDArray[np.uint8], motion_px: Array) -> Array:
        """Move on by one frame, whose motion since the one before is told in pixels."""
        grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY).astype(np.float64)
        detail = self._cells(np.hypot(*np.gradient(grey)))
        away2 = ((self.places - self.place) ** 2).sum(axis=-1)
        recent = np.exp(-0.5 * away2 / INHIBITED_PX**2)
        self.inhibited += FORGETTING * (recent - self.inhibited)
        masses = DETAIL * _shares(detail * (1.0 - self.inhibited))
        masses += MOTION * _shares(self._cells(motion_px))
        for _ in range(SUBSTEPS):
            way = self.places - self.place
            pull = masses / ((way**2).sum(axis=-1) + SOFTENING_PX**2)
            force = GRAVITY * (pull[..., None] * way).sum(axis=(0, 1)) - FRICTION * self.velocity
            self.velocity = self.velocity + force / SUBSTEPS
            place = self.place + self.velocity / SUBSTEPS
            self.place = np.clip(place, 0.0, self.bounds)
            self.velocity[self.place != place] *= -0.5  # it bounces off the borders
        return self.place.copy()

    def _cells(self, values: Array) -> Array:
        size = self.inhibited.shape[::-1]
        return np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_AREA), np.float64)


def _shares(masses: Array) -> Array:
    total = masses.sum()
    return masses / total if total > 0.0 else masses


def crop_at(picture: NDArray[np.uint8], row: int, column: int) -> NDArray[np.uint8]:
    """Return what lies around a place, its edge repeated beyond the picture's."""
    half = CROP_PX // 2
    wide = cv2.copyMakeBorder(picture, half, half, half, half, cv2.BORDER_REPLICATE)
    return np.asarray(wide[row : row + CROP_PX, column : column + CROP_PX], np.uint8)


def told_of(path: Array, moving: NDArray[np.bool_]) -> str:
    """Return how fast a path is, and how often it is on what moves."""
    speeds = np.hypot(*np.diff(path, axis=0).T)
    rows, columns = np.rint(path).astype(int).T
    some = moving.any(axis=(1, 2))
    hit = moving[np.arange(len(path)), rows, columns][some].mean()
    return (
        f"median {np.median(speeds):.1f} px, 90 % below {np.quantile(speeds, 0.9):.0f} px a frame; "
        f"on what moves in {100 * hit:.0f} % of the frames"
    )


if __name__ == "__main__":
    sheet, trajectory = [*sys.argv[1:], *("attention.png", "")[len(sys.argv) - 1 :]]
    stream = stream_named("solid")
    steps = round(240 / stream.rate_hz)
    path, tiles, labels, moving = [], {}, [], []
    given: dict[str, int] = {}
    with Simulation(stream.scene, mode="lockstep") as simulation:
        eye = simulation.info.agents[0]
        focus = Gravitation(eye.intrinsics.height, eye.intrinsics.width)
        names = {one.id: one.name for one in simulation.info.instances}
        spent = 0.0
        for number in range(FRAMES):
            if number:
                simulation.step(steps)
            frame = simulation.capture(("rgb", "instance", "flow"), agent=eye.name)
            began = time.perf_counter()
            motion = np.linalg.norm(np.nan_to_num(frame["flow"]), axis=-1) / stream.rate_hz
            path.append(focus(frame["rgb"], motion.astype(np.float64)))
            spent += time.perf_counter() - began
            moving.append(motion > 0.0)
            row, column = np.rint(path[-1]).astype(int).tolist()
            # A label is one pixel, where the focus meets what moves, now and then.
            name = names.get(int(frame["instance"][row, column]), "")
            late_enough = not labels or number - labels[-1][0] >= LABELS_APART
            if motion[row, column] > 0.0 and late_enough and given.get(name, 0) < LABELS_EACH:
                given[name] = given.get(name, 0) + 1
                labels.append((number, row, column, name))
            if number % 50 == 25:
                picture = frame["rgb"].copy()
                recent = np.rint(np.array(path[-25:])[:, ::-1]).astype(np.int32)
                cv2.polylines(picture, [recent], False, (255, 220, 0), 1, cv2.LINE_AA)
                cv2.circle(picture, (column, row), 5, (255, 60, 0), 2, cv2.LINE_AA)
                tiles[f"{number / stream.rate_hz:.1f} s"] = picture
                crop = np.ascontiguousarray(crop_at(frame["rgb"], row, column))
                tiles[f"fixation {number}"] = cv2.resize(crop, (256, 256))
    seen = np.stack(moving)
    covered = seen[seen.any(axis=(1, 2))].mean()
    print(f"what moves covers {100 * covered:.1f} % of the pixels, in {len(seen)} frames")
    print(f"gravitation: {told_of(np.array(path), seen)}; {1e3 * spent / FRAMES:.1f} ms a frame")
    if trajectory:
        rows = np.loadtxt(trajectory, delimiter=",", max_rows=FRAMES)
        print(f"{trajectory}: {told_of(rows[:, :2], seen[: len(rows)])}")
    for number, row, column, name in labels:
        print(f"label: frame {number}, row {row}, column {column}: {name}")
    save_contact_sheet(sheet, tiles, columns=8)
    print("written:", sheet)
