"""Records made by hand: a plausible drive without physics, for tests of what reads records."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzyq_bullet.fuzzy import paper_controller
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.settings import ImprovedFuzzySettings
from fuzzyq_bullet.recording.trajectory import Collision, Decisions, Outcome, Ticks, Trajectory
from fuzzyq_bullet.scenario import Arena, Box, Cylinder, Goal, Scenario, Start

RADIUS = 0.2
RANGE = 1.0
STEP_UNIT = 0.2
RATE = 30


def scenario(
    count: int = 30,
    boxes: int = 4,
    *,
    size: tuple[float, float] = (10.0, 10.0),
    start: tuple[float, float] = (1.0, 4.0),
    goal: tuple[float, float] = (9.0, 6.0),
    seed: int = 3,
    **others: Any,
) -> Scenario:
    """Return a scenario with obstacles at random places that leave start and goal free."""
    rng = np.random.default_rng(seed)
    obstacles: list[Cylinder | Box] = []
    while len(obstacles) < count + boxes:
        x, y = (float(v) for v in rng.uniform((0.4, 0.4), (size[0] - 0.4, size[1] - 0.4)))
        far = min(math.dist((x, y), start), math.dist((x, y), goal))
        if far < 0.9 and min(size) > 4:
            continue
        if len(obstacles) < count:
            obstacles.append(Cylinder(shape="cylinder", position=(x, y), radius=0.2))
        else:
            obstacles.append(
                Box(shape="box", position=(x, y), size=(0.9, 0.35), yaw=float(rng.uniform(0, 3)))
            )
    return Scenario(
        name="synthetic",
        seed=seed,
        arena=Arena(size=size),
        start=Start(position=start),
        goal=Goal(position=goal),
        obstacles=tuple(obstacles),
        planner=ImprovedFuzzySettings(turn_unit=math.radians(45.0)),
        **others,
    )


def drive(
    world: Scenario | None = None,
    *,
    seconds: float = 60.0,
    outcome: Outcome | None = None,
    explained: bool = True,
) -> Trajectory:
    """Return a drive of the fuzzy controller, moved by hand: turns at 2 rad/s, at most 0.6 m/s.

    Args:
        world: Where; by default ``scenario()``.
        seconds: When to stop at the latest.
        outcome: How it is said to end; by default as it does.
        explained: False leaves every explanation at its blank, as planners without fuzzy sets do.
    """
    world = world or scenario()
    field = Field.of(world.obstacles, world.arena)
    controller = paper_controller()
    goal = world.goal.position
    x, y = world.start.position
    heading, speed = world.start_heading(), 0.0
    ticks: list[tuple[float, ...]] = []
    made: list[dict[str, Any]] = []
    ended: Outcome = "timeout"
    wish, pace = heading, 0.0
    for tick in range(int(seconds * RATE) + 1):
        near = float(field.clearance([(x, y)])[0]) - RADIUS
        ticks.append((tick / RATE, x, y, heading, speed, 0.0, near))
        if math.dist((x, y), goal) < world.goal.radius:
            ended = "goal"
            break
        if near < 0:
            ended = "collision"
            break
        if tick % 2 == 0:
            bearing = math.atan2(goal[1] - y, goal[0] - x)
            lines = bearing + math.radians(45) * np.array([1, 0, -1])
            lengths = field.free_distance((x, y), lines, RADIUS + 0.02, RANGE)
            left, ahead, right = lengths.tolist()
            free = ahead >= min(RANGE, math.dist((x, y), goal))
            distance, difference = (5.0, 0.0) if free else (ahead / 0.2, (left - right) / 0.2)
            inferred = controller.infer(distance, difference)
            wish = bearing + inferred.turn * math.radians(45)
            pace = 0.3 * inferred.stride
            made.append(
                {
                    "tick": tick,
                    "heading": wish,
                    "step": inferred.stride * STEP_UNIT,
                    "reach": math.inf,
                    "mode": 0,
                    "lines": lines,
                    "lengths": lengths,
                    "distance": distance,
                    "difference": difference,
                    "near": inferred.near,
                    "side": inferred.side,
                    "rules": inferred.rules,
                    "turn": inferred.turn,
                    "stride": inferred.stride,
                    "weights": (1.0, 1.0),
                    "breakout_at": 1.0,
                    "guard": math.nan,
                    "target": (math.nan, math.nan),
                    "aim": goal,
                    "exact": 0.0,
                }
            )
        error = math.remainder(wish - heading, math.tau)
        heading += max(-2.0 / RATE, min(2.0 / RATE, error))
        wanted = pace * max(0.0, math.cos(error))
        speed += max(-1.0 / RATE, min(1.0 / RATE, wanted - speed))
        x, y = x + math.cos(heading) * speed / RATE, y + math.sin(heading) * speed / RATE
    return _record(world, ticks, made, outcome or ended, explained)


def modes(trajectory: Trajectory, *modes_and_share: tuple[int, float]) -> Trajectory:
    """Return the record with modes and a target in consecutive shares of its decisions."""
    decisions = trajectory.decisions
    mode, target = decisions.mode.copy(), decisions.target.copy()
    begin = 0
    for number, share in modes_and_share:
        stop = begin + int(share * len(mode))
        mode[begin:stop] = number
        if number:
            target[begin:stop] = np.add(
                trajectory.ticks.position[decisions.tick[begin]], (0.8, 0.9)
            )
        begin = stop
    return replace(trajectory, decisions=replace(decisions, mode=mode, target=target))


def standing(seconds: float, world: Scenario | None = None) -> Trajectory:
    """Return a record of a robot that stands still for so long."""
    world = world or scenario()
    short = drive(world, seconds=0.0, outcome="timeout")
    count = int(seconds * RATE) + 1
    ticks = {name: np.repeat(column, count, axis=0) for name, column in vars(short.ticks).items()}
    ticks["time"] = np.arange(count) / RATE
    return replace(short, ticks=Ticks(**ticks))


def _record(
    world: Scenario,
    ticks: list[tuple[float, ...]],
    made: list[dict[str, Any]],
    outcome: Outcome,
    explained: bool,
) -> Trajectory:
    time, x, y, heading, speed, rate, clearance = np.array(ticks).T
    columns = {
        key: np.array([one[key] for one in made], dtype=int if key in ("tick", "mode") else float)
        for key in made[0]
    }
    if not explained:
        for key in columns:
            if key not in ("tick", "heading", "step", "reach", "mode"):
                columns[key] = np.full_like(columns[key], np.nan)
    hit = None
    if outcome == "collision":
        field = Field.of(world.obstacles, world.arena)
        obstacle, gap = field.nearest((x[-1], y[-1]))
        if obstacle >= 0:
            cx, cy = world.obstacles[obstacle].position
            away = math.hypot(cx - x[-1], cy - y[-1])
            point = (x[-1] + (cx - x[-1]) / away * gap, y[-1] + (cy - y[-1]) / away * gap)
        else:
            point = (x[-1] + gap, y[-1])
        hit = Collision(float(time[-1]), (float(point[0]), float(point[1])), obstacle, 12.5)
    return Trajectory(
        scenario=world,
        outcome=outcome,
        physics_steps=len(ticks) * 8,
        collision=hit,
        ticks=Ticks(
            time=time,
            position=np.stack([x, y], axis=1),
            heading=heading,
            speed=speed,
            turn_rate=rate,
            wheel_speeds=np.stack([speed, speed], axis=1) / 0.05,
            clearance=clearance,
        ),
        decisions=Decisions(**columns),
        version="0.0.0",
    )
