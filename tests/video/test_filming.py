"""The film as a tool: any size, view, part and format, with the frames that were asked for."""

from __future__ import annotations

import math
import re
import subprocess
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.filming import Filming, size_of
from fuzzyq_bullet.outputs import film_name, films_of
from fuzzyq_bullet.scenario import Cylinder
from fuzzyq_bullet.video import Canvas, View, frame, record, register_view, style
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.layout import Layout
from fuzzyq_bullet.video.race_map import COLOURS
from fuzzyq_bullet.video.scene.cameras import FixedCamera, FollowCamera
from fuzzyq_bullet.video.style import Rect
from fuzzyq_bullet.video.timeline import Timeline
from tests.helpers.synthetic import drive, scenario

if TYPE_CHECKING:
    from pathlib import Path

    from fuzzyq_bullet.recording.trajectory import Trajectory

pytestmark = pytest.mark.usefixtures("still_once")
SMALL = (320, 240)


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return drive(scenario(8, 1), seconds=2.0, outcome="timeout")


def facts(path: Path) -> tuple[int, str]:
    """Return the number of frames of a film, and what ffmpeg says of it."""
    program = imageio_ffmpeg.get_ffmpeg_exe()
    told = subprocess.run(
        [program, "-i", str(path), "-map", "0:v", "-f", "null", "-"],
        capture_output=True,
        text=True,
        check=True,
    ).stderr
    return int(re.findall(r"frame=\s*(\d+)", told)[-1]), told


@pytest.mark.parametrize(
    ("asked", "frames", "fps"),
    [
        ({}, 61 + 30, 30),
        ({"start": 0.5, "end": 1.5}, 30, 30),
        ({"start": 0.5, "end": 1.5, "fps": 50}, 50, 50),
        ({"start": 0.5, "end": 1.5, "fps": 24, "speed": 2.0}, 12, 24),
        ({"start": 1.0}, 31 + 30, 30),
        ({"end": 99.0, "fps": 10}, 21 + 10, 10),
    ],
)
def test_a_film_has_the_frames_that_were_asked_for_and_opens_in_a_browser(
    run: Trajectory, tmp_path: Path, asked: dict[str, Any], frames: int, fps: int
) -> None:
    path = tmp_path / "x.mp4"
    info = record(run, path, view="map", size=SMALL, **asked)
    assert info == (frames, pytest.approx(frames / fps), SMALL)
    counted, told = facts(path)
    assert counted == frames
    assert re.search(rf"h264 .*yuv420p\(tv, bt709.*320x240.* {fps} fps", told)
    head = path.read_bytes()
    assert head.index(b"moov") < head.index(b"mdat")


def test_a_part_begins_and_ends_when_it_should(run: Trajectory, tmp_path: Path) -> None:
    shown: list[float] = []
    film = Filming(start=0.5, end=1.5, speed=2.0)
    shown += film.times(0.0, 2.0, 10)
    assert shown == pytest.approx([0.5, 0.7, 0.9, 1.1, 1.3])
    *_, last = Filming(start=1.9).times(0.0, 2.0, 10)
    assert math.isinf(last), "without an end it closes with the outcome"
    with pytest.raises(UserError, match=r"start: 3 s is after the end of the run, 2\.00 s"):
        record(run, tmp_path / "x.mp4", view="map", start=3.0)


