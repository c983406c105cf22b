"""The picture of an instant: the film's map, drawn for an episode that may still go on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.trajectory import Trajectory
from fuzzyq_bullet.video.map import Map
from fuzzyq_bullet.video.timeline import Timeline, sensed_at


def picture(trajectory: Trajectory) -> NDArray[np.uint8]:
    """Return the map at the end of a trajectory, RGB, shape (384, 372, 3)."""
    timeline = Timeline(trajectory)
    moment = timeline.at(timeline.end)
    hit = None if trajectory.collision is None else trajectory.collision.point
    patch = Map(trajectory).draw(moment, sensed_at(trajectory, moment.decision), hit)
    assert patch is not None  # a new map is drawn whole
    return np.array(patch.image)
