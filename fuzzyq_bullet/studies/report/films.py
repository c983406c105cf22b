"""The runs of a report that are worth watching, made again and filmed; and the paper's figures.

Both take time, and are made by worker processes. The films are small and short, and each is held
to the digest of its row.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from PIL import Image
from pydantic import ValidationError

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import planner_names, settings_for
from fuzzyq_bullet.recording.metrics import result_of
from fuzzyq_bullet.scenario import Limits, realise
from fuzzyq_bullet.studies.episodes import Environment, Job, Row
from fuzzyq_bullet.studies.options import POSITIONAL
from fuzzyq_bullet.studies.positional import learn_and_drive
from fuzzyq_bullet.studies.report.found import Found
from fuzzyq_bullet.studies.success.table import by_planner
from fuzzyq_bullet.studies.sweep import local_pool
from fuzzyq_bullet.video import frame, record

RULE = (
    "All runs of a planner that have a row without an error, in this order: first those that "
    "reached the goal, by the time they took over that of the shortest path at full speed; then "
    "those that failed where there is no way for a disc of radius 0.22 m; last those that failed "
    "although there is one, by their time. Best is the first, median the one in the middle, worst "
    "the last: a failure, if there is one."
)
LONGEST = 12.0
"""How long a film may play (s), where the greatest speed there is allows it."""
SPEEDS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100)
"""Speeds to choose from."""
SIZE = (640, 360)


@dataclass(frozen=True)
class Wanted:
    """A run to be made again.

    Attributes:
        row: What it came to.
        planner: The settings of its planner, as the sweep wrote them.
        limits: When it was given up.
    """

    row: Row
    planner: Mapping[str, Any]
    limits: Limits


Place: TypeAlias = tuple[Path, str, str]
"""Folder of a study, planner, and what the run is."""


@dataclass(frozen=True)
class Film:
    """A run made again.

    Attributes:
        wanted: What was to be made.
        problem: Why it could not be made again; None if it could, and then the rest is there.
        outcome: How it ended this time.
        digest: Of the trajectory this time.
        speed: Of the film, in times of the run's.
        video: The film: an MP4 of ``SIZE``.
        poster: Its last picture: a JPEG of ``SIZE``.
    """

    wanted: Wanted
    problem: str | None = None
    outcome: str = ""
    digest: str = ""
    speed: int = 1
    video: bytes = b""
    poster: bytes = b""

    @property
    def other(self) -> bool:
        """Whether it was made, and is not the run of the row to the last bit."""
        return self.problem is None and self.digest != self.wanted.row.digest


Made: TypeAlias = "Film | bytes"


def wanted_films(found: Sequence[Found]) -> dict[Place, Wanted]:
    """Return which runs are to be made again: the best, median and worst of each planner."""
    return {
        (one.folder, name, role): Wanted(row, swept.plan.planners[name], swept.plan.limits)
        for one in found
        if one.kind.filmed
        for swept in one.results.values()
        for name in by_planner(swept.rows)
        for role, row in picked(swept.rows, name).items()
    }


def picked(rows: Iterable[Row], planner: str) -> dict[str, Row]:
    """Return a planner's best, median and worst run; what is the same run is one entry.

    Returns:
        Runs by what they are, such as ``best`` or ``median and worst``; empty without any run.
    """
    runs = [row for row in rows if row.planner == planner and row.outcome != "error"]
    runs.sort(key=_rank)
    if not runs:
        return {}
    places = {"best": 0, "median": (len(runs) - 1) // 2, "worst": len(runs) - 1}
    roles: dict[int, list[str]] = {}
    for role, place in places.items():
        roles.setdefault(place, []).append(role)
    return {_listed(names): runs[place] for place, names in roles.items()}


def _pace(row: Row) -> float | None:
    """Return the time of a run in times of the shortest path at 1 m/s; None without such a path.

    The robot's greatest speed is the same in all runs, so the order is that of the true ratio.
    """
    if row.time_s is None or not row.shortest_path_m:
        return None
    return row.time_s / row.shortest_path_m


def _rank(row: Row) -> tuple[object, ...]:
    time = row.time_s or 0.0
    if row.success:
        ratio = _pace(row)
        return 0, math.inf if ratio is None else ratio, time, row.key
    return 1 if row.feasible is False else 2, 0.0, time, row.key


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def make(
    things: Sequence[Wanted | int],
    workers: int | None,
    plugins: Sequence[str],
    done: Callable[[], None],
) -> list[Made]:
    """Return the film of each run, and each figure as a PNG, in their order.

    Args:
        things: Runs to be filmed, and numbers of figures.
        workers: How many at a time; None for one a core.
        plugins: Modules that each worker imports first.
        done: Called after each.

    Raises:
        UserError: If no film can be written, or a worker process dies.
    """
    made: dict[int, Made] = {}
    # One folder for all, made here: workers that are ended leave theirs behind.
    with (
        tempfile.TemporaryDirectory(prefix="fuzzyq-", ignore_cleanup_errors=True) as folder,
        local_pool(workers, plugins) as pool,
    ):
        places = [Path(folder) / str(place) for place in range(len(things))]
        orders = [_order(one, place) for one, place in zip(things, places, strict=True)]
        for i, answer in pool.run(_make, orders):
            if answer.failed:
                raise UserError(*answer.failed)
            if answer.died:
                raise UserError(f"a film or figure could not be made: {answer.died}; try --jobs 1")
            thing, place = things[i], places[i]
            if isinstance(thing, int):
                made[i] = Path(answer.value).read_bytes()
            elif answer.value["problem"] is not None:
                made[i] = Film(thing, answer.value["problem"])
            else:
                video, poster = ((place / name).read_bytes() for name in (_VIDEO, _POSTER))
                made[i] = Film(thing, **answer.value, video=video, poster=poster)
            done()
    return [made[place] for place in range(len(things))]


_VIDEO, _POSTER = "film.mp4", "poster.jpg"


def _order(thing: Wanted | int, folder: Path) -> dict[str, Any]:
    if isinstance(thing, int):
        return {"figure": thing, "folder": str(folder)}
    return {
        "row": thing.row.model_dump(mode="json"),
        "planner": dict(thing.planner),
        "limits": thing.limits.model_dump(mode="json"),
        "folder": str(folder),
    }


def _make(order: dict[str, Any]) -> Any:
    """Draw a figure or make a film, in a worker: return its path, or what came of the run."""
    folder = Path(order["folder"])
    folder.mkdir()
    if "figure" in order:
        from fuzzyq_bullet.figures import drawing

        path, *_ = drawing(order["figure"])(folder)
        return str(path)
    row, limits = Row.model_validate(order["row"]), Limits.model_validate(order["limits"])
    return _film(Wanted(row, order["planner"], limits), folder)


def _film(wanted: Wanted, folder: Path) -> dict[str, Any]:
    """Make a run again and film it; whatever goes wrong with the run is said in the film's place.

    Raises:
        UserError: If no film can be written (ffmpeg, a full disk).
    """
    row = wanted.row
    try:
        where = Environment(row.layout, row.count, row.run, row.seed)
        settings = _planner(wanted.planner)
        job = Job(where, row.planner, settings, row.drive, wanted.limits)
        drive = learn_and_drive if row.planner in POSITIONAL else run
        trajectory = drive(realise(job.scenario()))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where_ = ".".join(map(str, first["loc"]))
        return {"problem": f"the planner's settings are not this version's: {where_}"}
    except Exception as error:
        return {"problem": " ".join(f"{type(error).__name__}: {error}".split())}
    result = result_of(trajectory)
    speed = next((one for one in SPEEDS if result.time_s <= one * LONGEST), SPEEDS[-1])
    record(trajectory, folder / _VIDEO, speed=speed, small=True)
    last = Image.fromarray(frame(trajectory, result.time_s + 1.0))
    last.resize(SIZE, Image.Resampling.BOX).save(folder / _POSTER, format="JPEG", quality=80)
    told = {"outcome": result.outcome, "digest": result.digest, "speed": speed}
    return {"problem": None, **told}


def _planner(told: Mapping[str, Any]) -> Any:
    """Return settings as they were described; a policy is named by its hash, and is the usual."""
    name = str(told.get("name"))
    if name not in planner_names():
        raise UserError(f"this version has no planner {name}")
    given = {key: value for key, value in told.items() if key != "policy"}
    return settings_for(name).model_validate(given)
