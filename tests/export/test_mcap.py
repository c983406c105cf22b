"""A record as MCAP: read back with the format's own reader, it is the record again."""

from __future__ import annotations

import io
import json
import math
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from fuzzyq_bullet import Trajectory, load_scenario, run, with_options
from fuzzyq_bullet.columns import Column
from fuzzyq_bullet.export.mcap import mcap_of
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.recording.trajectory import DECISIONS, TICKS, Collision
from fuzzyq_bullet.video import style

SECOND = 10**9


class File:
    """An MCAP file, read whole: by topic the schema, and every message with its time (ns)."""

    def __init__(self, content: bytes) -> None:
        self.schemas: dict[str, Any] = {}
        self.times: dict[str, list[int]] = {}
        self.messages: dict[str, list[Any]] = {}
        reader = make_reader(io.BytesIO(content), True, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages():
            topic = channel.topic
            assert schema is not None
            assert message.publish_time == message.log_time
            self.schemas[topic] = schema
            decode = DecoderFactory().decoder_for(channel.message_encoding, schema) or json.loads
            self.times.setdefault(topic, []).append(message.log_time)
            self.messages.setdefault(topic, []).append(decode(message.data))
        self.about = {one.name: one.metadata for one in reader.iter_metadata()}

    def at(self, topic: str, time: int) -> Any:
        """Return what a player shows of a topic that is set to a time (ns): the last before it."""
        return self.messages[topic][bisect_right(self.times[topic], time) - 1]


@pytest.fixture(scope="module")
def record(short: Path) -> Trajectory:
    return run(load_scenario(short))


@pytest.fixture(scope="module")
def content(record: Trajectory) -> bytes:
    return mcap_of(record)


@pytest.fixture(scope="module")
def file(content: bytes) -> File:
    return File(content)


def nanoseconds(times: Any) -> list[int]:
    return [round(time * SECOND) for time in times.tolist()]


def test_every_tick_and_every_decision_is_there_at_its_time(record: Trajectory, file: File) -> None:
    ticks = nanoseconds(record.ticks.time)
    decisions = nanoseconds(record.ticks.time[record.decisions.tick])
    assert file.times.pop("/log")[-1] == ticks[-1]
    assert file.times == {
        **{topic: [0] for topic in ("/scene", "/robot", "/path")},
        **dict.fromkeys(("/tf", "/ticks"), ticks),
        **dict.fromkeys(("/decisions", "/lines", "/aim"), decisions),
    }


def test_what_is_in_space_follows_schemas_that_foxglove_knows(file: File) -> None:
    assert {topic: (one.name, one.encoding) for topic, one in file.schemas.items()} == {
        **dict.fromkeys(
            ("/scene", "/robot", "/lines", "/aim"), ("foxglove.SceneUpdate", "protobuf")
        ),
        "/path": ("foxglove.PosesInFrame", "protobuf"),
        "/tf": ("foxglove.FrameTransforms", "protobuf"),
        "/log": ("foxglove.Log", "protobuf"),
        "/ticks": ("fuzzyq_bullet.Tick", "jsonschema"),
        "/decisions": ("fuzzyq_bullet.Decision", "jsonschema"),
    }


@pytest.mark.parametrize(("group", "columns"), [("ticks", TICKS), ("decisions", DECISIONS)])
def test_the_tables_keep_to_their_schema_and_hold_every_number(
    group: str, columns: dict[str, Column], record: Trajectory, file: File
) -> None:
    schema = json.loads(file.schemas[f"/{group}"].data)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    rows = file.messages[f"/{group}"]
    for row in rows:
        validator.validate(row)
    arrays = vars(getattr(record, group))
    for name, column in columns.items():
        assert schema["properties"][name]["description"].startswith(column.meaning)
        assert column.unit in schema["properties"][name]["description"]
        for row, entry in zip(rows, arrays[name].tolist(), strict=True):
            assert row.get(name) == as_json(entry, column, column.axes)


def as_json(entry: Any, column: Column, axes: tuple[tuple[str, ...], ...]) -> Any:
    if axes:
        inner = {
            label: as_json(one, column, axes[1:]) for label, one in zip(axes[0], entry, strict=True)
        }
        return {label: one for label, one in inner.items() if one is not None}
    if column.words:
        return column.words[entry]
    return entry if math.isfinite(entry) else None


def test_a_schema_without_what_it_asks_for_is_noticed(file: File) -> None:
    schema = json.loads(file.schemas["/decisions"].data)
    row = file.messages["/decisions"][0]
    for wrong in (
        {**row, "mode": "asleep"},
        {**row, "unheard": 1.0},
        {**row, "lines": {**row["lines"], "left": "far"}},
        {name: value for name, value in row.items() if name != "heading"},
    ):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, schema)


