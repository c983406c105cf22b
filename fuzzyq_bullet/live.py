"""An episode seen as it happens: in real time, slower, faster, or a decision at a time.

The episode is driven as ever, and calls its spectator after each decision. The spectator keeps it
waiting for as long as the decision lasts, and shows meanwhile what it led to.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol

import numpy as np

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.physics.camera import Mesh
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.window import Line, Window, WindowClosed
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.scenario import Scenario, check, realise
from fuzzyq_bullet.trajectory import Trajectory
from fuzzyq_bullet.video import meshes, style
from fuzzyq_bullet.video.captions import outcome_lines
from fuzzyq_bullet.video.decision_hold import HOLD
from fuzzyq_bullet.video.explanation import reason

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Simulated seconds in a second, to which the keys for slower and faster go."""
PAUSE, STEP, FASTER, SLOWER, QUIT = " ", "s", "=+", "-", "q"
"""The keys; ``+`` is where ``=`` is on many keyboards, and may do without the shift key."""
KEYS = "space: pause   s: one decision   +/-: faster, slower   q: quit"

_FRAME = 1.0 / 30.0
_LONGEST_GAP = 0.25
"""Longest time (s) between two frames that is made up for."""


class Screen(Protocol):
    """What the spectator needs of a window."""

    def draw(
        self,
        position: tuple[float, float],
        heading: float,
        lines: Sequence[Line] = (),
        *,
        passed: Sequence[tuple[float, float]] = (),
        above: Sequence[str] = (),
        below: Sequence[str] = (),
    ) -> str:
        """Show the robot and what it senses; return the keys that were pressed."""
        ...


def watch(scenario: Scenario, *, speed: float = 1.0, stay: bool = True) -> Trajectory:
    """Run one episode in PyBullet's window and return everything that happened.

    It happens as in ``episode.run``, to the last bit.

    Args:
        scenario: What to run.
        speed: Simulated seconds in a second.
        stay: Whether the window stays when the run is over, until somebody closes it.

    Raises:
        UserError: If the scenario cannot be run, or there is no screen to open a window on.
        PlannerError: If the planner raises, exits or decides what cannot be carried out.
        WindowClosed: If the window is closed before the run is over.
    """
    scenario = realise(scenario)
    check(scenario)
    still, robot = still_meshes(scenario), scenario.robot.spec
    with Window(still, robot, background=style.PAGE, paint=style.ROBOT) as window:
        spectator = Spectator(window, scenario, speed)
        trajectory = run(scenario, observer=spectator)
        if stay:
            with suppress(WindowClosed):
                spectator.stay(trajectory)
    return trajectory


def still_meshes(scenario: Scenario) -> list[Mesh]:
    """Return ground, walls, obstacles, via points and goal of a realised scenario, as filmed."""
    everywhere = meshes.EVERYWHERE
    return [
        *meshes.solids(
            meshes.ground_of(scenario, everywhere),
            [piece for obstacle in scenario.obstacles for piece in obstacle.pieces()],
            meshes.walls_of(scenario, everywhere),
            meshes.goal_disc(scenario),
        ),
        *meshes.heading_mark(scenario),
        *(meshes.disc(via.position, via.radius) for via in scenario.via),
        meshes.pole(scenario.goal.position, 1.0),
    ]


