"""The page: one HTML file that needs no server, no other file and no script."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from fuzzyq_bullet.figures import FIGURES
from fuzzyq_bullet.studies.registry import study_names, study_of
from fuzzyq_bullet.studies.report import sections
from fuzzyq_bullet.studies.report.films import Film, Place
from fuzzyq_bullet.studies.report.found import Found
from fuzzyq_bullet.studies.report.markup import MARK, Html, join, tag
from fuzzyq_bullet.studies.report.sections import Section

TITLE = "Planners among obstacles they have never seen"
_POLICY = (
    "default-src 'none'; img-src data:; media-src data:; style-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'"
)
"""What a browser may load: nothing but what is in the page."""


def page(
    folder: Path,
    found: Sequence[Found],
    films: Mapping[Place, Film] | None,
    figures: Mapping[int, bytes] | None,
    command: str,
    plugins: Sequence[str] = (),
) -> str:
    """Return the whole page.

    Args:
        folder: What it is about.
        found: The studies in it.
        films: The runs to be watched; None to leave them out.
        figures: The paper's figures, as PNGs, by number; None to leave them out.
        command: The command that makes this page.
        plugins: What that was given by ``--plugin``.
    """
    heads, shown = [], []
    for one in found:
        if one.study is not None:
            findings = sections.findings_of(one)
            if findings is not None and findings.headline is not None:
                heads.append(sections.table(findings.headline))
            mine = None if films is None or not one.kind.filmed else _of(films, one.folder)
            shown.append(sections.of_study(one, one.study, findings, mine))
    shown += [_figures(figures), sections.made(found, folder, command, plugins)]
    unfinished = [sections.unfinished(swept) for one in found for swept in one.results.values()]
    missing = _missing(folder, found)
    links = [tag("li", tag("a", one.title, href=f"#{one.name}")) for one in shown]
    body = tag(
        "body",
        tag(
            "header",
            tag("h1", TITLE),
            tag(
                "p",
                "The evaluation of “Local Path Planning via Improved Fuzzy and Q(λ)-learning "
                "Algorithms for the Mobile Robot”, done again by fuzzyq_bullet: how often, how "
                "fast and how safely each planner crosses unknown fields.",
            ),
            *unfinished,
            *heads,
        ),
        tag("nav", tag("ul", *links), aria_label="Sections"),
        tag(
            "main",
            *(
                tag("section", tag("h2", one.title, id=one.name + "-title"), one.body,
                    id=one.name, aria_labelledby=one.name + "-title")
                for one in shown
            ),
            *([tag("section", tag("h2", "Not here yet"), missing)] if missing else []),
        ),
    )  # fmt: skip
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=_POLICY),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="generator", content=MARK),
        tag("title", f"{TITLE}: {folder}"),
        tag("link", rel="icon", href="data:,"),
        tag("style", Html(_css())),
    )
    return "<!doctype html>\n" + tag("html", head, "\n", body, lang="en") + "\n"


def _of(films: Mapping[Place, Film], folder: Path) -> dict[str, dict[str, Film]]:
    table: dict[str, dict[str, Film]] = {}
    for (where, planner, role), film in films.items():
        if where == folder:
            table.setdefault(planner, {})[role] = film
    return table


def _missing(folder: Path, found: Sequence[Found]) -> Html:
    there = {one.kind.name for one in found if one.study is not None}
    return join(
        *(
            sections.missing(
                f"{study_of(name).title or name}.", f"fuzzyq bench {name} --out {folder / name}"
            )
            for name in study_names()
            if name not in there
        )
    )


def _figures(figures: Mapping[int, bytes] | None) -> Section:
    title = "Figures of the paper"
    if figures is None:
        left_out = sections.missing("Left out.", "fuzzyq figure NUMBER")
        return Section("figures", title, left_out)
    shown = []
    for number, contents in figures.items():
        alt = f"Fig. {number}: {FIGURES[number]}."
        caption = join(f"{alt} ", tag("code", f"fuzzyq figure {number}"))
        shown.append(sections.png(contents, alt, caption))
    return Section("figures", title, join(*shown))


def _css() -> str:
    return Path(__file__).with_name("page.css").read_text(encoding="utf-8")