@pytest.mark.parametrize("fps", [7, 10, 24, 30])
def test_a_gif_plays_at_the_right_speed(run: Trajectory, tmp_path: Path, fps: int) -> None:
    path = tmp_path / "x.gif"
    info = record(run, path, view="map", size=SMALL, fps=fps, end=1.0)
    assert info.frames == fps
    with Image.open(path) as image:
        assert image.size == SMALL
        assert image.info["loop"] == 0
        lasts = []
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            lasts.append(image.info["duration"])
    assert sum(lasts) == pytest.approx(1000.0, abs=5), "to the hundredth of a second"
    assert min(lasts) >= 20, "browsers slow down what is quicker"


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"size": (321, 240)}, "size: width and height must be even"),
        ({"size": (8000, 240)}, "size: must be from 240x240"),
        ({"size": (3840, 3840)}, "size: must be from"),
        ({"size": "720p"}, "size: must be width and height"),
        ({"fps": 0}, "fps: must be a whole number from 1 to 120"),
        ({"fps": 500}, "fps: must be a whole number"),
        ({"start": -1.0}, "start: must be a number of seconds"),
        ({"end": math.nan}, "end: must be a number of seconds"),
        ({"start": 1.0, "end": 1.0}, r"end: must be later than start \(1 s\)"),
        ({"view": "sideways"}, "view: must be one of explain, scene, follow, map"),
    ],
)
def test_what_no_film_can_be_is_one_line(
    run: Trajectory, tmp_path: Path, asked: dict[str, Any], words: str
) -> None:
    with pytest.raises(UserError, match=words) as caught:
        record(run, tmp_path / "x.mp4", **asked)
    assert len(caught.value.problems) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_gif_that_memory_has_no_room_for_is_refused(run: Trajectory, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="too large for an animated picture: 1051 frames"):
        record(run, tmp_path / "x.gif", view="map", size=(1920, 1080), speed=0.1, fps=50)


@pytest.mark.parametrize(("text", "size"), [("1920x1080", (1920, 1080)), ("640X480", (640, 480))])
def test_a_size_is_written_as_everywhere(text: str, size: tuple[int, int]) -> None:
    assert size_of(text) == size


@pytest.mark.parametrize("size", [(1280, 720), (1920, 1080), (1080, 1080), (854, 480), (1024, 768),
                                  (1080, 1920), (2560, 1080), (242, 3840)])  # fmt: skip
def test_cards_cover_no_other_and_are_even(size: tuple[int, int]) -> None:
    layout = Layout.explaining(size)
    places = [layout.place(name) for name in layout.cards]
    for number, place in enumerate(places):
        assert all(value % 2 == 0 for value in place)
        assert 0 <= place.x < place.right <= size[0]
        assert 0 <= place.y < place.bottom <= size[1]
        for other in places[number + 1 :]:
            apart = (
                place.right <= other.x
                or other.right <= place.x
                or place.bottom <= other.y
                or other.bottom <= place.y
            )
            assert apart, (place, other)


def test_the_usual_film_lies_where_it_always_did() -> None:
    layout = Layout.explaining((1280, 720))
    assert layout.unit == 1.0
    assert layout.place("scene") == layout.cards["scene"] == style.SCENE
    assert layout.place("action") == style.ACTION


def test_a_part_of_an_enlarged_card_is_that_of_the_whole(run: Trajectory) -> None:
    """What is drawn anew of a card fits what was there, to the bit: no seams."""

    def card() -> Canvas:
        canvas = Canvas(Rect(10, 20, 200, 100), "TITLE", Rect(14, 28, 282, 142))
        canvas.write((100, 60), "some words", size=20, align="m")
        return canvas

    def shown(canvas: Canvas, image: Image.Image) -> np.ndarray[Any, Any]:
        for x, y, part in canvas.take_changes():
            image.paste(part, (x, y))
        return np.asarray(image)

    at_once, by_and_by = card(), card()
    picture = Image.new("RGB", (400, 300))
    shown(by_and_by, picture)
    for canvas in (at_once, by_and_by):
        canvas.line([(20, 80), (60, 71)], style.HEAT)
    whole = shown(at_once, Image.new("RGB", (400, 300)))
    assert (shown(by_and_by, picture) == whole).all()


