"""The report is a page of what sweeps wrote: complete, honest, and safe to open."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from fuzzyq_bullet import UserError
from fuzzyq_bullet.cli.app import call
from fuzzyq_bullet.studies import FieldsPlan, Plan, described, planners_of
from fuzzyq_bullet.studies.episodes import Environment, Row, as_csv, from_csv
from fuzzyq_bullet.studies.escape.study import Escape
from fuzzyq_bullet.studies.familiar.study import Familiar
from fuzzyq_bullet.studies.field.study import AgainstField
from fuzzyq_bullet.studies.learning.study import NO_CONTROLLER, ComparisonPlan
from fuzzyq_bullet.studies.learning.table import LEARNED
from fuzzyq_bullet.studies.report.films import picked
from fuzzyq_bullet.studies.report.markup import Html, join, tag
from fuzzyq_bullet.studies.robust.study import Robust
from fuzzyq_bullet.studies.selection import (
    HALF,
    ONE,
    TRIPLES,
    USUAL_BREAKOUT,
    SearchPlan,
    Weights,
    label_of,
)
from fuzzyq_bullet.studies.steps.study import contenders
from fuzzyq_bullet.studies.storage import Folder
from fuzzyq_bullet.studies.study import met_by_all
from fuzzyq_bullet.studies.success.table import measures_of, solved_by_all
from fuzzyq_bullet.studies.sweep import run_job
from fuzzyq_bullet.version import __version__
from fuzzyq_bullet.workers import WorkerPool
from tests.helpers.browser import CHROMIUM, browsing
from tests.helpers.commands import Here

PLANNERS = ("fuzzy", "fuzzy-q-lambda")


def row(planner: str, run: int, **more: object) -> Row:
    given = {
        "planner": planner,
        "drive": "kinematic",
        "count": 5,
        "run": run,
        "seed": run,
        "layout": "scatter",
        "feasible": True,
        "outcome": "goal",
        "steps": 20 + run,
        "time_s": 20.0 + run,
        "path_length_m": 11.0,
        "shortest_path_m": 10.0,
        "spl": 0.9,
        "min_clearance_m": 0.1,
        "collisions": 0,
        "digest": "0" * 32,
    }
    return Row.model_validate(given | more)


def plan_of(*planners: str, runs: int = 1, counts: tuple[int, ...] = (5,)) -> FieldsPlan:
    told = described(planners_of(planners))
    return FieldsPlan(sweep="success", planners=told, counts=counts, runs=runs)


def rows_of(plan: Plan) -> list[Row]:
    """Return a row for every episode, as if all had gone well."""
    return [row_of(where, name, drive) for where, name, drive in plan.schedule()]


def row_of(where: Environment, name: str, drive: str) -> Row:
    more = {"count": where.count, "seed": where.seed, "layout": where.layout, "drive": drive}
    return row(name, where.run, **more)


def write(folder: Path, settings: dict[str, object], rows: list[Row], table: str | None) -> None:
    """Write what a sweep leaves; without the name of a table, one that is still at work."""
    home = Folder(folder)
    home.claim({"version": __version__, **settings})
    home.journal.write_text("".join(one.model_dump_json() + "\n" for one in rows))
    if table is not None:
        (folder / table).write_text(as_csv(rows))


def success(
    folder: Path, plan: FieldsPlan, rows: list[Row] | None = None, *, done: bool = True
) -> Path:
    found = rows_of(plan) if rows is None else rows
    write(folder, plan.model_dump(mode="json"), found, "success.csv" if done else None)
    return folder


@pytest.fixture(autouse=True)
def _in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films are made one after the other, and a second long: workers are tested by sweeps."""
    monkeypatch.setattr(WorkerPool, "run", Here.run)
    monkeypatch.setattr("fuzzyq_bullet.studies.report.films.LONGEST", 0.1)
    monkeypatch.setattr("fuzzyq_bullet.studies.statistics.RESAMPLES", 500)


def report(monkeypatch: pytest.MonkeyPatch, *given: object) -> int:
    monkeypatch.setattr(sys, "argv", ["fuzzyq", "report", *map(str, given)])
    return call()


