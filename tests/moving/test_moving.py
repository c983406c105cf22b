"""Moving obstacles: where they go, that they are seen and touched, and what the record says."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet.episode import Episode, run, world_of
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.movers import Mover
from fuzzyq_bullet.planning import Decision
from fuzzyq_bullet.recording.fault import FAULT_SPEED, robot_speed
from fuzzyq_bullet.recording.metrics import collision_text, result_of
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.scenario.courses import courses_of, fastest, told_top_speed
from fuzzyq_bullet.scenario.expectations import unmet_expectations
from fuzzyq_bullet.scenario.files import dump_scenario, load_scenario, parse_scenario
from fuzzyq_bullet.shapes.motion import seen_from

ROOM = """\
name: moving
arena: {size: [6.0, 4.0]}
start: {position: [1.0, 2.0], heading: 0.0}
goal: {position: [5.5, 2.0]}
"""


def room(*obstacles: str, more: str = "", folder: Path | None = None) -> Scenario:
    lines = "".join(f"  - {{{one}}}\n" for one in obstacles)
    lines = f"obstacles:\n{lines}" if lines else ""
    return parse_scenario(f"{ROOM}{more}{lines}", folder=folder)


def disc(x: float, y: float, motion: str, radius: float = 0.25) -> str:
    return f"shape: cylinder, position: [{x}, {y}], radius: {radius}, motion: {{{motion}}}"


def place(scenario: Scenario, time: float, index: int = 0) -> tuple[float, float]:
    course = courses_of(scenario.obstacles, scenario.arena, scenario.seed)[index]
    (x, y), pose = scenario.obstacles[index].position, course.pose(time)
    return round(x + pose[0], 6), round(y + pose[1], 6)


def stand(scenario: Scenario, seconds: float, *, step: float = 0.0) -> Trajectory:
    """Let a robot decide on steps of one length, ahead, whatever comes."""
    with world_of(scenario) as world:
        episode = Episode(world, scenario, patience=1e9)
        still = Decision(0.0, step, step, mode="routine")
        while episode.outcome is None and episode.now.time < seconds:
            episode.advance(still)
        return episode.record() if episode.outcome else episode.so_far(still)


# Where they go


def test_a_patrol_goes_back_and_forth_and_pauses() -> None:
    course = "kind: patrol, points: [[3, 1], [3, 2], [4, 2]], speed: 0.5, pause: 1.0"
    world = room(disc(3.0, 1.0, course))
    # A second at the first point, two to the next, a second there.
    told = {0.5: (3, 1), 2.0: (3, 1.5), 3.5: (3, 2), 6.5: (4, 2), 8.0: (3.5, 2), 12.5: (3, 1)}
    assert {time: place(world, time) for time in told} == told
    looped = room(disc(3.0, 1.0, course.replace("pause: 1.0", "loop: true")))
    back = 4.0 + math.sqrt(2.0) / 0.5  # two seconds a side, then straight to the first point
    assert place(looped, back) == pytest.approx((3.0, 1.0))
    assert place(looped, back + 1.0) == pytest.approx((3.0, 1.5))


def test_a_patrol_begins_at_its_position() -> None:
    world = room(disc(3.0, 1.5, "kind: patrol, points: [[3, 1], [3, 3]], speed: 0.5"))
    assert [place(world, time) for time in (0.0, 1.0, 2.0)] == [(3, 1.5), (3, 1), (3, 1.5)]


def test_what_goes_round_a_centre_turns_with_it() -> None:
    world = room(
        "shape: box, position: [3.0, 1.0], size: [0.4, 0.1], "
        "motion: {kind: circle, centre: [2.0, 1.0], speed: 0.5}"
    )
    quarter = math.pi / 2 / 0.5
    assert place(world, quarter) == pytest.approx((2.0, 2.0))
    course = courses_of(world.obstacles, world.arena, 0)[0]
    assert course.pose(quarter)[2] == pytest.approx(math.pi / 2)


def test_a_wanderer_bounces_and_depends_on_seed_and_number_alone() -> None:
    both = (disc(3.0, 1.0, "kind: wander, speed: 0.5"), disc(3.0, 3.0, "kind: wander, speed: 0.5"))
    still = "shape: box, position: [2.0, 3.0], size: [0.5, 0.5]"
    world = room(*both, still)
    times = np.arange(0.0, 120.0, 0.1)
    field = Field.of(world.standing, world.arena)
    ways = [np.array([place(world, t, i) for t in times]) for i in (0, 1)]
    for way in ways:
        assert field.clearance(way).min() >= 0.25 - 1e-5
        steps = np.hypot(*np.diff(way, axis=0).T)
        assert steps.max() <= 0.05 + 1e-5  # shorter where it bounces
        assert np.ptp(way, axis=0).min() > 2.0
    # The same however often it is asked, and whatever else moves.
    assert place(world, 90.0) == tuple(ways[0][900])
    alone = room(both[0], "shape: cylinder, position: [5.0, 3.5], radius: 0.1", still)
    assert place(alone, 30.0) == tuple(ways[0][300])
    other = world.model_copy(update={"seed": 1})
    assert place(other, 30.0) != place(world, 30.0)


@pytest.mark.parametrize(
    ("motion", "speed"),
    [
        ("kind: patrol, points: [[3, 1], [3, 2], [4, 2]], speed: 0.5, pause: 1.0", 0.5),
        ("kind: circle, centre: [3.5, 1.0], speed: 0.2", 0.2 * (0.5 + 0.25) / 0.5),
        ("kind: wander, speed: 0.3", 0.3),
        ("kind: trace, poses: [[0, 3, 1, 0], [1, 3, 1.4, 0], [2, 3, 1.5, 0]]", 0.4),
        ("kind: trace, poses: [[0, 3, 1, 0], [1, 3, 1.4, 0.4]]", 0.5),
        ("kind: trace, poses: [[0, 3, 1, 0], [9, 3, 1.04, 0]], repeat: true", 0.8),
    ],
)
def test_the_greatest_speed_is_told_as_it_is_seen(motion: str, speed: float) -> None:
    world = room(disc(3.0, 1.0, motion))
    [shape] = world.obstacles
    course = courses_of(world.obstacles, world.arena, world.seed)[0]
    seen = fastest(course, shape.extent(), world.limits.time)
    assert seen == pytest.approx(speed, rel=0.01)
    told = told_top_speed(shape)
    assert told == pytest.approx(speed)
    with world_of(world) as built:
        assert Episode(built, world).observe().closing_speed == told


def test_what_a_trace_does_late_is_told_too() -> None:
    late = "kind: trace, poses: [[0, 3, 1, 0], [100, 3, 1.1, 0], [101, 3, 1.6, 0]]"
    [shape] = room(disc(3.0, 1.0, late)).obstacles
    assert told_top_speed(shape) == pytest.approx(0.5)


@pytest.mark.parametrize("speed", [0.3, 2.5])
def test_however_fast_a_wanderer_goes_into_nothing(speed: float) -> None:
    # Legs that are shorter than it goes in 0.05 s, in a corridor hardly wider than itself.
    lane = "shape: box, position: [3.0, 1.4], size: [4.0, 0.2]"
    world = room(disc(3.0, 0.65, f"kind: wander, speed: {speed}", radius=0.62), lane)
    course = courses_of(world.obstacles, world.arena, world.seed)[0]
    moved = np.array([course.pose(t)[:2] for t in np.arange(0.0, 120.0, 0.01)])
    way = np.add(moved, (3.0, 0.65))
    assert Field.of(world.standing, world.arena).clearance(way).min() >= 0.62 - 1e-5
    assert np.hypot(*np.diff(way, axis=0).T).max() <= 0.01 * speed + 1e-9
    assert np.ptp(way[:, 0]) > 0.3


def test_a_trace_is_read_from_its_file_and_kept(tmp_path: Path) -> None:
    (tmp_path / "walk.csv").write_text("t,x,y,yaw\n0,3,1,0\n2,3,2,1\n4,4,2,1\n")
    world = room(disc(3.0, 1.0, "kind: trace, file: walk.csv"), folder=tmp_path)
    assert [place(world, t) for t in (0, 1, 3, 9)] == [(3, 1), (3, 1.5), (3.5, 2), (4, 2)]
    assert parse_scenario(dump_scenario(world)) == world  # wherever that is read


def test_a_scenario_that_is_moved_takes_its_motions_along() -> None:
    world = room(
        disc(3.0, 1.0, "kind: patrol, points: [[3, 1], [3, 3]], speed: 0.5"),
        disc(4.0, 3.0, "kind: circle, centre: [4, 2.5], speed: 0.5"),
    )
    there = world.moved(10.0, -5.0)
    for index in (0, 1):
        x, y = place(world, 1.5, index)
        assert place(there, 1.5, index) == pytest.approx((x + 10.0, y - 5.0), abs=1e-4)


# What they do to the robot


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_robot_at_rest_is_touched_and_not_at_fault(drive: str) -> None:
    scenario = room(
        disc(2.5, 2.0, "kind: patrol, points: [[2.5, 2], [0.5, 2]], speed: 0.5"),
        more=f"drive: {drive}\nexpect: {{contact: not-at-fault}}\n",
    )
    record = stand(scenario, 5.0)
    hit, result = record.collision, result_of(record)
    assert hit is not None
    assert hit.obstacle == 0
    # From 1.5 m apart to 0.45 m, the sum of the radii.
    assert hit.time == pytest.approx(1.05 / 0.5, abs=0.05 if drive == "wheels" else 0.7)
    assert result.at_fault is False
    assert "moved at 0.50 m/s, the robot at 0.00 m/s: not at fault" in collision_text(record, 1)
    assert unmet_expectations(scenario.expect, result) == []
    strict = scenario.expect.model_copy(update={"contact": "none"})
    assert unmet_expectations(strict, result) == ["outcome collision, expected goal"]
    assert record.ticks.position[-1] == pytest.approx((1.0, 2.0), abs=0.01)  # not pushed away


@pytest.mark.parametrize(
    ("speed", "words"),
    [(0.05001, "0.05001 m/s: at"), (0.0476, "0.0476 m/s: not at"), (0.061, "0.06 m/s: at")],
)
def test_a_speed_near_the_limit_is_told_exactly(speed: float, words: str) -> None:
    motion = "kind: patrol, points: [[2.5, 2], [0.5, 2]], speed: 0.5"
    record = stand(room(disc(2.5, 2.0, motion)), 5.0)
    speeds = record.ticks.speed.copy()
    speeds[-4] = speed
    record = replace(record, ticks=replace(record.ticks, speed=speeds))
    assert f"the robot at {words} fault" in collision_text(record, 1)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_robot_that_drives_into_one_is_at_fault(drive: str) -> None:
    scenario = room(
        disc(3.0, 2.0, "kind: patrol, points: [[3, 2], [3, 2.1]], speed: 0.05"),
        more=f"drive: {drive}\nexpect: {{contact: not-at-fault}}\n",
    )
    record = stand(scenario, 20.0, step=0.2)
    result = result_of(record)
    assert record.collision is not None
    assert result.at_fault is True
    assert unmet_expectations(scenario.expect, result) == ["outcome collision, expected goal"]
    assert "at_fault" in result.model_dump()
    assert "at_fault" not in result_of(stand(room(), 0.1)).model_dump()


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_robot_that_creeps_into_what_stands_still_is_at_fault(drive: str) -> None:
    scenario = room(
        "shape: cylinder, position: [1.5, 2.0], radius: 0.25",
        more=f"drive: {drive}\nexpect: {{contact: not-at-fault}}\n",
    )
    record = stand(scenario, 20.0, step=0.02)
    result, speed = result_of(record), robot_speed(record)
    assert record.collision is not None
    assert speed is not None
    assert speed < FAULT_SPEED
    assert result.at_fault is True
    assert unmet_expectations(scenario.expect, result) == ["outcome collision, expected goal"]


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_what_stops_for_the_robot_never_touches_one_at_rest(drive: str) -> None:
    motion = "kind: patrol, points: [[2.5, 2], [0.5, 2]], speed: 0.5, stops_for_robot: true"
    record = stand(room(disc(2.5, 2.0, motion), more=f"drive: {drive}\n"), 8.0)
    assert record.collision is None
    way = record.movers[:, 0, 0]
    assert way[-1] == way[-20 if drive == "wheels" else -5]  # it stands, and its clock with it
    assert 0.1 <= record.ticks.clearance[-1] <= 0.7


def test_one_that_stopped_is_touched_where_it_stands() -> None:
    motion = "kind: patrol, points: [[4, 2], [0.5, 2]], speed: 2.0, stops_for_robot: true"
    record = stand(room(disc(4.0, 2.0, motion)), 8.0, step=0.4)
    assert record.collision is not None
    assert record.movers[-1, 0, 0] == record.movers[-5, 0, 0]  # the robot drove into it
    # In a step of 1/240 s the robot goes 2.5 mm: no contact is seen later than that.
    assert record.ticks.clearance[-1] >= -0.005
    assert record.ticks.clearance[:-1].min() > 0.0


def test_one_that_has_passed_goes_on() -> None:
    # It moves away from the robot, however near it is.
    motion = "kind: patrol, points: [[1.5, 2], [5, 2]], speed: 0.5, stops_for_robot: true"
    record = stand(room(disc(1.5, 2.0, motion)), 2.0)
    assert record.movers[-1, 0, 0] == pytest.approx(2.5, abs=0.05)


def test_rays_meet_it_where_it_is() -> None:
    scenario = room(disc(4.0, 2.0, "kind: patrol, points: [[4, 2], [2, 2]], speed: 0.5"))
    with world_of(scenario) as world:
        episode = Episode(world, scenario)
        z = world.model.sensor_height
        told = []
        for _ in range(3):
            told.append(4.0 * world.cast([(1.0, 2.0, z)], [(5.0, 2.0, z)])[0])
            for _ in range(10):
                episode.advance(Decision(0.0, 0.0, 0.0, mode="routine"))
    assert told == pytest.approx([2.75, 2.5, 2.25], abs=0.002)


# What is on record


def test_the_record_tells_where_everything_was(tmp_path: Path) -> None:
    scenario = room(
        disc(3.0, 3.0, "kind: wander, speed: 0.4"),
        "shape: cylinder, position: [3.0, 2.2], radius: 0.1",
        "shape: box, position: [4.0, 1.0], size: [0.8, 0.1], "
        "motion: {kind: circle, centre: [3.6, 1.0], speed: 0.3}",
    )
    record = run(scenario)
    assert record.movers.shape == (len(record.ticks.time), 2, 3)
    for k, index in enumerate(scenario.movers):
        for tick in (0, 40, len(record.ticks.time) - 1):
            at = place(scenario, float(record.ticks.time[tick]), index)
            assert record.movers[tick, k, :2] == pytest.approx(at, abs=1e-5)
    # The clearance is the least to anything, where it was at that tick.
    gaps = [Field.of(scenario.standing, scenario.arena).clearance(record.ticks.position)]
    for k, index in enumerate(scenario.movers):
        shape = scenario.obstacles[index]
        local = seen_from(record.ticks.position, shape.position, record.movers[:, k])
        gaps.append(Field.of([shape]).clearance(local))
    assert record.ticks.clearance == pytest.approx(np.min(gaps, axis=0) - 0.2)

    record.save(tmp_path / "run.npz")
    loaded = Trajectory.load(tmp_path / "run.npz")
    assert loaded == record
    assert run(scenario).digest() == record.digest()
    arrays = dict(np.load(tmp_path / "run.npz"))
    arrays["movers.poses"] = arrays["movers.poses"] + 1e-3
    np.savez(tmp_path / "other.npz", **arrays)
    assert Trajectory.load(tmp_path / "other.npz").digest() != record.digest()
    for bad in (arrays["movers.poses"][1:], arrays["movers.poses"] * np.nan):
        np.savez(tmp_path / "bad.npz", **{**arrays, "movers.poses": bad})
        with pytest.raises(UserError, match=r"damaged record: movers\.poses"):
            Trajectory.load(tmp_path / "bad.npz")


# What cannot be


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        ("kind: patrol, points: [[3, 1]], speed: 0.5", "motion.points: must have at least 2"),
        ("kind: patrol, points: [[3, 1], [3, 2]], speed: 3.5", "motion.speed: must be at most 3"),
        ("kind: trace, file: no.csv", "motion.file: .*no.csv: "),
        ("kind: trace, file: order.csv", "motion.file: .*order.csv:3: is out of order"),
        ("kind: trace, file: fast.csv", "motion.file: .*fast.csv:3: is reached at 4.00 m/s; at"),
        ("kind: trace, file: early.csv", "motion.file: .*early.csv:2: t must be at least 0, got"),
        ("kind: trace, file: far.csv", "motion.file: .*far.csv:3: x must be at most 1000, got"),
        ("kind: trace, file: blank.csv", "motion.file: .*blank.csv:4: is out of order"),
        ("kind: trace, file: long.csv", "motion.file: .*long.csv:2: is no CSV: "),
        ("kind: trace, file: turns.csv", "motion.file: turns so fast before t = 1 s that its "),
        (
            "kind: trace, poses: [[0, 3, 1, 0], [70, 3, 3, 0]], repeat: true",
            "motion.repeat: jumps 2.00 m, from its last row to its first",
        ),
        ("kind: patrol, points: [], speed: 0.5", "motion.points: must have at least 2 .* got 0"),
        ("kind: patrol, points: [[3, 1], [3, a]], speed: 0.5", r"motion.points\[1\]\[1\]: exp"),
        (
            "kind: patrol, points: [[3, 1], [3, 2]], sped: 1, speed: 1",
            "motion.sped: unknown key; did you mean 'speed'. allowed: kind, .*, points, speed, ",
        ),
        ("kind: trace, file: words.csv", "motion.file: .*words.csv:2: expected 3 numbers"),
        ("kind: trace, file: head.csv", "motion.file: .*head.csv:1: expected the header t,x,y"),
        ("kind: trace, file: inside.csv", r"motion: begins inside obstacles\[1\]"),
        ("kind: trace, file: start.csv", "motion: begins .* from the start"),
        ("kind: trace, file: wall.csv", "motion: begins in a wall"),
        ("kind: trace, file: 3", "motion.file: expected text, got 3; put it in quotes"),
        ("kind: circle, centre: [3, 1], speed: 0.5", "motion.centre: is the obstacle's own"),
        ("kind: circle, centre: [3, 1.1], speed: 1", "motion: its edge moves at 3.50 m/s; at most"),
    ],
)
def test_a_motion_that_cannot_be_is_one_line(motion: str, words: str, tmp_path: Path) -> None:
    for name, rows in {
        "order": "0,3,1\n0,3,2\n",
        "fast": "0,3,1\n0.5,3,3\n",
        "early": "-1,3,1\n",
        "far": "0,3,1\n1,1e9,1\n",
        "blank": "0,3,1\n\n0,3,1\n",
        "long": "0,3," + 200_000 * "1",
        "words": "0,3,here\n",
        "inside": "0,5,3\n",
        "start": "0,1.2,2\n",
        "wall": "0,5.9,2\n",
    }.items():
        (tmp_path / f"{name}.csv").write_text("t,x,y\n" + rows)
    (tmp_path / "head.csv").write_text("0,3,1\n")
    (tmp_path / "turns.csv").write_text("t,x,y,yaw\n0,3,1,0\n1,3,1,31.4\n")
    path = tmp_path / "room.yaml"
    still = "shape: cylinder, position: [5, 3], radius: 0.3"
    path.write_text(f"{ROOM}obstacles:\n  - {{{disc(3, 1, motion)}}}\n  - {{{still}}}\n")
    with pytest.raises(UserError, match=rf"room\.yaml:6: obstacles\[0\]\.{words}") as told:
        load_scenario(path)
    assert len(told.value.problems) == 1


def test_what_moves_wholly_outside_the_arena_is_told_once() -> None:
    with pytest.raises(UserError) as told:
        room(disc(9.0, 2.0, "kind: patrol, points: [[9, 2], [9, 3]], speed: 0.5"))
    [line] = told.value.problems
    assert line.startswith("scenario:6: obstacles[0].position: is wholly outside the walls")


def test_a_wanderer_needs_room() -> None:
    with pytest.raises(UserError, match=r"scenario:6: .*motion\.kind: wander: .* in something"):
        room(
            disc(3.0, 1.0, "kind: wander, speed: 0.5"),
            "shape: cylinder, position: [3.0, 1.2], radius: 0.5",
        )


@pytest.mark.parametrize("seed", range(8))
def test_a_fast_wanderer_in_a_narrow_place_stays_out_of_the_walls(seed: int) -> None:
    # It bounces often: most of its pieces last less than a twentieth of a second.
    wander = "shape: cylinder, position: [0.6, 3.4], radius: 0.45, motion: {kind: wander, speed: 3}"
    wall = "shape: box, position: [1.3, 3.4], size: [0.2, 1.2]"
    world = room(wander, wall).model_copy(update={"seed": seed})
    way = np.array([place(world, t) for t in np.arange(0.0, 10.0, 0.02)])
    assert Field.of(world.standing, world.arena).clearance(way).min() >= 0.45 - 1e-5
    assert np.ptp(way, axis=0).min() > 0.1


def test_what_turns_stops_for_the_robot_wherever_it_is_on_its_circle() -> None:
    # Its turn counts from -π to π, and it is at π on its way to the robot.
    motion = "kind: circle, centre: [3.0, 1.5], speed: 0.5, stops_for_robot: true"
    world, robot = room(disc(3.75, 1.5, motion)), (2.25, 0.79)
    mover = Mover(0, world.obstacles[0])
    mover.begin(courses_of(world.obstacles, world.arena, 0)[0])
    half = math.pi * 0.75 / 0.5
    for time in np.arange(half - 0.2, half + 0.1, 0.01).tolist():
        assert mover.is_blocked(time, robot, 0.2)
