"""Make ``docs/gallery.md`` and its pictures: ``python docs/tools/gallery.py`` (``make gallery``).

Every bundled scenario is driven and drawn from above. A picture is made anew if the run, by its
digest, is another than the one that it shows; ``--anew`` makes all.
"""

from __future__ import annotations

import io
import re
import sys
from pathlib import Path

from PIL import Image

from fuzzyq_bullet import Scenario, load_scenario, run
from fuzzyq_bullet.figures.notebook import ENDS, picture_of
from fuzzyq_bullet.scenario import bundled_scenarios

DOCS = Path(__file__).resolve().parents[1]
PAGE = DOCS / "gallery.md"
PICTURES = DOCS / "images" / "gallery"
WIDEST = 420
"""Pixels."""

HEAD = """\
# Gallery

Every bundled scenario, driven with its own settings and drawn from above. The blue line is the
path. Red and orange are the ways out of dead ends. The command below a picture drives the scenario
and films it. `make gallery` makes this page.

"""
KNOWN = re.compile(
    r"^<!-- (?P<name>\S+): (?P<told>.+?) (?P<digest>[0-9a-f]{32}) -->$", re.MULTILINE
)


def known() -> dict[str, tuple[str, str]]:
    """Return what the page says of each scenario: how it ended, and the digest of the run."""
    text = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    return {one["name"]: (one["told"], one["digest"]) for one in KNOWN.finditer(text)}


def picture(name: str) -> Path:
    """Return where the picture of a scenario is."""
    return PICTURES / f"{name}.webp"


def page(told: dict[str, tuple[str, str]]) -> str:
    """Return the page.

    Args:
        told: Of each scenario, how it ended and the digest of the run.
    """
    entries = "\n".join(entry(load_scenario(name), *told[name]) for name in sorted(told))
    return f'{HEAD}<div class="grid gallery" markdown>\n\n{entries}\n</div>\n'


def entry(scenario: Scenario, ended: str, digest: str) -> str:
    """Return the part of the page about a scenario."""
    name = scenario.name
    return (
        f"<div markdown>\n\n"
        f"<!-- {name}: {ended} {digest} -->\n"
        f"## {name}\n\n"
        f"{scenario.description}\n\n"
        f"![{name}: {ended}, with the planner {scenario.planner.name}]"
        f"(images/gallery/{name}.webp)\n\n"
        f"The planner `{scenario.planner.name}` {ended}.\n\n"
        f"<!-- not run: tests/test_unchanged.py drives every bundled scenario -->\n"
        f"```sh\nfuzzyq run {name}\n```\n\n</div>\n"
    )


def drive(name: str, before: tuple[str, str] | None, *, anew: bool) -> tuple[str, str]:
    """Drive a scenario, draw it if the run is another one, and return what there is to say."""
    trajectory = run(load_scenario(name))
    end = f"{ENDS[trajectory.outcome]} after {trajectory.ticks.time[-1]:.1f} s"
    told = (end, trajectory.digest())
    if anew or told != before or not picture(name).exists():
        drawn = Image.open(io.BytesIO(picture_of(trajectory))).convert("RGB")
        drawn.thumbnail((WIDEST, WIDEST), Image.Resampling.LANCZOS)
        drawn.save(picture(name), quality=80, method=6)
    return told


def main() -> None:
    """Bring the page and its pictures up to date."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    before, told = known(), {}
    for name in sorted(bundled_scenarios()):
        told[name] = drive(name, before.get(name), anew="--anew" in sys.argv)
        print(f"{name}: {told[name][0]}", flush=True)
    for old in set(PICTURES.glob("*.webp")) - {picture(name) for name in told}:
        old.unlink()
    PAGE.write_text(page(told), encoding="utf-8")


if __name__ == "__main__":
    main()
