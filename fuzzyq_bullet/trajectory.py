"""The record of one episode: everything that happened, in arrays, on disk and back.

Video, metrics, checks and reports are made from this record alone; nothing is measured again.
"""

from __future__ import annotations

import hashlib
import io
import json
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, ValidationError

from fuzzyq_bullet.archive import read_arrays
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.planning.base import MODES
from fuzzyq_bullet.scenario.models import ANY_NAME, Scenario

Floats: TypeAlias = NDArray[np.float64]
Outcome: TypeAlias = Literal["goal", "collision", "timeout", "stuck"]

FORMAT = 2
LONGEST = 7200.0
"""Longest run that is read (s): twice the greatest limit of a scenario."""
_FAR = 1e7
"""No position (m), angle (rad) or speed of a run comes near this."""


@dataclass(frozen=True, eq=False)
class Ticks:
    """The robot's state at every tick of the drive, first the start and last the end.

    ``T`` ticks; one every 0.15 s with wheels, one for each step (Eq. 17) in the kinematic drive.

    Attributes:
        time: Simulated time (s), shape (T,), increasing.
        position: Centre of the robot (m), shape (T, 2).
        heading: Direction it faces (rad), shape (T,).
        speed: Forward speed (m/s), shape (T,).
        turn_rate: Turn rate (rad/s), shape (T,).
        wheel_speeds: Speeds of the left and right wheel (rad/s), shape (T, 2).
        clearance: Distance to the nearest obstacle or wall (m), shape (T,); negative where the two
            overlap, inf when there is none. In the kinematic drive, whose moves may be long, the
            least since the tick before.
    """

    time: Floats
    position: Floats
    heading: Floats
    speed: Floats
    turn_rate: Floats
    wheel_speeds: Floats
    clearance: Floats


@dataclass(frozen=True, eq=False)
class Decisions:
    """Every decision of the planner, with all that explains it. ``D`` decisions.

    Fields have the meaning and units of ``planning.base.Decision``.

    Attributes:
        tick: Index of the tick at which it was taken, shape (D,), integers, non-decreasing.
        heading: Shape (D,).
        step: Shape (D,).
        reach: Shape (D,).
        mode: Index into ``planning.base.MODES``, shape (D,), integers.
        lines: Shape (D, 3): left, middle, right.
        lengths: Shape (D, 3): left, middle, right.
        distance: Shape (D,).
        difference: Shape (D,).
        near: Shape (D, 5).
        side: Shape (D, 5).
        rules: Shape (D, 5, 5).
        turn: Shape (D,).
        stride: Shape (D,).
        weights: Shape (D, 2).
        breakout_at: Shape (D,).
        guard: Shape (D,).
        target: Shape (D, 2).
    """

    tick: NDArray[np.int64]
    heading: Floats
    step: Floats
    reach: Floats
    mode: NDArray[np.int64]
    lines: Floats
    lengths: Floats
    distance: Floats
    difference: Floats
    near: Floats
    side: Floats
    rules: Floats
    turn: Floats
    stride: Floats
    weights: Floats
    breakout_at: Floats
    guard: Floats
    target: Floats


@dataclass(frozen=True)
class Collision:
    """The first contact of a run, which ended it.

    Attributes:
        time: When (s).
        point: Where the two touched (m), world frame.
        obstacle: Index into the scenario's obstacles, or −1 for a wall.
        normal_force: Force between the two (N); 0 in the kinematic drive, which has no forces.
    """

    time: float
    point: tuple[float, float]
    obstacle: int
    normal_force: float


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """One whole episode.

    Attributes:
        scenario: What was asked, with the planner, drive and seed that ran and every obstacle
            listed (``random`` already drawn).
        outcome: How it ended.
        physics_steps: Steps of the simulation: physics steps with wheels, moves in the kinematic
            drive.
        collision: The contact that ended it, if one did.
        ticks: The robot's motion.
        decisions: The planner's decisions.
        version: Version of fuzzyq_bullet that made it.
    """

    scenario: Scenario
    outcome: Outcome
    physics_steps: int
    collision: Collision | None
    ticks: Ticks
    decisions: Decisions
    version: str

    def __repr__(self) -> str:
        scenario, ticks = self.scenario, self.ticks
        return (
            f"<Trajectory {scenario.name}: {self.outcome} after {ticks.time[-1]:.2f} s "
            f"({scenario.planner.name}, {scenario.drive}, seed {scenario.seed})>"
        )

    def __eq__(self, other: object) -> bool:
        """Whether two runs were asked for alike, and went alike to the last bit."""
        if not isinstance(other, Trajectory):
            return NotImplemented
        return (self.scenario, self.collision, self.version, self.digest()) == (
            other.scenario,
            other.collision,
            other.version,
            other.digest(),
        )

    def __hash__(self) -> int:
        return hash(self.digest())

    def digest(self) -> str:
        """Return a hash of the exact trajectory: every float of every array, and how it ended."""
        sha = hashlib.sha256()
        head = {"outcome": self.outcome, "physics_steps": self.physics_steps}
        sha.update(json.dumps(head, sort_keys=True).encode())
        for name, array in sorted(self._arrays().items()):
            sha.update(f"{name}{array.dtype.str}{array.shape}".encode())
            sha.update(np.ascontiguousarray(array).tobytes())
        return sha.hexdigest()[:32]

    def save(self, path: Path | str) -> None:
        """Write the record as a compressed ``.npz`` (plain arrays and JSON, no pickle).

        Raises:
            UserError: If the file cannot be written.
        """
        collision = None if self.collision is None else vars(self.collision)
        meta = {
            "format": FORMAT,
            "version": self.version,
            "outcome": self.outcome,
            "physics_steps": self.physics_steps,
            "collision": collision,
            "scenario": self.scenario.model_dump(mode="json"),
        }
        arrays: dict[str, Any] = {"meta": np.array(json.dumps(meta)), **self._arrays()}
        # Made in memory first: on a full disk an archive is left open, and complains on its own.
        archive = io.BytesIO()
        np.savez_compressed(archive, **arrays)
        with written_beside(Path(path)) as part:
            part.write_bytes(archive.getvalue())

    @classmethod
    def load(cls, path: Path | str) -> Trajectory:
        """Read a record written by ``save``.

        Of a planner that is not registered here only the name is kept: what it did is all there.

        Raises:
            UserError: If the file is missing, damaged, or not a record of this format.
        """
        arrays = read_arrays(Path(path))
        try:
            meta = json.loads(str(arrays.pop("meta")))
            form = meta["format"]
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise UserError(f"{path}: not a trajectory of fuzzyq_bullet") from error
        if form != FORMAT:
            shown = repr(form)[:20]
            raise UserError(f"{path}: a record of format {shown}; this version reads {FORMAT}")
        try:
            head = _Head.model_validate(meta, context=ANY_NAME)
            ticks = Ticks(**_columns(arrays, "ticks", Ticks))
            decisions = Decisions(**_columns(arrays, "decisions", Decisions))
            _check(ticks, decisions)
            _check_collision(head.collision, head.scenario)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            raise UserError(f"{path}: damaged record: {where}: {first['msg']}") from error
        except ValueError as error:
            raise UserError(f"{path}: damaged record: {error}") from error
        return cls(
            scenario=head.scenario,
            outcome=head.outcome,
            physics_steps=head.physics_steps,
            collision=head.collision,
            ticks=ticks,
            decisions=decisions,
            version=head.version,
        )

    def _arrays(self) -> dict[str, NDArray[Any]]:
        return {
            f"{group}.{column.name}": getattr(getattr(self, group), column.name)
            for group, kind in (("ticks", Ticks), ("decisions", Decisions))
            for column in fields(kind)
        }


