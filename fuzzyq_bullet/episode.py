"""One episode: a scenario and a planner become a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.drives import Driver, KinematicDriver, WheelsDriver
from fuzzyq_bullet.drives.velocity_controller import Twist
from fuzzyq_bullet.drives.wheels import DECISIONS_A_SECOND
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning import Decision, Observation, Planner
from fuzzyq_bullet.planning.commands import (
    Answer,
    CommandSettings,
    TwistCommand,
    WheelCommand,
    equivalent,
    twist_of,
)
from fuzzyq_bullet.planning.consult import ask, build_planner, closing, refusal
from fuzzyq_bullet.planning.controllers import fields_of
from fuzzyq_bullet.planning.decision import DecisionError, checked
from fuzzyq_bullet.planning.traffic.guard import Guard
from fuzzyq_bullet.recording.trajectory import Outcome, Trajectory
from fuzzyq_bullet.scenario import check, realise
from fuzzyq_bullet.scenario.fields import refuse_other_field
from fuzzyq_bullet.scenario.models import Limits, Scenario

Progress: TypeAlias = Callable[[float, float], None]
"""Called after every decision with the simulated time (s) and the distance to the goal (m)."""
Observer: TypeAlias = Callable[[RobotState, Decision, RobotState], None]
"""Called after every decision with the robot as it was then, the decision, and the robot as it is
when the next one is due. The run waits for it, and is the same whatever it does."""

STUCK_TIME = 15.0
WAITING = 4.0
"""Where things move, a robot may stay at one place for so many times as long: it may wait."""
STUCK_RADIUS = 0.1
"""A robot that stays within this distance (m) for ``STUCK_TIME`` seconds is stuck: longer than it
may take in a narrow place to turn round, try a way twice, and give it up. A robot that is slower
than usual may take as many times longer."""


def run(
    scenario: Scenario, *, progress: Progress | None = None, observer: Observer | None = None
) -> Trajectory:
    """Run one episode and return everything that happened.

    Args:
        scenario: What to run. Use ``scenario.with_options`` to change planner, seed or drive.
        progress: Called after every decision.
        observer: Likewise, with what it led to.

    Raises:
        UserError: If the scenario cannot be run: overlaps, or obstacles that cannot be placed.
        PlannerError: If the planner raises, exits or decides what cannot be carried out.
    """
    scenario = realise(scenario)
    check(scenario)
    return run_with(planner_of(scenario), scenario, progress=progress, observer=observer)


def planner_of(scenario: Scenario) -> Planner:
    """Build the planner that a realised scenario asks for, for one episode.

    Raises:
        UserError: If there is no such planner, or its policy cannot be used, as one that was
            learned in another field.
        PlannerError: If building it fails.
    """
    # The first stream of the seed places the obstacles; the planner has the second to itself.
    rng = np.random.default_rng(np.random.SeedSequence(scenario.seed, spawn_key=(1,)))
    refuse_other_field(scenario)
    return build_planner(scenario.planner, rng)


def run_with(
    planner: Planner,
    scenario: Scenario,
    *,
    progress: Progress | None = None,
    observer: Observer | None = None,
) -> Trajectory:
    """Run one episode of a realised scenario with a planner, whichever the scenario names.

    Raises:
        PlannerError: If the planner raises, exits or decides what cannot be carried out.
    """
    with world_of(scenario) as world:
        return run_in(world, scenario, planner, progress=progress, observer=observer)


def world_of(scenario: Scenario, engine: Engine | None = None) -> SensorWorld:
    """Build the world of a realised scenario, with a robot to be touched if wheels drive it.

    Args:
        scenario: The scenario.
        engine: An engine to build in, emptied first; by default a new one that the world owns.
    """
    build = World if scenario.drive == "wheels" else SensorWorld
    return build(scenario.obstacles, scenario.arena, engine=engine, model=scenario.robot.spec)


def run_in(
    world: SensorWorld,
    scenario: Scenario,
    planner: Planner,
    *,
    progress: Progress | None = None,
    observer: Observer | None = None,
) -> Trajectory:
    """Run one episode of a realised scenario in a world that is already built for it.

    Raises:
        ValueError: If the world is not that of the scenario, or there to be seen only although
            the scenario is to be driven by wheels.
        PlannerError: If the planner raises, exits or decides what cannot be carried out.
    """
    name = scenario.planner.name
    with closing(planner, name):
        episode = Episode(world, scenario)
        while episode.outcome is None:
            before, observation = episode.now, episode.observe()
            answer = ask(planner, observation, name)
            try:
                decision = episode.carry_out(answer, observation)
            except DecisionError as error:
                raise refusal(planner, observation, name, error) from error
            if progress is not None:
                now = episode.now
                progress(now.time, math.dist((now.x, now.y), scenario.goal.position))
            if observer is not None:
                observer(before, decision, episode.now)
        return episode.record()


class Episode:
    """An episode that whoever holds it drives, a decision at a time.

    Args:
        world: A world that is built for the scenario; the kinematic drive only looks at it.
        scenario: A realised scenario.
        patience: How long the robot may stay at one place before it counts as stuck (s); a slow
            robot may stay longer.
        rate: Decisions a second on wheels, at most 80; each must last a whole number of physics
            steps of 1/240 s. By default that of the scenario's planner, or 20.

    Raises:
        ValueError: If the world was built of other obstacles or another arena, there is nothing
            in it for wheels to drive on, or the rate is not allowed.

    Attributes:
        outcome: How it ended; None while it goes on.
    """

    def __init__(
        self,
        world: SensorWorld,
        scenario: Scenario,
        *,
        patience: float = STUCK_TIME,
        rate: float | None = None,
    ) -> None:
        if (world.obstacles, world.arena) != (scenario.obstacles, scenario.arena):
            raise ValueError(f"the world was not built for the scenario {scenario.name}")
        self._scenario = scenario
        self._fields = fields_of(scenario.planner)
        self._field = world.field
        own = scenario.planner if isinstance(scenario.planner, CommandSettings) else None
        self._guard = Guard() if own is not None and own.guard else None
        rate = rate or (own.rate if own else DECISIONS_A_SECOND)
        self._driver = _driver(world, scenario, rate)
        self._decisions: list[tuple[int, Decision]] = []
        self._asked: dict[int, Twist] = {}
        if scenario.movers:
            patience *= WAITING
        self._standstill = _Standstill(self.now, patience * self._driver.slowness)
        self.outcome: Outcome | None = None

    @property
    def now(self) -> RobotState:
        """The latest tick."""
        return self._driver.ticks[-1]

    def observe(self) -> Observation:
        """Return what a planner may know now."""
        return self._driver.observe()

    def carry_out(self, answer: Answer, observation: Observation) -> Decision:
        """Carry out whatever a planner answered until the next one is due, or the episode is over.

        Args:
            answer: A decision, a twist or speeds of the wheels. The safety filter limits it if the
                settings of the scenario's planner say so.
            observation: What the planner saw.

        Returns:
            What went on record: of a twist, the decision that leads to the same.

        Raises:
            DecisionError: If it cannot be carried out.
            ValueError: If the episode is over already.
        """
        if not isinstance(answer, TwistCommand | WheelCommand):
            if self._guard is not None:
                answer = self._guard.limit_decision(checked(answer, self._fields), observation)
            self.advance(answer)
            return answer
        motion = observation.motion
        asked = limited = twist_of(answer, motion)
        assert motion is not None  # else it was refused
        told = equivalent(asked, observation, motion)
        if self._guard is not None:
            limited, free = self._guard.limit_twist(asked, observation, motion)
            told = equivalent(limited, observation, motion)._replace(guard=free)
        told = checked(told, self._fields)
        self._asked[len(self._decisions)] = Twist(asked.speed, asked.turn_rate)
        self.steer(Twist(limited.speed, limited.turn_rate), told)
        return told

    def advance(self, decision: Decision) -> None:
        """Carry out a decision until the next one is due, or the episode is over.

        Raises:
            DecisionError: If it cannot be carried out.
            ValueError: If the episode is over already.
        """
        decision = self._note(decision)
        self._driver.advance(decision)
        self._judge(decision)

    def steer(self, twist: Twist, told: Decision) -> None:
        """Hold a twist for as long as a decision lasts, or until the episode is over.

        Args:
            twist: What the wheels aim for.
            told: What goes on record where a planner's decision would; it moves nothing.

        Raises:
            ValueError: In the kinematic drive, which has no wheels; if the twist is not finite, or
                the episode is over already.
        """
        if not all(map(math.isfinite, twist)):
            raise ValueError(f"a twist must be finite, got {tuple(twist)}")
        if not isinstance(self._driver, WheelsDriver):
            raise ValueError(f"a twist needs the drive wheels, not {self._scenario.drive}")
        told = self._note(told)
        self._driver.steer(twist)
        self._judge(told)

    def record(self) -> Trajectory:
        """Return the trajectory of an episode that is over.

        Raises:
            ValueError: If it is not.
        """
        if self.outcome is None:
            raise ValueError("the episode is not over")
        return self._recorded(self._decisions, self.outcome)

    def so_far(self, told: Decision) -> Trajectory:
        """Return what has happened until now, for a picture of it.

        Args:
            told: What is shown of this instant, as if it were decided now.

        Returns:
            A trajectory; while the episode goes on, one that the time has run out for.
        """
        decisions = [*self._decisions, (len(self._driver.ticks) - 1, checked(told, self._fields))]
        return self._recorded(decisions, self.outcome or "timeout")

    def _recorded(self, decisions: list[tuple[int, Decision]], outcome: Outcome) -> Trajectory:
        driver = self._driver
        return Trajectory.from_episode(
            self._scenario,
            self._field,
            driver.ticks,
            decisions,
            outcome=outcome,
            physics_steps=driver.steps,
            collision=driver.collision,
            movers=driver.poses,
            twists=self._asked,
        )

    def _note(self, decision: Decision) -> Decision:
        if self.outcome is not None:
            raise ValueError(f"the episode is over ({self.outcome}); begin another")
        decision = checked(decision, self._fields)
        self._decisions.append((len(self._driver.ticks) - 1, decision))
        return decision

    def _judge(self, decision: Decision) -> None:
        """See whether the episode is over."""
        count, limits = len(self._decisions), self._scenario.limits
        self.outcome = _outcome(self._driver, decision, count, limits, self._standstill)


def _driver(world: SensorWorld, scenario: Scenario, rate: float) -> Driver:
    if scenario.drive == "kinematic":
        return KinematicDriver(world, scenario)
    if not isinstance(world, World):
        raise ValueError(f"the drive {scenario.drive} needs a world that can be touched")
    return WheelsDriver(world, scenario, rate)


class _Standstill:
    """Notices that the robot has stayed about one place for too long."""

    def __init__(self, start: RobotState, patience: float) -> None:
        self._anchor = start
        self._patience = patience

    def lasts(self, now: RobotState) -> bool:
        """Return whether the robot has been near one place for too long by now."""
        anchor = self._anchor
        if math.hypot(now.x - anchor.x, now.y - anchor.y) > STUCK_RADIUS:
            self._anchor = now
            return False
        return now.time - anchor.time >= self._patience


def _outcome(
    driver: Driver, last: Decision, count: int, limits: Limits, standstill: _Standstill
) -> Outcome | None:
    now = driver.ticks[-1]
    if driver.collision is not None:
        return "collision"
    if driver.arrived:
        return "goal"
    if standstill.lasts(now) or last.hopeless:
        return "stuck"
    if now.time >= limits.time or count >= limits.steps:
        return "timeout"
    return None
