"""What a record shows in space, as entities of Foxglove's scenes (extra ``mcap``).

The world's frame is ``world``, the robot's ``base_link``: x forward, y left, z up (REP 103).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from foxglove.messages import (
    Color,
    CylinderPrimitive,
    Duration,
    FrameTransform,
    FrameTransforms,
    KeyValuePair,
    LinePrimitive,
    Point3,
    Pose,
    PosesInFrame,
    Quaternion,
    SceneEntity,
    SceneEntityDeletion,
    SceneEntityDeletionType,
    SceneUpdate,
    SpherePrimitive,
    TextPrimitive,
    Timestamp,
    TriangleListPrimitive,
    Vector3,
)

from fuzzyq_bullet.geometry import Floats
from fuzzyq_bullet.physics.camera import Mesh
from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT, WALL_HEIGHT
from fuzzyq_bullet.recording.trajectory import Ticks, Trajectory
from fuzzyq_bullet.robots import RobotModel
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.map.footprints import arrow
from fuzzyq_bullet.video.scene import meshes
from fuzzyq_bullet.video.timeline import sensed_at

WORLD, ROBOT = "world", "base_link"
SIDES = ("left", "middle", "right")

_LINE_WIDTH = 0.03
_MARK = 0.16
_FAINT = 0.25
"""Opacity of the ground that the robot would cover along a detection line."""


def stamp(time: int) -> Timestamp:
    """Return a time (ns) as Foxglove has it."""
    return Timestamp(time // 10**9, time % 10**9)


def world_entities(scenario: Scenario) -> SceneUpdate:
    """Return all that stands still: each obstacle, the walls, via points, the goal."""
    walls, moving = meshes.walls_of(scenario, meshes.EVERYWHERE), set(scenario.movers)
    goal = [meshes.goal_disc(scenario), *meshes.heading_mark(scenario)]
    entities = [_entity("goal", solids=goal)]
    for index, via in enumerate(scenario.via):
        disc = meshes.disc(via.position, via.radius)
        name, number = f"via[{index}]", index + 1
        text = _number_over(via.position, number)
        entities.append(_entity(name, solids=[disc], about={"number": number}, texts=[text]))
    if walls:
        wall = meshes.prisms(walls, 0.0, WALL_HEIGHT, style.WALL)
        entities.append(_entity("walls", solids=[wall]))
    for index, obstacle in enumerate(scenario.obstacles):
        if index in moving:
            continue
        solid = meshes.prisms(obstacle.pieces(), 0.0, OBSTACLE_HEIGHT, style.OBSTACLE)
        about = obstacle.model_dump(mode="json", exclude={"motion"})
        entities.append(_entity(f"obstacles[{index}]", solids=[solid], about=about))
    return SceneUpdate(entities=entities)


def _number_over(position: tuple[float, float], number: int) -> TextPrimitive:
    """Return a number that stands over a place (m) and always faces who looks."""
    return TextPrimitive(
        pose=_pose(*position, 0.3),
        billboard=True,
        font_size=0.3,
        scale_invariant=False,
        color=_colour(style.GOAL),
        text=str(number),
    )


def mover_entities(scenario: Scenario) -> SceneUpdate:
    """Return all that moves, each in a frame of its own."""
    entities = []
    for index in scenario.movers:
        obstacle = scenario.obstacles[index]
        pieces = [piece - obstacle.position for piece in obstacle.pieces()]
        solids = [meshes.prisms(pieces, 0.0, OBSTACLE_HEIGHT, style.MOVER)]
        about = obstacle.model_dump(mode="json", exclude={"motion"})
        frame: dict[str, Any] = {"frame_id": mover_frame(index), "frame_locked": True}
        entities.append(_entity(f"obstacles[{index}]", solids=solids, about=about, **frame))
    return SceneUpdate(entities=entities)


def mover_frame(index: int) -> str:
    """Return what the frame of a moving obstacle is called."""
    return f"obstacle_{index}"


def mover_marks(scenario: Scenario, poses: Floats, headings: list[float], time: int) -> SceneUpdate:
    """Return an arrow on each moving obstacle that shows where it goes.

    Args:
        scenario: The scenario.
        poses: Where they are, shape (M, 3).
        headings: In which direction each goes (rad); NaN for none.
        time: When (ns).
    """
    top, arrows = OBSTACLE_HEIGHT + 0.005, []
    for index, (x, y, _), heading in zip(scenario.movers, poses.tolist(), headings, strict=True):
        if math.isnan(heading):
            continue
        obstacle = scenario.obstacles[index]
        nose = arrow((x, y), heading, min(obstacle.extent(), obstacle.thickness()))
        solid = meshes.prisms([nose], OBSTACLE_HEIGHT, top, style.CARD)
        arrows.append(_entity(f"heading of obstacles[{index}]", time, solids=[solid]))
    return _instead(arrows, time)


def robot_entities(model: RobotModel) -> SceneUpdate:
    """Return the robot in its own frame, with an arrow that shows which way it faces."""
    size = model.radius * (1.2 if model.is_disc else 0.75)
    outlines = [arrow((0.0, 0.0), 0.0, size)]
    nose = meshes.prisms(outlines, model.height, model.height + 0.005, style.CARD)
    body = [_cylinder(model)] if model.is_disc else []
    outline = np.array(model.footprint)
    low = 2.0 * model.sensor_height - model.height
    solids = [] if model.is_disc else [meshes.prisms([outline], low, model.height, style.ROBOT)]
    entity = SceneEntity(
        frame_id=ROBOT,
        id="robot",
        frame_locked=True,
        lifetime=Duration(0),
        timestamp=stamp(0),
        cylinders=body,
        triangles=[_triangles(solid) for solid in (*solids, nose)],
    )
    return SceneUpdate(entities=[entity])


def _cylinder(model: RobotModel) -> CylinderPrimitive:
    height = 2.0 * (model.height - model.sensor_height)
    return CylinderPrimitive(
        pose=_pose(0.0, 0.0, model.sensor_height),
        size=Vector3(x=2 * model.radius, y=2 * model.radius, z=height),
        bottom_scale=1.0,
        top_scale=1.0,
        color=_colour(style.ROBOT),
    )


def path_poses(ticks: Ticks) -> PosesInFrame:
    """Return the whole path."""
    pairs = zip(ticks.position.tolist(), ticks.heading.tolist(), strict=True)
    poses = [_pose(x, y, 0.0, heading) for (x, y), heading in pairs]
    return PosesInFrame(timestamp=stamp(0), frame_id=WORLD, poses=poses)


def frames(time: int, poses: Mapping[str, tuple[float, float, float]]) -> FrameTransforms:
    """Return where frames are at a time (ns): by name the position (m, m) and turn (rad)."""
    transforms = [
        FrameTransform(
            timestamp=stamp(time),
            parent_frame_id=WORLD,
            child_frame_id=name,
            translation=Vector3(x=x, y=y, z=0.0),
            rotation=_turned(turn),
        )
        for name, (x, y, turn) in poses.items()
    ]
    return FrameTransforms(transforms=transforms)


def detection_lines(trajectory: Trajectory, index: int, time: int) -> SceneUpdate:
    """Return the detection lines of a decision in place of those before; none if it has none.

    Args:
        trajectory: The record.
        index: Which decision.
        time: When it was taken (ns).
    """
    sensed = sensed_at(trajectory, index)
    height = trajectory.scenario.robot.spec.sensor_height
    entities = []
    if sensed is not None:
        for side, colour, line, corridor in zip(
            SIDES, style.LINES, sensed.lines, sensed.corridors, strict=False
        ):
            (x, y), (heading, length) = sensed.origin, line
            reach = sensed.radius + length
            tip = (x + reach * math.cos(heading), y + reach * math.sin(heading))
            stroke = LinePrimitive(
                pose=_pose(0.0, 0.0, 0.0),
                thickness=_LINE_WIDTH,
                points=[Point3(x=one[0], y=one[1], z=height) for one in ((x, y), tip)],
                color=_colour(colour),
            )
            cover = TriangleListPrimitive(
                pose=_pose(0.0, 0.0, 0.0),
                points=[Point3(x=one, y=other, z=0.01) for one, other in corridor.tolist()],
                color=_colour(colour, _FAINT),
                indices=[k for last in range(2, len(corridor)) for k in (0, last - 1, last)],
            )
            entities.append(_entity(side, time, lines=[stroke], triangles=[cover]))
    return _instead(entities, time)


def aim_marks(trajectory: Trajectory, index: int, time: int) -> SceneUpdate:
    """Return what a decision aims at, and its temporary goal, in place of those before.

    Args:
        trajectory: The record.
        index: Which decision.
        time: When it was taken (ns).
    """
    sensed = sensed_at(trajectory, index)
    marks = (
        ()
        if sensed is None
        else (
            ("aim", style.AIM, sensed.aim),
            ("temporary goal", style.TARGET, sensed.target),
        )
    )
    entities = [
        _entity(
            name,
            time,
            spheres=[
                SpherePrimitive(
                    pose=_pose(*point, _MARK / 2),
                    size=Vector3(x=_MARK, y=_MARK, z=_MARK),
                    color=_colour(colour),
                )
            ],
        )
        for name, colour, point in marks
        if point is not None
    ]
    return _instead(entities, time)


def _instead(entities: list[SceneEntity], time: int) -> SceneUpdate:
    """Return entities that take the place of all that the topic has shown so far."""
    everything = SceneEntityDeletion(timestamp=stamp(time), type=SceneEntityDeletionType.All)
    return SceneUpdate(deletions=[everything], entities=entities)


def _entity(
    name: str,
    time: int = 0,
    *,
    solids: Iterable[Mesh] = (),
    about: Mapping[str, Any] | None = None,
    **primitives: Any,
) -> SceneEntity:
    """Return something that stays until it is deleted; in the world unless ``frame_id`` differs."""
    return SceneEntity(
        timestamp=stamp(time),
        id=name,
        lifetime=Duration(0),
        metadata=[KeyValuePair(key=key, value=str(value)) for key, value in (about or {}).items()],
        **{
            "frame_id": WORLD,
            "triangles": [_triangles(solid) for solid in solids],
            **primitives,
        },
    )


def _triangles(mesh: Mesh) -> TriangleListPrimitive:
    return TriangleListPrimitive(
        pose=_pose(0.0, 0.0, 0.0),
        points=[Point3(x=x, y=y, z=z) for x, y, z in mesh.vertices.tolist()],
        color=_colour(mesh.colour),
        indices=mesh.triangles.ravel().tolist(),
    )


def _colour(colour: style.Colour, opacity: float = 1.0) -> Color:
    red, green, blue = (part / 255 for part in colour)
    return Color(r=red, g=green, b=blue, a=opacity)


def _pose(x: float, y: float, z: float, heading: float = 0.0) -> Pose:
    return Pose(position=Vector3(x=x, y=y, z=z), orientation=_turned(heading))


def _turned(heading: float) -> Quaternion:
    return Quaternion(x=0.0, y=0.0, z=math.sin(heading / 2), w=math.cos(heading / 2))
