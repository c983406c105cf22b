"""A Gazebo world read from its outermost element down to the solids of its links."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import MAX_OBSTACLES
from fuzzyq_bullet.reading.xml_tree import Element, read_xml
from fuzzyq_bullet.robots.base import TALLEST
from fuzzyq_bullet.scenario.importers.foreign import (
    THIN,
    ForeignMap,
    ImportOptions,
    Obstacle,
    beside,
    too_many,
)
from fuzzyq_bullet.scenario.importers.gazebo import solids
from fuzzyq_bullet.scenario.importers.gazebo.meshes import bodies, read_mesh
from fuzzyq_bullet.scenario.importers.gazebo.poses import HERE, Matrix, Scope
from fuzzyq_bullet.scenario.importers.registry import register_importer
from fuzzyq_bullet.scenario.places import Bounds
from fuzzyq_bullet.wording import shorten

_MARGIN = 1.0
"""Free space around all that stands in a world (m)."""
_DEEPEST = 20
"""Most models in models, included ones too."""
_MOST_MODELS = 20_000
_NAMED = 6
_NO_BODIES = {
    "light": "lights: nothing to run into",
    "actor": "actors: obstacles stand still",
    "plugin": "plugins: programs of Gazebo",
    "joint": "joints: links stand where they are drawn",
    "road": "roads: nothing to run into",
    "population": "populations: models by number",
    "state": "saved states: models stand where their own poses put them",
    "sensor": "sensors: the robot has its own",
}


@register_importer(".world", ".sdf")
def gazebo_world(path: Path, options: ImportOptions) -> ForeignMap:
    """Read a world, or a single model, of Gazebo."""
    return _Reader(path, options).read()


class _Reader:
    """Reads one world, and the models that it includes."""

    def __init__(self, path: Path, options: ImportOptions) -> None:
        self._path = path
        self._folder = path.parent
        self._band = solids.Band(solids.FLAT, options.robot_model().height)
        self._obstacles: list[Obstacle] = []
        self._left: dict[str, list[str]] = {}
        self._changed: dict[str, list[str]] = {}
        self._headroom = math.inf
        self._files: dict[Path, Element] = {}
        self._models = self._depth = 0

    def read(self) -> ForeignMap:
        root = self._file(self._path)
        inner = [root] if root.tag == "world" else list(root.every("world", "model"))
        if root.tag not in ("sdf", "gazebo", "world") or not inner:
            raise UserError(f"{root.where}: expected <sdf> with a <world> or a <model> in it")
        for other in inner[1:]:
            self._leave("other worlds or models of the file: one is read", other.name)
        if inner[0].tag == "world":
            self._inside(inner[0], HERE, "", (self._path.resolve(),))
        else:
            self._model(inner[0], Scope(root).pose(inner[0]), "", (self._path.resolve(),))
        found = ForeignMap(self._bounds(), walls=False, obstacles=self._obstacles)
        found.left_out = [f"{why}: {_some(names)}" for why, names in self._left.items()]
        found.changed = [f"{why}: {_some(names)}" for why, names in self._changed.items()]
        if self._headroom < TALLEST:
            found.headroom = self._headroom
        return found

    def _inside(self, element: Element, pose: Matrix, name: str, files: tuple[Path, ...]) -> None:
        """Read what is in a world or a model.

        Args:
            element: The world or the model.
            pose: Its pose in the world.
            name: Its name, with those around it.
            files: Files that include one another, the one it is in last.
        """
        scope = Scope(element)
        for child in element.children:
            inner = f"{name}/{child.name}".lstrip("/")
            if child.tag == "link":
                self._link(child, scope, pose, inner)
            elif child.tag == "model":
                self._model(child, pose @ scope.pose(child), inner, files)
            elif child.tag == "include":
                self._include(child, scope, pose, name, files)
            elif child.tag in _NO_BODIES:
                self._leave(_NO_BODIES[child.tag], inner)

    def _model(self, element: Element, pose: Matrix, name: str, files: tuple[Path, ...]) -> None:
        self._models += 1
        if self._models > _MOST_MODELS:
            raise UserError(f"{element.where}: more than {_MOST_MODELS} models")
        if element.attributes.get("placement_frame"):
            raise UserError(f"{element.where}: placement_frame is not known here; give a <pose>")
        if self._depth >= _DEEPEST:
            raise UserError(f"{element.where}: models nested deeper than {_DEEPEST} levels")
        before = len(self._obstacles)
        name = name or element.name
        self._depth += 1
        self._inside(element, pose, name, files)
        self._depth -= 1
        static = element.first("static")
        is_static = static is not None and static.text.strip() in ("1", "true")
        if not is_static and len(self._obstacles) > before:
            self._change("models that can be pushed in Gazebo stand still here", name)

    def _include(
        self, element: Element, scope: Scope, pose: Matrix, name: str, files: tuple[Path, ...]
    ) -> None:
        uri = element.need("uri")
        path = self._included(uri, files[-1].parent)
        own_name = element.first("name")
        title = (own_name.text.strip() if own_name else "") or uri.text.strip()
        inner = f"{name}/{title[:60]}".lstrip("/")
        if path is None:
            self._leave("includes that do not lie beside the file", inner)
            return
        real = path.resolve()
        if real in files:
            raise UserError(f"{uri.where}: {shorten(uri.text.strip())} includes itself in the end")
        if element.first("placement_frame") is not None:
            raise UserError(f"{element.where}: placement_frame is not known here; give a <pose>")
        root = self._file(path)
        model = root.first("model")
        if model is None:
            raise UserError(f"{root.where}: expected <sdf> with a <model> in it")
        given = element.first("pose")
        there = scope.pose(element, given) if given else Scope(root).pose(model)
        self._model(model, pose @ there, inner, (*files, real))

    def _included(self, uri: Element, folder: Path) -> Path | None:
        """Return the file that an include means; None if it is not beside the world."""
        for candidate in self._candidates(uri, folder):
            if candidate.is_dir() and (candidate / "model.sdf").is_file():
                return candidate / "model.sdf"
            if candidate.is_file():
                return candidate
        return None

    def _candidates(self, uri: Element, folder: Path) -> Iterator[Path]:
        """Yield where a file may lie that a URI names, all in the world's folder or below.

        Raises:
            UserError: If it names a place outside.
        """
        text = uri.text.strip()
        scheme, _, rest = text.rpartition("://")
        if scheme in ("http", "https"):
            return
        roots = [self._folder, self._folder / "models"] if scheme == "model" else []
        for root in [folder, *roots, folder.parent]:
            if not root.resolve().is_relative_to(self._folder.resolve()):
                continue
            try:
                inside = (root / rest).resolve().is_relative_to(self._folder.resolve())
                there = inside and (root / rest).exists()
            except (OSError, ValueError, RuntimeError):  # a name too long, a null character
                continue
            if not inside and root == folder:
                beside(self._folder, rest, uri.where)  # says where it lies
                raise UserError(f"{uri.where}: {shorten(text)} lies outside {self._folder}")
            if there:
                yield root / rest

    def _link(self, link: Element, scope: Scope, pose: Matrix, name: str) -> None:
        base = scope.pose(link)
        parts = list(link.every("collision"))
        if not parts and link.first("visual") is not None:
            self._leave("links that are only seen: nothing to run into", name)
        for child in link.every(*_NO_BODIES):
            self._leave(_NO_BODIES[child.tag], f"{name}/{child.name}")
        for part in parts:
            inner = f"{name}/{part.name}"
            there = pose @ scope.within(base, part)
            geometry = part.need("geometry")
            for kind in geometry.children:
                try:
                    found = self._solid(kind, there, inner)
                except solids.NotHere as reason:
                    self._leave(f"what {reason}", inner)
                    self._lower(reason.bottom)
                    continue
                for one in found:
                    self._obstacles.append(one.obstacle)
                    if one.grown:
                        self._change(f"what is thinner than {THIN:g} m is grown to that", inner)
                    if one.spreads:
                        self._lower(self._band.high)
                if len(self._obstacles) > 20 * MAX_OBSTACLES:
                    raise UserError(too_many(self._path, len(self._obstacles)))

    def _solid(self, kind: Element, pose: Matrix, name: str) -> list[solids.Solid]:
        """Return the obstacles that a geometry is at the robot's height.

        Raises:
            NotHere: If it is none.
            UserError: If it is wrong.
        """
        band = self._band
        if kind.tag == "box":
            size = np.array(kind.need("size").numbers(3, positive=True))
            return [solids.box(size, pose, band)]
        if kind.tag in ("cylinder", "capsule"):
            radius = kind.need("radius").numbers(1, positive=True)[0]
            length = kind.need("length").numbers(1, positive=True)[0]
            if kind.tag == "cylinder":
                return [solids.cylinder(radius, length, pose, band)]
            return [solids.ellipsoid(np.full(3, radius), pose, band, stretch=length)]
        if kind.tag == "sphere":
            radius = kind.need("radius").numbers(1, positive=True)[0]
            return [solids.ellipsoid(np.full(3, radius), pose, band)]
        if kind.tag == "ellipsoid":
            radii = np.array(kind.need("radii").numbers(3, positive=True))
            return [solids.ellipsoid(radii, pose, band)]
        if kind.tag == "polyline":
            points = np.array([one.numbers(2) for one in kind.every("point")]).reshape(-1, 2)
            if len(points) > 1 and np.array_equal(points[0], points[-1]):
                points = points[:-1]
            height = kind.need("height").numbers(1, positive=True)[0]
            return [solids.prism(points, height, pose, band)]
        if kind.tag == "mesh":
            return self._mesh(kind, pose, name)
        if kind.tag not in ("plane", "empty"):  # a plane is the ground
            self._leave(f"{kind.tag[:40]}s: no solids that are read", name)
        return []

    def _mesh(self, kind: Element, pose: Matrix, name: str) -> list[solids.Solid]:
        uri = kind.need("uri")
        path = next((one for one in self._candidates(uri, kind.path.parent) if one.is_file()), None)
        if path is None:
            self._leave("meshes that do not lie beside the file", f"{name} ({uri.text.strip()})")
            return []
        scale = kind.first("scale")
        points, triangles = read_mesh(path, uri.where)
        points = points * (scale.numbers(3) if scale else 1.0)
        points = points @ pose[:3, :3].T + pose[:3, 3]
        self._band.refuse(float(points[:, 2].min()), float(points[:, 2].max()))
        parts = (self._part(points, body) for body in bodies(points, triangles))
        found = [part for part in parts if part is not None]
        if not found:
            raise solids.NotHere("has nothing at the height of the robot")
        self._change("parts of meshes are their convex outlines at the robot's height", name)
        return found

    def _part(self, points: solids.Floats, body: NDArray[np.intp]) -> solids.Solid | None:
        """Return what of a part of a mesh the robot could touch; None for nothing."""
        try:
            return solids.outline(points, body, self._band)
        except solids.NotHere as reason:
            self._lower(reason.bottom)
            return None

    def _bounds(self) -> Bounds:
        if not self._obstacles:
            return Bounds(-5.0, -5.0, 5.0, 5.0)
        corners = []
        for one in self._obstacles:
            if one["shape"] == "polygon":
                corners += one["points"]
            else:
                (x, y), (length, width) = one["position"], one.get("size", (0.0, 0.0))
                cos, sin = (abs(f(one.get("yaw", 0.0))) for f in (math.cos, math.sin))
                dx = one.get("radius", (cos * length + sin * width) / 2)
                dy = one.get("radius", (sin * length + cos * width) / 2)
                corners += [(x - dx, y - dy), (x + dx, y + dy)]
        low, high = np.min(corners, axis=0) - _MARGIN, np.max(corners, axis=0) + _MARGIN
        left, bottom = (float(np.floor(edge * 10) / 10) for edge in low)
        right, top = (float(np.ceil(edge * 10) / 10) for edge in high)
        return Bounds(left, bottom, right, top)

    def _file(self, path: Path) -> Element:
        real = path.resolve()
        if real not in self._files:
            self._files[real] = read_xml(path, "a world of Gazebo")
        return self._files[real]

    def _leave(self, why: str, name: str) -> None:
        self._left.setdefault(why, []).append(name)

    def _change(self, what: str, name: str) -> None:
        self._changed.setdefault(what, []).append(name)

    def _lower(self, height: float) -> None:
        """Note that a robot taller than this (m) could touch what is no obstacle here."""
        self._headroom = min(self._headroom, height)


def _some(names: list[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more
