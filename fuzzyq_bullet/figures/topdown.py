"""One run seen from straight above, drawn from its record alone: the world, the way, the end."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon
from numpy.typing import NDArray

from fuzzyq_bullet.figures.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.rules_turn import has_rules
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.shapes import Obstacle
from fuzzyq_bullet.video.map.footprints import arrow, pointer
from fuzzyq_bullet.video.movers import DrawnMovers


class Stroke(NamedTuple):
    """How a stretch of the path is drawn: colour, width (points), words of the legend."""

    colour: str
    width: float
    words: str


PATH = {
    "routine": Stroke(BLUE, 1.8, "path: routine"),
    "breakout": Stroke(RED, 3.8, "breakout"),
    "following": Stroke(ORANGE, 2.8, "following an obstacle"),
}
"""By mode. The thickest is the shortest: a breakout is often one decision long."""

PLAIN = "path"
"""What a stretch of routine is called for a planner without rules."""

LEGEND = (
    "start",
    "goal",
    PLAIN,
    *(stroke.words for stroke in PATH.values()),
    TEMPORARY := "temporary goal of a breakout",
    LEAVES := "leaves the obstacle",
    LAST := "robot at the end",
    MOVES := "moving obstacle at the end, and its way",
    HIT := "collision",
)
"""All that a panel may show, in the order of the legend."""

_Look: TypeAlias = dict[str, Any]
"""Arguments of matplotlib, whose values are of many types."""
_Shown: TypeAlias = dict[str, Artist]

_CORNERS = 60
"""Of a polygon that stands for a circle."""
_OBSTACLE = "#B9BEC6"
_GOAL_FACE = "#40B696"
_MOVER, _MOVER_EDGE = "#D9C7A3", "#8A7443"


def _look(marker: str, face: str, rim: str, size: float) -> _Look:
    """Return how a mark is drawn that has the same size (points) however large the arena is."""
    return {"marker": marker, "mfc": face, "mec": rim, "ms": size, "mew": 1.4, "ls": ""}


_START_LOOK = _look("o", "white", INK, 9)
_GOAL_LOOK = _look("o", _GOAL_FACE, GREEN, 9)
_END_LOOK = _look("o", INK, INK, 8)
_TARGET_LOOK = _look("D", "white", PURPLE, 6.5)
_LEAVE_LOOK = _look("s", "white", PATH["routine"].colour, 5)
_MOVER_LOOK = _look("o", _MOVER, _MOVER_EDGE, 9)
_HIT_LOOK = _look("X", RED, "white", 11)


def draw_run(axes: Axes, trajectory: Trajectory, *, targets: bool = True) -> dict[str, Artist]:
    """Draw a run over the whole arena.

    Args:
        axes: Where to.
        trajectory: The record.
        targets: Whether the temporary goals of breakouts are shown.

    Returns:
        What there is to explain: words, out of ``LEGEND``, and a sample of each mark drawn.
    """
    shown: _Shown = {}
    _world(axes, trajectory, shown)
    _movers(axes, trajectory, shown)
    _path(axes, trajectory, shown)
    _escapes(axes, trajectory, shown, targets)
    _end(axes, trajectory, shown)
    return shown


def _world(axes: Axes, trajectory: Trajectory, shown: _Shown) -> None:
    scenario = trajectory.scenario
    left, bottom, right, top = scenario.arena.bounds
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    hit = trajectory.collision
    for index, obstacle in enumerate(scenario.obstacles):
        if index in scenario.movers:
            continue
        struck = hit is not None and hit.obstacle == index
        axes.add_patch(_shape(obstacle, struck))
    for side in axes.spines.values():
        side.set(linewidth=2.2 if scenario.arena.walls else 0.6, color=INK)
    at = (*scenario.start.position, scenario.start_heading())
    start = _body(scenario, *at)
    start.set(fc="white", ec=INK, lw=1.4, zorder=3)
    axes.add_patch(start)
    goal = scenario.goal
    for number, via in enumerate(scenario.via, 1):
        axes.add_patch(Circle(via.position, via.radius, fc="none", ec=GREEN, lw=1.2, zorder=3))
        axes.annotate(str(number), via.position, color=GREEN, ha="center", va="center", zorder=8)
    if goal.heading is not None:
        for part in pointer(goal.position, goal.heading, 2.5 * goal.radius):
            axes.add_patch(Polygon(part, fc=GREEN, ec="none", zorder=8))
    axes.add_patch(Circle(goal.position, goal.radius, fc=_GOAL_FACE, ec="none", zorder=3))
    # Its rim is seen through the robot that came to rest there.
    axes.add_patch(Circle(goal.position, goal.radius, fc="none", ec=GREEN, lw=2.0, zorder=8))
    shown["start"] = _sample(_START_LOOK)
    shown["goal"] = _sample(_GOAL_LOOK)


def _movers(axes: Axes, trajectory: Trajectory, shown: _Shown) -> None:
    """Draw what moves where it was in the end, with the way it went and an arrow on it."""
    last, hit = len(trajectory.ticks.time) - 1, trajectory.collision
    drawn = DrawnMovers(trajectory, lambda _: _CORNERS).at(float(trajectory.ticks.time[-1]), last)
    for k, one in enumerate(drawn):
        way = trajectory.movers[:, k, :2]
        axes.plot(*way.T, color=_MOVER_EDGE, lw=1.0, ls=(0, (4, 2)), zorder=2.2)
        struck = hit is not None and hit.obstacle == one.number
        look: _Look = {"fc": _MOVER, "ec": RED if struck else _MOVER_EDGE, "zorder": 2.6}
        axes.add_patch(Polygon(one.outline, lw=2.2 if struck else 1.0, **look))
        if one.nose is not None:
            axes.add_patch(Polygon(one.nose, fc="white", ec="none", zorder=2.7))
        shown[MOVES] = _sample(_MOVER_LOOK)


def _body(scenario: Scenario, x: float, y: float, heading: float) -> Patch:
    """Return the robot's footprint at a pose (m, m, rad)."""
    model = scenario.robot.spec
    if model.is_disc:
        return Circle((x, y), model.radius)
    return Polygon(model.footprint_at(x, y, heading))