def test_every_type_is_one_that_foxglove_reads(file: File) -> None:
    # It refuses a schema in which a type is a list, such as ["number", "null"].
    def types(schema: dict[str, Any]) -> Iterator[Any]:
        yield schema["type"]
        for inner in schema.get("properties", {}).values():
            yield from types(inner)

    for topic in ("/ticks", "/decisions"):
        found = Counter(types(json.loads(file.schemas[topic].data)))
        assert set(found) <= {"object", "number", "integer", "string"}


def test_the_robots_frame_is_where_the_robot_was(record: Trajectory, file: File) -> None:
    ticks = record.ticks
    for message, time, where, heading in zip(
        file.messages["/tf"],
        file.times["/tf"],
        ticks.position.tolist(),
        ticks.heading.tolist(),
        strict=True,
    ):
        (one,) = message.transforms
        assert (one.parent_frame_id, one.child_frame_id) == ("world", "base_link")
        assert [one.translation.x, one.translation.y, one.translation.z] == [*where, 0.0]
        turned = 2.0 * math.atan2(one.rotation.z, one.rotation.w)
        assert math.remainder(turned - heading, math.tau) == pytest.approx(0.0, abs=1e-12)
        assert one.timestamp.ToNanoseconds() == time
    (robot,) = file.messages["/robot"][0].entities
    assert (robot.frame_id, robot.frame_locked) == ("base_link", True)
    assert robot.cylinders[0].size.x == 2 * record.scenario.robot.radius
    (path,) = file.messages["/path"]
    assert [[p.position.x, p.position.y] for p in path.poses] == ticks.position.tolist()


@pytest.mark.parametrize("name", ["rooms", "jackal", "rounds"])
def test_polygons_rectangular_robots_and_tasks_are_in_space(name: str, record: Trajectory) -> None:
    scenario = load_scenario(name)
    stands = replace(record, scenario=scenario)
    file = File(mcap_of(stands))
    (scene,) = file.messages["/scene"]
    there = {one.id: one for one in scene.entities}
    assert len([one for one in there if one.startswith("obstacles")]) == len(scenario.obstacles)
    low, high = corners(there["walls"]).min(axis=0), corners(there["walls"]).max(axis=0)
    left, bottom, right, top = scenario.arena.bounds
    assert (low[:2] < (left, bottom)).all()
    assert (high[:2] > (right, top)).all()
    for index, one in enumerate(scenario.obstacles):
        outline = one.outline()
        seen = corners(there[f"obstacles[{index}]"])
        np.testing.assert_allclose(seen.min(axis=0)[:2], outline.min(axis=0), atol=0.02)
        np.testing.assert_allclose(seen.max(axis=0)[:2], outline.max(axis=0), atol=0.02)
    numbers = [one.texts[0].text for key, one in there.items() if key.startswith("via")]
    assert numbers == [str(k + 1) for k in range(len(scenario.via))]
    reach = np.hypot(*(corners(there["goal"])[:, :2] - scenario.goal.position).T).max()
    assert (reach > 1.5 * scenario.goal.radius) == (scenario.goal.heading is not None)
    (robot,) = file.messages["/robot"][0].entities
    model = scenario.robot.spec
    assert bool(robot.cylinders) == model.is_disc
    if not model.is_disc:
        span = np.ptp(corners(robot)[:, :2], axis=0)
        np.testing.assert_allclose(span, model.size, atol=1e-9)


def corners(entity: Any) -> np.ndarray[Any, Any]:
    return np.array([(p.x, p.y, p.z) for solid in entity.triangles for p in solid.points])


def test_the_scene_is_that_of_the_scenario(record: Trajectory, file: File) -> None:
    (scene,) = file.messages["/scene"]
    scenario = record.scenario
    found = {one.id: one for one in scene.entities}
    assert list(found) == ["goal", "walls", "obstacles[0]", "obstacles[1]"]
    assert {(one.frame_id, one.lifetime.ToNanoseconds()) for one in found.values()} == {
        ("world", 0)
    }
    for index, obstacle in enumerate(scenario.obstacles):
        entity = found[f"obstacles[{index}]"]
        away = Field.of([obstacle]).clearance(corners(entity)[:, :2])
        assert np.abs(away).max() < 1e-9  # each corner stands on its outline
        assert set(corners(entity)[:, 2]) == {0.0, 0.4}
        about = {one.key: one.value for one in entity.metadata}
        assert about["shape"] == obstacle.shape
    goal = corners(found["goal"])[:, :2] - scenario.goal.position
    assert np.hypot(*goal.T) == pytest.approx(scenario.goal.radius)
    low, high = corners(found["walls"]).min(axis=0), corners(found["walls"]).max(axis=0)
    assert (*low, *high) == pytest.approx((-0.1, -0.1, 0.0, 3.1, 2.1, 0.25))