PLAIN = ("--no-videos", "--no-figures")


# Rows, read back


def test_rows_read_back_are_the_rows_written() -> None:
    rows = [
        row("a", 0),
        row("b", 0, outcome="error", error='x, "y"', steps=None, time_s=None, digest=None),
        row("c", 1, count=None, feasible=None, layout="semicircle", shortest_path_m=1 / 3),
    ]
    assert from_csv(as_csv(rows)) == rows
    hit = [row("a", 0, outcome="collision", collisions=1, at_fault=False)]
    assert from_csv(as_csv(hit)) == hit


def test_a_table_without_the_columns_that_came_later_is_read() -> None:
    rows = [row("a", 0), row("b", 0, outcome="error", error='x, "y"')]
    lines = list(csv.reader(io.StringIO(as_csv(rows))))
    least = lines[0].index("error") + 1
    for columns in range(least, len(lines[0])):
        text = io.StringIO()
        csv.writer(text).writerows(line[:columns] for line in lines)
        assert from_csv(text.getvalue()) == rows
    text = io.StringIO()
    csv.writer(text).writerows(line[: least - 1] for line in lines)
    with pytest.raises(ValueError, match=r"line 1: must have the columns planner,.*,at_fault"):
        from_csv(text.getvalue())


# Which runs are watched


def test_the_worst_is_a_failure_where_there_is_one_and_best_is_quick_for_its_way() -> None:
    rows = [
        row("a", 0, time_s=10.0, shortest_path_m=5.0),
        row("a", 1, time_s=12.0, shortest_path_m=10.0),
        row("a", 2, outcome="collision", time_s=1.0),
        row("a", 3, outcome="timeout", time_s=900.0, feasible=False),
        row("a", 4, outcome="error", time_s=None),
        row("b", 0, time_s=1.0),
    ]
    assert {role: one.run for role, one in picked(rows, "a").items()} == {
        "best": 1,
        "median": 0,
        "worst": 2,  # there was a way; without one it is no fault
    }
    assert {role: one.run for role, one in picked(rows, "b").items()} == {
        "best, median and worst": 0
    }
    assert picked(rows, "c") == {}


# How far, how long, how near


def test_measures_are_of_runs_that_arrived_and_common_ones_of_where_all_did() -> None:
    rows = [
        row("a", 0, path_length_m=12.0),
        row("a", 1, path_length_m=14.0, min_clearance_m=0.02),
        row("a", 2, outcome="collision", path_length_m=1.0),
        row("b", 0),
        row("b", 2),
    ]
    one = measures_of(rows[:3])
    assert one.runs == 2
    assert one.path is not None
    assert one.path.middle == pytest.approx(1.3)
    assert one.least == 0.02
    assert solved_by_all(rows) == {("scatter", 5, 0)}
    assert measures_of(rows[:3], solved_by_all(rows)).runs == 1
    assert [(one.planner, one.run) for one in met_by_all(rows)] == [
        *(("a", 0), ("a", 2), ("b", 0), ("b", 2))
    ]
    assert measures_of([]).path is None


# The page


