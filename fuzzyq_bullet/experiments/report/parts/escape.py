"""On the page: whether the planner finds a way wherever there is one (``fuzzyq bench escape``)."""

from __future__ import annotations

from fuzzyq_bullet.experiments.escape.table import table_of
from fuzzyq_bullet.experiments.report.found import Found
from fuzzyq_bullet.experiments.report.markup import join
from fuzzyq_bullet.experiments.report.parts import blocks
from fuzzyq_bullet.experiments.report.parts.blocks import Section
from fuzzyq_bullet.experiments.report.settings import Escape

COMMAND = "fuzzyq bench escape --out {}"


def section(sweep: Found, settings: Escape) -> Section:
    """Return the section."""
    planner = str(settings.planner.get("name"))
    title = f"Out of dead ends, {planner}"
    name = blocks.name_of("escape", sweep.folder)
    lines = table_of(sweep.rows)
    if not lines:
        return Section(name, title, blocks.unfinished(sweep))
    missed = [
        f"Target missed: {line.family}{'' if line.count is None else f' {line.count}'}, "
        f"{one.drive}: {one.what} {one.figure:.4g}, wanted {one.sense} {one.bound:g}."
        for line in lines
        for one in line.targets
        if not one.met
    ]
    return Section(
        name,
        title,
        join(
            blocks.unfinished(sweep),
            blocks.table(
                "Found: share of the environments with a way for a disc of radius 0.22 m in which "
                "the goal was reached. Time: median over that of the shortest path at full speed.",
                ["obstacles", "drive", "with a way", "found", "collisions", "driven ÷ shortest",
                 "time ÷ shortest", "least (m)"],
                [
                    [
                        line.family if line.count is None else f"{line.family} {line.count}",
                        drive,
                        f"{one.feasible} of {one.episodes}",
                        blocks.number(one.found, ".2f"),
                        str(one.collisions),
                        blocks.number(one.path_ratio, ".2f"),
                        blocks.number(one.time_ratio, ".2f"),
                        blocks.number(one.clearance, ".3f"),
                    ]
                    for line in lines
                    for drive, one in line.drives.items()
                ],
            ),
            blocks.bullets(missed or ["All targets met."]),
        ),
    )  # fmt: skip
