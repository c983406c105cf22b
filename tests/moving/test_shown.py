"""Moving obstacles in film, map, page and exports: at their pose, with their heading."""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet.doctor import examine
from fuzzyq_bullet.episode import run
from fuzzyq_bullet.page.run_data import run_data
from fuzzyq_bullet.recording.metrics import has_way
from fuzzyq_bullet.recording.moving import headings_of, movers_csv, poses_at
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.captions import Story, outcome_lines
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.explanation import reason
from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.movers import DrawnMovers
from fuzzyq_bullet.video.race_map import COLOURS, RaceMap
from fuzzyq_bullet.video.timeline import Timeline, sensed_at
from tests.moving.test_moving import disc, room, stand

CROSSING = disc(3.0, 0.5, "kind: patrol, points: [[3, 0.5], [3, 3.5]], speed: 0.5", radius=0.3)


@pytest.fixture(scope="module")
def crossed() -> Trajectory:
    return stand(room(CROSSING, "shape: cylinder, position: [4, 3], radius: 0.2"), 4.0)


def test_the_map_shows_it_where_it_is(crossed: Trajectory) -> None:
    shown = Map(crossed)
    timeline = Timeline(crossed)
    for time in (1.0, 3.0):
        moment = timeline.at(time)
        region = shown.draw(moment, sensed_at(crossed, 0))
        assert region is not None
        # Beside the arrow on it, which points up.
        x, y = shown.spot([(2.78, 0.5 + 0.5 * time)])[0]
        left, top = region.x - style.MAP.x, region.y - style.MAP.y
        colour = region.image.getpixel((round(x - left), round(y - top)))
        assert np.abs(np.subtract(colour, style.MOVER)).max() < 12


class RaceFilm:
    """The map of a race as a film shows it: what changed is laid over what was there."""

    def __init__(self, *runs: Trajectory) -> None:
        self.map = RaceMap(runs, style.MAP, 1.0)
        self._timelines = [Timeline(run) for run in runs]
        self.image = Image.new("RGB", style.MAP.size)

    def at(self, time: float) -> Image.Image:
        moments = [
            replace(one.at(time), over=time > one.end) for one in self._timelines
        ]  # as a race has them
        for region in self.map.draw(moments):
            self.image.paste(region.image, (region.x - style.MAP.x, region.y - style.MAP.y))
        return self.image

    def shows(self, x: float, y: float, colour: style.Colour) -> bool:
        """Return whether a pixel at a place (m), or beside it, has about a colour."""
        left, top = np.round(self.map.plan.spot([(x, y)])[0] - 1).astype(int).tolist()
        around = np.asarray(self.image.crop((left, top, left + 3, top + 3)), dtype=int)
        return bool((np.abs(around - colour).max(axis=-1) < 25).any())


def test_the_map_of_a_race_shows_it_where_it_is(crossed: Trajectory) -> None:
    film = RaceFilm(crossed, crossed)
    for time in (0.0, 1.0, 3.0, 4.5):
        film.at(time)
        places = [0.5 + 0.5 * k for k in (0.0, 1.0, 3.0, 4.0)]
        here = 0.5 + 0.5 * min(time, 4.0)
        # Beside the arrow on it. Where it was, there is nothing any more.
        assert [y for y in places if film.shows(2.78, y, style.MOVER)] == [here]
        assert film.shows(3.0, here, style.GROUND)  # the arrow


def test_one_that_a_robot_has_stopped_is_there_for_each_run_of_a_race() -> None:
    motion = "kind: patrol, points: [[5, 2], [0.5, 2]], speed: 0.5, stops_for_robot: true"
    scenario = room(disc(5.0, 2.0, motion, radius=0.3))
    stands, drives = stand(scenario, 6.5), stand(scenario, 6.5, step=0.05)
    film = RaceFilm(stands, drives)
    film.at(1.0)
    assert film.shows(4.5, 2.22, style.MOVER)  # the same in both: no rim
    assert not film.shows(4.5 - 0.3, 2.0, COLOURS[0])
    film.at(6.4)
    ends = [float(poses_at(run, 6.4)[0, 0]) for run in (stands, drives)]
    assert ends[1] > ends[0] + 0.2
    assert film.shows(ends[0] - 0.3, 2.0, COLOURS[0])
    assert film.shows(ends[1] + 0.3, 2.0, COLOURS[1])
    drives_on = RaceFilm(stand(scenario, 1.0), drives)
    drives_on.at(6.4)  # the first is over, and its obstacle with it
    assert drives_on.shows(ends[1], 2.22, style.MOVER)
    assert not drives_on.shows(4.5, 2.22, style.MOVER)


