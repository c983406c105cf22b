"""The page plays a record by mouse, touch and keys, and lets its controller be changed."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fuzzyq_bullet.page import record_page
from fuzzyq_bullet.page.document import MODULES
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.trajectory import Decisions, Ticks, Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.video.explanation import reason
from fuzzyq_bullet.video.timeline import Timeline
from tests.helpers import synthetic
from tests.helpers.browser import Browser
from tests.page.conftest import Open, bright

SOURCES = Path(record_page.__code__.co_filename).parent / "js"

TIME = "fuzzyq.player.time"


def data_of(page: str) -> dict[str, Any]:
    """Return the data of a page as a browser would read them."""
    (held,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    return dict(json.loads(held))


def repeated(drive: Trajectory, times: int) -> Trajectory:
    """Return a record in which a drive happens several times over."""
    ticks = vars(drive.ticks)
    decisions = {name: one for name, one in vars(drive.decisions).items() if one is not None}
    count = len(ticks["time"])
    again = {name: np.concatenate([array] * times) for name, array in ticks.items()}
    again["time"] = np.arange(count * times) * float(ticks["time"][1])
    decided = {
        name: None if array is None else np.concatenate([array] * times)
        for name, array in decisions.items()
    }
    decided["tick"] = np.concatenate([decisions["tick"] + k * count for k in range(times)])
    return replace(drive, ticks=Ticks(**again), decisions=Decisions(**decided))


def middle(browser: Browser, selector: str) -> tuple[float, float]:
    """Scroll an element into sight and return its middle (CSS pixels)."""
    x, y = browser.value(
        f"""(() => {{
          const one = document.querySelector({json.dumps(selector)});
          one.scrollIntoView({{block: "center"}});
          const box = one.getBoundingClientRect();
          return [box.x + box.width / 2, box.y + box.height / 2];
        }})()"""
    )
    return x, y


def said(browser: Browser, selector: str) -> str:
    text = browser.value(f"document.querySelector({json.dumps(selector)}).textContent")
    return str(text).replace("\xa0", " ")


def wait_until(browser: Browser, condition: str) -> None:
    """Wait for frames, as many as it takes, until a condition holds in the page."""
    frame = f"(now) => ({condition}) ? done() : requestAnimationFrame(look)"
    browser.value(f"new Promise((done) => {{ const look = {frame}; look(); }})")


# What it shows is the record


def test_everything_at_a_time_is_of_the_record(show: Open, drive: Trajectory) -> None:
    browser = show("one")
    timeline, decisions = Timeline(drive), drive.decisions
    for time in np.linspace(timeline.start, timeline.end - 0.01, 9).tolist():
        moment = timeline.at(time)
        browser.value(f"fuzzyq.player.seek({time})")
        shown = browser.value("fuzzyq.views[0].moment")
        assert (shown["x"], shown["y"]) == pytest.approx(moment.position, abs=2e-3)
        assert shown["heading"] == pytest.approx(moment.heading, abs=2e-3)
        decision = browser.value("fuzzyq.views[0].decision")
        k = moment.decision
        assert decision["lengths"] == pytest.approx(decisions.lengths[k].tolist(), abs=1e-3)
        assert decision["near"] == pytest.approx(decisions.near[k].tolist(), abs=1e-3)
        assert decision["rules"] == pytest.approx(decisions.rules[k].ravel().tolist(), abs=1e-3)
        assert decision["weights"] == [1, 1]
        assert decision["aim"] == pytest.approx(decisions.aim[k].tolist(), abs=1e-3)
        assert said(browser, ".sentence") == reason(drive, k)
        assert said(browser, ".mode") == MODES[int(decisions.mode[k])]


@pytest.mark.slow
def test_the_rule_that_fires_most_is_lit_most(show: Open, drive: Trajectory) -> None:
    browser = show("one")
    strongest = np.ravel(drive.decisions.rules[40]).argmax()
    browser.value(f"fuzzyq.player.seek({drive.ticks.time[drive.decisions.tick[40]]})")
    row, column = np.unravel_index(strongest, (5, 5))
    # Columns run from "left much freer" to "right much freer": the other way round.
    cell = f".run tbody tr:nth-child({row + 1}) td:nth-of-type({5 - column})"
    assert browser.value(f"document.querySelector('{cell}').matches('.strongest')")
    lit = [float(one) for one in browser.value(
        "[...document.querySelectorAll('.run .lit')].map((one) => one.style.opacity)")]  # fmt: skip
    fired = drive.decisions.rules[40][:, ::-1].ravel()
    np.testing.assert_allclose(lit, np.sqrt(fired), atol=0.03)


@pytest.mark.slow
def test_it_says_how_the_run_ended(show: Open) -> None:
    browser = show("two")
    browser.press("End")
    assert browser.value("fuzzyq.views.map((view) => view.moment.over)") == [True, True]
    first, second = browser.value(
        "[...document.querySelectorAll('.sentence')].map((one) => one.textContent)"
    )
    assert first.startswith("GOAL reached (in ")
    assert second.startswith("COLLISION with the ")


@pytest.mark.slow
def test_two_records_go_in_step_and_the_shorter_waits_at_its_end(
    show: Open, drive: Trajectory, crash: Trajectory
) -> None:
    browser = show("two")
    browser.value("fuzzyq.player.seek(4)")
    assert browser.value("fuzzyq.views.map((view) => view.moment.time)") == [4, 4]
    browser.value("fuzzyq.player.seek(15)")
    ends = browser.value("fuzzyq.views.map((view) => view.moment.time)")
    assert ends == pytest.approx([15, crash.ticks.time[-1]])
    assert browser.value("fuzzyq.player.end") == pytest.approx(drive.ticks.time[-1], abs=1e-3)


@pytest.mark.slow
def test_the_band_shows_modes_and_events_where_they_are(show: Open, drive: Trajectory) -> None:
    browser = show("one")
    times = drive.ticks.time[drive.decisions.tick]
    modes = drive.decisions.mode
    changes = [0.0, *times[1:][np.diff(modes) != 0].tolist()]
    drawn = browser.value(
        "[...document.querySelectorAll('.stretch')].map((one) => [one.getAttribute('class'), "
        "Number(one.getAttribute('x')) / 100 * fuzzyq.player.end])"
    )
    assert [name for name, _ in drawn] == [
        f"stretch {MODES[k]}" for k in (0, 1, 2, 0)
    ]  # fmt: skip
    assert [time for _, time in drawn] == pytest.approx(changes, abs=0.01)
    kinds = browser.value("[...document.querySelectorAll('.mark')].map((one) => one.className)")
    assert kinds == ["mark breakout", "mark routine", "mark goal"]
    browser.press("n")
    assert browser.value(TIME) == pytest.approx(changes[1], abs=1e-3)
    assert said(browser, ".sentence") == "Blocked towards the goal: breaks out"
    browser.press("n")
    assert browser.value(TIME) == pytest.approx(changes[3], abs=1e-3)
    browser.press("p")
    assert browser.value(TIME) == pytest.approx(changes[1], abs=1e-3)


@pytest.mark.slow
def test_a_planner_without_rules_and_lines_shows_what_it_has_and_nothing_empty(show: Open) -> None:
    browser = show("plain")

    def texts(selector: str) -> list[str]:
        chosen = f"document.querySelectorAll({json.dumps(selector)})"
        return list(browser.value(f"[...{chosen}].map((one) => one.textContent)"))

    assert texts(".card h3") == ["1 · Senses", "2 · Acts"]
    assert said(browser, ".mode") == "improved-fuzzy"
    assert texts(".legend li") == ["path"]
    assert texts(".acts dt")[:2] == ["speed asked", "known free"]
    # The close-up has a robot, an arrow and a ring, in more than one colour.
    colours = browser.value(
        "(() => { const one = document.querySelector('.around canvas');"
        " const { data } = one.getContext('2d').getImageData(0, 0, one.width, one.height);"
        " return new Set(new Uint32Array(data.buffer)).size; })()"
    )
    assert colours > 10
    browser = show("one")
    assert [*map(str.strip, texts(".legend li"))][-3:] == ["routine", "breakout", "following"]
    assert texts(".card h3")[0] == "1 · Senses"
    assert texts(".acts dt")[:2] == ["speed asked", "known free"]


@pytest.mark.slow
def test_the_point_robot_stands_where_it_decided_and_says_what_it_jumps(show: Open) -> None:
    browser = show("jumps")
    here, jumped = 6 * 2.0 / 3.0, 7 * 2.0 / 3.0
    for time in (here + 0.01, here + 0.6):
        browser.value(f"fuzzyq.player.seek({time})")
        moment = browser.value("fuzzyq.views[0].moment")
        decision = browser.value("fuzzyq.views[0].decision")
        assert moment["tick"] == decision["index"] == 6
        assert (moment["x"], moment["y"]) == (decision["x"], decision["y"])
    names = "[...document.querySelectorAll('.acts dt')].map((one) => one.textContent)"
    values = "[...document.querySelectorAll('.acts dd')].map((one) => one.textContent)"
    told = ["step asked", "known free", "last step", "nearest in step"]
    assert browser.value(names)[:4] == told
    asked = browser.value(values)[0]
    browser.value(f"fuzzyq.player.seek({jumped + 0.01})")
    step, free, last, _ = browser.value(values)[:4]
    assert last == asked  # what was asked for then is what it has jumped now
    assert float(step[:-2]) <= float(free.strip("> m")) <= 1.0


# Mouse, touch and keys


def test_playing_moves_the_robot_until_it_is_paused(show: Open) -> None:
    browser = show("one")
    button = middle(browser, ".play")
    before = browser.value("fuzzyq.views[0].field.canvas.toDataURL()")
    browser.drag(button)
    wait_until(browser, f"{TIME} > 0.4")
    browser.drag(button)
    at = browser.value(TIME)
    assert browser.value("fuzzyq.player.playing") is False
    assert browser.value("fuzzyq.views[0].moment.x") > 1.0
    assert browser.value("fuzzyq.views[0].field.canvas.toDataURL()") != before
    browser.value("new Promise(requestAnimationFrame)")
    assert browser.value(TIME) == at


@pytest.mark.slow
def test_at_eight_times_the_speed_it_comes_to_the_end_and_plays_again(show: Open) -> None:
    browser = show("one")
    browser.value("fuzzyq.player.seek(fuzzyq.player.end - 0.5)")
    for _ in range(5):
        browser.press("+")
    assert browser.value(
        "[fuzzyq.player.speed, document.querySelector('footer select').value]"
    ) == [8, "8"]
    browser.press(" ")
    wait_until(browser, "!fuzzyq.player.playing")
    assert browser.value(f"{TIME} === fuzzyq.player.end")
    browser.press(" ")
    wait_until(browser, f"fuzzyq.player.playing && {TIME} > 0")
    assert browser.value(TIME) < 5
    browser.press(" ")


def test_a_press_on_the_band_goes_there_and_dragging_scrubs(show: Open) -> None:
    browser = show("one")
    end = browser.value("fuzzyq.player.end")
    x, y = middle(browser, ".band")
    browser.drag((x, y))
    assert browser.value(TIME) == pytest.approx(end / 2, rel=0.01)
    browser.drag((x, y), (x + 100, y), (1e4, y))
    assert browser.value(TIME) == end


@pytest.mark.slow
def test_a_finger_plays_and_scrubs(show: Open) -> None:
    browser = show("one", 400)
    browser("Emulation.setTouchEmulationEnabled", enabled=True)
    try:
        browser.touch(middle(browser, ".play"))
        wait_until(browser, f"{TIME} > 0.1")
        x, y = middle(browser, ".band")
        browser.touch((x, y), (x + 20, y), (x + 60, y))
        width = browser.value("document.querySelector('.band').clientWidth")
        part = browser.value(f"{TIME} / fuzzyq.player.end")
        assert part == pytest.approx(0.5 + 60 / width, abs=0.05)
    finally:
        browser("Emulation.setTouchEmulationEnabled", enabled=False)


@pytest.mark.slow
def test_a_press_on_the_path_goes_to_when_the_robot_was_there(
    show: Open, drive: Trajectory
) -> None:
    browser = show("one")
    tick = len(drive.ticks.time) // 2
    x, y = drive.ticks.position[tick].tolist()
    place = browser.value(
        f"""(() => {{
          const field = fuzzyq.views[0].field, box = field.canvas.getBoundingClientRect();
          const [x, y] = field.at({x}, {y});
          return [box.x + x, box.y + y];
        }})()"""
    )
    steps = browser.value(
        """((field) => [[1, 0], [0, 1]].map(([x, y]) => {
          const [from, to] = [field.at(2, 3), field.at(2 + x, 3 + y)];
          return [(to[0] - from[0]) / field.scale, (to[1] - from[1]) / field.scale];
        }))(fuzzyq.views[0].field)"""
    )
    np.testing.assert_allclose(steps, [[1, 0], [0, -1]], atol=1e-9)  # x to the right, y up
    browser.drag(tuple(place))
    moment = browser.value("fuzzyq.views[0].moment")
    assert (moment["x"], moment["y"]) == pytest.approx((x, y), abs=0.05)
    at = browser.value(TIME)
    left, top = browser.value(
        "(({x, y}) => [x, y])(document.querySelector('.field').getBoundingClientRect())"
    )
    browser.drag((left + 3, top + 3))  # far from the path
    assert browser.value(TIME) == at


def test_arrows_go_from_decision_to_decision(show: Open, drive: Trajectory) -> None:
    browser = show("one")
    times = drive.ticks.time[drive.decisions.tick]
    for _ in range(3):
        browser.press("ArrowRight")
    assert browser.value(TIME) == pytest.approx(times[3], abs=1e-3)
    browser.press("ArrowLeft")
    assert browser.value("fuzzyq.views[0].decision.index") == 2
    browser.press("ArrowRight", shift=True)
    assert browser.value(TIME) == pytest.approx(times[2] + 1.0, abs=1e-3)
    browser.press("Home")
    assert browser.value(TIME) == 0


@pytest.mark.slow
def test_a_key_shows_the_keys_and_another_closes_them(show: Open) -> None:
    browser = show("one")
    browser.press("?")
    assert browser.value("document.querySelector('dialog.help').open")
    browser.press("ArrowRight")
    assert browser.value(TIME) == 0  # the run is behind the dialog
    browser.value("document.querySelector('dialog.help button').click()")
    assert not browser.value("document.querySelector('dialog.help').open")


def test_light_and_dark_as_the_system_says_and_as_the_button_says(show: Open) -> None:
    browser = show("one")
    assert bright(browser) > 200
    canvas = browser.value("fuzzyq.views[0].field.canvas.toDataURL()")
    browser.drag(middle(browser, "nav button:nth-child(2)"))
    assert bright(browser) < 40
    assert browser.value("fuzzyq.views[0].field.canvas.toDataURL()") != canvas
    show("one", dark=True)
    assert bright(browser) < 40
    browser.press("d")
    assert bright(browser) > 200


@pytest.mark.slow
def test_the_close_up_follows_the_robot(show: Open) -> None:
    browser = show("one")
    centred = (
        "(({size, at, scale}, {x, y}) => [...fuzzyq.views[0].field.at(x, y), ...size, scale])"
        "(fuzzyq.views[0].field, fuzzyq.views[0].moment)"
    )
    before = browser.value(centred)[4]
    browser.press("z")
    browser.value("fuzzyq.player.seek(5)")
    x, y, width, height, scale = browser.value(centred)
    assert (x, y) == pytest.approx((width / 2, height / 2))
    assert scale > 1.5 * before


@pytest.mark.parametrize(
    ("name", "width"),
    [
        ("one", 400),
        *(pytest.param(name, 400, marks=pytest.mark.slow) for name in ("two", "plain", "lesson")),
        *(pytest.param(name, 1920, marks=pytest.mark.slow) for name in ("one", "two", "lesson")),
    ],
)
def test_it_fits_on_a_phone_and_on_a_projector(show: Open, name: str, width: int) -> None:
    browser = show(name, width)
    assert browser.value("document.documentElement.scrollWidth") == width
    # What is cut off on purpose, and handles that reach to the edge, aside.
    beyond = browser.value(
        f"""[...document.querySelectorAll("body *")]
          .filter((one) => !one.closest(".band, .field, .handle, h2"))
          .filter((one) => one.getBoundingClientRect().right > {width} + 0.5)
          .map((one) => one.outerHTML.slice(0, 80))"""
    )
    assert beyond == []


def test_labels_of_sets_do_not_overlap_and_the_strongest_is_written(show: Open) -> None:
    browser = show("wordy", 400)
    for df in (0.0, 3.0):
        browser.value(f"fuzzyq.whatIf.setInputs(2.5, {df})")
        plots = browser.value(
            """[...document.querySelectorAll(".plot svg")].map((one) =>
              [...one.querySelectorAll("text.label")]
                .filter((label) => label.style.visibility !== "hidden")
                .map((label) => [label.getBoundingClientRect(), label.classList])
                .map(([box, classes]) => [box.left, box.right, classes.contains("strongest")])
                .sort((a, b) => a[0] - b[0]))"""
        )
        assert len(plots) == 4
        for labels in plots:
            assert all(a[1] <= b[0] for a, b in pairwise(labels))
        assert all(any(strongest for *_, strongest in labels) for labels in plots[:2])
        assert [len(labels) for labels in plots] < [5, 5, 5, 5]


# What if


def test_sliders_move_the_rules_and_the_answer(show: Open) -> None:
    browser = show("lesson")
    browser.value("fuzzyq.whatIf.setInputs(1.0, 3.0)")
    assert "to the left" in said(browser, ".answer")
    lit = "[...document.querySelectorAll('.lit')].map((one) => one.style.opacity)"
    before = browser.value(lit)
    browser.value("document.querySelector('input[aria-label=Df]').focus()")
    browser.press("Home")  # its least value: the right is much freer
    assert browser.value("fuzzyq.whatIf.df") == -5
    assert browser.value(lit) != before
    assert "right much freer" in said(browser, ".answer")
    assert "to the right" in said(browser, ".answer")
    x, y = middle(browser, "input[aria-label=d]")
    browser.drag((x, y))
    assert browser.value("fuzzyq.whatIf.d") == pytest.approx(2.5, abs=0.05)


SURFACE = "Array.from(fuzzyq.whatIf.surfaces[0].heights)"
NUMBERS = "fuzzyq.whatIf.controller.distance.sets[1].numbers"


def test_dragging_a_set_moves_rules_and_surface_at_once_and_reset_undoes_it(show: Open) -> None:
    browser = show("lesson")
    answer, surface = said(browser, ".answer"), browser.value(SURFACE)
    x, y = middle(browser, "[data-handle='N 0']")
    browser.drag((x, y), (x + 20, y), (x + 60, y))
    centre, width = browser.value(NUMBERS)
    assert centre > 1.8
    assert width == 0.425
    assert said(browser, ".answer") != answer
    wait_until(browser, "!fuzzyq.whatIf.waiting")
    assert browser.value(SURFACE) != surface
    assert said(browser, ".before").startswith("Before your changes: ")
    browser.drag(middle(browser, ".reset"))
    assert browser.value(NUMBERS) == [1.49, 0.425]
    assert browser.value(SURFACE) == surface
    assert (said(browser, ".answer"), said(browser, ".before")) == (answer, "")


@pytest.mark.slow
def test_a_chosen_set_is_reshaped_by_its_square_handles_and_by_keys(show: Open) -> None:
    browser = show("lesson")
    browser.drag(middle(browser, "[data-handle='N 0']"))
    x, y = middle(browser, "[data-handle='N 1']")
    browser.drag((x, y), (x + 30, y))
    centre, width = browser.value(NUMBERS)
    assert centre == 1.49
    assert width > 0.6
    browser.value("document.querySelector(\"[data-handle='N 0']\").focus()")
    browser.press("ArrowRight")
    browser.press("ArrowRight")  # the focus stays
    assert browser.value(NUMBERS) == pytest.approx([1.59, width])


@pytest.mark.slow
def test_a_rule_is_changed_in_its_cell(show: Open) -> None:
    browser = show("lesson")
    browser.value("fuzzyq.whatIf.setInputs(1.49, -2.22)")  # near, and the right is freer
    assert "to the right" in said(browser, ".answer")
    surface = browser.value(SURFACE)
    browser.drag(middle(browser, "tr:nth-child(2) td:nth-of-type(4) button"))
    assert said(browser, "dialog.rule p") == ("If ahead is near, and the sides are right freer:")
    browser.value("document.querySelector('dialog.rule select').focus()")
    for _ in range(3):
        browser.press("ArrowDown")  # from NS over ZO and PS to PL
    browser.value("document.querySelector('dialog.rule').close()")
    assert said(browser, "tr:nth-child(2) td:nth-of-type(4) small") == "PL L"
    assert "to the left" in said(browser, ".answer")
    wait_until(browser, "!fuzzyq.whatIf.waiting")
    assert browser.value(SURFACE) != surface
    browser.drag(middle(browser, ".reset"))
    assert browser.value(SURFACE) == surface


@pytest.mark.slow
def test_a_press_on_the_surface_takes_d_and_df_from_there(show: Open) -> None:
    browser = show("lesson")
    browser.drag(middle(browser, ".surface-box canvas"))
    assert browser.value("[fuzzyq.whatIf.d, fuzzyq.whatIf.df]") == pytest.approx([2.5, 0], abs=0.05)


@pytest.mark.slow
def test_what_if_follows_the_run_until_a_slider_is_moved(show: Open, drive: Trajectory) -> None:
    browser = show("one")
    browser.value("fuzzyq.player.seek(5)")
    inputs = "[fuzzyq.whatIf.d, fuzzyq.whatIf.df]"
    k = Timeline(drive).at(5.0).decision
    recorded = [float(drive.decisions.distance[k]), float(drive.decisions.difference[k])]
    assert browser.value(inputs) == pytest.approx(recorded, abs=1e-3)
    browser.value("fuzzyq.whatIf.setInputs(1, 1)")
    browser.value("fuzzyq.player.seek(7)")
    assert browser.value(inputs) == [1, 1]
    browser.value("fuzzyq.whatIf.follow(0)")
    assert browser.value(inputs) != [1, 1]


@pytest.mark.slow
def test_a_planner_without_rules_has_no_rules_on_its_page(show: Open) -> None:
    browser = show("plain")
    browser.press("ArrowRight")
    assert browser.value("document.querySelectorAll('.judges, .rules, .what-if').length") == 0
    assert "No detection lines" in said(browser, ".around")


# The file


def test_what_a_record_says_cannot_become_a_part_of_the_page(
    drive: Trajectory, browser: Browser, tmp_path: Path
) -> None:
    name = "</script><script>window.broken = 1</script><!-- &amp; <b>"
    odd = drive.scenario.model_copy(update={"name": name})
    page = record_page([replace(drive, scenario=odd)])
    path = tmp_path / "odd.html"
    path.write_text(page, encoding="utf-8")
    assert data_of(page)["runs"][0]["name"] == name
    browser.complaints.clear()
    browser.open(path, width=1280, dark=False)
    assert browser.value("document.querySelector('h1').firstChild.textContent") == name
    assert browser.value("[window.broken, document.querySelectorAll('script').length]") == [None, 2]
    assert browser.complaints == []


def test_two_minutes_are_less_than_two_megabytes(drive: Trajectory) -> None:
    long = repeated(drive, 6)
    page = record_page([long])
    assert long.ticks.time[-1] > 120.0
    (run,) = data_of(page)["runs"]
    assert len(run["ticks"]["time"]) == len(long.ticks.time)  # nothing is left out
    assert len(run["decisions"]["time"]) == len(long.decisions.tick)
    assert len(page.encode()) < 2e6


def test_a_task_and_a_rectangular_robot_are_on_the_page(browser: Browser, tmp_path: Path) -> None:
    start = {"position": [-3, 0], "heading": 0.0}
    goal = {"position": [3, 0], "heading": 1.5}
    via = [{"position": [0, 1]}, {"position": [1, -1]}]
    rest = {"arena": {"size": [8, 6], "origin": [-4, -3]}, "robot": {"model": "jackal"}}
    told = {"name": "task", "start": start, "goal": goal, "via": via, **rest}
    page = record_page([synthetic.drive(Scenario.model_validate(told))])
    run = data_of(page)["runs"][0]
    assert run["field"]["goal"]["heading"] == 1.5
    assert len(run["robot"]["footprint"]) == 4
    assert [one["passed"] for one in run["field"]["via"]] == [None, None]
    path = tmp_path / "task.html"
    path.write_text(page, encoding="utf-8")
    browser.complaints.clear()
    browser.open(path, width=1280, dark=False)
    frame = "new Promise((done) => requestAnimationFrame(() => setTimeout(done)))"
    browser.value(frame)
    tip, ground = [3 + 0.35 * np.cos(1.5), 0.35 * np.sin(1.5)], [-1, -2]
    seen = browser.value(
        f"""(() => {{
          const field = fuzzyq.views[0].field, {{width, height}} = field.still;
          const {{data}} = field.still.getContext("2d").getImageData(0, 0, width, height);
          return {json.dumps([tip, ground])}.map(([x, y]) => {{
            const ratio = width / field.size[0];
            const [left, top] = field.at(x, y).map((one) => Math.round(one * ratio));
            const first = 4 * (top * width + left);
            return [...data.slice(first, first + 4)];
          }});
        }})()"""
    )
    assert seen[0] != seen[1]  # the arrow reaches out of the goal
    assert browser.complaints == []


def test_a_very_long_run_is_thinned_out_and_keeps_its_end() -> None:
    hour = synthetic.standing(3600.0)
    data = data_of(record_page([hour]))["runs"][0]
    times = data["ticks"]["time"]
    assert len(times) <= 6000
    assert (times[0], times[-1]) == (0, 3600)


def test_every_module_stands_behind_those_that_it_imports() -> None:
    assert {path.stem for path in SOURCES.glob("*.js")} == set(MODULES)
    before: dict[str, str] = {}
    for name in MODULES:
        text = (SOURCES / f"{name}.js").read_text()
        for names, module in re.findall(r'import \{([^}]*)\} from "\./(\w+)\.js"', text):
            for one in filter(None, map(str.strip, names.split(","))):
                assert re.search(rf"^export (const|function|class) {one}\b", before[module], re.M)
        assert text.count("import {") == len(re.findall(r"^import \{", text, re.M))
        before[name] = text
