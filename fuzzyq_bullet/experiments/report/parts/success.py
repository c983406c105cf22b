"""Fig. 13 on the page: success, how far, how long and how near, and the runs to be watched."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fuzzyq_bullet.experiments.report.films import SIZE, Film
from fuzzyq_bullet.experiments.report.found import Found
from fuzzyq_bullet.experiments.report.markup import Html, data_uri, join, tag
from fuzzyq_bullet.experiments.report.measures import (
    by_planner,
    measures_of,
    met_by_all,
    solved_by_all,
)
from fuzzyq_bullet.experiments.report.parts import blocks
from fuzzyq_bullet.experiments.report.parts.blocks import Section
from fuzzyq_bullet.experiments.report.pick import RULE
from fuzzyq_bullet.experiments.report.picture import picture
from fuzzyq_bullet.experiments.report.settings import Planners
from fuzzyq_bullet.experiments.success.picture import picture as figure13
from fuzzyq_bullet.experiments.success.show import HOW_FAILURES_COUNT
from fuzzyq_bullet.experiments.success.table import Line, Summary, summary_of
from fuzzyq_bullet.experiments.sweep.rows import Row

COMMAND = "fuzzyq bench success --out {}"
HEADLINE = (25, 75, 125)
"""Numbers of obstacles of the first table, where they were run."""
MOST_COLUMNS = 4

Films = Mapping[str, Mapping[str, Film]]
"""By planner, then by what the run is, such as ``best``."""


def headline(sweep: Found, settings: Planners) -> Html:
    """Return the table that says it in one look; empty while nothing can be compared."""
    rows = met_by_all(sweep.rows)
    if not rows:
        return Html()
    summary = summary_of(rows)
    lines = {line.count: line for line in summary.lines}
    chosen = [lines[count] for count in _chosen(sorted(c for c in lines if c is not None))]
    total = summary.total
    return blocks.table(
        f"Share of environments in which the goal was reached, {settings.drive}, by the number of "
        "obstacles, with Wilson's 95 % intervals. Last column: only where a disc of radius 0.22 m "
        "has a way.",
        ["planner", *(str(line.count) for line in chosen), "all", "all with a way"],
        [
            [
                name,
                *(blocks.share(line.cells[name].all) for line in chosen),
                blocks.share(total.cells[name].all),
                blocks.share(total.cells[name].feasible),
            ]
            for name in summary.planners
        ],
    )


def section(sweep: Found, settings: Planners, films: Films | None) -> Section:
    """Return the section of one sweep.

    Args:
        sweep: The sweep.
        settings: Its settings.
        films: The runs to be watched; None where none were asked for.
    """
    title = f"Success by obstacles (Fig. 13), {settings.drive}"
    rows = met_by_all(sweep.rows)
    parts = [blocks.unfinished(sweep)]
    if not rows:
        parts.append(blocks.paragraphs("No environment has been met by all planners yet."))
        return Section(blocks.name_of("success", sweep.folder), title, join(*parts))
    summary = summary_of(rows)
    count = summary.total.environments
    about = f"{settings.drive}; seed {settings.seed}; walled 10 × 10 m"
    parts += [
        blocks.paragraphs(
            f"{count} environments, the same for every planner, up to {settings.runs} for each "
            f"number of obstacles; {summary.total.feasible} of them have a way for a disc of "
            f"radius 0.22 m. {HOW_FAILURES_COUNT} M_s is {settings.limits.steps}."
        ),
        blocks.picture(
            blocks.png(figure13(summary, f"Success by planner: {about}")),
            f"Success of each planner by the number of obstacles, {settings.drive}. "
            + "; ".join(_in_words(summary, name) for name in summary.planners),
            "Fig. 13 with Wilson's 95 % intervals: above over all environments, below over those "
            "that have a way. The table holds the same figures.",
        ),
        tag("details", tag("summary", "All figures of the plot"), *_tables(summary)),
        tag("h3", "How runs ended"),
        _ends(summary),
        blocks.bullets(
            f'The paper\'s order "{claim.what}" is '
            f"{'seen' if claim.reproduced else 'NOT seen'} here."
            for claim in summary.claims
        ),
        tag("h3", "How far, how long, how near"),
        _measures(rows),
        blocks.picture(
            blocks.png(picture(rows, f"Runs that reached the goal: {about}")),
            "Driven over shortest path, time to the goal and least distance to anything of each "
            "planner by the number of obstacles; the table above has them over all.",
            "Median and middle half over the runs that reached the goal. A planner that only "
            "reaches the easy ones looks quick here.",
        ),
    ]
    if films is not None:
        parts += [tag("h3", "Runs to watch"), *_films(films)]
    return Section(blocks.name_of("success", sweep.folder), title, join(*parts))


def _chosen(counts: Sequence[int]) -> list[int]:
    wanted = [count for count in HEADLINE if count in counts]
    if len(wanted) > 1 or len(counts) <= 1:
        return wanted or list(counts)
    places = {round(k * (len(counts) - 1) / (MOST_COLUMNS - 1)) for k in range(MOST_COLUMNS)}
    return [counts[place] for place in sorted(places)]


def _tables(summary: Summary) -> list[Html]:
    lines = (*summary.lines, summary.total)

    def cells(line: Line, whole: bool) -> list[Html | str]:
        what = "all" if line.count is None else str(line.count)
        shares = (line.cells[name] for name in summary.planners)
        return [
            what,
            str(line.environments if whole else line.feasible),
            *(blocks.share(one.all if whole else one.feasible) for one in shares),
        ]

    head = ["obstacles", "runs", *summary.planners]
    return [
        blocks.table(caption, head, [cells(line, whole) for line in lines], last_apart=True)
        for caption, whole in (
            ("Success over all environments.", True),
            ("Success over the environments that have a way.", False),
        )
    ]


def _ends(summary: Summary) -> Html:
    cells = summary.total.cells
    kinds = sorted({kind for cell in cells.values() for kind in cell.outcomes} - {"goal"})
    return blocks.table(
        "How the runs of each planner ended.",
        ["planner", "goal", *kinds],
        [
            [name, *(str(cell.outcomes.get(kind, 0)) for kind in ("goal", *kinds))]
            for name, cell in cells.items()
        ],
    )


def _measures(rows: Sequence[Row]) -> Html:
    shared = solved_by_all(rows)
    head = ["planner", "runs", "driven ÷ shortest", "time (s)", "clearance (m)", "least (m)"]

    def lines(common: bool) -> list[list[Html | str]]:
        found = []
        for name, mine in by_planner(rows).items():
            one = measures_of(mine, shared if common else None)
            found.append(
                [
                    name,
                    str(one.runs),
                    blocks.quartiles(one.path, ".2f"),
                    blocks.quartiles(one.time, ".1f"),
                    blocks.quartiles(one.clearance, ".3f"),
                    blocks.number(one.least, ".3f"),
                ]
            )
        return found

    whole = blocks.table(
        "Runs that reached the goal: median, and the middle half. Clearance is the least distance "
        "to anything in a run, least the least of any run.",
        head,
        lines(False),
    )
    if len(by_planner(rows)) < 2:
        return whole
    if not shared:
        return join(whole, blocks.paragraphs("No environment was solved by all planners."))
    caption = f"The same over the {len(shared)} environments that every planner solved."
    return join(whole, blocks.table(caption, head, lines(True)))


def _films(films: Films) -> list[Html]:
    parts = [tag("p", RULE, class_="remark")]
    different = [film for runs in films.values() for film in runs.values() if film.other]
    if different:
        parts.append(
            blocks.warning(
                f"{len(different)} runs did not come out as their rows have them: the sweep was "
                "made by another version, with other policies or on another machine. They are "
                "marked."
            )
        )
    for planner, runs in films.items():
        parts.append(tag("h4", planner))
        if not runs:
            parts.append(blocks.paragraphs("No run yet."))
            continue
        parts.append(tag("div", *(_film(role, one) for role, one in runs.items()), class_="films"))
    return parts


def _film(role: str, film: Film) -> Html:
    row = film.wanted.row
    took = f" after {row.time_s:.1f} s" if row.time_s is not None else ""
    way = "" if row.success or row.feasible is not False else "; there is no way for 0.22 m"
    told = f"{row.outcome}{took}, {row.count} obstacles, run {row.run} (seed {row.seed}){way}"
    name = tag("strong", role.capitalize())
    if film.problem is not None:
        what = blocks.warning(f"cannot be made again: {film.problem}")
        return tag("figure", what, tag("figcaption", name, f": {told}."))
    remark = (
        Html()
        if not film.other
        else blocks.warning(
            f"this time it ended otherwise: {film.outcome}. Not the run of the row."
        )
        if film.outcome != row.outcome
        else blocks.warning("not the run of the row: its digest differs.")
    )
    width, height = SIZE
    video = tag(
        "video",
        controls=True,
        playsinline=True,
        preload="metadata",
        width=width,
        height=height,
        poster=data_uri("image/jpeg", film.poster),
        src=data_uri("video/mp4", film.video),
        aria_label=f"{row.planner}, {role} run: {told}",
    )
    played = f" Played at {film.speed}×." if film.speed > 1 else ""
    return tag("figure", video, tag("figcaption", name, f": {told}.{played}"), remark)


def _in_words(summary: Summary, name: str) -> str:
    ends = (summary.lines[0], summary.lines[-1])
    told = [
        f"{line.cells[name].all.value:.2f} at {line.count}" for line in ends[: len(summary.lines)]
    ]
    return f"{name} {', '.join(told)}"
