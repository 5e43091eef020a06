"""A model that learns from the stream, frame by frame: from colour and position to category.

Softmax regression by gradient descent in NumPy, on 512 pixels of each frame, each used only once.
Prints the share of correct pixels of a frame before the model has learned from them.
"""

import numpy as np

from sailenv_ros import Agent

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}
FRAMES, PIXELS, RATE = 60, 512, 2.0

rng = np.random.default_rng(0)


def features(frame: dict, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return colour, place, their products and 1 of some pixels."""
    height, width = frame["category"].shape
    colour = frame["main"][rows, columns] / 127.5 - 1.0
    place = np.stack([2.0 * rows / height - 1.0, 2.0 * columns / width - 1.0], axis=-1)
    x = np.concatenate([colour, place], axis=-1)
    return np.concatenate([x, x * x, x[:, :1] * x[:, 1:], np.ones((len(x), 1))], axis=-1)


with Agent(width=160, height=120, namespace="/example", simulator=LOCKSTEP) as agent:
    classes = sorted({instance.category_id for instance in agent.instances.values()} | {0})
    class_of = np.zeros(256, int)
    class_of[classes] = np.arange(len(classes))
    weights, right = None, []
    for number, frame in enumerate(agent.frames(rate_hz=30.0)):
        rows, columns = rng.integers(0, 120, PIXELS), rng.integers(0, 160, PIXELS)
        x, label = features(frame, rows, columns), class_of[frame["category"][rows, columns]]
        if weights is None:
            weights = np.zeros((x.shape[1], len(classes)))
        score = x @ weights
        right.append(float((score.argmax(axis=1) == label).mean()))
        share = np.exp(score - score.max(axis=1, keepdims=True))
        share /= share.sum(axis=1, keepdims=True)
        share[np.arange(PIXELS), label] -= 1.0
        weights -= RATE * x.T @ share / PIXELS
        if number % 10 == 0:
            print(f"t = {frame['stamp_ns'] * 1e-9:.2f} s: {right[-1]:4.0%} right")
        if number + 1 == FRAMES:
            break
        agent.step(8)
    first, last = np.mean(right[:5]), np.mean(right[-5:])
    print(f"the first five frames: {first:.0%}, the last five: {last:.0%}")
