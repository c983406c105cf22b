"""The page: one HTML file that needs no server, no other file and no script."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fuzzyq_bullet.experiments.figures import FIGURES
from fuzzyq_bullet.experiments.report.evaluation import Evaluation, Place
from fuzzyq_bullet.experiments.report.films import Film
from fuzzyq_bullet.experiments.report.markup import Html, join, tag
from fuzzyq_bullet.experiments.report.parts import blocks, escape, learning, made, steps, success
from fuzzyq_bullet.experiments.report.parts.blocks import Section

TITLE = "Planners among obstacles they have never seen"
_POLICY = (
    "default-src 'none'; img-src data:; media-src data:; style-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'"
)
"""What a browser may load: nothing but what is in the page."""


def page(
    evaluation: Evaluation,
    films: Mapping[Place, Film] | None,
    figures: Mapping[int, bytes] | None,
    command: str,
) -> str:
    """Return the whole page.

    Args:
        evaluation: What there is to show.
        films: The runs to be watched; None to leave them out.
        figures: The paper's figures, as PNGs, by number; None to leave them out.
        command: The command that makes this page.
    """
    sections = [
        *_of_sweeps(evaluation, films),
        _figures(figures),
        made.section(evaluation, command),
    ]
    missing = _missing(evaluation)
    links = [tag("li", tag("a", one.title, href=f"#{one.name}")) for one in sections]
    heads = (success.headline(one, settings) for one, settings in evaluation.success)
    body = tag(
        "body",
        tag(
            "header",
            tag("h1", TITLE),
            blocks.paragraphs(
                "The evaluation of “Local Path Planning via Improved Fuzzy and Q(λ)-learning "
                "Algorithms for the Mobile Robot”, done again by fuzzyq_bullet: how often, how "
                "fast and how safely each planner crosses unknown fields."
            ),
            join(*map(blocks.unfinished, evaluation.sweeps)),
            join(*heads),
        ),
        tag("nav", tag("ul", *links), aria_label="Sections"),
        tag(
            "main",
            *(
                tag("section", tag("h2", one.title, id=one.name + "-title"), one.body,
                    id=one.name, aria_labelledby=one.name + "-title")
                for one in sections
            ),
            *([tag("section", tag("h2", "Not here yet"), missing)] if missing else []),
        ),
    )  # fmt: skip
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=_POLICY),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="generator", content="fuzzyq report"),
        tag("title", f"{TITLE}: {evaluation.folder}"),
        tag("link", rel="icon", href="data:,"),
        tag("style", Html(_css())),
    )
    return "<!doctype html>\n" + tag("html", head, "\n", body, lang="en") + "\n"


def _of_sweeps(evaluation: Evaluation, films: Mapping[Place, Film] | None) -> list[Section]:
    sections = []
    for one, settings in evaluation.success:
        mine = None if films is None else _by_planner(films, one.folder)
        sections.append(success.section(one, settings, mine))
    sections += [steps.section(*parts) for parts in evaluation.steps]
    sections += [learning.section(*parts) for parts in evaluation.learning]
    sections += [escape.section(*parts) for parts in evaluation.escape]
    return sections


def _by_planner(films: Mapping[Place, Film], folder: Path) -> dict[str, dict[str, Film]]:
    table: dict[str, dict[str, Film]] = {}
    for (where, planner, role), film in films.items():
        if where == folder:
            table.setdefault(planner, {})[role] = film
    return table


def _missing(evaluation: Evaluation) -> Html:
    parts = (
        (evaluation.success, "Success by obstacles (Fig. 13).", success.COMMAND, "success"),
        (evaluation.steps, "Steps to the goal (Table 5).", steps.COMMAND, "steps"),
        (evaluation.learning, "What learning gains.", learning.COMMAND, "learning"),
        (evaluation.escape, "Out of dead ends.", escape.COMMAND, "escape"),
    )
    return join(
        *(
            blocks.missing(what, command.format(evaluation.folder / name))
            for there, what, command, name in parts
            if not there
        )
    )


def _figures(figures: Mapping[int, bytes] | None) -> Section:
    title = "Figures of the paper"
    if figures is None:
        return Section("figures", title, blocks.missing("Left out.", "fuzzyq figure NUMBER"))
    shown = []
    for number, contents in figures.items():
        alt = f"Fig. {number}: {FIGURES[number].shows}."
        caption = join(f"{alt} ", tag("code", f"fuzzyq figure {number}"))
        shown.append(blocks.picture(contents, alt, caption))
    return Section("figures", title, join(*shown))


def _css() -> str:
    return Path(__file__).with_name("page.css").read_text(encoding="utf-8")
