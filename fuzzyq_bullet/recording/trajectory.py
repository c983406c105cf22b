"""The record of one episode: everything that happened, in arrays, on disk and back.

Video, metrics, checks and reports are made from this record alone; nothing is measured again.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, make_dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, ValidationError

from fuzzyq_bullet.columns import Column, Columns, array_of, check_arrays, columns_of, csv_of
from fuzzyq_bullet.columns import documented as with_columns
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.geometry import Field as Obstacles
from fuzzyq_bullet.planning.commands import COMMAND_FIELDS, command_arrays
from fuzzyq_bullet.planning.controllers import fields_of, fields_with
from fuzzyq_bullet.planning.decision import FIELDS, RARE_FIELDS, Decision, rare_arrays
from fuzzyq_bullet.planning.registry import planner_names
from fuzzyq_bullet.planning.settings import PlannerSettings
from fuzzyq_bullet.reading.untrusted import read_arrays
from fuzzyq_bullet.recording.checks import check_collision, check_order, mistake_in_record
from fuzzyq_bullet.recording.moving import checked_poses, clearance_of, poses_of
from fuzzyq_bullet.scenario.expectations import ANY_NAME
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.passing import passed_along
from fuzzyq_bullet.version import __version__

Floats: TypeAlias = NDArray[np.float64]
Outcome: TypeAlias = Literal["goal", "collision", "timeout", "stuck"]

FORMAT = 2

_XY, _SIDES = ("x", "y"), ("left", "right")


@dataclass(frozen=True, eq=False)
class Ticks:
    """The robot's state at every tick of the drive, first the start and last the end.

    One every 0.05 s with wheels, one for each step (Eq. 17) in the kinematic drive. Every array
    has a row for each of the T ticks.
    """

    time: Annotated[Floats, Column("s", "Simulated time, increasing.")]
    position: Annotated[Floats, Column("m", "Centre of the robot, world frame.", (_XY,))]
    heading: Annotated[Floats, Column("rad", "Direction the robot faces, anticlockwise from x.")]
    speed: Annotated[Floats, Column("m/s", "Forward speed.")]
    turn_rate: Annotated[Floats, Column("rad/s", "Turn rate, positive to the left.")]
    wheel_speeds: Annotated[Floats, Column("rad/s", "Speeds of the two wheels.", (_SIDES,))]
    clearance: Annotated[
        Floats,
        Column(
            "m",
            "Distance to the nearest obstacle or wall: negative where the two overlap, infinite "
            "when there is none. In the kinematic drive, the least since the tick before.",
            endless=True,
        ),
    ]


TICKS = columns_of(Ticks)
DECISIONS = {
    "tick": Column("", "Index of the tick at which it was taken, non-decreasing.", whole=True),
    **FIELDS,
}
"""All columns of a record: a row of ``TICKS`` for each tick, of ``DECISIONS`` for each decision."""
OPTIONAL: Columns = {**RARE_FIELDS, **COMMAND_FIELDS}
"""Columns of the decisions that only some runs have."""
Ticks.__doc__ = with_columns(Ticks.__doc__, TICKS)
_DECISIONS_DOC = "Every decision of the planner, with all that explains it: D rows in each array."

if TYPE_CHECKING:

    class Decisions:
        """Every decision of the planner, with all that explains it: an array for each column."""

        def __init__(self, **columns: NDArray[Any]) -> None: ...
        def __getattr__(self, name: str) -> NDArray[Any]: ...

else:
    Decisions = make_dataclass(
        "Decisions",
        [
            *((name, NDArray) for name in DECISIONS),
            *((name, NDArray | None, field(default=None)) for name in OPTIONAL),
        ],
        frozen=True,
        eq=False,
        namespace={"__module__": __name__, "__doc__": with_columns(_DECISIONS_DOC, DECISIONS)},
    )


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
        movers: Where the moving obstacles were at every tick; see
            ``recording.moving.poses_of``.
        version: Version of fuzzyq_bullet that made it.
    """

    scenario: Scenario
    outcome: Outcome
    physics_steps: int
    collision: Collision | None
    ticks: Ticks
    decisions: Decisions
    version: str
    movers: Floats = field(default_factory=lambda: np.zeros((0, 0, 3)))

    def __post_init__(self) -> None:
        """Give a record without moving obstacles as many rows of none."""
        if not self.movers.size:
            object.__setattr__(self, "movers", poses_of((), len(self.ticks.time)))

    @classmethod
    def from_episode(
        cls,
        scenario: Scenario,
        obstacles: Obstacles,
        states: Sequence[Sequence[float]],
        decisions: Sequence[tuple[int, Decision]],
        *,
        outcome: Outcome,
        physics_steps: int,
        collision: Collision | None,
        movers: Sequence[Floats] = (),
        twists: Mapping[int, tuple[float, float]] | None = None,
    ) -> Trajectory:
        """Return the record of an episode.

        Args:
            scenario: The scenario as it ran, every obstacle listed.
            obstacles: Its standing obstacles and walls.
            states: The robot at every tick: time, x, y, heading, speed, turn rate and the speeds of
                the left and right wheel.
            decisions: Each decision with the index of the tick it was taken at.
            outcome: How the episode ended.
            physics_steps: Steps of the simulation.
            collision: The contact that ended it, if one did.
            movers: Where its moving obstacles were at every tick, shape (M, 3) each.
            twists: What the planner asked for instead, by the number of the decision.
        """
        at = np.array(states, dtype=np.float64)
        poses = poses_of(movers, len(at))
        return cls(
            scenario=scenario,
            outcome=outcome,
            physics_steps=physics_steps,
            collision=collision,
            ticks=Ticks(
                time=at[:, 0],
                position=at[:, 1:3],
                heading=at[:, 3],
                speed=at[:, 4],
                turn_rate=at[:, 5],
                wheel_speeds=at[:, 6:8],
                clearance=clearance_of(scenario, obstacles, at[:, 1:3], poses),
            ),
            decisions=Decisions(
                tick=np.array([tick for tick, _ in decisions], dtype=np.int64),
                **{
                    name: array_of(column, [getattr(decision, name) for _, decision in decisions])
                    for name, column in fields_of(scenario.planner).items()
                },
                **rare_arrays([decision for _, decision in decisions]),
                **command_arrays(twists or {}, len(decisions)),
            ),
            movers=poses,
            version=__version__,
        )

    def csv(self, group: Literal["ticks", "decisions"], *, units: bool = False) -> str:
        """Return the ticks or decisions as CSV (docs/reference/record.md); see ``csv_of``."""
        told = TICKS if group == "ticks" else self.decision_columns
        return csv_of(told, vars(getattr(self, group)), units=units)

    @cached_property
    def via_passed(self) -> NDArray[np.int64]:
        """How many via points were passed by each tick, shape (T,)."""
        return np.array(passed_along(self.scenario.via, self.ticks.position), dtype=np.int64)

    @property
    def decision_columns(self) -> Columns:
        """``DECISIONS``, with the labels of the controller that was asked."""
        return _columns_in(self.scenario.planner, self._arrays())

    def __repr__(self) -> str:
        scenario, ticks = self.scenario, self.ticks
        return (
            f"<Trajectory {scenario.name}: {self.outcome} after {ticks.time[-1]:.2f} s "
            f"({scenario.planner.name}, {scenario.drive}, seed {scenario.seed})>"
        )

    def _repr_html_(self) -> str:
        from fuzzyq_bullet.figures.notebook import html_of  # drawn only where a notebook asks

        return html_of(self)

    def __eq__(self, other: object) -> bool:
        """Whether two runs were asked for alike, and went alike to the last bit."""
        if not isinstance(other, Trajectory):
            return NotImplemented
        one, two = ((r.scenario, r.collision, r.version, r.digest()) for r in (self, other))
        return one == two

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
        # Made in memory first: on a full disk an archive is left open, and complains on its own.
        archive = self.to_bytes()
        with written_beside(Path(path)) as part:
            part.write_bytes(archive)

    def to_bytes(self) -> bytes:
        """Return the contents of the file that ``save`` writes."""
        meta = {
            "format": FORMAT,
            "version": self.version,
            "outcome": self.outcome,
            "physics_steps": self.physics_steps,
            "collision": None if self.collision is None else vars(self.collision),
            "scenario": self.scenario.model_dump(mode="json"),
        }
        arrays: dict[str, Any] = {"meta": np.array(json.dumps(meta)), **self._arrays()}
        archive = io.BytesIO()
        np.savez_compressed(archive, **arrays)
        return archive.getvalue()

    @classmethod
    def load(cls, path: Path | str) -> Trajectory:
        """Read a record written by ``save``.

        Of a planner or sensor that is not registered here only the name is kept: what it did is all
        there. Shapes, motions and the robot must be registered.

        Raises:
            UserError: If the file is missing, damaged, or not a record of this format, or if it was
                made with what is not registered here.
        """
        arrays = read_arrays(Path(path))
        try:
            meta = json.loads(str(arrays.pop("meta")))
            form = meta["format"]
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise UserError(f"{path}: not a trajectory of fuzzyq_bullet") from error
        if form != FORMAT:
            raise UserError(f"{path}: a record of format {form!r:.20}; this version reads {FORMAT}")
        try:
            head = _Head.model_validate(meta, context=ANY_NAME)
            ticks = Ticks(**check_arrays("ticks", TICKS, arrays))
            columns = _columns_in(head.scenario.planner, arrays)
            decisions = Decisions(**check_arrays("decisions", columns, arrays))
            check_order(ticks.time, decisions.tick)
            movers = checked_poses(arrays.get("movers.poses"), head.scenario, ticks.time.size)
            if head.collision is not None:
                check_collision(head.collision, head.scenario)
        except ValidationError as error:
            raise UserError(f"{path}: {mistake_in_record(error)}") from error
        except ValueError as error:
            raise UserError(f"{path}: damaged record: {error}") from error
        return cls(**dict(head), ticks=ticks, decisions=decisions, movers=movers)

    def _arrays(self) -> dict[str, NDArray[Any]]:
        arrays = {
            f"{group}.{name}": array
            for group in ("ticks", "decisions")
            for name, array in vars(getattr(self, group)).items()
            if array is not None  # what this run has not
        }
        return {**arrays, "movers.poses": self.movers} if self.movers.size else arrays


def _columns_in(planner: PlannerSettings, arrays: Mapping[str, Any]) -> Columns:
    """Return the columns of the decisions of a planner.

    Of one that is not registered here nothing is known; its labels are numbers then.
    """
    more = {name: column for name, column in OPTIONAL.items() if f"decisions.{name}" in arrays}
    rules = arrays.get("decisions.rules")
    known = planner.name in planner_names()
    if known or rules is None or rules.ndim != 3 or rules.shape[1:] == DECISIONS["rules"].shape:
        return {"tick": DECISIONS["tick"], **fields_of(planner), **more}
    near, side = (list(map(str, range(1, size + 1))) for size in rules.shape[1:])
    return {"tick": DECISIONS["tick"], **fields_with(near, side), **more}


class _Head(BaseModel):
    """What a record holds beside its arrays."""

    version: Annotated[str, Field(max_length=100)]
    outcome: Outcome
    physics_steps: Annotated[int, Field(ge=0)]
    collision: Collision | None
    scenario: Scenario
