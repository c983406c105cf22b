"""A study of one's own: is it quicker to turn less than the fuzzy controller says?

    fuzzyq bench turn-weight --plugin examples/extend/study.py --runs 10 --jobs 2

It runs on all cores, goes on where it was interrupted, prints a table, and writes
turn-weight.csv (a row for every episode) and turn-weight.json. ``fuzzyq report`` shows it too.
"""

from statistics import fmean

from pydantic import Field

from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.studies import (
    FieldsPlan,
    Findings,
    Study,
    Table,
    counts_of,
    described,
    register_study,
)


@register_study
class TurnWeight(Study):
    """Drive through random fields with several weights of the turn; print what each takes."""

    name = "turn-weight"
    title = "Weights of the turn"

    counts: str = Field("25", description="Numbers of scattered obstacles.")
    runs: int = Field(5, ge=1, le=1000, description="Fields for every number.")

    def planner_set(self):
        """Return the planners, by what rows call them."""
        return {f"turn-{w:g}": ImprovedFuzzySettings(weights=(1.0, w)) for w in (0.25, 0.5, 1.0)}

    def plan(self):
        """Return what is run: every planner in the same fields."""
        told, counts = described(self.planner_set()), counts_of(self.counts, "--counts")
        return FieldsPlan(
            sweep=self.name,
            planners=told,
            counts=counts,
            runs=self.runs,
            seed=self.seed,
        )

    def findings(self, results):
        """Return a line for each planner: how many arrived, and their mean time."""
        lines = {}
        for name in results[self.name].plan.planners:
            rows = [row for row in results[self.name].rows if row.planner == name]
            times = [row.time_s for row in rows if row.success]
            lines[name] = [f"{len(times)} of {len(rows)}", f"{fmean(times):.1f}" if times else "–"]
        cells = [[name, *line] for name, line in lines.items()]
        return Findings(
            (Table("Means of arrivals.", ("weights", "arrived", "time s"), cells),), lines
        )
