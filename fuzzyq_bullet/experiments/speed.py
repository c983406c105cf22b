"""``fuzzyq bench speed``: what the project promises about its own speed, measured."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median, quantiles
from typing import Literal

from rich.table import Table

from fuzzyq_bullet.experiments.timing import interleaved, median_ratio


@dataclass(frozen=True)
class Row:
    """One measured figure.

    Attributes:
        what: What was compared.
        figure: The figure; None where it could not be measured.
        aim: What it should be.
        sense: Whether the aim is a least or a most.
        detail: The absolute figures behind it.
    """

    what: str
    figure: float | None
    aim: float
    sense: Literal["at least", "at most"]
    detail: str

    @property
    def met(self) -> bool:
        """Whether the aim is met; what was not measured misses nothing."""
        if self.figure is None:
            return True
        return self.figure >= self.aim if self.sense == "at least" else self.figure <= self.aim


@dataclass(frozen=True)
class Measurement:
    """A group of figures that are measured together.

    Attributes:
        name: What to call it while it runs.
        rows: Measures, given the number of rounds and the decisions a second.
    """

    name: str
    rows: Callable[[int, int], list[Row]]


def _loop(rounds: int, rate: int) -> list[Row]:
    from fuzzyq_bullet.experiments.loop_speed import compare

    few, many = compare(rounds, rate)
    among = f"125 obstacles, {rate} decisions a second"
    decisions = f"{len(few.decisions)} decisions among {among}"
    return [
        Row(
            f"real time factor of one core, {among}",
            1.0 / median(few.whole),
            40.0,
            "at least",
            f"{1e3 * median(few.whole):.1f} ms for a simulated second",
        ),
        Row(
            f"share of bare physics in that time, {among}",
            median_ratio(few.bare, few.whole),
            0.5,
            "at least",
            f"{1e3 * median(few.bare):.1f} ms for a simulated second",
        ),
        Row(
            "time of a simulated second, 1000 obstacles against 125",
            median_ratio(many.whole, few.whole),
            1.15,
            "at most",
            f"{1e3 * median(many.whole):.1f} ms against {1e3 * median(few.whole):.1f} ms",
        ),
        Row(
            "time of one decision, median (ms)",
            1e3 * median(few.decisions),
            0.6,
            "at most",
            decisions,
        ),
        Row(
            "time of one decision, 99th percentile (ms)",
            1e3 * quantiles(few.decisions, n=100)[-1],
            20.0,
            "at most",
            f"longest {1e3 * max(few.decisions):.1f} ms",
        ),
    ]


def _film(rounds: int, rate: int) -> list[Row]:
    from fuzzyq_bullet.experiments.video_speed import compare

    times = compare(rounds)
    return [
        Row(
            "film against encoding ready-made frames",
            median_ratio(times.encoding, times.pipeline),
            0.7,
            "at least",
            f"{times.frames / median(times.pipeline):.0f} frames/s against "
            f"{times.frames / median(times.encoding):.0f}",
        ),
        Row(
            "film against real time, 720p",
            times.seconds / median(times.pipeline),
            6.0,
            "at least",
            f"{times.seconds:.1f} s of film in {median(times.pipeline):.1f} s",
        ),
    ]


def _run(rounds: int, rate: int) -> list[Row]:
    from fuzzyq_bullet.trajectory import Trajectory
    from fuzzyq_bullet.video import record

    taken = []
    with tempfile.TemporaryDirectory(prefix="fuzzyq-") as name:
        command = [
            sys.executable,
            "-m",
            "fuzzyq_bullet",
            "run",
            "mixed",
            "--replace",
            "--out",
            name,
        ]
        for _ in range(min(rounds, 3)):
            start = time.perf_counter()
            subprocess.run(command, capture_output=True, check=True)
            taken.append(time.perf_counter() - start)
        seconds = record(
            Trajectory.load(Path(name) / "mixed.npz"), Path(name) / "again.mp4"
        ).seconds
    return [
        Row(
            "fuzzyq run mixed, start to finished film, against the film's length",
            seconds / median(taken),
            5.0,
            "at least",
            f"{seconds:.1f} s of film in {median(taken):.1f} s",
        )
    ]


def _inference(rounds: int, rate: int) -> list[Row]:
    import numpy as np

    from fuzzyq_bullet.fuzzy import paper_controller

    what = "one inference against pyfuzzylite"
    try:
        from fuzzyq_bullet.experiments.fuzzylite_twin import FuzzyliteTwin

        twin = FuzzyliteTwin(paper_controller())
    except ImportError:
        return [Row(what, None, 80.0, "at least", "pyfuzzylite is not installed (extra: test)")]
    rng = np.random.default_rng(0)
    inputs = np.column_stack([rng.uniform(0, 5, 100), rng.uniform(-5, 5, 100)]).tolist()
    controller = paper_controller()
    repeats = 20

    def ours() -> None:
        for _ in range(repeats):
            for d, df in inputs:
                controller.infer(d, df)

    def theirs() -> None:
        for d, df in inputs:
            twin.infer(d, df)

    own, other = interleaved([ours, theirs], rounds)
    each, twins = ([t / n for t in times] for times, n in ((own, 100 * repeats), (other, 100)))
    detail = f"{1e6 * median(each):.1f} µs against {1e6 * median(twins):.0f} µs"
    return [Row(what, median_ratio(twins, each), 80.0, "at least", detail)]


MEASUREMENTS: Sequence[Measurement] = (
    Measurement("episodes", _loop),
    Measurement("the film", _film),
    Measurement("a whole run", _run),
    Measurement("the controller", _inference),
)


def as_table(rows: Sequence[Row]) -> Table:
    """Return the rows as a table for a terminal."""
    table = Table("compared", "measured", "aim", "", "in absolute terms, here and now", box=None)
    table.columns[1].justify = "right"
    for row in rows:
        figure = "not measured" if row.figure is None else f"{row.figure:.2f}"
        verdict = "" if row.figure is None else ("met" if row.met else "MISSED")
        table.add_row(row.what, figure, f"{row.sense} {row.aim:g}", verdict, row.detail)
    return table


def as_json(rows: Sequence[Row]) -> str:
    """Return the rows as JSON."""
    return json.dumps([{**asdict(row), "met": row.met} for row in rows], indent=2)
