"""`sailenv scene lens`: a calibration as the keys of a camera in scene files and recipes."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import yaml

from sailenv_ros.scene.calibration_files import load_calibration, load_rig
from sailenv_ros.scene.serialisation import camera_entries, lens_entry

__all__ = ["add_arguments", "show_lens"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="a camera_info YAML, Kalibr's camchain.yaml or COLMAP's cameras.txt",
    )
    parser.add_argument(
        "--camera", metavar="NAME", help="which, of a file with several: cam1, or COLMAP's number"
    )
    parser.add_argument(
        "--rig", action="store_true", help="all cameras of a camchain.yaml, as an agent's rig"
    )
    parser.add_argument(
        "--max-angle",
        type=float,
        default=0.0,
        metavar="DEG",
        help="where the image circle ends, from the axis (default: where the lens does)",
    )


def show_lens(args: argparse.Namespace) -> int:
    """Print the keys, one a line."""
    if args.rig:
        entries = camera_entries(load_rig(args.file, max_angle_deg=args.max_angle))
        print(yaml.safe_dump({"cameras": entries}, sort_keys=False, default_flow_style=None))
        return 0
    lens = load_calibration(args.file, camera=args.camera, max_angle_deg=args.max_angle)
    for key, value in lens_entry(lens).items():
        print(f"{key}: {json.dumps(value)}")
    return 0
