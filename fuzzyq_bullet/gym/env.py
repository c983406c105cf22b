"""An episode as a Gymnasium environment, whatever is done in it and seen of it."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, TypeAlias

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box
from numpy.typing import NDArray

from fuzzyq_bullet.drives.wheels import DECISIONS_A_SECOND
from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.gym.tasks import TaskSource
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning import Decision, Observation
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Robot, Scenario
from fuzzyq_bullet.training.rewards import USUAL, Transition
from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.timeline import Timeline, sensed_at

Vector: TypeAlias = NDArray[np.float32]

HALFWAY = 5.0
"""Distance (m) that is told as a half."""
HOLD = 0.3
"""How long an action lasts on wheels (s)."""


class EpisodeEnv(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """What the environments share: tasks, physics, reward, picture.

    An action is two numbers from −1 to 1; what lies beyond is moved to the bound.

    Args:
        tasks: Where the scenarios come from.
        sees: Least value of each element of the observation, by name; the greatest is 1.
        render_mode: ``rgb_array``, or None for no pictures.

    Raises:
        UserError: If there is no such render mode.
    """

    rate: ClassVar[float] = DECISIONS_A_SECOND
    """Decisions of an episode a second."""
    metadata = {"render_modes": ["rgb_array"], "render_fps": 3}  # noqa: RUF012 (as Gymnasium has it)

    def __init__(
        self, tasks: TaskSource, sees: Mapping[str, float], *, render_mode: str | None
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise UserError(f"render_mode: must be rgb_array or None, got {render_mode!r}")
        self.render_mode = render_mode
        least = np.array(list(sees.values()), dtype=np.float32)
        self.observation_space = Box(least, np.ones_like(least))
        self.action_space = Box(-1.0, 1.0, (2,))
        self._tasks = tasks
        self._sees = sees
        self._engine: Engine | None = None
        self._episode: Episode | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Vector, dict[str, Any]]:
        """Begin the next episode.

        Args:
            seed: Begins a sequence of episodes that is the same every time; without one the
                sequence goes on.
            options: There are none.

        Returns:
            The first observation; the scenario's name and seed.

        Raises:
            UserError: If any option is given, or no world can be drawn.
        """
        super().reset(seed=seed)
        if options:
            raise UserError(f"options: there are none, got {', '.join(map(str, options))}")
        self._episode = None
        scenario = self._tasks.draw(self.np_random)
        self._engine = self._engine or Engine()
        world = World(
            scenario.obstacles, scenario.arena, engine=self._engine, model=scenario.robot.spec
        )
        self._scenario = scenario
        self._episode = Episode(world, scenario, rate=self.rate)
        self._begin(scenario)
        return self._observed(), {"scenario": scenario.name, "seed": scenario.seed}

    def step(self, action: NDArray[Any]) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """Act until the next decision is due.

        Returns:
            The observation; the reward (s); whether the episode ended, in the goal, in a collision
            or stuck; whether its limits cut it off; and the parts of the ``reward`` by name,
            ``outcome`` (None while it goes on) and ``is_success``.

        Raises:
            ValueError: If the action is not two numbers.
            ResetNeeded: Before the first episode, and after the end of each.
        """
        episode, scenario = self._running(), self._scenario
        if episode.outcome is not None:
            raise ResetNeeded(
                f"the episode is over ({episode.outcome}): reset before the next step"
            )
        numbers = np.asarray(action, dtype=np.float64)
        if numbers.shape != (2,) or np.isnan(numbers).any():
            raise ValueError(f"an action is two numbers from -1 to 1, got {action}")
        before = episode.now
        first, second = np.clip(numbers, -1.0, 1.0).tolist()
        self._act(episode, first, second)
        now, outcome, goal = episode.now, episode.outcome, scenario.goal.position
        nearer = math.dist((before.x, before.y), goal) - math.dist((now.x, now.y), goal)
        reward = USUAL.of(Transition(before, now, nearer, scenario.robot.max_speed, outcome))
        truncated = outcome == "timeout"
        told = {
            "reward": reward.parts(),
            "outcome": outcome,
            "is_success": outcome == "goal",
        }
        ended = outcome is not None and not truncated
        return self._observed(), reward.total, ended, truncated, told

    def render(self) -> NDArray[np.uint8] | None:
        """Return the map of this instant, RGB, shape (384, 372, 3); None without a render mode."""
        if self.render_mode is None:
            return None
        return picture(self._running().so_far(self._shown()))

    def record(self) -> Trajectory:
        """Return the trajectory of an episode that is over, to be filmed or measured.

        Raises:
            ValueError: If it is not over.
        """
        return self._running().record()

    def close(self) -> None:
        """Free the physics; a second call does nothing, and a reset begins anew."""
        self._episode = None
        if self._engine is not None:
            self._engine.close()
            self._engine = None

    def _running(self) -> Episode:
        if self._episode is None:
            raise ResetNeeded("there is no episode yet: reset first")
        return self._episode

    def _observed(self) -> Vector:
        seen = self._see(self._running())
        values = [seen[name] for name in self._sees]
        # A wheel that swings past its speed by a thousandth must not leave the space.
        return np.clip(values, list(self._sees.values()), 1.0).astype(np.float32)

    @abstractmethod
    def _begin(self, scenario: Scenario) -> None:
        """Make ready for an episode."""

    @abstractmethod
    def _see(self, episode: Episode) -> dict[str, float]:
        """Sense, and return the elements of the observation by name."""

    @abstractmethod
    def _act(self, episode: Episode, first: float, second: float) -> None:
        """Act until the next decision is due; both numbers of the action are within −1 to 1."""

    @abstractmethod
    def _shown(self) -> Decision:
        """Return what a picture shows of this instant."""


def goal_seen(observation: Observation) -> dict[str, float]:
    """Return where the goal is as the robot faces, and how far away.

    The distance d is told as d / (d + ``HALFWAY``): below 1 however large the arena, and finest
    where the robot must stop.
    """
    x, y = np.subtract(observation.goal, observation.position).tolist()
    aside = math.atan2(y, x) - observation.heading
    distance = math.hypot(x, y)
    return {
        "goal_ahead": math.cos(aside),
        "goal_left": math.sin(aside),
        "goal_distance": distance / (distance + HALFWAY),
    }


def motion_seen(observation: Observation, robot: Robot) -> dict[str, float]:
    """Return how fast the robot moves, as parts of the greatest speed and turn rate."""
    return {
        "speed": observation.speed / robot.max_speed,
        "turn_rate": observation.turn_rate / robot.max_turn_rate,
    }


def picture(trajectory: Trajectory) -> NDArray[np.uint8]:
    """Return the map at the end of a trajectory, RGB, shape (384, 372, 3)."""
    timeline = Timeline(trajectory)
    moment = timeline.at(timeline.end)
    hit = None if trajectory.collision is None else trajectory.collision.point
    patch = Map(trajectory).draw(moment, sensed_at(trajectory, moment.decision), hit)
    assert patch is not None  # a new map is drawn whole
    return np.array(patch.image)
