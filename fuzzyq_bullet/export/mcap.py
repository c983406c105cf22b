"""A record as MCAP, for Foxglove and other programs that play such files (extra ``mcap``).

All that is in space follows Foxglove's own schemas, in Protobuf. Ticks and decisions are JSON, with
schemas that follow from the columns of a record. Every time is simulated time; the run starts at 0.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from foxglove import Channel, Context, open_mcap
from foxglove.channels import (
    FrameTransformsChannel,
    LogChannel,
    PosesInFrameChannel,
    SceneUpdateChannel,
)
from foxglove.mcap import MCAPWriteOptions
from foxglove.messages import Log, LogLevel

from fuzzyq_bullet.columns import Column, Columns
from fuzzyq_bullet.export import scene
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.moving import headings_of
from fuzzyq_bullet.recording.trajectory import TICKS, Trajectory
from fuzzyq_bullet.video.captions import outcome_lines
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.explanation import reason
from fuzzyq_bullet.video.timeline import NO_DECISION, Timeline

Axes: TypeAlias = tuple[tuple[str, ...], ...]

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_LEVELS = {"goal": LogLevel.Info, "collision": LogLevel.Error}
"""What an outcome counts as in the log; all others are warnings."""


def mcap_of(trajectory: Trajectory) -> bytes:
    """Return a record as an MCAP file; docs/reference/record.md lists its topics."""
    file, context = io.BytesIO(), Context()
    # In one thread it is compressed to the same bytes each time.
    options = MCAPWriteOptions(compression_threads=0)
    with open_mcap(file, context=context, writer_options=options) as writer:
        writer.write_metadata("fuzzyq_bullet", _about(trajectory))
        _log_all(trajectory, context)
    return file.getvalue()


def json_schema(title: str, columns: Columns) -> dict[str, Any]:
    """Return the JSON Schema of messages that hold one row of a table.

    Numbers in rows and tables are objects, such as ``rules.VN.NB``. What is blank or infinite is
    left out: JSON has no such numbers, and Foxglove takes no type such as "a number or null".
    """
    inner = {name: _schema(column, column.axes) for name, column in columns.items()}
    always = [name for name, column in columns.items() if column.axes or not _may_lack(column)]
    return {"$schema": _DIALECT, "title": title, **_object(inner, always)}


def _log_all(trajectory: Trajectory, context: Context) -> None:
    """Log every message of a record, in the order of time."""
    ticks, decisions = trajectory.ticks, trajectory.decisions
    start = _nanoseconds(float(ticks.time[0]))
    world, robot, lines, aim = (
        SceneUpdateChannel(topic, context=context)
        for topic in ("/scene", "/robot", "/lines", "/aim")
    )
    world.log(scene.world_entities(trajectory.scenario), log_time=start)
    robot.log(scene.robot_entities(trajectory.scenario.robot.spec), log_time=start)
    headings = headings_of(trajectory)
    if headings.size:
        movers, arrows = (
            SceneUpdateChannel(topic, context=context) for topic in ("/movers", "/movers_headings")
        )
        movers.log(scene.mover_entities(trajectory.scenario), log_time=start)
    path = PosesInFrameChannel("/path", context=context)
    path.log(scene.path_poses(ticks), log_time=start)
    frame = FrameTransformsChannel("/tf", context=context)
    log = LogChannel("/log", context=context)
    states = Channel("/ticks", schema=json_schema("fuzzyq_bullet.Tick", TICKS), context=context)
    columns = trajectory.decision_columns
    decided = Channel(
        "/decisions", schema=json_schema("fuzzyq_bullet.Decision", columns), context=context
    )
    state_rows, decision_rows = _rows(TICKS, vars(ticks)), _rows(columns, vars(decisions))
    events = _events(trajectory)
    at = decisions.tick.tolist()
    index = 0
    for tick, row in enumerate(state_rows):
        time = _nanoseconds(row["time"])
        frame.log(scene.frames(time, _poses(trajectory, tick)), log_time=time)
        if headings.size:
            marks = scene.mover_marks(
                trajectory.scenario, trajectory.movers[tick], headings[tick].tolist(), time
            )
            arrows.log(marks, log_time=time)
        states.log(row, log_time=time)
        while index < len(at) and at[index] == tick:
            decided.log(next(decision_rows), log_time=time)
            lines.log(scene.detection_lines(trajectory, index, time), log_time=time)
            aim.log(scene.aim_marks(trajectory, index, time), log_time=time)
            index += 1
        for name, level, text in events.get(tick, ()):
            entry = Log(timestamp=scene.stamp(time), level=level, message=text, name=name)
            log.log(entry, log_time=time)


def _poses(trajectory: Trajectory, tick: int) -> dict[str, tuple[float, float, float]]:
    """Return the poses of the frames of the robot and of all that moves."""
    x, y = trajectory.ticks.position[tick].tolist()
    told = {scene.ROBOT: (x, y, float(trajectory.ticks.heading[tick]))}
    for index, pose in zip(trajectory.scenario.movers, trajectory.movers[tick], strict=False):
        told[scene.mover_frame(index)] = tuple(pose.tolist())
    return told


def _events(trajectory: Trajectory) -> dict[int, list[tuple[str, LogLevel, str]]]:
    """Return what is worth a line in the log: source, level and text by tick.

    The planner's reasons are those that the film shows, each for long enough to be read.
    """
    scenario, decisions = trajectory.scenario, trajectory.decisions
    planner = f"planner {scenario.planner.name}, drive {scenario.drive}, seed {scenario.seed}"
    found = {0: [("episode", LogLevel.Info, f"{scenario.name}: {planner}")]}
    timeline, hold = Timeline(trajectory), DecisionHold(trajectory)
    mode, sentence = "routine", ""
    for index, tick in enumerate(decisions.tick.tolist()):
        here = found.setdefault(tick, [])
        now = MODES[int(decisions.mode[index])]
        if now != mode:
            mode = now
            here.append(("episode", LogLevel.Info, f"mode: {mode}"))
        shown = hold.at(timeline.at(float(trajectory.ticks.time[tick])))
        why = sentence if shown == NO_DECISION else reason(trajectory, shown)
        if why != sentence:
            sentence = why
            here.append(("planner", LogLevel.Info, sentence))
    title, figures = outcome_lines(trajectory)
    level = _LEVELS.get(trajectory.outcome, LogLevel.Warning)
    last = len(trajectory.ticks.time) - 1
    found.setdefault(last, []).append(("episode", level, f"{title}   {figures}"))
    return found


def _about(trajectory: Trajectory) -> dict[str, str]:
    scenario = trajectory.scenario
    return {
        "scenario": scenario.name,
        "planner": scenario.planner.name,
        "drive": scenario.drive,
        "seed": str(scenario.seed),
        "outcome": trajectory.outcome,
        "digest": trajectory.digest(),
        "version": trajectory.version,
    }


def _nanoseconds(time: float) -> int:
    return round(time * 1e9)


def _object(properties: dict[str, Any], always: list[str]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": properties,
        "required": always,
        "additionalProperties": False,
    }


def _schema(column: Column, axes: Axes, inside: bool = False) -> dict[str, Any]:
    """Return the JSON Schema of one entry of a column."""
    told = {} if inside else {"description": _described(column)}
    if axes:
        inner = _schema(column, axes[1:], True)
        always = [] if _may_lack(column) and not axes[1:] else list(axes[0])
        return {**_object(dict.fromkeys(axes[0], inner), always), **told}
    if column.words:
        return {"type": "string", "enum": list(column.words), **told}
    return {"type": "integer" if column.whole else "number", **told}


def _may_lack(column: Column) -> bool:
    return column.blank or column.endless


def _described(column: Column) -> str:
    return f"{column.meaning} Unit: {column.unit}." if column.unit else column.meaning


def _rows(columns: Columns, arrays: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield every row of a table as a message."""
    for entries in zip(*(arrays[name].tolist() for name in columns), strict=True):
        row = {
            name: _plain(entry, column, column.axes)
            for (name, column), entry in zip(columns.items(), entries, strict=True)
        }
        yield _without_blanks(row)


def _plain(entry: Any, column: Column, axes: Axes) -> Any:
    """Return one entry as JSON has it, and None for what it has not."""
    if axes:
        labelled = zip(axes[0], entry, strict=True)
        return _without_blanks({label: _plain(one, column, axes[1:]) for label, one in labelled})
    if column.words:
        return column.words[entry]
    return entry if math.isfinite(entry) else None


def _without_blanks(entries: dict[str, Any]) -> dict[str, Any]:
    return {name: entry for name, entry in entries.items() if entry is not None}