class Page(HTMLParser):
    """The words of a page, its elements, and what is not closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in {"meta", "link", "img", "br"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def test_what_is_no_element_is_text() -> None:
    assert tag("p", "<b>&", class_='"x"') == '<p class="&quot;x&quot;">&lt;b&gt;&amp;</p>'
    assert join(tag("br"), None, "<") == "<br>&lt;"
    assert isinstance(join("a"), Html)


@pytest.mark.slow
def test_every_sweep_of_a_folder_is_on_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    home = tmp_path / "<i>out & about"
    success(home / "success", plan_of(*PLANNERS, counts=(5, 25)))
    pair = Weights(1.5, 0.5, USUAL_BREAKOUT)
    told = described(contenders(pair))
    table = FieldsPlan(sweep="steps steps", planners=told, counts=(50,), runs=2)
    write(home / "s" / "table", table.model_dump(mode="json"), rows_of(table), "steps.csv")
    labels = [label_of(one) for one in TRIPLES]
    for command in ("steps", "learning"):
        tried = labels if command == "learning" else labels[:2]
        rows = [row(label, run) for label in tried for run in (1, 2)]
        grid = SearchPlan(sweep=f"{command} grid", drive="kinematic", episodes=2, candidates=tried)
        write(home / command[0] / "grid", grid.model_dump(mode="json"), rows, "grid.csv")
    fixed = tuple(label_of(one) for one in (HALF, ONE))
    comparison = ComparisonPlan(
        sweep="learning comparison", drive="kinematic", seed=0, environments=2, counts=(5,),
        fixed=fixed,
    )  # fmt: skip
    met = [row(name, run) for name in (*fixed, NO_CONTROLLER, LEARNED) for run in (0, 1)]
    write(home / "l" / "comparison", comparison.model_dump(mode="json"), met, "comparison.csv")
    fields = Escape(
        planner="fuzzy", drive="wheels", runs=1, counts="5", traps=4, rectangles="30"
    ).plan()
    write(home / "escape", fields.model_dump(mode="json"), rows_of(fields), "escape.csv")
    again = Familiar(runs=1, counts="5", traps=1).plan()
    write(home / "familiar", again.model_dump(mode="json"), rows_of(again), "familiar.csv")
    disturbed = Robust(runs=1, count=5, disturbances="noise", levels="2").plan()
    write(home / "robust", disturbed.model_dump(mode="json"), rows_of(disturbed), "robust.csv")
    against = next(
        AgainstField(runs=1, planners="fuzzy,fuzzy-q-lambda", kinds="scatter").stages()
    ).plan
    write(home / "field", against.model_dump(mode="json"), rows_of(against), "field.csv")

    assert report(monkeypatch, home, *PLAIN) == 0
    assert capsys.readouterr().out == f"{home / 'report.html'}\n"
    text = (home / "report.html").read_text()
    page = Page(text)
    assert not page.open
    for words in (
        *(
            "Fig. 13",
            "Table 5",
            "2342",
            "best pair 1.5/0.5",
            "best on 2 environments of the training",
        ),
        *(
            "Noise, slip, latency and moving obstacles",
            "0.01 m",
            "What learning gains",
            "Out of dead ends, fuzzy",
            "1.00 [0.21, 1.00]",
            "traps",
            "Against the field",
            "time ÷ bound",
        ),
        *("fuzzyq bench steps --runs 2 --count 50 --grid 2 ", "--traps 4 --rectangles 30"),
        "--planners fuzzy,fuzzy-q-lambda --counts 5,25 --runs 1 --drive kinematic --seed 0",
    ):
        assert words in page.text, words
    assert "Not here yet" not in page.text
    assert "unfinished" not in page.text
    assert "i" not in dict(page.tags)
    for name, given in page.tags:  # nothing from elsewhere, and every picture has words
        assert name != "script"
        for key in ("src", "href", "poster"):
            assert str(given.get(key, "#")).startswith(("#", "data:")), given
        assert name != "img" or given.get("alt")
    targets = {given["id"] for _, given in page.tags if "id" in given}
    links = {str(given["href"])[1:] for name, given in page.tags if name == "a"}
    assert links <= targets

    assert report(monkeypatch, home, *PLAIN, "--out", tmp_path / "again.html") == 0
    assert (tmp_path / "again.html").read_text() == text


def test_what_is_unfinished_or_not_there_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = plan_of(*PLANNERS, runs=3)
    rows = rows_of(plan)[:3]
    success(tmp_path / "success", plan, rows, done=False)
    with (tmp_path / "success" / "journal.jsonl").open("a") as file:
        file.write('{"planner": "fuz')  # torn
    assert report(monkeypatch, tmp_path / "success", *PLAIN) == 0
    text = Page((tmp_path / "success" / "report.html").read_text()).text
    assert "unfinished, 3 of 6 episodes" in text
    assert "5 1 1.00 [0.21, 1.00] 1.00 [0.21, 1.00] all 1" in text  # of three environments
    assert "fuzzyq bench steps --out" in text
    assert "3 of 6 episodes so far" in capsys.readouterr().err

    (tmp_path / "success" / "journal.jsonl").write_text("")
    assert report(monkeypatch, tmp_path / "success", *PLAIN) == 0
    text = Page((tmp_path / "success" / "report.html").read_text()).text
    assert "No environment has been met by all planners yet" in text


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report with three films: a run that is made again, one that differs, and none."""
    home = tmp_path_factory.mktemp("filmed")
    plan = plan_of("improved-fuzzy", *PLANNERS)
    rows = {one.planner: one for one in rows_of(plan)}
    for job in plan.jobs(planners_of(plan.planners)):
        if job.planner != "improved-fuzzy":
            rows[job.planner] = run_job(job).row
    rows["fuzzy"] = rows["fuzzy"].model_copy(update={"digest": "0" * 32})
    success(home / "success", plan, list(rows.values()))
    told = home / "success" / "settings.json"
    settings = json.loads(told.read_text())
    settings["planners"]["improved-fuzzy"]["courage"] = 9
    settings["version"] = "0.0.1"
    told.write_text(json.dumps(settings))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WorkerPool, "run", Here.run)
        patch.setattr("fuzzyq_bullet.studies.report.films.LONGEST", 0.1)
        assert report(patch, home, "--no-figures") == 0
    return home / "report.html"


