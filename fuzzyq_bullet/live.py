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

from fuzzyq_bullet.episode import planner_of, run_in, world_of
from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.physics.camera import Mesh
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.window import Line, Window, WindowClosed
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.recording.moving import Floats, first_poses, poses_between
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario, check, realise
from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.captions import outcome_lines
from fuzzyq_bullet.video.decision_hold import HOLD
from fuzzyq_bullet.video.explanation import reason
from fuzzyq_bullet.video.map.footprints import arrow
from fuzzyq_bullet.video.movers import nose_size
from fuzzyq_bullet.video.scene import meshes
from fuzzyq_bullet.video.scene.solid_movers import body_of, nose_of

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Simulated seconds in a second, to which the keys for slower and faster go."""
PAUSE, STEP, FASTER, SLOWER, QUIT = " ", "s", "=+", "-", "q"
"""The keys; ``+`` is where ``=`` is on many keyboards, and may do without the shift key."""
KEYS = "space: pause   s: one decision   +/-: faster, slower   q: quit"

_FRAME = 1.0 / 30.0
_LEAST_WAY = 1e-6
"""What moves less from decision to decision (m) stands."""
_AWAY = (1e4, 0.0, 0.0)
"""Where the arrow is of what goes nowhere: out of sight."""
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
        moved: Sequence[Sequence[float]] = (),
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
    moving = moving_meshes(scenario)
    with (
        Window(still, robot, moving, background=style.PAGE, paint=style.ROBOT) as window,
        world_of(scenario) as world,
    ):
        spectator = Spectator(window, scenario, speed, movers=world.movers.poses)
        planner = planner_of(scenario)
        trajectory = run_in(world, scenario, planner, observer=spectator)
        if stay:
            with suppress(WindowClosed):
                spectator.stay(trajectory)
    return trajectory


def still_meshes(scenario: Scenario) -> list[Mesh]:
    """Return ground, walls, what stands, via points and goal of a realised scenario, as filmed."""
    everywhere = meshes.EVERYWHERE
    return [
        *meshes.solids(
            meshes.ground_of(scenario, everywhere),
            [piece for obstacle in scenario.standing for piece in obstacle.pieces()],
            meshes.walls_of(scenario, everywhere),
            meshes.goal_disc(scenario),
        ),
        *meshes.heading_mark(scenario),
        *(meshes.disc(via.position, via.radius) for via in scenario.via),
        meshes.pole(scenario.goal.position, 1.0),
    ]


def moving_meshes(scenario: Scenario) -> list[Mesh]:
    """Return the solid of each moving obstacle, and the arrow on it, each about the origin."""
    found = []
    for index in scenario.movers:
        shape = scenario.obstacles[index]
        pieces = [piece - np.asarray(shape.position) for piece in shape.pieces()]
        found += [body_of(pieces), nose_of(arrow((0.0, 0.0), 0.0, nose_size(shape)))]
    return found


class Spectator:
    """Shows an episode's decisions, each for as long as it lasts.

    Args:
        window: Where to show them.
        scenario: The realised scenario.
        speed: Simulated seconds in a second, to begin with.
        clock: Returns the time (s).
        sleep: Waits for some time (s).
        movers: Returns where the moving obstacles are now, shape (M, 3); see ``Trajectory.movers``.
    """

    def __init__(
        self,
        window: Screen,
        scenario: Scenario,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        movers: Callable[[], Floats] | None = None,
    ) -> None:
        self._window = window
        self._scenario = scenario
        self._field = Field.of(scenario.standing, scenario.arena)
        first = first_poses(scenario)
        self._movers = movers or (lambda: first)
        self._poses = (first, first)  # at the latest two decisions
        self._headings = np.full(len(first), np.nan)
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
        self._poses = self._poses[1], self._movers()
        self._headings = self._headings_now()
        self._passed.append((before.x, before.y))
        self._lines = self._lines_of(before, decision)
        ruled = bool(np.isfinite(decision.rules).any())
        # Without rules it has no routine part: the first line says what planner it is.
        mode = decision.mode if ruled or decision.mode != "routine" else ""
        self._why = mode, reason(self._at_once(before, decision, now), 0)
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
            moved=self._moved(part),
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

    def _headings_now(self) -> Floats:
        """Return where the moving obstacles go (rad); what halts keeps the direction it had."""
        dx, dy, _ = (self._poses[1] - self._poses[0]).T
        return np.where(np.hypot(dx, dy) > _LEAST_WAY, np.arctan2(dy, dx), self._headings)

    def _moved(self, part: float) -> list[tuple[float, float, float]]:
        """Return the poses of all moving solids: of each obstacle, and of its arrow."""
        found = []
        poses = poses_between(*self._poses, part).tolist()
        for (x, y, turn), heading in zip(poses, self._headings.tolist(), strict=True):
            found += [(x, y, turn), _AWAY if math.isnan(heading) else (x, y, heading)]
        return found

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

    def _at_once(self, before: RobotState, decision: Decision, now: RobotState) -> Trajectory:
        """Return a record of this decision alone, which is explained as those of a whole run."""
        return Trajectory.from_episode(
            self._scenario,
            self._field,
            [before, now],
            [(0, decision)],
            outcome="timeout",
            physics_steps=0,
            collision=None,
            movers=self._poses,
        )
