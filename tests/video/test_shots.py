"""A robot in a large arena is filmed from near, in several shots; in a small one all is in one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet.physics.obstacle_urdf import WALL_HEIGHT, WALL_THICKNESS
from fuzzyq_bullet.video import frame, style
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.scene.scene import Scene
from fuzzyq_bullet.video.scene.shots import SPAN, Shots
from fuzzyq_bullet.video.scene.viewpoint import lens_for
from fuzzyq_bullet.video.style import SCENE
from fuzzyq_bullet.video.timeline import Timeline
from tests.helpers.synthetic import drive, scenario

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory


@pytest.fixture(scope="module")
def far() -> Trajectory:
    world = scenario(40, 5, size=(60.0, 40.0), start=(5.0, 4.0), goal=(57.0, 36.0))
    run = drive(world, seconds=20.0, outcome="timeout")
    # The same record of a robot that drives five times as far.
    start = run.ticks.position[0]
    position = start + (run.ticks.position - start) * 5.0
    return replace(run, ticks=replace(run.ticks, position=position))


def test_a_way_in_a_small_arena_is_one_shot() -> None:
    assert len(Shots(drive(seconds=2.0))) == 1


@pytest.mark.parametrize("size", [(720, 720), (1280, 720), SCENE.size])
@pytest.mark.parametrize("goal", [(9.0, 9.0), (9.0, 1.0), (1.0, 9.0)])
def test_no_wall_is_cut_off_unless_the_arena_is_much_larger_than_the_way(
    size: tuple[int, int], goal: tuple[float, float]
) -> None:
    run = drive(scenario(4, 0, start=(1.0, 1.0), goal=goal), seconds=2.0)
    ends = (-WALL_THICKNESS, 10.0 + WALL_THICKNESS)
    corners = [(x, y, z) for x in ends for y in ends for z in (0.0, WALL_HEIGHT)]
    lens = lens_for(run, np.array([(1.0, 1.0), goal]), size)
    seen = lens.project(corners)
    margin = 0.01 * min(size)
    assert (seen > margin).all()
    assert (seen < np.array(size) - margin).all()
    near = lens_for(run, np.array([(1.0, 1.0), (3.0, 3.0)]), size)
    assert not ((near.project(corners) > 0) & (near.project(corners) < size)).all()


def test_shots_follow_one_another_and_none_spans_more_than_can_be_seen_from_near(
    far: Trajectory,
) -> None:
    shots = Shots(far)
    assert len(shots) > 3
    numbers = [shots.at(tick) for tick in range(len(far.ticks.time))]
    assert numbers[0] == 0
    assert set(np.diff(numbers)) == {0, 1}
    assert numbers[-1] == len(shots) - 1
    for number in range(len(shots)):
        path = far.ticks.position[np.array(numbers) == number]
        assert np.ptp(path, axis=0).max() <= SPAN + 1e-9


@pytest.mark.slow
def test_in_every_shot_robot_and_lines_are_legible_and_in_the_picture(far: Trajectory) -> None:
    scene, timeline = Scene(far), Timeline(far)
    shots = Shots(far)
    for number in range(len(shots)):
        for tick in (shots[number].tick, shots[number].tick + 3):
            moment = timeline.at(float(far.ticks.time[tick]))
            scene.draw(moment, None)
            x, y = moment.position
            ends = [(x - 0.2, y, 0.0), (x + 0.2, y, 0.0)]
            left, right = scene.lens.project(np.array(ends))
            assert np.hypot(*(right - left)) > 20, "pixels across the robot"
            assert 10 < left[0] < right[0] < SCENE.width - 10
            assert 10 < left[1] < SCENE.height - 10
    scene.close()


@pytest.mark.slow
def test_a_shot_looks_the_same_whatever_was_shown_before(far: Trajectory) -> None:
    shots, timeline = Shots(far), Timeline(far)
    times = [float(far.ticks.time[shots[k].tick]) + 0.2 for k in range(3)]
    image = Image.new("RGB", (style.WIDTH, style.HEIGHT), style.PAGE)
    with Compositor(far) as compositor:
        for time in times:
            for region in compositor.changes(timeline.at(time)):
                image.paste(region.image, (region.x, region.y))
    box = np.s_[SCENE.y : SCENE.bottom, SCENE.x : SCENE.right]
    after, at_once = (np.asarray(one)[box].astype(int) for one in (image, frame(far, times[-1])))
    assert (np.abs(after - at_once).max(axis=-1) > 60).sum() <= 60
