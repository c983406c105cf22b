"""Write the table of ``docs/reference/figures.md``, made of what ``Result`` says of its fields.

``make format`` does so; a test tells when the page is not what the code says.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path

from fuzzyq_bullet import Result

PAGE = Path(__file__).resolve().parents[1] / "reference" / "figures.md"
TABLE = re.compile(r"^\| figure \|.*?\n(?=\n)", re.MULTILINE | re.DOTALL)
UNIT = re.compile(r" \((?P<unit>s|m|rad|m/s³)\)")


def renewed() -> str:
    """Return the page with the table of today."""
    text = PAGE.read_text(encoding="utf-8")
    assert len(TABLE.findall(text)) == 1
    return TABLE.sub(lambda _: table(), text)


def table() -> str:
    """Return a row for each figure: its name, its unit, its meaning."""
    told = inspect.cleandoc(Result.__doc__ or "").partition("Attributes:\n")[2]
    rows = ["| figure | unit | meaning |", "|---|---|---|"]
    for entry in re.split(r"\n(?=    \w)", told):
        name, _, meaning = entry.strip().partition(": ")
        words = " ".join(meaning.split()).replace("``", "`").replace("|", "\\|")
        units = dict.fromkeys(UNIT.findall(words))
        unit = next(iter(units), "")
        rows.append(f"| `{name}` | {unit} | {UNIT.sub('', words, count=1)} |")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    PAGE.write_text(renewed(), encoding="utf-8")
