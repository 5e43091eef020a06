"""A stream without an end as an agent of UNaIVERSE: whoever asks gets a picture and its label.

    pip install unaiverse
    python examples/22_unaiverse.py NODE_NAME     # needs an account; joins the network

Without a name the agent is asked three times here, and nothing is sent.
"""

import sys

from PIL import Image

import sailenv_ros.streams as streams

try:
    from torch.nn import Module
except ImportError:
    Module = object


class SeeingWorld(Module):
    """A module without weights: each call returns the next picture, and the label of one pixel."""

    def __init__(self, course: str = "home", seed: int = 3, begin: int = 0) -> None:
        super().__init__()
        views = ("rgb", "category", "instance")
        self.frames = iter(streams.open(course, seed=seed, views=views)[begin:])

    def forward(self, asked: object = None) -> tuple[Image.Image, str]:
        """Return a picture, and ``ROW COLUMN CATEGORY``; what was asked does not matter."""
        frame = next(self.frames)
        label = frame.labels(1)[0]
        category = frame.frame.info.categories[label.category].name
        return Image.fromarray(frame["rgb"]), f"{label.row} {label.column} {category}"


if len(sys.argv) > 1:
    from unaiverse.agent import Agent
    from unaiverse.networking.node.node import Node
    from unaiverse.streams.dataprops import StreamType

    agent = Agent(
        proc=SeeingWorld(),
        proc_inputs=[StreamType(data_type="all")],
        proc_outputs=[StreamType(data_type="img"), StreamType(data_type="text")],
    )
    Node(node_name=sys.argv[1], hosted=agent, hidden=True, clock_delta=0.2).run()
else:
    world = SeeingWorld()
    for _ in range(3):
        picture, text = world.forward()
        print(f"{picture.width} × {picture.height} pixels; {text}")
