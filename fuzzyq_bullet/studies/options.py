"""What the options of studies mean: lists of counts, drives, a planner with its weights."""

from __future__ import annotations

from typing import get_args

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings, planner_names, settings_for
from fuzzyq_bullet.planning.registry import no_planner
from fuzzyq_bullet.scenario import MAX_OBSTACLES, Drive
from fuzzyq_bullet.wording import not_one_of, shorten

NONE = "none"


def counts_of(text: str, option: str) -> tuple[int, ...]:
    """Return numbers of obstacles, sorted, each once; ``none`` stands for none of them.

    Args:
        text: Such as ``5,25,50``.
        option: What to call it in an error.

    Raises:
        UserError: If one is no number of obstacles that a scenario may have.
    """
    if text.strip() == NONE:
        return ()
    counts = set()
    for part in text.split(","):
        number = part.strip()
        if not (
            number.isascii()
            and number.isdigit()
            and len(number) < 9
            and int(number) <= MAX_OBSTACLES
        ):
            raise UserError(
                f"{option}: {part[:30]!r} is no number of obstacles; give numbers from 0 to "
                f"{MAX_OBSTACLES} with commas between, or {NONE}"
            )
        counts.add(int(number))
    return tuple(sorted(counts))


def drives_of(text: str) -> tuple[Drive, ...]:
    """Return the drives that ``--drive`` asks for.

    Raises:
        UserError: If there is no such drive.
    """
    known: tuple[Drive, ...] = get_args(Drive)
    if text == "both":
        return known
    chosen = tuple(drive for drive in known if drive == text)
    if not chosen:
        raise UserError(f"--drive: {not_one_of('drive', text, [*known, 'both'])}")
    return chosen


def one_drive_of(text: str) -> Drive:
    """Return the one drive that ``--drive`` asks for.

    Raises:
        UserError: If there is no such drive, or both are asked for.
    """
    drives = drives_of(text)
    if len(drives) > 1:
        raise UserError(f"--drive: one at a time here: {', '.join(drives)}")
    return drives[0]


def planner_of(name: str, weights: str | None) -> PlannerSettings:
    """Return the settings of a planner with these weights.

    Args:
        name: Name of a planner.
        weights: (ω1, ω2) as ``1,1``; None for 1 and 1 where the planner takes weights at all.

    Raises:
        UserError: If there is no such planner, or it does not take such weights.
    """
    if name not in planner_names():
        raise UserError(f"--planner: {no_planner(name)}")
    model = settings_for(name)
    takes = "weights" in model.model_fields
    if weights is None:
        return model.model_validate({"name": name, **({"weights": (1.0, 1.0)} if takes else {})})
    if not takes:
        raise UserError(f"--weights: planner {name} takes none")
    try:
        pair = [float(part) for part in weights.split(",")]
        return model.model_validate({"name": name, "weights": tuple(pair)})
    except ValidationError as error:
        why = error.errors(include_url=False)[0]["msg"].splitlines()[0]
        raise UserError(f"--weights: {shorten(weights)}: {why}") from error
    except ValueError as error:
        raise UserError(f"--weights: must be two numbers such as 1,1, got {weights!r}") from error
