"""A new importer: a table of circles, one a line, as ``x,y,radius`` in metres.

    fuzzyq import forest.csv --plugin examples/extend/importer.py
    fuzzyq run forest.yaml

The first and the last circle are start and goal.
"""

from __future__ import annotations

import csv
from pathlib import Path

from fuzzyq_bullet import Scenario
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario.importers import register_importer


@register_importer(".csv")
def circles(path: Path) -> Scenario:
    """Return the scenario of a table of circles."""
    rows = []
    with path.open(newline="", encoding="utf-8") as file:
        for line, row in enumerate(csv.reader(file), 1):
            try:
                x, y, radius = map(float, row)
            except ValueError as error:
                raise UserError(f"{path}:{line}: expected x,y,radius, got {row}") from error
            rows.append((x, y, radius))
    if len(rows) < 2:
        raise UserError(f"{path}: needs at least a start and a goal")
    start, *obstacles, goal = rows
    size = [max(x + radius for x, _, radius in rows), max(y + r for _, y, r in rows)]
    return Scenario.model_validate(
        {
            "name": path.stem,
            "description": f"Imported from {path.name}.",
            "arena": {"size": size},
            "start": {"position": start[:2]},
            "goal": {"position": goal[:2], "radius": goal[2]},
            "obstacles": [
                {"shape": "cylinder", "position": (x, y), "radius": radius}
                for x, y, radius in obstacles
            ],
        }
    )
