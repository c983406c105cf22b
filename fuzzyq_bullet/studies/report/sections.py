"""From studies to sections of the page: tables, pictures, remarks, and the runs to be watched."""

from __future__ import annotations

import io
import json
import platform
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from fuzzyq_bullet.outputs import plugin_inputs
from fuzzyq_bullet.platforms import pybullet_in_words
from fuzzyq_bullet.studies.report.films import RULE, SIZE, Film
from fuzzyq_bullet.studies.report.found import Found
from fuzzyq_bullet.studies.report.markup import Child, Html, data_uri, join, tag
from fuzzyq_bullet.studies.study import Findings, Picture, Study, Swept, Table
from fuzzyq_bullet.version import __version__

PACKAGES = ("numpy", "scipy", "matplotlib", "pillow", "imageio-ffmpeg")
_INTERVAL = re.compile(r"(.*) (\[.*\])", re.DOTALL)

Films = Mapping[str, Mapping[str, Film]]
"""By planner, then by what the run is, such as ``best``."""


@dataclass(frozen=True)
class Section:
    """A section of the page: what links call it, its heading, and what it holds."""

    name: str
    title: str
    body: Html


def findings_of(found: Found) -> Findings | None:
    """Return what a study says so far; None while nothing can be compared."""
    if found.study is None:
        return None
    usable = found.study.usable(found.results)
    return None if usable is None else found.study.findings(usable)


def of_study(found: Found, study: Study, findings: Findings | None, films: Films | None) -> Section:
    """Return the section of one study.

    Args:
        found: What there is of it.
        study: It.
        findings: What it says; None while nothing can be compared.
        films: The runs to be watched; None where there are none.
    """
    safe = "".join(c if c.isascii() and c.isalnum() else "-" for c in str(found.folder)).strip("-")
    name = f"{study.name}-{safe}" if safe else study.name
    parts = [unfinished(swept) for swept in found.results.values()]
    if findings is None:
        parts.append(tag("p", "No environment has been met by all planners yet."))
        return Section(name, study.heading(), join(*parts))
    parts += [warning(f"could not be read: {one}") for one in findings.problems]
    parts += [table(one) for one in findings.tables]
    missed = [f"Target missed: {one}." for one in findings.missed]
    parts.append(bullets([*findings.remarks, *missed]))
    parts += [picture(one) for one in findings.pictures]
    parts += [table(one) for one in findings.details]
    if films is not None:
        parts += [tag("h3", "Runs to watch"), *_films(films)]
    return Section(name, study.heading(), join(*parts))


def made(found: Sequence[Found], folder: Path, report: str, plugins: Sequence[str] = ()) -> Section:
    """Return by which commands, settings and versions all was made.

    Args:
        found: All studies.
        folder: Where they are.
        report: The command that made the page.
        plugins: What that was given by ``--plugin``.
    """
    files = {path.name: name for name in plugins for path in plugin_inputs([name])}
    lines = [
        " ".join([one.study.command(one.folder), *_plugins_of(one, files)])
        for one in found
        if one.study is not None
    ]
    sweeps = [swept for one in found for swept in one.results.values()]
    versions = {swept.plan.version for swept in sweeps}
    others = sorted(versions - {__version__})
    packages = [pybullet_in_words(), *(f"{name} {metadata.version(name)}" for name in PACKAGES)]
    settings = [
        tag(
            "details",
            tag("summary", f"Settings of {swept.folder}"),
            tag(
                "pre",
                tag("code", json.dumps(swept.settings, indent=2, ensure_ascii=False)),
                tabindex="0",
            ),
        )
        for swept in sweeps
    ]
    body = join(
        tag("pre", tag("code", "\n".join([*lines, report])), tabindex="0"),
        tag(
            "p",
            "A policy other than the shipped one is not in the commands; settings hold its hash. "
            "The same sweeps give the same page, with the same versions on one machine.",
        ),
        tag(
            "p",
            f"Page: fuzzyq_bullet {__version__}, {', '.join(packages)}, Python "
            f"{platform.python_version()}, {platform.platform()}.",
        ),
        tag("p", f"Sweeps: fuzzyq_bullet {', '.join(sorted(versions))}."),
        warning(
            f"sweeps of another version ({', '.join(others)}): runs that are made again below may "
            "differ."
        )
        if others
        else None,
        *settings,
    )
    return Section("made", "How it was made", body)


