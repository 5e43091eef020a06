"""The process that measures one part: its module in, a JSON file of its measurements out.

    python -m sailenv_bench.suite.part_process NAME MODULE OUTPUT [--quick]

A part has a process of its own, so that what it leaves behind, or its end, concerns no other part.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from sailenv_bench.suite.measurement import plain
from sailenv_bench.suite.parts import CHECKOUT, Part, load_part
from sailenv_ros.errors import SailenvError

__all__ = ["main"]


def main() -> int:
    """Measure and write; 1 and a sentence as the last line where that cannot be done."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name")
    parser.add_argument("module")
    parser.add_argument("output", type=Path)
    parser.add_argument("--quick", action="store_true")
    args = parser.parse_args()
    sys.path[:0] = [str(CHECKOUT), str(CHECKOUT / "benchmarks")]
    part = Part(name=args.name, title=args.name, module=args.module)
    try:
        measurements = [plain(one) for one in load_part(part)(args.quick)]
    except (SailenvError, ImportError) as problem:
        sys.stderr.write(f"{problem}\n")
        return 1
    args.output.write_text(json.dumps(measurements), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