@pytest.mark.slow
@pytest.mark.parametrize("view", ["explain", "scene", "follow", "map"])
@pytest.mark.parametrize("size", [(1280, 720), (1080, 1080), (640, 360)])
def test_every_view_shows_the_robot_at_every_size(
    run: Trajectory, view: str, size: tuple[int, int]
) -> None:
    picture = frame(run, 1.0, view=view, size=size)
    assert picture.shape == (size[1], size[0], 3)
    white = (np.abs(picture.astype(int) - style.ROBOT).max(axis=-1) <= 30).sum()
    assert white > 12


def test_the_camera_that_follows_keeps_the_robot_in_the_middle() -> None:
    run, size = drive(scenario(0, 0), seconds=20.0), (640, 360)
    camera, timeline = FollowCamera(run, size, 0.5), Timeline(run)
    for number in range(len(camera.shots)):
        lens = camera.lens(number)
        for time in (0.3, 5.0, 10.0, 15.0):
            moment = timeline.at(time)
            if camera.shots.at(moment.tick) != number:
                continue
            left, top, right, bottom = camera.window(lens, moment)
            assert (right - left, bottom - top) == size
            x, y = lens.project([(*moment.position, 0.0)])[0]
            assert abs(x - (left + right) / 2) < 25
            assert abs(y - (top + bottom) / 2) < 25


def test_a_view_of_ones_own_is_filmed_and_its_mistakes_name_it(
    run: Trajectory, tmp_path: Path
) -> None:
    @register_view("tests-own")
    class Own(View):
        def __init__(self, trajectory: Trajectory, stage: Any) -> None:
            self._canvas = stage.canvas()

        def draw(self, moment: Any) -> Any:
            if moment.time > 0.5:
                raise ZeroDivisionError("none left")
            self._canvas.fill([(0, 0), (1280, 0), (1280, 720), (0, 720)], style.GOAL)
            return self._canvas.take_changes()

    assert (frame(run, 0.0, view="tests-own", size=SMALL)[100:140, 100:200] == style.GOAL).all()
    with pytest.raises(UserError, match=r"^view tests-own: ZeroDivisionError: none left$"):
        record(run, tmp_path / "x.mp4", view="tests-own", size=SMALL)
    with pytest.raises(ValueError, match="registered already"):
        register_view("tests-own")
    with pytest.raises(ValueError, match="cannot be named"):
        register_view("../mine")


def test_names_of_films_tell_them_apart(tmp_path: Path) -> None:
    films = [
        Filming(),
        Filming(speed=4.0),
        Filming("follow"),
        Filming(size=(1920, 1080)),
        Filming("map", (1080, 1080), 60, 0.5, 2.0, 5.5),
        Filming(start=1.0),
        Filming(end=1.0),
    ]
    names = [film_name("mixed", one) for one in films]
    names += [film_name("mixed", form="gif"), film_name("mixed", still=2.5)]
    assert names[0] == "mixed.mp4"
    assert names[1] == "mixed-4x.mp4"
    assert names[4] == "mixed-map-1080x1080-60fps-0.5x-from2sto5.5s.mp4"
    assert names[-1] == "mixed-at2.5s.png"
    assert len(set(names)) == len(names)
    for name in (*names, "mixed-fuzzy.mp4", "mixed-fuzzy-4x.mp4", "mixed.npz"):
        (tmp_path / name).touch()
    assert {path.name for path in films_of(tmp_path, "mixed")} == set(names)


# --- races


def numbered(run: Trajectory, seconds: float) -> Trajectory:
    """Return the record as far as it went after so many seconds."""
    keep = run.ticks.time <= seconds
    ticks = {name: column[keep] for name, column in vars(run.ticks).items()}
    within = run.decisions.tick < keep.sum()
    told = {name: one for name, one in vars(run.decisions).items() if one is not None}
    decisions = {name: column[within] for name, column in told.items()}
    return replace(
        run, ticks=replace(run.ticks, **ticks), decisions=replace(run.decisions, **decisions)
    )


