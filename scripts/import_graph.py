#!/usr/bin/env python3
"""Counts rooms, arrows between them, long modules and circles of imports.

    scripts/import_graph.py [ROOT]           prints the figures
    scripts/import_graph.py --check [ROOT]   prints what is beyond the limits alone

Returns 1 if modules import in a circle, or a limit below is passed.

Every import counts: at the top, inside functions, and under TYPE_CHECKING. A room is a package or
a module at the top of `sailenv_ros`; each of the other packages is one room.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

CORE = "sailenv_ros"
PACKAGES = (CORE, "sailenv_msgs_py", "sailenv_content", "sailenv_bench")
MAX_LINES = 350
MAX_ROOMS = 30
MAX_ARROWS = 210

Graph = Mapping[str, set[str]]


def modules_of(root: Path) -> dict[str, Path]:
    """Return the files of all modules below a repository's root, by their dotted names."""
    found = {}
    for package in PACKAGES:
        for file in sorted((root / package).rglob("*.py")):
            parts = file.relative_to(root).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def imported_names(tree: ast.AST, package: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield what is imported anywhere in a module: whence, and which names (none: all of it)."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, ()) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            source = node.module or ""
            if node.level:
                base = package.split(".")
                base = base[: len(base) - node.level + 1]
                source = ".".join([*base, source] if source else base)
            yield source, tuple(alias.name for alias in node.names)


def imports_of(modules: Mapping[str, Path]) -> dict[str, set[str]]:
    """Return which of the modules each module imports; not itself, and not its parents by it."""
    graph: dict[str, set[str]] = {}
    for name, file in modules.items():
        tree = ast.parse(file.read_text(encoding="utf-8"), str(file))
        package = name if file.name == "__init__.py" else name.rpartition(".")[0]
        targets: set[str] = set()
        for source, names in imported_names(tree, package):
            inner = {f"{source}.{one}" for one in names} & modules.keys()
            targets |= inner
            if source in modules and len(inner) < max(1, len(names)):
                targets.add(source)
        graph[name] = targets - {name}
    return graph


def room_of(module: str) -> str:
    """Return the room of a module."""
    package, _, inner = module.partition(".")
    return inner.partition(".")[0] or package if package == CORE else package


def rooms_graph(graph: Graph) -> dict[str, set[str]]:
    """Return which other rooms each room imports; the package's own front is none."""
    rooms: dict[str, set[str]] = {}
    for module, targets in graph.items():
        if module == CORE:
            continue
        room = rooms.setdefault(room_of(module), set())
        room |= {room_of(target) for target in targets if target != CORE}
    return {room: targets - {room} for room, targets in rooms.items()}


def circles(graph: Graph) -> list[list[str]]:
    """Return the strongly connected components of more than one node, the largest first.

    Tarjan, "Depth-first search and linear graph algorithms", SIAM J. Comput. 1 (1972).
    """
    index: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []
    for root in graph:
        if root in index:
            continue
        walk: list[tuple[str, Iterator[str]]] = []

        def enter(node: str, walk: list[tuple[str, Iterator[str]]] = walk) -> None:
            index[node] = lowest[node] = len(index)
            stack.append(node)
            walk.append((node, iter(sorted(graph.get(node, ())))))

        enter(root)
        while walk:
            node, targets = walk[-1]
            target = next(targets, None)
            if target is not None:
                if target not in index:
                    enter(target)
                elif target in stack:
                    lowest[node] = min(lowest[node], index[target])
                continue
            walk.pop()
            if walk:
                lowest[walk[-1][0]] = min(lowest[walk[-1][0]], lowest[node])
            if lowest[node] == index[node]:
                cut = stack.index(node)
                found.append(sorted(stack[cut:]))
                del stack[cut:]
    return sorted((circle for circle in found if len(circle) > 1), key=lambda c: (-len(c), c))


def arrows(graph: Graph) -> int:
    """Return the number of arrows of a graph."""
    return sum(len(targets) for targets in graph.values())


def within(graph: Graph, circle: Iterable[str]) -> list[str]:
    """Return the arrows inside a circle, in words."""
    members = set(circle)
    return [f"{one} -> {two}" for one in sorted(members) for two in sorted(graph[one] & members)]


def main() -> int:
    """Print the figures; return 1 if there is a circle, or a limit is passed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parents[1])
    parser.add_argument(
        "--check", action="store_true", help="print what is beyond the limits alone"
    )
    options = parser.parse_args()
    modules = modules_of(options.root)
    graph = imports_of(modules)
    rooms = rooms_graph(graph)
    found = circles(graph)
    between = circles(rooms)
    lengths = {
        name: len(file.read_text(encoding="utf-8").splitlines()) for name, file in modules.items()
    }
    long = {name: count for name, count in lengths.items() if count > MAX_LINES}
    passed = len(rooms) > MAX_ROOMS or arrows(rooms) > MAX_ARROWS
    if passed or not options.check:
        core = sum(count for name, count in lengths.items() if name.partition(".")[0] == CORE)
        print(f"modules: {len(modules)}, lines: {sum(lengths.values())}, of {CORE}: {core}")
        print(f"rooms: {len(rooms)} (at most {MAX_ROOMS})")
        print(f"arrows between rooms: {arrows(rooms)} (at most {MAX_ARROWS})")
    if long or not options.check:
        print(f"modules of more than {MAX_LINES} lines: {len(long)}")
    for name, count in sorted(long.items(), key=lambda item: -item[1]):
        print(f"  {count:4d} {name}")
    if between or not options.check:
        print(f"circles between rooms: {len(between)}")
    for circle in between:
        print(f"  {len(circle)} rooms: {', '.join(circle)}")
    if found or not options.check:
        print(f"circles between modules: {len(found)}")
    for circle in found:
        print(f"  {len(circle)} modules:", *within(graph, circle), sep="\n    ")
    return 1 if found or long or passed else 0


if __name__ == "__main__":
    sys.exit(main())
