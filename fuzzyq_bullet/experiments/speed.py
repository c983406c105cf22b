"""``fuzzyq bench speed``: what the project promises about its own speed, measured.

Every figure but the oracle's seconds is a ratio of two pieces of work timed in turn within one run,
so that a slow or busy machine changes both alike.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from statistics import median
from typing import Literal

from rich.table import Table

from fuzzyq_bullet.experiments.timing import interleaved, least_ratio, median_ratio

MORE_ROUNDS = 3
"""Rounds of the episode loop for each round of the rest: its target is close, and it is short."""


@dataclass(frozen=True)
class Row:
    """One measured figure.

    Attributes:
        what: What was compared.
        figure: The figure; None where it could not be measured.
        target: What it should be.
        sense: Whether the target is a least or a most.
        detail: The absolute figures behind it, for orientation only.
    """

    what: str
    figure: float | None
    target: float
    sense: Literal["at least", "at most"]
    detail: str

    @property
    def met(self) -> bool:
        """Whether the target is met; what was not measured misses nothing."""
        if self.figure is None:
            return True
        return (
            self.figure >= self.target if self.sense == "at least" else self.figure <= self.target
        )


@dataclass(frozen=True)
class Measurement:
    """A group of figures that are measured together.

    Attributes:
        name: What to call it while it runs.
        rows: Measures, given the number of rounds.
    """

    name: str
    rows: Callable[[int], list[Row]]


def _loop(rounds: int) -> list[Row]:
    from fuzzyq_bullet.experiments.loop_speed import prepare

    counts, fields = (125, 1000), 3
    loops = [prepare(count, seed) for count in counts for seed in range(fields)]
    # The two of a pair follow each other at once, and there are many pairs: what they are to tell
    # is no larger than what else goes on in a machine changes from one second to the next.
    works = [work for loop in loops for work in (loop.whole, loop.bare)]
    times = interleaved(works, MORE_ROUNDS * rounds)
    rows = []
    seconds = []  # what a simulated second costs, by the number of obstacles
    for k, count in enumerate(counts):
        own = slice(k * fields, (k + 1) * fields)
        all_of_it = [sum(of_round) for of_round in zip(*times[::2][own], strict=True)]
        simulated = sum(loop.simulated for loop in loops[own])
        seconds.append([taken / simulated for taken in all_of_it])
        rows.append(
            Row(
                f"episode loop against bare physics, {count} obstacles",
                least_ratio(times[1::2][own], times[::2][own]),
                0.85,
                "at least",
                f"{simulated / min(all_of_it):.0f} × real time",
            )
        )
    few, many = seconds
    rows.append(
        Row(
            "cost of a simulated second, 1000 obstacles against 125",
            median_ratio(many, few),
            1.15,
            "at most",
            f"{1e3 * min(many):.1f} ms against {1e3 * min(few):.1f} ms",
        )
    )
    return rows


def _escape(rounds: int) -> list[Row]:
    from fuzzyq_bullet.experiments.escape_speed import compare

    costs = compare(rounds)
    return [
        Row(
            "cost of a simulated second, 125 obstacles against 25, escape included",
            median_ratio(costs.many, costs.few),
            1.25,
            "at most",
            f"{1e3 * min(costs.many):.1f} ms against {1e3 * min(costs.few):.1f} ms; "
            f"{costs.escaping:.0%} of the decisions escape",
        ),
        Row(
            "seconds of the oracle for 125 obstacles",
            median(costs.oracle),
            1.0,
            "at most",
            "the slowest of four fields, nothing remembered",
        ),
    ]


def _inference(rounds: int) -> list[Row]:
    import numpy as np

    from fuzzyq_bullet.fuzzy import paper_controller

    what = "one inference against the same controller in pyfuzzylite"
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
    return [
        Row(
            what,
            median_ratio(twins, each),
            80.0,
            "at least",
            f"{1e6 * min(each):.1f} µs against {1e6 * min(twins):.0f} µs",
        )
    ]


def _video(rounds: int) -> list[Row]:
    from fuzzyq_bullet.experiments.video_speed import compare

    times = compare(rounds)
    return [
        Row(
            "video against encoding ready-made frames",
            median_ratio(times.encoding, times.pipeline),
            0.55,
            "at least",
            f"{times.frames / min(times.pipeline):.0f} frames/s against "
            f"{times.frames / min(times.encoding):.0f}",
        ),
        Row(
            "video against rendering every whole frame",
            median_ratio(times.whole_frame, [t / times.frames for t in times.pipeline]),
            25.0,
            "at least",
            f"{1e3 * min(times.pipeline) / times.frames:.1f} ms a frame against "
            f"{1e3 * min(times.whole_frame):.0f} ms",
        ),
        Row(
            "video against real time",
            median_ratio([times.seconds] * len(times.pipeline), times.pipeline),
            3.0,
            "at least",
            f"{times.seconds:.1f} s of video in {min(times.pipeline):.1f} s",
        ),
    ]


def _help(rounds: int) -> list[Row]:
    heavy = ("pybullet", "matplotlib")
    code = (
        "import sys\n"
        "from fuzzyq_bullet.cli import main\n"
        "sys.argv = ['fuzzyq', '--help']\n"
        "try:\n"
        "    main()\n"
        "except SystemExit:\n"
        "    pass\n"
        f"print([name for name in {heavy!r} if name in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = json.loads(done.stderr.strip().splitlines()[-1].replace("'", '"'))
    return [
        Row(
            "heavy libraries that --help imports",
            float(len(loaded)),
            0.0,
            "at most",
            ", ".join(loaded) or f"neither {' nor '.join(heavy)}",
        )
    ]


MEASUREMENTS: Sequence[Measurement] = (
    Measurement("the episode loop", _loop),
    Measurement("ways out", _escape),
    Measurement("the video", _video),
    Measurement("the controller", _inference),
    Measurement("the command line", _help),
)


def measure(measurement: Measurement, rounds: int) -> list[Row]:
    """Return the rows of one measurement."""
    return measurement.rows(rounds)


def as_table(rows: Sequence[Row]) -> Table:
    """Return the rows as a table for a terminal."""
    table = Table("compared", "figure", "target", "", "in absolute terms, here and now", box=None)
    table.columns[1].justify = "right"
    for row in rows:
        figure = "not measured" if row.figure is None else f"{row.figure:.2f}"
        verdict = "" if row.figure is None else ("met" if row.met else "MISSED")
        table.add_row(row.what, figure, f"{row.sense} {row.target:g}", verdict, row.detail)
    return table


def as_json(rows: Sequence[Row]) -> str:
    """Return the rows as JSON."""
    return json.dumps([{**asdict(row), "met": row.met} for row in rows], indent=2)
