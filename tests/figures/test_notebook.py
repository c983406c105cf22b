"""What a notebook shows of a trajectory: words and a picture."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet import load_scenario, run, with_options
from fuzzyq_bullet.figures.style import BLUE
from tests.helpers.synthetic import drive


def picture(html: str) -> Image.Image:
    (data,) = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    return Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")


def test_a_trajectory_shows_itself_in_words_and_with_its_path() -> None:
    trajectory = run(with_options(load_scenario("boxes"), drive="kinematic"))
    html = trajectory._repr_html_()
    assert "<b>boxes</b>: reached the goal after 14.00 s; drove 8.57 m" in html
    assert "Planner fuzzy-q-lambda, drive kinematic, seed 0." in html
    assert "http" not in html  # complete in itself
    image = np.asarray(picture(html)).reshape(-1, 3)
    path = tuple(int(BLUE[k : k + 2], 16) for k in (1, 3, 5))
    assert (image == path).all(axis=1).sum() > 100


@pytest.mark.parametrize(
    ("outcome", "words"), [("timeout", "ran out of time"), ("stuck", "got stuck")]
)
def test_it_says_how_the_run_ended(outcome: str, words: str) -> None:
    assert words in replace(drive(seconds=2.0), outcome=outcome)._repr_html_()  # type: ignore[arg-type]


def test_a_path_outside_an_arena_without_walls_is_seen_whole() -> None:
    record = drive(seconds=2.0, outcome="timeout")
    open_field = record.scenario.arena.model_copy(update={"walls": False})
    moved = replace(
        record,
        scenario=record.scenario.model_copy(update={"arena": open_field}),
        ticks=replace(record.ticks, position=record.ticks.position - (0.0, 20.0)),
    )
    wide, tall = picture(record._repr_html_()).size, picture(moved._repr_html_()).size
    assert tall[0] / tall[1] < wide[0] / wide[1]