def _shape(obstacle: Obstacle, struck: bool) -> Patch:
    look: _Look = {
        "facecolor": _OBSTACLE,
        "edgecolor": RED if struck else GREY,
        "linewidth": 2.2 if struck else 0.6,
        "zorder": 2.5 if struck else 2.0,
    }
    return Polygon(obstacle.outline(_CORNERS), **look)


def modes_by_tick(trajectory: Trajectory) -> NDArray[np.int64]:
    """Return for each move, from one tick to the next, the index of its mode, shape (T − 1,)."""
    ticks = np.arange(len(trajectory.ticks.time) - 1)
    decision = np.searchsorted(trajectory.decisions.tick, ticks, side="right") - 1
    modes: NDArray[np.int64] = trajectory.decisions.mode[decision]
    return modes


def _path(axes: Axes, trajectory: Trajectory, shown: _Shown) -> None:
    points = trajectory.ticks.position
    moves = np.stack([points[:-1], points[1:]], axis=1)
    modes = modes_by_tick(trajectory)
    for index, mode in enumerate(MODES):
        here = modes == index
        if not here.any():
            continue
        stroke = PATH[mode]
        axes.add_collection(
            LineCollection(
                list(moves[here]), colors=stroke.colour, linewidths=stroke.width,
                capstyle="round", zorder=4.0 + index % 2,
            )
        )  # fmt: skip
        plain = mode == "routine" and not has_rules(trajectory.decisions)
        shown[PLAIN if plain else stroke.words] = Line2D(
            [], [], color=stroke.colour, lw=stroke.width
        )


def _escapes(axes: Axes, trajectory: Trajectory, shown: _Shown, targets: bool) -> None:
    """Mark each beginning of a breakout, with its temporary goal, and each place of leaving."""
    decisions = trajectory.decisions
    places = trajectory.ticks.position[decisions.tick]
    routine, breakout = MODES.index("routine"), MODES.index("breakout")
    before = np.concatenate([[routine], decisions.mode[:-1]])
    begun = targets & (decisions.mode == breakout) & (before != breakout)
    for here, target in zip(places[begun], decisions.target[begun], strict=True):
        line = np.stack([here, target])
        axes.plot(*line.T, color=PURPLE, lw=1.2, ls=(0, (1.5, 1.8)), zorder=5.5)
        axes.plot(*target, zorder=6, **_TARGET_LOOK)
        shown[TEMPORARY] = _sample(_TARGET_LOOK)
    left = (decisions.mode == routine) & (before != routine)
    for here in places[left]:
        axes.plot(*here, zorder=6, **_LEAVE_LOOK)
        shown[LEAVES] = _sample(_LEAVE_LOOK)


def _end(axes: Axes, trajectory: Trajectory, shown: _Shown) -> None:
    """Draw the robot where it came to its end, and where it touched something."""
    x, y = trajectory.ticks.position[-1].tolist()
    model = trajectory.scenario.robot.spec
    size = model.radius * (1.15 if model.is_disc else 0.75)
    nose = arrow((x, y), float(trajectory.ticks.heading[-1]), size)
    body = _body(trajectory.scenario, x, y, float(trajectory.ticks.heading[-1]))
    body.set(fc=INK, ec="none", zorder=7)
    axes.add_patch(body)
    axes.add_patch(Polygon(nose, fc="white", ec="none", zorder=7.5))
    shown[LAST] = _sample(_END_LOOK)
    if trajectory.collision is not None:
        axes.plot(*trajectory.collision.point, zorder=8, **_HIT_LOOK)
        shown[HIT] = _sample(_HIT_LOOK)


def _sample(look: _Look) -> Line2D:
    return Line2D([], [], **look)