def test_the_lines_are_as_they_were_cast(record: Trajectory, file: File) -> None:
    decisions, radius = record.decisions, record.scenario.robot.radius
    for index, message in enumerate(file.messages["/lines"]):
        assert [one.type for one in message.deletions] == [1]  # all that was there before
        assert [one.id for one in message.entities] == ["left", "middle", "right"]
        x, y = record.ticks.position[decisions.tick[index]].tolist()
        for entity, colour, heading, length in zip(
            message.entities,
            style.LINES,
            decisions.lines[index].tolist(),
            decisions.lengths[index].tolist(),
            strict=True,
        ):
            (line,) = entity.lines
            start, end = ([one.x, one.y] for one in line.points)
            assert start == [x, y]
            assert math.dist(start, end) == pytest.approx(radius + length)
            assert math.atan2(end[1] - y, end[0] - x) == pytest.approx(heading)
            shade = (line.color.r, line.color.g, line.color.b)
            assert [round(255 * part) for part in shade] == list(colour)
            assert entity.timestamp.ToNanoseconds() == file.times["/lines"][index]


def test_the_aim_is_marked(record: Trajectory, file: File) -> None:
    for index, message in enumerate(file.messages["/aim"]):
        (aim,) = (one for one in message.entities if one.id == "aim")
        place = aim.spheres[0].pose.position
        assert [place.x, place.y] == record.decisions.aim[index].tolist()


def test_a_player_that_is_set_to_any_time_shows_what_was_then(
    record: Trajectory, file: File
) -> None:
    ticks, decisions = record.ticks, record.decisions
    for time in np.linspace(0.0, ticks.time[-1], 60):
        now = round(float(time) * SECOND)
        tick = int(np.searchsorted(nanoseconds(ticks.time), now, "right")) - 1
        decision = int(np.searchsorted(decisions.tick, tick, "right")) - 1
        assert file.at("/ticks", now)["speed"] == ticks.speed[tick]
        assert file.at("/tf", now).transforms[0].translation.x == ticks.position[tick, 0]
        assert file.at("/decisions", now)["heading"] == decisions.heading[decision]
        x = file.at("/lines", now).entities[0].lines[0].points[0].x
        assert x == ticks.position[decisions.tick[decision], 0]
        assert len(file.at("/scene", now).entities) == 4


def test_the_log_tells_how_it_began_why_it_turned_and_how_it_ended(
    record: Trajectory, file: File
) -> None:
    said = [(one.name, one.level, one.message) for one in file.messages["/log"]]
    assert said[0] == ("episode", 2, "short: planner fuzzy-q-lambda, drive wheels, seed 0")
    assert said[-1][:2] == ("episode", 2)
    assert said[-1][2].startswith("GOAL reached   in ")
    why = [text for name, _, text in said if name == "planner"]
    assert why
    assert all(a != b for a, b in pairwise(why))
    assert file.about["fuzzyq_bullet"]["digest"] == record.digest()
    touched = Collision(float(record.ticks.time[-1]), (1.0, 1.0), 1, 3.0)
    ended = File(mcap_of(replace(record, outcome="collision", collision=touched)))
    last = ended.messages["/log"][-1]
    assert (last.level, last.message.startswith("COLLISION with the box at (1.2, 1.5)")) == (
        4,
        True,
    )
    ended = File(mcap_of(replace(record, outcome="stuck")))
    assert ended.messages["/log"][-1].level == 3


def test_a_change_of_mode_is_an_event(record: Trajectory) -> None:
    mode = np.zeros_like(record.decisions.mode)
    mode[5:9] = 1
    other = replace(
        record, decisions=type(record.decisions)(**{**vars(record.decisions), "mode": mode})
    )
    file = File(mcap_of(other))
    said = zip(file.times["/log"], file.messages["/log"], strict=True)
    modes = [(time, one.message) for time, one in said if one.message.startswith("mode: ")]
    at = nanoseconds(record.ticks.time[record.decisions.tick[[5, 9]]])
    assert modes == [(at[0], "mode: breakout"), (at[1], "mode: routine")]


def test_a_planner_without_lines_has_none_and_leaves_its_numbers_out(record: Trajectory) -> None:
    blank = {
        name: np.full_like(array, np.nan) if DECISIONS[name].blank else array
        for name, array in vars(record.decisions).items()
        if array is not None
    }
    file = File(mcap_of(replace(record, decisions=type(record.decisions)(**blank))))
    assert {len(one.entities) for topic in ("/lines", "/aim") for one in file.messages[topic]} == {
        0
    }
    row = file.messages["/decisions"][0]
    jsonschema.validate(row, json.loads(file.schemas["/decisions"].data))
    assert (row["lines"], row["rules"]["VN"], "distance" in row) == ({}, {}, False)


def test_the_point_robots_record_is_one_too(short: Path) -> None:
    point = run(with_options(load_scenario(short), drive="kinematic"))
    file = File(mcap_of(point))
    assert file.times["/tf"] == nanoseconds(point.ticks.time)
    assert len(file.messages["/decisions"]) == point.decisions.tick.size


def test_the_same_record_gives_the_same_bytes(record: Trajectory, content: bytes) -> None:
    assert mcap_of(record) == content
