"""Why the robot turns, in one plain sentence that is true of the numbers beside it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.video.timeline import NO_DECISION

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Decisions, Trajectory

STRAIGHT = math.radians(5.0)
"""A smaller turn is called straight on (rad)."""
ALIKE = 0.03
"""Sides whose lengths differ by less are called alike (m)."""
_HELD_BACK = math.radians(2.0)
"""A heading that differs by more from the controller's (rad) is not the controller's."""
_STANDS = 1e-6
"""A shorter step (m) is none."""
_BACK = math.radians(110.0)
"""A heading farther than this from the line to the goal leads back (rad)."""
_FACING = math.radians(2.0)
"""A robot this near to its new heading (rad) need not turn on the spot."""
_SLOW = 0.05
"""A slower robot (m/s) is on the spot."""
_MOST_ROOM = 5.0 - 1e-9
"""d, in steps, where nothing was met."""


def reason(trajectory: Trajectory, index: int) -> str:
    """Return why decision ``index`` turns the robot as it does."""
    if index == NO_DECISION:
        return "Waits for its first decision"
    decisions = trajectory.decisions
    mode = MODES[int(decisions.mode[index])]
    if mode == "routine":
        return _steers(trajectory, index)
    if not math.isfinite(float(decisions.target[index].sum())) and (
        float(decisions.step[index]) < _STANDS
    ):
        return "Finds no way on: stops"
    if mode == "breakout":
        return _breaks_out(trajectory, index)
    return _goes_on(trajectory, index)


def side_of(trajectory: Trajectory, index: int) -> int:
    """Return on which side of the line to the goal a decision leads: 1 left, −1 right, 0 neither.

    The way back is on neither side.
    """
    lean = _lean(trajectory, index)
    return 0 if not STRAIGHT <= abs(lean) <= _BACK else (1 if lean > 0.0 else -1)


def is_asked(decisions: Decisions, index: int) -> bool:
    """Whether the controller's rules had a say in a decision, and not a way out in their place."""
    return MODES[int(decisions.mode[index])] == "routine"


def off_goal_line(decisions: Decisions, index: int) -> float:
    """Return how far (rad) the decided heading lies left of the middle line."""
    return math.remainder(
        float(decisions.heading[index]) - float(decisions.lines[index, 1]), math.tau
    )


def is_clear(decisions: Decisions, index: int) -> bool:
    """Whether nothing stood between robot and goal, so that the controller heard of no sides."""
    return float(decisions.difference[index]) == 0.0 and (
        float(decisions.distance[index]) >= _MOST_ROOM
    )


def struck(trajectory: Trajectory) -> str:
    """Return what the robot collided with, by kind and place; empty if it did not."""
    hit = trajectory.collision
    if hit is None:
        return ""
    if hit.obstacle < 0:
        return "a wall"
    obstacle = trajectory.scenario.obstacles[hit.obstacle]
    x, y = (round(v, 1) + 0.0 for v in obstacle.position)
    return f"the {obstacle.shape} at ({x:.1f}, {y:.1f})".replace("-", "−")


def _turn(trajectory: Trajectory, index: int) -> float:
    """Return by how much (rad) a decision turns the robot from where it faced."""
    decisions = trajectory.decisions
    facing = float(trajectory.ticks.heading[int(decisions.tick[index])])
    return math.remainder(float(decisions.heading[index]) - facing, math.tau)


def _lean(trajectory: Trajectory, index: int) -> float:
    """Return how far left of the goal line a decision leads (rad); else from where it faced."""
    lean = off_goal_line(trajectory.decisions, index)
    return lean if math.isfinite(lean) else _turn(trajectory, index)


def _goes_on(trajectory: Trajectory, index: int) -> str:
    """Return where the robot goes that is on its way from frontier to frontier."""
    decisions = trajectory.decisions
    if float(decisions.reach[index]) <= 0.0:
        if float(trajectory.ticks.speed[int(decisions.tick[index])]) > _SLOW:
            return "Brakes first: no room for a wide turn"
        if abs(_turn(trajectory, index)) > _FACING:
            return "Turns on the spot: no room for a wide turn"
    lean = _lean(trajectory, index)
    if abs(lean) < STRAIGHT:
        return "Goes on to where the way may lead on"
    if abs(lean) > _BACK:
        return "Goes back to a way not tried yet"
    return f"Goes round the obstacle by the {_side(lean)}"