@pytest.mark.parametrize("count", [2, 3, 4])
def test_all_of_a_race_are_on_one_map_each_in_its_colour(run: Trajectory, count: int) -> None:
    picture = frame([run] * count, 1.5, view="map", size=(640, 360)).astype(int)
    field = picture[20:350, :420]
    # The first robot lies on top of those in the same place; in the list each has its own.
    for number in range(count):
        part = field if number == 0 else picture[20:, 420:]
        assert (np.abs(part - COLOURS[number]).max(axis=-1) <= 12).sum() > 40


def test_a_race_lasts_as_long_as_its_last_run_and_stops_each_clock_in_time(
    run: Trajectory, tmp_path: Path
) -> None:
    runs = [run, numbered(run, 1.0)]
    info = record(runs, tmp_path / "x.mp4", view="map", size=SMALL)
    assert info.frames == 61 + 30
    first, last = (frame(runs, time, view="map", size=(640, 360)) for time in (1.5, 1.9))
    rows = [np.s_[21:46, 440:], np.s_[51:76, 440:]]
    assert (first[rows[0]] != last[rows[0]]).any(), "the first still drives"
    assert (first[rows[1]] == last[rows[1]]).all(), "the second is done"
    ended = np.abs(first.astype(int) - style.HEAT).max(axis=-1) <= 12
    assert ended[rows[1]].sum() > 20, "and it says how"
    assert ended[rows[0]].sum() == 0


@pytest.mark.slow
@pytest.mark.parametrize("view", ["explain", "scene", "follow"])
@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("size", [(640, 360), (480, 480)])
def test_a_race_has_a_scene_for_each(
    run: Trajectory, view: str, count: int, size: tuple[int, int]
) -> None:
    picture = frame([run] * count, 1.5, view=view, size=size).astype(int)
    assert (np.abs(picture - style.ROBOT).max(axis=-1) <= 40).sum() > 20 * count


def test_the_scenes_of_a_race_are_seen_from_one_place() -> None:
    world = scenario(8, 1, size=(20.0, 20.0))  # more than is seen of it: each way has its own lens
    run = drive(world, seconds=2.0, outcome="timeout")
    runs, size = [run, numbered(run, 1.0)], (400, 200)
    lenses = [FixedCamera(one, size, runs).lens(0) for one in runs]
    assert lenses[0] == lenses[1]
    assert len({FixedCamera(one, size).lens(0) for one in runs}) == 2


def test_what_is_no_race_is_one_line(run: Trajectory, tmp_path: Path) -> None:
    elsewhere = replace(
        run,
        scenario=run.scenario.model_copy(
            update={"obstacles": (Cylinder(shape="cylinder", position=(5.0, 5.0), radius=0.2),)}
        ),
    )
    for runs, view, words in (
        ([run], "explain", "a race has two to 4 runs; got 1"),
        ([run] * 5, "explain", "a race has two to 4 runs; got 5"),
        ([run, elsewhere], "explain", "must be of one field: obstacles of synthetic"),
        ([run, run], "tests-own", "of a race must be one of explain, scene, follow, map"),
    ):
        with pytest.raises(UserError, match=words):
            record(runs, tmp_path / "x.mp4", view=view)


@pytest.mark.slow
@pytest.mark.parametrize("view", ["scene", "follow", "map"])
def test_drawing_only_what_changed_gives_the_same_frame_in_every_view(
    run: Trajectory, view: str
) -> None:
    size = (640, 360)
    image = Image.new("RGB", size, style.PAGE)
    with Compositor(run, view=view, size=size) as compositor:
        for time in np.arange(0.0, 1.5 + 1e-9, 0.1).tolist():
            for region in compositor.at(time):
                assert region.x % 2 == region.y % 2 == 0
                image.paste(region.image, (region.x, region.y))
    at_once = frame(run, 1.5, view=view, size=size).astype(int)
    assert (np.abs(np.asarray(image).astype(int) - at_once).max(axis=-1) > 60).sum() <= 120
