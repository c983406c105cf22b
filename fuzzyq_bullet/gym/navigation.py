"""``fuzzyq_bullet/Navigation-v0``: a policy drives the robot itself, by its twist."""

from __future__ import annotations

import math
from typing import ClassVar

from fuzzyq_bullet.drives.velocity_controller import Twist
from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.gym.env import HOLD, EpisodeEnv, goal_seen, motion_seen
from fuzzyq_bullet.gym.tasks import DEFAULT_COUNT, Count, Source, TaskSource
from fuzzyq_bullet.planning import Decision, Observation
from fuzzyq_bullet.scenario import Scenario

LINE_ANGLE = math.radians(45.0)
"""α: angle of the left and right detection lines from the middle one (rad)."""

_LEAST = {
    "left": 0.0,
    "middle": 0.0,
    "right": 0.0,
    "ahead_left": 0.0,
    "ahead": 0.0,
    "ahead_right": 0.0,
    "goal_ahead": -1.0,
    "goal_left": -1.0,
    "goal_distance": 0.0,
    "speed": -1.0,
    "turn_rate": -1.0,
}


class NavigationEnv(EpisodeEnv):
    """The robot is driven by its twist, which is held for 0.3 s within its acceleration.

    Action, shape (2,), each from −1 to 1:
        0. Forward speed: −1 stands, 1 is the greatest speed. It never backs up.
        1. Turn rate: −1 is the greatest to the right, 1 the greatest to the left.

    Observation, float32, shape (11,):
        0. to 2. ``left``, ``middle``, ``right``: free lengths of the planner's three detection
           lines, the middle one to the goal, the others 45° off; from 0 to 1, the range of 1 m.
        3. to 5. ``ahead_left``, ``ahead``, ``ahead_right``: the same about where the robot faces.
        6. ``goal_ahead``: cosine of the angle from where the robot faces to the goal, −1 to 1.
        7. ``goal_left``: sine of that angle, −1 to 1, positive to the left.
        8. ``goal_distance``: d / (d + 5 m), 0 to 1, d the distance to the goal's centre.
        9. ``speed``: forward, over the greatest speed, −1 to 1.
        10. ``turn_rate``: over the greatest, −1 to 1, positive to the left.

    In the goal the robot stops by itself.

    Args:
        scenario: A scenario, its file, or the name of a bundled one: every episode is about it, and
            what it asks to be ``random`` is drawn anew. Its drive and planner do not matter. By
            default every episode is a random task that has a way.
        count: Obstacles of a random task, 0 to 150, or the least and the most as a pair.
        render_mode: ``rgb_array``, or None for no pictures.

    Raises:
        UserError: If one of them is not allowed.
    """

    rate: ClassVar[float] = 1.0 / HOLD

    def __init__(
        self,
        *,
        scenario: Source = None,
        count: Count = DEFAULT_COUNT,
        render_mode: str | None = None,
    ) -> None:
        tasks = TaskSource(scenario=scenario, count=count, drive="wheels")
        super().__init__(tasks, _LEAST, render_mode=render_mode)

    def _begin(self, scenario: Scenario) -> None:
        self._robot = scenario.robot

    def _see(self, episode: Episode) -> dict[str, float]:
        now = episode.observe()
        bearing = math.atan2(now.goal[1] - now.position[1], now.goal[0] - now.position[0])
        fan = (LINE_ANGLE, 0.0, -LINE_ANGLE)
        headings = [about + aside for about in (bearing, now.heading) for aside in fan]
        lengths = now.sense(headings)
        self._now: Observation = now
        self._lines, self._lengths = headings[:3], lengths[:3]
        free = dict(zip(_LEAST, (length / now.range for length in lengths), strict=False))
        return {**free, **goal_seen(now), **motion_seen(now, self._robot)}

    def _act(self, episode: Episode, first: float, second: float) -> None:
        robot = self._robot
        twist = Twist((first + 1.0) / 2.0 * robot.max_speed, second * robot.max_turn_rate)
        episode.steer(twist, self._told(twist))

    def _shown(self) -> Decision:
        return self._told(Twist(self._now.speed, self._now.turn_rate))

    def _told(self, twist: Twist) -> Decision:
        """Return what goes on record: where a twist leads until the next one, and what was seen."""
        motion = self._now.motion
        assert motion is not None  # the wheels have one
        return Decision(
            heading=self._now.heading + twist.turn_rate * motion.period,
            step=max(0.0, twist.speed) * motion.period,
            lines=self._lines,
            lengths=self._lengths,
        )
