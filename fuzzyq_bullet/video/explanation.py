"""Why the robot heads where it does, in one plain sentence that is true of the numbers beside it.

Sentence and panels have one reference: the direction of the aim, which is that of the middle line.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.rules_turn import asked, controller_turns
from fuzzyq_bullet.video.approach import approaching
from fuzzyq_bullet.video.timeline import NO_DECISION, sensor_range

if TYPE_CHECKING:
    from fuzzyq_bullet.quantities import Point
from fuzzyq_bullet.recording.trajectory import Decisions, Trajectory

STRAIGHT = math.radians(5.0)
"""A heading no farther off the aim is called straight to it (rad)."""
ALIKE = 0.03
"""Sides whose lengths differ by less are called alike (m)."""
_HELD_BACK = math.radians(2.0)
"""A heading that differs by more from the controller's (rad) is not the controller's."""
_STANDS = 1e-6
"""A shorter step or reach (m) is none."""
_BACK = math.radians(110.0)
"""A heading farther than this off the aim leads away from it (rad)."""
_FACING = math.radians(2.0)
"""A robot this near to its new heading (rad) need not turn on the spot."""
_SLOW = 0.05
"""A slower robot (m/s) is on the spot."""
_MOST_ROOM = 5.0 - 1e-9
"""d, in steps, where nothing was met."""


def reason(trajectory: Trajectory, index: int) -> str:
    """Return why decision ``index`` heads where it does."""
    if index == NO_DECISION:
        return "Waits for its first decision"
    if ends := _ends(trajectory, index):
        return ends
    decisions = trajectory.decisions
    mode = MODES[int(decisions.mode[index])]
    if makes_way := _makes_way(trajectory, index):
        return makes_way
    if mode != "routine":
        stands = min(float(decisions.step[index]), float(decisions.reach[index])) < _STANDS
        if stands and not math.isfinite(float(decisions.target[index].sum())):
            return "Finds no way on: stops"
    if mode == "breakout":
        return "Blocked towards the goal: breaks out"
    return _steers(trajectory, index)


def side_of(trajectory: Trajectory, index: int) -> int:
    """Return on which side of the aim a decision leads: 1 left, −1 right, 0 neither.

    The way back is on neither side.
    """
    lean = off_aim(trajectory, index)
    return 0 if not STRAIGHT <= abs(lean) <= _BACK else (1 if lean > 0.0 else -1)


def is_asked(decisions: Decisions, index: int) -> bool:
    """Whether the controller's rules had a say in a decision."""
    return bool(asked(decisions, index))


def aim_name(trajectory: Trajectory, index: int) -> str:
    """Return what a decision aims at, in words: goal, via point, or the way out."""
    name, position = target_of(trajectory, index)
    aim = trajectory.decisions.aim[index].tolist()
    straight = MODES[int(trajectory.decisions.mode[index])] == "routine"
    if (straight and not gives_way(trajectory, index)) or not math.isfinite(sum(aim)):
        return name
    return name if math.dist(aim, position) < 1e-9 else "the way out"


def gives_way(trajectory: Trajectory, index: int) -> bool:
    """Whether the aim is a temporary goal that keeps the robot clear of what moves."""
    decisions = trajectory.decisions
    routine = MODES[int(decisions.mode[index])] == "routine"
    return routine and math.isfinite(float(decisions.target[index].sum()))


def target_of(trajectory: Trajectory, index: int) -> tuple[str, Point]:
    """Return the target of a decision: what it is called, and where it is (m)."""
    scenario, tick = trajectory.scenario, int(trajectory.decisions.tick[index])
    if scenario.via:
        passed = int(trajectory.via_passed[tick])
        if passed < len(scenario.via):
            name = f"via point {passed + 1} of {len(scenario.via)}"
            return name, scenario.via[passed].position
    return "the goal", scenario.goal.position


def off_aim(trajectory: Trajectory, index: int) -> float:
    """Return how far (rad) the decided heading lies left of the aim: of the middle line if any."""
    decisions = trajectory.decisions
    towards = float(decisions.lines[index, 1])
    if not math.isfinite(towards):
        x, y = trajectory.ticks.position[int(decisions.tick[index])].tolist()
        aim = decisions.aim[index].tolist()
        known = math.isfinite(sum(aim))
        aim_x, aim_y = aim if known else target_of(trajectory, index)[1]
        towards = math.atan2(aim_y - y, aim_x - x)
    return math.remainder(float(decisions.heading[index]) - towards, math.tau)


def is_clear(decisions: Decisions, index: int) -> bool:
    """Whether nothing was seen between robot and goal, so that the controller heard of no sides."""
    return (
        MODES[int(decisions.mode[index])] == "routine"
        and float(decisions.difference[index]) == 0.0
        and float(decisions.distance[index]) >= _MOST_ROOM
    )


def struck(trajectory: Trajectory) -> str:
    """Return what the robot collided with, by kind and place; empty if it did not."""
    hit, scenario = trajectory.collision, trajectory.scenario
    if hit is None:
        return ""
    if hit.obstacle < 0:
        return "a wall"
    obstacle = scenario.obstacles[hit.obstacle]
    what, place = f"the {obstacle.shape}", obstacle.position
    if hit.obstacle in scenario.movers and trajectory.movers.size:
        moved = trajectory.movers[-1, scenario.movers.index(hit.obstacle), :2]
        what, place = f"the moving {obstacle.shape}", tuple(moved.tolist())
    x, y = (round(v, 1) + 0.0 for v in place)
    return f"{what} at ({x:.1f}, {y:.1f})".replace("-", "−")