@pytest.mark.slow
def test_runs_are_made_again_from_their_rows_and_those_that_differ_are_marked(
    filmed: Path,
) -> None:
    text = filmed.read_text()
    page = Page(text)
    films = [given for name, given in page.tags if name == "video"]
    assert len(films) == 2
    assert str(films[1]["aria-label"]).startswith(
        "fuzzy-q-lambda, best, median and worst run: goal"
    )
    assert page.text.count("not the run of the row: its digest differs") == 1
    assert "1 runs did not come out as their rows have them" in page.text
    assert (
        "cannot be made again: the planner's settings are not this version's: courage" in page.text
    )
    assert "sweeps of another version (0.0.1)" in page.text


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_a_browser_shows_it_on_a_phone_in_light_and_dark_without_a_complaint(
    filmed: Path, tmp_path: Path
) -> None:
    alone = tmp_path / "elsewhere.html"
    shutil.copy(filmed, alone)
    corners = []
    with browsing(tmp_path / "profile") as browser:
        for width, dark in ((390, False), (390, True), (1280, True)):
            browser.open(alone, width=width, dark=dark)
            assert browser.value("document.documentElement.scrollWidth") == width
            shown = Image.open(BytesIO(browser.picture())).convert("RGB")
            assert shown.width == width
            assert len(shown.getcolors(1 << 24) or ()) > 20  # letters are there
            corners.append(sum(shown.getpixel((2, 2))))
        broken = "[...document.images].filter(image => !image.naturalWidth).length"
        assert browser.value(broken) == 0
        seconds = browser.value(
            "new Promise((done, failed) => { const film = document.querySelector('video');"
            " film.onerror = failed; film.onloadeddata = () => done(film.duration);"
            " film.preload = 'auto'; film.load(); })"
        )
        assert seconds > 0.5
        assert browser.complaints == []
    assert corners[0] == 3 * 255
    assert max(corners[1:]) < 100


# Mistakes


