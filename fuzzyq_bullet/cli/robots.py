"""``fuzzyq robots``: which robots there are, as a table, as JSON, or side by side in a picture."""

from __future__ import annotations

from json import dumps
from pathlib import Path
from typing import Annotated, Any

import typer

from fuzzyq_bullet.cli.options import Json, PluginOption
from fuzzyq_bullet.errors import UserError

_HEADINGS = ("name", "footprint m", "track m", "wheel m", "mass kg", "m/s", "rad/s")


def robots(
    *,
    json: Json = False,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a picture of all of them side by side (.png)."),
    ] = None,
    plugin: PluginOption = None,
) -> None:
    """List the robots that a scenario can ask for.

    Raises:
        UserError: If the picture cannot be written.
    """
    from fuzzyq_bullet.robots import robot_model, robot_names

    models = [robot_model(name) for name in robot_names()]
    if picture is not None:
        _write_picture(picture, models)
    if json:
        typer.echo(dumps({model.name: _figures(model) for model in models}, indent=2))
        return
    rows = [_HEADINGS, *(_row(model) for model in models)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(_HEADINGS))]
    for row in rows:
        typer.echo("  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip())


def _row(model: Any) -> tuple[str, ...]:
    a_disc = f"disc r {model.radius:g}"
    footprint = a_disc if model.size is None else f"{model.size[0]:g} x {model.size[1]:g}"
    numbers = (model.track, model.wheel_radius, _mass(model), model.max_speed, model.max_turn_rate)
    return (model.name, footprint, *(f"{number:g}" for number in numbers))


def _mass(model: Any) -> float:
    return round(float(model.mass + 2 * model.wheel_mass), 3)


def _figures(model: Any) -> dict[str, Any]:
    keys = {"radius", "height", "track", "wheel_radius", "max_speed", "max_turn_rate"}
    keys |= {"acceleration", "turn_acceleration", "source"}
    told: dict[str, Any] = model.model_dump(mode="json", include=keys)
    told["footprint"] = None if model.is_disc else [list(p) for p in model.footprint]
    return {**told, "mass": _mass(model)}


def _write_picture(path: Path, models: list[Any]) -> None:
    from PIL import Image

    from fuzzyq_bullet.files import written_beside
    from fuzzyq_bullet.physics.portrait import portrait

    if path.suffix.lower() != ".png":
        raise UserError(f"--picture: {path}: must end in .png")
    image = Image.fromarray(portrait(models))
    with written_beside(path) as part:
        image.save(part)