def _steers(trajectory: Trajectory, index: int) -> str:
    """Return why a decision leads straight to its aim, or to one side of it."""
    decisions = trajectory.decisions
    left, middle, right = decisions.lengths[index].tolist()
    name, lean = aim_name(trajectory, index), off_aim(trajectory, index)
    if not math.isfinite(left + middle + right):
        return _capital(_leads(lean, name))
    unasked = math.isfinite(float(decisions.turn[index])) and not is_asked(decisions, index)
    if unasked and math.isnan(float(decisions.exact[index])):
        return f"On a way out: {_leads(lean, name)}"  # version 0.1.0: the lines point at the goal
    if waits := _waits(trajectory, index, lean):
        return waits
    if unasked:
        if name != "the way out":
            return f"Line to {name} leads on ({middle:.1f} m): {_leads(lean, name)}"
        return "Aims at a gap on the way out: the rules are not asked"
    if is_clear(decisions, index):
        return f"Way is clear: {_leads(lean, name)}"
    if min(left, middle, right) >= sensor_range(trajectory) - 1e-9:
        return f"Nothing in sight: {_leads(lean, name)}"
    if abs(left - right) < ALIKE:
        both = _both(left, right)
        return f"Sides alike ({both}), {middle:.1f} m towards {name}: {_leads(lean)}"
    freer, room, other = ("left", left, right) if left > right else ("right", right, left)
    digits = 1 if f"{room:.1f}" != f"{other:.1f}" else 2
    because = f"{freer.capitalize()} is freer ({room:.{digits}f} m against {other:.{digits}f} m)"
    if abs(lean) < STRAIGHT:
        return f"{because}, {middle:.1f} m towards {name}: nearly straight"
    if _side(lean) != freer:
        ruled = math.isfinite(float(decisions.turn[index]))
        return f"{because}, yet {'the rules lead' if ruled else 'it heads'} {_side(lean)} of {name}"
    return f"{because}: {_leads(lean, name)}"


def _waits(trajectory: Trajectory, index: int, lean: float) -> str:
    """Return why the robot cannot head for where it wants to yet; empty if it can."""
    decisions = trajectory.decisions
    wanted = float(controller_turns(trajectory, index))
    held = abs(math.remainder(lean - wanted, math.tau)) > _HELD_BACK  # never, if not known
    if not held and float(decisions.reach[index]) >= _STANDS:
        return ""
    tick = int(decisions.tick[index])
    if abs(float(trajectory.ticks.speed[tick])) > _SLOW:
        return "No room yet to turn so far: brakes first"
    facing = float(trajectory.ticks.heading[tick])
    turn = math.remainder(float(decisions.heading[index]) - facing, math.tau)
    if abs(turn) > _FACING:
        degrees = f"{math.degrees(abs(turn)):.0f}°"  # from its nose; the dial's is from the aim
        return f"No room for an arc: turns {degrees} {_side(turn)} on the spot"
    return "No room yet to turn so far: slows down" if held else ""


def _ends(trajectory: Trajectory, index: int) -> str:
    """Return what the robot does in the goal, where no decision moves its wheels any more."""
    scenario, tick = trajectory.scenario, int(trajectory.decisions.tick[index])
    goal, passed = scenario.goal, int(trajectory.via_passed[tick])
    away = math.dist(trajectory.ticks.position[tick].tolist(), goal.position)
    if scenario.drive != "wheels" or not goal.stop or passed < len(scenario.via):
        return ""
    if away > goal.radius:
        return ""
    if goal.heading is None:
        return "In the goal: stops"
    off = math.remainder(goal.heading - float(trajectory.ticks.heading[tick]), math.tau)
    return f"In the goal: {'stops' if abs(off) <= goal.tolerance else 'turns to its heading'}"


def _makes_way(trajectory: Trajectory, index: int) -> str:
    """Return that the robot waits for what comes, or gives way to it, if it does."""
    decisions, tick = trajectory.decisions, int(trajectory.decisions.tick[index])
    backs_up = decisions.backward is not None and decisions.backward[index] == 1.0
    if (backs_up or gives_way(trajectory, index)) and float(decisions.reach[index]) >= _STANDS:
        coming = approaching(trajectory, tick)
        if backs_up and not coming and not trajectory.movers.size:
            return "Backs up"
        return f"{coming or 'Something moves near by'}: {'backs up' if backs_up else 'gives way'}"
    if min(float(decisions.step[index]), float(decisions.reach[index])) >= _STANDS:
        return ""
    coming = approaching(trajectory, tick)
    moves = abs(float(trajectory.ticks.speed[tick])) > _SLOW
    return f"{coming}: {'brakes' if moves else 'waits'}" if coming else ""


def _leads(lean: float, name: str = "") -> str:
    """Say where a heading leads that lies so far (rad) left of the aim."""
    if abs(lean) < STRAIGHT:
        return f"straight to {name}" if name else "straight on"
    if abs(lean) > _BACK:
        return f"heads away from {name or 'it'}"
    return f"heads {_side(lean)} of {name or 'it'}"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _both(left: float, right: float) -> str:
    if f"{left:.1f}" == f"{right:.1f}":
        return f"{left:.1f} m"
    return f"{left:.2f} m and {right:.2f} m"


def _side(lean: float) -> str:
    return "left" if lean > 0.0 else "right"
