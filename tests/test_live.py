"""An episode that is watched: it keeps real time, obeys the keys, and drives as it would alone."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import Trajectory, UserError, load_scenario, run, with_options
from fuzzyq_bullet.episode import Episode, planner_of, run_in, world_of
from fuzzyq_bullet.live import KEYS, Spectator, moving_meshes, still_meshes
from fuzzyq_bullet.physics.window import Line, WindowClosed
from fuzzyq_bullet.planning import Decision
from fuzzyq_bullet.recording.moving import headings_of, poses_at
from fuzzyq_bullet.scenario import Scenario, parse_scenario
from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.explanation import reason
from tests.helpers.commands import FUZZYQ, Call
from tests.helpers.screen import Screen, needs_screen, screen

FRAME = 1 / 30


class Recorder:
    """A window that nobody sees, a person at its keys, and the clock on the wall."""

    def __init__(self, press: Callable[[int], str] = lambda frame: "") -> None:
        self.now = 0.0
        self.times: list[float] = []
        self.poses: list[tuple[float, float, float]] = []
        self.lines: list[tuple[Line, ...]] = []
        self.texts: list[tuple[str, ...]] = []
        self.path: list[tuple[float, float]] = []
        self.moved: list[list[tuple[float, ...]]] = []
        self._press = press

    def draw(
        self,
        position: tuple[float, float],
        heading: float,
        lines: Sequence[Line] = (),
        *,
        moved: Sequence[Sequence[float]] = (),
        passed: Sequence[tuple[float, float]] = (),
        above: Sequence[str] = (),
        below: Sequence[str] = (),
    ) -> str:
        self.times.append(self.now)
        self.poses.append((*position, heading))
        self.lines.append(tuple(lines))
        self.texts.append((*above, *below))
        self.path += passed
        self.moved.append([tuple(pose) for pose in moved])
        return self._press(len(self.poses))

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def watch(self, scenario: Scenario, speed: float = 1.0) -> Trajectory:
        with world_of(scenario) as world:
            self.spectator = Spectator(
                self, scenario, speed, lambda: self.now, self.sleep, world.movers.poses
            )
            return run_in(world, scenario, planner_of(scenario), observer=self.spectator)


@pytest.fixture(scope="module")
def scenario(short: Path) -> Scenario:
    return load_scenario(short)


@pytest.fixture(scope="module")
def alone(scenario: Scenario) -> Trajectory:
    return run(scenario)


def test_an_observer_is_told_of_every_decision_and_of_the_robot_before_and_after_it(
    scenario: Scenario, alone: Trajectory
) -> None:
    told = []
    watched = run(scenario, observer=lambda *seen: told.append(seen))
    assert watched.digest() == alone.digest()
    decisions, ticks = watched.decisions, watched.ticks
    assert [decision.heading for _, decision, _ in told] == decisions.heading.tolist()
    before = [(one.time, one.x, one.y) for one, _, _ in told]
    where = zip(
        ticks.time[decisions.tick].tolist(), *ticks.position[decisions.tick].T.tolist(), strict=True
    )
    assert before == list(where)
    assert [after for *_, after in told[:-1]] == [one for one, *_ in told[1:]]
    assert told[-1][2].time == ticks.time[-1]


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_it_takes_as_long_to_watch_as_it_lasts(
    scenario: Scenario, alone: Trajectory, speed: float
) -> None:
    window = Recorder()
    watched = window.watch(scenario, speed)
    assert watched.digest() == alone.digest()
    assert abs(window.now - alone.ticks.time[-1] / speed) <= FRAME
    assert max(b - a for a, b in pairwise(window.times)) <= FRAME + 1e-9
    # It moves evenly, never faster than the robot is.
    moves = [math.dist(a[:2], b[:2]) for a, b in pairwise(window.poses)]
    assert max(moves) <= 1.1 * alone.ticks.speed.max() * FRAME * speed


def test_a_slow_window_misses_frames_and_keeps_the_time(
    scenario: Scenario, alone: Trajectory
) -> None:
    window = Recorder()
    quick = window.draw

    def slow(*args: object, **more: object) -> str:
        window.now += 0.12
        return quick(*args, **more)  # type: ignore[arg-type]

    window.draw = slow  # type: ignore[method-assign]
    window.watch(scenario)
    assert abs(window.now - alone.ticks.time[-1]) <= 0.2
    # What was missed is in the path all the same.
    assert window.path == [
        tuple(one) for one in alone.ticks.position[alone.decisions.tick].tolist()
    ]


def test_the_lines_are_those_of_the_decision_in_force(
    scenario: Scenario, alone: Trajectory
) -> None:
    window = Recorder()
    window.watch(scenario, 0.47)
    decisions, radius = alone.decisions, scenario.robot.radius
    for frame, lines in enumerate(window.lines):
        shown = 0.47 * FRAME * frame
        k = np.searchsorted(alone.ticks.time[decisions.tick], shown, "right") - 1
        x, y = alone.ticks.position[decisions.tick[k]].tolist()
        assert [line.colour for line in lines] == list(style.LINES)
        for line, heading, length in zip(
            lines, decisions.lines[k].tolist(), decisions.lengths[k].tolist(), strict=True
        ):
            reach = radius + length
            end = (x + reach * math.cos(heading), y + reach * math.sin(heading))
            assert line.start == (x, y)
            assert line.end == pytest.approx(end)


def test_the_captions_say_what_is_seen_and_why(scenario: Scenario) -> None:
    window = Recorder()
    window.watch(scenario)
    first = window.texts[0]
    assert first == ("short   fuzzy-q-lambda   seed 0", KEYS, first[2], first[3])
    assert first[2].endswith("1x   routine")
    assert "the goal" in first[3]


def test_a_sentence_stays_long_enough_to_be_read_and_in_a_pause_is_that_of_the_lines() -> None:
    scenario = load_scenario("boxes")
    window = Recorder()
    watched = window.watch(scenario, 2.0)
    said = [(texts[2].split()[-1], texts[3]) for texts in window.texts]
    changes = [k for k in range(1, len(said)) if said[k] != said[k - 1]]
    assert len(changes) > 3
    for a, b in pairwise(changes):
        assert said[b][0] != said[b - 1][0] or (b - a) * FRAME >= 0.5 - 1e-9
    steps = iter("s" * 40 + "q")
    window = Recorder(lambda frame: next(steps))
    with pytest.raises(WindowClosed):
        window.watch(scenario, 2.0)
    for k, texts in enumerate(window.texts[2:]):
        assert texts[3] == reason(watched, k + 2)


def test_the_space_bar_pauses_and_lets_it_go_on(scenario: Scenario, alone: Trajectory) -> None:
    keys = {10: " ", 100: " "}
    window = Recorder(lambda frame: keys.get(frame, ""))
    watched = window.watch(scenario)
    assert watched.digest() == alone.digest()
    assert len(set(window.poses[9:100])) == 1
    assert "paused" in window.texts[50][2]
    assert abs(window.now - alone.ticks.time[-1] - 90 * FRAME) <= 2 * FRAME


def test_s_drives_for_one_decision_and_pauses(scenario: Scenario, alone: Trajectory) -> None:
    keys = {10: "s", 40: "s", 70: "s", 100: " "}
    window = Recorder(lambda frame: keys.get(frame, ""))
    watched = window.watch(scenario)
    assert watched.digest() == alone.digest()
    ticks = alone.ticks
    held = [set(window.poses[start : start + 25]) for start in (12, 42, 72)]
    assert [len(one) for one in held] == [1, 1, 1]
    places = [ticks.position.tolist().index(pytest.approx(one.pop()[:2])) for one in held]
    assert places == [places[0], places[0] + 1, places[0] + 2]


def test_plus_and_minus_change_the_speed(scenario: Scenario, alone: Trajectory) -> None:
    for key, factor in (("=", 2.0), ("+", 2.0), ("-", 0.5)):
        window = Recorder(lambda frame, key=key: key if frame == 1 else "")  # type: ignore[misc]
        window.watch(scenario)
        assert abs(window.now - alone.ticks.time[-1] / factor) <= 2 * FRAME
        assert f"{factor:g}x" in window.texts[1][2]
    window = Recorder(lambda frame: "=" * 20)
    window.watch(scenario)
    assert "16x" in window.texts[-1][2]


def test_q_ends_it(scenario: Scenario) -> None:
    window = Recorder(lambda frame: "q" if frame == 5 else "")
    with pytest.raises(WindowClosed):
        window.watch(scenario)
    assert len(window.poses) == 5


def test_the_point_robot_moves_evenly_too(scenario: Scenario) -> None:
    window = Recorder()
    point = with_options(scenario, drive="kinematic")
    watched = window.watch(point)
    assert watched.digest() == run(point).digest()
    moves = [math.dist(a[:2], b[:2]) for a, b in pairwise(window.poses)]
    assert max(moves) <= 1.01 * watched.ticks.speed.max() * FRAME


def test_at_the_end_it_stays_and_says_how_it_ended(scenario: Scenario) -> None:
    window = Recorder()
    watched = window.watch(scenario)
    count = len(window.poses)
    window._press = lambda frame: "q" if frame == count + 30 else ""
    with pytest.raises(WindowClosed):
        window.spectator.stay(watched)
    assert len(window.poses) == count + 30
    assert window.texts[-1][3].startswith("GOAL reached   in ")
    assert window.poses[-1][:2] == pytest.approx(watched.ticks.position[-1].tolist(), abs=1e-12)


@pytest.fixture(scope="module")
def crossing() -> Scenario:
    return parse_scenario(
        "name: crossing\narena: {size: [6.0, 4.0]}\nstart: {position: [1.0, 2.0], heading: 0.0}\n"
        "goal: {position: [2.2, 2.0]}\nobstacles:\n"
        "  - {shape: cylinder, position: [5, 3], radius: 0.2}\n"
        "  - {shape: box, position: [4.0, 1.0], size: [0.6, 0.3], motion: {kind: circle, "
        "centre: [4.0, 2.0], speed: 0.5}}\n"
        "  - {shape: cylinder, position: [2.8, 3.6], radius: 0.2, motion: {kind: patrol, "
        "points: [[2.8, 3.6], [2.8, 0.5]], speed: 0.5, stops_for_robot: true}}\n"
        "  - {shape: cylinder, position: [5, 1], radius: 0.2, motion: {kind: trace, "
        "poses: [[0, 5, 1, 0]]}}\n"
    )


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_what_moves_is_where_it_is_at_that_time_and_its_arrow_points_where_it_goes(
    crossing: Scenario, drive: str
) -> None:
    window = Recorder()
    scenario = with_options(crossing, drive=drive)
    record = window.watch(scenario, 0.5)
    assert record.digest() == run(scenario).digest()
    # A solid and an arrow for each; what stands is not among them, and these not among what stands.
    assert {len(one) for one in window.moved} == {6} == {len(moving_meshes(scenario))}
    plain = scenario.model_copy(update={"obstacles": scenario.standing})
    corners = [sum(len(m.vertices) for m in still_meshes(one)) for one in (scenario, plain)]
    assert corners[0] == corners[1]
    headings = headings_of(record)
    for frame, moved in enumerate(window.moved):
        time = min(0.5 * FRAME * frame, float(record.ticks.time[-1]))
        assert np.array(moved[::2]) == pytest.approx(poses_at(record, time), abs=1e-9)
        tick = int(np.searchsorted(record.ticks.time, time))
        for k in (0, 1):
            x, y, heading = moved[2 * k + 1]
            assert (x, y) == moved[2 * k][:2]
            about = headings[max(tick - 1, 0) : tick + 2, k]  # between two ticks it may be either's
            assert np.abs(np.remainder(about - heading + np.pi, 2 * np.pi) - np.pi).min() < 1e-6
        assert moved[5][0] > 1e3  # out of sight: it goes nowhere


def test_the_sentence_tells_of_what_comes() -> None:
    scenario = parse_scenario(
        "name: left\narena: {size: [6.0, 4.0]}\nstart: {position: [1.0, 2.0], heading: 0.0}\n"
        "goal: {position: [5.0, 2.0]}\nobstacles:\n"
        "  - {shape: cylinder, position: [1.0, 3.5], radius: 0.25, motion: {kind: patrol, "
        "points: [[1, 3.5], [1, 2.6]], speed: 0.3}}\n"
    )
    window, waits = Recorder(), Decision(0.0, 0.0, 0.0, mode="routine")
    with world_of(scenario) as world:
        spectator = Spectator(
            window, scenario, 1.0, lambda: window.now, window.sleep, world.movers.poses
        )
        episode = Episode(world, scenario)
        while episode.now.time < 2.0:
            before = episode.now
            episode.advance(waits)
            spectator(before, waits, episode.now)
    assert window.texts[-1][3] == "A moving obstacle comes from the left: waits"


# --- on a screen


def test_without_a_screen_one_line_says_what_to_use_instead(
    fuzzyq: Call, inside: Call, short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    done = fuzzyq("watch", short)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "error: no window can be opened: the variable DISPLAY is not set; "
        "`fuzzyq run` needs no screen\n"
    )
    monkeypatch.setenv("DISPLAY", ":64999")
    with pytest.raises(UserError, match=r"there is no X server at DISPLAY=:64999; `fuzzyq run`"):
        inside("watch", short)


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    with screen(tmp_path_factory.mktemp("screen")) as found:
        yield found


@needs_screen
@pytest.mark.slow
@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_in_the_window_the_robot_drives_as_it_does_alone(
    scenario: Scenario, short: Path, drive: str, shown: Screen
) -> None:
    code = (
        "import sys\n"
        "from fuzzyq_bullet import load_scenario, with_options\n"
        "from fuzzyq_bullet.live import watch\n"
        "task = with_options(load_scenario(sys.argv[1]), drive=sys.argv[2])\n"
        "print(watch(task, speed=4.0, stay=False).digest())\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(short), drive],
        env=shown.environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    digest = run(with_options(scenario, drive=drive)).digest()
    assert (done.stdout, done.returncode) == (f"{digest}\n", 0), done.stderr


def until(true: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    """Wait for something, as long as a process lives."""
    for _ in range(1200):
        if true():
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    raise AssertionError("it never happened")


@needs_screen
@pytest.mark.slow
def test_the_window_shows_robot_goal_obstacles_and_lines_in_their_colours(
    short: Path, shown: Screen
) -> None:
    process = subprocess.Popen(
        [FUZZYQ, "watch", short, "--speed", "0.1"],
        env=shown.environment,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        for colour, least in (
            *((colour, 50) for colour in style.LINES),
            (style.ROBOT, 100),  # its text is of the same colour
            (style.PAGE, 10_000),
        ):
            until(lambda least=least, colour=colour: shown.shows(colour) > least, process)  # type: ignore[misc]
        # What is lit has not exactly the colour that it is painted in.
        ground = tuple(0.85 * part for part in style.GROUND)
        assert shown.shows(ground, within=12) > 10_000  # type: ignore[arg-type]
        reds, greens, blues = shown.picture().astype(int).transpose(2, 0, 1)
        assert ((greens > reds + 60) & (greens > blues + 20)).sum() > 50  # the goal
    finally:
        process.terminate()
        _, said = process.communicate(timeout=60)
    assert process.returncode == 143
    assert said == "error: interrupted\n"


@needs_screen
@pytest.mark.slow
@pytest.mark.skipif(shutil.which("xdotool") is None, reason="needs the program xdotool")
@pytest.mark.parametrize("key", ["q", "Escape"])
def test_a_key_that_a_person_presses_arrives(key: str, short: Path, shown: Screen) -> None:
    def tool(*words: str) -> str:
        command = ["xdotool", *words]
        done = subprocess.run(command, env=shown.environment, capture_output=True, text=True)
        return done.stdout

    process = subprocess.Popen(
        [FUZZYQ, "watch", short, "--speed", "0.1"],
        env=shown.environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        until(lambda: shown.shows(style.LINES[0]) > 50, process)
        tool("windowfocus", tool("search", "--name", "Bullet").split()[-1])
        tool("key", "--delay", "80", key)
        out, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, out, said) == (0, "", "closed before the run was over\n")


@needs_screen
@pytest.mark.slow
def test_a_screen_without_opengl_is_none(short: Path, tmp_path: Path) -> None:
    with screen(tmp_path, "-extension", "GLX") as plain:
        done = subprocess.run(
            [FUZZYQ, "watch", short], env=plain.environment, capture_output=True, text=True
        )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "has no OpenGL; `fuzzyq run` needs no screen" in done.stderr


def test_via_points_and_the_heading_asked_for_are_on_the_ground() -> None:
    rounds = load_scenario("rounds")
    goal = rounds.goal.model_copy(update={"heading": None})
    plain = rounds.model_copy(update={"via": (), "goal": goal})
    more, less = still_meshes(rounds), still_meshes(plain)
    assert len(more) == len(less) + len(rounds.via) + 1
    tips = np.concatenate([mesh.vertices[:, :2] for mesh in more])
    heading = rounds.goal.heading
    assert heading is not None
    x, y = rounds.goal.position
    reach = 2.5 * rounds.goal.radius
    tip = (x + reach * np.cos(heading), y + reach * np.sin(heading))
    assert np.hypot(*(tips - tip).T).min() < 1e-9
