"""The planner ``process``: a program of one's own, in any language, asked by lines of JSON."""

from __future__ import annotations

import math
import os
import shutil
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, Strict

from fuzzyq_bullet.errors import PlannerError, UserError
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.commands import Answer, CommandSettings
from fuzzyq_bullet.planning.process.child import ChildError, LineChild
from fuzzyq_bullet.planning.process.messages import Goal, Greeting, Lines, Robot, Seen, read_reply
from fuzzyq_bullet.version import __version__
from fuzzyq_bullet.wording import shorten

_Number: TypeAlias = Annotated[float, Strict(), Field(allow_inf_nan=False)]
_Word: TypeAlias = Annotated[str, Strict(), Field(max_length=4096, pattern=r"^[^\x00]*$")]
LINE_ANGLE = math.radians(45.0)
"""Angle of the left and right lines from the middle one (rad)."""

_SCRIPTS = {".py", ".pl", ".rb", ".js", ".mjs", ".ts", ".sh", ".lua", ".jl", ".r", ".php", ".jar"}
"""How the names of programs end that an interpreter runs."""


class Rays(BaseModel):
    """A fan of rays about where the robot faces."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    count: Annotated[int, Strict(), Field(ge=0, le=1000)] = Field(
        default=36, description="How many, evenly spaced, anticlockwise."
    )
    angle: Annotated[_Number, Field(ge=0.0, le=2.0 * math.pi)] = Field(
        default=2.0 * math.pi,
        description="From the first to the last (rad), the robot facing its middle; 2π: all round, "
        "beginning ahead.",
    )

    def angles(self) -> list[float]:
        """Return the angle of each from where the robot faces (rad)."""
        if self.angle >= 2.0 * math.pi - 1e-9:
            return [2.0 * math.pi * k / self.count for k in range(self.count)]
        if self.count == 1:
            return [0.0]
        gap = self.angle / max(1, self.count - 1)
        return [k * gap - self.angle / 2.0 for k in range(self.count)]


class ProcessSettings(CommandSettings):
    """A program of one's own decides; it speaks JSON over its standard input and output."""

    name: Literal["process"] = "process"
    command: Annotated[tuple[_Word, ...], Field(max_length=100)] = Field(
        default=(),
        description="The program and its arguments. What begins with ./ or ../ is relative to the "
        "scenario's file.",
    )
    time_limit: Annotated[_Number, Field(gt=0.0, le=3600.0)] = Field(
        default=1.0, description="Longest time that an answer may take (s, of the clock)."
    )
    start_limit: Annotated[_Number, Field(gt=0.0, le=3600.0)] = Field(
        default=10.0, description="Likewise for the first answer, before which it has to start."
    )
    rays: Rays = Rays()


class ProcessPlanner:
    """Asks a program, which is started with the first decision.

    Args:
        settings: What to start, and how long to wait.
        rng: Gives the program its seed.

    Raises:
        UserError: If there is no command, no such program, or no such script for it.
    """

    def __init__(self, settings: ProcessSettings, rng: np.random.Generator) -> None:
        if not settings.command:
            raise UserError(
                "command: names no program; as in planner: {name: process, command: [./mine]}"
            )
        if shutil.which(settings.command[0]) is None:
            program = shorten(settings.command[0])
            if Path(settings.command[0]).is_file():
                raise UserError(f"command: {program}: is not executable: chmod +x makes it so")
            raise UserError(f"command: {program}: there is no such program")
        if (script := _missing_script(settings.command[1:])) is not None:
            raise UserError(
                f"command: {script!r}: there is no such file; what begins with ./ is looked "
                "for beside the scenario"
            )
        self._settings = settings
        self._angles = settings.rays.angles()
        self._seed = int(rng.integers(2**31))
        self._child: LineChild | None = None

    def decide(self, observation: Observation, /) -> Answer:
        """Tell the program what the robot sees, and return what it answers.

        Raises:
            PlannerError: If it cannot be started, does not answer in time, ends, or answers what
                is no answer.
        """
        settings = self._settings
        try:
            limit = settings.time_limit
            if self._child is None:
                limit = settings.start_limit
                self._child = LineChild(settings.command)
                self._child.tell(self._greeting(observation).model_dump_json(), limit)
            seen, lines = self._seen(observation)
            said = self._child.ask(seen.model_dump_json(), limit)
            try:
                reply = read_reply(said)
            except ValueError as error:
                raise self._child.failed(f"answered {shorten(said)}: {error}") from error
        except ChildError as error:
            program = shorten(" ".join(settings.command))
            when = f"after {observation.time:.2f} s"
            raise PlannerError(f"planner process: {program}: {error}, {when}") from error
        lengths = (seen.lines.left, seen.lines.middle, seen.lines.right)
        return reply.answer(lines, lengths)

    def close(self) -> None:
        """End the program and whatever it has started."""
        child, self._child = self._child, None
        if child is not None:
            child.close()

    def _greeting(self, observation: Observation) -> Greeting:
        robot, motion = Robot(radius=observation.unit), observation.motion
        if motion is not None:
            limits = {name: getattr(motion, name) for name in Robot.model_fields}
            robot = Robot.model_validate(limits)
        return Greeting(
            version=__version__,
            robot=robot,
            goal=Goal(position=observation.goal, radius=observation.goal_radius),
            range=observation.range,
            period=None if motion is None else motion.period,
            rays=self._angles,
            seed=self._seed,
        )

    def _seen(self, observation: Observation) -> tuple[Seen, tuple[float, ...]]:
        (x, y), (gx, gy) = observation.position, observation.goal
        bearing = math.atan2(gy - y, gx - x)
        lines = (bearing + LINE_ANGLE, bearing, bearing - LINE_ANGLE)
        left, middle, right = observation.sense(lines)
        rays = observation.look([observation.heading + angle for angle in self._angles])
        seen = Seen(
            time=observation.time,
            position=(x, y),
            heading=observation.heading,
            speed=observation.speed,
            turn_rate=observation.turn_rate,
            goal=(gx, gy),
            lines=Lines(left=left, middle=middle, right=right),
            rays=rays.tolist(),
        )
        return seen, lines


def _missing_script(words: tuple[str, ...]) -> str | None:
    """Return the argument that names a script which is not there; None if there is none.

    That is one that ends like a script, or the first if it is a path: other paths may be files that
    the program is to write.
    """
    for i, word in enumerate(words):
        is_path = i == 0 and "/" in word and not word.startswith("-")
        is_script = is_path or Path(word).suffix.lower() in _SCRIPTS
        if is_script and not os.path.exists(word):  # noqa: PTH110 – takes a name of any length
            return word
    return None
