"""Benchmark maps of MovingAI: grids of letters (``.map``) and tasks on them (``.scen``).

Sturtevant (2012), "Benchmarks for grid-based pathfinding"; rows are counted from the top.
"""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_text
from fuzzyq_bullet.reading.untrusted import number
from fuzzyq_bullet.scenario.importers.cells import grid_map
from fuzzyq_bullet.scenario.importers.foreign import (
    ForeignMap,
    ImportOptions,
    beside,
)
from fuzzyq_bullet.scenario.importers.images import cell_size
from fuzzyq_bullet.scenario.importers.registry import register_importer
from fuzzyq_bullet.wording import shorten

Letters: TypeAlias = NDArray[np.uint8]

_MAX_BYTES = 50_000_000
_MOST = 5000
"""Most cells along a side."""
_FREE = "G."
_KINDS = {"S": "swamp", "W": "water", "T": "trees"}
_BLOCKED = "@OTW"
_USUAL_CELL = 1.0
"""Size of a cell (m) unless ``--resolution`` says otherwise."""


@register_importer(".map")
def grid(path: Path, options: ImportOptions) -> ForeignMap:
    """Read a map; its lower left corner is the origin."""
    return _map(path, options, _read(path))


@register_importer(".scen")
def task(path: Path, options: ImportOptions) -> ForeignMap:
    """Read a task of a file of them, and the map that it names, which lies beside it."""
    lines = read_text(path, what="a file of tasks", most=_MAX_BYTES).splitlines()
    if not lines or not lines[0].startswith("version"):
        raise UserError(f"{path}:1: expected 'version 1', got {shorten(lines[0] if lines else '')}")
    rows = [(at, line.split()) for at, line in enumerate(lines[1:], 2) if line.strip()]
    if not 1 <= options.number <= len(rows):
        raise UserError(f"--number: {path} has the tasks 1 to {len(rows)}, not {options.number}")
    at, row = rows[options.number - 1]
    if len(row) != 9:
        raise UserError(
            f"{path}:{at}: expected bucket, map, width, height, start x and y, goal x and y and "
            f"length: 9 values, got {len(row)}"
        )
    name = row[1].replace("\\", "/").rsplit("/", 1)[-1]  # benchmarks name folders of their authors
    source = beside(path.parent, name, f"{path}:{at}: map")
    cells = _read(source)
    height, width = cells.shape
    found = _map(source, options, cells)
    size = _cell(options)
    places = []
    for which, x, y in (("start", *row[4:6]), ("goal", *row[6:8])):
        column = number(x, f"{path}:{at}: {which} x", least=0, most=width - 1)
        line = number(y, f"{path}:{at}: {which} y", least=0, most=height - 1)
        places.append(((int(column) + 0.5) * size, (height - int(line) - 0.5) * size))
    found.start, found.goal = places
    return found


def _cell(options: ImportOptions) -> float:
    given = options.resolution
    return _USUAL_CELL if given is None else cell_size(given, "--resolution")


def _map(path: Path, options: ImportOptions, letters: Letters) -> ForeignMap:
    blocked = np.isin(letters, [ord(letter) for letter in _BLOCKED])
    found = grid_map(path, blocked[::-1], _cell(options), options)
    for letter, kind in _KINDS.items():
        count = int(np.count_nonzero(letters == ord(letter)))
        if count:
            as_what = "blocked" if letter in _BLOCKED else "free"
            found.changed.append(f"{count} cells of {kind} ({letter}): taken as {as_what}")
    if options.resolution is None:
        found.changed.append("cells have no size in the file: 1 m each (--resolution)")
    return found


def _read(path: Path) -> Letters:
    """Return the letters of a map as bytes, the first row at the top.

    Raises:
        UserError: If it is none.
    """
    lines = read_text(path, what="a map", most=_MAX_BYTES).splitlines()
    sizes: dict[str, int] = {}
    for at, line in enumerate(lines[:20], 1):
        words = line.split()
        if words == ["map"]:
            break
        if len(words) == 2 and words[0] in ("height", "width"):
            where = f"{path}:{at}: {words[0]}"
            sizes[words[0]] = int(number(words[1], where, least=1, most=_MOST))
        elif words[:1] != ["type"]:
            raise UserError(
                f"{path}:{at}: expected type, height, width and then map, got {shorten(line)}"
            )
    else:
        raise UserError(f"{path}: is no map: there is no line 'map' at its head")
    lacking = {"height", "width"} - set(sizes)
    if lacking:
        raise UserError(f"{path}:{at}: {' and '.join(sorted(lacking))}: is missing before 'map'")
    height, width = sizes["height"], sizes["width"]
    rows = lines[at : at + height]
    if len(rows) < height:
        raise UserError(f"{path}:{len(lines)}: {len(rows)} rows, but height says {height}")
    known = set(_FREE + _BLOCKED + "S")
    for i, row in enumerate(rows, at + 1):
        if len(row) != width:
            raise UserError(f"{path}:{i}: {len(row)} letters, but width says {width}")
        if unknown := set(row) - known:
            raise UserError(
                f"{path}:{i}: {shorten(min(unknown))} is no cell; allowed: . G S @ O T W"
            )
    return np.frombuffer("".join(rows).encode(), dtype=np.uint8).reshape(height, width)
