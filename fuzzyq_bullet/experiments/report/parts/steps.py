"""Table 5 on the page: mean steps beside the paper's, and what failures do to them."""

from __future__ import annotations

import numpy as np

from fuzzyq_bullet.experiments.learning_gain.candidates import ONE, USUAL_BREAKOUT, label_of
from fuzzyq_bullet.experiments.report.found import Found
from fuzzyq_bullet.experiments.report.markup import join
from fuzzyq_bullet.experiments.report.measures import met_by_all
from fuzzyq_bullet.experiments.report.parts import blocks
from fuzzyq_bullet.experiments.report.parts.blocks import Section
from fuzzyq_bullet.experiments.report.settings import Planners
from fuzzyq_bullet.experiments.steps.plan import roles
from fuzzyq_bullet.experiments.steps.show import orders_in_words
from fuzzyq_bullet.experiments.steps.table import summary_of
from fuzzyq_bullet.planning.fuzzy_q_lambda import Weights

COMMAND = "fuzzyq bench steps --out {}"


def pair_of(settings: Planners) -> Weights:
    """Return the best fixed pair of a table: the fixed weights in it that are not 1/1, if any."""
    pairs = [
        Weights(float(told["weights"][0]), float(told["weights"][1]), USUAL_BREAKOUT)
        for name, told in settings.planners.items()
        if name.startswith("fixed-")
    ]
    return next((one for one in pairs if label_of(one) != label_of(ONE)), ONE)


def section(sweep: Found, settings: Planners, search: Found | None) -> Section:
    """Return the section.

    Args:
        sweep: The table's sweep.
        settings: Its settings.
        search: The search for the best pair; None where the pair was given.
    """
    title = f"Steps to the goal (Table 5), {settings.drive}"
    name = blocks.name_of("steps", sweep.folder)
    rows = met_by_all(sweep.rows)
    head = blocks.unfinished(sweep)
    if not rows:
        told = blocks.paragraphs("No environment has been met by all planners yet.")
        return Section(name, title, join(head, told))
    kinematic = settings.drive == "kinematic"
    limit = settings.limits.steps
    pair = pair_of(settings)
    rng = np.random.default_rng(settings.seed)
    summary = summary_of(rows, roles(pair), limit if kinematic else None, rng)
    how = "given" if search is None else "the best on training environments"
    unit = (
        "Steps are moves by Eq. 17, the paper's steps."
        if kinematic
        else "Steps are those of the physics, 240 a second: not the paper's; look at the time."
    )
    about = (
        f"{settings.counts[0]} obstacles, walled 10 × 10 m, seed {settings.seed}; "
        f"{summary.feasible} of {summary.environments} environments have a way for a disc of "
        f"radius 0.22 m. {unit} improved-fuzzy has weights 0.5/0.5; the pair "
        f"{pair.step:g}/{pair.turn:g} was {how}."
    )
    failures = (
        "The paper does not say how failures count. Steps: mean over the runs that reached the "
        "goal, with a bootstrapped 95 % interval. All reached: mean over the "
        f"{summary.common} environments that all planners with ways out solved. As M_s: mean over "
        f"all runs, each failure counting as {limit}."
    )
    return Section(
        name,
        title,
        join(
            head,
            blocks.paragraphs(about, failures),
            blocks.table(
                "Mean number of steps to the goal, the paper's beside ours.",
                [
                    "planner",
                    "paper",
                    "steps",
                    "reached",
                    "collisions",
                    "all reached",
                    "as M_s",
                    "time (s)",
                ],
                [
                    [
                        line.role,
                        blocks.number(line.paper, "d"),
                        blocks.estimate(line.steps, ".1f"),
                        f"{line.reached} of {line.runs}",
                        str(line.collisions),
                        blocks.number(line.common),
                        blocks.number(line.punished),
                        blocks.number(line.time),
                    ]
                    for line in summary.lines
                ],
            ),
            blocks.bullets(orders_in_words(summary)),
        ),
    )
