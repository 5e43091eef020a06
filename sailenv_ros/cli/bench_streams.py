"""`sailenv bench streams`: options in, result file, tables and plot out."""

from __future__ import annotations

import argparse
from functools import partial

from sailenv_bench.experiments.machine import provenance
from sailenv_bench.experiments.stream_bench import bench_stream
from sailenv_ros.cli.experiment import command_line, finish, progress_bar
from sailenv_ros.dataset.streams import STREAMS, stream_named
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.extras import need

__all__ = ["streams"]

EXACT = 0.01
"""Greatest difference of the factor of flow from 1."""

QUICK_PAIRS = 8


def streams(args: argparse.Namespace) -> int:
    """Measure each stream; 1 if flow of one is not in true units."""
    if args.pairs < 2:
        raise InvalidRequest("--pairs", args.pairs, "at least 2")
    if not args.no_plots:
        # Now, and not after an hour of measuring.
        need("matplotlib", "a plot (or --no-plots)")
    kinds = [stream_named(name) for name in dict.fromkeys(args.stream or STREAMS)]
    pairs = min(args.pairs, QUICK_PAIRS) if args.quick else args.pairs
    origin = provenance(command_line())
    with progress_bar(len(kinds) * pairs) as tell:
        measured = [
            bench_stream(kind, pairs=pairs, seed=args.seed, on_pair=partial(tell, kind.title))
            for kind in kinds
        ]
    finish(args, "streams", origin, {"streams": measured, "seed": args.seed})
    return 0 if all(abs(entry["factor"] - 1.0) <= EXACT for entry in measured) else 1
