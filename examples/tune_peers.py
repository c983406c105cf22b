#!/usr/bin/env python3
"""Tunes a peer by random search on training fields; interrupt it and run it again to resume.

    python examples/tune_peers.py dwa --settings 20 --fields 24 --out out/tune-dwa.jsonl

The fields are scatter fields of 25 to 100 obstacles, a corridor of pillars, rectangles and two
traps, with the seeds of sweep 7 from run 1000 on: no study of the package uses these. Of the
settings those are best that hit nothing, then reach most goals, then are fastest; a run that fails
counts as one that took all the time.
"""

from __future__ import annotations

import argparse
import json
import random
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import fmean
from typing import Any

from fuzzyq_bullet import run
from fuzzyq_bullet.planning import settings_for
from fuzzyq_bullet.scenario import Limits
from fuzzyq_bullet.studies.episodes import Environment, Job

SWEEP, FIRST = 7, 1000
KINDS = [
    *(("scatter", count) for count in (25, 50, 75, 100)),
    ("cellular", None),
    ("rectangles", 15),
    ("u-shape", None),
    ("semicircle", None),
]
SPACES: dict[str, dict[str, list[Any]]] = {
    "dwa": {
        "heading": [0.5, 1.0, 2.0],
        "clearance": [0.2, 0.5, 1.0],
        "velocity": [0.2, 0.5, 1.0],
        "horizon": [0.25, 0.5, 1.0],
        "margin": [0.0, 0.02, 0.05],
    },
    "vfh": {
        "safety": [0.0, 0.02, 0.05, 0.1],
        "high": [4.0, 8.0, 16.0],
        "low": [1.0, 2.0, 4.0],
        "steepness": [2.0, 4.0, 10.0],
        "wide": [8, 12, 16],
        "dense": [10.0, 20.0, 40.0],
    },
    "apf": {
        "repulsion": [0.005, 0.01, 0.02, 0.05],
        "influence": [0.2, 0.3, 0.4, 0.6],
        "patience": [2.0, 3.0, 5.0],
        "enough": [0.2, 0.3, 0.45],
    },
    "tangent-bug": {"enough": [0.15, 0.2, 0.3, 0.45, 0.6]},
    "navground": {
        "behavior": ["HL", "ORCA", "HRVO"],
        "safety_margin": [0.0, 0.02, 0.05, 0.1],
    },
}


def episode(order: tuple[str, dict[str, Any], int, float]) -> dict[str, Any]:
    """Run one setting in one field, and return what it came to."""
    planner, given, number, time = order
    (layout, count), run_number = KINDS[number % len(KINDS)], FIRST + number // len(KINDS)
    settings = settings_for(planner).model_validate({"name": planner, **given})
    where = Environment.of(layout, count, run_number, SWEEP)
    job = Job(where, planner, settings, "wheels", Limits(time=time))
    record = run(job.scenario())
    ended = float(record.ticks.time[-1])
    return {"settings": given, "field": number, "outcome": record.outcome, "time": ended}


def main() -> None:
    """Search, and print the settings, the best first."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("planner", choices=SPACES)
    parser.add_argument("--settings", type=int, default=20, help="the defaults and drawn ones")
    parser.add_argument(
        "--given", type=json.loads, action="append", help="this setting, as JSON; nothing is drawn"
    )
    parser.add_argument("--fields", type=int, default=24)
    parser.add_argument("--time", type=float, default=120.0, help="longest run (s, simulated)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True, help="file of all episodes, kept")
    told = parser.parse_args()

    rng, space, tried = random.Random(SWEEP), SPACES[told.planner], told.given or [{}]
    for _ in range(0 if told.given else 100 * told.settings):
        drawn = {key: rng.choice(values) for key, values in space.items()}
        if drawn not in tried and len(tried) < told.settings:
            tried.append(drawn)
    told.out.parent.mkdir(parents=True, exist_ok=True)
    lines = told.out.read_text().splitlines() if told.out.exists() else []
    rows = {(json.dumps(row["settings"]), row["field"]): row for row in map(json.loads, lines)}
    orders = [
        (told.planner, one, number, told.time)
        for number in range(told.fields)
        for one in tried
        if (json.dumps(one), number) not in rows
    ]
    with ProcessPoolExecutor(told.jobs) as pool, told.out.open("a") as file:
        for row in pool.map(episode, orders):
            rows[json.dumps(row["settings"]), row["field"]] = row
            print(json.dumps(row), file=file, flush=True)

    table = []
    for one in tried:
        mine = [rows[json.dumps(one), number] for number in range(told.fields)]
        solved = [row["outcome"] == "goal" for row in mine]
        hits = sum(row["outcome"] == "collision" for row in mine)
        times = [row["time"] if row["outcome"] == "goal" else told.time for row in mine]
        table.append((hits, -sum(solved), fmean(times), json.dumps(one)))
    print(f"{len(orders)} episodes run; collisions, goals of {told.fields}, mean time, settings:")
    for hits, missed, mean, one in sorted(table):
        print(f"{hits:3d} {-missed:4d} {mean:7.1f} s  {one}")


if __name__ == "__main__":
    main()
