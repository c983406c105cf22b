"""A panel of a user's own: one file, in every film, and in nobody's way."""

from __future__ import annotations

import subprocess
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import imageio_ffmpeg
import numpy as np
import pytest

from fuzzyq_bullet.video import register_panel, style
from fuzzyq_bullet.video.layout import Layout, usual_size

if TYPE_CHECKING:
    from tests.helpers.commands import Call

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "extend" / "panel.py"
HEIGHT = 720
"""That of a film without panels of a user's own."""


def frames(film: Path, height: int) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return all frames of a film, shape (N, height, 1280, 3)."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-i", str(film)]
    command += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(raw, dtype=np.uint8).reshape(-1, height, 1280, 3)


@pytest.mark.slow
def test_the_example_is_in_the_film_below_all_that_was_there(
    fuzzyq: Call, filmed: Path, short: Path, tmp_path: Path
) -> None:
    done = fuzzyq("run", short, "--plugin", EXAMPLE, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    with_it = frames(tmp_path / "short.mp4", HEIGHT + 168)
    without = frames(filmed / "short.mp4", HEIGHT)
    assert len(with_it) == len(without)
    yellow = []
    for now, then in zip(with_it[::4], without[::4], strict=True):
        # What was there looks as it did; the two are compressed differently.
        assert np.abs(now[:HEIGHT].astype(int) - then).mean() < 1.5
        card = now[HEIGHT:].astype(int)
        yellow.append(int((np.abs(card - (240, 228, 66)).max(axis=-1) < 40).sum()))
    assert yellow[0] < 20
    assert yellow[-1] > 500, "the curve is drawn"
    assert max(np.diff(yellow)) < 0.5 * yellow[-1], "and grows with the run"


def test_a_panel_that_fails_is_one_line_that_names_it(
    fuzzyq: Call, filmed: Path, tmp_path: Path
) -> None:
    plugin = tmp_path / "broken.py"
    plugin.write_text(
        "from fuzzyq_bullet.video import register_panel\n"
        "@register_panel('mine')\n"
        "class Mine:\n"
        "    def __init__(self, trajectory, canvas):\n        pass\n"
        "    def draw(self, moment):\n        1 / 0\n"
    )
    done = fuzzyq("replay", filmed / "short.npz", "--plugin", plugin, "--out", tmp_path)
    assert done.returncode == 2
    assert done.stderr == "error: panel mine: ZeroDivisionError: division by zero\n"
    assert list(tmp_path.glob("*.mp4")) == []


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 9])
def test_any_number_of_panels_has_room_without_covering_anything(count: int) -> None:
    width, height = usual_size(count)
    layout = Layout.explaining((width, height), count)
    places = [layout.place(name) for name in layout.cards if name.startswith("added")]
    assert len(places) == count
    assert layout.place("sensors") == style.SENSORS, "where it always is"
    for place in places:
        assert all(value % 2 == 0 for value in place)
        assert place.y >= style.SENSORS.bottom
        assert 0 <= place.x < place.right <= width
        assert place.bottom <= height
    for a, b in combinations(places, 2):
        assert a.right <= b.x or a.bottom <= b.y
    assert (width % 4, height % 4) == (0, 0), "half of it is a small film, which is even too"
    assert usual_size() == (style.WIDTH, style.HEIGHT)


def test_a_name_is_given_once() -> None:
    with pytest.raises(ValueError, match="a panel named 'rules' is registered already"):
        register_panel("rules")