def damaged(tmp_path: Path) -> Iterator[tuple[Path, list[str]]]:
    """Folders that are wrong in one way each, and what is said of them."""
    yield tmp_path / "gone", ["gone", "no such folder"]
    (tmp_path / "empty").mkdir()
    yield tmp_path / "empty", ["holds no sweep", "fuzzyq bench success --out"]
    for name, file, change, words in (
        ("cut", "success.csv", lambda text: text[: text.rstrip().rfind("\n") + 1], ["1 rows"]),
        ("torn", "success.csv", lambda text: text[:-9], ["line 3", "columns"]),
        ("word", "success.csv", lambda text: text.replace("20.0", "soon"), ["line 2", "time_s"]),
        ("head", "success.csv", lambda text: "a,b\n" + text, ["line 1", "planner,drive"]),
        ("void", "success.csv", lambda text: "", ["line 1", "planner,drive"]),
        ("alien", "success.csv", lambda text: text.replace("\nfuzzy,", "\nelse,"), ["no episode"]),
        ("twice", "success.csv", lambda text: text + text.splitlines()[1] + "\n", ["line 4"]),
        ("null", "success.csv", lambda text: text.replace("goal", "\0"), ["line 2"]),
        ("json", "settings.json", lambda text: text[:-5], ["settings.json", "damaged"]),
        ("keys", "settings.json", lambda text: text.replace('"runs"', '"ran"'), ["runs"]),
    ):
        folder = success(tmp_path / name, plan_of(*PLANNERS))
        path = folder / file
        path.write_text(change(path.read_text()))
        yield folder, [str(path), *words]
    folder = success(tmp_path / "bytes", plan_of(*PLANNERS))
    (folder / "success.csv").write_bytes(b"\xff\xfe")
    yield folder, ["success.csv", "UTF-8"]


def test_a_mistake_is_one_line_and_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder, words in damaged(tmp_path):
        with pytest.raises(UserError) as caught:
            report(monkeypatch, folder, *PLAIN)
        (line,) = caught.value.problems
        assert "\n" not in line
        assert all(word in line for word in words), line
        assert not (folder / "report.html").exists()


@pytest.mark.slow
def test_a_page_of_somebody_elses_is_replaced_only_when_asked_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = success(tmp_path / "success", plan_of(*PLANNERS))
    page = folder / "report.html"
    page.write_text("<!doctype html>\n<title>Mine</title>\n")
    with pytest.raises(UserError, match=r"report.html: is there already, .* --replace"):
        report(monkeypatch, folder, *PLAIN)
    assert "Mine" in page.read_text()
    report(monkeypatch, folder, *PLAIN, "--replace")
    made = page.read_text()
    assert "Mine" not in made
    report(monkeypatch, folder, *PLAIN)  # its own
    assert page.read_text() == made


def test_a_page_that_cannot_be_written_is_told_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = success(tmp_path / "success", plan_of(*PLANNERS))
    monkeypatch.setattr("fuzzyq_bullet.studies.report.films.make", lambda *_: 1 / 0)
    for out in ("/dev/null/page.html", tmp_path / "success", "/proc/page.html", ""):
        with pytest.raises(UserError) as caught:
            report(monkeypatch, folder, "--out", out)
        (line,) = caught.value.problems
        assert re.search("cannot be written|not a folder|--out", line), line


DAMAGED_SETTINGS = [
    ("escape", {"planner": {"name": "improved-fuzzy", "weights": "ab"}}),
    ("escape", {"planner": {"name": "improved-fuzzy", "weights": [1.0]}}),
    ("escape", {"planner": {"name": 3}}),
    ("escape", {"drives": []}),
    ("escape", {"runs": -1}),
    ("escape", {"runs": 0, "counts": [], "traps": 0}),
    ("success", {"planners": {"fixed-1-1": {"name": "improved-fuzzy"}}}),
    ("success", {"planners": {"fuzzy": {"name": "fuzzy", "weights": {"a": 1}}}}),
    ("success", {"counts": [-5]}),
    ("success", {"seed": 1e300}),
]


@pytest.mark.parametrize(("kind", "changes"), DAMAGED_SETTINGS)
def test_settings_that_no_sweep_has_written_are_one_line(
    kind: str, changes: dict[str, object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = {"drive": "kinematic", "runs": 1, "counts": "5", "traps": 0, "rectangles": "none"}
    plan = plan_of("fuzzy") if kind == "success" else Escape.model_validate(asked).plan()
    whole = plan.described()
    write(tmp_path, {"sweep": kind, **whole, **changes}, [], None)
    with pytest.raises(UserError, match=r"settings\.json: is damaged: "):
        report(monkeypatch, tmp_path, *PLAIN)
