"""Make ``docs/gallery.md`` and its pictures: ``python docs/tools/gallery.py`` (``make gallery``).

Every bundled scenario is driven and drawn from above. A picture is made anew if the run, by its
digest, is another than the one that it shows; ``--anew`` makes all.
"""

from __future__ import annotations

import io
import re
import sys
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from fuzzyq_bullet import Scenario, Trajectory, load_scenario, run
from fuzzyq_bullet.figures.notebook import ENDS
from fuzzyq_bullet.figures.topdown import draw_run
from fuzzyq_bullet.scenario import bundled_scenarios
from fuzzyq_bullet.video.scene.viewpoint import extent_of

DOCS = Path(__file__).resolve().parents[1]
PAGE = DOCS / "gallery.md"
PICTURES = DOCS / "images" / "gallery"
WIDEST = 480
"""Longer side of a picture (pixels)."""

HEAD = """\
# Gallery

Every bundled scenario, driven with its own settings and drawn from above. The command below
a picture drives the scenario and films it. `make gallery` makes this page.

| in a picture | what it is |
|---|---|
| white disc, green disc | the start, the goal |
| black disc | the robot at the end |
| blue line | its path |
| red line | a breakout: the way to the goal is blocked |
| orange line | the robot follows an obstacle |
| purple diamond | the temporary goal of a breakout |
| blue square | the robot leaves the obstacle |
| brown | what moves, where it was at the end, and its way |
| red cross | a collision |

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


def drawn(trajectory: Trajectory) -> Image.Image:
    """Return a run from above without letters, which nobody could read in so small a picture."""
    x0, y0, x1, y1 = extent_of(trajectory)
    scale = WIDEST / 100 / max(x1 - x0, y1 - y0)
    figure = Figure(figsize=(scale * (x1 - x0), scale * (y1 - y0)), dpi=100)
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
    draw_run(axes, trajectory)
    axes.set(xlim=(x0, x1), ylim=(y0, y1), xticks=[], yticks=[])
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return Image.open(file).convert("RGB")


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
        drawn(trajectory).save(picture(name), quality=80, method=6)
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