def _breaks_out(trajectory: Trajectory, index: int) -> str:
    decisions, unit = trajectory.decisions, trajectory.scenario.robot.radius
    ahead = float(decisions.lengths[index, 1])
    lean = off_goal_line(decisions, index)
    way = lean if math.isfinite(lean) else _turn(trajectory, index)
    side = "straight ahead" if abs(way) < STRAIGHT else "to the " + _side(way)
    if not math.isfinite(ahead) or ahead < unit:
        because = "Blocked ahead"
    elif ahead < float(decisions.breakout_at[index]) * unit:
        because = f"Blocked {ahead:.1f} m ahead"
    else:
        because = "Comes no nearer"
    return f"{because}: breaks out {side}"


def _steers(trajectory: Trajectory, index: int) -> str:
    """Return why the routine part turns as it does."""
    decisions = trajectory.decisions
    turn = _turn(trajectory, index)
    left, ahead, right = decisions.lengths[index].tolist()
    lean = off_goal_line(decisions, index)
    if not all(map(math.isfinite, (left, ahead, right, lean))):
        return "Drives straight on" if abs(turn) < STRAIGHT else f"Turns {_side(turn)}"

    clear = is_clear(decisions, index)
    wanted = _wanted(trajectory, index)
    if abs(math.remainder(lean - wanted, math.tau)) > _HELD_BACK:
        if abs(lean) < 1e-6:  # the way out that has been promised is taken, whatever the sides
            return f"Line to the goal leads on ({ahead:.1f} m): {_to_goal(turn)}"
        because = "Way is clear" if clear else f"{ahead:.1f} m ahead"
        return f"{because}, but no room yet to turn so far: brakes first"
    if clear:
        return "Way is clear: " + _to_goal(turn)

    if abs(left - right) < ALIKE:
        if abs(lean) >= STRAIGHT:
            return f"Blocked {ahead:.1f} m ahead: {_bends(turn, lean)}"
        return f"Both sides alike ({_both(left, right)}), {ahead:.1f} m ahead: {_to_goal(turn)}"
    freer, room, other = ("left", left, right) if left > right else ("right", right, left)
    digits = 1 if f"{room:.1f}" != f"{other:.1f}" else 2
    because = f"{freer.capitalize()} is freer ({room:.{digits}f} m against {other:.{digits}f} m)"
    if abs(lean) < STRAIGHT:
        return f"{because}, {ahead:.1f} m ahead: {_to_goal(turn, nearly=True)}"
    if _side(lean) != freer:
        who = "the rules lead" if math.isfinite(float(decisions.turn[index])) else "it goes"
        return f"{because}, yet {who} {_side(lean)}"
    return f"{because}: {_bends(turn, lean)}"


def _wanted(trajectory: Trajectory, index: int) -> float:
    """Return the controller's turn off the line to the goal (rad), of Eqs. 15 to 17."""
    decisions = trajectory.decisions
    unit = getattr(trajectory.scenario.planner, "turn_unit", None)
    turn = float(decisions.turn[index] * decisions.weights[index, 1])
    if unit is None or not math.isfinite(turn):
        return off_goal_line(decisions, index)
    return turn * float(unit)


def _bends(turn: float, lean: float) -> str:
    """Say what becomes of the robot's direction when it is to lie on one side of the goal line."""
    if abs(turn) < STRAIGHT:
        return f"keeps {_side(lean)}"
    return f"turns {_side(lean)}" if turn * lean > 0.0 else f"keeps {_side(lean)}, a little less"


def _both(left: float, right: float) -> str:
    if f"{left:.1f}" == f"{right:.1f}":
        return f"{left:.1f} m"
    return f"{left:.2f} m and {right:.2f} m"


def _to_goal(turn: float, *, nearly: bool = False) -> str:
    about = "nearly " if nearly else ""
    if abs(turn) < STRAIGHT:
        return f"{about}straight to the goal"
    return f"turns {_side(turn)}, {about}to the goal"


def _side(turn: float) -> str:
    return "left" if turn > 0.0 else "right"
