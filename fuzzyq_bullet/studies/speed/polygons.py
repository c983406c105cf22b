"""How fast a large map is: read, asked for a way, and driven in, among thousands of polygons."""

from __future__ import annotations

import math
import time
from statistics import median

import numpy as np

from fuzzyq_bullet.episode import Episode, world_of
from fuzzyq_bullet.planning.consult import build_planner
from fuzzyq_bullet.recording.metrics import has_way
from fuzzyq_bullet.scenario import Arena, Goal, Limits, Scenario, Start
from fuzzyq_bullet.scenario.files import dump_scenario, parse_scenario
from fuzzyq_bullet.studies.speed import Row, interleaved

SIDE = 55
"""Polygons on a side of the map: 3024 of them, as the start takes the place of one."""
APART = 1.6
"""Between the middles of neighbours (m)."""
_CORNERS = 8
_RADII = (0.08, 0.3)
SIMULATED = 10.0
"""Simulated time of one timed episode (s), which is too short to reach the goal."""


def polygons(rounds: int, rate: int) -> list[Row]:
    """Return how fast a map of 3024 concave polygons is, with ``rate`` decisions a second."""
    text = dump_scenario(_map(), defaults=False)
    start = time.process_time()
    scenario = parse_scenario(text)
    loading = time.process_time() - start
    start = time.process_time()
    way = has_way(scenario)
    asking = time.process_time() - start
    with world_of(scenario) as world:

        def drive() -> float:
            planner = build_planner(scenario.planner, np.random.default_rng(0))
            episode = Episode(world, scenario, rate=rate)
            while episode.outcome is None:
                observation = episode.observe()
                episode.carry_out(planner.decide(observation), observation)
            return episode.now.time

        simulated = drive()  # the first is slower: much is loaded in it
        [times] = interleaved([drive], rounds)
    among = f"{len(scenario.obstacles)} polygons"
    return [
        Row(
            f"real time factor of one core, {among}, {rate} decisions a second",
            simulated / median(times),
            30.0,
            "at least",
            f"{1e3 * median(times) / simulated:.1f} ms for a simulated second",
        ),
        Row(f"time to load {among} (s)", loading, 5.0, "at most", f"{len(text) / 1e6:.2f} MB"),
        Row(
            f"time to tell whether there is a way among {among} (s)",
            asking,
            10.0,
            "at most",
            "there is one" if way else "there is none",
        ),
    ]


def _map() -> Scenario:
    """Return a map of ragged polygons, one in each cell of a grid."""
    rng = np.random.default_rng(0)
    angles = np.arange(_CORNERS) * math.tau / _CORNERS
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    places = [(x, y) for x in range(SIDE) for y in range(SIDE) if (x, y) != (0, 0)]
    shapes = []
    for place in places:
        ragged = rng.uniform(*_RADII, (_CORNERS, 1)) * circle
        points = (np.add(place, 0.5) * APART + ragged).round(3)
        shapes.append({"shape": "polygon", "points": points.tolist()})
    far = SIDE * APART
    return Scenario.model_validate(
        {
            "name": "speed-polygons",
            "arena": Arena(size=(far, far)),
            "start": Start(position=(APART / 2, APART / 2)),
            "goal": Goal(position=(far - APART, far - APART), radius=0.2),
            "limits": Limits(time=SIMULATED),
            "obstacles": shapes,
        }
    )
