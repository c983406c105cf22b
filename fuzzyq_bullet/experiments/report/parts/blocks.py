"""What the parts are built of: sections, tables, pictures, figures with their intervals."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from fuzzyq_bullet.experiments.learning_gain.statistics import Estimate
from fuzzyq_bullet.experiments.report.found import Found
from fuzzyq_bullet.experiments.report.markup import Child, Html, data_uri, join, tag
from fuzzyq_bullet.experiments.report.measures import Quartiles
from fuzzyq_bullet.experiments.wilson import Share

NONE = "–"


@dataclass(frozen=True)
class Section:
    """A section of the page.

    Attributes:
        name: What links call it.
        title: Its heading.
        body: What it holds.
    """

    name: str
    title: str
    body: Html


def table(
    caption: str, head: Sequence[str], rows: Iterable[Sequence[Child]], *, last_apart: bool = False
) -> Html:
    """Return a table, which scrolls by itself where the page is narrow.

    Args:
        caption: What it shows.
        head: Its columns.
        rows: Their cells; the first of each is its heading.
        last_apart: Whether a line sets the last row apart, as for a total.
    """
    lines = [
        tag(
            "tr",
            tag("th", cells[0], scope="row"),
            *(tag("td", one) for one in cells[1:]),
        )
        for cells in rows
    ]
    inner = tag(
        "table",
        tag("thead", tag("tr", *(tag("th", one, scope="col") for one in head))),
        tag("tbody", *lines),
        class_="total" if last_apart else None,
        aria_label=caption,
    )
    # Its words stand outside of what scrolls, and are broken where the page ends.
    wide = tag("div", inner, class_="wide", tabindex="0", role="region", aria_label=caption)
    return tag("figure", tag("figcaption", caption), wide, class_="table")


def picture(contents: bytes, alt: str, caption: Child = None, *, width: int = 720) -> Html:
    """Return a PNG with its caption; it scrolls by itself where the page is narrow."""
    image = tag("img", src=data_uri("image/png", contents), alt=alt, style=f"min-width:{width}px")
    wide = tag("div", image, class_="wide paper", tabindex="0", role="region", aria_label=alt[:80])
    return tag("figure", wide, None if caption is None else tag("figcaption", caption))


def png(figure: Figure) -> bytes:
    """Return a figure as the bytes of a PNG."""
    out = io.BytesIO()
    figure.savefig(out, format="png")
    return out.getvalue()


def paragraphs(*texts: Child) -> Html:
    """Return texts as paragraphs."""
    return join(*(tag("p", text) for text in texts if text is not None))


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


def unfinished(sweep: Found) -> Html:
    """Say how far a sweep is; nothing of one that is finished."""
    if sweep.finished:
        return Html()
    return warning(
        f"{sweep.folder}: unfinished, {len(sweep.rows)} of {sweep.settings.total} episodes. The "
        "command that began it goes on."
    )


def share(one: Share | None) -> Html | str:
    """Return a share with its interval."""
    if one is None:
        return NONE
    return join(f"{one.value:.2f} ", _small(f"[{one.low:.2f}, {one.high:.2f}]"))


def estimate(one: Estimate | None, form: str) -> Html | str:
    """Return an estimate with its interval."""
    if one is None:
        return NONE
    low, high = format(one.low, form), format(one.high, form)
    return join(format(one.value, form), " ", _small(f"[{low}, {high}]"))


def quartiles(one: Quartiles | None, form: str) -> Html | str:
    """Return a median with the middle half."""
    if one is None:
        return NONE
    low, high = format(one.low, form), format(one.high, form)
    return join(format(one.middle, form), " ", _small(f"{low} – {high}"))


def number(value: float | None, form: str = ".1f") -> str:
    """Return a number, or a dash for none."""
    return NONE if value is None else format(value, form)


def name_of(prefix: str, folder: Path) -> str:
    """Return what links call the section of a folder."""
    safe = "".join(c if c.isascii() and c.isalnum() else "-" for c in str(folder)).strip("-")
    return f"{prefix}-{safe}" if safe else prefix


def _small(text: str) -> Html:
    return tag("span", text, class_="interval")
