"""What a frame shows: every part in its place, hidden things hidden, texts in their boxes."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet.recording.trajectory import Collision, Decisions, Ticks
from fuzzyq_bullet.scenario import Arena, Box, Cylinder
from fuzzyq_bullet.scenario.places import Via
from fuzzyq_bullet.video import frame, paint, style
from fuzzyq_bullet.video.captions import outcome_lines
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.map.avoidance import Avoidance
from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.panels import Canvas
from fuzzyq_bullet.video.panels.rules import Rules
from fuzzyq_bullet.video.record import moments
from fuzzyq_bullet.video.scene.scene import Scene
from fuzzyq_bullet.video.style import FUZZIFICATION, MAP, RULES, SCENE, SENSORS, Rect
from fuzzyq_bullet.video.timeline import Timeline, sensed_at
from tests.helpers.synthetic import drive, modes, scenario

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion


pytestmark = pytest.mark.usefixtures("still_once")


Pixels: TypeAlias = np.ndarray[Any, np.dtype[np.uint8]]


def pixels(image: Image.Image | Pixels, rect: Rect) -> np.ndarray[Any, np.dtype[np.int64]]:
    return np.asarray(image)[rect.y : rect.bottom, rect.x : rect.right].astype(np.int64)


def count(image: np.ndarray[Any, Any], colour: style.Colour, tolerance: int = 12) -> int:
    return int((np.abs(image - colour).max(axis=-1) <= tolerance).sum())


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return drive()


@pytest.fixture(scope="module")
def middle(run: Trajectory) -> Pixels:
    return frame(run, 5.5)


@pytest.mark.slow
def test_the_scene_shows_robot_lines_and_goal(middle: Pixels) -> None:
    scene = pixels(middle, SCENE)
    assert count(scene, style.GOAL, 30) > 100
    assert count(scene, style.ROBOT, 40) > 300
    for colour in style.LINES[1:]:  # the left one is short at this moment
        assert count(scene, colour, 60) > 50


def test_the_map_shows_path_goal_and_three_lines_at_their_length(run: Trajectory) -> None:
    run = aiming(run, (math.nan, math.nan))  # the mark of the aim has the colour of a line
    area = pixels(frame(run, 7.0), MAP)
    scale = 34.4  # pixels a metre: 10 m on 344 pixels
    assert count(area, style.GOAL, 30) > 30
    assert count(area, style.PATH, 20) > 3 * scale
    sensed = sensed_at(run, Timeline(run).at(7.0).decision)
    assert sensed is not None
    for colour, (_, length) in zip(style.LINES, sensed.lines, strict=True):
        # A line 3.6 pixels wide, about two of which are of its pure colour.
        assert count(area, colour, 40) == pytest.approx(length * scale * 3, rel=0.45)


def aiming(run: Trajectory, at: tuple[float, float]) -> Trajectory:
    """Return the record with another aim (m)."""
    aim = np.tile(at, (len(run.decisions.tick), 1))
    return replace(run, decisions=replace(run.decisions, aim=aim))


def test_the_aim_is_marked_where_it_is_in_scene_and_map(run: Trajectory) -> None:
    """The mark has four strokes in the colour of the middle line, and is open in the middle."""
    place = (7.5, 5.0)
    shown, plain = (frame(aiming(run, at), 5.5) for at in (place, (math.nan, math.nan)))
    scene = Scene(run)
    seen = scene.lens.project(np.array([(*place, 0.0)]))[0]
    scene.close()
    for rect, at in ((MAP, Map(run).spot([place])[0]), (SCENE, seen)):
        before, after = (pixels(one, rect)[:-20] for one in (plain, shown))  # without the legend
        changed = np.argwhere(np.abs(after - before).max(axis=-1) > 8)
        assert len(changed) > 60
        assert changed.mean(axis=0)[::-1] == pytest.approx(at - 0.5, abs=0.6)
        assert np.ptp(changed, axis=0).max() <= 34, "nothing else may change"
        assert 60 < count(after, style.AIM, 40) - count(before, style.AIM, 40) < 250
        x, y = at.astype(int).tolist()
        assert (after[y - 1 : y + 2, x - 1 : x + 2] == before[y - 1 : y + 2, x - 1 : x + 2]).all()


def test_the_rule_that_fires_most_is_the_brightest(run: Trajectory) -> None:
    time = 5.0
    index = DecisionHold(run).at(Timeline(run).at(time))
    fired = run.decisions.rules[index]
    image = pixels(frame(run, time), RULES)
    left, top, wide, high = 86, 48, 36, 32
    light = np.array(
        [
            [image[top + r * high + 4, left + (4 - c) * wide + 4].sum() for c in range(5)]
            for r in range(5)
        ]
    )
    # Brightness has 32 steps: two rules within one of them look the same.
    assert fired.ravel()[light.argmax()] == pytest.approx(fired.max(), abs=0.03)
    assert fired.max() > 2.0 * np.median(fired)
    # And the whole table is in order, as far as its steps of brightness tell.
    order = np.argsort(fired.ravel())
    assert (np.diff(light.ravel()[order]) >= -6).all()


@pytest.mark.slow
def test_an_obstacle_in_front_hides_the_robot() -> None:
    world = scenario(0, 0, start=(2.0, 4.0), goal=(8.0, 4.0))
    free = drive(world, seconds=0.0)
    scene = Scene(free)
    toward = np.subtract(scene.lens.eye[:2], (2.0, 4.0))
    at = np.array((2.0, 4.0)) + toward / np.linalg.norm(toward) * 0.27
    scene.close()
    wall = Box(shape="box", position=(float(at[0]), float(at[1])), size=(0.9, 0.1))
    # The same record with the box put in front of the robot: same camera, same pose.
    hidden = replace(free, scenario=world.model_copy(update={"obstacles": (wall,)}))
    before, after = (pixels(frame(one, 0.0), SCENE) for one in (free, hidden))
    assert count(before, style.ROBOT, 40) > 200
    # From above, a box of 0.4 m leaves the far part of the robot's lid in sight.
    assert 0 < count(after, style.ROBOT, 40) < 0.75 * count(before, style.ROBOT, 40)
    behind = wall.model_copy(update={"position": (float(4 - at[0]), float(8 - at[1]))})
    shown = replace(free, scenario=world.model_copy(update={"obstacles": (behind,)}))
    assert count(pixels(frame(shown, 0.0), SCENE), style.ROBOT, 40) == pytest.approx(
        count(before, style.ROBOT, 40), rel=0.05
    )


def test_a_robot_out_of_the_picture_is_left_out(run: Trajectory) -> None:
    scene = Scene(run)
    moment = replace(Timeline(run).at(0.0), position=(500.0, 500.0))
    scene.draw(moment, None)
    moment = replace(moment, position=(*np.add(scene.lens.eye[:2], (0.0, -50.0)),))
    scene.draw(moment, None)
    scene.close()


def assembled(run: Trajectory, until: float) -> Image.Image:
    image = Image.new("RGB", (style.WIDTH, style.HEIGHT), style.PAGE)
    timeline = Timeline(run)
    with Compositor(run) as compositor:
        for moment in moments(timeline, 1.0):
            if moment.time > until + 1e-6:
                break
            for region in compositor.changes(moment):
                image.paste(region.image, (region.x, region.y))
    return image


@pytest.mark.slow
def test_redrawing_only_what_changed_gives_the_same_frame(run: Trajectory) -> None:
    until = 6.0
    step_by_step, at_once = assembled(run, until), frame(run, until)
    a, b = (np.asarray(image).astype(int) for image in (step_by_step, at_once))
    differs = np.abs(a - b).max(axis=-1) > 60
    # Shifts of less than half a pixel are left out, which shows on edges. Something not wiped
    # away, or forgotten, would be hundreds of pixels.
    assert differs.sum() <= 120, differs.sum()


KINDS = (
    "goal",
    "collision",
    "wall",
    "stuck",
    "breakout",
    "following",
    "blank",
    "one tick",
    "no obstacles",
    "a thousand",
    "huge",
    "tiny",
    "long",
    "no walls",
)


def everything() -> dict[str, Trajectory]:
    plain = drive(scenario(12, 2), seconds=4.0, outcome="timeout")
    hit = Collision(4.0, (2.0, 4.2), 3, 12.0)
    return {
        "goal": drive(scenario(6, 1, start=(7.0, 5.0)), seconds=30.0),
        "collision": replace(plain, outcome="collision", collision=hit),
        "wall": replace(plain, outcome="collision", collision=replace(hit, obstacle=-1)),
        "stuck": replace(plain, outcome="stuck"),
        "breakout": modes(plain, (0, 0.2), (1, 0.8)),
        "following": modes(plain, (2, 1.0)),
        "blank": drive(scenario(12, 2), seconds=2.0, explained=False),
        "one tick": drive(seconds=0.0),
        "no obstacles": drive(scenario(0, 0), seconds=2.0),
        "a thousand": drive(
            scenario(1000, 10, size=(40.0, 40.0), start=(2.0, 2.0), goal=(38.0, 38.0)), seconds=2.0
        ),
        "huge": drive(
            scenario(10, 2, size=(1000.0, 1000.0), start=(5.0, 5.0), goal=(900.0, 800.0)),
            seconds=2.0,
        ),
        "tiny": drive(
            scenario(0, 0, size=(1.2, 1.2), start=(0.4, 0.4), goal=(0.8, 0.8)), seconds=2.0
        ),
        "long": drive(scenario(20, 2, size=(40.0, 4.0), start=(1, 2), goal=(39, 2)), seconds=2.0),
        "no walls": drive(
            scenario(5, 0).model_copy(
                update={
                    "arena": Arena(walls=False),
                    "name": "a" * 100,
                    "seed": 2**63 - 1,
                    "drive": "kinematic",
                    "obstacles": (
                        Cylinder(shape="cylinder", position=(-900.0, 5.0), radius=900.5),
                        Box(shape="box", position=(5.0, -500.0), size=(900.0, 1000.0), yaw=0.001),
                    ),
                }
            ),
            seconds=2.0,
        ),
    }


@pytest.fixture(scope="module")
def all_runs() -> dict[str, Trajectory]:
    runs = everything()
    assert tuple(runs) == KINDS
    return runs


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_every_kind_of_run_is_drawn_with_all_text_in_its_box(
    all_runs: dict[str, Trajectory], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[tuple[Image.Image, tuple[float, ...], str]] = []
    real = paint.write

    def write(
        image: Image.Image,
        at: tuple[float, float],
        text: str,
        colour: style.Colour,
        size: int,
        *,
        bold: bool = False,
        align: str = "l",
    ) -> None:
        assert not text.endswith("…") or run.scenario.name == "a" * 100, f"{text} is cut short"
        width = style.text_width(text, size, bold)
        left = at[0] - {"l": 0.0, "m": width / 2, "r": width}[align]
        box = (left, at[1] - 0.74 * size, left + width, at[1])
        assert min(box[0], box[1] + 1) >= 0, text
        assert max(box[2] - image.width, box[3] - image.height) <= 0, text
        for other, theirs, said in written:
            if other is image:
                apart = (
                    theirs[2] <= box[0] + 1
                    or box[2] <= theirs[0] + 1
                    or theirs[3] <= box[1] + 1
                    or box[3] <= theirs[1] + 1
                )
                assert apart, f"{text!r} over {said!r}"
        written.append((image, box, text))
        real(image, at, text, colour, size, bold=bold, align=align)

    monkeypatch.setattr(paint, "write", write)
    for room in ("scene", "solid_movers"):  # smooth edges take time, and are no text
        monkeypatch.setattr(f"fuzzyq_bullet.video.scene.{room}.DETAIL", 1)
    run = all_runs[name]
    regions: list[DirtyRegion] = []
    with Compositor(run) as compositor:
        for number, moment in enumerate(moments(Timeline(run), 1.0)):
            if number % 15 == 0 or moment.over:
                written.clear()
                regions += compositor.changes(moment)
    assert {(SCENE.x, SCENE.y), (MAP.x, MAP.y), (FUZZIFICATION.x, FUZZIFICATION.y)} <= {
        (region.x, region.y) for region in regions
    }
    for x, y, image in regions:
        assert x % 2 == y % 2 == image.width % 2 == image.height % 2 == 0
        assert min(x, y) >= 0
        assert x + image.width <= style.WIDTH
        assert y + image.height <= style.HEIGHT


@pytest.mark.slow
def test_the_robot_can_be_seen_in_any_arena(all_runs: dict[str, Trajectory]) -> None:
    for name in ("a thousand", "huge", "tiny", "long"):
        picture = frame(all_runs[name], 1.0)
        for rect in (SCENE, MAP):
            assert count(pixels(picture, rect), style.ROBOT, 30) > 12, (name, rect)


def map_at(run: Trajectory, time: float, *before: float) -> np.ndarray[Any, Any]:
    """Return the map at a time (s), drawn at once or after moments before."""
    drawn, timeline = Map(run), Timeline(run)
    image = Image.new("RGB", (style.WIDTH, style.HEIGHT), style.PAGE)
    for when in (*before, time):
        moment = timeline.at(when)
        patch = drawn.draw(moment, sensed_at(run, moment.decision))
        if patch is not None:
            image.paste(patch.image, (patch.x, patch.y))
    return pixels(image, MAP)


def test_a_robot_that_came_back_to_where_it_was_left_its_way_on_the_map(
    run: Trajectory,
) -> None:
    columns = {name: np.concatenate([one, one[::-1]]) for name, one in vars(run.ticks).items()}
    columns["time"] = time = np.linspace(0.0, 2.0 * run.ticks.time[-1], 2 * len(run.ticks.time))
    back = replace(run, ticks=Ticks(**columns))
    assert count(map_at(back, float(time[-1])), style.PATH) > 100


def test_a_via_point_that_was_passed_is_filled_in_the_scene() -> None:
    plain = scenario(0, 0)
    via = (Via(position=(4.0, 4.75), radius=0.6),)
    run = drive(plain.model_copy(update={"via": via}))
    timeline, scene = Timeline(run), Scene(run)
    (x, y), image = scene.lens.project(np.array([[4.0, 5.2, 0.0]]))[0], None
    for time in (0.0, float(run.ticks.time[-1])):
        region = scene.draw(timeline.at(time), None)
        assert region is not None
        image = image or Image.new("RGB", (style.WIDTH, style.HEIGHT), style.PAGE)
        image.paste(region.image, (region.x, region.y))
        red, green, _ = image.getpixel((SCENE.x + round(x), SCENE.y + round(y)))
        assert (green > 1.5 * red) == (time > 0.0)
    scene.close()


def aimed(run: Trajectory, target: float) -> Trajectory:
    """Return the record with another target."""
    everywhere = np.full_like(run.decisions.target, target)
    return replace(run, decisions=replace(run.decisions, target=everywhere))


def test_the_target_is_marked_where_there_is_one(all_runs: dict[str, Trajectory]) -> None:
    run = all_runs["following"]
    shown, plain = (
        count(map_at(one, 2.0), style.TARGET, 40) for one in (run, aimed(run, math.nan))
    )
    assert shown > plain + 15
    assert count(map_at(all_runs["blank"], 2.0), style.TARGET, 40) == 0


def test_a_target_beyond_the_walls_is_not_marked(all_runs: dict[str, Trajectory]) -> None:
    run = all_runs["following"]
    assert (map_at(aimed(run, 10.05), 2.0) == map_at(aimed(run, math.nan), 2.0)).all()


TRAP = (
    Box(shape="box", position=(4.0, 7.2), size=(0.2, 1.6)),
    Box(shape="box", position=(3.3, 8.0), size=(1.6, 0.2)),  # touches the first
    Cylinder(shape="cylinder", position=(4.5, 7.3), radius=0.15),  # near, and touches none
    Cylinder(shape="cylinder", position=(8.0, 8.0), radius=0.4),
)


@pytest.fixture(scope="module")
def freed() -> Trajectory:
    """Return a drive that breaks out of a trap after 2 s, goes round it, and is free after 4 s."""
    world = scenario(0, 0, start=(3.2, 6.0), goal=(9.0, 2.0))
    plain = drive(world, seconds=6.0, outcome="timeout")
    moved = modes(plain, (0, 1 / 3), (1, 0.1), (2, 1 / 3 - 0.1))
    # The same record among obstacles: only what is drawn around the drive changes.
    return replace(moved, scenario=world.model_copy(update={"obstacles": TRAP}))


def test_what_the_robot_goes_round_is_outlined_with_all_that_touches_it(freed: Trajectory) -> None:
    facts = freed.decisions
    routine = replace(freed, decisions=replace(facts, mode=np.zeros_like(facts.mode)))
    spot = Map(freed).spot
    for time, shown in ((1.0, False), (3.0, True), (5.0, False)):
        outlined, plain = (map_at(one, time) for one in (freed, routine))
        for x0, y0, x1, y1 in ((3.8, 6.3, 4.2, 7.8), (2.4, 7.8, 3.7, 8.2), (7.4, 7.4, 8.6, 8.6)):
            (left, bottom), (right, top) = spot([(x0, y0), (x1, y1)]).round().astype(int).tolist()
            here = np.s_[top:bottom, left:right]
            more = count(outlined[here], style.TARGET, 60) - count(plain[here], style.TARGET, 60)
            assert (more > 60) == (shown and x0 < 7), (time, x0, more)
        if shown:  # what lies within, also where the two meet, keeps its colour
            (left, bottom), (right, top) = spot([(3.95, 6.5), (4.05, 8.0)]).round().astype(int)
            here = np.s_[top:bottom, left:right]
            assert count(outlined[here], style.OBSTACLE) == count(plain[here], style.OBSTACLE) > 50
    avoidance = Avoidance(freed)
    group = avoidance.group_at(int(np.flatnonzero(facts.mode == 2)[0]))
    assert group is not None
    assert avoidance.members(group) == list(TRAP[:2])


@pytest.mark.parametrize(
    ("start", "ends"),
    [
        ((0.5, 5.0), [(0, 0), (0, 10)]),
        ((5.0, 9.5), [(0, 10), (10, 10)]),
        ((9.5, 5.0), [(10, 10), (10, 0)]),
        ((5.0, 0.5), [(10, 0), (0, 0)]),
    ],
)
def test_a_wall_that_the_robot_goes_along_gets_a_line(
    start: tuple[float, float], ends: list[tuple[int, int]]
) -> None:
    run = modes(drive(scenario(0, 0, start=start, goal=(5.0, 5.0)), seconds=0.5), (2, 1.0))
    avoidance = Avoidance(run)
    group = avoidance.group_at(0)
    assert group is not None
    wall = avoidance.wall(group)
    assert wall is not None
    assert wall.tolist() == [list(end) for end in ends]
    x, y = Map(run).spot([np.mean(ends, axis=0)])[0].round().astype(int).tolist()
    around = map_at(run, 0.2)[y - 6 : y + 6, x - 6 : x + 6]
    assert count(around, style.TARGET, 40) >= 24


def test_what_is_outlined_changes_only_for_something_clearly_nearer() -> None:
    world = scenario(0, 0, size=(10.0, 10.0), start=(5.0, 5.0), goal=(9.0, 5.0))
    posts = tuple(
        Cylinder(shape="cylinder", position=(5.0, y), radius=0.2) for y in (6.0, 3.96, 4.2)
    )
    run = modes(drive(world, seconds=0.0), (2, 1.0))
    for kept, expected in ((posts[:2], 0), (posts[::2], 1)):
        one = replace(run, scenario=world.model_copy(update={"obstacles": kept}))
        assert Avoidance(one).group_at(0) == expected
    # From y = 5.0 the first post is nearer; at 4.96 the second is, by 6 cm, at 4.9 by 18 cm.
    facts, ticks = run.decisions, run.ticks
    three = {name: np.repeat(column, 3, axis=0) for name, column in vars(facts).items()}
    three["tick"] = np.arange(3)
    states = {name: np.repeat(column, 3, axis=0) for name, column in vars(ticks).items()}
    states["time"] = np.arange(3) / 4
    states["position"] = np.array([(5.0, 5.0), (5.0, 4.95), (5.0, 4.9)])
    several = replace(
        run,
        scenario=world.model_copy(update={"obstacles": posts[:2]}),
        ticks=Ticks(**states),
        decisions=Decisions(**three),
    )
    avoidance = Avoidance(several)
    assert [avoidance.group_at(k) for k in range(3)] == [0, 0, 1]


def test_where_a_way_out_began_and_ended_stays_marked_on_the_map(freed: Trajectory) -> None:
    marks = Avoidance(freed).marks
    assert [mark.begins for mark in marks] == [True, False]
    names = freed.decisions.mode.tolist()
    assert [mark.decision for mark in marks] == [names.index(1), len(names) - names[::-1].index(2)]
    places = [Map(freed).spot([mark.point])[0].round().astype(int).tolist() for mark in marks]
    seen, picture = [], map_at(freed, 0.0)
    for time in (1.5, 3.5, 5.9):
        picture = map_at(freed, time)
        for x, y in places:
            part = picture[y - 9 : y + 9, x - 9 : x + 9]
            seen.append(count(part, style.TARGET, 50) > 25)
    assert seen == [False, False, True, False, True, True]
    # A dot is full, a ring is not.
    dot, ring = (count(picture[y - 2 : y + 2, x - 2 : x + 2], style.TARGET, 50) for x, y in places)
    assert dot > 10
    assert ring == 0


def test_marks_that_would_cover_each_other_are_one() -> None:
    run = drive(scenario(0, 0), seconds=3.0, outcome="timeout")
    mode = np.arange(len(run.decisions.mode)) % 2  # breaks out anew at every other decision
    marks = Avoidance(replace(run, decisions=replace(run.decisions, mode=mode))).marks
    for begins in (True, False):
        points = [mark.point for mark in marks if mark.begins == begins]
        assert 2 < len(points) < mode.sum()
        assert min(math.dist(a, b) for a, b in combinations(points, 2)) > 0.05


def test_marks_and_outline_drawn_step_by_step_are_those_of_one_frame(freed: Trajectory) -> None:
    for until in (3.0, 5.9):
        steps = np.arange(0.0, until, 1 / 30).tolist()
        differs = np.abs(map_at(freed, until, *steps) - map_at(freed, until)).max(axis=-1) > 60
        assert differs.sum() <= 30, (until, differs.sum())


def test_rules_are_lit_whenever_they_are_asked_and_grey_when_they_are_not(
    freed: Trajectory,
) -> None:
    facts = freed.decisions
    gaps = replace(freed, decisions=replace(facts, exact=np.where(facts.mode == 2, 1.0, 0.0)))

    def table(*times: float, run: Trajectory = gaps) -> np.ndarray[Any, Any]:
        canvas = Canvas(RULES, "3  RULES THAT FIRE")
        panel = Rules(run, canvas)
        image = Image.new("RGB", (style.WIDTH, style.HEIGHT), style.PAGE)
        for time in times:
            moment = Timeline(run).at(time)
            panel.draw(replace(moment, shown=moment.decision))
            for region in canvas.take_changes():
                image.paste(region.image, (region.x, region.y))
        return pixels(image, RULES)

    def colourful(image: np.ndarray[Any, Any]) -> int:
        return int((np.ptp(image, axis=-1) > 40).sum())

    asked, greyed = table(1.0), table(3.0)
    assert colourful(asked) > 500
    assert colourful(greyed) == 0
    # A way out is no reason: where its aim leaves the rules a say, they are lit.
    assert colourful(table(3.0, run=freed)) > 500
    assert (asked[:28] != greyed[:28]).any(), "the title must say so"
    # Step by step too: all of it turns grey, and lights up again.
    assert (table(1.0, 3.0) == greyed).all()
    assert (table(3.0, 1.0) == asked).all()


def test_the_obstacle_that_was_hit_is_outlined_on_the_map(
    all_runs: dict[str, Trajectory],
) -> None:
    hit, wall = (
        count(pixels(frame(all_runs[name], 99.0), MAP), style.DANGER, 10)
        for name in ("collision", "wall")
    )
    assert hit > wall + 30


def test_a_collision_is_marked_on_the_map_and_in_the_scene(
    all_runs: dict[str, Trajectory],
) -> None:
    for rect in (MAP, SCENE):
        counts = [
            count(pixels(frame(all_runs["collision"], time), rect), style.DANGER, 10)
            for time in (3.9, 99.0)
        ]
        assert counts[1] > counts[0] + 40


def test_the_outcome_says_what_happened(all_runs: dict[str, Trajectory]) -> None:
    title, figures = outcome_lines(all_runs["goal"])
    assert title == "GOAL reached"
    assert "path" in figures
    assert "least clearance" in figures
    x, y = all_runs["collision"].scenario.obstacles[3].position
    title = f"COLLISION with the cylinder at ({x:.1f}, {y:.1f})"
    assert outcome_lines(all_runs["collision"])[0] == title
    assert outcome_lines(all_runs["wall"])[0] == "COLLISION with a wall"
    assert "at 4.0 s" in outcome_lines(all_runs["wall"])[1]
    assert outcome_lines(all_runs["stuck"])[0].startswith("STUCK")


def test_the_close_up_has_left_on_the_left(run: Trajectory) -> None:
    picture = frame(run, 7.0)
    close_up = pixels(picture, Rect(SENSORS.x + 8, SENSORS.y + 28, 174, 174))
    columns = [
        np.nonzero(np.abs(close_up - colour).max(axis=-1) <= 12)[1].mean() for colour in style.LINES
    ]
    assert columns[0] < columns[1] < columns[2]


# Machado, Oliveira and Fernandes 2009, severity 1.0.
_BLINDNESS = {
    "protan": [(0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216),
               (-0.003882, -0.048116, 1.051998)],
    "deutan": [(0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413),
               (-0.011820, 0.042940, 0.968881)],
    "tritan": [(1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602),
               (0.004733, 0.691367, 0.303900)],
}  # fmt: skip


@pytest.mark.parametrize("kind", list(_BLINDNESS))
def test_the_colour_blind_can_tell_the_lines_apart(kind: str) -> None:
    def seen(colour: style.Colour) -> np.ndarray[Any, Any]:
        linear = (np.array(colour) / 255) ** 2.2
        x, y, z = np.array(
            [(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)]
        ) @ np.clip(np.array(_BLINDNESS[kind]) @ linear, 0, 1)
        fx, fy, fz = np.cbrt((x / 0.9505, y, z / 1.089))
        return np.array((116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)))

    for a, b in combinations(style.LINES, 2):
        # CIE76: 2 is just noticeable, 20 is obvious side by side.
        assert math.dist(seen(a), seen(b)) > 25
