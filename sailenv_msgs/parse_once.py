"""Runs a command of the build; interfaces that a generator of ROS parses are kept for the next one.

    python parse_once.py FOLDER COMMAND...

Every generator parses every interface, by a grammar that takes a tenth of a second for each: half
of the time to build the messages. What is parsed is kept in the folder by a hash of its text.
Commands that are no generators run as they are.
"""

import hashlib
import os
import pickle
import runpy
import sys
from pathlib import Path


def keep_parsed(folder: Path) -> None:
    """Have rosidl's parser look into the folder first."""
    from rosidl_parser import parser

    parse = parser.parse_idl_string

    def parse_once(text: str, png_file: str | None = None) -> object:
        digest = hashlib.sha256((parser.grammar + "\0" + text).encode()).hexdigest()
        kept = folder / f"{digest}.pickle"
        try:
            return pickle.loads(kept.read_bytes())
        except (OSError, EOFError, pickle.UnpicklingError):
            content = parse(text, png_file=png_file)
        folder.mkdir(parents=True, exist_ok=True)
        # Generators run side by side: a file appears when it is whole.
        draft = kept.with_suffix(f".{os.getpid()}")
        draft.write_bytes(pickle.dumps(content))
        draft.replace(kept)
        return content

    parser.parse_idl_string = parse_once


def main(folder: str, command: list[str]) -> None:
    """Run a generator in this process, other commands instead of it."""
    program = Path(command[0]).name
    if not (program.startswith("python") and "--generator-arguments-file" in command):
        os.execvp(command[0], command)
    keep_parsed(Path(folder))
    sys.argv = command[1:]
    sys.path[0] = str(Path(command[1]).parent)
    runpy.run_path(command[1], run_name="__main__")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