class _Head(BaseModel):
    """What a record holds beside its arrays."""

    version: Annotated[str, Field(max_length=100)]
    outcome: Outcome
    physics_steps: Annotated[int, Field(ge=0)]
    collision: Collision | None
    scenario: Scenario


_SHAPES: dict[str, tuple[int, ...]] = {
    "position": (2,),
    "wheel_speeds": (2,),
    "lines": (3,),
    "lengths": (3,),
    "near": (5,),
    "side": (5,),
    "rules": (5, 5),
    "weights": (2,),
    "target": (2,),
}
"""Shape of one row of each column that is not a plain number."""
_INTEGERS = ("tick", "mode")


def _columns(arrays: dict[str, NDArray[Any]], group: str, kind: type) -> dict[str, NDArray[Any]]:
    """Return the columns of a group, all of one length, each of its type and shape.

    Raises:
        ValueError: If one is missing or of another type, length or shape.
    """
    columns: dict[str, NDArray[Any]] = {}
    rows = None
    for column in fields(kind):
        name = f"{group}.{column.name}"
        if name not in arrays:
            raise ValueError(f"{name} is missing")
        array = arrays[name]
        rows = array.shape[:1] if rows is None else rows
        expected = np.int64 if column.name in _INTEGERS else np.float64
        if array.dtype != expected:
            raise ValueError(f"{name} holds {array.dtype} instead of {np.dtype(expected)}")
        if not rows or rows == (0,) or array.shape != rows + _SHAPES.get(column.name, ()):
            raise ValueError(f"{name} is of the wrong shape {array.shape}")
        columns[column.name] = array
    return columns


def _check(ticks: Ticks, decisions: Decisions) -> None:
    """Check what every reader of a record relies on.

    Raises:
        ValueError: If a run cannot have left these numbers.
    """
    for name in ("time", "position", "heading", "speed", "turn_rate", "wheel_speeds"):
        if not (np.abs(getattr(ticks, name)) < _FAR).all():
            raise ValueError(f"ticks.{name} holds a number that is not finite, or is absurd")
    if np.isnan(ticks.clearance).any():
        raise ValueError("ticks.clearance holds a value that is not a number")
    if not (np.diff(ticks.time) > 0).all():
        raise ValueError("ticks.time does not increase")
    if ticks.time[-1] - ticks.time[0] > LONGEST:
        raise ValueError(f"ticks.time spans more than {LONGEST:g} s")
    for column in fields(decisions):
        values = getattr(decisions, column.name)
        if column.name not in ("heading", "step"):  # only these are never left blank
            values = values[~np.isnan(values)]
        if column.name == "reach":  # nothing was looked at, so nothing is known to end
            values = values[values != np.inf]
        if not (np.abs(values) < _FAR).all():
            raise ValueError(f"decisions.{column.name} holds a number that is absurd")
    tick, last = decisions.tick, ticks.time.size - 1
    if tick.min() < 0 or tick.max() > last or (np.diff(tick) < 0).any():
        raise ValueError(f"decisions.tick does not run upwards within 0 to {last}")
    if decisions.mode.min() < 0 or decisions.mode.max() >= len(MODES):
        raise ValueError(f"decisions.mode leaves the range 0 to {len(MODES) - 1}")


def _check_collision(collision: Collision | None, scenario: Scenario) -> None:
    """Check what every reader of a collision relies on.

    Raises:
        ValueError: If a run cannot have left these numbers.
    """
    if collision is None:
        return
    numbers = (collision.time, *collision.point, collision.normal_force)
    if not all(abs(number) < _FAR for number in numbers):
        raise ValueError("collision holds a number that is not finite, or is absurd")
    if not -1 <= collision.obstacle < len(scenario.obstacles):
        raise ValueError(f"collision.obstacle: there is no obstacle {collision.obstacle}")
