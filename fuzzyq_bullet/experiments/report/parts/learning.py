"""On the page: what learned weights gain over fixed ones (``fuzzyq bench learning``)."""

from __future__ import annotations

import numpy as np

from fuzzyq_bullet.experiments.learning_gain import candidates
from fuzzyq_bullet.experiments.learning_gain.choice import best_of
from fuzzyq_bullet.experiments.learning_gain.picture import picture
from fuzzyq_bullet.experiments.learning_gain.table import summary_of, time_ratios
from fuzzyq_bullet.experiments.report.found import Found
from fuzzyq_bullet.experiments.report.markup import join
from fuzzyq_bullet.experiments.report.parts import blocks
from fuzzyq_bullet.experiments.report.parts.blocks import Section
from fuzzyq_bullet.experiments.report.settings import Comparison

COMMAND = "fuzzyq bench learning --out {}"

_HEAD = (
    *("weights", "values", "success", "collisions", "time (s)", "driven ÷ shortest"),
    "learned ÷ this",
)


def section(comparison: Found, settings: Comparison, search: Found) -> Section:
    """Return the section; both sweeps belong to one call of the command."""
    title = f"What learning gains, {settings.drive}"
    name = blocks.name_of("learning", comparison.folder)
    if not (comparison.finished and search.finished):
        return Section(name, title, join(blocks.unfinished(search), blocks.unfinished(comparison)))
    pair, triple = (
        best_of(search.rows, some).best for some in (candidates.PAIRS, candidates.TRIPLES)
    )
    chosen = (candidates.HALF, candidates.ONE, pair, triple)
    names = ("0.5/0.5", "1/1", "best pair", "best triple")
    roles = dict(zip(names, map(candidates.label_of, chosen), strict=True))
    rows = comparison.rows
    summary = summary_of(rows, roles, "best pair", np.random.default_rng(settings.seed))
    weights = dict(zip(names, map(candidates.words_of, chosen), strict=True))
    against = {one.role: one for one in summary.against}
    table = blocks.table(
        f"Means over the {summary.common} environments that all solved; success over the "
        f"{summary.feasible} of {summary.environments} that have a way; learned over this with "
        "95 % intervals, over the environments that both solved.",
        _HEAD,
        [
            [
                line.role,
                weights.get(line.role, "by situation"),
                blocks.number(line.figures.found, ".3f"),
                str(line.figures.collisions),
                blocks.number(line.figures.time, ".2f"),
                blocks.number(line.figures.path, ".3f"),
                blocks.estimate(against[line.role].time if line.role in against else None, ".3f"),
            ]
            for line in summary.lines
        ],
    )  # fmt: skip
    told = [f"Target: {one}: {'met' if one.met else 'MISSED'}." for one in summary.targets]
    shown = picture(summary, time_ratios(rows, roles["best pair"]), title)
    return Section(
        name,
        title,
        join(
            table,
            blocks.bullets(told),
            blocks.picture(
                blocks.png(shown),
                "Time of the learned planner over that of the best fixed pair in each environment, "
                "and the intervals of all comparisons; the table above has the figures.",
            ),
        ),
    )
