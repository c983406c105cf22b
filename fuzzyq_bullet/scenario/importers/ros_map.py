"""Maps of the ROS ``map_server``: a YAML file beside a picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario.importers.cells import grid_map
from fuzzyq_bullet.scenario.importers.foreign import ForeignMap, ImportOptions, beside
from fuzzyq_bullet.scenario.importers.images import cell_size, read_grey
from fuzzyq_bullet.scenario.importers.registry import register_importer
from fuzzyq_bullet.scenario.importers.yaml_keys import keys_in, read_yaml
from fuzzyq_bullet.wording import shorten


def _is_map(path: Path) -> bool:
    return {"image", "resolution"} <= keys_in(path)


@register_importer(".yaml", ".yml", claims=_is_map)
def ros_map(path: Path, options: ImportOptions) -> ForeignMap:
    """Read a map as ``map_server`` does in the mode ``trinary``.

    A pixel is occupied by (255 − brightness)/255, or by brightness/255 with ``negate``. Above
    ``occupied_thresh`` it is blocked, below ``free_thresh`` free, and else unknown. The origin is
    the pose of the lower left pixel's lower left corner.
    """
    given = read_yaml(path, "a map of map_server")
    name = given.get("image")
    if not isinstance(name, str) or not name:
        raise UserError(f"{given.where('image')}: expected a file's name, got {shorten(name)}")
    cell = given.number("resolution")
    if options.resolution is None:
        cell_size(cell, given.where("resolution"))
    else:
        cell = cell_size(options.resolution, "--resolution")
    x, y, *turn = given.numbers("origin", 2, 3)
    for i, value in enumerate((x, y)):
        if abs(value) > 1e6:
            raise UserError(f"{given.where('origin')}[{i}]: {value:g} m is too far away")
    given.one_of("mode", ("trinary",), "trinary")
    occupied = given.number("occupied_thresh", 0.65, least=0.0, most=1.0)
    free = given.number("free_thresh", 0.196, least=0.0, most=1.0)
    if free > occupied:
        raise UserError(
            f"{given.where('free_thresh')}: {free:g} is above occupied_thresh, {occupied:g}"
        )
    negate = given.get("negate")
    if negate not in (None, 0, 1):
        raise UserError(f"{given.where('negate')}: expected 0 or 1, got {shorten(negate)}")
    bright = read_grey(beside(path.parent, name, given.where("image")))
    taken = bright if negate else 1.0 - bright
    blocked, unknown = taken > occupied, (taken >= free) & (taken <= occupied)
    is_blocked = options.unknown == "blocked"
    found = grid_map(
        path,
        blocked | unknown if is_blocked else blocked,
        cell,
        options,
        origin=(x, y),
        yaw=turn[0] if turn else 0.0,
        border=is_blocked,
    )
    count = int(np.count_nonzero(unknown))
    if count:
        found.changed.append(
            f"{count} unknown cells of {unknown.size}: taken as {options.unknown} (--unknown)"
        )
    return found
