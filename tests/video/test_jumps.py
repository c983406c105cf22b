"""Films of the point robot, which jumps: it stands where it decided, at the end of its path."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from fuzzyq_bullet import episode, with_options
from fuzzyq_bullet.scenario import load_scenario
from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.movers import DrawnMovers
from fuzzyq_bullet.video.race_map import RaceMap
from fuzzyq_bullet.video.record import frame
from fuzzyq_bullet.video.style import MAP, PATH
from fuzzyq_bullet.video.timeline import Timeline, sensed_at
from tests.moving.test_moving import disc, room, stand

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

STEP = 2.0 / 3.0
"""Time of a step (s)."""
BETWEEN = (0.0, 0.01, 0.3, 0.66)
"""Times since a tick (s), before the next."""


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return episode.run(with_options(load_scenario("boxes"), drive="kinematic"))


def test_between_two_ticks_it_stands_where_its_lines_begin(run: Trajectory) -> None:
    timeline, decisions = Timeline(run), run.decisions
    for decision, tick in enumerate(decisions.tick.tolist()):
        for since in BETWEEN:
            moment = timeline.at(tick * STEP + since)
            assert (moment.tick, moment.decision) == (tick, decision)
            assert moment.position == tuple(run.ticks.position[tick].tolist())
            assert moment.heading == run.ticks.heading[tick]
            sensed = sensed_at(run, moment.decision)
            assert sensed is not None
            assert sensed.origin == moment.position
    assert timeline.at(99.0).position == tuple(run.ticks.position[-1].tolist())


def test_on_the_map_its_path_leads_up_to_it(run: Trajectory) -> None:
    """Up to its rim, along the step that led there."""
    shown, timeline = Map(run), Timeline(run)
    jumps = np.hypot(*np.diff(run.ticks.position, axis=0).T)
    tick = 1 + int(jumps.argmax())  # far from the marks of ways out
    moment = timeline.at(tick * STEP + 0.5)
    region = shown.draw(moment, None)
    assert region is not None
    before, here = run.ticks.position[[tick - 1, tick]]
    length = float(jumps[tick - 1])
    for part in np.linspace(0.3, 1.0 - 0.25 / length, 5):
        x, y = shown.spot([before + part * (here - before)])[0]
        at = round(x - region.x + MAP.x), round(y - region.y + MAP.y)
        near = [
            region.image.getpixel((at[0] + dx, at[1] + dy))
            for dx in (-1, 0, 1)
            for dy in (-1, 0, 1)
        ]
        assert min(np.abs(np.subtract(one, PATH)).max() for one in near) < 60


@pytest.mark.slow
@pytest.mark.parametrize("view", ["scene", "map"])
def test_nothing_but_the_clock_moves_until_it_jumps(run: Trajectory, view: str) -> None:
    stands, still, jumped = (
        frame(run, 6 * STEP + since, view=view)[40:].astype(int) for since in (0.0, 0.6, 0.7)
    )
    assert (stands == still).all()
    assert np.abs(jumped - still).max() > 100


def test_in_a_race_each_disc_stays_at_the_end_of_its_path(run: Trajectory) -> None:
    shown, timeline = RaceMap([run, run], MAP, 1.0), Timeline(run)
    list(shown.draw([timeline.at(6 * STEP)] * 2))
    assert list(shown.draw([timeline.at(6 * STEP + 0.5)] * 2)) == []
    assert list(shown.draw([timeline.at(7 * STEP)] * 2)) != []


@pytest.mark.parametrize("drive", ["kinematic", "wheels"])
def test_moving_obstacles_stand_as_long_as_it_does(drive: str) -> None:
    patrol = disc(3.0, 0.5, "kind: patrol, points: [[3, 0.5], [3, 3.5]], speed: 0.5", radius=0.3)
    run = stand(room(patrol), 4.0)
    run = replace(run, scenario=run.scenario.model_copy(update={"drive": drive}))
    now, later = run.ticks.time[[3, 4]].tolist()
    movers = DrawnMovers(run, lambda _: 12)
    places = [movers.at(time, 3)[0].outline for time in (now, (now + later) / 2)]
    assert np.array_equal(*places) == (drive == "kinematic")