def test_its_arrow_points_where_it_goes(crossed: Trajectory) -> None:
    [drawn] = DrawnMovers(crossed, lambda _: 24).at(2.0, 40)
    assert drawn.nose is not None
    tip, *others = drawn.nose[:, 1].tolist()
    assert tip > max(others)
    assert drawn.outline.mean(axis=0) == pytest.approx((3.0, 1.5), abs=1e-3)
    assert poses_at(crossed, 2.025)[0] == pytest.approx((3.0, 1.5125, 0.0))


def test_a_halted_one_keeps_its_heading() -> None:
    motion = "kind: patrol, points: [[2.5, 2], [0.5, 2]], speed: 0.5, stops_for_robot: true"
    record = stand(room(disc(2.5, 2.0, motion)), 4.0)
    assert headings_of(record)[[0, -1], 0] == pytest.approx([math.pi, math.pi])
    turning = "kind: circle, centre: [4.0, 2.5], speed: 0.01"
    assert np.isfinite(headings_of(stand(room(disc(4.0, 3.0, turning)), 0.5))).all()


def test_the_sentence_says_what_comes() -> None:
    # The planner of `stand` decides on no step; one comes along the detection lines' range.
    left = disc(1.0, 3.5, "kind: patrol, points: [[1, 3.5], [1, 2.6]], speed: 0.3")
    record = stand(room(left), 4.0)
    told = [reason(record, k) for k in range(len(record.decisions.tick))]
    assert "A moving obstacle comes from the left: waits" in told
    assert not told[0].startswith("A moving obstacle")  # too far away to be seen
    assert not told[-1].startswith("A moving obstacle")  # it goes back


@pytest.mark.parametrize(
    ("step", "words", "fault"), [(0.0, "Was hit by", "not at fault"), (0.4, "Ran into", "at fault")]
)
def test_the_end_says_what_moved_where_and_how_fast(step: float, words: str, fault: str) -> None:
    there = disc(3.5, 2.0, "kind: patrol, points: [[3.5, 2], [0.5, 2]], speed: 0.5")
    record = stand(room(there), 8.0, step=step)
    x = record.movers[-1, 0, 0]
    assert x < 3.0
    what = f"the moving cylinder at ({x:.1f}, 2.0)"
    assert Story(record).sentence(0, over=True) == f"{words} {what}"
    title, figures = outcome_lines(record)
    assert title == f"COLLISION with {what}"
    assert re.search(rf"it moved at 0\.50 m/s, the robot at 0\.\d\d m/s: {fault}$", figures)


def test_that_it_gives_way_is_shown_at_once(crossed: Trajectory) -> None:
    decisions = crossed.decisions
    target = decisions.target.copy()
    target[23:] = 4.0, 4.0  # a temporary goal
    heading = decisions.heading.copy()
    heading[25:] += 2.0  # and then one on the other side
    heading[27:] += 1.0  # a little farther that way
    record = replace(crossed, decisions=replace(decisions, target=target, heading=heading))
    time = record.ticks.time[decisions.tick].tolist()
    timeline, hold = Timeline(record), DecisionHold(record)
    assert hold.at(timeline.at(time[23] - 0.01)) < 23
    assert [hold.at(timeline.at(time[k])) for k in (23, 24, 25, 26, 27)] == [23, 23, 25, 25, 25]


def test_csv_has_a_row_for_each_tick(crossed: Trajectory) -> None:
    rows = list(csv.DictReader(io.StringIO(movers_csv(crossed))))
    assert len(rows) == len(crossed.ticks.time)
    assert float(rows[20]["position_y"]) == pytest.approx(1.0)
    assert float(rows[20]["heading"]) == pytest.approx(math.pi / 2)
    assert rows[20]["obstacle"] == "0"


def test_the_page_has_its_way_and_does_not_draw_it_as_standing(crossed: Trajectory) -> None:
    told = run_data(crossed)
    assert len(told["field"]["obstacles"]) == 1
    [mover] = told["movers"]
    assert mover["corners"] == [[0, 0]]
    assert mover["y"][20] == pytest.approx(1.0)


def test_mcap_moves_its_frame(crossed: Trajectory) -> None:
    pytest.importorskip("foxglove")
    from fuzzyq_bullet.export.mcap import mcap_of

    told = mcap_of(crossed)
    assert b"/movers" in told


def test_ways_and_doctor_reckon_with_what_stands() -> None:
    # A door across the whole room, that opens.
    door = (
        "shape: box, position: [3.0, 2.0], size: [0.2, 3.9], "
        "motion: {kind: patrol, points: [[3, 2], [3, 2.01]], speed: 0.01}"
    )
    assert has_way(room(door))
    assert [one for one in examine(room(door)) if one.wrong] == []


def test_a_scenario_whose_obstacles_move_can_be_filmed_and_run_again() -> None:
    record = run(room(CROSSING.replace("0.5}", "0.5, stops_for_robot: true}")))
    assert record.outcome in ("goal", "collision")
    assert record == run(record.scenario)