def _plugins_of(found: Found, files: Mapping[str, str]) -> list[str]:
    """Return the options by which plugins were loaded for a study.

    Args:
        found: What there is of it; settings hold the names of files alone.
        files: The plugins that are loaded now, by those names.
    """
    told = [swept.settings.get("plugins") for swept in found.results.values()]
    names = dict.fromkeys(name for one in told if isinstance(one, Mapping) for name in one)
    return [f"--plugin {shlex.quote(files.get(name, name))}" for name in names]


def table(one: Table) -> Html:
    """Return a table, which scrolls by itself where the page is narrow."""
    side = ["left" if i in one.left else None for i in range(len(one.columns))]
    lines = [
        tag(
            "tr",
            tag("th", cells[0], scope="row"),
            *(
                tag("td", _cell(text), class_=where)
                for text, where in zip(cells[1:], side[1:], strict=True)
            ),
        )
        for cells in one.rows
    ]
    heads = (
        tag("th", name, scope="col", class_=where)
        for name, where in zip(one.columns, side, strict=True)
    )
    inner = tag(
        "table",
        tag("thead", tag("tr", *heads)),
        tag("tbody", *lines),
        class_="total" if one.total else None,
        aria_label=one.caption,
    )
    # Its words stand outside of what scrolls, and are broken where the page ends.
    label = one.caption
    wide = tag("div", inner, class_="wide", tabindex="0", role="region", aria_label=label)
    return tag("figure", tag("figcaption", one.caption), wide, class_="table")


def picture(one: Picture) -> Html:
    """Return a picture with its caption."""
    out = io.BytesIO()
    one.draw().savefig(out, format="png")
    return png(out.getvalue(), one.alt, one.caption or None)


def png(contents: bytes, alt: str, caption: Child = None) -> Html:
    """Return a PNG with its caption; it scrolls by itself where the page is narrow."""
    image = tag("img", src=data_uri("image/png", contents), alt=alt, style="min-width:720px")
    wide = tag("div", image, class_="wide paper", tabindex="0", role="region", aria_label=alt[:80])
    return tag("figure", wide, None if caption is None else tag("figcaption", caption))


def bullets(texts: Iterable[Child]) -> Html:
    """Return texts as a list."""
    items = [tag("li", text) for text in texts]
    return tag("ul", *items) if items else Html()


def warning(text: Child) -> Html:
    """Return a remark that is not to be overlooked."""
    return tag("p", tag("strong", "Note: "), text, class_="warning")


def missing(what: str, command: str) -> Html:
    """Say by which command a part would be made."""
    return tag("p", f"{what} Made by ", tag("code", command), ".", class_="missing")


def unfinished(swept: Swept) -> Html:
    """Say how far a sweep is; nothing of one that is finished."""
    if swept.finished:
        return Html()
    return warning(
        f"{swept.folder}: unfinished, {len(swept.rows)} of {swept.plan.total} episodes. The "
        "command that began it goes on."
    )


def _cell(text: str) -> Html:
    """Return a cell; intervals stand back behind their figures, lines stay lines."""
    parts: list[Child] = []
    for i, line in enumerate(text.split("\n")):
        parts += [tag("br")] if i else []
        found = _INTERVAL.fullmatch(line)
        if found:
            parts += [f"{found[1]} ", tag("span", found[2], class_="interval")]
        else:
            parts.append(line)
    return join(*parts)


def _films(films: Films) -> list[Html]:
    parts = [tag("p", RULE, class_="remark")]
    different = [film for runs in films.values() for film in runs.values() if film.other]
    if different:
        parts.append(
            warning(
                f"{len(different)} runs did not come out as their rows have them: the sweep was "
                "made by another version, with other policies or on another machine. They are "
                "marked."
            )
        )
    for planner, runs in films.items():
        parts.append(tag("h4", planner))
        if not runs:
            parts.append(tag("p", "No run yet."))
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
        what = warning(f"cannot be made again: {film.problem}")
        return tag("figure", what, tag("figcaption", name, f": {told}."))
    remark = (
        Html()
        if not film.other
        else warning(f"this time it ended otherwise: {film.outcome}. Not the run of the row.")
        if film.outcome != row.outcome
        else warning("not the run of the row: its digest differs.")
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
