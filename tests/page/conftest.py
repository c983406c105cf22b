"""One browser for all tests of the page, and the pages that they open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest

from fuzzyq_bullet import episode, with_options
from fuzzyq_bullet.fuzzy import ControllerDefinition, paper_definition
from fuzzyq_bullet.page import lesson_page, record_page
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import load_scenario
from tests.helpers import synthetic
from tests.helpers.browser import CHROMIUM, Browser, browsing

Open: TypeAlias = Callable[..., Browser]


@pytest.fixture(scope="session")
def drive() -> Trajectory:
    """A drive with all three modes that reaches its goal."""
    return synthetic.modes(synthetic.drive(), (0, 0.3), (1, 0.2), (2, 0.3))


@pytest.fixture(scope="session")
def crash() -> Trajectory:
    """A shorter drive in the same field, which ends with a contact."""
    return synthetic.drive(seconds=8.0, outcome="collision")


@pytest.fixture(scope="session")
def pages(
    drive: Trajectory, crash: Trajectory, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Path]:
    """Pages by name: of one or two records, of a planner without rules, and two lessons."""
    folder = tmp_path_factory.mktemp("pages")
    plain = synthetic.drive(seconds=5.0, explained=False)
    jumping = episode.run(with_options(load_scenario("boxes"), drive="kinematic"))
    told = paper_definition().model_dump(mode="json")
    for name, variable in told["inputs"].items():
        variable["sets"] = {f"{one}_{name}"[:16]: how for one, how in variable["sets"].items()}
    told["rules"] = {f"{label}_distance": row for label, row in told["rules"].items()}
    wordy = ControllerDefinition.model_validate(told)
    texts = {
        "one": record_page([drive]),
        "two": record_page([drive, crash]),
        "plain": record_page([plain]),
        "jumps": record_page([jumping]),
        "lesson": lesson_page(),
        "wordy": lesson_page(wordy),
    }
    for name, text in texts.items():
        (folder / f"{name}.html").write_text(text, encoding="utf-8")
    return {name: folder / f"{name}.html" for name in texts}


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    if CHROMIUM is None:
        pytest.skip("needs Chromium")
    with browsing(tmp_path_factory.mktemp("browser") / "profile") as started:
        yield started


@pytest.fixture
def show(browser: Browser, pages: dict[str, Path]) -> Iterator[Open]:
    """Open a page by name; at the end nothing was complained of, and nothing was loaded."""
    browser.complaints.clear()

    def opened(name: str, width: int = 1280, *, dark: bool = False) -> Browser:
        browser.open(pages[name], width=width, dark=dark)
        # What depends on sizes is drawn with the first frame.
        browser.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
        return browser

    yield opened
    assert browser.complaints == []
    assert browser.value("performance.getEntriesByType('resource').length") == 0


def bright(browser: Browser) -> float:
    """Return how light the page is, 0 to 255."""
    colour = browser.value("getComputedStyle(document.documentElement).backgroundColor")
    return float(np.mean([int(part) for part in colour.strip("rgb()").split(",")]))
