"""Runs of a sweep made again, and filmed: small, short, and held to the digest of their row."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PIL import Image
from pydantic import ValidationError

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.sweep.jobs import Environment, Job
from fuzzyq_bullet.experiments.sweep.rows import Row
from fuzzyq_bullet.metrics import result_of
from fuzzyq_bullet.planning import planner_names, settings_for
from fuzzyq_bullet.scenario import Limits, realise
from fuzzyq_bullet.video import frame, record

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


def film(wanted: Wanted, folder: Path) -> Film:
    """Make a run again and film it; whatever goes wrong with the run is said in the film's place.

    Args:
        wanted: The run.
        folder: For what is needed on the way; removed by whoever made it.

    Raises:
        UserError: If no film can be written (ffmpeg, a full disk).
    """
    row = wanted.row
    try:
        where = Environment(row.layout, row.count, row.run, row.seed)
        settings = _planner(wanted.planner)
        job = Job(where, row.planner, settings, row.drive, wanted.limits)
        trajectory = run(realise(job.scenario()))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where_ = ".".join(map(str, first["loc"]))
        return Film(wanted, f"the planner's settings are not this version's: {where_}")
    except Exception as error:
        return Film(wanted, " ".join(f"{type(error).__name__}: {error}".split()))
    result = result_of(trajectory)
    speed = next((one for one in SPEEDS if result.time_s <= one * LONGEST), SPEEDS[-1])
    path = folder / "film.mp4"
    record(trajectory, path, speed=speed, small=True)
    video = path.read_bytes()
    poster = io.BytesIO()
    last = frame(trajectory, result.time_s + 1.0).resize(SIZE, Image.Resampling.BOX)
    last.save(poster, format="JPEG", quality=80)
    return Film(wanted, None, result.outcome, result.digest, speed, video, poster.getvalue())


def _planner(told: Mapping[str, Any]) -> Any:
    """Return settings as they were described; a policy is named by its hash, and is the usual."""
    name = str(told.get("name"))
    if name not in planner_names():
        raise UserError(f"this version has no planner {name}")
    given = {key: value for key, value in told.items() if key != "policy"}
    return settings_for(name).model_validate(given)
