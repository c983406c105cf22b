"""The planner ``navground``: behaviours of the package navground, through its own interface.

J. Guzzi's navground (https://github.com/idsia-robotics/navground) implements among others:

- ``HL``: human-like. J. Guzzi, A. Giusti, L. M. Gambardella, G. Theraulaz, G. A. Di Caro:
  Human-friendly robot navigation in dynamic environments, ICRA 2013.
- ``ORCA``: optimal reciprocal collision avoidance. J. van den Berg, S. J. Guy, M. Lin, D. Manocha:
  Reciprocal n-body collision avoidance, ISRR 2009.
- ``HRVO``: J. Snape, J. van den Berg, S. J. Guy, D. Manocha: The hybrid reciprocal velocity
  obstacle, IEEE Transactions on Robotics 27(4), 2011.
- ``SocialForce``: D. Helbing, P. Molnár: Social force model for pedestrian dynamics, 1995.

Nothing of these is written here. Each decision tells the behaviour the robot's pose and twist, the
goal, and a disc for every point that a ray has hit, as wide as the gap to the next ray; and it
answers with the twist that the behaviour asks of two wheels. They are made for crowds: what stands
still has no say in ORCA and HRVO, which both give way as if they had the whole fault, and none of
them has a memory, so that dead ends hold them. The package knows no acceleration of the wheels; the
safety filter makes up for that.

Tuning (docs/results/peers.md): behaviour and margin are the best of 12 settings on 24 training
fields. ORCA's horizon and how it takes obstacles were tried in `sparse` and before one cylinder.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

import numpy as np
from pydantic import Field, Strict

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.base import Motion, Observation
from fuzzyq_bullet.planning.commands import TwistCommand
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.peers.surroundings import PeerSettings, look_around
from fuzzyq_bullet.quantities import Number
from fuzzyq_bullet.wording import shorten

Behavior: TypeAlias = Literal["HL", "ORCA", "HRVO", "SocialForce"]
Value: TypeAlias = Annotated[bool, Strict()] | Annotated[int, Strict()] | Number
TUNED: Mapping[Behavior, Mapping[str, bool | int | float]] = {
    "HL": {},
    "ORCA": {
        "time_horizon": 1.0,
        "static_time_horizon": 1.0,
        "treat_obstacles_as_agents": False,
    },
    "HRVO": {},
    "SocialForce": {},
}
"""Properties that are not navground's defaults, because training fields were better for it."""
_MISSING = "the package navground is not installed: pip install 'fuzzyq_bullet[peers]'"


class NavgroundSettings(PeerSettings):
    """A behaviour of the package navground (extra ``peers``)."""

    needs_wheels: ClassVar[bool] = True

    name: Literal["navground"] = "navground"
    behavior: Behavior = Field(default="HL", description="Which of its behaviours decides.")
    safety_margin: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="Distance that the behaviour keeps besides the radius (m)."
    )
    properties: dict[str, Value] = Field(
        default={},
        description="Properties of the behaviour that are to be others, as navground names them: "
        "{tau: 0.2}.",
    )

    def doubts(self) -> Iterator[tuple[str, str]]:
        """Yield what is allowed and yet hardly meant: a run needs the package."""
        yield from super().doubts()
        if importlib.util.find_spec("navground") is None:
            yield "name", f"a run would fail: {_MISSING}"


class NavgroundPlanner:
    """Asks a behaviour of navground.

    Raises:
        UserError: If the package is not installed, or the behaviour has no such property.
    """

    def __init__(self, settings: NavgroundSettings) -> None:
        try:
            core: Any = importlib.import_module("navground.core")
        except ImportError as error:
            raise UserError(_MISSING) from error
        self._core = core
        self._settings = settings
        self._behavior: Any = core.Behavior.make_type(settings.behavior)
        for key, value in {**TUNED[settings.behavior], **settings.properties}.items():
            if not self._behavior.has(key):
                known = ", ".join(sorted(self._behavior.properties))
                raise UserError(
                    f"properties: {settings.behavior} has no {shorten(key)}; it has {known}"
                )
            self._behavior.set(key, value)
        self._ready = False

    def decide(self, observation: Observation, /) -> TwistCommand:
        """Return the twist that the behaviour asks for."""
        motion = observation.motion
        if motion is None:  # a point has no wheels: the episode refuses any twist with one line
            return TwistCommand(0.0, 0.0)
        core, behavior = self._core, self._behavior
        if not self._ready:
            self._dress(observation, motion)
        around = look_around(observation)
        behavior.pose = core.Pose2(observation.position, observation.heading)
        behavior.twist = core.Twist2(
            (observation.speed, 0.0), observation.turn_rate, core.Frame.relative
        )
        behavior.target = core.Target.Point(observation.goal, observation.goal_radius / 2.0)
        half = math.pi / len(around.headings)
        points = around.points + np.array(observation.position)
        behavior.environment_state.static_obstacles = [
            core.Disc(point, half * distance)
            for point, distance in zip(points, around.distances[around.met].tolist(), strict=True)
        ]
        asked = behavior.compute_cmd(motion.period, core.Frame.relative)
        told = Decision(0.0, 0.0, aim=observation.goal)
        return TwistCommand(float(asked.velocity[0]), float(asked.angular_speed), told)

    def _dress(self, observation: Observation, motion: Motion) -> None:
        """Tell the behaviour which robot it drives."""
        behavior = self._behavior
        behavior.kinematics = self._core.kinematics.TwoWheelsDifferentialDriveKinematics(
            max_speed=motion.max_speed,
            wheel_axis=motion.track,
            max_angular_speed=motion.max_turn_rate,
        )
        behavior.radius = observation.radius
        behavior.optimal_speed = motion.max_speed
        behavior.optimal_angular_speed = motion.max_turn_rate
        behavior.safety_margin = self._settings.safety_margin + observation.uncertainty
        behavior.horizon = observation.range + observation.radius
        behavior.prepare()
        self._ready = True