class Spectator:
    """Shows an episode's decisions, each for as long as it lasts.

    Args:
        window: Where to show them.
        scenario: The realised scenario.
        speed: Simulated seconds in a second, to begin with.
        clock: Returns the time (s).
        sleep: Waits for some time (s).
    """

    def __init__(
        self,
        window: Screen,
        scenario: Scenario,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._window = window
        self._scenario = scenario
        self._field = Field.of(scenario.obstacles, scenario.arena)
        self._clock, self._sleep = clock, sleep
        self._speed = speed
        self._paused = self._one_step = False
        self._last: RobotState | None = None
        self._passed: list[tuple[float, float]] = []
        self._shown, self._looked = 0.0, clock()
        self._due = True
        self._why = self._said = ("", "")  # the mode and the sentence: of now, and shown
        self._since = -math.inf
        self._lines: tuple[Line, ...] = ()

    def __call__(self, before: RobotState, decision: Decision, now: RobotState) -> None:
        """Show what a decision has led to, in the time that it lasts.

        Raises:
            WindowClosed: If somebody closes the window, or presses the key for it.
        """
        self._last = now
        self._passed.append((before.x, before.y))
        self._lines = self._lines_of(before, decision)
        self._why = decision.mode, reason(self._at_once(before, decision), 0)
        while True:
            if self._due:
                if self._shown > now.time:
                    return  # it is due within a later decision
                self._show(before, now)
                self._due = False
            if self._one_step:
                self._one_step, self._paused, self._due = False, True, True
                self._shown = now.time
                return
            self._wait()

    def stay(self, trajectory: Trajectory) -> None:
        """Show how it ended until somebody closes the window.

        Raises:
            WindowClosed: When somebody does.
        """
        title, figures = outcome_lines(trajectory)
        self._why = self._why[0], f"{title}   {figures}"
        self._since = -math.inf
        last = self._last
        while last is not None:
            self._wait()
            self._show(last, last, over=True)

    def _wait(self) -> None:
        """Wait until a frame is due, and move on by what has passed unless the run is paused."""
        self._sleep(max(0.0, self._looked + _FRAME - self._clock()))
        now = self._clock()
        passed, self._looked = min(now - self._looked, _LONGEST_GAP), now
        if not self._paused:
            self._shown += passed * self._speed
        self._due = True

    def _show(self, before: RobotState, now: RobotState, *, over: bool = False) -> None:
        """Draw the robot on its way between two states, and do what the keys say."""
        span = now.time - before.time
        part = min(1.0, (self._shown - before.time) / span) if span > 0.0 else 1.0
        turn = wrap_angle(now.heading - before.heading)
        scenario = self._scenario
        pace = "" if over else "paused   " if self._paused else f"{self._speed:g}x   "
        mode, sentence = self._explained()
        keys = self._window.draw(
            (before.x + part * (now.x - before.x), before.y + part * (now.y - before.y)),
            before.heading + part * turn,
            self._lines,
            passed=self._passed,
            above=(
                f"{scenario.name}   {scenario.planner.name}   seed {scenario.seed}",
                "q: close" if over else KEYS,
            ),
            below=(f"{before.time + part * span:.1f} s   {pace}{mode}", sentence),
        )
        self._passed = []
        for key in keys:
            self._press(key)

    def _press(self, key: str) -> None:
        if key == QUIT:
            raise WindowClosed
        if key == PAUSE:
            self._paused = not self._paused
        elif key == STEP:
            self._one_step = True
        elif key in FASTER:
            self._speed = min((one for one in SPEEDS if one > self._speed), default=self._speed)
        elif key == SLOWER:
            self._speed = max((one for one in SPEEDS if one < self._speed), default=self._speed)

    def _explained(self) -> tuple[str, str]:
        """Return the mode and why the robot heads where it does, each for long enough to be read.

        In a pause, and of another mode, it is told at once.
        """
        at_once = self._paused or self._why[0] != self._said[0]
        if self._why != self._said and (at_once or self._looked - self._since >= HOLD):
            self._said, self._since = self._why, self._looked
        return self._said

    def _lines_of(self, before: RobotState, decision: Decision) -> tuple[Line, ...]:
        """Return the detection lines, as far as the front of the robot could go along each."""
        if not np.isfinite([*decision.lines, *decision.lengths]).all():
            return ()
        radius = self._scenario.robot.radius
        return tuple(
            Line(
                (before.x, before.y),
                (
                    before.x + (radius + length) * math.cos(heading),
                    before.y + (radius + length) * math.sin(heading),
                ),
                colour,
            )
            for heading, length, colour in zip(
                decision.lines, decision.lengths, style.LINES, strict=True
            )
        )

    def _at_once(self, before: RobotState, decision: Decision) -> Trajectory:
        """Return a record of this decision alone, which is explained as those of a whole run."""
        return Trajectory.from_episode(
            self._scenario,
            self._field,
            [before],
            [(0, decision)],
            outcome="timeout",
            physics_steps=0,
            collision=None,
        )
